//! The joints of the robots of a fleet: wheels, and front wheels that steer.

use super::Fleet;
use super::robot::Joints;
use crate::error::{Error, check_all_finite};
use crate::motion::{Drive, DriveKind};

impl Fleet {
    /// Returns the number of joints of each robot: its wheels, and the steering of its left and right front wheel.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        let of_drive = |drive: &Drive| drive.wheel_count() + 2 * usize::from(drive.kind() == DriveKind::Ackermann);
        self.options.drives.first().map_or(0, of_drive)
    }

    /// Writes what the joints of each robot do, one robot after another: wheels, then steering, each in the order of [`Drive`].
    ///
    /// `positions` gets angles \[rad\]: those of wheels are by how much they have turned since the last reset. `rates` gets
    /// rates \[rad/s\].
    ///
    /// # Errors
    /// - [`Error::Length`]: a list does not have [`joint_count`](Self::joint_count) elements for each robot.
    /// - [`Error::Number`], [`Error::Element`]: a number or a result is not finite.
    pub fn joints(&self, positions: &mut [f64], rates: &mut [f64]) -> Result<(), Error> {
        let (count, needed) = (self.joint_count(), self.joint_count() * self.len());
        for (name, value) in [("positions", positions.len()), ("rates", rates.len())] {
            if value != needed {
                return Err(Error::Length { name, value, needed });
            }
        }
        if count == 0 {
            return Ok(());
        }
        let rows = positions.chunks_exact_mut(count).zip(rates.chunks_exact_mut(count));
        for ((robot, member), (positions, rates)) in self.in_order().enumerate().zip(rows) {
            let body = self.options.body(robot);
            if let (Some(drive), Some(joints)) = (body.drive, member.robot.joints(body)?) {
                let (wheels, Joints { rolled, wheel_rates, angle, rate }) = (drive.wheel_count(), joints);
                positions[..wheels].copy_from_slice(&rolled[..wheels]);
                rates[..wheels].copy_from_slice(&wheel_rates[..wheels]);
                positions[wheels..].copy_from_slice(&drive.steering_angles(angle)[..count - wheels]);
                rates[wheels..].copy_from_slice(&drive.steering_angle_rates(angle, rate)[..count - wheels]);
            }
        }
        check_all_finite("the resulting rates", rates, count)
    }

    /// Writes the steering angle of each robot \[rad\]; 0 for robots that do not steer.
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one angle for each robot.
    /// - [`Error::Number`]: a number is not finite.
    pub fn steering(&self, angles: &mut [f64]) -> Result<(), Error> {
        if angles.len() != self.len() {
            return Err(Error::Length { name: "angles", value: angles.len(), needed: self.len() });
        }
        for ((robot, member), angle) in self.in_order().enumerate().zip(angles) {
            *angle = member.robot.joints(self.options.body(robot))?.map_or(0.0, |joints| joints.angle);
        }
        Ok(())
    }
}
