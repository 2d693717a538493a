//! The obstacles that one scan can see, as the distance along each beam to the nearest of them.
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
//! Only beams between `bearing - half_angle` and `bearing + half_angle` are tested against the outline. A few more do no harm,
//! because they miss it. So both angles are approximations that are fast.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::body::disc_entry;
use super::squares::Circle;
use super::{Body, OBSTACLES, Obstacles};
use crate::beams::Beams;
use crate::error::Error;
use crate::memory;
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;

/// Extra angle \[rad\] on both sides of an obstacle, more than the error of [`bearing`].
const ANGLE_MARGIN: f64 = 2e-5;

/// The obstacles that a scan can see from one pose.
pub struct View {
    /// Distance \[m\] along each beam to the nearest obstacle; infinite for none within `max_range`. Empty if no beam can hit one.
    nearest: Vec<Group>,
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

impl View {
    /// Returns the obstacles within `max_range` of a laser at `map_from_laser`. Allocates only if there is at least one.
    ///
    /// The obstacle with the index `except` is left out. `beams` are `None` if they are not evenly spread in the plane; then
    /// each may hit each obstacle. `cos` and `sin` are those of their angles.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(
        (obstacles, except): (&Obstacles, Option<usize>),
        map_from_laser: Pose,
        beams: Option<Beams>,
        (cos, sin): (&[Group], &[Group]),
        beam_count: usize,
        max_range: f64,
    ) -> Result<Self, Error> {
        let (heading_sin, heading_cos) = libm::sincos(map_from_laser.yaw);
        let (origin, heading) = (map_from_laser.position, DVec2::new(heading_cos, heading_sin));
        let fan = beams.filter(|beams| beams.count() > 1);
        let mut nearest = Vec::new();
        let mut add = |outline: Outline<'_>, (start, end): (usize, usize)| {
            if nearest.is_empty() {
                nearest = memory::filled(OBSTACLES, [f64::INFINITY; GROUP], cos.len())?;
            }
            let directions = cos.as_flattened()[start..end].iter().zip(&sin.as_flattened()[start..end]);
            for (nearest, (&cos, &sin)) in nearest.as_flattened_mut()[start..end].iter_mut().zip(directions) {
                let direction = heading.rotate(DVec2::new(cos, sin));
                let distance = match outline {
                    Outline::Around => 0.0,
                    Outline::Disc(offset, radius) => disc_entry(offset, radius, direction),
                    Outline::Polygon(body) => body.entry(origin, direction),
                };
                *nearest = if distance < *nearest { distance } else { *nearest };
            }
            Ok(())
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
            if let Some(fan) = fan.filter(|_| distance > reach) {
                let offset = DVec2::new(heading_cos, -heading_sin).rotate(offset);
                let (bearing, half_angle) = (bearing(offset), half_angle(reach / distance) + ANGLE_MARGIN);
                for beams in fan.within(bearing - half_angle, bearing + half_angle) {
                    add(outline, beams)?;
                }
            } else {
                add(outline, (0, beam_count))?;
            }
        }
        for distance in nearest.as_flattened_mut() {
            *distance = if *distance < max_range { *distance } else { f64::INFINITY };
        }
        Ok(Self { nearest })
    }

    /// Returns true if the scan can see no obstacle.
    pub fn is_empty(&self) -> bool {
        self.nearest.is_empty()
    }

    /// Replaces each range \[m\] of a group of beams, which is infinite for no return, by the distance to the nearest obstacle,
    /// if that is shorter than the range and `max_range`.
    #[inline(always)]
    pub fn shorten(&self, group: usize, ranges: &mut Group) {
        // A tilted scanner has a view also where it sees no obstacle.
        let Some(nearest) = self.nearest.get(group) else { return };
        for (range, &distance) in ranges.iter_mut().zip(nearest) {
            *range = if distance < *range { distance } else { *range };
        }
    }
}

