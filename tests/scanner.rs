//! Laser scanners: beam angles, single scans, batches, noise, invalid readings.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use mobile_robot_simulator::raycast::{Caster, Kernel};
use mobile_robot_simulator::{
    BeamLayout, BeamModel, BeamModelOptions, GridOptions, LaserScanner, NoReturn, Noise, OCCUPIED_THRESHOLD, Obstacles,
    OccupancyGrid, Pose, ScannerOptions, Shape, Unknown,
};
use rayon::prelude::*;

const SEED: u64 = 11;

/// A room of 10 m by 6 m with a pillar. The walls are one cell of 0.1 m thick.
fn room() -> OccupancyGrid {
    let (width, height) = (100, 60);
    let wall = |col, row| col == 0 || row == 0 || col == width - 1 || row == height - 1;
    let pillar = |col, row| (40..45).contains(&col) && (20..25).contains(&row);
    let cells = (0..width * height)
        .map(|index| (index % width, index / width))
        .map(|(col, row)| if wall(col, row) || pillar(col, row) { 100 } else { 0 })
        .collect();
    let options = GridOptions {
        resolution: 0.1,
        origin: Pose::new(-1.0, 2.0, 0.3),
        occupied_threshold: OCCUPIED_THRESHOLD,
        unknown: Unknown::Free,
    };
    OccupancyGrid::new(cells, width, options).expect("a room")
}

fn scanner(options: ScannerOptions) -> LaserScanner {
    LaserScanner::new(options).expect("a good scanner")
}

fn poses(count: usize) -> Vec<[f64; 3]> {
    let grid = room();
    (0..count as u64).map(|seed| grid.draw_free_pose(0.1, seed).expect("a free place").to_array()).collect()
}

#[test]
fn the_first_and_last_beam_are_at_the_ends_of_the_field_of_view() {
    let laser = scanner(ScannerOptions { layout: BeamLayout::Fov(PI), beam_count: 5, ..ScannerOptions::default() });
    let angles: Vec<f64> = (0..5).map(|beam| laser.angle(beam)).collect();
    assert_eq!(angles, [-FRAC_PI_2, -FRAC_PI_2 / 2.0, 0.0, FRAC_PI_2 / 2.0, FRAC_PI_2]);
    assert_eq!((laser.angle_min(), laser.angle_max()), (-FRAC_PI_2, FRAC_PI_2));
}

#[test]
#[allow(clippy::approx_constant, reason = "drivers round it")]
fn in_a_full_turn_no_two_beams_point_in_the_same_direction() {
    for fov in [TAU, TAU - 1e-7, TAU + 1e-7, 6.2832] {
        let laser = scanner(ScannerOptions { layout: BeamLayout::Fov(fov), beam_count: 8, ..ScannerOptions::default() });
        assert_eq!(laser.angle_increment(), fov / 8.0);
        assert_eq!(laser.angle_max(), laser.angle_min() + 7.0 * laser.angle_increment());
    }
    let nearly = scanner(ScannerOptions { layout: BeamLayout::Fov(TAU - 3e-5), beam_count: 8, ..ScannerOptions::default() });
    assert_eq!(nearly.angle_increment(), (TAU - 3e-5) / 7.0);
}

#[test]
fn a_single_beam_points_straight_ahead() {
    let laser = scanner(ScannerOptions { beam_count: 1, ..ScannerOptions::default() });
    assert_eq!((laser.angle_min(), laser.angle_max(), laser.angle_increment()), (0.0, 0.0, 0.0));
}

#[test]
fn a_mounted_scanner_sees_what_a_robot_at_its_pose_would_see() {
    let grid = room();
    let mount = Pose::new(0.4, -0.2, 1.1);
    let base = Pose::new(2.0, 4.5, -0.4);
    let (mut mounted, mut moved) = (vec![0.0; 541], vec![0.0; 541]);
    scanner(ScannerOptions { mount: mount.into(), ..ScannerOptions::default() })
        .scan(&grid, base, &mut mounted)
        .expect("a kernel");
    scanner(ScannerOptions::default()).scan(&grid, base * mount, &mut moved).expect("a kernel");
    assert_eq!(mounted, moved);
}

