//! Shapes of robots and of things that stand in their way: discs and simple polygons.

use glam::DVec2;

use crate::error::{Error, check_number};

/// The largest radius of a disc and the largest coordinate of a corner \[m\].
pub const MAX_EXTENT: f64 = 1e6;

/// The largest number of corners.
pub const MAX_CORNERS: usize = 1000;

/// A shape in its own frame, whose origin is what a pose places: a disc around it, or a polygon anywhere about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Counter-clockwise; for a disc nothing but its centre, the origin.
    corners: Vec<DVec2>,
    /// Of a disc, else 0.
    radius: f64,
}

impl Shape {
    /// The disc of `radius` metres around the origin.
    ///
    /// # Errors
    /// A radius that is not positive, or more than [`MAX_EXTENT`].
    pub fn disc(radius: f64) -> Result<Self, Error> {
        Ok(Self { corners: vec![DVec2::ZERO], radius: extent("radius", radius)? })
    }

    /// The rectangle around the origin, `length` metres along x and `width` along y.
    ///
    /// # Errors
    /// A side that is not positive, or more than [`MAX_EXTENT`].
    pub fn rectangle(length: f64, width: f64) -> Result<Self, Error> {
        let half = 0.5 * DVec2::new(extent("length", length)?, extent("width", width)?);
        let corners = vec![-half, DVec2::new(half.x, -half.y), half, DVec2::new(-half.x, half.y)];
        Ok(Self { corners, radius: 0.0 })
    }

    /// The polygon with these corners, either way round, convex or not; the last is joined to the first.
    ///
    /// # Errors
    /// Fewer than 3 corners or more than [`MAX_CORNERS`], coordinates that are not finite or beyond [`MAX_EXTENT`], a corner
    /// repeated at once, edges that meet elsewhere than at the corner they share.
    pub fn polygon(corners: &[[f64; 2]]) -> Result<Self, Error> {
        if !(3..=MAX_CORNERS).contains(&corners.len()) {
            return Err(Error::Count { name: "the number of corners", value: corners.len(), needed: "in 3..1000" });
        }
        let within = |corner: &[f64; 2]| corner.iter().all(|number| number.abs() <= MAX_EXTENT);
        if let Some(row) = corners.iter().position(|corner| !within(corner)) {
            return Err(Error::Corner { row, value: corners[row] });
        }
        let mut corners: Vec<DVec2> = corners.iter().copied().map(DVec2::from).collect();
        check_simple(&corners)?;
        if doubled_area(&corners) < 0.0 {
            corners.reverse();
        }
        Ok(Self { corners, radius: 0.0 })
    }

    /// The radius, if this is a disc.
    #[must_use]
    pub fn radius(&self) -> Option<f64> {
        self.is_disc().then_some(self.radius)
    }

    /// Corners \[m\], counter-clockwise; none of a disc.
    #[must_use]
    pub fn corners(&self) -> &[DVec2] {
        if self.is_disc() { &[] } else { &self.corners }
    }

    /// Distance \[m\] from the origin to the farthest point.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.corners.iter().map(|corner| corner.length()).fold(self.radius, f64::max)
    }

    /// Area \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        if self.is_disc() { std::f64::consts::PI * self.radius * self.radius } else { 0.5 * doubled_area(&self.corners) }
    }

    /// A skeleton and how far the shape reaches around it: the outline of a polygon and 0, or a disc's centre and radius.
    pub(crate) fn skeleton(&self) -> (&[DVec2], f64) {
        (&self.corners, self.radius)
    }

    fn is_disc(&self) -> bool {
        self.radius > 0.0
    }
}

fn extent(name: &'static str, value: f64) -> Result<f64, Error> {
    check_number(name, value, "positive and at most 1e6", |value| value > 0.0 && value <= MAX_EXTENT)
}

/// Twice the area, by the shoelace formula; negative for corners that go round clockwise.
fn doubled_area(corners: &[DVec2]) -> f64 {
    edges(corners).map(|(start, end)| (start - corners[0]).perp_dot(end - corners[0])).sum()
}

