//! Scanners mounted anywhere in space, against beams as lines in space that meet walls of any height and a floor.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DQuat, DVec2, DVec3};
use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    BeamLayout, BeamModel, BeamModelOptions, GridOptions, LaserScanner, Mount, Noise, OCCUPIED_THRESHOLD, Obstacles,
    OccupancyGrid, Pose, ScannerOptions, Shape, Unknown, random,
};
use rand::RngExt;

const SIDE: usize = 40;
const RESOLUTION: f64 = 0.25;
const MAX_RANGE: f64 = 7.0;

/// Returns a grid of 10 m × 10 m in which one cell in `spacing` blocks, and the corners of these cells.
fn world(spacing: usize) -> (OccupancyGrid, Vec<DVec2>) {
    let is_wall = |index: usize| (index * 7919).is_multiple_of(spacing);
    let options = GridOptions {
        resolution: RESOLUTION,
        origin: Pose::default(),
        occupied_threshold: OCCUPIED_THRESHOLD,
        unknown: Unknown::Free,
    };
    let cells = (0..SIDE * SIDE).map(|index| if is_wall(index) { 100 } else { 0 }).collect();
    let corner = |index| DVec2::new((index % SIDE) as f64, (index / SIDE) as f64) * RESOLUTION;
    let corners = (0..SIDE * SIDE).filter(|&index| is_wall(index)).map(corner).collect();
    (OccupancyGrid::new(cells, SIDE, options).expect("a grid"), corners)
}

/// Returns how far a beam goes in space until it meets a cell, a disc, or the floor; at most `MAX_RANGE`.
fn expected(start: DVec3, direction: DVec3, corners: &[DVec2], discs: &[(DVec2, f64)]) -> f64 {
    let mut nearest = MAX_RANGE;
    if direction.z < 0.0 && start.z > 0.0 {
        nearest = nearest.min(start.z / -direction.z);
    }
    for &corner in corners {
        // The beam is inside the cell from `enter` to `leave`.
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..2 {
            let (one, other) = (corner[axis] - start[axis], corner[axis] + RESOLUTION - start[axis]);
            let (one, other) = (one / direction[axis], other / direction[axis]);
            (enter, leave) = (enter.max(one.min(other)), leave.min(one.max(other)));
        }
        if enter < leave {
            nearest = nearest.min(enter);
        }
    }
    for &(center, radius) in discs {
        // |start + t · direction - center|² = radius² in the plane.
        let (offset, flat) = (start.truncate() - center, direction.truncate());
        if offset.length() <= radius {
            return 0.0;
        }
        let (a, b, c) = (flat.length_squared(), offset.dot(flat), offset.length_squared() - radius * radius);
        let root = b * b - a * c;
        if root > 0.0 && b < 0.0 {
            nearest = nearest.min((-b - root.sqrt()) / a);
        }
    }
    nearest
}

fn scanner(layout: BeamLayout, beam_count: usize, mount: Mount) -> LaserScanner {
    let options = ScannerOptions { layout, beam_count, min_range: 0.0, max_range: MAX_RANGE, mount };
    LaserScanner::new(options).expect("a scanner")
}

