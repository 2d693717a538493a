//! The ways to find a range, all of one shape: `(grid, ray) -> distance in cells`, infinite for no hit.

use glam::DVec2;
use mobile_robot_simulator::raycast::{Ray, kernel, traverse};
use mobile_robot_simulator::{Cell, GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, Unknown};

/// Start (in cells) and direction (a unit vector) of a ray.
pub type Start = (DVec2, DVec2);

/// Distance in cells of the first blocking cell.
pub type Method = fn(&OccupancyGrid, Start) -> f64;

/// The specification, and all that is faster.
pub const METHODS: [(&str, Method); 2] = [("traversal", by_traversal), ("portable", by_portable)];

/// No ray of these tests goes as far as this.
const FAR: f64 = 1e12;

pub fn by_traversal(grid: &OccupancyGrid, start: Start) -> f64 {
    through(grid, start, |ray| traverse(grid, ray, FAR))
}

fn by_portable(grid: &OccupancyGrid, start: Start) -> f64 {
    through(grid, start, |ray| kernel::portable::cast(grid.clearance(), ray, FAR))
}

fn through(grid: &OccupancyGrid, (origin, direction): Start, cast: impl Fn(&Ray) -> f64) -> f64 {
    Ray::entering(grid.width(), grid.height(), origin, direction).map_or(f64::INFINITY, |ray| ray.gap + cast(&ray).max(0.0))
}

/// How far a ray gets into and through the square of every blocking cell: nothing is skipped, and there is no order to get wrong.
///
/// Returns the distance to the nearest square that the ray surely crosses, and the distances to all that it may at least touch.
pub fn by_every_square(grid: &OccupancyGrid, (origin, direction): Start) -> (f64, Vec<f64>) {
    let (mut crossed, mut touched) = (f64::INFINITY, Vec::new());
    for row in 0..grid.height() {
        for col in 0..grid.width() {
            if !grid.is_blocking(Cell { col, row }) {
                continue;
            }
            let (enter_x, leave_x) = slab(origin.x, direction.x, col as f64);
            let (enter_y, leave_y) = slab(origin.y, direction.y, row as f64);
            let (enter, leave) = (enter_x.max(enter_y).max(0.0), leave_x.min(leave_y));
            if leave > enter + TOLERANCE {
                crossed = crossed.min(enter);
            }
            if leave > enter - TOLERANCE {
                touched.push(enter);
            }
        }
    }
    (crossed, touched)
}

fn slab(origin: f64, direction: f64, low: f64) -> (f64, f64) {
    let (a, b) = ((low - origin) / direction, (low + 1.0 - origin) / direction);
    if direction.abs() > 1e-300 {
        (a.min(b), a.max(b))
    } else if (low..low + 1.0).contains(&origin) {
        (f64::NEG_INFINITY, f64::INFINITY)
    } else {
        (f64::INFINITY, f64::NEG_INFINITY)
    }
}

const TOLERANCE: f64 = 1e-9;

/// Holds every method against the reference, and against the plain traversal to the last bit.
pub fn check(grid: &OccupancyGrid, start: Start) {
    check_methods(grid, start);
    let (crossed, touched) = by_every_square(grid, start);
    let found = by_traversal(grid, start);
    assert!(found <= crossed + TOLERANCE, "{start:?}: a beam that goes through a wall at {crossed} went on to {found}");
    let stops = found.is_infinite() || touched.iter().any(|distance| (found - distance).abs() < TOLERANCE);
    assert!(stops, "{start:?}: nothing to stop a beam at {found}, only at {touched:?}");
}

/// Holds every method against the plain traversal to the last bit.
pub fn check_methods(grid: &OccupancyGrid, start: Start) {
    let expected = by_traversal(grid, start);
    for (name, method) in METHODS {
        let found = method(grid, start);
        assert_eq!(found.to_bits(), expected.to_bits(), "{name} from {start:?}: {found}, traversal: {expected}");
    }
}

/// A grid of cells of one unit at the origin; `blocking` row by row from the bottom.
pub fn unit_grid(blocking: &[bool], width: usize) -> OccupancyGrid {
    let cells = blocking.iter().map(|&blocks| if blocks { 100 } else { 0 }).collect();
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a grid of free and occupied cells")
}

/// A grid drawn in text, `#` blocking, top row first.
pub fn drawn_grid(drawing: &str) -> OccupancyGrid {
    let rows: Vec<&str> = drawing.split_whitespace().rev().collect();
    let blocking: Vec<bool> = rows.iter().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
    unit_grid(&blocking, rows[0].len())
}

/// The unit vector at an angle.
pub fn toward(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}
