//! Rays and obstacles: ranges worked out by hand, a reference that intersects every edge, and the same scene drawn as cells.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use glam::DVec2;
use mobile_robot_simulator::raycast::cast_rays;
use mobile_robot_simulator::{
    BeamLayout, BeamModel, BeamModelOptions, Contact, ContactMode, GridOptions, LaserScanner, Noise, OCCUPIED_THRESHOLD,
    Obstacles, OccupancyGrid, Pose, ScannerOptions, Shape, Twist, Unknown, World, advance, clearance, random, touches,
};
use rand::RngExt;

const SEED: u64 = 40;

const FAR: f64 = 1e6;

/// An L made of three unit squares, and an arrow whose tail has a notch.
const L_SHAPE: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
const ARROW: [[f64; 2]; 4] = [[1.0, 0.0], [-1.0, 1.0], [-0.5, 0.0], [-1.0, -1.0]];

fn grid(width: usize, cells: Vec<i8>, resolution: f64, origin: Pose) -> OccupancyGrid {
    let options = GridOptions { resolution, origin, occupied_threshold: OCCUPIED_THRESHOLD, unknown: Unknown::Free };
    OccupancyGrid::new(cells, width, options).expect("a good grid")
}

fn empty() -> OccupancyGrid {
    grid(1, vec![0], 1.0, Pose::new(1e5, 1e5, 0.0))
}

fn cast(obstacles: &Obstacles, x: f64, y: f64, angle: f64) -> f64 {
    let (sin, cos) = libm::sincos(angle);
    obstacles.cast(DVec2::new(x, y), DVec2::new(cos, sin), FAR)
}

#[test]
fn ranges_to_a_disc_worked_out_by_hand() {
    let disc = Obstacles::new([(&Shape::disc(1.0).unwrap(), Pose::new(3.0, 0.0, 2.0))]).unwrap();
    assert_eq!(cast(&disc, 0.0, 0.0, 0.0), 2.0);
    assert_eq!(cast(&disc, 0.0, 0.0, PI), f64::INFINITY);
    assert_eq!(cast(&disc, 3.5, 0.5, 1.0), 0.0);
    // The ray passes the centre at a distance of 0.6, so it enters 0.8 before the nearest point: 0.6² + 0.8² = 1.
    assert!((cast(&disc, 0.0, 0.6, 0.0) - 2.2).abs() < 1e-15);
    assert!((cast(&disc, 0.0, 3.0, -FRAC_PI_4) - (18f64.sqrt() - 1.0)).abs() < 1e-15);
    assert_eq!(cast(&disc, 0.0, 1.0 + 1e-12, 0.0), f64::INFINITY);
    // From a point on the circle: 0 inwards, no hit outwards.
    assert_eq!(cast(&disc, 2.0, 0.0, 0.0), 0.0);
    assert_eq!(cast(&disc, 2.0, 0.0, PI), f64::INFINITY);
}

#[test]
fn ranges_to_a_polygon_worked_out_by_hand() {
    let l_shape = Obstacles::new([(&Shape::polygon(&L_SHAPE).unwrap(), Pose::default())]).unwrap();
    assert_eq!(cast(&l_shape, -1.0, 0.5, 0.0), 1.0);
    assert_eq!(cast(&l_shape, 3.0, 1.5, PI), 2.0);
    assert_eq!(cast(&l_shape, 3.0, 0.5, PI), 1.0);
    assert_eq!(cast(&l_shape, 0.5, 0.5, 0.3), 0.0);
    // From the notch, which is outside of the polygon.
    assert_eq!(cast(&l_shape, 1.5, 1.5, PI), 0.5);
    assert!((cast(&l_shape, 1.5, 1.5, -FRAC_PI_2) - 0.5).abs() < 1e-15);
    assert_eq!(cast(&l_shape, 1.5, 1.5, FRAC_PI_4), f64::INFINITY);
    assert!((cast(&l_shape, 3.0, 3.0, -3.0 * FRAC_PI_4) - 8f64.sqrt()).abs() < 1e-15);
    // From a point on an edge, inwards.
    assert_eq!(cast(&l_shape, 0.0, 0.5, 0.0), 0.0);
    assert_eq!(cast(&l_shape, 2.0, 0.5, PI), 0.0);
    // The same polygon, rotated and shifted.
    let turned = Obstacles::new([(&Shape::polygon(&L_SHAPE).unwrap(), Pose::new(10.0, 0.0, FRAC_PI_2))]).unwrap();
    assert!((cast(&turned, 9.5, -1.0, FRAC_PI_2) - 1.0).abs() < 1e-15);
    assert!((cast(&turned, 7.0, 0.5, 0.0) - 1.0).abs() < 1e-15);
}