#[test]
fn end_points_lie_on_walls() {
    let grid = room();
    let laser = scanner(ScannerOptions::default());
    for pose in poses(20) {
        let mut ranges = vec![0.0; 541];
        laser.scan(&grid, pose.into(), &mut ranges).expect("a kernel");
        for [x, y] in laser.end_points(pose.into(), &ranges).expect("as many ranges as beams") {
            // The end point is on the surface of a wall up to float32 rounding, so a disc of 0.01 mm around it is not free.
            assert_eq!(grid.is_free_disc([x, y].into(), 1e-5), Ok(false), "({x}, {y})");
        }
    }
}

#[test]
fn a_batch_does_not_depend_on_threads_or_chunks() {
    let (grid, laser, poses) = (room(), scanner(ScannerOptions::default()), poses(64));
    let model = BeamModelOptions { z_hit: 0.7, z_short: 0.1, z_max: 0.1, z_rand: 0.1, ..BeamModelOptions::default() };
    let model = BeamModel::new(model).expect("a good model");
    for noisy in [false, true] {
        let noise = |first_index| noisy.then_some(Noise { model, surface: None, seed: SEED, first_index });
        let batch = |threads, chunk: usize| {
            let mut readings = vec![0.0; poses.len() * 541];
            for (index, (poses, readings)) in poses.chunks(chunk).zip(readings.chunks_mut(chunk * 541)).enumerate() {
                let first = 5 + (index * chunk) as u64;
                laser.scan_batch(&grid, poses, noise(first), threads, readings).expect("a good batch");
            }
            readings
        };
        let whole = batch(Some(1), poses.len());
        assert!(whole.iter().all(|reading| (0.0..=30.0).contains(reading)));
        for (threads, chunk) in [(Some(2), 64), (Some(8), 64), (None, 64), (Some(1), 1), (Some(3), 7), (None, 33)] {
            assert_eq!(batch(threads, chunk), whole, "{threads:?} threads, chunks of {chunk}");
        }
        if !noisy {
            for (pose, ranges) in poses.iter().zip(whole.chunks(541)) {
                let mut alone = vec![0.0; 541];
                laser.scan(&grid, (*pose).into(), &mut alone).expect("a kernel");
                assert_eq!(alone, ranges);
            }
        }
    }
}

#[test]
fn large_batches_on_large_maps_keep_their_order() {
    let cells = (0..600 * 500).map(|index| if index % 600 % 37 == 0 && index / 600 % 29 == 3 { 100 } else { 0 }).collect();
    let (origin, occupied_threshold) = (Pose::new(-1.0, 2.0, 0.3), OCCUPIED_THRESHOLD);
    let options = GridOptions { resolution: 0.1, origin, occupied_threshold, unknown: Unknown::Free };
    let grid = OccupancyGrid::new(cells, 600, options).expect("a hall");
    let laser = scanner(ScannerOptions { beam_count: 101, ..ScannerOptions::default() });
    let poses: Vec<[f64; 3]> =
        (0..1100_u64).map(|seed| grid.draw_free_pose(0.1, seed).expect("a free place").to_array()).collect();
    let model = BeamModel::new(BeamModelOptions::default()).expect("a good model");
    let batch = |threads, chunk: usize| {
        let mut readings = vec![0.0; poses.len() * 101];
        for (index, (poses, readings)) in poses.chunks(chunk).zip(readings.chunks_mut(chunk * 101)).enumerate() {
            let noise = Noise { model, surface: None, seed: SEED, first_index: (index * chunk) as u64 };
            laser.scan_batch(&grid, poses, Some(noise), threads, readings).expect("a good batch");
        }
        readings
    };
    // Batches of ten are cast in their own order.
    let expected = batch(Some(1), 10);
    for threads in [Some(1), Some(3), None] {
        assert!(batch(threads, poses.len()) == expected, "{threads:?} threads");
    }
}

