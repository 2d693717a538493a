//! `cargo bench --bench world`: obstacles and mounts in a scan, and steps of a robot near walls and far from them.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mobile_robot_simulator::{
    ContactMode, GridOptions, LaserScanner, Mount, OCCUPIED_THRESHOLD, Obstacles, OccupancyGrid, Pose, ScannerOptions,
    Shape, Twist, Unknown, advance, clearance,
};

/// Returns a map of 40 m by 40 m with cells of 5 cm: rooms of 5 m by 4 m, walls of 0.1 m and doors of 1 m.
fn rooms() -> OccupancyGrid {
    let wall = |along: usize, across: usize, size: usize| across % size < 2 && !(40..60).contains(&(along % 100));
    let cells = (0..640_000).map(|index| (index % 800, index / 800));
    let cells = cells.map(|(col, row)| if wall(row, col, 100) || wall(col, row, 80) { 100 } else { 0 }).collect();
    let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution: 0.05, origin, occupied_threshold, unknown: Unknown::Free };
    OccupancyGrid::new(cells, 800, options).expect("a good grid")
}

/// Returns twenty robots around the one that scans, discs and rectangles in turn.
fn others() -> Obstacles {
    let shapes = [Shape::disc(0.2).unwrap(), Shape::rectangle(0.6, 0.4).unwrap()];
    let pose = |index: usize| {
        let bearing = index as f64 * 0.3;
        let distance = 1.0 + 0.2 * index as f64;
        Pose::new(12.5 + distance * bearing.cos(), 10.0 + distance * bearing.sin(), bearing)
    };
    Obstacles::new((0..20).map(|index| (&shapes[index % 2], pose(index)))).unwrap()
}

fn scans(criterion: &mut Criterion) {
    let (grid, others) = (rooms(), others());
    let scanner = LaserScanner::new(ScannerOptions::default()).unwrap();
    let mut ranges = [0.0; 541];
    let mut group = criterion.benchmark_group("scan/rooms_541");
    for (name, obstacles) in [("obstacles_0", Obstacles::NONE), ("obstacles_20", &others)] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| scanner.scan((&grid, obstacles), black_box(Pose::new(12.5, 10.0, 0.3)), &mut ranges));
        });
        // The nearest wall is less than 2.6 m away, the nearest obstacle less than 0.81 m.
        let bound = if obstacles.is_empty() { 2.6 } else { 0.81 };
        assert!(ranges.iter().fold(f32::INFINITY, |a, &b| a.min(b)) < bound);
    }
    let mounts = [("upside_down", [std::f64::consts::PI, 0.0, 0.0]), ("tilted", [0.1, 0.1, 0.0])];
    for (name, rotation) in mounts {
        let mount = Mount::new([0.0, 0.0, 0.4], rotation);
        let scanner = LaserScanner::new(ScannerOptions { mount, ..ScannerOptions::default() }).unwrap();
        group.bench_function(name, |bencher| {
            bencher.iter(|| scanner.scan(&grid, black_box(Pose::new(12.5, 10.0, 0.3)), &mut ranges));
        });
        assert!(ranges.iter().all(|&range| range > 0.0));
    }
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    let (grid, others) = (rooms(), others());
    let footprints = [("disc", Shape::disc(0.2).unwrap()), ("rectangle", Shape::rectangle(0.6, 0.4).unwrap())];
    // Far from all walls, along a wall at a distance of 0.1 m, and pressed against a wall.
    let places =
        [("far", 12.5, 10.0, 0.0), ("along", 10.4, 10.7, std::f64::consts::FRAC_PI_2), ("pressed", 10.4, 10.7, 3.0)];
    for (footprint_name, footprint) in &footprints {
        let mut group = criterion.benchmark_group(format!("advance/{footprint_name}"));
        for (place, x, y, yaw) in places {
            for (mode_name, mode) in [("stop", ContactMode::Stop), ("slide", ContactMode::Slide)] {
                let twist = Twist::from([0.5, 0.0, 0.1]);
                let mut start = Pose::new(x, y, yaw);
                if place == "pressed" {
                    for _ in 0..50 {
                        start = advance(&grid, footprint, start, twist, 0.02, ContactMode::Stop).unwrap().0;
                    }
                }
                let step = || advance(&grid, footprint, black_box(start), twist, 0.02, mode).unwrap();
                assert_eq!(step().1.is_some(), place == "pressed");
                group.bench_function(format!("{place}/{mode_name}"), |bencher| bencher.iter(step));
            }
        }
        let start = Pose::new(12.5, 10.0, 0.0);
        let twist = Twist::from([0.5, 0.0, 0.1]);
        group.bench_function("among_20/stop", |bencher| {
            bencher.iter(|| advance((&grid, &others), footprint, black_box(start), twist, 0.02, ContactMode::Stop).unwrap());
        });
        group.bench_function("clearance_10m", |bencher| {
            bencher.iter(|| clearance(&grid, footprint, black_box(start), 10.0).unwrap());
        });
        group.finish();
    }
}

criterion_group!(benches, scans, steps);
criterion_main!(benches);