/// Returns the distance to the nearest edge or circle, each intersected on its own; 0 from inside.
///
/// A point is inside a polygon if the angles between successive corners, seen from the point, add up to a full turn.
fn by_every_edge(shapes: &[(Shape, Pose)], origin: DVec2, direction: DVec2) -> f64 {
    let mut nearest = f64::INFINITY;
    for (shape, pose) in shapes {
        if let Some(radius) = shape.radius() {
            let offset = origin - pose.position;
            let (b, c) = (offset.dot(direction), offset.length_squared() - radius * radius);
            let root = (b * b - c).sqrt();
            if c < 0.0 {
                nearest = 0.0;
            } else if b < 0.0 && !root.is_nan() {
                nearest = nearest.min(-b - root);
            }
            continue;
        }
        let corners: Vec<DVec2> = shape.corners().iter().map(|&corner| pose.transform_point(corner)).collect();
        let mut turned = 0.0;
        for (index, &start) in corners.iter().enumerate() {
            let end = corners[(index + 1) % corners.len()];
            turned += (start - origin).angle_to(end - origin);
            // origin + t · direction = start + s · (end - start), by Cramer's rule.
            let (along, offset) = (end - start, start - origin);
            let t = offset.perp_dot(along) / direction.perp_dot(along);
            let s = offset.perp_dot(direction) / direction.perp_dot(along);
            if t >= 0.0 && (0.0..=1.0).contains(&s) {
                nearest = nearest.min(t);
            }
        }
        if turned.abs() > PI {
            nearest = 0.0;
        }
    }
    nearest
}

fn shapes(stream: &mut random::Stream, count: usize) -> Vec<(Shape, Pose)> {
    let mut draw = |low: f64, high: f64| low + (high - low) * stream.random::<f64>();
    (0..count)
        .map(|index| {
            let shape = match index % 4 {
                0 => Shape::disc(draw(0.05, 1.0)),
                1 => Shape::rectangle(draw(0.1, 2.0), draw(0.1, 2.0)),
                2 => Shape::polygon(&L_SHAPE),
                _ => Shape::polygon(&ARROW),
            };
            (shape.unwrap(), Pose::new(draw(-5.0, 5.0), draw(-5.0, 5.0), draw(-PI, PI)))
        })
        .collect()
}

fn set<'a>(placed: impl IntoIterator<Item = &'a (Shape, Pose)>) -> Obstacles {
    Obstacles::new(placed.into_iter().map(|(shape, pose)| (shape, *pose))).unwrap()
}

#[test]
fn rays_agree_with_the_reference() {
    let mut stream = random::stream(SEED, 0);
    let mut met = 0;
    for round in 0..4000 {
        let shapes = shapes(&mut stream, 1 + round % 7);
        let obstacles = set(&shapes);
        for _ in 0..10 {
            let origin = DVec2::new(stream.random::<f64>() - 0.5, stream.random::<f64>() - 0.5) * 14.0;
            let (sin, cos) = libm::sincos(stream.random::<f64>() * TAU);
            let direction = DVec2::new(cos, sin);
            let expected = by_every_edge(&shapes, origin, direction);
            let found = obstacles.cast(origin, direction, FAR);
            assert!(
                found == expected || (found - expected).abs() < 1e-12,
                "{found} {expected}: {origin} {direction} {shapes:?}"
            );
            met += usize::from(found < FAR);
        }
    }
    assert!(met > 7000, "{met}");
}

/// A ray aimed exactly at a corner hits one of its two edges and never passes between them.
#[test]
fn no_ray_passes_through_a_corner() {
    let mut stream = random::stream(SEED, 1);
    for _ in 0..20_000 {
        let pose = Pose::new(stream.random::<f64>(), stream.random::<f64>(), stream.random::<f64>() * TAU);
        let obstacles = Obstacles::new([(&Shape::rectangle(2.0, 2.0).unwrap(), pose)]).unwrap();
        let away = DVec2::new(1.0 + 9.0 * stream.random::<f64>(), 1.0 + 9.0 * stream.random::<f64>());
        let (origin, corner) = (pose.transform_point(DVec2::ONE + away), pose.transform_point(DVec2::ONE));
        let found = obstacles.cast(origin, (corner - origin).normalize(), FAR);
        assert!((found - corner.distance(origin)).abs() < 1e-12, "{found}");
    }
}

