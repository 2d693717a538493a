//! Scores of the likelihood field: against the distances to all blocking cells, and the same bytes for threads and splits.

use std::f64::consts::PI;

use glam::DVec2;
use mobile_robot_simulator::{
    BeamLayout, Cell, GridOptions, LaserScanner, LikelihoodField, LikelihoodFieldOptions, Mount, NoReturn,
    OCCUPIED_THRESHOLD, OccupancyGrid, Pose, Readings, ScannerOptions, Score, Unknown, random,
};
use rand::RngExt;

const SIDE: usize = 60;
const POSES: usize = 150;

const OPTIONS: LikelihoodFieldOptions =
    LikelihoodFieldOptions { sigma_hit: 0.25, z_hit: 1.8, z_rand: 0.2, max_distance: 0.77 };

fn world() -> OccupancyGrid {
    let origin = Pose::new(-1.0, 0.5, 0.3);
    let options = GridOptions { resolution: 0.1, origin, occupied_threshold: OCCUPIED_THRESHOLD, unknown: Unknown::Free };
    let cells = (0..SIDE * SIDE).map(|index| if (index * 7919).is_multiple_of(300) { 100 } else { 0 }).collect();
    OccupancyGrid::new(cells, SIDE, options).expect("a grid")
}

fn scanner(beam_count: usize, mount: Mount) -> LaserScanner {
    let options = ScannerOptions { layout: BeamLayout::Fov(5.0), beam_count, min_range: 0.1, max_range: 4.0, mount };
    LaserScanner::new(options).expect("a scanner")
}

/// Poses, also off the grid.
fn poses(seed: u64) -> Vec<[f64; 3]> {
    let mut stream = random::stream(seed, 0);
    (0..POSES)
        .map(|_| [stream.random_range(-2.0..7.0), stream.random_range(-1.0..8.0), stream.random_range(-PI..PI)])
        .collect()
}

/// Returns the distance between the centre of the cell of a point and that of the nearest blocking cell; `None` if the point
/// is so near to an edge of its cell that rounding decides.
fn distance(grid: &OccupancyGrid, blocking: &[DVec2], point: DVec2) -> Option<f64> {
    let at = grid.to_cells(point);
    let is_near_edge = (at - at.round()).abs().min_element() < 1e-9;
    let center = at.floor() + 0.5;
    let nearest = blocking.iter().map(|other| other.distance(center)).fold(f64::INFINITY, f64::min);
    (!is_near_edge).then_some(nearest * grid.resolution())
}

fn blocking(grid: &OccupancyGrid) -> Vec<DVec2> {
    let cells = (0..SIDE * SIDE).map(|index| Cell { col: index % SIDE, row: index / SIDE });
    let blocking = cells.filter(|&cell| grid.is_blocking(cell));
    blocking.map(|cell| DVec2::new(cell.col as f64 + 0.5, cell.row as f64 + 0.5)).collect()
}

/// Returns `temper` times the sum of the logarithms of the formula of the book.
fn expected(grid: &OccupancyGrid, laser: &LaserScanner, pose: [f64; 3], readings: &[f32], temper: f64) -> Option<f64> {
    let LikelihoodFieldOptions { sigma_hit, z_hit, z_rand, max_distance } = OPTIONS;
    let mut sum = 0.0;
    for [x, y] in laser.end_points(Pose::from(pose), readings).expect("points") {
        let distance = distance(grid, &blocking(grid), DVec2::new(x, y))?.min(max_distance);
        let normal = (-0.5 * (distance / sigma_hit).powi(2)).exp() / (sigma_hit * (2.0 * PI).sqrt());
        sum += (z_hit / 2.0 * normal + z_rand / 2.0 / laser.options().max_range).ln();
    }
    Some(temper * sum)
}

