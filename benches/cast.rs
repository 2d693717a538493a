//! `cargo bench --bench cast`: scans and rays on many maps, with every kernel. Ids are workload/map/kernel.

mod workloads;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mobile_robot_simulator::raycast::{Caster, Kernel};
use mobile_robot_simulator::{BeamModel, BeamModelOptions, Noise, Obstacles};

use workloads::{kernels, laser, maps, poses};

const SCANS: usize = 100;

fn scan(criterion: &mut Criterion) {
    scans(criterion, "scan", None);
}

fn noisy_scan(criterion: &mut Criterion) {
    let model = BeamModel::new(BeamModelOptions::default()).expect("a model");
    scans(criterion, "noisy_scan", Some(Noise { model, surface: None, seed: 1, first_index: 0 }));
}

fn scans(criterion: &mut Criterion, workload: &str, noise: Option<Noise>) {
    for (map, grid) in maps() {
        let poses = poses(&grid, SCANS);
        let mut group = criterion.benchmark_group(format!("{workload}/{map}"));
        let ranges = |kernel| {
            let mut ranges = vec![0.0; SCANS * 541];
            laser(&grid, kernel, 541).scan_batch(&grid, &poses, noise, Some(1), &mut ranges).expect("a scan");
            ranges
        };
        let expected = ranges(Kernel::Traversal);
        group.throughput(Throughput::Elements(expected.len() as u64));
        for kernel in kernels() {
            assert!(ranges(kernel) == expected, "{map} by {}", kernel.name());
            let (laser, mut ranges) = (laser(&grid, kernel, 541), vec![0.0; expected.len()]);
            group.bench_function(kernel.name(), |bencher| {
                bencher.iter(|| laser.scan_batch(&grid, &poses, noise, Some(1), &mut ranges));
            });
        }
    }
}

fn rays(criterion: &mut Criterion) {
    for (map, grid) in maps() {
        let rays = poses(&grid, 20_000);
        let mut group = criterion.benchmark_group(format!("rays/{map}"));
        group.throughput(Throughput::Elements(rays.len() as u64));
        let max_range = 600.0 * grid.resolution();
        let ranges = |kernel| {
            let mut ranges = vec![0.0; rays.len()];
            Caster::new(&grid, max_range, kernel)
                .expect("a range")
                .cast_rays(Obstacles::NONE, &rays, Some(1), &mut ranges)
                .expect("ranges");
            ranges
        };
        let expected = ranges(Kernel::Traversal);
        for kernel in kernels() {
            assert!(ranges(kernel) == expected, "{map} by {}", kernel.name());
            let (caster, mut ranges) = (Caster::new(&grid, max_range, kernel).expect("a range"), vec![0.0; rays.len()]);
            group.bench_function(kernel.name(), |bencher| {
                bencher.iter(|| caster.cast_rays(Obstacles::NONE, &rays, Some(1), &mut ranges));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = scan, noisy_scan, rays
}
criterion_main!(benches);
