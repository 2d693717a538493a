//! Random rays over random grids, with many boundaries, corners and axes among them.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec2;
use proptest::prelude::*;
use rand::{Rng, RngExt};

use super::methods::{Start, by_traversal, check, check_all, toward, unit_grid};
use crate::grid::OccupancyGrid;
use crate::random;

const SEED: u64 = 20;

/// Returns true if a cell blocks, from its column, its row and a random number in [0, 1).
type Kind = fn(usize, usize, f64) -> bool;

const KINDS: [(&str, Kind); 7] = [
    ("empty", |_, _, _| false),
    ("sparse", |_, _, draw| draw < 0.01),
    ("dense", |_, _, draw| draw < 0.3),
    ("poles", |col, row, _| col % 7 == 3 && row % 5 == 2),
    ("diagonal walls", |col, row, _| (col + row) % 16 == 0 || (col + 40 - row % 40) % 23 == 0),
    ("checkerboard", |col, row, _| (col + row) % 2 == 0),
    ("corridor", |_, row, _| row % 6 == 0),
];

fn grid(kind: Kind, width: usize, height: usize, seed: u64) -> OccupancyGrid {
    let mut stream = random::stream(seed, 1);
    let blocking: Vec<bool> = (0..width * height).map(|index| kind(index % width, index / width, stream.random())).collect();
    unit_grid(&blocking, width)
}

/// A coordinate: anywhere, outside, on a grid line, near one, or at a multiple of a quarter of a cell.
fn coordinate(size: usize) -> impl Strategy<Value = f64> {
    let end = size as f64;
    prop_oneof![
        3 => 0.0..end,
        1 => -2.0 * end..3.0 * end,
        1 => (0..=size).prop_map(|line| line as f64),
        1 => (0..=size, -1e-12..1e-12).prop_map(|(line, off)| line as f64 + off),
        1 => (0..=4 * size).prop_map(|quarter| quarter as f64 / 4.0),
    ]
}

/// A direction: any, near a multiple of 45°, at one, almost along an axis, or from corner to corner of cells.
fn direction() -> impl Strategy<Value = DVec2> {
    prop_oneof![
        2 => (-PI..PI).prop_map(toward),
        1 => (-4..=4, -1e-12..1e-12).prop_map(|(eighth, off)| toward(f64::from(eighth) * FRAC_PI_4 + off)),
        1 => (-4..=4).prop_map(|eighth| toward(f64::from(eighth) * FRAC_PI_4)),
        1 => (0..4i32, 20..320i32, any::<bool>()).prop_map(|(quarter, digits, left): (i32, i32, bool)| {
            let off = 10f64.powi(-digits);
            let (along, across) = (if quarter < 2 { 1.0 } else { -1.0 }, if left { off } else { -off });
            if quarter % 2 == 0 { DVec2::new(along, across) } else { DVec2::new(across, along) }
        }),
        1 => (-9..=9, -9..=9).prop_filter("a vector", |&(x, y)| (x, y) != (0, 0))
            .prop_map(|(x, y)| DVec2::new(x.into(), y.into()).normalize()),
    ]
}

fn case() -> impl Strategy<Value = (usize, usize, usize, u64, f64, f64, DVec2)> {
    (0..KINDS.len(), 1..40usize, 1..40usize, 0..50u64).prop_flat_map(|(kind, width, height, seed)| {
        (Just(kind), Just(width), Just(height), Just(seed), coordinate(width), coordinate(height), direction())
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_kernel_agrees_with_the_reference((kind, width, height, seed, x, y, direction) in case()) {
        check(&grid(KINDS[kind].1, width, height, seed), (DVec2::new(x, y), direction));
    }
}

#[test]
fn every_kernel_agrees_with_the_traversal_on_large_grids() {
    for (name, kind) in KINDS {
        let (width, height) = (700, 450);
        let grid = grid(kind, width, height, SEED);
        let mut stream = random::stream(SEED, 2);
        let mut start = || {
            let mut along = |size: usize| (stream.random::<f64>() * 1.2 - 0.1) * size as f64;
            let origin = DVec2::new(along(width), along(height));
            let origin = if stream.next_u64().is_multiple_of(4) { origin.round() } else { origin };
            let angle = stream.random::<f64>() * 2.0 * PI;
            let angle = if stream.next_u64().is_multiple_of(4) { (angle / FRAC_PI_4).round() * FRAC_PI_4 } else { angle };
            (origin, toward(angle))
        };
        let starts: Vec<Start> = (0..20_000).map(|_| start()).collect();
        check_all(&grid, &starts);
        assert!(by_traversal(&grid, (DVec2::splat(-5.0), toward(3.0))).is_infinite(), "{name}");
    }
}

/// Turning by a quarter turn, mirroring or shifting grid and ray does not change the distance.
#[test]
fn symmetries_hold() {
    let mut stream = random::stream(SEED, 3);
    for _ in 0..3000 {
        let size = 12;
        let blocking: Vec<bool> = (0..size * size).map(|_| stream.next_u64().is_multiple_of(9)).collect();
        let at = |col: usize, row: usize| blocking[row * size + col];
        let turned: Vec<bool> = (0..size * size).map(|i| at(i / size, size - 1 - i % size)).collect();
        let mirrored: Vec<bool> = (0..size * size).map(|i| at(size - 1 - i % size, i / size)).collect();
        let shifted: Vec<bool> = (0..size * (size + 3)).map(|i| i >= 3 * size && blocking[i - 3 * size]).collect();
        let origin = DVec2::new(stream.random::<f64>(), stream.random::<f64>()) * size as f64;
        let direction = toward(stream.random::<f64>() * 2.0 * PI);
        let end = size as f64;
        let range = by_traversal(&unit_grid(&blocking, size), (origin, direction));
        let same = |other: f64| range == other || (range - other).abs() < 1e-12;
        // A quarter turn takes (x, y) to (end - y, x).
        let turn = (DVec2::new(end - origin.y, origin.x), direction.perp());
        assert!(same(by_traversal(&unit_grid(&turned, size), turn)));
        let mirror = (DVec2::new(end - origin.x, origin.y), DVec2::new(-direction.x, direction.y));
        assert!(same(by_traversal(&unit_grid(&mirrored, size), mirror)));
        let shift = (origin + DVec2::new(0.0, 3.0), direction);
        assert!(same(by_traversal(&unit_grid(&shifted, size), shift)));
    }
}

#[test]
fn another_wall_never_lengthens_a_beam() {
    let mut stream = random::stream(SEED, 4);
    for _ in 0..3000 {
        let size = 15;
        let mut blocking: Vec<bool> = (0..size * size).map(|_| stream.next_u64().is_multiple_of(20)).collect();
        let start = (
            DVec2::new(stream.random::<f64>(), stream.random::<f64>()) * size as f64,
            toward(stream.random::<f64>() * 2.0 * PI),
        );
        let before = by_traversal(&unit_grid(&blocking, size), start);
        blocking[(stream.next_u64() % (size * size) as u64) as usize] = true;
        assert!(by_traversal(&unit_grid(&blocking, size), start) <= before);
    }
}
