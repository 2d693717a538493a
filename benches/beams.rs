//! `cargo bench --bench beams [-- MAP...]`: how the time of a scan grows with its number of beams.
//!
//! Scans have a field of 270° and a maximum range of 600 cells. For each kernel and number of beams: microseconds for a scan, and how
//! many times the time of 541 beams that is. Numbers of beams take turns; figures are medians of the turns, on one thread.

mod workloads;

use std::time::Instant;

use workloads::{kernels, laser, maps, poses};

const TURNS: usize = 9;

const SCANS: usize = 200;

const BEAMS: [usize; 5] = [541, 1081, 2161, 4096, 8401];

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    print!("{:24}", "microseconds per scan");
    for count in BEAMS {
        print!("{count:>16}");
    }
    println!();
    for (map, grid) in maps().filter(|(map, _)| wanted.is_empty() || wanted.iter().any(|name| name == map)) {
        let poses = poses(&grid, SCANS);
        for kernel in kernels() {
            let lasers = BEAMS.map(|beam_count| laser(&grid, kernel, beam_count));
            let mut ranges = vec![0.0; SCANS * BEAMS[BEAMS.len() - 1]];
            let mut times = BEAMS.map(|_| Vec::new());
            for _ in 0..TURNS {
                for ((laser, beam_count), times) in lasers.iter().zip(BEAMS).zip(&mut times) {
                    let start = Instant::now();
                    laser.scan_batch(&grid, &poses, None, Some(1), &mut ranges[..SCANS * beam_count]).expect("scans");
                    times.push(start.elapsed().as_secs_f64() * 1e6 / SCANS as f64);
                }
            }
            print!("{:24}", format!("{} {map}", kernel.name()));
            let medians = times.map(|mut times| {
                times.sort_by(f64::total_cmp);
                times[TURNS / 2]
            });
            for time in medians {
                print!("{:>16}", format!("{time:.1} {:.2}x", time / medians[0]));
            }
            println!();
        }
    }
}
