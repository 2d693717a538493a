//! The footprint of a beam: what returns if it meets an edge.

/// A beam that is spread over an angle. Its light is even over the angle, in the plane of the scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// The whole angle \[rad\].
    pub divergence: f64,
    /// Smallest difference between the ranges at an edge \[m\].
    pub edge_depth: f64,
    /// Largest difference of two ranges that are mixed \[m\].
    pub mixing_length: f64,
}

impl Footprint {
    /// Returns true if a beam with these ranges \[m\] at its right end, in its middle and at its left end meets an edge.
    ///
    /// Along a straight wall, one over the range is linear in the angle, for a small angle.
    #[inline(always)]
    pub fn is_at_edge(&self, [right, middle, left]: [f64; 3]) -> bool {
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        // NaN if nothing has a return.
        let depth = most(most(right, left), middle) - least(least(right, left), middle);
        let (right, middle, left) = (1.0 / right, 1.0 / middle, 1.0 / left);
        (depth > self.edge_depth) & ((middle - right - (left - middle)).abs() > 0.5 * (left - right).abs())
    }

    /// Returns the angle \[rad\] to the middle of the beam of a place from 0, its right end, to 1.
    pub fn angle(&self, place: f64) -> f64 {
        (place - 0.5) * self.divergence
    }

    /// Returns the range \[m\] of a beam at an edge, from the ranges at the two places that are drawn: infinite without a return.
    pub fn range(&self, [first, second]: [f64; 2], mix: f64) -> f64 {
        // Without a return, the difference is infinite or NaN.
        if (second - first).abs() <= self.mixing_length { first + (second - first) * mix } else { first }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const FOOTPRINT: Footprint = Footprint { divergence: 0.01, edge_depth: 0.1, mixing_length: 0.5 };

    #[test]
    fn straight_walls_have_no_edges() {
        for incidence in [0.0, 0.5, 1.0, 1.4, 1.5, 1.56] {
            for distance in [0.2, 1.0, 10.0] {
                let range = |angle: f64| {
                    let incidence = incidence + angle;
                    if incidence < FRAC_PI_2 { distance / libm::cos(incidence) } else { f64::INFINITY }
                };
                let ranges = [0.0, 0.5, 1.0].map(|place| range(FOOTPRINT.angle(place)));
                assert!(!FOOTPRINT.is_at_edge(ranges), "{incidence} {distance} {ranges:?}");
            }
        }
    }

    #[test]
    fn steps_are_edges_if_they_are_deep_enough() {
        let none = f64::INFINITY;
        for ranges in
            [[1.0, 1.0, 1.2], [1.0, 1.2, 1.2], [3.0, 1.0, 3.0], [1.0, 3.0, 1.0], [2.0, 2.0, none], [none, 1.0, none]]
        {
            let [right, middle, left] = ranges;
            assert!(FOOTPRINT.is_at_edge(ranges) && FOOTPRINT.is_at_edge([left, middle, right]), "{ranges:?}");
        }
        for ranges in [[1.0, 1.0, 1.09], [1.0; 3], [0.0; 3], [none; 3], [1.0, 1.05, 1.0]] {
            assert!(!FOOTPRINT.is_at_edge(ranges), "{ranges:?}");
        }
    }

    #[test]
    fn only_ranges_that_are_near_each_other_are_mixed() {
        let range = |ranges| FOOTPRINT.range(ranges, 0.25);
        assert_eq!([range([2.0, 2.4]), range([2.4, 2.0]), range([2.0, 2.6])], [2.1, 2.3, 2.0]);
        let none = f64::INFINITY;
        assert_eq!([range([2.0, none]), range([none, 2.0]), range([none, none])], [2.0, none, none]);
    }
}
