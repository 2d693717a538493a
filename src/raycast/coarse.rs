//! Coarse beams: every n-th beam of a dense scanner. They are cast first.

use crate::error::Error;
use crate::memory;
use crate::numeric::{GROUP, Group};

/// Every `step`-th beam of a scanner, from the first one on, and then the beams after the last of these.
#[derive(Debug, Clone)]
pub struct CoarseBeams {
    /// A power of two.
    pub step: usize,
    /// Angle between neighbouring beams of the scanner \[rad\].
    pub spacing: f64,
    /// Number of the coarse beams.
    pub count: usize,
    /// Cosines of their angles in the frame of a fan.
    pub cos: Vec<Group>,
    /// Sines of the same angles.
    pub sin: Vec<Group>,
}

/// Largest angle between coarse beams \[rad\].
const MAX_SPACING: f64 = 9.3e-3;

/// Smallest angle between beams \[rad\]. The components of the directions of closer beams might be in the wrong order, by rounding.
const MIN_BEAM_SPACING: f64 = 1e-5;

/// Longest step.
const MAX_STEP: usize = 32;

impl CoarseBeams {
    /// Returns the coarse beams of a scanner; `None` if its beams are too far apart, or too close together.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(spacing: f64, cos: &[Group], sin: &[Group], count: usize) -> Result<Option<Self>, Error> {
        let mut step = 1;
        while step < MAX_STEP && (2 * step) as f64 * spacing <= MAX_SPACING {
            step *= 2;
        }
        if step == 1 || spacing < MIN_BEAM_SPACING || count < 4 * step {
            return Ok(None);
        }
        let last = (count - 1) / step * step;
        let beams = (0..last).step_by(step).chain(last..count);
        let picked = beams.clone().count();
        let pick = |from: &[Group], padding: f64| {
            let mut to = memory::filled("the beams", [padding; GROUP], picked.div_ceil(GROUP))?;
            for (to, beam) in to.as_flattened_mut().iter_mut().zip(beams.clone()) {
                *to = from.as_flattened()[beam];
            }
            Ok(to)
        };
        Ok(Some(Self { step, spacing, count: picked, cos: pick(cos, 1.0)?, sin: pick(sin, 0.0)? }))
    }
}