#[test]
fn tilted_scans_agree_with_lines_in_space() {
    let mut stream = random::stream(4, 0);
    let mut drawn = |low: f64, high: f64| stream.random_range(low..high);
    let (mut compared, mut floors, mut walls) = (0, 0, 0);
    for round in 0..60 {
        let (grid, corners) = world([40, 97, 400][round % 3]);
        let height = [0.6, 0.05, 0.0, -0.3][round % 4];
        let tilt = [0.1, 0.5, FRAC_PI_2, PI][round / 4 % 4];
        let rotation = [drawn(-tilt, tilt), drawn(-tilt, tilt), drawn(-PI, PI)];
        let mount = Mount::new([drawn(-0.3, 0.3), drawn(-0.3, 0.3), height], rotation);
        let base = Pose::new(drawn(0.5, 9.5), drawn(0.5, 9.5), drawn(-PI, PI));
        let disc = (DVec2::new(drawn(0.0, 10.0), drawn(0.0, 10.0)), 0.7);
        let shape = Shape::disc(disc.1).expect("a disc");
        let obstacles = Obstacles::new([(&shape, Pose::new(disc.0.x, disc.0.y, 0.0))]).expect("obstacles");

        let laser = scanner(BeamLayout::Ends { angle_min: -2.0, angle_max: 3.0 }, 101, mount);
        let mut ranges = vec![0.0; 101];
        laser.scan((&grid, &obstacles), base, &mut ranges).expect("a scan");
        let (map_from_base, [roll, pitch, yaw]) = (DQuat::from_rotation_z(base.yaw), rotation);
        let turned =
            map_from_base * DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll);
        let start = base.position.extend(0.0) + map_from_base * mount.position;
        for (beam, &range) in ranges.iter().enumerate() {
            let angle = laser.angle(beam);
            let direction = turned * DVec3::new(angle.cos(), angle.sin(), 0.0);
            let expected = expected(start, direction, &corners, &[disc]);
            assert!((f64::from(range) - expected).abs() < 1e-6 * (1.0 + expected), "{round} {beam}: {range} {expected}");
            compared += 1;
            let meets_floor = direction.z < 0.0 && height > 0.0 && (expected - height / -direction.z).abs() < 1e-9;
            floors += usize::from(meets_floor);
            walls += usize::from(!meets_floor && expected > 0.0 && expected < MAX_RANGE);
        }
        // The points lie below the beams, seen from above.
        let points = laser.end_points(base, &ranges).expect("points");
        let hits = (0..101).filter(|&beam| f64::from(ranges[beam]) < MAX_RANGE);
        for (point, beam) in points.iter().zip(hits.clone()) {
            let angle = laser.angle(beam);
            let end = start + turned * DVec3::new(angle.cos(), angle.sin(), 0.0) * f64::from(ranges[beam]);
            assert!(end.truncate().abs_diff_eq(DVec2::from(*point), 1e-9), "{round} {beam}");
        }
        assert_eq!(points.len(), hits.count());
    }
    assert!(floors > 1000 && walls > 500 && compared == 6060, "{floors} floors, {walls} walls");
}

#[test]
#[allow(clippy::approx_constant, reason = "files round it")]
fn an_upside_down_scan_is_a_level_one_in_reverse() {
    let (grid, _) = world(97);
    let shape = Shape::rectangle(0.8, 0.5).expect("a rectangle");
    let obstacles = Obstacles::new([(&shape, Pose::new(4.0, 6.0, 0.4))]).expect("obstacles");
    let base = Pose::new(5.1, 4.9, 0.3);
    for (low, high) in [(-2.0, 2.0), (-1.0, 2.5), (0.1, 6.0)] {
        for rotation in [[PI, 0.0, 0.7], [-PI, 0.0, 0.7], [3.1416, 1e-6, 0.7]] {
            let mount = Mount::new([0.2, 0.1, 0.3], rotation);
            let down = scanner(BeamLayout::Ends { angle_min: low, angle_max: high }, 541, mount);
            let level = Mount::new([0.2, 0.1, 0.3], [0.0, 0.0, 0.7]);
            let up = scanner(BeamLayout::Ends { angle_min: -high, angle_max: -low }, 541, level);
            let (mut reversed, mut ranges) = (vec![0.0; 541], vec![0.0; 541]);
            down.scan((&grid, &obstacles), base, &mut reversed).expect("a scan");
            up.scan((&grid, &obstacles), base, &mut ranges).expect("a scan");
            assert!(ranges.iter().any(|&range| range < 3.0) && ranges.iter().any(|&range| range > 3.0));
            assert!(reversed.iter().eq(ranges.iter().rev()), "{low} to {high}");
            let mut points = down.end_points(base, &reversed).expect("points");
            points.reverse();
            assert_eq!(points, up.end_points(base, &ranges).expect("points"));
        }
    }
    // A scanner that looks back after half a turn about y, like one turned about x and then about z.
    let flipped = scanner(BeamLayout::Fov(4.71), 541, Mount::new([0.0, 0.0, 0.2], [0.0, PI, 0.2]));
    let rolled = scanner(BeamLayout::Fov(4.71), 541, Mount::new([0.0, 0.0, 0.2], [PI, 0.0, 0.2 + PI]));
    let (mut one, mut other) = (vec![0.0; 541], vec![0.0; 541]);
    flipped.scan(&grid, base, &mut one).expect("a scan");
    rolled.scan(&grid, base, &mut other).expect("a scan");
    assert_eq!(one, other);
}

