//! Contacts worked out by hand, most of them on a grid with one straight wall.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use mobile_robot_simulator::{
    CONTACT_TOLERANCE, Contact, ContactMode, Obstacles, OccupancyGrid, Pose, Shape, Twist, advance, clearance,
    clearance_batch, integrate, touches,
};

use crate::oracle::grid;

/// A grid of 10 m by 10 m in cells of 0.1 m, with a wall from x = 8 m to x = 9 m.
fn walled() -> OccupancyGrid {
    let blocking: Vec<bool> = (0..10_000).map(|index| (80..90).contains(&(index % 100))).collect();
    grid(&blocking, 100, 0.1, Pose::default())
}

fn drive(footprint: &Shape, start: Pose, twist: [f64; 3], dt: f64, mode: ContactMode) -> (Pose, Option<Contact>) {
    advance(&walled(), footprint, start, twist.into(), dt, mode).unwrap()
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= CONTACT_TOLERANCE
}

#[test]
fn clearances_worked_out_by_hand() {
    let grid = walled();
    let at = |footprint: &Shape, x, yaw| clearance(&grid, footprint, Pose::new(x, 5.0, yaw), 3.0).unwrap();
    let (disc, plank) = (Shape::disc(0.5).unwrap(), Shape::rectangle(2.0, 1.0).unwrap());
    assert!((at(&disc, 7.0, 0.3) - 0.5).abs() < 1e-12);
    assert!((at(&disc, 10.0, 0.3) - 0.5).abs() < 1e-12);
    assert_eq!((at(&disc, 2.0, 0.0), at(&disc, 7.6, 0.0), at(&disc, 8.5, 0.0)), (3.0, 0.0, 0.0));
    assert!((at(&plank, 6.0, 0.0) - 1.0).abs() < 1e-12);
    assert!((at(&plank, 6.0, FRAC_PI_2) - 1.5).abs() < 1e-12);
    // Deep inside a wall no edge is near, yet the footprint overlaps. Far off the grid nothing is near.
    let thick = crate::oracle::grid(&[true; 2500], 50, 0.1, Pose::default());
    assert!(touches(&thick, &Shape::disc(0.05).unwrap(), Pose::new(2.5, 2.5, 0.0)).unwrap());
    assert_eq!(clearance(&thick, &disc, Pose::new(1e300, 0.0, 0.0), 1.0), Ok(1.0));
    assert!((clearance(&thick, &disc, Pose::new(-2.0, 2.0, 0.0), 9.0).unwrap() - 1.5).abs() < 1e-12);
}

#[test]
fn a_disc_stops_at_the_wall() {
    let disc = Shape::disc(0.25).unwrap();
    let (end, contact) = drive(&disc, Pose::new(5.0, 5.03, 0.0), [1.0, 0.0, 0.0], 4.0, ContactMode::Stop);
    let contact = contact.unwrap();
    assert!(near(end.position.x, 7.75) && end.position.x < 7.75 && end.position.y == 5.03, "{end:?}");
    assert!(near(contact.fraction, 2.75 / 4.0) && contact.obstacle.is_none(), "{contact:?}");
    assert!(contact.point.distance(DVec2::new(8.0, 5.03)) < 1e-9 && contact.normal.distance(DVec2::NEG_X) < 1e-9);
}

#[test]
fn a_quarter_turn_stops_where_the_corner_meets_the_wall() {
    // A plank 2 m long turns with its centre 0.8 m from the wall. The corner at the end of its half-diagonal meets the wall.
    let plank = Shape::rectangle(2.0, 0.2).unwrap();
    let (end, contact) = drive(&plank, Pose::new(7.2, 5.0, FRAC_PI_2), [0.0, 0.0, -1.0], 1.5, ContactMode::Stop);
    let expected = (0.8 / 1.01f64.sqrt()).acos() + 0.1f64.atan();
    assert!((end.yaw - expected).abs() < 2e-6, "{} {expected}", end.yaw);
    assert!(near(contact.unwrap().fraction, (FRAC_PI_2 - expected) / 1.5));
}

