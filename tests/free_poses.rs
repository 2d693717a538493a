//! Random free poses: uniform over the points at which a disc is free, the same for any split.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use mobile_robot_simulator::{Cell, Error, GridOptions, OccupancyGrid, Pose, Unknown, random};
use rand::RngExt;

const SEED: u64 = 60;

const OPTIONS: GridOptions =
    GridOptions { resolution: 0.5, origin: Pose::new(1.0, 2.0, 0.4), occupied_threshold: 60, unknown: Unknown::Free };

fn grid(cells: &[i8], width: usize, options: GridOptions) -> OccupancyGrid {
    OccupancyGrid::new(cells.to_vec(), width, options).expect("a good grid")
}

/// A grid of 24 by 20 cells: walls in a twelfth of them and unknown cells in another twelfth.
fn cluttered(options: GridOptions) -> OccupancyGrid {
    let mut stream = random::stream(SEED, 1);
    let cells: Vec<i8> = (0..480).map(|_| [100, -1, 0][stream.random_range(0..12_usize).min(2)]).collect();
    grid(&cells, 24, options)
}

fn draw(grid: &OccupancyGrid, count: usize, radius: f64) -> Vec<[f64; 3]> {
    let mut poses = vec![[0.0; 3]; count];
    grid.draw_free_poses(radius, SEED, 0, None, &mut poses).expect("free places");
    poses
}

fn in_cells(grid: &OccupancyGrid, [x, y, _]: [f64; 3]) -> DVec2 {
    grid.to_cells(DVec2::new(x, y))
}

fn is_known_free(grid: &OccupancyGrid, position: DVec2) -> bool {
    let value = |cell: Cell| grid.cells()[cell.row * grid.width() + cell.col];
    grid.cell_at(position).is_some_and(|cell| value(cell) >= 0 && !grid.is_blocking(cell))
}

/// Fails if counts differ from what is expected by more than 5 standard deviations of Pearson's chi-square statistic.
fn assert_fits(counts: &[f64], expected: &[f64], what: &str) {
    let pairs = || counts.iter().zip(expected).filter(|&(_, &expected)| expected >= 5.0);
    let statistic: f64 = pairs().map(|(count, expected)| (count - expected).powi(2) / expected).sum();
    let freedom = pairs().count() as f64 - 1.0;
    assert!((statistic - freedom).abs() < 5.0 * (2.0 * freedom).sqrt(), "{what}: {statistic} for {freedom} bins");
}

/// Counts points in bins of a cell's `bins`-th part; the bins of the grid's rows follow each other.
fn histogram(grid: &OccupancyGrid, points: impl Iterator<Item = DVec2>, bins: f64) -> Vec<f64> {
    let width = (grid.width() as f64 * bins) as usize;
    let mut counts = vec![0.0; width * (grid.height() as f64 * bins) as usize];
    for point in points {
        let bin = (point * bins).floor();
        counts[bin.y as usize * width + bin.x as usize] += 1.0;
    }
    counts
}

/// Expected counts per bin, by a regular lattice of points that `is_free_disc` tests.
fn expected(grid: &OccupancyGrid, radius: f64, bins: f64, count: usize) -> Vec<f64> {
    const PER_BIN: f64 = 20.0;
    let steps = bins * PER_BIN;
    let (width, height) = ((grid.width() as f64 * steps) as usize, (grid.height() as f64 * steps) as usize);
    let points = (0..width * height).map(|index| DVec2::new((index % width) as f64, (index / width) as f64));
    let free = points.map(|point| (point + 0.5) / steps).filter(|&at| {
        let position = grid.options().origin.transform_point(at * grid.resolution());
        is_known_free(grid, position) && grid.is_free_disc(position, radius).expect("a disc")
    });
    let counts = histogram(grid, free, bins);
    let all: f64 = counts.iter().sum();
    counts.into_iter().map(|inside| inside * count as f64 / all).collect()
}

