//! Scores of scans: against the sum of the logarithms of likelihoods, and the same bytes for kernels, threads and splits.

use std::f64::consts::PI;

use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{
    BeamLayout, BeamModel, BeamModelOptions, Course, Courses, GridOptions, LaserScanner, Mount, MovingObstacle, NoReturn,
    Noise, OCCUPIED_THRESHOLD, Obstacles, OccupancyGrid, Pose, Readings, ScannerOptions, Score, Shape, Sweeps, Twist,
    Unknown, random,
};
use rand::RngExt;

const SIDE: usize = 120;
const POSES: usize = 100;

fn world() -> OccupancyGrid {
    let origin = Pose::new(-1.0, 0.5, 0.3);
    let options = GridOptions { resolution: 0.1, origin, occupied_threshold: OCCUPIED_THRESHOLD, unknown: Unknown::Free };
    let cells = (0..SIDE * SIDE).map(|index| if (index * 7919).is_multiple_of(300) { 100 } else { 0 }).collect();
    OccupancyGrid::new(cells, SIDE, options).expect("a grid")
}

fn scanner(beam_count: usize, mount: Mount) -> LaserScanner {
    let options = ScannerOptions { layout: BeamLayout::Fov(5.0), beam_count, min_range: 0.1, max_range: 6.0, mount };
    LaserScanner::new(options).expect("a scanner")
}

fn model() -> BeamModel {
    let options = BeamModelOptions {
        sigma_hit: 0.3,
        lambda_short: 0.7,
        z_hit: 0.7,
        z_short: 0.1,
        z_max: 0.1,
        z_rand: 0.1,
        ..BeamModelOptions::default()
    };
    BeamModel::new(options).expect("a model")
}

fn poses(seed: u64) -> Vec<[f64; 3]> {
    let mut stream = random::stream(seed, 0);
    (0..POSES)
        .map(|_| [stream.random_range(-1.0..11.0), stream.random_range(0.0..12.0), stream.random_range(-PI..PI)])
        .collect()
}

/// Returns `temper` times the sum of the logarithms of the likelihoods of some beams, for each scan.
fn expected(laser: &LaserScanner, readings: &[f32], ranges: &[f32], beams: &[usize], temper: f64) -> Vec<f64> {
    let options = laser.options();
    let score = |scan: usize| {
        let each = |&beam: &usize| {
            let at = scan * options.beam_count + beam;
            let limits = (options.min_range, options.max_range);
            model().likelihoods([readings[at]], [ranges[at]], limits).unwrap()[0]
        };
        beams.iter().map(each).map(f64::ln).sum::<f64>() * temper
    };
    (0..readings.len() / options.beam_count).map(score).collect()
}

fn assert_close(found: &[f64], expected: &[f64]) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} {expected}");
    }
    assert_eq!(found.len(), expected.len());
}

#[test]
fn scores_are_sums_of_logarithms_of_likelihoods() {
    let (grid, shape) = (world(), Shape::rectangle(1.0, 0.5).unwrap());
    let obstacles = Obstacles::new([(&shape, Pose::new(5.0, 5.0, 0.4)), (&shape, Pose::new(3.0, 8.0, 1.0))]).unwrap();
    let (poses, others) = (poses(1), poses(2));
    for (beam_count, mount) in [
        (7, Mount::default()),
        (61, Mount::new([0.2, -0.1, 0.0], [0.0, 0.0, 0.5])),
        (541, Mount::new([0.2, -0.1, 0.3], [PI, 0.0, 0.5])),
        (100, Mount::new([0.0, 0.0, 0.3], [0.1, 0.2, 0.5])),
    ] {
        let laser = scanner(beam_count, mount);
        let mut ranges = vec![0.0; POSES * beam_count];
        laser.scan_batch((&grid, &obstacles), &poses, None, None, &mut ranges).unwrap();
        let mut readings = vec![0.0; POSES * beam_count];
        let noise = Noise { surface: None, model: model(), seed: 4, first_index: 0 };
        laser.scan_batch((&grid, &obstacles), &others, Some(noise), None, &mut readings).unwrap();
        laser.mark_invalid(&mut readings, NoReturn::Inf);
        for beams in [None, Some(vec![0]), Some((0..beam_count).step_by(3).collect::<Vec<_>>())] {
            let numbers = beams.clone().unwrap_or_else(|| (0..beam_count).collect());
            let model = model();
            let score = |readings, temper| Score { model: &model, readings, beams: beams.as_deref(), temper };
            let mut found = vec![0.0; POSES];
            laser
                .log_likelihoods((&grid, &obstacles), &poses, score(Readings::Each(&readings), 0.5), None, &mut found)
                .unwrap();
            assert_close(&found, &expected(&laser, &readings, &ranges, &numbers, 0.5));
            let one = &readings[..beam_count];
            laser.log_likelihoods((&grid, &obstacles), &poses, score(Readings::One(one), 1.0), None, &mut found).unwrap();
            assert_close(&found, &expected(&laser, &one.repeat(POSES), &ranges, &numbers, 1.0));
        }
    }
}