#[test]
fn without_contact_the_end_equals_that_of_integrate() {
    let (start, twist) = (Pose::new(3.0, 4.0, 1.0), [0.7, 0.1, -0.6]);
    for mode in [ContactMode::Stop, ContactMode::Slide, ContactMode::Report] {
        let free = (integrate(start, Twist::from(twist), 0.37), None);
        assert_eq!(drive(&Shape::disc(0.3).unwrap(), start, twist, 0.37, mode), free);
    }
}

#[test]
fn a_disc_in_contact_can_move_along_move_away_and_turn() {
    let disc = Shape::disc(0.25).unwrap();
    let (start, _) = drive(&disc, Pose::new(5.0, 5.0, 0.0), [1.0, 0.0, 0.0], 4.0, ContactMode::Stop);
    for (twist, free) in [
        ([-1.0, 0.0, 0.0], true),
        ([0.0, 1.0, 0.0], true),
        ([0.0, 0.0, 2.0], true),
        ([-1.0, 1.0, 0.0], true),
        ([1.0, 1.0, 0.0], false),
    ] {
        let (end, contact) = drive(&disc, start, twist, 0.5, ContactMode::Stop);
        assert_eq!(contact.is_none(), free, "{twist:?}");
        assert_eq!(end, integrate(start, twist.into(), if free { 0.5 } else { 0.0 }), "{twist:?}");
    }
    // Pressing against the wall for many steps does not move it.
    let mut pose = start;
    for _ in 0..2000 {
        let (next, contact) = drive(&disc, pose, [1.0, 0.0, 0.0], 0.02, ContactMode::Stop);
        assert_eq!(contact.map(|contact| contact.fraction), Some(0.0));
        pose = next;
    }
    assert_eq!(pose, start);
}

#[test]
fn a_disc_slides_at_the_component_of_its_velocity_along_the_wall() {
    let disc = Shape::disc(0.25).unwrap();
    // 0.6 m/s along the wall for two seconds; seams between cells have no effect.
    let (end, contact) = drive(&disc, Pose::new(7.5, 3.0, 0.0), [0.8, 0.6, 0.0], 2.0, ContactMode::Slide);
    assert!(near(end.position.x, 7.75) && (end.position.y - 4.2).abs() < 1e-9, "{end:?}");
    assert!(near(contact.unwrap().fraction, 0.25 / 0.8 / 2.0));
    // The same while it turns. Turning does not move the contact point of a disc.
    let mut pose = Pose::new(7.5, 3.0, 0.0);
    for _ in 0..100 {
        pose = drive(&disc, pose, [0.8, 0.6, 0.1], 0.02, ContactMode::Slide).0;
    }
    assert!(near(pose.position.x, 7.75) && pose.position.y > 4.2 && (pose.yaw - 0.2).abs() < 1e-12, "{pose:?}");
}

#[test]
fn a_robot_that_turns_against_a_wall_is_pushed_away() {
    let plank = Shape::rectangle(1.0, 0.2).unwrap();
    let mut pose = Pose::new(7.85, 5.0, FRAC_PI_2);
    for _ in 0..200 {
        pose = drive(&plank, pose, [0.0, 0.0, 1.0], FRAC_PI_2 / 200.0, ContactMode::Slide).0;
    }
    // It ends facing away from the wall, and at least its half-diagonal away: the corner had to pass.
    let widest = 8.0 - 0.5 * 1.04f64.sqrt();
    assert!((pose.yaw - PI).abs() < 1e-9 && pose.position.x <= widest + 1e-9 && pose.position.x > widest - 2e-3, "{pose:?}");
}

#[test]
fn a_corner_stops_a_slide() {
    let blocking: Vec<bool> = (0..10_000).map(|index| index % 100 >= 80 || index / 100 >= 80).collect();
    let grid = grid(&blocking, 100, 0.1, Pose::default());
    let twist = Twist::from([0.8, 0.6, 0.5]);
    for footprint in [Shape::disc(0.25).unwrap(), Shape::rectangle(0.5, 0.5).unwrap()] {
        let mut pose = Pose::new(7.3, 7.3, 0.0);
        for _ in 0..100 {
            pose = advance(&grid, &footprint, pose, twist, 0.05, ContactMode::Slide).unwrap().0;
            assert!(clearance(&grid, &footprint, pose, 1.0).unwrap() > 0.0);
        }
    }
}