#[test]
fn each_beam_of_a_scan_agrees_with_the_reference() {
    let mut stream = random::stream(SEED, 2);
    let mut met = 0;
    for round in 0..600 {
        let fov = [TAU, 4.71, 1.0, 6.0, 1e-3][round % 5];
        let beam_count = [1, 2, 361, 541, 700][round / 5 % 5];
        let mount = Pose::new(0.2, -0.1, [0.0, 3.0, -1.5][round % 3]);
        let scanner =
            ScannerOptions { layout: BeamLayout::Fov(fov), beam_count, min_range: 0.0, max_range: 6.0, mount: mount.into() };
        let scanner = LaserScanner::new(scanner).unwrap();
        let shapes = shapes(&mut stream, round % 6);
        let obstacles = set(&shapes);
        let base =
            Pose::new(4.0 * stream.random::<f64>() - 2.0, 4.0 * stream.random::<f64>() - 2.0, 9.0 * stream.random::<f64>());
        let mut ranges = vec![0.0; beam_count];
        scanner.scan((&empty(), &obstacles), base, &mut ranges).expect("a kernel");
        let laser = base * mount;
        for (beam, &range) in ranges.iter().enumerate() {
            let direction = DVec2::from_angle(laser.yaw + scanner.angle(beam));
            let expected = by_every_edge(&shapes, laser.position, direction).min(6.0);
            assert!((f64::from(range) - expected).abs() < 1e-6, "{range} {expected}: beam {beam} of {round}");
            met += usize::from(range < 6.0);
        }
    }
    assert!(met > 20_000, "{met}");
}

/// A scan gives the same ranges whether squares are blocking cells or obstacles on free cells.
#[test]
fn square_obstacles_equal_blocking_cells() {
    let mut stream = random::stream(SEED, 3);
    let (width, height, resolution) = (40, 30, 0.25);
    for _ in 0..40 {
        let origin = Pose::new(-3.0, 1.0, stream.random::<f64>() * TAU);
        let walls: Vec<bool> = (0..width * height).map(|_| stream.random::<f64>() < 0.04).collect();
        let drawn: Vec<bool> = walls.iter().map(|&wall| wall && stream.random::<f64>() < 0.5).collect();
        let cells = |blocks: &[bool]| blocks.iter().map(|&blocks| if blocks { 100 } else { 0 }).collect::<Vec<i8>>();
        let whole = grid(width, cells(&walls), resolution, origin);
        let part = grid(width, cells(&drawn), resolution, origin);
        let square = Shape::rectangle(resolution, resolution).unwrap();
        let standing = (0..width * height).filter(|&index| walls[index] && !drawn[index]);
        let poses = standing.map(|index| {
            let center = DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5) * resolution;
            Pose { position: origin.transform_point(center), yaw: origin.yaw }
        });
        let obstacles = Obstacles::new(poses.map(|pose| (&square, pose))).unwrap();
        let scanner = LaserScanner::new(ScannerOptions::default()).unwrap();
        let free = part.draw_free_pose(0.0, 1).unwrap();
        let pose = Pose { yaw: 1.0, ..free };
        if whole.is_blocking(whole.cell_at(pose.position).unwrap()) {
            continue;
        }
        let (mut by_cells, mut by_shapes) = (vec![0.0; 541], vec![0.0; 541]);
        scanner.scan(&whole, pose, &mut by_cells).expect("a kernel");
        scanner.scan((&part, &obstacles), pose, &mut by_shapes).expect("a kernel");
        for (a, b) in by_cells.iter().zip(&by_shapes) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }
}

#[test]
fn unrelated_rays_hit_obstacles_too() {
    let disc = Obstacles::new([(&Shape::disc(0.5).unwrap(), Pose::new(2.0, 0.0, 0.0))]).unwrap();
    let mut ranges = [0.0; 3];
    let rays = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [2.0, 0.1, 0.0]];
    cast_rays((&empty(), &disc), &rays, 9.0, None, &mut ranges).unwrap();
    assert_eq!(ranges, [1.5, 9.0, 0.0]);
    // An obstacle at max_range or beyond it is not hit.
    cast_rays((&empty(), &disc), &rays[..1], 1.5, None, &mut ranges[..1]).unwrap();
    cast_rays((&empty(), &disc), &rays[..1], 1.0, None, &mut ranges[1..2]).unwrap();
    assert_eq!(ranges[..2], [1.5, 1.0]);
}

