//! Scans that take time, against scans of each beam by itself: taken in one instant, from where the robot is at the time of
//! the beam, with the obstacles where they are then. All ranges are equal to the last bit.

use std::f64::consts::{PI, TAU};

use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    BeamLayout, BeamModel, BeamModelOptions, Course, Courses, GridOptions, LaserScanner, Mount, MovingObstacle, Noise,
    OCCUPIED_THRESHOLD, Obstacles, OccupancyGrid, Pose, ScannerOptions, Shape, Sweeps, Twist, Unknown, integrate, random,
};
use rand::RngExt;

const SIDE: usize = 120;
const MAX_RANGE: f64 = 9.0;

/// Returns a grid of 12 m × 12 m with a yawed origin, in which one cell in `spacing` blocks.
fn world(spacing: usize, origin: Pose) -> OccupancyGrid {
    let options = GridOptions { resolution: 0.1, origin, occupied_threshold: OCCUPIED_THRESHOLD, unknown: Unknown::Free };
    let cells = (0..SIDE * SIDE).map(|index| if (index * 7919).is_multiple_of(spacing) { 100 } else { 0 }).collect();
    OccupancyGrid::new(cells, SIDE, options).expect("a grid")
}

fn scanner(layout: BeamLayout, beam_count: usize, mount: Mount) -> LaserScanner {
    LaserScanner::new(ScannerOptions { layout, beam_count, min_range: 0.0, max_range: MAX_RANGE, mount }).expect("a scanner")
}

/// A moving thing: its pose at the time of beam 0, and its twist.
type Mover = (Pose, Twist);

fn at((start, twist): Mover, time: f64) -> Pose {
    integrate(start, twist, time)
}

/// Returns the range of each beam, from a scan of its own.
fn one_by_one(
    laser: &LaserScanner,
    grid: &OccupancyGrid,
    robot: Mover,
    scan_duration: f64,
    obstacles: &[(&Shape, Mover)],
) -> Vec<f32> {
    let beams = laser.options().beam_count;
    let mut ranges = vec![0.0; beams];
    (0..beams)
        .map(|beam| {
            let time = beam as f64 * laser.time_increment(scan_duration);
            let placed = Obstacles::new(obstacles.iter().map(|&(shape, mover)| (shape, at(mover, time)))).unwrap();
            laser.scan((grid, &placed), at(robot, time), &mut ranges).unwrap();
            ranges[beam]
        })
        .collect()
}

fn sweep(
    laser: &LaserScanner,
    grid: &OccupancyGrid,
    (pose, twist): Mover,
    scan_duration: f64,
    obstacles: &[MovingObstacle<'_>],
) -> Vec<f32> {
    let courses = Courses::Arcs { poses: &[pose.to_array()], twists: &[twist.to_array()] };
    let mut ranges = vec![0.0; laser.options().beam_count];
    laser.sweep_batch(grid, Sweeps { courses, scan_duration, obstacles }, None, None, &mut ranges).unwrap();
    ranges
}

fn moving<'a>(obstacles: &[(&'a Shape, Mover)]) -> Vec<MovingObstacle<'a>> {
    let course = |(start, twist)| Course::Arc { start, twist };
    obstacles.iter().map(|&(shape, mover)| MovingObstacle { shape, course: course(mover) }).collect()
}

