//! Beams: the angles of a scanner's beams in its own frame. They are defined here and nowhere else.

use std::f64::consts::TAU;

use crate::error::{Error, check_number};

/// Largest number of beams of a scanner.
pub const MAX_BEAMS: usize = 1_000_000;

/// A field within this of 2π \[rad\] counts as a full turn.
///
/// Drivers and configuration files round: 6.2832 exceeds 2π by 1.5e-5, from -3.1416 to 3.1416 as well; 6.28318 and ±3.14159
/// lack 5e-6. A field that ends one increment before the full turn is not one, for up to 314000 beams.
pub const FULL_TURN_TOLERANCE: f64 = 2e-5;

/// How the angles of the beams are given. All angles are in the laser frame \[rad\], counter-clockwise from its x axis.
///
/// | layout | field | `angle_min` | `angle_increment` |
/// |---|---|---|---|
/// | [`Fov`](Self::Fov) | less than a full turn | `-fov / 2` | `fov / (beam_count - 1)`: a beam at both ends |
/// | | full turn (2π ± 2e-5) | `-fov / 2` | `fov / beam_count`: both ends are one direction, with one beam |
/// | | any, with a single beam | 0 | 0 |
/// | [`Ends`](Self::Ends) | less than a full turn | as given | `(angle_max - angle_min) / (beam_count - 1)` |
/// | | full turn (2π ± 2e-5) | as given | `(angle_max - angle_min) / beam_count` |
/// | | any, with a single beam | the middle | 0 |
/// | [`Steps`](Self::Steps) | at most a full turn | as given | as given; 0 with a single beam |
///
/// A negative increment turns clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BeamLayout {
    /// A field of view in (0, 2π], centred on the x axis.
    Fov(f64),
    /// A field from one angle to another. If `angle_max` is the smaller one, the beams turn clockwise.
    Ends {
        /// Angle of beam 0.
        angle_min: f64,
        /// Angle of the last beam; in a full turn, the angle at which the turn is complete.
        angle_max: f64,
    },
    /// Steps from one beam to the next.
    Steps {
        /// Angle of beam 0.
        angle_min: f64,
        /// Angle from one beam to the next. If it is negative, the beams turn clockwise.
        angle_increment: f64,
    },
}

/// Angles of the beams of a scanner in the laser frame.
///
/// They lie at `low + k · step`, with `k = i` for beam `i`, or `k = gaps - i` if the beams turn clockwise. So a clockwise
/// scan is a counter-clockwise one in reverse, to the last bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beams {
    /// Smallest angle of the field \[rad\].
    low: f64,
    /// Largest angle of the field \[rad\].
    high: f64,
    /// Angle between neighbouring beams \[rad\], not negative; 0 if there is only one beam.
    step: f64,
    /// Number of steps from one end of the field to the other: `count - 1`, or `count` in a full turn.
    gaps: usize,
    count: usize,
    is_clockwise: bool,
}

