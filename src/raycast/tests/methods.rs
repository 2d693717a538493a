//! The ways to find a range, all of one shape: `(grid, ray) -> distance in cells`, infinite for no hit.

use std::sync::Once;

use crate::grid::{Cell, GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Unknown};
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;
use crate::raycast::rays::{RayColumns, Rays};
use crate::raycast::{Caster, Kernel, Ray};
use glam::DVec2;

/// Start (in cells) and direction (a unit vector) of a ray.
pub type Start = (DVec2, DVec2);

/// No ray of these tests goes as far as this.
const FAR: f64 = 1e12;

/// The kernels that this machine has, the plain traversal first.
///
/// Says once which ones are passed over.
pub fn kernels() -> impl Iterator<Item = Kernel> {
    static PASSED_OVER: Once = Once::new();
    PASSED_OVER.call_once(|| {
        for kernel in Kernel::ALL.into_iter().filter(|kernel| !kernel.is_available()) {
            eprintln!("passed over: this machine has no {}", kernel.name());
        }
    });
    Kernel::ALL.into_iter().filter(|kernel| kernel.is_available())
}

/// Distances in cells along rays to the first blocking cell, infinite for no hit.
pub fn cast_all(kernel: Kernel, grid: &OccupancyGrid, starts: &[Start]) -> Vec<f64> {
    let mut groups = vec![RayColumns::MISSES; starts.len().div_ceil(GROUP)];
    for (index, &(origin, direction)) in starts.iter().enumerate() {
        if let Some(ray) = Ray::entering(grid.width(), grid.height(), origin, direction) {
            groups[index / GROUP].set(index % GROUP, &ray);
        }
    }
    let mut distances = Vec::new();
    let source = Rays { groups: &groups, count: starts.len(), upcoming: &[] };
    Caster::new(grid, FAR, kernel).cast(source, |_, ranges: &Group| distances.extend_from_slice(ranges));
    distances.truncate(starts.len());
    distances
}

pub fn cast(kernel: Kernel, grid: &OccupancyGrid, start: Start) -> f64 {
    cast_all(kernel, grid, &[start])[0]
}

pub fn by_traversal(grid: &OccupancyGrid, start: Start) -> f64 {
    cast(Kernel::Traversal, grid, start)
}

/// How far a ray gets into and through the square of every blocking cell: nothing is skipped, and there is no order to get wrong.
///
/// Returns the distance to the nearest square that the ray surely crosses, and for all that it may at least touch
/// from where to where it does.
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
            // One that all but runs along a side is moved across it by rounding.
            let (enter, leave) = within(-ROUNDING);
            if leave > enter + TOLERANCE {
                crossed = crossed.min(enter);
            }
            // A ray along a side may be taken for one on either side of it.
            let (enter, leave) = within(TOLERANCE);
            if leave >= enter {
                touched.push((enter, leave));
            }
        }
    }
    (crossed, touched)
}

/// Where a ray enters and leaves a cell along one axis, the cell being larger by a margin, or smaller if the ray moves along it.
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

/// More than rounding moves a ray that comes from beside these grids.
const ROUNDING: f64 = 1e-12;

/// Holds every method against the reference, and against the plain traversal to the last bit.
pub fn check(grid: &OccupancyGrid, start: Start) {
    check_methods(grid, start);
    let (crossed, touched) = by_every_square(grid, start);
    let found = by_traversal(grid, start);
    assert!(found <= crossed + TOLERANCE, "{start:?}: a beam that goes through a wall at {crossed} went on to {found}");
    let near = |&(enter, leave): &(f64, f64)| enter - TOLERANCE < found && found < leave + TOLERANCE;
    let stops = found.is_infinite() || touched.iter().any(near);
    assert!(stops, "{start:?}: nothing to stop a beam at {found}, only at {touched:?}");
}

/// Holds every kernel against the plain traversal to the last bit.
pub fn check_methods(grid: &OccupancyGrid, start: Start) {
    check_all(grid, &[start]);
}

/// [`check_methods`] of many rays at once.
pub fn check_all(grid: &OccupancyGrid, starts: &[Start]) {
    let expected = cast_all(Kernel::Traversal, grid, starts);
    for kernel in kernels() {
        for ((start, found), expected) in starts.iter().zip(cast_all(kernel, grid, starts)).zip(&expected) {
            let name = kernel.name();
            assert_eq!(found.to_bits(), expected.to_bits(), "{name} from {start:?}: {found}, traversal: {expected}");
        }
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
