//! Obstacles as one scan sees them: each with the few beams that can meet it.

use std::f64::consts::TAU;

use glam::DVec2;

use super::{Body, Obstacles};
use crate::pose::Pose;

/// Angles this near \[rad\] to an obstacle's outermost ones are cast as well; rounding is far below.
const MARGIN: f64 = 1e-9;

/// Angles of the beams of a scan, from the first on.
#[derive(Debug, Clone, Copy)]
pub struct Spread {
    pub angle_min: f64,
    pub angle_increment: f64,
    pub beam_count: usize,
}

/// The obstacles within reach of a scan.
pub struct View<'a> {
    origin: DVec2,
    heading: DVec2,
    max_range: f64,
    seen: Vec<Seen<'a>>,
}

struct Seen<'a> {
    body: &'a Body,
    /// Whether the scan starts in it.
    inside: bool,
    /// First beam that can meet it, and the one after the last.
    beams: (usize, usize),
}

impl<'a> View<'a> {
    /// What a scanner at `map_from_laser` can see of the obstacles; allocates only if there are any.
    pub fn new(obstacles: &'a Obstacles, map_from_laser: Pose, spread: Spread, max_range: f64) -> Self {
        let (sin, cos) = libm::sincos(map_from_laser.yaw);
        let (origin, heading) = (map_from_laser.position, DVec2::new(cos, sin));
        let mut seen = Vec::new();
        for body in &obstacles.bodies {
            let (center, reach) = body.bounds();
            let offset = center - origin;
            let distance = offset.length();
            if distance - reach > max_range {
                continue;
            }
            let inside = body.contains(origin);
            if distance > reach && spread.beam_count > 1 {
                let offset = DVec2::new(cos, -sin).rotate(offset);
                let (bearing, half) = (libm::atan2(offset.y, offset.x), libm::asin(reach / distance) + MARGIN);
                // The same bearing a turn earlier and later, as beams may lie up to half a turn to either side.
                for turn in [-TAU, 0.0, TAU] {
                    let beams = spread.beams_within(bearing + turn - half, bearing + turn + half);
                    if beams.0 < beams.1 {
                        seen.push(Seen { body, inside, beams });
                    }
                }
            } else {
                seen.push(Seen { body, inside, beams: (0, spread.beam_count) });
            }
        }
        Self { origin, heading, max_range, seen }
    }

    /// Whether nothing is within reach.
    pub fn is_empty(&self) -> bool {
        self.seen.is_empty()
    }

    /// Shortens the ranges \[m\] of the beams from `first` on, whose directions in the scanner's frame are given, to the nearest
    /// obstacle; what is infinite stays so where there is none within the maximum.
    pub fn shorten(&self, first: usize, direction: impl Fn(usize) -> DVec2, ranges: &mut [f64]) {
        for seen in &self.seen {
            let (start, end) = (seen.beams.0.max(first), seen.beams.1.min(first + ranges.len()));
            for beam in start..end {
                let range = &mut ranges[beam - first];
                let distance = if seen.inside {
                    0.0
                } else {
                    seen.body.entry(self.origin, self.heading.rotate(direction(beam - first)))
                };
                if distance < range.min(self.max_range) {
                    *range = distance;
                }
            }
        }
    }
}

impl Spread {
    /// The first beam within two angles, and the one after the last.
    fn beams_within(self, low: f64, high: f64) -> (usize, usize) {
        // A float becomes the nearest integer it can: negative ones 0.
        let first = ((low - self.angle_min) / self.angle_increment).ceil() as usize;
        let past = ((high - self.angle_min) / self.angle_increment).floor() + 1.0;
        (first, (past as usize).min(self.beam_count))
    }
}