#[test]
fn a_level_mount_measures_as_one_without_a_height() {
    let (grid, _) = world(97);
    let flat = scanner(BeamLayout::Fov(TAU), 360, Pose::new(0.2, 0.1, 0.7).into());
    let high = scanner(BeamLayout::Fov(TAU), 360, Mount::new([0.2, 0.1, 1.5], [0.0, 0.0, 0.7]));
    let (mut one, mut other) = (vec![0.0; 360], vec![0.0; 360]);
    flat.scan(&grid, Pose::new(5.1, 4.9, 0.3), &mut one).expect("a scan");
    high.scan(&grid, Pose::new(5.1, 4.9, 0.3), &mut other).expect("a scan");
    assert_eq!(one, other);
}

#[test]
fn vertical_beams_meet_the_floor_only() {
    let (grid, _) = world(97);
    let mount = Mount::new([0.0, 0.0, 0.5], [0.0, FRAC_PI_2, 0.0]);
    let straight_down = scanner(BeamLayout::Fov(1.0), 1, mount);
    let free = Pose::new(5.1, 4.9, 0.0);
    let mut range = [0.0];
    straight_down.scan(&grid, free, &mut range).expect("a scan");
    assert_eq!(range, [0.5]);
    scanner(BeamLayout::Fov(1.0), 1, Mount { pitch: -FRAC_PI_2, ..mount }).scan(&grid, free, &mut range).expect("a scan");
    assert_eq!(range, [MAX_RANGE as f32]);
    straight_down.scan(&grid, Pose::new(0.1, 0.1, 0.0), &mut range).expect("a scan from a wall");
    assert_eq!(range, [0.0]);
}

#[test]
fn tilted_batches_have_the_same_bytes_on_any_thread_kernel_and_chunk() {
    let (grid, _) = world(97);
    let laser = scanner(BeamLayout::Fov(4.0), 333, Mount::new([0.1, 0.0, 0.4], [0.2, 0.15, 0.5]));
    let model = BeamModel::new(BeamModelOptions::default()).expect("a model");
    let poses: Vec<[f64; 3]> = (0..300).map(|index| [1.0 + 0.02 * f64::from(index), 5.0, 0.1 * f64::from(index)]).collect();
    let batch = |laser: &LaserScanner, threads, poses: &[[f64; 3]], first_index| {
        let mut readings = vec![0.0; 333 * poses.len()];
        let noise = Some(Noise { model, surface: None, seed: 3, first_index });
        laser.scan_batch(&grid, poses, noise, Some(threads), &mut readings).expect("a batch");
        readings
    };
    let all = batch(&laser, 1, &poses, 0);
    assert_eq!(batch(&laser, 3, &poses, 0), all);
    assert_eq!([batch(&laser, 2, &poses[..123], 0), batch(&laser, 1, &poses[123..], 123)].concat(), all);
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
        assert_eq!(batch(&laser.clone().with_kernel(kernel), 2, &poses, 0), all, "{}", kernel.name());
    }
}