/// Start and end of each edge; of a single point, that point twice.
pub(crate) fn edges(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + Clone {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

/// Whether a point lies inside of a polygon (either way round); on its edges, rounding decides.
pub(crate) fn encloses(corners: &[DVec2], point: DVec2) -> bool {
    // Crossings of a ray along x; a corner counts with the edge that comes from below, so that none is missed or counted twice.
    let crosses = |&(start, end): &(DVec2, DVec2)| {
        let rises = start.y <= point.y && end.y > point.y;
        let falls = end.y <= point.y && start.y > point.y;
        let side = (end - start).perp_dot(point - start);
        (rises && side > 0.0) || (falls && side < 0.0)
    };
    edges(corners).filter(crosses).count() % 2 == 1
}

/// Checks that edges meet at the corners they share and nowhere else: every pair of them, which is quick enough for shapes.
fn check_simple(corners: &[DVec2]) -> Result<(), Error> {
    let count = corners.len();
    let edge = |index: usize| (corners[index], corners[(index + 1) % count]);
    if let Some(row) = (0..count).find(|&index| edge(index).0 == edge(index).1) {
        return Err(Error::RepeatedCorner { row, next: (row + 1) % count });
    }
    for first in 0..count {
        for second in first + 1..count {
            let (a, b) = (edge(first), edge(second));
            let meet = if second == first + 1 {
                folds(a, b)
            } else if (second + 1) % count == first {
                folds(b, a)
            } else {
                intersect(a, b)
            };
            if meet {
                return Err(Error::Edges { first, second });
            }
        }
    }
    Ok(())
}

/// Whether the second of two edges in a row goes back over the first.
fn folds(first: (DVec2, DVec2), second: (DVec2, DVec2)) -> bool {
    let (before, after) = (first.1 - first.0, second.1 - second.0);
    before.perp_dot(after) == 0.0 && before.dot(after) < 0.0
}

/// Whether two segments share a point.
pub(crate) fn intersect(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> bool {
    let side = |edge: (DVec2, DVec2), point: DVec2| {
        let side = (edge.1 - edge.0).perp_dot(point - edge.0);
        if side == 0.0 { 0.0 } else { side.signum() }
    };
    let spans = |edge: (DVec2, DVec2), point: DVec2| {
        let (low, high) = (edge.0.min(edge.1), edge.0.max(edge.1));
        low.cmple(point).all() && point.cmple(high).all()
    };
    let sides = [side(a, b.0), side(a, b.1), side(b, a.0), side(b, a.1)];
    (sides[0] * sides[1] < 0.0 && sides[2] * sides[3] < 0.0)
        || (sides[0] == 0.0 && spans(a, b.0))
        || (sides[1] == 0.0 && spans(a, b.1))
        || (sides[2] == 0.0 && spans(b, a.0))
        || (sides[3] == 0.0 && spans(b, a.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L of three unit squares.
    const ANGLE: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

    fn error(corners: &[[f64; 2]]) -> String {
        Shape::polygon(corners).unwrap_err().to_string()
    }

    #[test]
    fn shapes_have_the_extent_they_were_given() {
        let disc = Shape::disc(0.5).unwrap();
        assert_eq!((disc.radius(), disc.reach(), disc.corners().len()), (Some(0.5), 0.5, 0));
        let box_ = Shape::rectangle(4.0, 3.0).unwrap();
        assert_eq!((box_.radius(), box_.reach(), box_.area()), (None, 2.5, 12.0));
        assert_eq!(Shape::polygon(&ANGLE).unwrap().area(), 3.0);
    }

    #[test]
    fn corners_go_round_counter_clockwise_whichever_way_they_came() {
        let mut turned = ANGLE;
        turned.reverse();
        let shape = Shape::polygon(&turned).unwrap();
        assert_eq!(shape.area(), 3.0);
        assert!(ANGLE.iter().all(|&corner| shape.corners().contains(&corner.into())));
    }

    #[test]
    fn points_are_inside_or_not() {
        let shape = Shape::polygon(&ANGLE).unwrap();
        let inside = |x, y| encloses(shape.corners(), DVec2::new(x, y));
        assert!(inside(0.5, 0.5) && inside(0.5, 1.0) && inside(1.5, 0.5) && inside(0.5, 1.9));
        assert!(!inside(1.5, 1.5) && !inside(-0.1, 1.0) && !inside(1.1, 1.0) && !inside(3.0, 2.0));
    }

    #[test]
    fn bad_shapes_are_refused_by_name() {
        let message = |shape: Result<Shape, Error>| shape.unwrap_err().to_string();
        assert_eq!(message(Shape::disc(0.0)), "radius must be positive and at most 1e6, got 0");
        assert_eq!(message(Shape::rectangle(1.0, f64::NAN)), "width must be positive and at most 1e6, got NaN");
        assert_eq!(error(&ANGLE[..2]), "the number of corners must be in 3..1000, got 2");
        assert_eq!(
            error(&[[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]]),
            "a corner must be finite and within 1e6 of the origin, got [1.0, NaN] in row 1"
        );
        assert_eq!(
            error(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
            "corners must differ, got the same in rows 1 and 2"
        );
        assert_eq!(
            error(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]),
            "corners must differ, got the same in rows 3 and 0"
        );
    }

    #[test]
    fn polygons_that_are_not_simple_are_refused() {
        let crossing = "edges must meet only at the corners they share, got edges 0 and 2 that meet elsewhere";
        assert_eq!(error(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), crossing);
        // A corner on another edge, a spike, and no area at all.
        assert!(error(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]).starts_with("edges must meet"));
        assert!(error(&[[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).starts_with("edges must meet"));
        assert!(error(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]).starts_with("edges must meet"));
        assert!(Shape::polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]]).is_ok());
    }
}
