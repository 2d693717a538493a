//! Sampled readings compared with the distribution function of the beam model (Thrun, Burgard & Fox 2006, sec. 6.3).

use mobile_robot_simulator::{BeamModel, BeamModelOptions};

const SEED: u64 = 31;

const MAX_RANGE: f64 = 30.0;

const BEAMS: usize = 1000;

const SCANS: u64 = 300;

/// Each part of the model alone, then mixtures of them, the default model last.
fn models() -> Vec<(&'static str, BeamModelOptions)> {
    let weights = |z_hit, z_short, z_max, z_rand| BeamModelOptions {
        sigma_hit: 0.2,
        lambda_short: 0.5,
        z_hit,
        z_short,
        z_max,
        z_rand,
    };
    vec![
        ("hit", weights(1.0, 0.0, 0.0, 0.0)),
        ("short", weights(0.0, 1.0, 0.0, 0.0)),
        ("max", weights(0.0, 0.0, 1.0, 0.0)),
        ("random", weights(0.0, 0.0, 0.0, 1.0)),
        ("mixture", weights(0.7, 0.1, 0.1, 0.1)),
        ("wide", BeamModelOptions { sigma_hit: 12.0, ..weights(0.7, 0.1, 0.1, 0.1) }),
        ("very wide", BeamModelOptions { sigma_hit: 50.0, ..weights(0.7, 0.1, 0.1, 0.1) }),
        ("narrow", BeamModelOptions { sigma_hit: 1e-4, ..weights(0.999, 0.0, 0.0, 0.001) }),
        ("default", BeamModelOptions::default()),
    ]
}

fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// Returns the probability of a reading of at most `z`, for `z` below the maximum range.
fn cdf(model: &BeamModelOptions, range: f64, z: f64) -> f64 {
    let below = |z: f64| normal_cdf((z - range) / model.sigma_hit);
    let hit = if range < MAX_RANGE { (below(z) - below(0.0)) / (below(MAX_RANGE) - below(0.0)) } else { 0.0 };
    let exponential_cdf = |z: f64| -libm::expm1(-model.lambda_short * z);
    let short = if range == 0.0 { 1.0 } else { exponential_cdf(z.min(range)) / exponential_cdf(range) };
    model.z_hit * hit + model.z_short * short + model.z_rand * z / MAX_RANGE
}

/// Returns sorted readings of beams with this true range.
fn readings(model: BeamModelOptions, range: f64) -> Vec<f64> {
    let model = BeamModel::new(model).expect("a good model");
    let ranges = vec![if range < MAX_RANGE { range } else { f64::INFINITY }; BEAMS];
    let mut readings = vec![0.0; BEAMS * SCANS as usize];
    for (index, readings) in (0..).zip(readings.chunks_mut(BEAMS)) {
        model.sample(&ranges, MAX_RANGE, (SEED, index), readings);
    }
    readings.sort_by(f64::total_cmp);
    readings
}

/// Kolmogorov-Smirnov test, with a significance level of about 1e-5 for each model and range.
#[test]
fn readings_follow_the_distribution() {
    for (name, options) in models() {
        for range in [0.0, 0.05, 5.0, 29.9, MAX_RANGE] {
            let readings = readings(options, range);
            let count = readings.len() as f64;
            let mut off: f64 = 0.0;
            for (index, &reading) in readings.iter().enumerate().filter(|(_, reading)| **reading < MAX_RANGE) {
                let expected = cdf(&options, range, reading);
                off = off.max((expected - index as f64 / count).abs()).max((expected - (index + 1) as f64 / count).abs());
            }
            let at_max = readings.iter().filter(|reading| **reading == MAX_RANGE).count() as f64 / count;
            let expected = options.z_max + if range < MAX_RANGE { 0.0 } else { options.z_hit };
            let bound = 2.5 / count.sqrt();
            // At a true range of 0 all short readings are 0: a point mass, at which the empirical distribution jumps.
            let point_mass = if range == 0.0 { options.z_short } else { 0.0 };
            assert!(off < bound + point_mass, "{name} at {range}: off by {off}, bound {bound}");
            assert!(
                (at_max - expected).abs() < bound,
                "{name} at {range}: {at_max} of the readings are max_range, not {expected}"
            );
        }
    }
}