#[test]
fn each_beam_is_taken_at_its_own_time() {
    let mut stream = random::stream(40, 0);
    let mut drawn = |low: f64, high: f64| stream.random_range(low..high);
    let shapes = [
        Shape::disc(0.4).unwrap(),
        Shape::rectangle(0.8, 0.3).unwrap(),
        Shape::polygon(&[[1.0, 0.0], [-1.0, 1.0], [-0.5, 0.0], [-1.0, -1.0]]).unwrap(),
    ];
    let (mut walls, mut met) = (0, 0);
    for round in 0..120 {
        let origin = [Pose::default(), Pose::new(-1.0, 0.5, 0.7)][round % 2];
        let grid = world([60, 700][round / 2 % 2], origin);
        let layout = [
            BeamLayout::Fov(4.71),
            BeamLayout::Fov(TAU),
            BeamLayout::Ends { angle_min: 1.0, angle_max: -2.0 },
            BeamLayout::Ends { angle_min: 0.0, angle_max: -TAU },
        ][round / 4 % 4];
        let mount = [
            Mount::default(),
            Mount::new([0.2, -0.1, 0.0], [0.0, 0.0, 0.3]),
            Mount::new([0.2, 0.1, 0.4], [PI, 0.0, 0.3]),
            Mount::new([0.1, 0.0, 0.4], [0.1, 0.2, -0.4]),
        ][round / 16 % 4];
        let laser = scanner(layout, [1, 61, 541][round % 3], mount);
        // Some robots start off the grid, some stand, some drive straight on.
        let start = Pose::new(drawn(-2.0, 13.0), drawn(-2.0, 13.0), drawn(-4.0, 4.0));
        let turn = if round % 5 == 0 { 0.0 } else { drawn(-6.0, 6.0) };
        let speed = if round % 10 == 0 { 0.0 } else { 3.0 };
        let robot = (start, Twist::from([speed * drawn(-1.0, 1.0), speed * drawn(-1.0, 1.0), turn]));
        let obstacles: Vec<(&Shape, Mover)> = (0..round % 6)
            .map(|nth| {
                let pose =
                    Pose::new(start.position.x + drawn(-3.0, 3.0), start.position.y + drawn(-3.0, 3.0), drawn(-4.0, 4.0));
                let twist = if nth == 4 { [0.0; 3] } else { [drawn(-2.0, 2.0), drawn(-2.0, 2.0), drawn(-3.0, 3.0)] };
                (&shapes[nth % 3], (pose, Twist::from(twist)))
            })
            .collect();
        let scan_duration = [0.1, 0.0, 1.3][round / 3 % 3];
        let expected = one_by_one(&laser, &grid, robot, scan_duration, &obstacles);
        let without = one_by_one(&laser, &grid, robot, scan_duration, &[]);
        walls += expected.iter().zip(&without).filter(|(range, other)| range == other && **range < MAX_RANGE as f32).count();
        met += expected.iter().zip(&without).filter(|(range, other)| range < other).count();
        for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
            let laser = laser.clone().with_kernel(kernel);
            let found = sweep(&laser, &grid, robot, scan_duration, &moving(&obstacles));
            assert_eq!(found, expected, "round {round}, {}", kernel.name());
        }
    }
    assert!(walls > 5000 && met > 2000, "only {walls} walls and {met} obstacles were met");
}

#[test]
fn poses_of_each_beam_replace_an_arc() {
    let (grid, shape) = (world(500, Pose::new(0.0, 0.0, -0.2)), Shape::rectangle(0.9, 0.5).unwrap());
    let laser = scanner(BeamLayout::Fov(TAU), 360, Mount::new([0.1, 0.2, 0.0], [0.0, 0.0, 2.0]));
    let robot: Mover = (Pose::new(6.0, 5.0, 3.0), Twist::from([1.0, -0.4, 2.0]));
    let other: Mover = (Pose::new(7.0, 6.0, 1.0), Twist::from([-1.0, 0.2, 4.0]));
    let poses_of = |mover: Mover| -> Vec<[f64; 3]> {
        (0..360).map(|beam| at(mover, f64::from(beam) * laser.time_increment(0.4)).to_array()).collect()
    };
    let (poses, other_poses) = (poses_of(robot), poses_of(other));
    let mut found_poses = vec![[0.0; 3]; 360];
    let arcs = Courses::Arcs { poses: &[robot.0.to_array()], twists: &[robot.1.to_array()] };
    laser.beam_poses(arcs, 0.4, &mut found_poses).unwrap();
    assert_eq!(found_poses, poses);

    let expected = one_by_one(&laser, &grid, robot, 0.4, &[(&shape, other)]);
    let obstacles = [MovingObstacle { shape: &shape, course: Course::Poses(&other_poses) }];
    let mut found = vec![0.0; 360];
    let sweeps = Sweeps { courses: Courses::Poses(&poses), scan_duration: 0.4, obstacles: &obstacles };
    laser.sweep_batch(&grid, sweeps, None, None, &mut found).unwrap();
    assert_eq!(found, expected);
}

