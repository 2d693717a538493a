//! Every kernel of this machine casts more than fifty million beams, and each range equals that of the plain traversal to
//! the last bit.
//!
//! `cargo test --release --test exact` casts all of them. `cargo test` casts only one in a hundred, but with the debug
//! assertions of the kernels.

use std::f64::consts::TAU;
use std::path::Path;

use mobile_robot_simulator::raycast::{Caster, Kernel};
use mobile_robot_simulator::{
    BeamLayout, GridOptions, LaserScanner, OCCUPIED_THRESHOLD, Obstacles, OccupancyGrid, Pose, ScannerOptions, Unknown,
    random,
};
use rand::{Rng, RngExt};

const SEED: u64 = 50;

/// Returns true if a cell blocks, given its column, its row and a random number for this cell.
type Kind = fn(usize, usize, u64) -> bool;

/// Name, width, height and pattern of each generated grid. The longest have the largest side that a grid may have.
const GRIDS: [(&str, usize, usize, Kind); 14] = [
    ("one free cell", 1, 1, |_, _, _| false),
    ("one wall", 1, 1, |_, _, _| true),
    ("column", 1, 500, |_, row, _| row % 97 == 50),
    ("row", 500, 1, |col, _, _| col % 97 == 50),
    ("longest row", 65_535, 1, |_, _, draw| draw % 20_000 == 0),
    ("longest column", 1, 65_535, |_, _, draw| draw % 20_000 == 0),
    ("long strip", 65_535, 3, |_, row, draw| row == 1 && draw % 3000 == 0),
    ("empty", 300, 200, |_, _, _| false),
    ("sparse", 700, 500, |_, _, draw| draw % 500 == 0),
    ("dense", 400, 400, |_, _, draw| draw % 4 == 0),
    ("poles", 300, 300, |col, row, _| col % 7 == 3 && row % 5 == 2),
    ("checkerboard", 200, 200, |col, row, _| (col + row) % 2 == 0),
    ("corridor", 600, 300, |_, row, _| row % 30 == 0),
    ("diagonal walls", 500, 500, |col, row, _| (col + row) % 60 == 0 || (col + 500 - row) % 83 == 0),
];

/// Real maps in the optional folder `../shared/maps`.
const IMAGES: [&str; 4] = [
    "nav2_depot/depot.pgm",
    "nav2_tb3_sandbox/tb3_sandbox.pgm",
    "rl_basement_hallways_5cm/basement_hallways_5cm.png",
    "willow_2010_0.10/willow-2010-02-18-0.10.pgm",
];

const BEAMS: usize = 541;

/// Numbers of scans and rays are divided by this. Debug assertions make casting slow.
const REDUCTION: usize = if cfg!(debug_assertions) { 100 } else { 1 };

/// Scans on each generated grid; together with the rays, 50 million beams.
const SCANS: usize = 6000 / REDUCTION;

/// Scans on each real map.
const REAL_SCANS: usize = 1500 / REDUCTION;

/// Layout and beam count of scanners with dense beams: 0.13°, 0.09° and 0.04° apart, then 0.006° and turning clockwise, then almost
/// as close as the coarse beams allow.
const DENSE: [(BeamLayout, usize); 5] = [
    (BeamLayout::Fov(TAU), 2771),
    (BeamLayout::Fov(TAU), 4100),
    (BeamLayout::Fov(4.71), 6743),
    (BeamLayout::Ends { angle_min: 0.4, angle_max: -0.4 }, 7993),
    (BeamLayout::Steps { angle_min: -0.03, angle_increment: 1.01e-5 }, 5900),
];

/// Scans with each of them on each grid.
const DENSE_SCANS: usize = 30_usize.div_ceil(REDUCTION);

/// Unrelated rays on each grid.
const RAYS: usize = 400_000 / REDUCTION;

fn grids() -> impl Iterator<Item = (String, OccupancyGrid)> {
    let mut stream = random::stream(SEED, 0);
    let made = GRIDS.into_iter().map(move |(name, width, height, blocks)| {
        let blocking = (0..width * height).map(|index| blocks(index % width, index / width, stream.next_u64()));
        (name.to_owned(), grid(blocking, width))
    });
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/maps");
    if !folder.is_dir() {
        eprintln!("skipped: no real maps in {}", folder.display());
    }
    let real = IMAGES.into_iter().filter_map(move |name| {
        let pixels = image::open(folder.join(name)).ok()?.into_luma8();
        let width = pixels.width() as usize;
        Some((name.to_owned(), grid(pixels.as_raw().chunks(width).rev().flatten().map(|&pixel| pixel < 90), width)))
    });
    made.chain(real)
}

fn grid(blocking: impl Iterator<Item = bool>, width: usize) -> OccupancyGrid {
    let cells = blocking.map(|blocks| if blocks { 100 } else { 0 }).collect();
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution: 0.5, origin, occupied_threshold, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a grid")
}

