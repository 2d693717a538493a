//! Maps and poses to measure on.

use std::f64::consts::TAU;
use std::path::Path;

use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    GridOptions, LaserScanner, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, ScannerOptions, Unknown, random,
};
use rand::RngExt;

const SEED: u64 = 5;

/// Real maps of the folder beside the project: name, image, metres per cell. Passed over where there is no such folder.
const REAL: [(&str, &str, f64); 5] = [
    // Long corridors: few jumps, far apart in memory.
    ("hallways", "rl_basement_hallways_5cm/basement_hallways_5cm.png", 0.05),
    // Cluttered offices: many short jumps.
    ("willow", "willow_2010_0.10/willow-2010-02-18-0.10.pgm", 0.10),
    // One large hall.
    ("depot", "nav2_depot/depot.pgm", 0.05),
    // Small: ranges so short that what a beam costs at least shows.
    ("sandbox", "nav2_tb3_sandbox/tb3_sandbox.pgm", 0.05),
    // 45 million cells: no cache holds it.
    ("huge", "rl_huge/huge_map.png", 0.05),
];

/// Whether a cell of a map of [`SIDE`] by [`SIDE`] blocks, by column and row.
type Blocks = fn(usize, usize) -> bool;

const SIDE: usize = 2000;

const MADE: [(&str, Blocks); 5] = [
    // Nothing to hit: a plain traversal walks to the maximum range.
    ("empty", |_, _| false),
    // Every jump is one cell: nothing is won by jumping.
    ("checkerboard", |col, row| (col + row) % 2 == 0),
    // One cell in five blocks at random: rays are short, and no jump is long.
    ("clutter", |col, row| scattered(col, row).is_multiple_of(5)),
    // Walls along a grid line: beams that graze them see short boxes all the way.
    ("grid_lines", |_, row| row % 30 == 0),
    // A wall at 45°, on which every box ends in a corner.
    ("diagonal", |col, row| (col + row) % 200 == 0),
];

/// A number that looks random, by column and row.
fn scattered(col: usize, row: usize) -> usize {
    (col.wrapping_mul(0x9e37_79b9) ^ row.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35) >> 15 & 0xffff
}

/// The maps that there are.
pub fn maps() -> impl Iterator<Item = (&'static str, OccupancyGrid)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/maps");
    if !folder.is_dir() {
        eprintln!("passed over: no real maps in {}", folder.display());
    }
    let real = REAL.into_iter().filter_map(move |(name, image, resolution)| {
        let pixels = image::open(folder.join(image)).ok()?.into_luma8();
        // Dark is occupied, white is free, and grey is unknown, where no pose is put.
        let value = |pixel: u8| if pixel < 90 { 100 } else { -i8::from(pixel < 250) };
        let lines = pixels.as_raw().chunks(pixels.width() as usize).rev();
        Some((name, grid(lines.flatten().map(|&pixel| value(pixel)).collect(), pixels.width() as usize, resolution)))
    });
    let made = MADE.into_iter().map(|(name, blocks)| {
        let value = |index: usize| if blocks(index % SIDE, index / SIDE) { 100 } else { 0 };
        (name, grid((0..SIDE * SIDE).map(value).collect(), SIDE, 0.05))
    });
    real.chain(made)
}

fn grid(cells: Vec<i8>, width: usize, resolution: f64) -> OccupancyGrid {
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution, origin, occupied_threshold, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a map")
}

/// Poses uniform in the free space of a grid at the origin.
pub fn poses(grid: &OccupancyGrid, count: usize) -> Vec<[f64; 3]> {
    let free: Vec<usize> = (0..grid.cells().len()).filter(|&index| grid.cells()[index] == 0).collect();
    let mut stream = random::stream(SEED, 0);
    let mut draw = || {
        let index = free[(stream.random::<f64>() * free.len() as f64) as usize];
        let (col, row) = (index % grid.width(), index / grid.width());
        let x = (col as f64 + stream.random::<f64>()) * grid.resolution();
        let y = (row as f64 + stream.random::<f64>()) * grid.resolution();
        [x, y, stream.random::<f64>() * TAU]
    };
    (0..count).map(|_| draw()).collect()
}

/// 541 beams over 270°, up to 600 cells.
pub fn laser(grid: &OccupancyGrid, kernel: Kernel) -> LaserScanner {
    let options = ScannerOptions {
        fov: 0.75 * TAU,
        beam_count: 541,
        max_range: 600.0 * grid.resolution(),
        ..ScannerOptions::default()
    };
    LaserScanner::new(options).expect("a scanner").with_kernel(kernel)
}

/// The kernels of this machine, the plain traversal first.
pub fn kernels() -> impl Iterator<Item = Kernel> {
    Kernel::ALL.into_iter().filter(|kernel| kernel.is_available())
}
