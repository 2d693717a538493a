//! Maps and poses to measure on.

use std::f64::consts::TAU;
use std::path::Path;

use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    BeamLayout, GridOptions, LaserScanner, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, ScannerOptions, Unknown, random,
};
use rand::RngExt;

const SEED: u64 = 5;

/// Real maps, in a folder beside the project: name, image, metres per cell. Skipped if the folder is absent.
const REAL: [(&str, &str, f64); 5] = [
    // Long corridors: few jumps, far apart in memory.
    ("hallways", "rl_basement_hallways_5cm/basement_hallways_5cm.png", 0.05),
    // Cluttered offices: many short jumps.
    ("willow", "willow_2010_0.10/willow-2010-02-18-0.10.pgm", 0.10),
    // One large hall.
    ("depot", "nav2_depot/depot.pgm", 0.05),
    // Small: ranges are short, so the constant cost of a beam shows.
    ("sandbox", "nav2_tb3_sandbox/tb3_sandbox.pgm", 0.05),
    // 45 million cells: larger than any cache.
    ("huge", "rl_huge/huge_map.png", 0.05),
];

/// Returns true if a cell of a map of [`SIDE`] by [`SIDE`] cells blocks, from its column and row.
type Blocks = fn(usize, usize) -> bool;

const SIDE: usize = 2000;

const GENERATED: [(&str, Blocks); 5] = [
    // Nothing to hit: a plain traversal walks to the maximum range.
    ("empty", |_, _| false),
    // Every jump is one cell: jumping gains nothing.
    ("checkerboard", |col, row| (col + row) % 2 == 0),
    // One cell in five blocks, at random: rays and jumps are short.
    ("clutter", |col, row| scattered(col, row).is_multiple_of(5)),
    // Walls along grid lines: beams that graze them meet short boxes all the way.
    ("grid_lines", |_, row| row % 30 == 0),
    // Walls at 45°: every box ends at a corner of a wall.
    ("diagonal", |col, row| (col + row) % 200 == 0),
];

/// Returns a pseudo-random number for a column and row.
fn scattered(col: usize, row: usize) -> usize {
    (col.wrapping_mul(0x9e37_79b9) ^ row.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35) >> 15 & 0xffff
}

/// Returns the real maps that are present, and the generated maps.
pub fn maps() -> impl Iterator<Item = (&'static str, OccupancyGrid)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/maps");
    if !folder.is_dir() {
        eprintln!("skipped: no real maps in {}", folder.display());
    }
    let real = REAL
        .into_iter()
        .filter_map(move |(name, image, resolution)| Some((name, read(&folder.join(image), resolution).ok()?)));
    let generated = GENERATED.into_iter().map(|(name, blocks)| {
        let value = |index: usize| if blocks(index % SIDE, index / SIDE) { 100 } else { 0 };
        (name, grid((0..SIDE * SIDE).map(value).collect(), SIDE, 0.05))
    });
    real.chain(generated)
}

/// Reads a map from an image. Dark is occupied, white is free, grey is unknown. Poses are in free cells only.
pub fn read(image: &Path, resolution: f64) -> Result<OccupancyGrid, image::ImageError> {
    let pixels = image::open(image)?.into_luma8();
    let value = |pixel: u8| if pixel < 90 { 100 } else { -i8::from(pixel < 250) };
    let lines = pixels.as_raw().chunks(pixels.width() as usize).rev();
    Ok(grid(lines.flatten().map(|&pixel| value(pixel)).collect(), pixels.width() as usize, resolution))
}

fn grid(cells: Vec<i8>, width: usize, resolution: f64) -> OccupancyGrid {
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution, origin, occupied_threshold, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a map")
}

/// Returns poses drawn uniformly from the free space of a grid at the origin.
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

/// Returns a scanner with a field of 270° and a maximum range of 600 cells.
pub fn laser(grid: &OccupancyGrid, kernel: Kernel, beam_count: usize) -> LaserScanner {
    let options = ScannerOptions {
        layout: BeamLayout::Fov(0.75 * TAU),
        beam_count,
        max_range: 600.0 * grid.resolution(),
        ..ScannerOptions::default()
    };
    LaserScanner::new(options).expect("a scanner").with_kernel(kernel)
}

/// Returns the kernels that this machine can run, the plain traversal first.
pub fn kernels() -> impl Iterator<Item = Kernel> {
    Kernel::ALL.into_iter().filter(|kernel| kernel.is_available())
}
