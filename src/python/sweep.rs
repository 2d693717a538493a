//! Conversion of the arguments of scans that can take time.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Rows, rows, rows_or_beam_rows};
use super::number::Argument;
use super::obstacles::MovingObstaclesArgument;
use crate::memory;
use crate::{Courses, MovingObstacle, Sweeps};

/// How robots move during the scans of a batch.
pub struct SweepArguments<'py> {
    poses: Rows<'py>,
    /// True if there is a pose for each beam.
    has_beams: bool,
    twists: Option<Rows<'py>>,
    scan_duration: Option<f64>,
    /// Number of scans.
    pub scans: usize,
}

impl<'py> SweepArguments<'py> {
    pub fn new(
        beam_count: usize,
        poses: &Bound<'py, PyAny>,
        twists: Option<&Bound<'py, PyAny>>,
        scan_duration: Option<Argument<f64>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let scan_duration = scan_duration.map(|duration| duration.named("scan_duration")).transpose()?;
        let (poses, has_beams) = rows_or_beam_rows("poses", poses, beam_count, out)?;
        let scans = if has_beams { poses.len() / beam_count } else { poses.len() };
        let mut twists = twists.map(|twists| rows("twists", twists, out)).transpose()?;
        if twists.is_some() && has_beams {
            return Err(PyValueError::new_err("twists must be None if poses has one pose for each beam, got both"));
        }
        if twists.is_some() && scan_duration.is_none() {
            return Err(PyValueError::new_err(
                "twists need scan_duration, the time in which the beams of a scan are taken [s]",
            ));
        }
        if twists.is_none() && !has_beams && scan_duration.is_some() {
            // The robots stand.
            twists = Some(Rows::Copied(memory::filled("the twists", [0.0; 3], scans)?));
        }
        Ok(Self { poses, has_beams, twists, scan_duration, scans })
    }

    /// Returns the poses if all beams of a scan are taken in one instant.
    pub fn instant(&self) -> Option<&[[f64; 3]]> {
        if self.scan_duration.is_none() && !self.has_beams { Some(&self.poses) } else { None }
    }

    /// Returns how obstacles move.
    pub fn obstacles<'a>(&self, obstacles: &'a MovingObstaclesArgument<'py>) -> PyResult<Vec<MovingObstacle<'a>>> {
        obstacles.moving(self.scan_duration.is_some())
    }

    pub fn sweeps<'a>(&'a self, obstacles: &'a [MovingObstacle<'a>]) -> Sweeps<'a> {
        let poses = &self.poses;
        let courses = self.twists.as_ref().map_or(Courses::Poses(poses), |twists| Courses::Arcs { poses, twists });
        Sweeps { courses, scan_duration: self.scan_duration.unwrap_or(0.0), obstacles }
    }
}
