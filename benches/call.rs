//! `cargo bench --bench call -- FOLDER WIDTH RESOLUTION`: the Rust side of `throughput.py`.
//!
//! Reads the map and the poses that `throughput.py` wrote to FOLDER. For each number on standard input it casts that many
//! scans and prints the seconds they took.

use std::io::{Write, stdin, stdout};
use std::path::Path;
use std::time::Instant;

use mobile_robot_simulator::{
    BeamLayout, GridOptions, LaserScanner, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, ScannerOptions, Unknown,
};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let [folder, width, resolution] = &arguments[..] else { panic!("needed: FOLDER WIDTH RESOLUTION, got: {arguments:?}") };
    let read = |name: &str| std::fs::read(Path::new(folder).join(name)).expect("a file of throughput.py");
    let cells = read("cells").into_iter().map(u8::cast_signed).collect();
    let resolution = resolution.parse().expect("metres per cell");
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution, origin, occupied_threshold, unknown: Unknown::Free };
    let grid = OccupancyGrid::new(cells, width.parse().expect("columns"), options).expect("a map");
    let numbers = read("poses");
    let poses: Vec<[f64; 3]> = numbers
        .as_chunks::<24>()
        .0
        .iter()
        .map(|row| std::array::from_fn(|axis| f64::from_le_bytes(*row[8 * axis..].first_chunk().expect("a float64"))))
        .collect();
    let options = ScannerOptions {
        layout: BeamLayout::Fov(0.75 * std::f64::consts::TAU),
        beam_count: 541,
        max_range: 600.0 * resolution,
        ..ScannerOptions::default()
    };
    let laser = LaserScanner::new(options).expect("a scanner");
    let mut ranges = vec![0.0; poses.len() * 541];
    for line in stdin().lines() {
        let count: usize = line.expect("a line").trim().parse().expect("a number of scans");
        let start = Instant::now();
        laser.scan_batch(&grid, &poses[..count], None, Some(1), &mut ranges[..count * 541]).expect("scans");
        println!("{:e}", start.elapsed().as_secs_f64());
        stdout().flush().expect("a reader");
    }
}
