//! Ranges on small maps, derived by hand.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::methods::{by_every_square, cast, check, drawn_grid, kernels, toward};
use crate::grid::OccupancyGrid;
use glam::DVec2;

/// Checks the distance that the reference and every kernel find for a ray from `(x, y)` at `angle`.
fn expect(grid: &OccupancyGrid, (x, y): (f64, f64), angle: f64, expected: f64) {
    let start = (DVec2::new(x, y), toward(angle));
    let (crossed, _) = by_every_square(grid, start);
    assert!(crossed == expected || (crossed - expected).abs() < 1e-9, "reference from {start:?}: {crossed}");
    for kernel in kernels() {
        let name = kernel.name();
        let found = cast(kernel, grid, start);
        assert!(found == expected || (found - expected).abs() < 1e-12, "{name} from {start:?}: {found}, not {expected}");
    }
    check(grid, start);
}

const NONE: f64 = f64::INFINITY;

#[test]
fn a_single_pole() {
    let grid = drawn_grid(
        ".....
         .....
         ..#..
         .....
         .....",
    );
    expect(&grid, (0.5, 2.5), 0.0, 1.5);
    expect(&grid, (0.5, 0.5), FRAC_PI_4, 1.5 * 2f64.sqrt());
    expect(&grid, (2.5, 2.5), 1.0, 0.0);
    expect(&grid, (-3.0, 2.5), 0.0, 5.0);
    expect(&grid, (-1.0, -1.0), FRAC_PI_4, 3.0 * 2f64.sqrt());
    expect(&grid, (-3.0, 2.5), PI, NONE);
    expect(&grid, (0.5, 2.0), 0.0, 1.5);
    expect(&grid, (0.5, 3.0), 0.0, NONE);
    expect(&grid, (2.5, 4.5), -FRAC_PI_2, 1.5);
    expect(&grid, (4.5, 2.5), PI, 1.5);
    expect(&grid, (2.5, 7.0), -FRAC_PI_2, 4.0);
}

#[test]
fn a_start_in_or_on_the_edge_of_a_wall() {
    let grid = drawn_grid(".#.");
    for angle in [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0] {
        expect(&grid, (1.5, 0.5), angle, 0.0);
    }
    expect(&grid, (1.0, 0.5), 0.0, 0.0);
    // The far edge of the wall belongs to the next cell: a beam back into the wall has range 0, a beam away never hits.
    expect(&grid, (2.0, 0.5), PI, 0.0);
    expect(&grid, (2.0, 0.5), 0.0, NONE);
}

#[test]
fn walls_that_touch_at_a_corner_do_not_leak() {
    let falling = drawn_grid(
        ".....
         .#...
         ..#..
         ...#.
         .....",
    );
    for step in 0..50 {
        // The rays are perpendicular to the diagonal wall. Some pass through its corners, the others beside them.
        let offset = f64::from(step) / 25.0 - 1.0;
        let start = DVec2::new(0.5 + offset, 0.5 - offset) + DVec2::new(0.5, 0.5);
        for angle in [FRAC_PI_4, FRAC_PI_4 + 1e-9, FRAC_PI_4 - 1e-9] {
            check(&falling, (start, toward(angle)));
            for kernel in kernels() {
                let name = kernel.name();
                let found = cast(kernel, &falling, (start, toward(angle)));
                assert!(found < 2.2 || offset.abs() > 0.99, "{name} leaks from {start} at {angle}: {found}");
            }
        }
    }
}

#[test]
fn a_ray_through_a_corner_crosses_the_row_boundary_first() {
    // Of the two cells beside the corner, the ray visits the upper one on its way up and the lower one on its way down.
    let above = drawn_grid(".. #.");
    let beside = drawn_grid("#. ..");
    for kernel in kernels() {
        let name = kernel.name();
        let corner = (DVec2::new(0.5, 0.5), DVec2::new(0.5f64.sqrt(), 0.5f64.sqrt()));
        assert!(cast(kernel, &beside, corner) < 0.71, "{name}: the row's boundary comes first");
        assert_eq!(cast(kernel, &above, (DVec2::new(1.5, 1.5), -corner.1)), 0.5 / 0.5f64.sqrt() + 0.0, "{name}");
    }
}

#[test]
fn a_range_is_never_negative_zero() {
    let grid = drawn_grid("#.#");
    for kernel in kernels() {
        let name = kernel.name();
        for angle in [0.0, -0.0, FRAC_PI_2, PI, -FRAC_PI_2] {
            for x in [1.0, 2.0] {
                let found = cast(kernel, &grid, (DVec2::new(x, 0.0), toward(angle)));
                assert!(found.is_sign_positive(), "{name} from {x} at {angle}: {found}");
            }
        }
    }
}

#[test]
fn components_that_are_zero_or_tiny_give_straight_rays() {
    let grid = drawn_grid("....#");
    for zero in [0.0, -0.0, 6e-17, -6e-17, 1e-310, -1e-310] {
        for kernel in kernels() {
            let name = kernel.name();
            assert_eq!(cast(kernel, &grid, (DVec2::new(0.5, 0.5), DVec2::new(1.0, zero))), 3.5, "{name} {zero}");
        }
    }
    let upright = drawn_grid("# . . .");
    for zero in [0.0, -0.0, 1e-310, -1e-310] {
        for kernel in kernels() {
            let name = kernel.name();
            assert_eq!(cast(kernel, &upright, (DVec2::new(0.0, 0.5), DVec2::new(zero, 1.0))), 2.5, "{name} {zero}");
        }
    }
}

#[test]
fn rays_from_far_or_from_nan_end() {
    let grid = drawn_grid("..#");
    for kernel in kernels() {
        let name = kernel.name();
        assert_eq!(cast(kernel, &grid, (DVec2::new(-1e9, 0.5), DVec2::X)), 1e9 + 2.0, "{name}");
        for x in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e308, -1e308] {
            assert_eq!(cast(kernel, &grid, (DVec2::new(x, -x), DVec2::X)), NONE, "{name}");
        }
    }
}

/// Rays that start on a grid line and leave it at an angle too small for float32: 0 · ∞ in the march.
#[test]
fn rays_almost_along_a_grid_line() {
    let grid = drawn_grid(
        "..........
         ..........
         .....#....
         ....#.....
         ..........
         ..........
         .....#....",
    );
    for digits in [20, 37, 39, 50, 100, 200, 290] {
        let off = 10f64.powi(-digits);
        for direction in [DVec2::new(1.0, -off), DVec2::new(1.0, off), DVec2::new(-1.0, -off), DVec2::new(-1.0, off)] {
            for row in 0..8 {
                check(&grid, (DVec2::new(5.5, f64::from(row)), direction));
                check(&grid, (DVec2::new(2.0, f64::from(row)), DVec2::new(direction.y, direction.x)));
            }
        }
    }
}
