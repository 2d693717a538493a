//! `cargo bench --bench ratios [-- MAP...]`: speed of each kernel relative to the plain traversal, in one run.
//!
//! A MAP is the name of a map in `workloads`, or the image of a map with cells of 5 cm. Without one, all named maps are used.
//!
//! Kernels take turns, so a busy machine slows all of them equally. In its turn a kernel casts a whole batch, so it does not
//! profit from what the kernel before it left in the cache. Figures are medians of the turns, on one thread.

mod workloads;

use std::path::Path;
use std::time::Instant;

use mobile_robot_simulator::raycast::{Caster, Kernel};
use mobile_robot_simulator::{BeamModel, BeamModelOptions, Noise, Obstacles, OccupancyGrid};

use workloads::{kernels, laser, maps, poses, read};

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
    let (images, names): (Vec<_>, Vec<_>) = wanted.iter().map(Path::new).partition(|map| map.extension().is_some());
    for image in &images {
        let grid = read(image, 0.05).unwrap_or_else(|error| panic!("{}: {error}", image.display()));
        measure(&image.file_stem().unwrap_or_default().to_string_lossy(), &grid, &kernels);
    }
    for (map, grid) in maps().filter(|(map, _)| wanted.is_empty() || names.contains(&Path::new(map))) {
        measure(map, &grid, &kernels);
    }
}

/// Measures all kernels on a map and prints a line for each kind of batch.
fn measure(map: &str, grid: &OccupancyGrid, kernels: &[Kernel]) {
    let build = build(grid);
    let [scans, noisy] = scans(grid, kernels);
    line(&format!("scan {map}"), build, &scans, |nth| scans[0] / scans[nth]);
    // Relative to the same scans without noise.
    line(&format!("with noise {map}"), build, &noisy, |nth| noisy[nth] / scans[nth]);
    let [rays] = rays(grid, kernels);
    line(&format!("rays {map}"), build, &rays, |nth| rays[0] / rays[nth]);
}

/// Returns the nanoseconds per cell to build the free boxes: the median of several runs.
fn build(grid: &OccupancyGrid) -> f64 {
    let times = (0..TURNS).map(|_| {
        let grid = OccupancyGrid::new(grid.cells().to_vec(), grid.width(), grid.options()).expect("a grid");
        let start = Instant::now();
        grid.prepare(Some(1)).expect("enough memory");
        start.elapsed().as_secs_f64()
    });
    median(times.collect()) * 1e9 / grid.cells().len() as f64
}

/// Prints a line: nanoseconds per range of each kernel, and a ratio.
fn line(name: &str, build: f64, times: &[f64], ratio: impl Fn(usize) -> f64) {
    print!("{name:22}{build:>10.1}");
    for (nth, time) in times.iter().enumerate() {
        print!("{:>20}", format!("{time:.2} {:.2}x", ratio(nth)));
    }
    println!();
}

/// Returns the nanoseconds per range of scans without noise, and of scans with noise.
fn scans(grid: &OccupancyGrid, kernels: &[Kernel]) -> [Vec<f64>; 2] {
    let poses = poses(grid, SCANS);
    let model = BeamModel::new(BeamModelOptions::default()).expect("a model");
    let noise = [None, Some(Noise { model, surface: None, seed: 1, first_index: 0 })];
    in_turns(kernels, poses.len() * 541, |kernel, way, ranges| {
        laser(grid, kernel, 541).scan_batch(grid, &poses, noise[way], Some(1), ranges).expect("a scan");
    })
}

fn rays(grid: &OccupancyGrid, kernels: &[Kernel]) -> [Vec<f64>; 1] {
    let rays = poses(grid, RAYS);
    in_turns(kernels, rays.len(), |kernel, _, ranges| {
        let caster = Caster::new(grid, 600.0 * grid.resolution(), kernel).expect("a range");
        caster.cast_rays(Obstacles::NONE, &rays, Some(1), ranges).expect("ranges");
    })
}

/// Returns the nanoseconds per range of each kernel, for each way to `cast`: the median of its turns.
fn in_turns<const WAYS: usize>(
    kernels: &[Kernel],
    count: usize,
    cast: impl Fn(Kernel, usize, &mut [f32]),
) -> [Vec<f64>; WAYS] {
    let mut ranges = vec![0.0; count];
    let mut expected = vec![vec![0.0; count]; WAYS];
    let mut times = vec![vec![Vec::new(); kernels.len()]; WAYS];
    for _ in 0..TURNS {
        for (nth, &kernel) in kernels.iter().enumerate() {
            for way in 0..WAYS {
                let start = Instant::now();
                cast(kernel, way, &mut ranges);
                times[way][nth].push(start.elapsed().as_secs_f64());
                if kernel == Kernel::Traversal {
                    expected[way].copy_from_slice(&ranges);
                }
                assert!(ranges == expected[way], "{} is wrong", kernel.name());
            }
        }
    }
    std::array::from_fn(|way| times[way].iter().map(|times| median(times.clone()) * 1e9 / count as f64).collect())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
