//! `cargo bench --bench ratios [-- MAP...]`: how many times as fast as the plain traversal each kernel is, in one run.
//!
//! Kernels take turns, so that a busy machine slows all of them alike, and in its turn each has a whole batch, so that what it
//! looks up is not in the cache because the one before it looked there. Of the turns the median counts. Single thread.

mod workloads;

use std::time::Instant;

use mobile_robot_simulator::raycast::{Caster, Kernel};
use mobile_robot_simulator::{BeamModel, BeamModelOptions, Noise, Obstacles, OccupancyGrid};

use workloads::{kernels, laser, maps, poses};

const TURNS: usize = 9;

const SCANS: usize = 1000;

const RAYS: usize = 500_000;

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
        let poses = poses(&grid, SCANS);
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
    in_turns(kernels, poses.len() * 541, |kernel, ranges| {
        let laser = laser(grid, kernel);
        let start = Instant::now();
        laser.scan_batch(grid, poses, noise, Some(1), ranges).expect("a scan");
        start.elapsed().as_secs_f64()
    })
}

fn rays(grid: &OccupancyGrid, kernels: &[Kernel]) -> Vec<f64> {
    let rays = poses(grid, RAYS);
    in_turns(kernels, rays.len(), |kernel, ranges| {
        let caster = Caster::new(grid, 600.0 * grid.resolution(), kernel);
        let start = Instant::now();
        caster.cast_rays(Obstacles::NONE, &rays, Some(1), ranges).expect("ranges");
        start.elapsed().as_secs_f64()
    })
}

/// Nanoseconds per range of each kernel, whose turns `cast` takes and times: the median.
fn in_turns(kernels: &[Kernel], count: usize, cast: impl Fn(Kernel, &mut [f32]) -> f64) -> Vec<f64> {
    let mut ranges = vec![0.0; count];
    let mut expected = vec![0.0; count];
    let mut times = vec![Vec::new(); kernels.len()];
    for _ in 0..TURNS {
        for (&kernel, times) in kernels.iter().zip(&mut times) {
            times.push(cast(kernel, &mut ranges));
            if kernel == Kernel::Traversal {
                expected.copy_from_slice(&ranges);
            }
            assert!(ranges == expected, "{} is wrong", kernel.name());
        }
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[TURNS / 2]
    };
    times.into_iter().map(|times| median(times) * 1e9 / count as f64).collect()
}
