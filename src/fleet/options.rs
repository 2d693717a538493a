//! Options of fleets.

use super::robot::Body;
use crate::beam_model::BeamModel;
use crate::contact::ContactMode;
use crate::error::{Error, check_number};
use crate::motion::{Drive, Limits, MotionNoise};
use crate::scanner::LaserScanner;
use crate::shape::Shape;
use crate::surface::SurfaceModel;

/// Options of a fleet. A list has one element for all robots, or one for each.
#[derive(Debug, Clone)]
pub struct FleetOptions {
    /// Outline of the robots; `None` if they touch nothing.
    pub footprint: Option<Shape>,
    /// What a contact does to the motion.
    pub contact: ContactMode,
    /// Limits on the velocity of the wheels and its change; empty for no limits.
    pub limits: Vec<Limits>,
    /// The wheels, all of one kind; empty for robots that move in any direction.
    pub drives: Vec<Drive>,
    /// Share of the commanded motion that slipping wheels lose, in 0..1; empty for none.
    pub slip: Vec<f64>,
    /// The scanner on each robot; `None` for no scans.
    pub scanner: Option<LaserScanner>,
    /// Noise of the ranges; empty for true ranges.
    pub noise: Vec<BeamModel>,
    /// How what a beam meets changes its reading, beside the noise; empty for not at all.
    pub surfaces: Vec<SurfaceModel>,
    /// Noise of the odometry; empty for exact odometry.
    pub odometry_noise: Vec<MotionNoise>,
    /// Distance up to which the clearance of the robots is measured after a step \[m\]; `None` to not measure it.
    pub clearance_limit: Option<f64>,
    /// Least free distance \[m\] around the footprint of a robot at a pose that is drawn.
    pub clearance: f64,
}

impl FleetOptions {
    /// Returns what a robot is.
    pub(super) fn body(&self, robot: usize) -> Body<'_> {
        Body {
            footprint: self.footprint.as_ref(),
            mode: self.contact,
            limits: of_robot(&self.limits, robot),
            grip: 1.0 - of_robot(&self.slip, robot).copied().unwrap_or(0.0),
            drive: of_robot(&self.drives, robot),
        }
    }

    /// Returns the noise of the odometry of a robot.
    pub(super) fn odometry_noise_of(&self, robot: usize) -> Option<&MotionNoise> {
        of_robot(&self.odometry_noise, robot)
    }

    /// Returns the work of a robot in a step, compared with one that only moves.
    pub(super) fn effort(&self) -> usize {
        1 + usize::from(self.footprint.is_some()) + 4 * usize::from(self.clearance_limit.is_some())
    }

    /// Checks the options for so many robots.
    pub(super) fn checked(self, count: usize) -> Result<Self, Error> {
        let lengths = [
            ("limits", self.limits.len()),
            ("drive", self.drives.len()),
            ("slip", self.slip.len()),
            ("noise", self.noise.len()),
            ("surfaces", self.surfaces.len()),
            ("odometry_noise", self.odometry_noise.len()),
        ];
        for (name, length) in lengths {
            if length > 1 && length != count {
                return Err(Error::Length { name, value: length, needed: count });
            }
        }
        if let Some(robot) = self.drives.iter().position(|drive| drive.kind() != self.drives[0].kind()) {
            return Err(Error::DriveKinds { robot });
        }
        for &slip in &self.slip {
            check_number("slip", slip, "in 0..1", |slip| (0.0..=1.0).contains(&slip))?;
        }
        if let Some(limit) = self.clearance_limit {
            check_number("clearance_limit", limit, "positive", |limit| limit > 0.0)?;
        }
        check_number("clearance", self.clearance, "at least 0", |clearance| clearance >= 0.0)?;
        Ok(self)
    }
}

/// Returns the element of a list that has one for all robots, or one for each; `None` if it is empty.
pub(super) fn of_robot<T>(list: &[T], robot: usize) -> Option<&T> {
    if list.len() == 1 { list.first() } else { list.get(robot) }
}
