//! Shapes of footprints and obstacles: discs and simple polygons.

use glam::DVec2;

use crate::error::{Error, check_number};
use crate::surface::Material;

/// Largest radius of a disc, side of a rectangle and absolute coordinate of a polygon's corner \[m\].
pub const MAX_EXTENT: f64 = 1e6;

/// Largest number of corners of a polygon.
pub const MAX_CORNERS: usize = 1000;

/// A disc centred at the origin of the shape's own frame, or a simple polygon in that frame.
///
/// A [`Pose`](crate::Pose) places the shape: it gives the position and yaw of the shape's frame in the map frame. A polygon
/// does not have to contain the origin.
///
/// ```
/// use mobile_robot_simulator::Shape;
///
/// let robot = Shape::rectangle(0.8, 0.6)?;
/// assert_eq!(robot.corners().len(), 4);
/// assert_eq!(robot.reach(), 0.5); // half of the diagonal: 0.4² + 0.3² = 0.5²
/// assert_eq!(Shape::disc(0.3)?.radius(), Some(0.3));
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Corners of a polygon, counter-clockwise. A disc has one entry, its centre at the origin.
    corners: Vec<DVec2>,
    /// Radius of a disc, 0 for a polygon.
    radius: f64,
    material: Material,
}

impl Shape {
    /// Returns the disc of `radius` \[m\] centred at the origin.
    ///
    /// # Errors
    /// [`Error::Number`] if the radius is not in (0, [`MAX_EXTENT`]].
    pub fn disc(radius: f64) -> Result<Self, Error> {
        Ok(Self { corners: vec![DVec2::ZERO], radius: extent("radius", radius)?, material: Material::WALL })
    }

    /// Returns the rectangle centred at the origin, with sides `length` along x and `width` along y \[m\].
    ///
    /// # Errors
    /// [`Error::Number`] if a side is not in (0, [`MAX_EXTENT`]].
    pub fn rectangle(length: f64, width: f64) -> Result<Self, Error> {
        let half = 0.5 * DVec2::new(extent("length", length)?, extent("width", width)?);
        let corners = vec![-half, DVec2::new(half.x, -half.y), half, DVec2::new(-half.x, half.y)];
        Ok(Self { corners, radius: 0.0, material: Material::WALL })
    }