#[test]
fn a_batch_does_not_depend_on_threads_or_splits() {
    let mut stream = random::stream(SEED, 4);
    let obstacles = set(&shapes(&mut stream, 20));
    let grid =
        grid(40, (0..1600).map(|index| if index % 37 == 0 { 100 } else { 0 }).collect(), 0.25, Pose::new(-5.0, -5.0, 0.3));
    let poses: Vec<[f64; 3]> = (0..60).map(|_| [0.0; 3].map(|_: f64| 6.0 * stream.random::<f64>() - 3.0)).collect();
    let scanner = LaserScanner::new(ScannerOptions::default()).unwrap();
    let model = BeamModel::new(BeamModelOptions { z_rand: 0.1, z_short: 0.1, ..BeamModelOptions::default() }).unwrap();
    let scan = |poses: &[[f64; 3]], first_index: u64, threads: usize| {
        let mut readings = vec![0.0; poses.len() * 541];
        let noise = Some(Noise { model, surface: None, seed: SEED, first_index });
        scanner.scan_batch((&grid, &obstacles), poses, noise, Some(threads), &mut readings).unwrap();
        readings
    };
    let whole = scan(&poses, 0, 1);
    assert_eq!(scan(&poses, 0, 2), whole);
    assert_eq!(scan(&poses, 0, 5), whole);
    assert_eq!([scan(&poses[..17], 0, 1), scan(&poses[17..], 17, 3)].concat(), whole);
}

#[test]
fn obstacles_out_of_sight_do_not_change_a_scan() {
    let grid = grid(40, (0..1600).map(|index| if index % 37 == 0 { 100 } else { 0 }).collect(), 0.25, Pose::default());
    let scanner = LaserScanner::new(ScannerOptions { layout: BeamLayout::Fov(2.0), ..ScannerOptions::default() }).unwrap();
    let model = BeamModel::new(BeamModelOptions::default()).unwrap();
    let scan = |obstacles: &Obstacles| {
        let mut readings = vec![0.0; 541];
        let noise = Some(Noise { model, surface: None, seed: SEED, first_index: 3 });
        scanner.scan_batch((&grid, obstacles), &[[5.1, 5.1, 0.0]], noise, None, &mut readings).unwrap();
        readings
    };
    let behind = Obstacles::new([(&Shape::disc(0.5).unwrap(), Pose::new(3.0, 5.0, 0.0))]).unwrap();
    assert_eq!(scan(&behind), scan(Obstacles::NONE));
}

#[test]
fn the_error_names_the_coordinate_that_is_not_finite() {
    let error = Obstacles::new([(&Shape::disc(1.0).unwrap(), Pose::new(0.0, f64::INFINITY, 0.0))]).unwrap_err();
    assert_eq!(error.to_string(), "y must be finite, got inf");
}

/// Returns discs and rectangles at random places around the origin.
fn crowd(count: usize, stream: &mut impl rand::Rng) -> Vec<(Shape, Pose)> {
    let placed = (0..count).map(|index| {
        let shape = match index % 7 {
            0 => Shape::rectangle(3.0, 0.1).unwrap(),
            1 | 2 => Shape::rectangle(0.6, 0.4).unwrap(),
            _ => Shape::disc(0.2).unwrap(),
        };
        let [x, y, yaw] = [(); 3].map(|()| stream.random_range(-14.0..14.0));
        (shape, Pose::new(x, y, yaw))
    });
    placed.collect()
}

#[test]
fn among_many_obstacles_each_range_is_the_shortest_one_among_one_of_them() {
    let mut stream = random::stream(SEED, 9);
    let placed = crowd(300, &mut stream);
    let many = set(&placed);
    for (layout, count) in [(BeamLayout::Fov(TAU), 1000), (BeamLayout::Fov(4.0), 541), (BeamLayout::Fov(0.1), 3)] {
        let laser = LaserScanner::new(ScannerOptions { layout, beam_count: count, ..ScannerOptions::default() }).unwrap();
        for _ in 0..20 {
            let [x, y, yaw] = [(); 3].map(|()| stream.random_range(-9.0..9.0));
            let (mut ranges, mut expected, mut one) = (vec![0.0; count], vec![f32::INFINITY; count], vec![0.0; count]);
            laser.scan((&empty(), &many), Pose::new(x, y, yaw), &mut ranges).unwrap();
            for each in &placed {
                laser.scan((&empty(), &set([each])), Pose::new(x, y, yaw), &mut one).unwrap();
                expected.iter_mut().zip(&one).for_each(|(least, range)| *least = least.min(*range));
            }
            assert_eq!(ranges, expected);
        }
    }
}