impl Beams {
    /// Returns `count` beams with this layout.
    ///
    /// # Errors
    /// - [`Error::Count`]: `count` is 0 or more than [`MAX_BEAMS`].
    /// - [`Error::Degrees`], [`Error::Number`]: a number looks like degrees, is not finite or out of range.
    /// - [`Error::Angles`], [`Error::Steps`]: the beams have no field, or turn by more than a full turn.
    pub(crate) fn new(layout: BeamLayout, count: usize) -> Result<Self, Error> {
        let ends = match layout {
            BeamLayout::Fov(fov) => {
                check_angle("fov", "in (0, 2π] radians", fov, |fov| fov > 0.0)?;
                (-0.5 * fov, 0.5 * fov)
            }
            BeamLayout::Ends { angle_min, angle_max } => {
                check_angle("angle_min", WITHIN_A_TURN, angle_min, |_| true)?;
                check_angle("angle_max", WITHIN_A_TURN, angle_max, |_| true)?;
                (angle_min, angle_max)
            }
            BeamLayout::Steps { angle_min, angle_increment } => {
                check_angle("angle_min", WITHIN_A_TURN, angle_min, |_| true)?;
                check_angle("angle_increment", WITHIN_A_TURN, angle_increment, |_| true)?;
                (angle_min, angle_min + angle_increment * count.saturating_sub(1) as f64)
            }
        };
        if !(1..=MAX_BEAMS).contains(&count) {
            return Err(Error::Count { name: "beam_count", value: count, needed: "in 1..1000000" });
        }
        let is_clockwise = ends.1 < ends.0;
        let (low, high) = if is_clockwise { (ends.1, ends.0) } else { ends };
        let field = if let BeamLayout::Fov(fov) = layout { fov } else { high - low };
        if count == 1 {
            let angle = if let BeamLayout::Steps { angle_min, .. } = layout { angle_min } else { low.midpoint(high) };
            return Ok(Self { low: angle, high: angle, step: 0.0, gaps: 0, count, is_clockwise: false });
        }
        let (gaps, step) = match layout {
            BeamLayout::Steps { angle_increment, .. } => (count - 1, angle_increment.abs()),
            _ if (field - TAU).abs() <= FULL_TURN_TOLERANCE => (count, field / count as f64),
            _ => (count - 1, field / (count - 1) as f64),
        };
        if step == 0.0 || field > TAU + FULL_TURN_TOLERANCE {
            return Err(match layout {
                BeamLayout::Steps { angle_increment, .. } => Error::Steps { angle_increment, beam_count: count },
                _ => Error::Angles { angle_min: ends.0, angle_max: ends.1 },
            });
        }
        Ok(Self { low, high, step, gaps, count, is_clockwise })
    }

    /// Returns the beams of a scanner that looks up from below: beam `i` points at minus its angle.
    pub(crate) fn mirrored(self) -> Self {
        Self { low: -self.high, high: -self.low, is_clockwise: !self.is_clockwise, ..self }
    }

    /// Returns the angle of beam 0 \[rad\].
    pub(crate) fn angle_min(&self) -> f64 {
        self.angle(0)
    }

    /// Returns the angle from one beam to the next \[rad\]: negative if they turn clockwise, 0 if there is only one.
    pub(crate) fn angle_increment(&self) -> f64 {
        if self.is_clockwise { -self.step } else { self.step }
    }

    /// Returns the size of the field \[rad\], from one end to the other.
    pub(crate) fn field(&self) -> f64 {
        self.high - self.low
    }

    /// Returns the number of steps from one end of the field to the other: one more than between the beams in a full turn.
    pub(crate) fn gaps(&self) -> usize {
        self.gaps
    }

    /// Returns the number of beams.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Returns the angle of a beam \[rad\].
    pub(crate) fn angle(&self, beam: usize) -> f64 {
        let steps = if self.is_clockwise { self.gaps - beam } else { beam };
        self.low + steps as f64 * self.step
    }

    /// Returns the beams, as a first one and one past the last, that point at angles from `low` to `high` \[rad\] or at
    /// angles that are whole turns away from these. Both must be nearer to 0 than a turn. Rounding decides about beams that
    /// point exactly there. There must be more than one beam.
    #[inline]
    pub(crate) fn within(self, low: f64, high: f64) -> impl Iterator<Item = (usize, usize)> {
        let (first, per_radian) = (self.angle(0), self.angle_increment().recip());
        let (one, other) = ((low - first) * per_radian, (high - first) * per_radian);
        // No beam is farther than a turn from angle 0.
        [-TAU, 0.0, TAU].into_iter().filter_map(move |turn| {
            let turn = turn * per_radian;
            // `as usize` rounds down, and saturates: negative values become 0.
            let start = (one.min(other) + turn + 1.0) as usize;
            let end = ((one.max(other) + turn + 1.0) as usize).min(self.count);
            (start < end).then_some((start, end))
        })
    }
}

/// Domain of an angle of a beam.
const WITHIN_A_TURN: &str = "in [-2π, 2π] radians";

