//! Rays over whole maps: those in `tests/maps`, and real ones, which are not part of the project and are optional.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec2;
use rand::{Rng, RngExt};

use super::methods::{Start, check_all, toward, unit_grid};
use crate::random;

/// Maps of the repository.
const CARRIED: [&str; 3] = ["office/map.png", "cave_turned/map.png", "corridor_shades/map.png"];

/// Real maps in the optional folder `../shared/maps`.
const REAL: [&str; 8] = [
    "f1_berlin/berlin.png",
    "flatland_conestogo/map.png",
    "nav2_depot/depot.pgm",
    "nav2_tb3_sandbox/tb3_sandbox.pgm",
    "nav2_warehouse/warehouse.pgm",
    "radish_intel/intel.pgm",
    "rl_basement_hallways_5cm/basement_hallways_5cm.png",
    "willow_2010_0.10/willow-2010-02-18-0.10.pgm",
];

#[test]
fn every_kernel_agrees_with_the_traversal_on_carried_maps() {
    check_maps(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/maps"), &CARRIED);
}

#[test]
fn every_kernel_agrees_with_the_traversal_on_real_maps() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/maps");
    if folder.is_dir() {
        check_maps(&folder, &REAL);
    } else {
        eprintln!("skipped: no real maps in {}", folder.display());
    }
}

fn check_maps(folder: &Path, images: &[&str]) {
    for image in images {
        let pixels = image::open(folder.join(image)).expect(image).into_luma8();
        let (width, height) = (pixels.width() as usize, pixels.height() as usize);
        let dark: Vec<bool> = pixels.pixels().map(|pixel| pixel.0[0] < 90).collect();
        let blocking: Vec<bool> = dark.chunks(width).rev().flatten().copied().collect();
        assert!(blocking.iter().any(|&blocks| blocks), "{image} has no walls");
        let grid = unit_grid(&blocking, width);
        let mut stream = random::stream(5, 0);
        for _ in 0..300 {
            let origin = DVec2::new(stream.random::<f64>() * width as f64, stream.random::<f64>() * height as f64);
            let origin = if stream.next_u64().is_multiple_of(8) { origin.floor() } else { origin };
            let starts: Vec<Start> = (0..180).map(|beam| (origin, toward(f64::from(beam) * PI / 90.0))).collect();
            check_all(&grid, &starts);
        }
    }
}