#[test]
fn scans_of_a_batch_equal_scans_cast_alone() {
    let (room, disc) = (room(), Shape::disc(0.4).expect("a good disc"));
    // On a checkerboard every scan starts in a dense area, where the portable and AVX2 kernels use another method.
    let cells =
        (0..room.cells().len()).map(|index| if (index % room.width() + index / room.width()) % 2 == 0 { 100 } else { 0 });
    let checkerboard = OccupancyGrid::new(cells.collect(), room.width(), room.options()).expect("a checkerboard");
    let cells = (0..room.cells().len()).map(|index| (if index % 100 < 50 { &room } else { &checkerboard }).cells()[index]);
    let both = OccupancyGrid::new(cells.collect(), room.width(), room.options()).expect("half a checkerboard");
    let obstacles = Obstacles::new([(&disc, Pose::new(3.0, 4.0, 0.0))]).expect("an obstacle");
    // With this many poses, scans of up to 544 beams are cast together (a test in `raycast` checks this number). The last
    // chunk is not full. Some scans start off the grid, one in a wall.
    let mut poses = poses(1037);
    poses[300] = [-2.0, 3.5, 0.3];
    poses[301] = [1e300, 0.0, 1.0];
    poses[500] = [3.0, 4.5, 1e300];
    poses[700] = [-1.0, 2.0, 0.5];
    let noise = Noise {
        surface: None,
        model: BeamModel::new(BeamModelOptions::default()).expect("a good model"),
        seed: SEED,
        first_index: 0,
    };
    for (grid, beam_count) in [1, 5, 31, 32, 33, 95, 129, 360, 541, 544, 1088, 1089]
        .map(|count| (&room, count))
        .into_iter()
        .chain([(&checkerboard, 33), (&both, 33)])
    {
        let laser = scanner(ScannerOptions { beam_count, max_range: 9.0, ..ScannerOptions::default() });
        let mut alone = vec![0.0; poses.len() * beam_count];
        let mut noisy_alone = alone.clone();
        let plain = laser.clone().with_kernel(Kernel::Traversal);
        for (index, pose) in poses.iter().enumerate() {
            let beams = index * beam_count..(index + 1) * beam_count;
            plain.scan((grid, &obstacles), (*pose).into(), &mut alone[beams.clone()]).expect("a kernel");
            let noise = Noise { first_index: index as u64, ..noise };
            plain
                .scan_batch((grid, &obstacles), &[*pose], Some(noise), Some(1), &mut noisy_alone[beams])
                .expect("a good batch");
        }
        for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
            let laser = laser.clone().with_kernel(kernel);
            let mut together = vec![0.0; alone.len()];
            laser.scan_batch((grid, &obstacles), &poses, None, Some(2), &mut together).expect("a good batch");
            assert!(together == alone, "{beam_count} beams by {kernel:?}");
            laser.scan_batch((grid, &obstacles), &poses, Some(noise), Some(2), &mut together).expect("a good batch");
            assert!(together == noisy_alone, "{beam_count} noisy beams by {kernel:?}");
        }
    }
}

#[test]
fn noise_depends_on_seed_and_index_alone() {
    let (grid, laser, pose) = (room(), scanner(ScannerOptions::default()), poses(1));
    let model = BeamModel::new(BeamModelOptions::default()).expect("a good model");
    let scan = |seed, first_index| {
        let mut readings = vec![0.0; 541];
        laser
            .scan_batch(&grid, &pose, Some(Noise { model, surface: None, seed, first_index }), None, &mut readings)
            .expect("a good batch");
        readings
    };
    assert_eq!(scan(1, u64::MAX), scan(1, u64::MAX));
    assert_ne!(scan(1, 0), scan(1, 1));
    assert_ne!(scan(1, 0), scan(2, 0));
}

#[test]
fn readings_that_are_not_valid_returns_are_marked() {
    let laser = scanner(ScannerOptions { beam_count: 4, min_range: 0.5, max_range: 8.0, ..ScannerOptions::default() });
    let mut readings = [0.499, 0.5, 7.999, 8.0];
    laser.mark_invalid(&mut readings, NoReturn::Inf);
    assert_eq!(readings, [f32::NEG_INFINITY, 0.5, 7.999, f32::INFINITY]);
    let mut readings = [0.0, 0.5, 7.999, 8.0];
    laser.mark_invalid(&mut readings, NoReturn::Max);
    assert_eq!(readings, [f32::NEG_INFINITY, 0.5, 7.999, 8.0]);
    laser.mark_invalid(&mut readings, NoReturn::BelowMax);
    assert_eq!(readings, [f32::NEG_INFINITY, 0.5, 7.999, 7.9]);
    let narrow = scanner(ScannerOptions { beam_count: 1, min_range: 0.5, max_range: 0.55, ..ScannerOptions::default() });
    let mut reading = [0.55];
    narrow.mark_invalid(&mut reading, NoReturn::BelowMax);
    assert_eq!(reading, [0.5]);
}