#[test]
fn positions_are_uniform_over_the_free_area() {
    let grid = cluttered(OPTIONS);
    // From the point itself to a disc that fits into few places; bins of a cell and of a quarter of one.
    for (radius, bins) in [(0.0, 1.0), (0.0, 4.0), (0.1, 4.0), (0.25, 4.0), (0.55, 4.0), (0.75, 8.0)] {
        let poses = draw(&grid, 200_000, radius);
        let counts = histogram(&grid, poses.iter().map(|&pose| in_cells(&grid, pose)), bins);
        let expected = expected(&grid, radius, bins, poses.len());
        let bins = expected.iter().filter(|&&expected| expected >= 5.0).count();
        assert!(bins > 40, "{radius}: {bins}");
        assert_fits(&counts, &expected, &format!("radius {radius}"));
    }
}

#[test]
fn positions_are_uniform_within_a_cell() {
    let grid = grid(&[0; 6], 3, OPTIONS);
    let poses = draw(&grid, 200_000, 0.0);
    let mut counts = vec![0.0; 400];
    for within in poses.iter().map(|&pose| in_cells(&grid, pose)) {
        let bin = (20.0 * (within - within.floor())).floor();
        counts[(bin.y * 20.0 + bin.x) as usize] += 1.0;
    }
    assert_fits(&counts, &[500.0; 400], "bins of a cell");
}

#[test]
fn yaws_are_uniform_and_independent_of_positions() {
    let grid = grid(&[0; 4], 4, OPTIONS);
    let poses = draw(&grid, 160_000, 0.0);
    let mut counts = vec![0.0; 160];
    for &pose in &poses {
        assert!((-PI..PI).contains(&pose[2]));
        let bin = ((pose[2] + PI) / TAU * 40.0) as usize;
        counts[in_cells(&grid, pose).x as usize * 40 + bin] += 1.0;
    }
    assert_fits(&counts, &[1000.0; 160], "yaws");
    // Nor do successive poses depend on each other.
    let mut counts = vec![0.0; 16];
    for pair in poses.chunks_exact(2) {
        let [first, second] = [pair[0], pair[1]].map(|pose| in_cells(&grid, pose).x as usize);
        counts[first * 4 + second] += 1.0;
    }
    assert_fits(&counts, &[5000.0; 16], "pairs");
}

#[test]
fn every_position_is_free_on_any_grid() {
    let far = Pose::new(-4e6, 3e7, 1.3);
    for options in [OPTIONS, GridOptions { origin: far, ..OPTIONS }, GridOptions { unknown: Unknown::Occupied, ..OPTIONS }] {
        let grid = cluttered(options);
        for radius in [0.0, 1e-6, 0.2, 0.25, 0.5] {
            for [x, y, _] in draw(&grid, 20_000, radius) {
                let position = DVec2::new(x, y);
                assert!(is_known_free(&grid, position), "{radius}: {position}");
                assert_eq!(grid.is_free_disc(position, radius), Ok(true), "{radius}: {position}");
            }
        }
    }
}

#[test]
fn any_split_and_any_number_of_threads_gives_the_same_poses() {
    let grid = cluttered(OPTIONS);
    let whole = draw(&grid, 10_000, 0.3);
    for threads in [1, 2, 7] {
        let mut poses = vec![[0.0; 3]; 10_000];
        grid.draw_free_poses(0.3, SEED, 0, Some(threads), &mut poses).expect("free places");
        assert_eq!(poses, whole);
    }
    let fresh = cluttered(OPTIONS);
    for (start, end) in [(9_000, 10_000), (17, 18), (0, 17), (18, 9_000)] {
        let mut poses = vec![[0.0; 3]; end - start];
        fresh.draw_free_poses(0.3, SEED, start as u64, None, &mut poses).expect("free places");
        assert_eq!(poses, whole[start..end]);
        // Another radius in between does not matter.
        draw(&fresh, 3, 0.1);
    }
    assert_eq!(grid.draw_free_pose(0.3, SEED), Ok(Pose::from(whole[0])));
    assert_eq!(grid.draw_free_poses(0.3, SEED, u64::MAX, None, &mut [[0.0; 3]; 2]), Ok(()));
}

