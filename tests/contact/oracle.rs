//! A simple oracle for contact: the distance of every pair of convex parts, by the separating axis theorem and all corners.

use glam::DVec2;
use mobile_robot_simulator::{Cell, GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, Shape, Unknown};

/// A convex part: a polygon, or a disc given by its centre and radius.
#[derive(Debug, Clone)]
pub struct Part {
    pub corners: Vec<DVec2>,
    pub radius: f64,
}

/// A shape and the convex parts that it consists of.
#[derive(Debug, Clone)]
pub struct CompositeShape {
    pub shape: Shape,
    pub parts: Vec<Part>,
}

fn polygon(corners: &[[f64; 2]]) -> Part {
    Part { corners: corners.iter().copied().map(DVec2::from).collect(), radius: 0.0 }
}

pub fn disc(radius: f64) -> CompositeShape {
    CompositeShape { shape: Shape::disc(radius).unwrap(), parts: vec![Part { corners: vec![DVec2::ZERO], radius }] }
}

pub fn rectangle(length: f64, width: f64) -> CompositeShape {
    let (x, y) = (0.5 * length, 0.5 * width);
    CompositeShape {
        shape: Shape::rectangle(length, width).unwrap(),
        parts: vec![polygon(&[[-x, -y], [x, -y], [x, y], [-x, y]])],
    }
}

/// An L shape of three squares with sides of `scale`; its origin is the centre of the corner square.
pub fn l_shape(scale: f64) -> CompositeShape {
    let scaled = |corners: &[[f64; 2]]| corners.iter().map(|&[x, y]| [scale * x, scale * y]).collect::<Vec<_>>();
    let whole = scaled(&[[-0.5, -0.5], [1.5, -0.5], [1.5, 0.5], [0.5, 0.5], [0.5, 1.5], [-0.5, 1.5]]);
    let horizontal = polygon(&scaled(&[[-0.5, -0.5], [1.5, -0.5], [1.5, 0.5], [-0.5, 0.5]]));
    let vertical = polygon(&scaled(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 1.5], [-0.5, 1.5]]));
    CompositeShape { shape: Shape::polygon(&whole).unwrap(), parts: vec![horizontal, vertical] }
}

/// A pointed triangle that does not contain its origin.
pub fn triangle(scale: f64) -> CompositeShape {
    let corners = [[0.2, -1.0], [2.0, 0.1], [0.2, 1.0]].map(|[x, y]| [scale * x, scale * y]);
    CompositeShape { shape: Shape::polygon(&corners).unwrap(), parts: vec![polygon(&corners)] }
}

impl CompositeShape {
    /// Returns the parts at a pose, scaled by `scale` about the origin.
    pub fn at(&self, pose: Pose, scale: f64) -> Vec<Part> {
        let place = |part: &Part| Part {
            corners: part.corners.iter().map(|&corner| pose.transform_point(scale * corner)).collect(),
            radius: scale * part.radius,
        };
        self.parts.iter().map(place).collect()
    }
}

/// Returns the squares of the blocking cells, in the map frame.
pub fn blocking_squares(grid: &OccupancyGrid) -> Vec<Part> {
    let cells = (0..grid.width() * grid.height()).map(|index| Cell { col: index % grid.width(), row: index / grid.width() });
    let square = |cell: Cell| {
        let half = 0.5 * grid.resolution();
        let turn = DVec2::from_angle(grid.options().origin.yaw);
        let center = grid.checked_center(cell).expect("a cell of the grid");
        let corner = |x: f64, y: f64| center + turn.rotate(DVec2::new(x * half, y * half));
        Part { corners: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], radius: 0.0 }
    };
    cells.filter(|&cell| grid.is_blocking(cell)).map(square).collect()
}

/// Returns the distance between two sets of parts, 0 if they overlap.
pub fn distance(a: &[Part], b: &[Part]) -> f64 {
    a.iter().flat_map(|a| b.iter().map(move |b| part_distance(a, b))).fold(f64::INFINITY, f64::min)
}

fn part_distance(a: &Part, b: &Part) -> f64 {
    if is_separated(a, b) || is_separated(b, a) {
        let corners = a.corners.iter().map(|&corner| to_outline(corner, b));
        let others = b.corners.iter().map(|&corner| to_outline(corner, a));
        (corners.chain(others).fold(f64::INFINITY, f64::min) - a.radius - b.radius).max(0.0)
    } else {
        0.0
    }
}

/// Returns true if the line through some edge of `a` separates it from `b`. Two single points always count as separated.
fn is_separated(a: &Part, b: &Part) -> bool {
    if a.corners.len() == 1 {
        return b.corners.len() == 1;
    }
    (0..a.corners.len()).any(|index| {
        let (start, end) = (a.corners[index], a.corners[(index + 1) % a.corners.len()]);
        b.corners.iter().all(|&corner| (end - start).perp_dot(corner - start) < 0.0)
    })
}

/// Returns the distance from a point to the nearest edge of a part.
fn to_outline(point: DVec2, part: &Part) -> f64 {
    let count = part.corners.len();
    let to_edge = |index: usize| {
        let (start, along) = (part.corners[index], part.corners[(index + 1) % count] - part.corners[index]);
        let share = if count == 1 { 0.0 } else { (point - start).dot(along) / along.length_squared() };
        point.distance(start + along * share.clamp(0.0, 1.0))
    };
    (0..count).map(to_edge).fold(f64::INFINITY, f64::min)
}

/// Returns a grid, given whether each cell blocks, row by row from the bottom.
pub fn grid(blocking: &[bool], width: usize, resolution: f64, origin: Pose) -> OccupancyGrid {
    let cells = blocking.iter().map(|&blocks| if blocks { 100 } else { 0 }).collect();
    let options = GridOptions { resolution, origin, occupied_threshold: OCCUPIED_THRESHOLD, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a good grid")
}

#[test]
fn the_oracle_gives_distances_known_by_hand() {
    let square = |x: f64, y: f64| rectangle(1.0, 1.0).at(Pose::new(x, y, 0.0), 1.0);
    assert_eq!(distance(&square(0.0, 0.0), &square(3.0, 0.2)), 2.0);
    assert!((distance(&square(0.0, 0.0), &square(2.0, 2.0)) - 2f64.sqrt()).abs() < 1e-15);
    assert_eq!(distance(&square(0.0, 0.0), &square(0.5, 0.7)), 0.0);
    assert_eq!(distance(&square(0.0, 0.0), &disc(0.5).at(Pose::new(3.0, 0.0, 1.0), 1.0)), 2.0);
    assert_eq!(distance(&square(0.0, 0.0), &disc(0.1).at(Pose::default(), 1.0)), 0.0);
    assert_eq!(distance(&disc(1.0).at(Pose::default(), 1.0), &disc(0.5).at(Pose::new(0.0, 4.0, 0.0), 1.0)), 2.5);
    // A disc in the notch of the L.
    assert_eq!(distance(&l_shape(1.0).at(Pose::default(), 1.0), &disc(0.25).at(Pose::new(1.0, 1.0, 0.0), 1.0)), 0.25);
}
