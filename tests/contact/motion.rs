//! Random drives of footprints of every kind among walls and obstacles, compared with an oracle that takes small steps.

use std::f64::consts::TAU;

use glam::DVec2;
use mobile_robot_simulator::{
    CONTACT_TOLERANCE, Contact, ContactMode, Obstacles, OccupancyGrid, Pose, Twist, advance, clearance, integrate, random,
    stays_clear, touches,
};
use rand::RngExt;

use crate::oracle::{CompositeShape, Part, blocking_squares, disc, distance, grid, l_shape, rectangle, triangle};

const SEED: u64 = 50;

/// Number of steps that the oracle takes along a path.
const STEPS: u32 = 200;

/// Largest rounding error of a distance \[m\].
const ROUNDING: f64 = 1e-12;

struct Scene {
    grid: OccupancyGrid,
    obstacles: Obstacles,
    /// Convex parts of the grid and the obstacles, for the oracle.
    parts: Vec<Part>,
    /// Convex parts of each obstacle.
    obstacle_parts: Vec<Vec<Part>>,
}

/// Draws random scenes, shapes, poses and twists.
struct Draw(random::Stream);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn pose(&mut self) -> Pose {
        Pose::new(self.between(-0.5, 3.9), self.between(-0.5, 3.2), self.between(0.0, TAU))
    }

    fn shape(&mut self) -> CompositeShape {
        match self.between(0.0, 4.0) as usize {
            0 => disc(self.between(0.05, 0.4)),
            1 => rectangle(self.between(0.1, 0.8), self.between(0.1, 0.5)),
            2 => l_shape(self.between(0.05, 0.3)),
            _ => triangle(self.between(0.05, 0.3)),
        }
    }

    fn scene(&mut self) -> Scene {
        let (width, height) = (14, 12);
        let share = [0.02, 0.1, 0.25][self.between(0.0, 3.0) as usize];
        let origin = Pose::new(0.1, -0.2, [0.0, 0.4][self.between(0.0, 2.0) as usize]);
        let walls: Vec<bool> = (0..width * height).map(|_| self.between(0.0, 1.0) < share).collect();
        let grid = grid(&walls, width, 0.25, origin);
        let shapes: Vec<(CompositeShape, Pose)> =
            (0..self.between(0.0, 4.0) as usize).map(|_| (self.shape(), self.pose())).collect();
        let obstacles = Obstacles::new(shapes.iter().map(|(composite, pose)| (&composite.shape, *pose))).unwrap();
        let obstacle_parts: Vec<Vec<Part>> = shapes.iter().map(|(composite, pose)| composite.at(*pose, 1.0)).collect();
        let parts = blocking_squares(&grid).into_iter().chain(obstacle_parts.iter().flatten().cloned()).collect();
        Scene { grid, obstacles, parts, obstacle_parts }
    }

    fn twist(&mut self) -> Twist {
        let mut axis = |top: f64| if self.between(0.0, 1.0) < 0.3 { 0.0 } else { self.between(-top, top) };
        Twist::from([axis(1.5), axis(0.7), axis(3.0)])
    }
}

impl Scene {
    fn distance(&self, footprint: &CompositeShape, pose: Pose, scale: f64) -> f64 {
        distance(&footprint.at(pose, scale), &self.parts)
    }

    fn advance(
        &self,
        footprint: &CompositeShape,
        start: Pose,
        twist: Twist,
        dt: f64,
        mode: ContactMode,
    ) -> (Pose, Option<Contact>) {
        advance((&self.grid, &self.obstacles), &footprint.shape, start, twist, dt, mode).unwrap()
    }
}