/// Checks that an angle is at most a full turn, and that `is_valid` is true for it.
fn check_angle(name: &'static str, needed: &'static str, angle: f64, is_valid: impl Fn(f64) -> bool) -> Result<(), Error> {
    if angle.abs() > TAU + 1.0 && angle.abs() <= 360.0 && is_valid(angle) {
        return Err(Error::Degrees { name, value: angle, needed });
    }
    check_number(name, angle, needed, |angle| angle.abs() <= TAU + FULL_TURN_TOLERANCE && is_valid(angle)).map(|_| ())
}

#[cfg(test)]
#[allow(clippy::approx_constant, reason = "drivers round them")]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn beams(layout: BeamLayout, count: usize) -> Beams {
        Beams::new(layout, count).expect("good beams")
    }

    #[test]
    fn what_drivers_state_for_a_full_turn_is_one() {
        for fov in [TAU, 6.28319, 6.2832, 6.283_185, 6.28318, 2.0 * 3.14159, 2.0 * 3.1416, f64::from(6.283_185_5_f32)] {
            let (half, turn) = (0.5 * fov, fov / 360.0);
            let shown = |layout| (beams(layout, 360).angle_min(), beams(layout, 360).angle_increment());
            assert_eq!(shown(BeamLayout::Fov(fov)), (-half, turn));
            for (low, high) in [(-half, half), (0.0, fov), (-fov, 0.0)] {
                assert_eq!(shown(BeamLayout::Ends { angle_min: low, angle_max: high }), (low, turn));
                let (first, step) = shown(BeamLayout::Ends { angle_min: high, angle_max: low });
                assert!((first - high).abs() < 1e-14 && step == -turn, "{first} {step}");
            }
        }
    }

    #[test]
    fn clockwise_beams_are_those_of_the_other_direction_in_reverse() {
        for (low, high, count) in [(-1.0, 2.0, 541), (0.1, 0.3, 7), (-6.0, 0.0, 1000), (-0.7, 0.7, 2)] {
            let up = beams(BeamLayout::Ends { angle_min: low, angle_max: high }, count);
            let down = beams(BeamLayout::Ends { angle_min: high, angle_max: low }, count);
            assert!((0..count).all(|beam| down.angle(beam) == up.angle(count - 1 - beam)), "{low} to {high}");
            let step = up.angle_increment();
            let down = beams(BeamLayout::Steps { angle_min: high, angle_increment: -step }, count);
            assert!((0..count).all(|beam| (down.angle(beam) - up.angle(count - 1 - beam)).abs() < 1e-14));
        }
    }

    #[test]
    fn mirrored_beams_point_at_the_opposite_angles() {
        for (angle_min, angle_max) in [(-1.0, 2.0), (-PI, PI), (0.0, TAU), (2.0, -1.0), (PI, -PI)] {
            for count in [2, 360, 541] {
                let (all, steps) =
                    (beams(BeamLayout::Ends { angle_min, angle_max }, count), (angle_max - angle_min).signum());
                let mirrored = all.mirrored();
                assert!((0..count).all(|beam| (mirrored.angle(beam) + all.angle(beam)).abs() < 1e-14), "{angle_min}");
                assert_eq!(mirrored.angle_increment().signum(), -steps);
                assert_eq!(mirrored.mirrored(), all);
            }
        }
        let level = beams(BeamLayout::Fov(4.71), 541);
        assert!((0..541).all(|beam| level.mirrored().angle(beam) == level.angle(540 - beam)));
    }

    #[test]
    fn a_field_that_lacks_one_increment_is_not_a_full_turn() {
        for count in [2, 360, 36_000, 300_000] {
            let field = TAU * (1.0 - 1.0 / count as f64);
            let all = beams(BeamLayout::Ends { angle_min: 0.0, angle_max: field }, count);
            assert!((all.angle(count - 1) - field).abs() < 1e-14, "{count}");
        }
        assert_eq!(beams(BeamLayout::Fov(6.283), 360).angle_increment(), 6.283 / 359.0);
        assert_eq!(beams(BeamLayout::Fov(6.28), 360).angle_increment(), 6.28 / 359.0);
    }

    #[test]
    fn a_single_beam_points_at_the_middle_of_the_field() {
        let single = |layout| (beams(layout, 1).angle_min(), beams(layout, 1).angle_increment());
        assert_eq!(single(BeamLayout::Fov(3.0)), (0.0, 0.0));
        assert_eq!(single(BeamLayout::Ends { angle_min: 1.0, angle_max: 2.0 }), (1.5, 0.0));
        assert_eq!(single(BeamLayout::Ends { angle_min: 1.0, angle_max: 1.0 }), (1.0, 0.0));
        assert_eq!(single(BeamLayout::Steps { angle_min: 1.0, angle_increment: -0.5 }), (1.0, 0.0));
    }

    #[test]
    fn programs_count_the_beams_of_every_layout() {
        let angles = [-TAU, -4.0, -PI, -1.0, 0.0, 0.5, PI, 5.0, TAU];
        for (angle_min, angle_max) in angles.iter().flat_map(|&low| angles.map(|high| (low, high))) {
            for count in [2, 3, 360, 541, 1081] {
                let Ok(all) = Beams::new(BeamLayout::Ends { angle_min, angle_max }, count) else { continue };
                let span = all.angle(count - 1) - all.angle_min();
                assert_eq!((span / all.angle_increment()).round() as usize + 1, count, "{angle_min} to {angle_max}");
                assert!(span.abs() < TAU, "a beam is repeated");
            }
        }
    }

    #[test]
    fn all_beams_within_an_interval_are_found() {
        for (angle_min, angle_max) in [(-PI, PI), (0.0, TAU), (TAU, 0.0), (-TAU, 0.0), (1.0, 1.5), (5.0, -0.5), (-6.0, -2.0)]
        {
            let all = beams(BeamLayout::Ends { angle_min, angle_max }, 97);
            for step in -40..40 {
                let (center, half) = (f64::from(step) * 0.1003, 0.05 + 0.019 * f64::from(step).abs());
                let found: Vec<usize> = all.within(center - half, center + half).flat_map(|(from, to)| from..to).collect();
                let expected = (0..97).filter(|&beam| libm::remainder(all.angle(beam) - center, TAU).abs() <= half);
                let mut sorted = found.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, expected.collect::<Vec<_>>(), "{angle_min} to {angle_max} around {center}");
            }
        }
    }

    #[test]
    fn the_error_names_the_bad_number() {
        let error = |layout, count| Beams::new(layout, count).unwrap_err().to_string();
        let ends = |angle_min, angle_max| error(BeamLayout::Ends { angle_min, angle_max }, 5);
        let steps = |angle_min, angle_increment| error(BeamLayout::Steps { angle_min, angle_increment }, 5);
        assert_eq!(ends(-7.0, 0.0), "angle_min must be in [-2π, 2π] radians, got -7");
        assert_eq!(ends(-135.0, 135.0), "angle_min must be in [-2π, 2π] radians, got -135; -135° is -2.3562 rad");
        assert_eq!(ends(0.0, f64::NAN), "angle_max must be in [-2π, 2π] radians, got NaN");
        assert_eq!(ends(1.0, 1.0), "angle_max must differ from angle_min by at most 2π, got 1 and 1");
        assert_eq!(ends(-4.0, 4.0), "angle_max must differ from angle_min by at most 2π, got 4 and -4");
        let needed = "angle_increment must be other than 0, and turn all beams by at most 2π";
        assert_eq!(steps(0.0, 0.0), format!("{needed}, got 0 for 5 beams"));
        assert_eq!(steps(0.0, -2.0), format!("{needed}, got -2 for 5 beams"));
        assert_eq!(steps(0.0, 10.0), "angle_increment must be in [-2π, 2π] radians, got 10; 10° is 0.1745 rad");
        assert_eq!(error(BeamLayout::Fov(-1.0), 5), "fov must be in (0, 2π] radians, got -1");
        assert_eq!(error(BeamLayout::Fov(270.0), 5), "fov must be in (0, 2π] radians, got 270; 270° is 4.7124 rad");
        assert_eq!(error(BeamLayout::Fov(1.0), 0), "beam_count must be in 1..1000000, got 0");
    }
}