/// For a true range of 5 m, numerical integration gives E[short] = 1.552873 and E[mixture] = 8.155287.
#[test]
fn means_agree_with_numerical_integration() {
    let mean = |name: &str| {
        let options = models().into_iter().find(|model| model.0 == name).expect("a model of that name").1;
        let readings = readings(options, 5.0);
        readings.iter().sum::<f64>() / readings.len() as f64
    };
    assert!((mean("short") - 1.552_873).abs() < 0.012, "{}", mean("short"));
    assert!((mean("mixture") - 8.155_287).abs() < 0.06, "{}", mean("mixture"));
}

/// Neighbouring beams, the two beams of a pair of normal numbers (16 apart), and successive scans are independent.
#[test]
fn readings_are_not_correlated() {
    let options = BeamModelOptions { z_hit: 1.0, z_max: 0.0, ..BeamModelOptions::default() };
    let model = BeamModel::new(options).expect("a good model");
    let scan = |index| {
        let mut readings = vec![0.0; BEAMS];
        model.sample(&[5.0; BEAMS], MAX_RANGE, (SEED, index), &mut readings);
        readings.iter().map(|reading| (reading - 5.0) / options.sigma_hit).collect::<Vec<f64>>()
    };
    let scans: Vec<_> = (0..SCANS).map(scan).collect();
    let products = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let count = (BEAMS as f64 * SCANS as f64).sqrt();
    let apart = |beams: usize| scans.iter().map(|scan| products(scan, &scan[beams..])).sum::<f64>();
    let successive: f64 = scans.windows(2).map(|pair| products(&pair[0], &pair[1])).sum();
    let squares: f64 = scans.iter().map(|scan| products(scan, scan) / BEAMS as f64 - 1.0).sum::<f64>() / SCANS as f64;
    for sum in [apart(1), apart(16), successive] {
        assert!(sum.abs() < 4.5 * count, "{sum}");
    }
    assert!(squares.abs() < 4.5 * 2f64.sqrt() / count, "{squares}");
}

/// The readings of each sample, marked as in a message, against the density and the probabilities.
#[test]
fn likelihoods_are_those_of_the_readings() {
    const MIN_RANGE: f64 = 0.04;
    for (name, options) in models() {
        let model = BeamModel::new(options).expect("a good model");
        for range in [0.0, 0.05, 5.0, 29.9, MAX_RANGE] {
            let hit = (range < MAX_RANGE).then_some(range);
            let readings = readings(options, range);
            let count = readings.len() as f64;
            for min_range in [0.0, MIN_RANGE] {
                let limits = (min_range, MAX_RANGE);
                let likelihood = |reading| model.likelihood(reading, hit, limits);
                let share =
                    |test: &dyn Fn(f64) -> bool| readings.iter().filter(|&&reading| test(reading)).count() as f64 / count;
                let masses = [
                    (likelihood(f64::INFINITY), share(&|reading| reading >= MAX_RANGE)),
                    (likelihood(f64::NEG_INFINITY), share(&|reading| reading < min_range)),
                ];
                for (expected, found) in masses {
                    assert!((expected - found).abs() < 2.5 / count.sqrt(), "{name} at {range}: {found}, not {expected}");
                }
                let at_zero = if range == 0.0 && min_range == 0.0 { options.z_short } else { 0.0 };
                assert!(at_zero == 0.0 || likelihood(0.0) == at_zero);
                // The density jumps at the true range, and is narrow around it.
                let width = 12.0 * options.sigma_hit;
                let mut edges =
                    [min_range, range - width, range, range + width, MAX_RANGE].map(|edge| edge.clamp(min_range, MAX_RANGE));
                edges.sort_by(f64::total_cmp);
                let steps = 20_000;
                let integral: f64 = edges
                    .windows(2)
                    .map(|edge| {
                        let step = (edge[1] - edge[0]) / f64::from(steps);
                        (0..steps).map(|index| likelihood(edge[0] + (f64::from(index) + 0.5) * step)).sum::<f64>() * step
                    })
                    .sum();
                let total = integral + at_zero + masses.iter().map(|(mass, _)| mass).sum::<f64>();
                assert!((total - 1.0).abs() < 1e-5, "{name} at {range} from {min_range}: the total is {total}");
            }
            assert_eq!(model.likelihood(f64::NAN, hit, (0.0, MAX_RANGE)), 1.0);
        }
    }
}