#[test]
fn clearance_agrees_with_the_oracle() {
    let mut draw = Draw(random::stream(SEED, 0));
    let mut overlaps = 0;
    for _ in 0..4000 {
        let (scene, footprint, pose) = (draw.scene(), draw.shape(), draw.pose());
        let expected = scene.distance(&footprint, pose, 1.0);
        for limit in [0.05, 0.5, 30.0] {
            let found = clearance((&scene.grid, &scene.obstacles), &footprint.shape, pose, limit).unwrap();
            assert!((found - expected.min(limit)).abs() < ROUNDING, "{found} {expected}: {footprint:?} {pose:?}");
        }
        let touching = touches((&scene.grid, &scene.obstacles), &footprint.shape, pose).unwrap();
        assert_eq!(touching, expected == 0.0, "{footprint:?} {pose:?} {expected}");
        overlaps += usize::from(touching);
    }
    assert!((400..3000).contains(&overlaps), "{overlaps}");
}

/// The path up to the stop is free, and at the stop the footprint is within the tolerance of the point of contact.
#[test]
fn a_footprint_stops_at_its_first_contact() {
    let mut draw = Draw(random::stream(SEED, 1));
    let (mut stopped, mut passed) = (0, 0);
    while stopped < 500 {
        let (scene, footprint, start) = (draw.scene(), draw.shape(), draw.pose());
        if scene.distance(&footprint, start, 1.0) == 0.0 {
            continue;
        }
        let (twist, dt) = (draw.twist(), draw.between(0.1, 2.0));
        let (end, contact) = scene.advance(&footprint, start, twist, dt, ContactMode::Stop);
        let fraction = contact.map_or(1.0, |contact| contact.fraction);
        let on_arc = integrate(start, twist, fraction * dt);
        let off = end.position.distance(on_arc.position) + (end.yaw - on_arc.yaw).abs();
        assert!(off < ROUNDING, "{off} off the arc: {end:?} {on_arc:?}");
        for step in 0..=STEPS {
            let pose = integrate(start, twist, fraction * dt * f64::from(step) / f64::from(STEPS));
            assert!(
                scene.distance(&footprint, pose, 1.0) > 0.0,
                "overlap at step {step}: {footprint:?} {start:?} {twist:?}"
            );
        }
        let Some(contact) = contact else {
            passed += 1;
            continue;
        };
        stopped += 1;
        let gap = scene.distance(&footprint, end, 1.0);
        assert!(gap <= CONTACT_TOLERANCE, "stopped {gap} away: {footprint:?} {start:?} {twist:?} {dt}");
        check_contact(&scene, &footprint, end, contact);
        let reported = scene.advance(&footprint, start, twist, dt, ContactMode::Report);
        assert_eq!(reported, (integrate(start, twist, dt), Some(contact)));
    }
    assert!(passed > 100, "{passed}");
}

/// The point is on the wall or obstacle and near the footprint; the normal points from there towards the footprint.
fn check_contact(scene: &Scene, footprint: &CompositeShape, pose: Pose, contact: Contact) {
    let point = |point: DVec2| [Part { corners: vec![point], radius: 0.0 }];
    let met = match contact.obstacle {
        Some(index) => scene.obstacle_parts[index].clone(),
        None => blocking_squares(&scene.grid),
    };
    assert!(distance(&point(contact.point), &met) < 1e-9, "{contact:?}");
    assert!(distance(&point(contact.point), &footprint.at(pose, 1.0)) <= CONTACT_TOLERANCE + 1e-9, "{contact:?}");
    assert!((contact.normal.length() - 1.0).abs() < 1e-9, "{contact:?}");
    let back = Pose { position: pose.position + contact.normal * 1e-7, ..pose };
    let to_point = |pose| distance(&point(contact.point), &footprint.at(pose, 1.0));
    let gained = to_point(back) - to_point(pose);
    assert!((gained - 1e-7).abs() < 1e-9, "{contact:?} {gained}");
}