/// Returns the angle of a vector \[rad\], in [-π, π], to within 1.2e-5 (Abramowitz and Stegun, *Handbook of Mathematical Functions*,
/// 4.4.47). The vector must not be zero.
#[inline(always)]
fn bearing(DVec2 { x, y }: DVec2) -> f64 {
    let (across, along) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
    let slope = across / along;
    let square = slope * slope;
    let angle =
        slope * ((((0.020_835_1 * square - 0.085_133) * square + 0.180_141) * square - 0.330_299_5) * square + 0.999_866);
    let angle = if x.abs() < y.abs() { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

/// Returns an angle that is at least the arc sine of a number in [0, 1], and at most 0.2 rad more \[rad\].
#[inline(always)]
fn half_angle(sine: f64) -> f64 {
    // (asin(x) - x) / x³ increases with x.
    sine + (FRAC_PI_2 - 1.0) * sine * sine * sine
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::beams::BeamLayout;
    use crate::random;
    use crate::shape::Shape;

    #[test]
    fn the_fast_angles_are_within_their_bounds() {
        for step in 0..100_000 {
            let angle = (f64::from(step) / 50_000.0 - 1.0) * PI;
            let (sin, cos) = libm::sincos(angle);
            let error = libm::remainder(bearing(DVec2::new(cos, sin) * 7.0) - angle, 2.0 * PI);
            assert!(error.abs() < 1.2e-5 && 1.2e-5 < ANGLE_MARGIN, "{angle}: {error}");
            let sine = f64::from(step) / 99_999.0;
            let excess = half_angle(sine) - libm::asin(sine);
            assert!((-1e-9..0.2).contains(&excess), "{sine}: {excess}");
        }
    }

    #[test]
    fn a_view_is_the_same_as_if_each_beam_were_tested_against_each_obstacle() {
        let mut stream = random::stream(8, 0);
        let shapes = [Shape::disc(0.2), Shape::disc(1.5), Shape::rectangle(0.6, 0.4), Shape::rectangle(4.0, 0.1)];
        let shapes = shapes.map(|shape| shape.expect("a good shape"));
        let layouts = [
            BeamLayout::Fov(2.0 * PI),
            BeamLayout::Fov(4.71),
            BeamLayout::Fov(1e-3),
            BeamLayout::Ends { angle_min: 6.0, angle_max: -0.2 },
            BeamLayout::Ends { angle_min: -6.2, angle_max: -1.0 },
        ];
        let mut met = 0;
        for round in 0..300 {
            let count = [2, 541, 20_000][round / 5 % 3];
            let beams = Beams::new(layouts[round % 5], count).expect("good beams");
            let (mut cos, mut sin) = (vec![[1.0; GROUP]; count.div_ceil(GROUP)], vec![[0.0; GROUP]; count.div_ceil(GROUP)]);
            for beam in 0..count {
                let direction = libm::sincos(beams.angle(beam));
                (sin.as_flattened_mut()[beam], cos.as_flattened_mut()[beam]) = direction;
            }
            let mut pose = || {
                let [x, y, yaw] = [(); 3].map(|()| stream.random_range(-9.0..9.0));
                Pose::new(x, y, yaw)
            };
            let placed: Vec<(&Shape, Pose)> = (0..70).map(|index| (&shapes[index % 4], pose())).collect();
            let (obstacles, laser) = (Obstacles::new(placed).expect("good poses"), pose());
            let view = |beams| View::new((&obstacles, Some(3)), laser, beams, (&cos, &sin), count, 8.0).expect("memory");
            let bits = |view: View| view.nearest.into_flattened().into_iter().map(f64::to_bits).collect::<Vec<_>>();
            let (found, expected) = (bits(view(Some(beams))), bits(view(None)));
            // Without an obstacle in sight, there is no view.
            assert!(
                found == expected || found.is_empty() && expected.iter().all(|&bits| f64::from_bits(bits).is_infinite())
            );
            met += found.iter().filter(|&&bits| f64::from_bits(bits).is_finite()).count();
        }
        assert!(met > 500_000, "{met}");
    }
}