    /// Returns the polygon with the given corners `[x, y]` \[m\]; an edge joins the last corner to the first.
    ///
    /// The polygon must be simple: its edges may not cross or touch. It may be concave, and its corners may be in clockwise
    /// or counter-clockwise order.
    ///
    /// ```
    /// use mobile_robot_simulator::Shape;
    ///
    /// let triangle = Shape::polygon(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])?;
    /// assert_eq!(triangle.area(), 6.0);
    /// assert!(Shape::polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).is_err()); // edges 0 and 2 cross
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Count`]: fewer than 3 corners, or more than [`MAX_CORNERS`].
    /// - [`Error::Corner`]: a coordinate is not finite, or larger than [`MAX_EXTENT`] in absolute value.
    /// - [`Error::RepeatedCorner`]: two successive corners are equal.
    /// - [`Error::Edges`]: two edges share a point other than a common corner.
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
        Ok(Self { corners, radius: 0.0, material: Material::WALL })
    }

    /// Returns the same shape of another material.
    ///
    /// # Errors
    /// Those of [`Material::checked`].
    pub fn with_material(self, material: Material) -> Result<Self, Error> {
        Ok(Self { material: material.checked()?, ..self })
    }

    /// Returns what the shape is made of: [`Material::WALL`] if nothing else was given.
    #[must_use]
    pub fn material(&self) -> Material {
        self.material
    }

    /// Returns the radius of a disc \[m\], `None` for a polygon.
    #[must_use]
    pub fn radius(&self) -> Option<f64> {
        self.is_disc().then_some(self.radius)
    }

    /// Returns the corners of a polygon \[m\] in counter-clockwise order; an empty slice for a disc.
    #[must_use]
    pub fn corners(&self) -> &[DVec2] {
        if self.is_disc() { &[] } else { &self.corners }
    }

    /// Returns the distance \[m\] from the origin to the farthest point of the shape.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.corners.iter().map(|corner| corner.length()).fold(self.radius, f64::max)
    }

    /// Returns the area \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        if self.is_disc() { std::f64::consts::PI * self.radius * self.radius } else { 0.5 * doubled_area(&self.corners) }
    }

    /// Returns a skeleton and the radius by which the shape extends around it.
    ///
    /// For a polygon: its corners and 0. For a disc: its centre and its radius.
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

/// Returns twice the signed area by the shoelace formula: positive if the corners are in counter-clockwise order.
fn doubled_area(corners: &[DVec2]) -> f64 {
    edges(corners).map(|(start, end)| (start - corners[0]).perp_dot(end - corners[0])).sum()
}

/// Iterates over the edges as (start, end). A single point gives one edge, which starts and ends at that point.
pub(crate) fn edges(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + Clone {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

/// Returns true if a point lies inside a polygon, whose corners may be in either order. On an edge, rounding decides.
///
/// Method: count the edges that a ray along +x crosses. The point is inside if the count is odd.
pub(crate) fn encloses(corners: &[DVec2], point: DVec2) -> bool {
    // An edge includes its lower end but not its upper end: an outline that passes through the ray at a corner counts once.
    let crosses = |&(start, end): &(DVec2, DVec2)| {
        let rises = start.y <= point.y && end.y > point.y;
        let falls = end.y <= point.y && start.y > point.y;
        let side = (end - start).perp_dot(point - start);
        (rises && side > 0.0) || (falls && side < 0.0)
    };
    edges(corners).filter(crosses).count() % 2 == 1
}

/// Checks that successive corners differ and that edges share no point other than a common corner.
///
/// Compares every pair of edges: at most about half a million pairs for [`MAX_CORNERS`].
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
                folds_back(a, b)
            } else if (second + 1) % count == first {
                folds_back(b, a)
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

/// Returns true if the second of two successive edges runs back over the first.
fn folds_back(first: (DVec2, DVec2), second: (DVec2, DVec2)) -> bool {
    let (before, after) = (first.1 - first.0, second.1 - second.0);
    before.perp_dot(after) == 0.0 && before.dot(after) < 0.0
}

/// Returns true if two closed segments share a point.
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

    /// An L-shaped polygon made of three unit squares.
    const L_SHAPE: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

    fn error(corners: &[[f64; 2]]) -> String {
        Shape::polygon(corners).unwrap_err().to_string()
    }

    #[test]
    fn shapes_report_their_radius_reach_and_area() {
        let disc = Shape::disc(0.5).unwrap();
        assert_eq!((disc.radius(), disc.reach(), disc.corners().len()), (Some(0.5), 0.5, 0));
        let box_ = Shape::rectangle(4.0, 3.0).unwrap();
        assert_eq!((box_.radius(), box_.reach(), box_.area()), (None, 2.5, 12.0));
        assert_eq!(Shape::polygon(&L_SHAPE).unwrap().area(), 3.0);
    }

    #[test]
    fn clockwise_corners_are_reversed() {
        let mut clockwise = L_SHAPE;
        clockwise.reverse();
        let shape = Shape::polygon(&clockwise).unwrap();
        assert_eq!(shape.area(), 3.0);
        assert!(L_SHAPE.iter().all(|&corner| shape.corners().contains(&corner.into())));
    }

    #[test]
    fn points_inside_and_outside_of_a_concave_polygon() {
        let shape = Shape::polygon(&L_SHAPE).unwrap();
        let inside = |x, y| encloses(shape.corners(), DVec2::new(x, y));
        assert!(inside(0.5, 0.5) && inside(0.5, 1.0) && inside(1.5, 0.5) && inside(0.5, 1.9));
        assert!(!inside(1.5, 1.5) && !inside(-0.1, 1.0) && !inside(1.1, 1.0) && !inside(3.0, 2.0));
    }

    #[test]
    fn the_error_names_the_bad_size_or_corner() {
        let message = |shape: Result<Shape, Error>| shape.unwrap_err().to_string();
        assert_eq!(message(Shape::disc(0.0)), "radius must be positive and at most 1e6, got 0");
        assert_eq!(message(Shape::rectangle(1.0, f64::NAN)), "width must be positive and at most 1e6, got NaN");
        assert_eq!(error(&L_SHAPE[..2]), "the number of corners must be in 3..1000, got 2");
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
    fn polygons_that_are_not_simple_are_errors() {
        let crossing = "edges must meet only at the corners they share, got edges 0 and 2 that meet elsewhere";
        assert_eq!(error(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), crossing);
        // A corner on another edge, a spike, and a polygon without area.
        assert!(error(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]).starts_with("edges must meet"));
        assert!(error(&[[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).starts_with("edges must meet"));
        assert!(error(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]).starts_with("edges must meet"));
        assert!(Shape::polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]]).is_ok());
    }
}
