//! Random moves of footprints of every shape near corners, compared with an oracle that samples the path densely.

use std::f64::consts::TAU;

use glam::DVec2;
use mobile_robot_simulator::{
    CONTACT_TOLERANCE, ContactMode, Obstacles, Pose, Shape, Twist, advance, clearance, integrate, random,
};
use rand::RngExt;

use crate::oracle::{CompositeShape, Part, blocking_squares, disc, distance, grid, l_shape, rectangle, triangle};

const SEED: u64 = 51;

/// Largest share of a move between two samples of the oracle.
const SAMPLE: f64 = 0.005;

struct Draw(random::Stream);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn one_in(&mut self, count: f64) -> bool {
        self.between(0.0, count) < 1.0
    }

    fn shape(&mut self) -> CompositeShape {
        match self.between(0.0, 7.0) as usize {
            0 => disc(self.between(0.02, 0.4)),
            1 => rectangle(self.between(0.1, 0.8), self.between(0.02, 0.5)),
            2 => l_shape(self.between(0.05, 0.3)),
            3 => triangle(self.between(0.05, 0.3)),
            _ => self.star(),
        }
    }

    /// A polygon around the origin with corners at random distances from it, most of them concave.
    fn star(&mut self) -> CompositeShape {
        let count = self.between(4.0, 8.0).floor();
        let corners: Vec<DVec2> = (0..count as u32)
            .map(|corner| {
                let angle = (f64::from(corner) + self.between(-0.35, 0.35)) * TAU / count;
                DVec2::from_angle(angle) * self.between(0.08, 0.4)
            })
            .collect();
        let next = corners.iter().cycle().skip(1);
        let sector = |(&a, &b): (&DVec2, &DVec2)| Part { corners: vec![DVec2::ZERO, a, b], radius: 0.0 };
        let parts = corners.iter().zip(next).map(sector).collect();
        let outline: Vec<[f64; 2]> = corners.iter().map(DVec2::to_array).collect();
        CompositeShape { shape: Shape::polygon(&outline).unwrap(), parts }
    }

    /// A move that starts near `corner`: mostly any arc, sometimes one around a point near the corner, with a long turn.
    fn arc(&mut self, corner: DVec2, reach: f64) -> (Pose, Twist) {
        let far = reach + self.between(0.0, 0.4);
        let at = corner + DVec2::from_angle(self.between(0.0, TAU)) * self.between(0.0, far);
        let start = Pose::new(at.x, at.y, self.between(-3.2, 3.2));
        let angular = if self.one_in(5.0) { 0.0 } else { self.between(-1.5, 1.5) };
        let mut linear = DVec2::new(self.between(-0.7, 0.7), self.between(-0.7, 0.7));
        if self.one_in(2.0) {
            let near = corner + DVec2::from_angle(self.between(0.0, TAU)) * self.between(0.0, 0.05);
            linear = -angular * start.inverse().transform_point(near).perp();
        }
        (start, Twist { linear, angular })
    }
}

/// Checks `count` moves and returns the number of those that are stopped and of those that are not.
///
/// A stopped footprint is within the tolerance of something, and the path up to the stop is free.
fn check(count: usize, stream: u64) -> [usize; 2] {
    let mut draw = Draw(random::stream(SEED, stream));
    let mut found = [0; 2];
    while found[0] + found[1] < count {
        // A block of 2 by 2 cells, a single cell diagonal to it, and sometimes an obstacle beside it.
        let mut blocking = [false; 100];
        for cell in [33, 34, 43, 44, 55] {
            blocking[cell] = true;
        }
        let origin = Pose::new(0.1, -0.2, if draw.one_in(2.0) { 0.0 } else { draw.between(-3.0, 3.0) });
        let grid = grid(&blocking, 10, 0.1, origin);
        let obstacle = draw.one_in(2.0).then(|| (draw.shape(), origin * Pose::new(0.8, 0.4, draw.between(0.0, TAU))));
        let obstacles = Obstacles::new(obstacle.iter().map(|(composite, pose)| (&composite.shape, *pose))).unwrap();
        let mut parts = blocking_squares(&grid);
        parts.extend(obstacle.iter().flat_map(|(composite, pose)| composite.at(*pose, 1.0)));
        for _ in 0..20 {
            let footprint = draw.shape();
            let reach = footprint.shape.reach();
            let [col, row] = [[3, 3], [5, 3], [3, 5], [5, 5], [6, 6]][draw.between(0.0, 5.0) as usize];
            let corner = origin.transform_point(0.1 * DVec2::new(f64::from(col), f64::from(row)));
            let (start, twist) = draw.arc(corner, reach);
            if distance(&footprint.at(start, 1.0), &parts) == 0.0 {
                continue;
            }
            let dt = draw.between(0.1, 3.0);
            let (end, contact) =
                advance((&grid, &obstacles), &footprint.shape, start, twist, dt, ContactMode::Stop).unwrap();
            let case = || format!("{footprint:?} {obstacle:?} {origin:?} {start:?} {twist:?} {dt} {contact:?}");
            if contact.is_some() {
                let gap = distance(&footprint.at(end, 1.0), &parts);
                assert!(gap > 0.0 && gap <= CONTACT_TOLERANCE + 1e-12, "stopped {gap} m away: {}", case());
            }
            let until = dt * contact.map_or(1.0, |contact| contact.fraction);
            let (top_speed, mut time) = (twist.linear.length() + twist.angular.abs() * reach, 0.0);
            while time < until {
                let gap = distance(&footprint.at(integrate(start, twist, time), 1.0), &parts);
                assert!(gap > 0.0, "overlap at {time} s: {}", case());
                time += (gap / top_speed).max(SAMPLE * dt);
            }
            found[usize::from(contact.is_none())] += 1;
        }
    }
    found
}

