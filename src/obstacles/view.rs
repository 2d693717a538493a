//! The obstacles that one scan can see, each with the range of beams that can hit it.
//!
//! ```text
//!                    _.-'   tangent
//!               _.-',---.
//!          _.-'    /     \
//!  laser ---------|   +   |---   bearing of the centre +
//!          `-._    \     /
//!              `-._ `---'        half_angle = asin(reach / distance to the centre)
//!                  `-._   tangent
//! ```
//!
//! Only beams between `bearing - half_angle` and `bearing + half_angle` are tested against the outline.

use glam::DVec2;

use super::body::disc_entry;
use super::squares::Circle;
use super::{Body, OBSTACLES, Obstacles};
use crate::beams::Beams;
use crate::error::Error;
use crate::memory;
use crate::pose::Pose;

/// Extra angle \[rad\] on both sides of an obstacle, far larger than the rounding error of its bearing.
const ANGLE_MARGIN: f64 = 1e-9;

/// Number of beams up to which an obstacle is narrow.
const NARROW: usize = 32;

/// The obstacles that a scan can see from one pose.
pub struct View<'a> {
    /// Position of the laser in the map frame \[m\].
    origin: DVec2,
    /// Unit vector along the laser's x axis, in the map frame.
    heading: DVec2,
    max_range: f64,
    /// Obstacles that many beams can hit.
    wide: Vec<Seen<'a>>,
    /// The others, by the first beam that can hit them.
    narrow: Vec<Seen<'a>>,
}

/// One obstacle and the beams that can hit it.
struct Seen<'a> {
    outline: Outline<'a>,
    /// First beam that can hit the obstacle, and one past the last.
    beams: (usize, usize),
}

/// What a beam can hit.
#[derive(Clone, Copy)]
enum Outline<'a> {
    /// The laser is inside the obstacle.
    Around,
    /// A disc: the way to its centre and its radius \[m\]. Most crowds are discs, and reading all of their bodies takes long.
    Disc(DVec2, f64),
    Polygon(&'a Body),
}

impl<'a> View<'a> {
    /// Returns the obstacles within `max_range` of a laser at `map_from_laser`. Allocates only if there is at least one.
    ///
    /// The obstacle with the index `except` is left out. `beams` are `None` if they are not evenly spread in the plane; then each may hit each obstacle.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(
        (obstacles, except): (&'a Obstacles, Option<usize>),
        map_from_laser: Pose,
        beams: Option<Beams>,
        beam_count: usize,
        max_range: f64,
    ) -> Result<Self, Error> {
        let (sin, cos) = libm::sincos(map_from_laser.yaw);
        let (origin, heading) = (map_from_laser.position, DVec2::new(cos, sin));
        let (mut wide, mut narrow) = (Vec::new(), Vec::new());
        let mut add = |seen: Seen<'a>| {
            let list = if seen.beams.1 - seen.beams.0 > NARROW { &mut wide } else { &mut narrow };
            memory::push(OBSTACLES, list, seen)
        };
        for index in obstacles.near(origin, max_range).filter(|index| Some(*index) != except) {
            let Circle { center, reach, is_outline } = obstacles.circles[index];
            let offset = center - origin;
            let distance = offset.length();
            if distance - reach > max_range {
                continue;
            }
            let outline = if distance <= reach && obstacles.bodies[index].contains(origin) {
                Outline::Around
            } else if is_outline {
                Outline::Disc(offset, reach)
            } else {
                Outline::Polygon(&obstacles.bodies[index])
            };
            if let Some(beams) = beams.filter(|beams| distance > reach && beams.count() > 1) {
                let offset = DVec2::new(cos, -sin).rotate(offset);
                let bearing = libm::atan2(offset.y, offset.x);
                let half_angle = libm::asin(reach / distance) + ANGLE_MARGIN;
                for beams in beams.within(bearing - half_angle, bearing + half_angle).filter(|beams| beams.0 < beams.1) {
                    add(Seen { outline, beams })?;
                }
            } else {
                add(Seen { outline, beams: (0, beam_count) })?;
            }
        }
        narrow.sort_unstable_by_key(|seen| seen.beams.0);
        Ok(Self { origin, heading, max_range, wide, narrow })
    }

    /// Returns true if the scan can see no obstacle.
    pub fn is_empty(&self) -> bool {
        self.wide.is_empty() && self.narrow.is_empty()
    }

    /// Replaces each range \[m\] by the distance to the nearest obstacle, if that is shorter than the range and `max_range`.
    ///
    /// `ranges[i]` is the range of beam `first + i`, infinite for no return. `direction(i)` is the direction of that beam: a
    /// unit vector in the laser frame.
    pub fn shorten(&self, first: usize, direction: impl Fn(usize) -> DVec2, ranges: &mut [f64]) {
        // A narrow obstacle ends at most `NARROW` beams after its first one.
        let starts_before = |beam: usize| self.narrow.partition_point(|seen| seen.beams.0 < beam);
        let narrow = &self.narrow[starts_before((first + 1).saturating_sub(NARROW))..starts_before(first + ranges.len())];
        for seen in self.wide.iter().chain(narrow) {
            let (start, end) = (seen.beams.0.max(first), seen.beams.1.min(first + ranges.len()));
            for beam in start..end {
                let range = &mut ranges[beam - first];
                let direction = || self.heading.rotate(direction(beam - first));
                let distance = match seen.outline {
                    Outline::Around => 0.0,
                    Outline::Disc(offset, radius) => disc_entry(offset, radius, direction()),
                    Outline::Polygon(body) => body.entry(self.origin, direction()),
                };
                if distance < range.min(self.max_range) {
                    *range = distance;
                }
            }
        }
    }
}