#[test]
fn a_robot_that_turns_in_a_corner_is_pushed_out_of_it() {
    let blocking: Vec<bool> = (0..10_000).map(|index| index % 100 >= 80 || index / 100 >= 80).collect();
    let grid = grid(&blocking, 100, 0.1, Pose::default());
    let plank = Shape::rectangle(0.6, 0.4).unwrap();
    let mut pose = Pose::new(7.7 - 1e-6, 7.8 - 1e-6, 0.0);
    for _ in 0..100 {
        let twist = Twist::from([0.0, 0.0, PI / 4.0]);
        pose = advance(&grid, &plank, pose, twist, 0.01, ContactMode::Slide).unwrap().0;
    }
    // It ends at 45°. Its largest extent during the turn sets the distance: its half-diagonal from the wall on the right.
    assert!((pose.yaw - PI / 4.0).abs() < 1e-9, "{pose:?}");
    let (right, top) = (8.0 - 0.3f64.hypot(0.2), 8.0 - 0.5 * 0.5f64.sqrt());
    assert!(pose.position.x <= right + 1e-9 && pose.position.x > right - 1e-2, "{pose:?}");
    assert!(pose.position.y <= top && pose.position.y > top - 1e-2, "{pose:?}");
}

/// Rounding makes motion along a wall point slightly into it. This must not stop the robot.
#[test]
fn a_robot_can_move_along_a_wall_at_any_angle() {
    let blocking: Vec<bool> = (0..10_000).map(|index| index % 100 >= 80).collect();
    let disc = Shape::disc(0.25).unwrap();
    for degrees in 0..360 {
        let yaw = f64::from(degrees).to_radians();
        let grid = grid(&blocking, 100, 0.1, Pose::new(3.0, -7.0, yaw));
        // The robot has an arbitrary yaw; its twists are perpendicular to the wall and along it.
        let (sin, cos) = (1.7 * yaw).sin_cos();
        let start = grid.options().origin * Pose::new(7.0, 2.0, 1.7 * yaw);
        let (across, along) = (Twist::from([cos, -sin, 0.0]), Twist::from([sin, cos, 0.0]));
        let (mut pose, contact) = advance(&grid, &disc, start, across, 1.0, ContactMode::Stop).unwrap();
        assert!(contact.is_some());
        for _ in 0..100 {
            let (next, contact) = advance(&grid, &disc, pose, along, 0.02, ContactMode::Stop).unwrap();
            assert!(contact.is_none(), "{degrees}°: {contact:?}");
            pose = next;
        }
        assert!(clearance(&grid, &disc, pose, 1.0).unwrap() > 0.0);
    }
}

#[test]
fn a_robot_in_a_wall_can_get_out_but_not_deeper() {
    let disc = Shape::disc(0.5).unwrap();
    let start = Pose::new(7.8, 5.0, 0.0);
    // It cannot move deeper, but along the wall and away from it.
    let (end, contact) = drive(&disc, start, [1.0, 0.0, 0.0], 1.0, ContactMode::Stop);
    assert!((end.position.x - 7.8).abs() < 1e-6 && contact.unwrap().fraction == 0.0, "{end:?}");
    let (end, _) = drive(&disc, start, [0.0, 1.0, 0.0], 1.0, ContactMode::Stop);
    assert!(end.position.distance(DVec2::new(7.8, 6.0)) < 1e-9, "{end:?}");
    let (end, contact) = drive(&disc, start, [-1.0, 0.0, 0.0], 1.0, ContactMode::Stop);
    assert_eq!(end, Pose::new(6.8, 5.0, 0.0));
    assert!(contact.unwrap().normal.distance(DVec2::NEG_X) < 1e-9);
    // With its origin inside the wall it moves freely, and the contact has a zero normal.
    let (end, contact) = drive(&disc, Pose::new(8.55, 5.0, 0.0), [1.0, 0.0, 0.0], 3.0, ContactMode::Stop);
    assert_eq!((end, contact.unwrap().normal, contact.unwrap().fraction), (Pose::new(11.55, 5.0, 0.0), DVec2::ZERO, 0.0));
}

