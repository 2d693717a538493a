//! Mounts: where a scanner sits on its robot, in space.

use glam::{DVec2, DVec3};

use crate::error::{Error, check_finite};
use crate::pose::Pose;

/// Pose of the laser frame in the robot's base frame, in space: `base_from_laser`.
///
/// The rotation is that of URDF and REP-103: first `roll` about x, then `pitch` about y, then `yaw` about z, all about the
/// axes of the base frame.
///
/// A scanner whose plane is tilted by at most 1e-5 rad is level or upside down, because files round π to 3.1416.
///
/// ```
/// use mobile_robot_simulator::{Mount, Pose};
///
/// assert_eq!(Mount::from(Pose::new(0.2, 0.0, 1.5)), Mount::new([0.2, 0.0, 0.0], [0.0, 0.0, 1.5]));
/// let upside_down = Mount::from_quaternion([0.2, 0.0, 0.3], [1.0, 0.0, 0.0, 0.0])?;
/// assert_eq!(upside_down, Mount::new([0.2, 0.0, 0.3], [std::f64::consts::PI, 0.0, 0.0]));
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount {
    /// Position in the base frame \[m\]. A positive z is the height above the floor, which the beams of a tilted scanner can
    /// hit. With any other z, the height is unknown, and there is no floor.
    pub position: DVec3,
    /// Rotation about x \[rad\].
    pub roll: f64,
    /// Rotation about y \[rad\]: positive if the scanner looks down.
    pub pitch: f64,
    /// Rotation about z \[rad\].
    pub yaw: f64,
}

/// How the plane of the beams lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Attitude {
    /// Horizontal, with z up.
    Level,
    /// Horizontal, with z down.
    UpsideDown,
    /// Not horizontal.
    Tilted,
}

/// Largest sine of the tilt of a plane that counts as horizontal.
const LEVEL_TOLERANCE: f64 = 1e-5;

impl Mount {
    /// Returns the mount at a position `[x, y, z]` \[m\] with a rotation `[roll, pitch, yaw]` \[rad\].
    #[must_use]
    pub const fn new([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        Self { position: DVec3::new(x, y, z), roll, pitch, yaw }
    }

    /// Returns the mount at a position `[x, y, z]` \[m\] with a rotation `[x, y, z, w]`, a quaternion of any length but 0.
    ///
    /// At a pitch of ±90°, where roll and yaw are not unique, the roll is 0.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite, or the quaternion is zero.
    pub fn from_quaternion(position: [f64; 3], [x, y, z, w]: [f64; 4]) -> Result<Self, Error> {
        let norm = (x * x + y * y + z * z + w * w).sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            return Err(Error::Number {
                name: "the norm of the mount's quaternion",
                value: norm,
                needed: "positive and finite",
            });
        }
        let [x, y, z, w] = [x, y, z, w].map(|part| part / norm);
        // Elements of the rotation matrix.
        let (xx, yx, zx) = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
        let (zy, zz) = (2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y));
        let level = xx.hypot(yx);
        let pitch = libm::atan2(-zx, level);
        if level < 1e-9 {
            let (xy, yy) = (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z));
            return Self::new(position, [0.0, pitch, libm::atan2(-xy, yy)]).checked();
        }
        Self::new(position, [libm::atan2(zy, zz), pitch, libm::atan2(yx, xx)]).checked()
    }

    /// Returns the mount unchanged if its numbers are finite.
    ///
    /// # Errors
    /// [`Error::Number`], which names the first number that is not finite.
    pub fn checked(self) -> Result<Self, Error> {
        check_finite("mount x", self.position.x)?;
        check_finite("mount y", self.position.y)?;
        check_finite("mount z", self.position.z)?;
        check_finite("mount roll", self.roll)?;
        check_finite("mount pitch", self.pitch)?;
        check_finite("mount yaw", self.yaw)?;
        Ok(self)
    }

    /// Returns the horizontal part `(x, y, yaw)`.
    #[must_use]
    pub fn planar(self) -> Pose {
        Pose { position: self.position.truncate(), yaw: self.yaw }
    }

    /// Returns `[x, y, z, roll, pitch, yaw]` in metres and radians.
    #[must_use]
    pub fn to_array(self) -> [f64; 6] {
        let [x, y, z] = self.position.to_array();
        [x, y, z, self.roll, self.pitch, self.yaw]
    }

    /// Returns the rotation as a unit quaternion `[x, y, z, w]`.
    #[must_use]
    pub fn to_quaternion(self) -> [f64; 4] {
        let [(sr, cr), (sp, cp), (sy, cy)] = [self.roll, self.pitch, self.yaw].map(|angle| libm::sincos(0.5 * angle));
        [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy]
    }

    /// Returns how the plane of the beams lies.
    pub(crate) fn attitude(self) -> Attitude {
        let ((sr, cr), (sp, cp)) = (libm::sincos(self.roll), libm::sincos(self.pitch));
        if sr.hypot(sp * cr) > LEVEL_TOLERANCE {
            Attitude::Tilted
        } else if cr * cp > 0.0 {
            Attitude::Level
        } else {
            Attitude::UpsideDown
        }
    }

    /// Returns the angle of the laser's x axis in the base frame, seen from above \[rad\].
    pub(crate) fn heading(self) -> f64 {
        // Looking down by more than 90° is looking back.
        if libm::cos(self.pitch) < 0.0 { self.yaw + std::f64::consts::PI } else { self.yaw }
    }

    /// Returns the direction in the base frame of the beam at an angle of the laser frame \[rad\].
    pub(crate) fn direction(self, angle: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(angle);
        let [(sr, cr), (sp, cp), (sy, cy)] = [self.roll, self.pitch, self.yaw].map(libm::sincos);
        // In the plane of the beams, then rolled, then pitched, then turned.
        let (y, z) = (cr * sin, sr * sin);
        let (ahead, up) = (cp * cos + sp * z, cp * z - sp * cos);
        DVec2::new(cy, sy).rotate(DVec2::new(ahead, y)).extend(up)
    }
}

