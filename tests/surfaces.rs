//! Readings that depend on surfaces: the same bytes for every kernel, for scans that take no time, and for any threads.

use std::f64::consts::TAU;
use std::sync::Arc;

use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    BeamLayout, BeamModel, BeamModelOptions, Course, Courses, GridOptions, LaserScanner, Material, Materials,
    MovingObstacle, Noise, Obstacles, OccupancyGrid, Pose, ScannerOptions, Shape, SurfaceModel, SurfaceOptions, Sweeps,
    Twist, Unknown, random,
};
use rand::RngExt;

const SIDE: usize = 200;

/// A room of 20 m with slanting walls and cells that block here and there.
fn room() -> OccupancyGrid {
    let mut stream = random::stream(3, 0);
    let cells = (0..SIDE * SIDE).map(|index| {
        let (col, row) = (index % SIDE, index / SIDE);
        let is_slanting = (2 * col + 3 * row) % 170 < 4 && row % 40 > 10;
        i8::from(row == 0 || col == 0 || is_slanting || stream.random_range(0..200) == 0) * 100
    });
    let origin = Pose::new(-5.0, -4.0, 0.2);
    let options = GridOptions { resolution: 0.1, origin, occupied_threshold: 60, unknown: Unknown::Free };
    OccupancyGrid::new(cells.collect(), SIDE, options).expect("a good grid")
}

/// The same room with walls of all materials, in squares of ten cells.
fn room_of_materials() -> OccupancyGrid {
    let numbers = (0..SIDE * SIDE).map(|index| (index % SIDE / 10 + index / SIDE / 10) as u8 % 4).collect();
    let table = Material::NAMED.map(|(_, material)| material).to_vec();
    let materials = Materials::new(numbers, SIDE, table).expect("good materials");
    room().with_materials(Some(Arc::new(materials))).expect("the same shape")
}

fn noise(first_index: u64) -> Noise {
    let model =
        BeamModelOptions { range_sigma_per_metre: 0.01, range_step: 0.001, z_rand: 0.1, ..BeamModelOptions::default() };
    let surface = SurfaceOptions {
        incidence_sigma: 0.5,
        incidence_bias: 0.03,
        correlation: 0.4,
        reference_range: 8.0,
        beam_divergence: 0.02,
        ..SurfaceOptions::default()
    };
    Noise {
        model: BeamModel::new(model).expect("a good model"),
        surface: Some(SurfaceModel::new(surface).expect("a good model")),
        seed: 4,
        first_index,
    }
}

fn poses() -> Vec<[f64; 3]> {
    let mut stream = random::stream(4, 0);
    (0..120).map(|_| [24.0, 24.0, TAU].map(|size| (stream.random::<f64>() - 0.3) * size)).collect()
}

fn laser(kernel: Kernel) -> LaserScanner {
    let options =
        ScannerOptions { layout: BeamLayout::Fov(TAU), beam_count: 100, max_range: 15.0, ..ScannerOptions::default() };
    LaserScanner::new(options).expect("a good scanner").with_kernel(kernel)
}

#[test]
fn all_kernels_and_threads_give_the_same_bytes() {
    for grid in [room(), room_of_materials()] {
        check_kernels_and_threads(&grid);
    }
}

fn check_kernels_and_threads(grid: &OccupancyGrid) {
    let (poses, disc) = (poses(), Shape::disc(0.5).expect("a disc"));
    let mirror = disc.clone().with_material(Material::MIRROR).expect("a mirror");
    let obstacles = Obstacles::new([(&disc, Pose::new(3.0, 4.0, 0.0)), (&mirror, Pose::new(7.0, 6.0, 0.0))]).expect("discs");
    let scan = |kernel, threads, chunk: usize| {
        let mut readings = vec![0.0; poses.len() * 100];
        for (index, (poses, readings)) in poses.chunks(chunk).zip(readings.chunks_mut(chunk * 100)).enumerate() {
            let noise = noise((index * chunk) as u64);
            laser(kernel).scan_batch((grid, &obstacles), poses, Some(noise), Some(threads), readings).expect("a scan");
        }
        readings
    };
    let plain = scan(Kernel::Traversal, 1, 1);
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
        for (threads, chunk) in [(1, 120), (3, 120), (2, 17)] {
            assert!(scan(kernel, threads, chunk) == plain, "{kernel:?}, {threads} threads, chunks of {chunk}");
        }
    }
}

#[test]
fn scans_that_take_no_time_have_the_bytes_of_an_instant() {
    let (grid, poses, disc) = (room_of_materials(), poses(), Shape::disc(0.5).expect("a disc"));
    let at = Pose::new(3.0, 4.0, 0.0);
    let obstacles = Obstacles::new([(&disc, at)]).expect("a disc");
    let twists: Vec<[f64; 3]> = poses.iter().map(|[x, y, _]| [0.1 * x, 0.1 * y, 1.0]).collect();
    let course = Course::Arc { start: at, twist: Twist::from([1.0, 0.0, 0.5]) };
    let moving = [MovingObstacle { shape: &disc, course }];
    let mut instant = vec![0.0; poses.len() * 100];
    laser(Kernel::Traversal).scan_batch((&grid, &obstacles), &poses, Some(noise(0)), Some(1), &mut instant).expect("a scan");
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
        let sweep = |scan_duration: f64, threads: usize| {
            let courses = Courses::Arcs { poses: &poses, twists: &twists };
            let sweeps = Sweeps { courses, scan_duration, obstacles: &moving };
            let mut readings = vec![0.0; poses.len() * 100];
            laser(kernel).sweep_batch(&grid, sweeps, Some(noise(0)), Some(threads), &mut readings).expect("a scan");
            readings
        };
        assert!(sweep(0.0, 2) == instant, "{kernel:?}");
        assert!(sweep(0.1, 1) == sweep(0.1, 3) && sweep(0.1, 1) != instant);
    }
}
