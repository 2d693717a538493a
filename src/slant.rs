//! The beams of a tilted scanner: how a range in the plane becomes a range in space.

use glam::DVec2;

use crate::beams::Beams;
use crate::error::Error;
use crate::memory;
use crate::mount::Mount;
use crate::numeric::{GROUP, Group};

/// The beams of a tilted scanner, seen from the side: each meets a wall at a distance `range` and the floor at `floor`.
///
/// ```text
///   laser +--.._     elevation (negative here)
///         |      `--.._  range     #
///    z    |             `--.._     #  wall, of any height
///         |                    `--.#
///   ------+------------------------#--- floor
///             horizontal distance
/// ```
///
/// Walls and obstacles have any height, so `range = horizontal distance / cos(elevation)`.
#[derive(Debug, Clone)]
pub struct Slant {
    groups: Vec<SlantGroup>,
    max_range: f64,
}

#[derive(Debug, Clone, Copy)]
struct SlantGroup {
    /// Cosine of the elevation of each beam.
    cos_elevation: Group,
    /// Range of each beam to the floor \[m\]; infinite if it does not meet the floor.
    floor: Group,
}

/// Cosine of the elevation below which a beam is vertical, and meets no wall.
const VERTICAL: f64 = 1e-12;

impl Slant {
    /// Returns the slant of beams on a mount. Writes the directions of the beams, seen from above in the base frame, to
    /// `cos` and `sin`.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(mount: Mount, beams: Beams, max_range: f64, cos: &mut [Group], sin: &mut [Group]) -> Result<Self, Error> {
        let level = SlantGroup { cos_elevation: [1.0; GROUP], floor: [f64::INFINITY; GROUP] };
        let mut groups = memory::filled("the beams", level, cos.len())?;
        let height = mount.position.z;
        for beam in 0..beams.count() {
            let (group, place) = (beam / GROUP, beam % GROUP);
            let direction = mount.direction(beams.angle(beam));
            let horizontal = direction.truncate();
            let length = horizontal.length();
            let heading = if length < VERTICAL { DVec2::X } else { horizontal / length };
            (cos[group][place], sin[group][place]) = heading.into();
            groups[group].cos_elevation[place] = if length < VERTICAL { 0.0 } else { length };
            if height > 0.0 && direction.z < 0.0 {
                groups[group].floor[place] = height / -direction.z;
            }
        }
        Ok(Self { groups, max_range })
    }

    /// Returns the slant of some of the beams.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn selected(&self, beams: &[usize]) -> Result<Self, Error> {
        let level = SlantGroup { cos_elevation: [1.0; GROUP], floor: [f64::INFINITY; GROUP] };
        let mut groups = memory::filled("the beams", level, beams.len().div_ceil(GROUP))?;
        for (place, &beam) in beams.iter().enumerate() {
            let (to, from) = (&mut groups[place / GROUP], &self.groups[beam / GROUP]);
            to.cos_elevation[place % GROUP] = from.cos_elevation[beam % GROUP];
            to.floor[place % GROUP] = from.floor[beam % GROUP];
        }
        Ok(Self { groups, max_range: self.max_range })
    }

    /// Returns the horizontal part of the range of a beam \[m\].
    pub fn horizontal(&self, beam: usize, range: f64) -> f64 {
        range * self.groups[beam / GROUP].cos_elevation[beam % GROUP]
    }

    /// Returns the range of a beam to the floor \[m\]; infinite if it does not meet the floor.
    pub fn floor(&self, beam: usize) -> f64 {
        self.groups[beam / GROUP].floor[beam % GROUP]
    }

    /// Returns the ranges in space of a group of beams, from their horizontal distances \[m\].
    pub fn ranges(&self, group: usize, distances: &Group) -> Group {
        let SlantGroup { cos_elevation, floor } = &self.groups[group];
        std::array::from_fn(|place| {
            // A beam that starts in a wall has range 0, also if it is vertical.
            let distance = distances[place];
            let to_wall = if distance > 0.0 { distance / cos_elevation[place] } else { 0.0 };
            let range = to_wall.min(floor[place]);
            if range < self.max_range { range } else { f64::INFINITY }
        })
    }
}