#[test]
fn a_scan_from_a_pose_that_is_not_finite_is_an_error() {
    let (grid, laser) = (room(), scanner(ScannerOptions::default()));
    let disc = Obstacles::new([(&Shape::disc(0.5).unwrap(), Pose::new(1.0, 1.0, 0.0))]).unwrap();
    let mut ranges = vec![7.0; laser.options().beam_count];
    let error = laser.scan((&grid, &disc), Pose::new(f64::NAN, 1.0, 0.0), &mut ranges).unwrap_err();
    assert_eq!(error.to_string(), "x must be finite, got NaN");
    assert!(ranges.iter().all(|&range| range == 7.0));
}

#[test]
fn a_yaw_that_overflows_has_no_returns() {
    let mut grid = room();
    let options = GridOptions { origin: Pose::new(-1.0, 2.0, -1.7e308), ..grid.options() };
    grid = OccupancyGrid::new(grid.cells().to_vec(), grid.width(), options).expect("a room");
    let start = [-0.5, 2.5, 1.7e308];
    let mut others = Vec::new();
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
        let laser =
            scanner(ScannerOptions { max_range: 5.0, beam_count: 3, ..ScannerOptions::default() }).with_kernel(kernel);
        let mut ranges = [0.0; 3];
        laser.scan_batch(&grid, &[start], None, Some(1), &mut ranges).expect("a scan");
        assert_eq!(ranges, [5.0; 3], "{}", kernel.name());
        let rays = [start, [-0.5, 2.5, -1.7e308], [-0.5, 2.5, 1.0]];
        let mut ranges = [0.0; 3];
        Caster::new(&grid, 5.0, kernel)
            .expect("a range")
            .cast_rays(Obstacles::NONE, &rays, Some(1), &mut ranges)
            .expect("ranges");
        assert_eq!(ranges[0], 5.0, "{}", kernel.name());
        others.push([ranges[1], ranges[2]]);
    }
    assert!(others.windows(2).all(|pair| pair[0] == pair[1]), "{others:?}");
}

#[test]
fn scans_work_on_the_threads_of_a_rayon_pool() {
    let laser = scanner(ScannerOptions::default());
    let (grid, starts) = (room(), poses(64));
    let expected: Vec<_> = starts.iter().map(|&start| scan(&laser, &room(), start)).collect();
    // All of them start at once on a grid whose data for casting is not built yet.
    let found: Vec<_> = starts.par_iter().map(|&start| scan(&laser, &grid, start)).collect();
    assert!(found == expected);
}

fn scan(laser: &LaserScanner, grid: &OccupancyGrid, start: [f64; 3]) -> Vec<f32> {
    let mut ranges = vec![0.0; laser.options().beam_count];
    laser.scan(grid, start.into(), &mut ranges).expect("a scan");
    ranges
}

#[test]
fn the_error_names_the_bad_option_or_argument() {
    let good = ScannerOptions::default();
    let error = |options| LaserScanner::new(options).unwrap_err().to_string();
    assert_eq!(error(ScannerOptions { layout: BeamLayout::Fov(0.0), ..good }), "fov must be in (0, 2π] radians, got 0");
    assert_eq!(error(ScannerOptions { layout: BeamLayout::Fov(6.3), ..good }), "fov must be in (0, 2π] radians, got 6.3");
    assert_eq!(error(ScannerOptions { beam_count: 0, ..good }), "beam_count must be in 1..1000000, got 0");
    assert_eq!(error(ScannerOptions { min_range: -1.0, ..good }), "min_range must be at least 0, got -1");
    assert_eq!(
        error(ScannerOptions { max_range: 0.05, ..good }),
        "max_range must be greater than min_range, got 0.05 and 0.05"
    );
    let mount = Pose::new(0.0, f64::INFINITY, 0.0);
    assert_eq!(error(ScannerOptions { mount: mount.into(), ..good }), "mount y must be finite, got inf");

    let (grid, laser) = (room(), scanner(good));
    let batch = |poses: &[[f64; 3]], threads, count| {
        laser.scan_batch(&grid, poses, None, threads, &mut vec![0.0; count]).unwrap_err().to_string()
    };
    let pose = [0.0, 0.0, 0.0];
    assert_eq!(batch(&[pose, [0.0, f64::NAN, 0.0]], None, 1082), "poses must be finite, got [0.0, NaN, 0.0] in row 1");
    assert_eq!(batch(&[pose], None, 540), "out must have 541 elements, got 540");
    assert_eq!(batch(&[pose], Some(0), 541), "threads must be in 1..1024, got 0");
}
