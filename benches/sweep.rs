//! `cargo bench --bench sweep [-- MAP...]`: the time of scans that take time, relative to scans in one instant, in one run.
//!
//! A MAP is the name of a map in `workloads`, or the image of a map with cells of 5 cm. Without one, all named maps are used.
//! The ways to scan take turns. Figures are medians of the turns, with 541 beams, on one thread, with the fastest kernel.

mod workloads;

use std::path::Path;
use std::time::Instant;

use mobile_robot_simulator::raycast::Kernel;
use mobile_robot_simulator::{Course, Courses, MovingObstacle, Obstacles, OccupancyGrid, Pose, Shape, Sweeps, Twist, World};

use workloads::{kernels, laser, maps, poses, read};

const TURNS: usize = 15;

const SCANS: usize = 1000;

/// Time of a scan \[s\], of a head that turns at 10 Hz and measures over three quarters of a turn.
const DURATION: f64 = 0.075;

/// Writes the ranges of all scans.
type Way<'a> = &'a dyn Fn(&mut [f32]);

fn main() {
    let kernel = kernels().last().expect("a kernel");
    println!("nanoseconds per range with {}", kernel.name());
    println!("{:22}{:>10}{:>16}{:>16}{:>16}{:>16}", "", "instant", "straight", "turning", "10 obstacles", "10 that move");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let (images, names): (Vec<_>, Vec<_>) = wanted.iter().map(Path::new).partition(|map| map.extension().is_some());
    for image in &images {
        let grid = read(image, 0.05).unwrap_or_else(|error| panic!("{}: {error}", image.display()));
        measure(&image.file_stem().unwrap_or_default().to_string_lossy(), &grid, kernel);
    }
    for (map, grid) in maps().filter(|(map, _)| wanted.is_empty() || names.contains(&Path::new(map))) {
        measure(map, &grid, kernel);
    }
}

/// Returns ten obstacles in a ring around a pose, half of them boxes, and how they move.
fn crowd(around: Pose) -> Vec<(Shape, Pose, Twist)> {
    let shape =
        |nth: u32| if nth.is_multiple_of(2) { Shape::rectangle(0.6, 0.4) } else { Shape::disc(0.3) }.expect("a shape");
    let pose = |nth: u32| around * Pose::new(0.0, 0.0, f64::from(nth) * 0.5) * Pose::new(1.0, 0.0, 0.4);
    (0..10).map(|nth| (shape(nth), pose(nth), Twist::from([1.0, 0.0, 0.5]))).collect()
}

/// Measures all ways to scan on a map and prints a line.
fn measure(map: &str, grid: &OccupancyGrid, kernel: Kernel) {
    let (laser, poses) = (laser(grid, kernel, 541), poses(grid, SCANS));
    let twists = |turn: f64| vec![[0.7, 0.0, turn]; SCANS];
    let (straight, turning) = (twists(0.0), twists(1.5));
    // Each obstacle is in view of the robot that it stands around, so each robot gets a batch of its own.
    let crowds: Vec<_> = poses.iter().map(|&pose| crowd(pose.into())).collect();
    let around = |crowd: &[(Shape, Pose, Twist)]| {
        Obstacles::new(crowd.iter().map(|(shape, pose, _)| (shape, *pose))).expect("obstacles")
    };
    let standing: Vec<_> = crowds.iter().map(|crowd| around(crowd)).collect();
    let moving: Vec<Vec<_>> = crowds
        .iter()
        .map(|crowd| {
            let course = |start, twist| Course::Arc { start, twist };
            crowd.iter().map(|(shape, pose, twist)| MovingObstacle { shape, course: course(*pose, *twist) }).collect()
        })
        .collect();
    let plain = |world: World<'_>, poses: &[[f64; 3]], ranges: &mut [f32]| {
        laser.scan_batch(world, poses, None, Some(1), ranges).expect("scans");
    };
    let sweep = |poses: &[[f64; 3]], twists: &[[f64; 3]], obstacles: &[MovingObstacle<'_>], ranges: &mut [f32]| {
        let sweeps = Sweeps { courses: Courses::Arcs { poses, twists }, scan_duration: DURATION, obstacles };
        laser.sweep_batch(grid, sweeps, None, Some(1), ranges).expect("scans");
    };
    let ways: [Way<'_>; 5] = [
        &|ranges| plain(grid.into(), &poses, ranges),
        &|ranges| sweep(&poses, &straight, &[], ranges),
        &|ranges| sweep(&poses, &turning, &[], ranges),
        &|ranges| {
            for ((poses, ranges), obstacles) in poses.chunks(1).zip(ranges.chunks_mut(541)).zip(&standing) {
                plain((grid, obstacles).into(), poses, ranges);
            }
        },
        &|ranges| {
            for (scan, (obstacles, ranges)) in moving.iter().zip(ranges.chunks_mut(541)).enumerate() {
                sweep(&poses[scan..=scan], &turning[scan..=scan], obstacles, ranges);
            }
        },
    ];
    let mut ranges = vec![0.0; SCANS * 541];
    let mut times = ways.map(|_| Vec::new());
    for _ in 0..TURNS {
        for (way, times) in ways.iter().zip(&mut times) {
            let start = Instant::now();
            way(&mut ranges);
            times.push(start.elapsed().as_secs_f64());
        }
    }
    let medians = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2] * 1e9 / (SCANS * 541) as f64
    });
    print!("{map:22}{:>10.2}", medians[0]);
    for (way, base) in [(1, 0), (2, 0), (3, 0), (4, 3)] {
        print!("{:>16}", format!("{:.2} {:.2}x", medians[way], medians[way] / medians[base]));
    }
    println!();
}