impl From<Pose> for Mount {
    fn from(pose: Pose) -> Self {
        Self { position: pose.position.extend(0.0), yaw: pose.yaw, ..Self::default() }
    }
}

#[cfg(test)]
#[allow(clippy::approx_constant, reason = "files round it")]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use glam::DQuat;

    use super::*;

    #[test]
    fn quaternions_and_angles_agree() {
        for roll in [-3.0, -1.0, 0.0, 0.4, PI] {
            for pitch in [-1.5, -0.2, 0.0, 0.9] {
                for yaw in [-2.0, 0.0, 1.3] {
                    let mount = Mount::new([0.1, 0.2, 0.3], [roll, pitch, yaw]);
                    let [x, y, z, w] = mount.to_quaternion();
                    let rotation =
                        DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll);
                    assert!(DQuat::from_xyzw(x, y, z, w).abs_diff_eq(rotation, 1e-14));
                    let back = Mount::from_quaternion([0.1, 0.2, 0.3], [3.0 * x, 3.0 * y, 3.0 * z, 3.0 * w]).unwrap();
                    for angle in [-2.0, 0.0, 0.7] {
                        let expected = rotation * DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
                        assert!(mount.direction(angle).abs_diff_eq(expected, 1e-14));
                        assert!(back.direction(angle).abs_diff_eq(expected, 1e-14));
                    }
                }
            }
        }
        for pitch in [FRAC_PI_2, -FRAC_PI_2] {
            let mount = Mount::new([0.0; 3], [0.3, pitch, 0.5]);
            let back = Mount::from_quaternion([0.0; 3], mount.to_quaternion()).unwrap();
            for angle in [-2.0, 0.0, 0.7] {
                assert!(mount.direction(angle).abs_diff_eq(back.direction(angle), 1e-7), "{pitch}");
            }
        }
    }

    #[test]
    fn a_plane_is_level_or_upside_down_within_what_files_round() {
        let attitude = |roll, pitch| Mount::new([0.0; 3], [roll, pitch, 0.7]).attitude();
        for (roll, pitch) in [(0.0, 0.0), (PI, PI), (1e-6, -9e-6), (-PI, -3.1416), (2.0 * PI, 0.0)] {
            assert_eq!(attitude(roll, pitch), Attitude::Level, "{roll} {pitch}");
        }
        for (roll, pitch) in [(PI, 0.0), (-3.1416, 0.0), (3.14159, 1e-6), (0.0, PI), (0.0, -3.1416)] {
            assert_eq!(attitude(roll, pitch), Attitude::UpsideDown, "{roll} {pitch}");
        }
        for (roll, pitch) in
            [(1.1e-5, 0.0), (0.0, -1.1e-5), (FRAC_PI_2, 0.0), (3.14, 0.0), (PI, 0.1), (FRAC_PI_2, FRAC_PI_2)]
        {
            assert_eq!(attitude(roll, pitch), Attitude::Tilted, "{roll} {pitch}");
        }
    }

    #[test]
    fn the_error_names_the_bad_number() {
        let error = Mount::new([0.0, 0.0, f64::NAN], [0.0; 3]).checked().unwrap_err().to_string();
        assert_eq!(error, "mount z must be finite, got NaN");
        let error = Mount::from_quaternion([0.0; 3], [0.0; 4]).unwrap_err().to_string();
        assert_eq!(error, "the norm of the mount's quaternion must be positive and finite, got 0");
    }
}