#[test]
fn scores_of_scans_that_take_time_use_the_pose_of_each_beam() {
    let (grid, disc, laser) = (world(), Shape::disc(0.6).unwrap(), scanner(90, Mount::new([0.1, 0.0, 0.0], [0.0; 3])));
    let (poses, twists) = (poses(3), vec![[1.0, -0.5, 2.0]; POSES]);
    let course = Course::Arc { start: Pose::new(5.0, 5.0, 0.0), twist: Twist::from([1.0, 0.0, 1.0]) };
    let obstacles = [MovingObstacle { shape: &disc, course }];
    let courses = Courses::Arcs { poses: &poses, twists: &twists };
    let sweeps = Sweeps { courses, scan_duration: 0.3, obstacles: &obstacles };
    let mut ranges = vec![0.0; POSES * 90];
    laser.sweep_batch(&grid, sweeps, None, None, &mut ranges).unwrap();
    let readings = &ranges.clone()[180..270];
    for beams in [None, Some(vec![3, 50, 51])] {
        let numbers = beams.clone().unwrap_or_else(|| (0..90).collect());
        let score = Score { model: &model(), readings: Readings::One(readings), beams: beams.as_deref(), temper: 1.0 };
        let mut found = vec![0.0; POSES];
        laser.log_likelihoods_of_sweeps(&grid, sweeps, score, None, &mut found).unwrap();
        assert_close(&found, &expected(&laser, &readings.repeat(POSES), &ranges, &numbers, 1.0));
    }
}

#[test]
fn scores_do_not_depend_on_kernels_threads_or_splits() {
    let (grid, poses) = (world(), poses(5));
    for beam_count in [7, 61, 541] {
        let laser = scanner(beam_count, Mount::default());
        let mut readings = vec![0.0; beam_count];
        laser.scan_batch(&grid, &poses[..1], None, None, &mut readings).unwrap();
        let score = Score { model: &model(), readings: Readings::One(&readings), beams: None, temper: 1.0 };
        let scores = |laser: &LaserScanner, poses: &[[f64; 3]], threads| {
            let mut scores = vec![0.0; poses.len()];
            laser.log_likelihoods(&grid, poses, score, Some(threads), &mut scores).unwrap();
            scores
        };
        let whole = scores(&laser, &poses, 1);
        assert_eq!(scores(&laser, &poses, 3), whole);
        assert_eq!([scores(&laser, &poses[..37], 1), scores(&laser, &poses[37..], 2)].concat(), whole);
        for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.is_available()) {
            assert_eq!(scores(&laser.clone().with_kernel(kernel), &poses, 1), whole, "{}", kernel.name());
        }
    }
}

#[test]
fn the_error_names_the_bad_value() {
    let (grid, laser) = (world(), scanner(5, Mount::default()));
    let error = |poses: &[[f64; 3]], score: Score<'_>, out: usize| {
        laser.log_likelihoods(&grid, poses, score, None, &mut vec![0.0; out]).unwrap_err().to_string()
    };
    let model = model();
    let good = Score { model: &model, readings: Readings::One(&[1.0; 5]), beams: None, temper: 1.0 };
    assert_eq!(error(&[[f64::NAN; 3]], good, 1), "poses must be finite, got [NaN, NaN, NaN] in row 0");
    assert_eq!(error(&[[0.0; 3]], good, 2), "out must have 1 elements, got 2");
    assert_eq!(error(&[[0.0; 3]], Score { temper: -1.0, ..good }, 1), "temper must be positive, got -1");
    assert_eq!(error(&[[0.0; 3]], Score { beams: Some(&[1, 5]), ..good }, 1), "beams must be less than beam_count, got 5");
    let short = Score { readings: Readings::One(&[1.0; 4]), ..good };
    assert_eq!(error(&[[0.0; 3]], short, 1), "ranges must have 5 elements, got 4");
    let short = Score { readings: Readings::Each(&[1.0; 5]), ..good };
    assert_eq!(error(&[[0.0; 3]; 2], short, 2), "ranges must have 10 elements, got 5");
}