#[test]
fn a_batch_does_not_depend_on_threads_or_its_split() {
    let mut stream = random::stream(41, 0);
    let mut drawn = |scale: f64| -> Vec<[f64; 3]> {
        (0..200).map(|_| std::array::from_fn(|_| stream.random_range(0.0..scale))).collect()
    };
    let (poses, twists) = (drawn(12.0), drawn(2.0));
    let (grid, disc) = (world(500, Pose::default()), Shape::disc(0.5).unwrap());
    let course = Course::Arc { start: Pose::new(5.0, 5.0, 0.0), twist: Twist::from([1.0, 0.0, 1.0]) };
    let obstacles = [MovingObstacle { shape: &disc, course }];
    let model = BeamModel::new(BeamModelOptions { z_short: 0.1, ..BeamModelOptions::default() }).unwrap();
    for beams in [7, 61, 541] {
        let laser = scanner(BeamLayout::Fov(4.0), beams, Mount::new([0.2, 0.0, 0.0], [0.0, 0.0, 0.1]));
        let cast = |part: std::ops::Range<usize>, duration: f64, threads: usize| {
            let noise = Noise { model, surface: None, seed: 3, first_index: 10 + part.start as u64 };
            let courses = Courses::Arcs { poses: &poses[part.clone()], twists: &twists[part.clone()] };
            let mut readings = vec![0.0; part.len() * beams];
            let sweeps = Sweeps { courses, scan_duration: duration, obstacles: &obstacles };
            laser.sweep_batch(&grid, sweeps, Some(noise), Some(threads), &mut readings).unwrap();
            readings
        };
        let whole = cast(0..200, 0.2, 1);
        assert_eq!(cast(0..200, 0.2, 3), whole);
        assert_eq!([cast(0..67, 0.2, 2), cast(67..200, 0.2, 1)].concat(), whole);

        let placed = Obstacles::new([(&disc, Pose::new(5.0, 5.0, 0.0))]).unwrap();
        let mut instant = vec![0.0; 200 * beams];
        let noise = Noise { model, surface: None, seed: 3, first_index: 10 };
        laser.scan_batch((&grid, &placed), &poses, Some(noise), None, &mut instant).unwrap();
        assert_eq!(cast(0..200, 0.0, 2), instant, "a duration of 0");
        assert_ne!(whole, instant);
    }
}

#[test]
fn a_passing_disc_is_met_where_it_is_then() {
    // One beam after the other points ahead, along x. The disc of radius 0.5 m comes nearer at 2 m/s.
    let grid = world(1_000_000, Pose::new(100.0, 100.0, 0.0));
    let laser = scanner(BeamLayout::Fov(1e-9), 21, Mount::default());
    let disc = Shape::disc(0.5).unwrap();
    let obstacles = moving(&[(&disc, (Pose::new(6.0, 0.0, PI), Twist::from([2.0, 0.0, 0.0])))]);
    let ranges = sweep(&laser, &grid, (Pose::default(), Twist::from([0.5, 0.0, 0.0])), 2.0, &obstacles);
    for (beam, range) in ranges.into_iter().enumerate() {
        let time = beam as f32 * 0.1;
        assert!((range - (5.5 - 2.5 * time)).abs() < 1e-6, "{range} after {time} s");
    }
}

#[test]
fn the_time_increment_covers_the_field() {
    let increment = |layout, beams| scanner(layout, beams, Mount::default()).time_increment(0.5);
    assert_eq!(increment(BeamLayout::Fov(PI), 51), 0.01);
    assert_eq!(increment(BeamLayout::Fov(TAU), 50), 0.01);
    assert_eq!(increment(BeamLayout::Ends { angle_min: 3.0, angle_max: -3.0 }, 51), 0.01);
    assert_eq!(increment(BeamLayout::Fov(PI), 1), 0.0);
}

#[test]
fn the_error_names_the_bad_value() {
    let (grid, laser) = (world(500, Pose::default()), scanner(BeamLayout::Fov(4.0), 3, Mount::default()));
    let disc = Shape::disc(0.5).unwrap();
    let error = |courses, scan_duration, course: Option<Course<'_>>, out: usize| {
        let obstacles: Vec<_> = course.map(|course| MovingObstacle { shape: &disc, course }).into_iter().collect();
        let sweeps = Sweeps { courses, scan_duration, obstacles: &obstacles };
        laser.sweep_batch(&grid, sweeps, None, None, &mut vec![0.0; out]).unwrap_err().to_string()
    };
    let (zero, bad) = ([[0.0; 3]], [[0.0, f64::NAN, 0.0]]);
    let arcs = Courses::Arcs { poses: &zero, twists: &zero };
    assert_eq!(error(arcs, -1.0, None, 3), "scan_duration must be at least 0, got -1");
    assert_eq!(error(arcs, f64::NAN, None, 3), "scan_duration must be at least 0, got NaN");
    assert_eq!(error(arcs, 1.0, None, 4), "out must have 3 elements, got 4");
    let nan_twist = Courses::Arcs { poses: &zero, twists: &bad };
    assert_eq!(error(nan_twist, 1.0, None, 3), "twists must be finite, got [0.0, NaN, 0.0] in row 0");
    assert_eq!(error(Courses::Arcs { poses: &zero, twists: &[] }, 1.0, None, 3), "twists must have 1 elements, got 0");
    assert_eq!(error(Courses::Poses(&zero), 1.0, None, 0), "poses must have 3 elements, got 1");
    let course = Course::Poses(&zero);
    assert_eq!(error(arcs, 1.0, Some(course), 3), "the poses of an obstacle must have 3 elements, got 1");
    let course = Course::Arc { start: Pose::default(), twist: Twist::from(bad[0]) };
    assert_eq!(error(arcs, 1.0, Some(course), 3), "vy must be finite, got NaN");
}