/// Random poses on and around the grid: one coordinate in four on a grid line, one angle in four a multiple of 45°, some far
/// away. From one pose in eight, one of the `beams` from there has a slope close to 0, 1/2, 1 or 2.
fn poses(grid: &OccupancyGrid, count: usize, index: u64, beams: usize) -> Vec<[f64; 3]> {
    let mut stream = random::stream(SEED, index);
    let one_in = |count: u64, index: u64| random::stream(SEED + 1, index).next_u64().is_multiple_of(count);
    let resolution = grid.resolution();
    (0..count as u64)
        .map(|pose| {
            let mut along = |size: usize, salt: u64| {
                let at = (stream.random::<f64>() * 1.1 - 0.05) * size as f64;
                let at = if one_in(4, 8 * pose + salt) { at.round() } else { at };
                // One in eight is 5e-14 cells or less off a grid line.
                let at =
                    if one_in(8, 8 * pose + salt + 1) { at.round() + 1e-13 * (stream.random::<f64>() - 0.5) } else { at };
                at * resolution
            };
            let (x, y) = (along(grid.width(), 0), along(grid.height(), 2));
            let angle = stream.random::<f64>() * TAU;
            let angle = if one_in(4, 8 * pose + 4) { (angle / TAU * 8.0).round() / 8.0 * TAU } else { angle };
            let angle = if one_in(8, 8 * pose + 6) {
                let slope = [0.0, 0.5, 1.0, 2.0_f64][stream.random_range(0..4)];
                // Off by 1e-16 to 1e-3, so that both float32 and float64 sometimes take it for the slope itself.
                let off = (stream.random::<f64>() - 0.5) * 10.0_f64.powi(-stream.random_range(3..17));
                let beam = stream.random_range(0..beams) as f64 / beams as f64 * TAU;
                slope.atan() + off + f64::from(stream.random_range(0..4)) * TAU / 4.0 - beam
            } else {
                angle
            };
            let far = if one_in(64, 8 * pose + 5) { 1e7 } else { 1.0 };
            [x * far, y, angle]
        })
        .collect()
}

/// Returns the kernels that this machine can run, without the plain traversal. Prints the names of the others.
fn kernels() -> Vec<Kernel> {
    let (available, missing): (Vec<_>, Vec<_>) = Kernel::ALL.into_iter().skip(1).partition(|kernel| kernel.is_available());
    for kernel in missing {
        eprintln!("skipped: this machine cannot run {}", kernel.name());
    }
    available
}

fn check(what: &str, kernel: Kernel, found: &[f32], expected: &[f32], poses: &[[f64; 3]]) {
    let bits = |ranges: &[f32]| ranges.iter().map(|range| range.to_bits()).collect::<Vec<_>>();
    if bits(found) == bits(expected) {
        return;
    }
    let beam = found.iter().zip(expected).position(|(a, b)| a.to_bits() != b.to_bits()).expect("a difference");
    let pose = poses[beam * poses.len() / found.len()];
    panic!("{what} by {}: beam {beam} from {pose:?} is {}, not {}", kernel.name(), found[beam], expected[beam]);
}

#[test]
fn dense_scans_are_exact() {
    for (index, (name, grid)) in (1..).zip(grids()) {
        for (layout, beam_count) in DENSE {
            let options = ScannerOptions { layout, beam_count, max_range: 100.0, ..ScannerOptions::default() };
            let laser = LaserScanner::new(options).expect("a scanner");
            let starts = poses(&grid, DENSE_SCANS, 2000 + index, beam_count);
            let scan = |kernel| {
                let mut ranges = vec![0.0; starts.len() * beam_count];
                let laser = laser.clone().with_kernel(kernel);
                laser.scan_batch(&grid, &starts, None, None, &mut ranges).expect("scans");
                ranges
            };
            let expected = scan(Kernel::Traversal);
            for kernel in kernels() {
                check(&format!("{name}, {layout:?}"), kernel, &scan(kernel), &expected, &starts);
            }
        }
    }
}

#[test]
fn all_kernels_are_exact() {
    let kernels = kernels();
    let mut count = 0;
    for (index, (name, grid)) in (1..).zip(grids()) {
        let options = ScannerOptions {
            layout: BeamLayout::Fov(TAU),
            beam_count: BEAMS,
            max_range: 100.0,
            ..ScannerOptions::default()
        };
        let laser = LaserScanner::new(options).expect("a scanner");
        let scans = if index as usize <= GRIDS.len() { SCANS } else { REAL_SCANS };
        let starts = poses(&grid, scans, index, BEAMS);
        let scan = |kernel| {
            let mut ranges = vec![0.0; scans * BEAMS];
            let laser = laser.clone().with_kernel(kernel);
            laser.scan_batch(&grid, &starts, None, None, &mut ranges).expect("scans");
            ranges
        };
        let expected = scan(Kernel::Traversal);
        for &kernel in &kernels {
            check(&name, kernel, &scan(kernel), &expected, &starts);
        }

        // Unrelated rays without a range limit.
        let rays = poses(&grid, RAYS, 1000 + index, 1);
        let cast = |kernel| {
            let mut ranges = vec![0.0; RAYS];
            Caster::new(&grid, 1e30, kernel)
                .expect("a range")
                .cast_rays(Obstacles::NONE, &rays, None, &mut ranges)
                .expect("rays");
            ranges
        };
        let far = cast(Kernel::Traversal);
        for &kernel in &kernels {
            check(&name, kernel, &cast(kernel), &far, &rays);
        }
        count += expected.len() + far.len();
    }
    assert!(count >= 50_000_000 / REDUCTION, "only {count} beams");
}