/// A robot never overlaps anything under a sequence of random commands, and covers a fair part of the commanded distance.
#[test]
fn a_random_drive_never_overlaps_anything() {
    for mode in [ContactMode::Stop, ContactMode::Slide] {
        let mut draw = Draw(random::stream(SEED, 2));
        let (mut contacts, mut moved, mut commanded) = (0, 0.0, 0.0);
        for _ in 0..150 {
            let (scene, footprint, mut pose) = (draw.scene(), draw.shape(), draw.pose());
            if scene.distance(&footprint, pose, 1.0) == 0.0 {
                continue;
            }
            for _ in 0..8 {
                let twist = draw.twist();
                for _ in 0..15 {
                    let (next, contact) = scene.advance(&footprint, pose, twist, 0.05, mode);
                    let gap = scene.distance(&footprint, next, 1.0);
                    assert!(gap > 0.0, "{mode:?}: {footprint:?} {pose:?} {twist:?} {next:?}");
                    contacts += usize::from(contact.is_some());
                    moved += next.position.distance(pose.position);
                    commanded += 0.05 * twist.linear.length();
                    pose = next;
                }
            }
        }
        assert!(contacts > 1000, "{contacts}");
        assert!(moved > if mode == ContactMode::Slide { 0.6 } else { 0.3 } * commanded, "{mode:?}: {moved} of {commanded}");
    }
}

/// A footprint that overlaps something moves as its largest scaled-down copy that overlaps nothing.
#[test]
fn an_overlap_never_gets_deeper() {
    let mut draw = Draw(random::stream(SEED, 3));
    let (mut tried, mut moved) = (0, 0);
    while tried < 400 {
        let (scene, footprint, start) = (draw.scene(), draw.shape(), draw.pose());
        let is_free = |pose, scale| scene.distance(&footprint, pose, scale) > 0.0;
        if is_free(start, 1.0) || !is_free(start, 1e-9) {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if is_free(start, middle) { low = middle } else { high = middle }
        }
        if low < 1e-3 {
            continue;
        }
        tried += 1;
        let (twist, dt) = (draw.twist(), draw.between(0.01, 0.3));
        for mode in [ContactMode::Stop, ContactMode::Slide] {
            let (end, contact) = scene.advance(&footprint, start, twist, dt, mode);
            assert_eq!(contact.map(|contact| contact.fraction), Some(0.0));
            let free = is_free(end, low) || is_free(end, low * (1.0 - 1e-6));
            assert!(free, "{mode:?} {low}: {footprint:?} {start:?} {twist:?} {end:?}");
            moved += usize::from(end != start);
        }
    }
    assert!(moved > 400, "{moved}");
}

/// Where a quick look says that a robot stays clear, it meets nothing under any velocities between the two.
#[test]
fn a_robot_that_stays_clear_meets_nothing() {
    let mut draw = Draw(random::stream(SEED, 3));
    let (mut clear, mut free) = (0, 0);
    for _ in 0..2000 {
        let (scene, footprint, mut pose) = (draw.scene(), draw.shape(), draw.pose());
        let world = (&scene.grid, &scene.obstacles);
        let twists = [draw.twist(), draw.twist()];
        let duration = draw.between(0.0, 0.5);
        let is_clear = stays_clear(world, &footprint.shape, pose, twists, duration).unwrap();
        let is_free = distance(&footprint.at(pose, 1.0), &scene.parts) > 0.0;
        clear += u32::from(is_clear);
        free += u32::from(is_free);
        assert!(is_free || !is_clear);
        if is_clear {
            for _ in 0..5 {
                let mut shares = [0.0; 3].map(|_| draw.between(0.0, 1.0));
                shares[2] = shares[2].round();
                let [first, second] = twists.map(Twist::to_array);
                let twist = std::array::from_fn(|axis| first[axis] + shares[axis] * (second[axis] - first[axis]));
                let step =
                    advance(world, &footprint.shape, pose, Twist::from(twist), duration / 5.0, ContactMode::Stop).unwrap();
                pose = step.0;
                assert_eq!(step.1, None);
                assert!(distance(&footprint.at(pose, 1.0), &scene.parts) > 0.0);
            }
        }
    }
    assert!(clear > 200 && free > clear, "{clear} of {free}");
}