#[test]
fn moves_near_corners_stop_at_what_they_touch_and_nowhere_else() {
    let [stopped, passed] = check(20_000, 0);
    assert!(stopped > 4_000 && passed > 4_000, "{stopped} {passed}");
}

/// `make fuzz` runs this one.
#[test]
#[ignore = "takes minutes"]
fn millions_of_moves_near_corners() {
    let found: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (1..=2).map(|stream| scope.spawn(move || check(2_000_000, stream))).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).collect()
    });
    println!("stopped and passed: {found:?}");
}

/// A side turns about the corner of a wall: the footprint stays 8.3e-5 m clear of it all the way.
#[test]
fn a_side_that_turns_about_a_corner_passes() {
    let blocking: Vec<bool> =
        (0..400).map(|index| (8..12).contains(&(index / 20)) && (8..12).contains(&(index % 20))).collect();
    let grid = grid(&blocking, 20, 0.05, Pose::default());
    let footprint = Shape::polygon(&[
        [0.384_738_738_748_404_5, 0.058_233_396_695_714_45],
        [-0.321_375_844_750_306_45, -0.086_336_363_452_856_63],
        [-0.023_291_123_372_876_64, -0.186_772_233_309_121_7],
        [0.204_578_058_060_833_37, -0.084_191_007_537_121_98],
        [0.195_739_430_832_632_2, -0.244_728_915_561_602_78],
    ])
    .unwrap();
    let start = Pose::new(1.014_061_540_694_859_2, 1.057_349_176_348_934_5, -1.999_469_271_691_545_2);
    let twist = Twist::from([0.532_824_773_953_905_8, 0.649_764_063_000_167_3, -1.178_072_136_016_959_7]);
    let smallest = (0..=20_000)
        .map(|step| clearance(&grid, &footprint, integrate(start, twist, f64::from(step) * 1e-4), 1.0).unwrap())
        .fold(f64::INFINITY, f64::min);
    assert!((smallest - 8.3e-5).abs() < 1e-6, "{smallest}");
    let (end, contact) = advance(&grid, &footprint, start, twist, 2.0, ContactMode::Stop).unwrap();
    assert_eq!((end, contact), (integrate(start, twist, 2.0), None));
}

#[test]
fn huge_twists_and_durations_give_a_pose_or_an_error() {
    let grid = grid(&[false; 16], 4, 0.5, Pose::default());
    let disc = Shape::disc(0.2).unwrap();
    let obstacles = Obstacles::new([(&disc, Pose::new(2.0, 2.0, 0.0))]).unwrap();
    let (mut poses, mut errors) = (0, 0);
    for twist in [[1e155, 0.0, 0.0], [0.0, 0.0, 1e155], [1e300, 1e300, 0.0], [1e155, 0.0, 1e155], [1e100, 0.0, 0.0]] {
        for dt in [0.0, 1e-300, 1e-155, 1e-100, 1.0, 1e300] {
            for mode in [ContactMode::Stop, ContactMode::Slide, ContactMode::Report] {
                let start = Pose::new(0.2, 0.2, 0.1);
                match advance((&grid, &obstacles), &disc, start, twist.into(), dt, mode) {
                    Ok((end, _)) => {
                        poses += 1;
                        assert!(end.checked().is_ok(), "{twist:?} {dt} {mode:?}: {end:?}");
                    }
                    Err(_) => errors += 1,
                }
            }
        }
    }
    assert!(poses > 30 && errors > 30, "{poses} {errors}");
}
