//! Glass and mirrors: the same bytes from every kernel, and what a beam loses on its way.

use std::sync::Arc;

use mobile_robot_simulator::random::stream;
use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    Courses, GridOptions, LaserScanner, Material, Materials, Obstacles, OccupancyGrid, Pose, ScannerOptions, Shape, Sweeps,
    Unknown,
};
use rand::RngExt;

const SEED: u64 = 20;
const SIDE: usize = 80;

/// Returns a grid with random blocks of all materials.
fn grid() -> OccupancyGrid {
    let mut stream = stream(SEED, 0);
    let mut cells = vec![0; SIDE * SIDE];
    let mut numbers = vec![0; SIDE * SIDE];
    for cell in 0..SIDE * SIDE {
        if stream.random::<f64>() < 0.03 {
            (cells[cell], numbers[cell]) = (100, stream.random_range(0..4));
        }
    }
    let options =
        GridOptions { resolution: 0.1, origin: Pose::new(-1.0, 2.0, 0.3), occupied_threshold: 60, unknown: Unknown::Free };
    let table = Material::NAMED.map(|(_, material)| material).to_vec();
    let materials = Materials::new(numbers, SIDE, table).expect("valid materials");
    let grid = OccupancyGrid::new(cells, SIDE, options).expect("a valid grid");
    grid.with_materials(Some(Arc::new(materials))).expect("the same shape")
}

#[test]
fn all_kernels_give_the_same_bytes() {
    let grid = grid();
    let plate = Shape::rectangle(0.5, 0.1).and_then(|plate| plate.with_material(Material::MIRROR)).expect("a plate");
    let obstacles = Obstacles::new([(&plate, Pose::new(2.0, 5.0, 1.0))]).expect("an obstacle");
    let laser = LaserScanner::new(ScannerOptions { beam_count: 200, ..ScannerOptions::default() }).expect("a scanner");
    let poses = [[1.0, 5.0, 0.0], [2.0, 6.0, 2.0], [-5.0, -3.0, 0.8], [0.0, 4.0, -2.0]];
    let scan = |kernel| {
        let mut ranges = vec![0.0; poses.len() * 200];
        let laser = laser.clone().with_kernel(kernel);
        laser.scan_batch((&grid, &obstacles), &poses, None, None, &mut ranges).expect("valid poses");
        ranges
    };
    let plain = scan(Kernel::Traversal);
    let direct = grid.try_clone().and_then(|grid| grid.with_materials(None)).expect("the same grid");
    let mut without = vec![0.0; poses.len() * 200];
    laser.scan_batch(&direct, &poses, None, None, &mut without).expect("valid poses");
    assert!(plain.iter().zip(&without).filter(|(a, b)| a != b).count() > 100, "the materials must matter");
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
        assert_eq!(scan(kernel), plain, "{kernel:?}");
    }
}

#[test]
fn all_kernels_give_the_same_intensities() {
    let grid = grid();
    let plate = Shape::rectangle(0.5, 0.1).and_then(|plate| plate.with_material(Material::GLASS)).expect("a plate");
    let obstacles = Obstacles::new([(&plate, Pose::new(2.0, 5.0, 1.0))]).expect("an obstacle");
    let laser = LaserScanner::new(ScannerOptions { beam_count: 200, ..ScannerOptions::default() }).expect("a scanner");
    let poses = [[1.0, 5.0, 0.0], [2.0, 6.0, 2.0], [-5.0, -3.0, 0.8], [0.0, 4.0, -2.0]];
    let courses = Courses::Arcs { poses: &poses, twists: &[[0.3, 0.1, 1.0]; 4] };
    for stream in [None, Some((SEED, 3))] {
        let intensities = |kernel| {
            let (mut instant, mut swept) = (vec![0.0; poses.len() * 200], vec![0.0; poses.len() * 200]);
            let laser = laser.clone().with_kernel(kernel);
            laser.intensities((&grid, &obstacles), &poses, stream, None, &mut instant).expect("valid poses");
            let sweeps = Sweeps { courses, scan_duration: 0.1, obstacles: &[] };
            laser.intensities_of_sweeps(&grid, sweeps, stream, Some(2), &mut swept).expect("valid poses");
            [instant, swept].map(|intensities| intensities.into_iter().map(f32::to_bits).collect::<Vec<u32>>())
        };
        let plain = intensities(Kernel::Traversal);
        assert!(plain.iter().all(|bits| bits.iter().filter(|&&bits| bits != 0).count() > 200), "most beams return");
        for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
            assert!(intensities(kernel) == plain, "{kernel:?}");
        }
    }
}