#[test]
fn a_robot_among_many_obstacles_moves_as_among_the_nearest() {
    let mut stream = random::stream(SEED, 10);
    let (mut contacts, robot) = (0, Shape::rectangle(0.5, 0.4).unwrap());
    let mut placed = crowd(400, &mut stream);
    let (mut many, grid) = (set(&placed), empty());
    for turn in 0..2000 {
        // One obstacle moves.
        let index = 31 * turn % placed.len();
        placed[index].1 = crowd(1, &mut stream)[0].1;
        many.place(index, &placed[index].0, placed[index].1).unwrap();
        let [x, y, yaw] = [(); 3].map(|()| stream.random_range(-12.0..12.0));
        let pose = Pose::new(x, y, yaw);
        let is_near = |(_, place): &&(Shape, Pose)| place.position.distance(pose.position) < 4.0;
        let near: Vec<usize> = (0..placed.len()).filter(|&index| is_near(&&placed[index])).collect();
        let few = set(near.iter().map(|&index| &placed[index]));
        let (all, part) = (World::from((&grid, &many)), (&grid, &few));
        assert_eq!(touches(all, &robot, pose).unwrap(), touches(part, &robot, pose).unwrap());
        assert_eq!(clearance(all, &robot, pose, 1.5).unwrap(), clearance(part, &robot, pose, 1.5).unwrap());
        for mode in [ContactMode::Stop, ContactMode::Slide] {
            let twist = Twist::from([1.0, 0.2, 0.5]);
            let (end, contact) = advance(all, &robot, pose, twist, 1.0, mode).unwrap();
            let (expected_end, expected) = advance(part, &robot, pose, twist, 1.0, mode).unwrap();
            let expected = expected.map(|contact| Contact { obstacle: contact.obstacle.map(|at| near[at]), ..contact });
            assert_eq!((end, contact), (expected_end, expected));
            contacts += usize::from(contact.is_some());
        }
    }
    assert!(contacts > 1000, "{contacts}");
}

#[test]
fn an_obstacle_that_is_left_out_is_as_if_it_were_not_there() {
    let mut stream = random::stream(SEED, 11);
    let placed = crowd(100, &mut stream);
    let (many, grid) = (set(&placed), empty());
    let rays: Vec<[f64; 3]> = (0..500).map(|_| [(); 3].map(|()| stream.random_range(-9.0..9.0))).collect();
    let (mut ranges, mut expected) = (vec![0.0; rays.len()], vec![0.0; rays.len()]);
    for except in [0, 42, 99] {
        let world = World { grid: &grid, obstacles: &many, except: Some(except) };
        let others = set(placed.iter().enumerate().filter(|(index, _)| *index != except).map(|(_, each)| each));
        cast_rays(world, &rays, 30.0, None, &mut ranges).unwrap();
        cast_rays((&grid, &others), &rays, 30.0, None, &mut expected).unwrap();
        assert_eq!(ranges, expected);
    }
}

#[test]
fn only_the_next_index_adds_an_obstacle() {
    let (disc, mut obstacles) = (Shape::disc(1.0).unwrap(), Obstacles::default());
    assert_eq!(
        obstacles.place(1, &disc, Pose::default()).unwrap_err().to_string(),
        "index must be at most the number of obstacles, got 1"
    );
    assert!(obstacles.is_empty());
    obstacles.place(0, &disc, Pose::new(3.0, 0.0, 0.0)).unwrap();
    assert!(obstacles.place(0, &disc, Pose::new(f64::NAN, 0.0, 0.0)).is_err());
    assert_eq!((obstacles.len(), cast(&obstacles, 0.0, 0.0, 0.0)), (1, 2.0));
    assert_eq!(cast(&obstacles.try_clone().unwrap(), 0.0, 0.0, 0.0), 2.0);
}
