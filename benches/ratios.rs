//! `cargo bench --bench ratios [-- MAP...]`: how many times as fast as the plain traversal each kernel is, in one run.
//!
//! Kernels take turns on small pieces of the work, so that a busy machine slows all of them alike; of each piece the median time
//! counts. Single thread.

mod workloads;

use std::time::Instant;

use mobile_robot_simulator::raycast::{Caster, Kernel};
use mobile_robot_simulator::{BeamModel, BeamModelOptions, Noise, Obstacles, OccupancyGrid};

use workloads::{kernels, laser, maps, poses};

const TURNS: usize = 9;

const PIECE: usize = 50;

fn main() {
    let kernels: Vec<Kernel> = kernels().collect();
    println!("{:22}{:>10}", "nanoseconds per", "build");
    print!("{:22}{:>10}", "", "a cell");
    for kernel in &kernels {
        print!("{:>20}", kernel.name());
    }
    println!();
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    for (map, grid) in maps().filter(|(map, _)| wanted.is_empty() || wanted.iter().any(|name| name == map)) {
        let build = build(&grid);
        let poses = poses(&grid, 20 * PIECE);
        line(&format!("scan {map}"), build, &scans(&grid, &poses, &kernels, None));
        let model = BeamModel::new(BeamModelOptions::default()).expect("a model");
        let noise = Noise { model, seed: 1, first_index: 0 };
        line(&format!("with noise {map}"), build, &scans(&grid, &poses, &kernels, Some(noise)));
        line(&format!("rays {map}"), build, &rays(&grid, &kernels));
    }
}

/// Nanoseconds per cell for building what casting needs, the median.
fn build(grid: &OccupancyGrid) -> f64 {
    let mut times: Vec<f64> = (0..TURNS)
        .map(|_| {
            let grid = OccupancyGrid::new(grid.cells().to_vec(), grid.width(), grid.options()).expect("a grid");
            let start = Instant::now();
            grid.prepare(Some(1));
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[TURNS / 2] * 1e9 / grid.cells().len() as f64
}

/// Nanoseconds per range of each kernel, and how many times as fast it is as the first.
fn line(name: &str, build: f64, times: &[f64]) {
    print!("{name:22}{build:>10.1}");
    for time in times {
        print!("{:>20}", format!("{time:.2} {:.2}x", times[0] / time));
    }
    println!();
}

fn scans(grid: &OccupancyGrid, poses: &[[f64; 3]], kernels: &[Kernel], noise: Option<Noise>) -> Vec<f64> {
    let mut readings = vec![0.0; PIECE * 541];
    let mut expected: Option<Vec<f32>> = None;
    let mut scan = |piece: usize, kernel: Kernel| {
        let laser = laser(grid, kernel);
        let start = Instant::now();
        laser.scan_batch(grid, &poses[piece * PIECE..][..PIECE], noise, Some(1), &mut readings).expect("a scan");
        let time = start.elapsed().as_secs_f64();
        if kernel == Kernel::Traversal {
            expected = Some(readings.clone());
        }
        assert!(expected.as_ref() == Some(&readings), "{} is wrong", kernel.name());
        time
    };
    medians(poses.len() / PIECE, kernels, poses.len() * 541, &mut scan)
}

fn rays(grid: &OccupancyGrid, kernels: &[Kernel]) -> Vec<f64> {
    let rays = poses(grid, 20 * PIECE * 200);
    let mut ranges = vec![0.0; PIECE * 200];
    let mut expected: Option<Vec<f32>> = None;
    let mut cast = |piece: usize, kernel: Kernel| {
        let caster = Caster::new(grid, 600.0 * grid.resolution(), kernel);
        let start = Instant::now();
        caster
            .cast_rays(Obstacles::NONE, &rays[piece * ranges.len()..][..ranges.len()], Some(1), &mut ranges)
            .expect("ranges");
        let time = start.elapsed().as_secs_f64();
        if kernel == Kernel::Traversal {
            expected = Some(ranges.clone());
        }
        assert!(expected.as_ref() == Some(&ranges), "{} is wrong", kernel.name());
        time
    };
    medians(20, kernels, rays.len(), &mut cast)
}

/// Nanoseconds per range of each kernel: the sum over the pieces of the median time of each.
fn medians(pieces: usize, kernels: &[Kernel], count: usize, time: &mut impl FnMut(usize, Kernel) -> f64) -> Vec<f64> {
    let mut sums = vec![0.0; kernels.len()];
    for piece in 0..pieces {
        let turns: Vec<Vec<f64>> = (0..TURNS).map(|_| kernels.iter().map(|&kernel| time(piece, kernel)).collect()).collect();
        for (which, sum) in sums.iter_mut().enumerate() {
            let mut times: Vec<f64> = turns.iter().map(|turn| turn[which]).collect();
            times.sort_by(f64::total_cmp);
            *sum += times[TURNS / 2];
        }
    }
    sums.iter().map(|sum| sum * 1e9 / count as f64).collect()
}
