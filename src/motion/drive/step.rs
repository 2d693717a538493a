//! Steps of many robots with the same drive.

use super::super::{Limits, Twist};
use super::{Drive, Steering, WheelMotion};
use crate::batch::{check_rows, for_each_chunk};
use crate::error::{Error, check_all_finite, check_number};
use crate::pose::Pose;

/// What the wheels of a robot do: the velocity `[vx, vy, wz]` \[m/s, m/s, rad/s\] and the steering angle \[rad\].
///
/// On an Ackermann drive, only vx and the steering angle count; wz follows from them.
pub type DriveState = [f64; 4];

/// Commands for many robots.
#[derive(Debug, Clone, Copy)]
pub enum DriveCommands<'a> {
    /// Velocities `[vx, vy, wz]`; see [`Drive::command`].
    Twists(&'a [[f64; 3]]),
    /// Speed \[m/s\] and steering angle \[rad\] of Ackermann drives.
    Steered(&'a [[f64; 2]]),
}

impl<'a> From<&'a [[f64; 3]]> for DriveCommands<'a> {
    fn from(twists: &'a [[f64; 3]]) -> Self {
        Self::Twists(twists)
    }
}

impl<'a, const N: usize> From<&'a [[f64; 3]; N]> for DriveCommands<'a> {
    fn from(twists: &'a [[f64; 3]; N]) -> Self {
        Self::Twists(twists)
    }
}

impl<'a> From<&'a [[f64; 2]]> for DriveCommands<'a> {
    fn from(rows: &'a [[f64; 2]]) -> Self {
        Self::Steered(rows)
    }
}

impl<'a> DriveCommands<'a> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Twists(rows) => rows.len(),
            Self::Steered(rows) => rows.len(),
        }
    }

    /// Returns the numbers of a row.
    pub(crate) fn row(&self, row: usize) -> &'a [f64] {
        match self {
            Self::Twists(rows) => &rows[row],
            Self::Steered(rows) => &rows[row],
        }
    }
}

impl Drive {
    /// Moves each robot for `duration` seconds under its command: changes its pose `[x, y, yaw]` and its state in `rows`.
    ///
    /// The motion is that of [`WheelMotion`], without slip, so several short steps under the same command end where one long
    /// step does. The yaw is not wrapped.
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one command for each row.
    /// - [`Error::Row`], [`Error::Element`]: a pose, a state, a command, or a result is not finite, or a steering angle of a
    ///   state is beyond [`MAX_STEERING`](super::MAX_STEERING), or not 0 for a drive that does not steer.
    /// - [`Error::Number`]: `duration` is negative or not finite.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn step(
        &self,
        rows: &mut [([f64; 3], DriveState)],
        commands: DriveCommands,
        limits: &Limits,
        duration: f64,
    ) -> Result<(), Error> {
        /// Number of robots that one thread moves at a time.
        const CHUNK: usize = 256;
        if commands.len() != rows.len() {
            return Err(Error::Length { name: "commands", value: commands.len(), needed: rows.len() });
        }
        match commands {
            DriveCommands::Twists(twists) => check_rows("commands", twists, None)?,
            DriveCommands::Steered(rows) => check_all_finite("commands", rows.as_flattened(), 2)?,
        }
        check_number("dt", duration, "at least 0", |value| value >= 0.0)?;
        let (needed, largest) = self.steering_domain();
        for (row, (pose, state)) in rows.iter().enumerate() {
            check_row("poses", row, pose)?;
            check_row("states", row, state)?;
            if state[3].abs() > largest {
                return Err(Error::Element { name: "the steering angle of states", row, value: state[3], needed });
            }
        }
        for_each_chunk(None, rows, CHUNK, |index, chunk| {
            for (offset, (pose, state)) in chunk.iter_mut().enumerate() {
                let [vx, vy, wz, angle] = *state;
                let row = index * CHUNK + offset;
                let (wanted, goal) = match commands {
                    DriveCommands::Twists(twists) => self.command(twists[row].into(), angle),
                    DriveCommands::Steered(rows) => (Twist::from([rows[row][0], 0.0, 0.0]), rows[row][1]),
                };
                let steering = Steering { angle, goal, rate: f64::INFINITY };
                let motion = WheelMotion::new(*self, limits, [vx, vy, wz].into(), wanted, steering)?;
                *pose = motion.moved(Pose::from(*pose), duration, 1.0).to_array();
                let [vx, vy, wz] = motion.velocity(duration).to_array();
                *state = [vx, vy, wz, motion.steering(duration)];
                check_row("the resulting poses", row, pose)?;
                check_row("the resulting states", row, state)?;
            }
            Ok(())
        })
    }
}

/// Checks that the numbers of a row are finite.
fn check_row(name: &'static str, row: usize, numbers: &[f64]) -> Result<(), Error> {
    match numbers.iter().find(|number| !number.is_finite()) {
        Some(&value) => Err(Error::Element { name, row, value, needed: "finite" }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_robot_of_a_batch_moves_as_if_it_were_alone() {
        let drive = Drive::ackermann(2.5, 1.5, 0.3, 0.6, 0.5).unwrap();
        let limits = Limits::new([3.0; 3], [1.0; 3], [2.0; 3]).unwrap();
        let mut rows: Vec<([f64; 3], DriveState)> =
            (0..600).map(|nth| ([0.1 * f64::from(nth), 0.0, 0.2], [0.5, 0.0, 0.0, 0.001 * f64::from(nth)])).collect();
        let twists: Vec<[f64; 3]> = (0..600).map(|nth| [1.0, 0.0, 0.001 * f64::from(nth)]).collect();
        let before = rows.clone();
        drive.step(&mut rows, DriveCommands::Twists(&twists), &limits, 0.8).unwrap();
        for nth in [0, 255, 256, 599] {
            let mut alone = [before[nth]];
            drive.step(&mut alone, DriveCommands::Twists(&twists[nth..=nth]), &limits, 0.8).unwrap();
            assert_eq!(alone[0], rows[nth]);
        }
        // The speed rises from 0.5 m/s to 1 m/s in half a second.
        assert_eq!(rows[599].1[0], 1.0);
        assert!((rows[0].0[0] - (0.5 * 0.75 + 0.3) * libm::cos(0.2)).abs() < 1e-15);
    }

    #[test]
    fn bad_rows_are_refused() {
        let drive = Drive::differential(0.5, 0.1).unwrap();
        let mut rows = [([0.0; 3], [0.0; 4])];
        let mut text = |commands| drive.step(&mut rows, commands, &Limits::NONE, 1.0).unwrap_err().to_string();
        assert_eq!(text(DriveCommands::Twists(&[])), "commands must have 1 elements, got 0");
        let bad = [[f64::NAN, 0.0, 0.0]];
        assert_eq!(text(DriveCommands::Twists(&bad)), "commands must be finite, got [NaN, 0.0, 0.0] in row 0");
        assert_eq!(text(DriveCommands::Steered(&[[f64::INFINITY, 0.0]])), "commands must be finite, got inf in row 0");
    }
}