#[test]
fn the_poses_of_a_seed_never_change() {
    let mut poses = [[0.0; 3]; 2];
    cluttered(OPTIONS).draw_free_poses(0.3, SEED, 0, None, &mut poses).expect("free places");
    let rounded = poses.map(|pose| pose.map(|number| (number * 1e9).round() / 1e9));
    let expected = [[1.376_425_28, 10.044_839_357, -1.258_087_212], [4.014_756_497, 8.709_445_737, 2.770_972_524]];
    assert_eq!(rounded, expected);
}

/// A corridor of 4 m, with walls of one cell on both sides.
fn corridor() -> OccupancyGrid {
    let cells: Vec<i8> = (0..600).map(|index| if [0, 9].contains(&(index / 60)) { 100 } else { 0 }).collect();
    grid(&cells, 60, GridOptions { origin: Pose::default(), ..OPTIONS })
}

#[test]
fn a_narrow_free_area_is_found() {
    // The walls are at y = 0.5 m and y = 4.5 m: the centre of the disc can be 2 mm beside y = 2.5 m at most.
    let poses = draw(&corridor(), 20_000, 1.998);
    let mut counts = vec![0.0; 10];
    for [_, y, _] in poses {
        counts[((y - 2.5 + 2e-3) * 2500.0).floor() as usize] += 1.0;
    }
    assert_fits(&counts, &[2000.0; 10], "a strip");
}

#[test]
fn without_a_free_area_the_error_names_the_largest_disc() {
    let error = |grid: &OccupancyGrid, radius| grid.draw_free_pose(radius, 1).unwrap_err();
    // A disc of 2 m fits between the walls on a line, which has no area.
    for radius in [2.0, 2.1, 50.0] {
        let Error::NoFreePlace { largest: Some(largest), .. } = error(&corridor(), radius) else { panic!("{radius}") };
        assert!((1.99..2.0).contains(&largest), "{largest}");
        assert!(corridor().draw_free_pose(largest, 1).is_ok());
    }
    for seed in 2..30 {
        let mut stream = random::stream(SEED, seed);
        let cells: Vec<i8> = (0..900).map(|_| if stream.random::<f64>() < 0.01 * seed as f64 { 100 } else { 0 }).collect();
        let grid = grid(&cells, 30, OPTIONS);
        let Error::NoFreePlace { largest: Some(largest), .. } = error(&grid, 50.0) else { panic!("{seed}") };
        assert!(grid.draw_free_pose(largest, 1).is_ok(), "{seed}: {largest}");
        // The search may miss the largest one by a hundredth of a cell.
        assert!(grid.draw_free_pose(largest + 0.006, 1).is_err(), "{seed}: {largest}");
    }
    assert_eq!(error(&grid(&[100, -1], 2, OPTIONS), 0.1), Error::NoFreePlace { radius: 0.1, largest: None });
    assert_eq!(
        error(&grid(&[100, -1], 2, OPTIONS), 0.1).to_string(),
        "no known free place for a disc of radius 0.1 m on this grid, where no cell is known to be free"
    );
    let message = error(&grid(&[100, 0, 100], 3, GridOptions { resolution: 1.0, ..OPTIONS }), 50.0).to_string();
    let start =
        "no known free place for a disc of radius 50 m on this grid, where the largest that fits has a radius of 0.49";
    assert!(message.starts_with(start), "{message}");
    assert_eq!(error(&corridor(), -1.0).to_string(), "radius must be at least 0, got -1");
    assert!(matches!(error(&corridor(), f64::NAN), Error::Number { .. }));
    // Without blocking cells every disc fits.
    assert!(grid(&[0; 4], 2, OPTIONS).draw_free_pose(1e9, 1).is_ok());
}

#[test]
fn changed_cells_change_the_free_area() {
    let mut grid = grid(&[0; 100], 10, GridOptions { origin: Pose::default(), ..OPTIONS });
    draw(&grid, 10, 0.2);
    let unchanged = grid.try_clone().expect("enough memory");
    grid.set_cells(Cell { col: 0, row: 0 }, 8, &[100; 80]).expect("cells of the grid");
    assert!(draw(&grid, 10_000, 0.2).iter().all(|&[x, ..]| x > 4.2));
    assert!(draw(&unchanged, 10_000, 0.2).iter().any(|&[x, ..]| x < 4.0));
}