#[test]
fn a_contact_gives_the_index_of_the_obstacle() {
    let grid = walled();
    let (disc, post) = (Shape::disc(0.25).unwrap(), Shape::disc(0.5).unwrap());
    let obstacles = Obstacles::new([
        (&post, Pose::new(1.0, 9.0, 0.0)),
        (&Shape::rectangle(1.0, 1.0).unwrap(), Pose::new(5.0, 5.2, 0.0)),
    ])
    .unwrap();
    let forward = Twist::from([1.0, 0.0, 0.0]);
    let (end, contact) =
        advance((&grid, &obstacles), &disc, Pose::new(2.0, 5.0, 0.0), forward, 10.0, ContactMode::Stop).unwrap();
    assert!(near(end.position.x, 4.25) && contact.unwrap().obstacle == Some(1), "{end:?} {contact:?}");
    let (end, contact) =
        advance((&grid, &obstacles), &disc, Pose::new(2.0, 9.0, PI), forward, 10.0, ContactMode::Stop).unwrap();
    assert!(near(end.position.x, 1.75) && contact.unwrap().obstacle == Some(0), "{end:?} {contact:?}");
    assert!(touches((&grid, &obstacles), &Shape::disc(0.1).unwrap(), Pose::new(5.0, 5.0, 0.0)).unwrap());
    let around = Shape::rectangle(4.0, 4.0).unwrap();
    assert!(touches((&grid, &obstacles), &around, Pose::new(5.0, 5.2, 0.0)).unwrap());
    assert_eq!(clearance((&grid, &obstacles), &around, Pose::new(5.0, 5.2, 0.0), 1.0), Ok(0.0));
}

#[test]
fn the_error_names_the_bad_argument() {
    let (grid, disc) = (walled(), Shape::disc(0.25).unwrap());
    let error = |pose: Pose, twist: [f64; 3], dt| {
        advance(&grid, &disc, pose, twist.into(), dt, ContactMode::Stop).unwrap_err().to_string()
    };
    assert_eq!(error(Pose::new(f64::NAN, 0.0, 0.0), [0.0; 3], 1.0), "x must be finite, got NaN");
    assert_eq!(error(Pose::default(), [0.0, 0.0, f64::NAN], 1.0), "wz must be finite, got NaN");
    assert_eq!(error(Pose::default(), [0.0; 3], -1.0), "dt must be at least 0, got -1");
    assert!(error(Pose::default(), [1.0, 0.0, 0.0], 1e8).starts_with("dt must be short enough"));
    assert_eq!(clearance(&grid, &disc, Pose::default(), 0.0).unwrap_err().to_string(), "limit must be positive, got 0");
    assert!(touches(&grid, &disc, Pose::new(0.0, 0.0, f64::INFINITY)).is_err());
}

#[test]
fn a_batch_of_clearances_equals_a_loop() {
    let (grid, obstacle) = (walled(), Shape::disc(0.4).unwrap());
    let obstacles = Obstacles::new([(&obstacle, Pose::new(3.0, 3.0, 0.0))]).unwrap();
    let footprint = Shape::rectangle(0.7, 0.4).unwrap();
    let poses: Vec<[f64; 3]> =
        (0..5000).map(f64::from).map(|nth| [nth * 0.013 % 13.0 - 2.0, nth * 0.0071 % 9.0, nth]).collect();
    let world = (&grid, &obstacles);
    let one = |pose: &[f64; 3]| clearance(world, &footprint, Pose::from(*pose), 2.0).unwrap();
    let expected: Vec<f64> = poses.iter().map(one).collect();
    assert!([0.0, 2.0].iter().all(|limit| expected.contains(limit)));
    for threads in [None, Some(1), Some(3)] {
        let mut found = vec![-1.0; poses.len()];
        clearance_batch(world, &footprint, &poses, 2.0, threads, &mut found).unwrap();
        assert_eq!(found, expected, "{threads:?}");
    }
    let error = |poses: &[[f64; 3]], limit, found: &mut [f64]| {
        clearance_batch(&grid, &footprint, poses, limit, None, found).unwrap_err().to_string()
    };
    assert_eq!(
        error(&[[0.0; 3], [0.0, f64::NAN, 0.0]], 1.0, &mut [0.0; 2]),
        "poses must be finite, got [0.0, NaN, 0.0] in row 1"
    );
    assert_eq!(error(&[[0.0; 3]], 0.0, &mut [0.0]), "limit must be positive, got 0");
    assert_eq!(error(&[[0.0; 3]], 1.0, &mut []), "out must have 1 elements, got 0");
}
