//! The argument that says where a scanner sits on its robot.

use pyo3::prelude::*;

use super::arrays::{short_repr, type_name};
use super::pose::{Pose, refused};

/// A mount argument: a `Pose`, or a sequence of three, six or seven numbers.
pub struct MountArgument(pub crate::Mount);

impl<'py> FromPyObject<'_, 'py> for MountArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(pose) = value.cast::<Pose>() {
            return Ok(Self(pose.get().0.into()));
        }
        if let Ok([x, y, yaw]) = value.extract::<[f64; 3]>() {
            return Ok(Self(crate::Mount::from(crate::Pose::new(x, y, yaw)).checked()?));
        }
        if let Ok([x, y, z, roll, pitch, yaw]) = value.extract::<[f64; 6]>() {
            return Ok(Self(crate::Mount::new([x, y, z], [roll, pitch, yaw]).checked()?));
        }
        if let Ok([x, y, z, qx, qy, qz, qw]) = value.extract::<[f64; 7]>() {
            return Ok(Self(crate::Mount::from_quaternion([x, y, z], [qx, qy, qz, qw])?));
        }
        let text = format!(
            "a mount must be three numbers (x, y, yaw), six (x, y, z, roll, pitch, yaw) or seven (x, y, z, qx, qy, qz, qw), \
             got {}: {}",
            type_name(&value),
            short_repr(&value)
        );
        Err(refused(&value, text, &[3, 6, 7]))
    }
}
