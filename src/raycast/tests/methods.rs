//! Methods that find the distance of a hit in cells, infinite for no hit, and checks that the methods agree.

use std::sync::Once;

use crate::grid::{Cell, GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Unknown};
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;
use crate::raycast::rays::{RayColumns, Rays};
use crate::raycast::{Caster, Kernel, Ray};
use glam::DVec2;

/// Origin of a ray in cells, and its direction as a unit vector.
pub type Start = (DVec2, DVec2);

/// Maximum range. No ray of these tests is as long.
const FAR: f64 = 1e12;

/// Returns the kernels that this machine can run, the plain traversal first.
///
/// Prints once which ones are skipped.
pub fn kernels() -> impl Iterator<Item = Kernel> {
    static PRINT_SKIPPED: Once = Once::new();
    PRINT_SKIPPED.call_once(|| {
        for kernel in Kernel::ALL.into_iter().filter(|kernel| !kernel.is_available()) {
            eprintln!("skipped: this machine cannot run {}", kernel.name());
        }
    });
    Kernel::ALL.into_iter().filter(|kernel| kernel.is_available())
}

/// Returns the distance of each ray to the first blocking cell.
pub fn cast_all(kernel: Kernel, grid: &OccupancyGrid, starts: &[Start]) -> Vec<f64> {
    let mut groups = vec![RayColumns::MISSES; starts.len().div_ceil(GROUP)];
    for (index, &(origin, direction)) in starts.iter().enumerate() {
        if let Some(ray) = Ray::entering(grid.width(), grid.height(), origin, direction) {
            groups[index / GROUP].set(index % GROUP, &ray);
        }
    }
    let mut distances = Vec::new();
    let source = Rays { groups: &groups, count: starts.len(), upcoming: &[] };
    Caster::new(grid, FAR, kernel).expect("a range").cast(source, |_, ranges: &Group| distances.extend_from_slice(ranges));
    distances.truncate(starts.len());
    distances
}

pub fn cast(kernel: Kernel, grid: &OccupancyGrid, start: Start) -> f64 {
    cast_all(kernel, grid, &[start])[0]
}

pub fn by_traversal(grid: &OccupancyGrid, start: Start) -> f64 {
    cast(Kernel::Traversal, grid, start)
}

/// Intersects a ray with the square of every blocking cell. No cell is skipped, and the order does not matter.
///
/// Returns the distance to the nearest square that the ray certainly crosses, and the intervals of distances within all
/// squares that it may touch.
pub fn by_every_square(grid: &OccupancyGrid, (origin, direction): Start) -> (f64, Vec<(f64, f64)>) {
    let (mut crossed, mut touched) = (f64::INFINITY, Vec::new());
    for row in 0..grid.height() {
        for col in 0..grid.width() {
            if !grid.is_blocking(Cell { col, row }) {
                continue;
            }
            let within = |margin: f64| {
                let (enter_x, leave_x) = slab(origin.x, direction.x, col as f64, margin);
                let (enter_y, leave_y) = slab(origin.y, direction.y, row as f64, margin);
                (enter_x.max(enter_y).max(0.0), leave_x.min(leave_y))
            };
            // Smaller squares: rounding can move a ray that runs almost along a side across it.
            let (enter, leave) = within(-ROUNDING);
            if leave > enter + TOLERANCE {
                crossed = crossed.min(enter);
            }
            // Larger squares: a ray along a side may count as on either side of it.
            let (enter, leave) = within(TOLERANCE);
            if leave >= enter {
                touched.push((enter, leave));
            }
        }
    }
    (crossed, touched)
}

/// Returns the distances at which a ray enters and leaves a cell along one axis.
///
/// The cell is enlarged by `margin` on both sides. A negative margin makes it smaller, but only if the ray moves along the
/// axis.
fn slab(origin: f64, direction: f64, cell: f64, margin: f64) -> (f64, f64) {
    let margin = if direction.abs() > 1e-300 { margin } else { margin.max(0.0) };
    let (low, high) = (cell - margin, cell + 1.0 + margin);
    let (a, b) = ((low - origin) / direction, (high - origin) / direction);
    if direction.abs() > 1e-300 {
        (a.min(b), a.max(b))
    } else if (low..high).contains(&origin) {
        (f64::NEG_INFINITY, f64::INFINITY)
    } else {
        (f64::INFINITY, f64::NEG_INFINITY)
    }
}

const TOLERANCE: f64 = 1e-9;

/// Larger than the rounding errors of rays that start near these grids.
const ROUNDING: f64 = 1e-12;

/// Checks the plain traversal against the reference, and that every kernel gives the same bits as the traversal.
pub fn check(grid: &OccupancyGrid, start: Start) {
    check_methods(grid, start);
    let (crossed, touched) = by_every_square(grid, start);
    let found = by_traversal(grid, start);
    assert!(found <= crossed + TOLERANCE, "{start:?}: a beam passed through a wall at {crossed} and ended at {found}");
    let near = |&(enter, leave): &(f64, f64)| enter - TOLERANCE < found && found < leave + TOLERANCE;
    let stops = found.is_infinite() || touched.iter().any(near);
    assert!(stops, "{start:?}: a beam ended at {found}, but walls are only at {touched:?}");
}

/// Checks that every kernel gives the same bits as the plain traversal.
pub fn check_methods(grid: &OccupancyGrid, start: Start) {
    check_all(grid, &[start]);
}

/// [`check_methods`] for many rays.
pub fn check_all(grid: &OccupancyGrid, starts: &[Start]) {
    let expected = cast_all(Kernel::Traversal, grid, starts);
    for kernel in kernels() {
        for ((start, found), expected) in starts.iter().zip(cast_all(kernel, grid, starts)).zip(&expected) {
            let name = kernel.name();
            assert_eq!(found.to_bits(), expected.to_bits(), "{name} from {start:?}: {found}, traversal: {expected}");
        }
    }
}

/// Returns a grid at the origin with cells of 1 m; `blocking` is row by row from the bottom.
pub fn unit_grid(blocking: &[bool], width: usize) -> OccupancyGrid {
    let cells = blocking.iter().map(|&blocks| if blocks { 100 } else { 0 }).collect();
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a grid of free and occupied cells")
}

/// Returns the grid of a drawing, top row first; `#` blocks.
pub fn drawn_grid(drawing: &str) -> OccupancyGrid {
    let rows: Vec<&str> = drawing.split_whitespace().rev().collect();
    let blocking: Vec<bool> = rows.iter().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
    unit_grid(&blocking, rows[0].len())
}

/// Returns the unit vector in the direction of an angle.
pub fn toward(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}