#[test]
fn scores_are_those_of_the_book() {
    let (grid, model) = (world(), LikelihoodField::new(OPTIONS).unwrap());
    let mut compared = 0;
    for (beam_count, mount) in [
        (7, Mount::default()),
        (61, Mount::new([0.2, -0.1, 0.0], [0.0, 0.0, 0.5])),
        (100, Mount::new([0.2, -0.1, 0.3], [PI, 0.0, 0.5])),
        (50, Mount::new([0.0, 0.0, -0.3], [0.1, 0.2, 0.5])),
    ] {
        let laser = scanner(beam_count, mount);
        let (poses, others) = (poses(1), poses(2));
        let mut readings = vec![0.0; POSES * beam_count];
        laser.scan_batch(&grid, &others, None, None, &mut readings).unwrap();
        laser.mark_invalid(&mut readings, NoReturn::Inf);
        readings[3] = f32::NAN;
        for temper in [1.0, 0.3] {
            let each = Score { model: &model, readings: Readings::Each(&readings), beams: None, temper };
            let one = Score { readings: Readings::One(&readings[..beam_count]), ..each };
            for (score, step) in [(each, beam_count), (one, 0)] {
                let mut scores = vec![0.0; POSES];
                model.log_likelihoods(&laser, &grid, &poses, score, None, &mut scores).unwrap();
                for (index, (&pose, &found)) in poses.iter().zip(&scores).enumerate() {
                    let readings = &readings[index * step..][..beam_count];
                    let Some(expected) = expected(&grid, &laser, pose, readings, temper) else { continue };
                    assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} {expected} {pose:?}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 2000);
}

#[test]
fn only_the_beams_that_count_are_scored() {
    let (grid, model, laser) = (world(), LikelihoodField::new(OPTIONS).unwrap(), scanner(61, Mount::default()));
    let mut readings = vec![0.0; 61];
    laser.scan(&grid, Pose::new(2.0, 3.0, 0.1), &mut readings).unwrap();
    let beams = [3, 20, 60];
    let chosen: Vec<f32> = (0..61).map(|beam| if beams.contains(&beam) { readings[beam] } else { f32::NAN }).collect();
    let all = Score { model: &model, readings: Readings::One(&chosen), beams: None, temper: 1.0 };
    let some = Score { readings: Readings::One(&readings), beams: Some(&beams), ..all };
    let [all, some] = [all, some].map(|score| {
        let mut scores = vec![0.0; POSES];
        model.log_likelihoods(&laser, &grid, &poses(1), score, None, &mut scores).unwrap();
        scores
    });
    assert_eq!(all, some);
}

#[test]
fn readings_of_the_floor_do_not_count() {
    let (grid, model) = (world(), LikelihoodField::new(OPTIONS).unwrap());
    let score = |mount: Mount, reading: f32| {
        let laser = scanner(1, mount);
        let score = Score { model: &model, readings: Readings::One(&[reading]), beams: None, temper: 1.0 };
        let mut scores = [0.0];
        model.log_likelihoods(&laser, &grid, &[[2.0, 3.0, 0.0]], score, None, &mut scores).unwrap();
        scores[0]
    };
    // Looking down by 30°, the floor is 2 m away along the beam.
    let down = Mount::new([0.0, 0.0, 1.0], [0.0, PI / 6.0, 0.0]);
    assert_eq!(score(down, 2.0), 0.0);
    assert_eq!(score(down, 1.3), 0.0);
    assert_ne!(score(down, 1.2), 0.0);
    assert_ne!(score(Mount::default(), 2.0), 0.0);
}

#[test]
fn scores_do_not_depend_on_threads_or_splits() {
    let (grid, model, laser) = (world(), LikelihoodField::new(OPTIONS).unwrap(), scanner(200, Mount::default()));
    let readings = vec![1.5; 200];
    let score = Score { model: &model, readings: Readings::One(&readings), beams: None, temper: 1.0 };
    let of = |poses: &[[f64; 3]], threads| {
        let mut scores = vec![0.0; poses.len()];
        model.log_likelihoods(&laser, &grid, poses, score, threads, &mut scores).unwrap();
        scores
    };
    let poses = poses(3);
    let all = of(&poses, Some(1));
    assert_eq!(all, of(&poses, Some(4)));
    assert_eq!(all, poses.chunks(7).flat_map(|poses| of(poses, None)).collect::<Vec<_>>());
}

#[test]
fn changed_cells_and_other_distances_change_the_field() {
    let mut grid = world();
    let near = |grid: &OccupancyGrid, max_distance: f64| {
        let mut distances = vec![0.0; SIDE * SIDE];
        grid.distances(max_distance, &mut distances).unwrap();
        distances
    };
    let before = near(&grid, 0.5);
    assert_eq!(before.iter().copied().fold(0.0, f32::max), 0.5);
    assert_eq!(near(&grid.try_clone().unwrap(), 0.5), before);
    assert!(near(&grid, 1.0).iter().copied().fold(0.0, f32::max) > 0.5);
    let free = before.iter().position(|&distance| distance > 0.3).unwrap();
    grid.set_cells(Cell { col: free % SIDE, row: free / SIDE }, 1, &[100]).unwrap();
    assert_eq!(near(&grid, 0.5)[free], 0.0);
}

#[test]
fn errors_name_the_bad_argument() {
    let (grid, laser) = (world(), scanner(5, Mount::default()));
    let error = |options| LikelihoodField::new(options).unwrap_err().to_string();
    assert_eq!(error(LikelihoodFieldOptions { sigma_hit: 0.0, ..OPTIONS }), "sigma_hit must be positive, got 0");
    assert_eq!(error(LikelihoodFieldOptions { z_rand: -0.5, ..OPTIONS }), "z_rand must be at least 0, got -0.5");
    assert_eq!(error(LikelihoodFieldOptions { z_hit: f64::NAN, ..OPTIONS }), "z_hit must be at least 0, got NaN");
    assert_eq!(error(LikelihoodFieldOptions { max_distance: 0.0, ..OPTIONS }), "max_distance must be positive, got 0");
    let none = LikelihoodFieldOptions { z_hit: 0.0, z_rand: 0.0, ..OPTIONS };
    assert_eq!(error(none), "z_hit + z_rand must be positive, got 0");
    let error = |options, readings, out: usize| {
        let model = LikelihoodField::new(options).unwrap();
        let score = Score { model: &model, readings: Readings::One(readings), beams: None, temper: 1.0 };
        model.log_likelihoods(&laser, &grid, &[[0.0; 3]], score, None, &mut vec![0.0; out]).unwrap_err().to_string()
    };
    let far = LikelihoodFieldOptions { max_distance: 26.0, ..OPTIONS };
    assert_eq!(error(far, &[1.0; 5], 1), "max_distance must be positive and at most 255 cells, got 26");
    assert_eq!(error(OPTIONS, &[1.0; 4], 1), "ranges must have 5 elements, got 4");
    assert_eq!(error(OPTIONS, &[1.0; 5], 2), "out must have 1 elements, got 2");
}
