//! `cargo bench --bench score [-- MAP...]`: the time to score a scan from many poses, relative to casting alone, in one run.
//!
//! A MAP is the name of a map in `workloads`. Without one, all named maps are used. Casting and scoring take turns. Figures
//! are medians of the turns, for 61 beams on two threads, with the fastest kernel.

mod workloads;

use std::time::Instant;

use mobile_robot_simulator::{BeamModel, BeamModelOptions, LikelihoodField, LikelihoodFieldOptions, Readings, Score};

use workloads::{kernels, laser, maps, poses};

const TURNS: usize = 7;

const POSES: usize = 1_000_000;

const BEAMS: usize = 61;

fn main() {
    let kernel = kernels().last().expect("a kernel");
    println!("seconds for {POSES} poses and {BEAMS} beams on 2 threads, and nanoseconds per beam and thread");
    println!("{:16}{:>16}{:>24}{:>24}{:>24}", "", "casting", "AMCL's model", "without short part", "likelihood field");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    for (map, grid) in maps().filter(|(map, _)| wanted.is_empty() || wanted.iter().any(|name| name == map)) {
        let laser = laser(&grid, kernel, BEAMS);
        let poses = poses(&grid, POSES);
        let mut readings = vec![0.0; BEAMS];
        laser.scan_batch(&grid, &poses[..1], None, None, &mut readings).expect("a scan");
        // The defaults of AMCL, and the same without short readings.
        let amcl = BeamModelOptions {
            sigma_hit: 0.2,
            lambda_short: 0.1,
            z_hit: 0.95,
            z_short: 0.1,
            z_max: 0.05,
            z_rand: 0.05,
            ..BeamModelOptions::default()
        };
        let models = [amcl, BeamModelOptions { z_short: 0.0, ..amcl }];
        let models = models.map(|options| BeamModel::new(options).expect("a model"));
        let (mut ranges, mut scores) = (vec![0.0; POSES * BEAMS], vec![0.0; POSES]);
        let field = LikelihoodField::new(LikelihoodFieldOptions::default()).expect("a model");
        let mut times = [const { Vec::new() }; 4];
        for _ in 0..TURNS {
            let start = Instant::now();
            laser.scan_batch(&grid, &poses, None, Some(2), &mut ranges).expect("scans");
            times[0].push(start.elapsed().as_secs_f64());
            for (model, times) in models.iter().zip(&mut times[1..3]) {
                let score = Score { model, readings: Readings::One(&readings), beams: None, temper: 1.0 };
                let start = Instant::now();
                laser.log_likelihoods(&grid, &poses, score, Some(2), &mut scores).expect("scores");
                times.push(start.elapsed().as_secs_f64());
            }
            let score = Score { model: &field, readings: Readings::One(&readings), beams: None, temper: 1.0 };
            let start = Instant::now();
            field.log_likelihoods(&laser, &grid, &poses, score, Some(2), &mut scores).expect("scores");
            times[3].push(start.elapsed().as_secs_f64());
        }
        let [casting, amcl, plain, field] = times.map(|mut times: Vec<f64>| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        let shown = |seconds: f64| format!("{seconds:.2} s {:.1} ns", 2e9 * seconds / (POSES * BEAMS) as f64);
        let ratio = |seconds: f64| format!("{} {:.2}x", shown(seconds), seconds / casting);
        println!("{map:16}{:>16}{:>24}{:>24}{:>24}", shown(casting), ratio(amcl), ratio(plain), ratio(field));
    }
}
