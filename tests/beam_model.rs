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
        ..BeamModelOptions::default()
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
        ("offset", BeamModelOptions { range_offset: 0.3, ..weights(0.7, 0.1, 0.1, 0.1) }),
        ("negative offset", BeamModelOptions { range_offset: -0.3, ..weights(0.9, 0.1, 0.0, 0.0) }),
        ("by range", BeamModelOptions { range_sigma_base: 0.1, range_sigma_per_metre: 0.05, ..weights(1.0, 0.0, 0.0, 0.0) }),
        (
            "very wide by range, behind",
            BeamModelOptions { range_offset: 1.0, range_sigma_per_metre: 5.0, ..weights(0.7, 0.1, 0.1, 0.1) },
        ),
        ("default", BeamModelOptions::default()),
    ]
}

fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// Returns the center of the hit part, and its σ.
fn hit_part(model: &BeamModelOptions, range: f64) -> (f64, f64) {
    let sigma = model.sigma_hit.max(model.range_sigma_base + model.range_sigma_per_metre * range);
    ((range + model.range_offset).clamp(0.0, MAX_RANGE), sigma)
}

/// Returns the probability of a reading of at most `z` before it is rounded, for `z` below the maximum range.
fn cdf(model: &BeamModelOptions, range: f64, z: f64) -> f64 {
    let (center, sigma) = hit_part(model, range);
    let below = |z: f64| normal_cdf((z - center) / sigma);
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
                let (center, sigma) = hit_part(&options, range);
                let width = 12.0 * sigma;
                let mut edges = [min_range, center - width, center, center + width, range, MAX_RANGE]
                    .map(|edge| edge.clamp(min_range, MAX_RANGE));
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

/// Returns all multiples that a reading is rounded to, each with the end of the readings that are rounded to it or less.
fn multiples(model: &BeamModelOptions) -> Vec<(f64, f64)> {
    // The step at a reading, doubled one by one.
    let step_at = |reading: f64| {
        let share = if model.range_step_share > 0.0 { (1.0 / model.range_step_share).ceil() } else { f64::INFINITY };
        let mut step = if model.range_step > 0.0 { model.range_step } else { (0.5_f64).powi(40) };
        while reading >= 2.0 * share * step * (1.0 - 1e-12) {
            step *= 2.0;
        }
        step
    };
    let mut found = vec![];
    let mut multiple = 0.0;
    while multiple < MAX_RANGE * (1.0 - 1e-7) {
        let step = step_at(multiple);
        found.push((multiple, multiple + 0.5 * step));
        multiple += step;
    }
    found.last_mut().expect("a multiple").1 = MAX_RANGE;
    found
}

fn rounded_models() -> Vec<(&'static str, BeamModelOptions)> {
    let all = BeamModelOptions { z_hit: 0.7, z_short: 0.1, z_max: 0.1, z_rand: 0.1, ..BeamModelOptions::default() };
    let hits = BeamModelOptions { z_hit: 1.0, z_max: 0.0, sigma_hit: 0.05, ..BeamModelOptions::default() };
    vec![
        ("fine", BeamModelOptions { range_step: 0.01, ..hits }),
        ("coarse", BeamModelOptions { range_step: 0.25, ..hits }),
        ("coarse, all parts", BeamModelOptions { range_step: 0.25, ..all }),
        ("1 %", BeamModelOptions { range_step: 0.001, range_step_share: 0.01, ..all }),
        ("1 % of wide hits", BeamModelOptions { range_step: 0.001, range_step_share: 0.01, sigma_hit: 0.5, ..all }),
        ("3 %, by range", BeamModelOptions { range_step: 0.07, range_step_share: 0.03, range_sigma_per_metre: 0.01, ..all }),
        ("not in the range", BeamModelOptions { range_step: 0.07, range_offset: 0.1, ..all }),
    ]
}

/// Kolmogorov-Smirnov test at the multiples, with a significance level of about 1e-5 for each model and range.
#[test]
fn rounded_readings_follow_the_distribution() {
    for (name, options) in rounded_models() {
        let multiples = multiples(&options);
        for range in [0.0, 0.05, 5.0, 6.2, 29.9, MAX_RANGE] {
            let readings = readings(options, range);
            let count = readings.len() as f64;
            let is_multiple = |reading: f64| {
                let next = multiples.partition_point(|(multiple, _)| *multiple < reading - 1e-9);
                next < multiples.len() && (multiples[next].0 - reading).abs() < 1e-9
            };
            assert!(readings.iter().all(|&reading| reading == MAX_RANGE || is_multiple(reading)), "{name} at {range}");
            for &(multiple, end) in &multiples {
                let found = readings.partition_point(|&reading| reading <= multiple + 1e-9) as f64 / count;
                let at_max = options.z_max + if range < MAX_RANGE { 0.0 } else { options.z_hit };
                let expected = if end < MAX_RANGE { cdf(&options, range, end) } else { 1.0 - at_max };
                assert!(
                    (found - expected).abs() < 2.5 / count.sqrt(),
                    "{name} at {range}: {found} below {end}, not {expected}"
                );
            }
        }
    }
}

/// The likelihood is the mass of each multiple, over the width of the readings that become it.
#[test]
fn likelihoods_of_rounded_readings_sum_to_1() {
    for (name, options) in rounded_models() {
        let model = BeamModel::new(options).expect("a good model");
        let multiples = multiples(&options);
        for range in [0.0, 0.05, 5.0, 6.2, 29.9, MAX_RANGE] {
            let hit = (range < MAX_RANGE).then_some(range);
            let mut start = 0.0;
            for &(multiple, end) in &multiples {
                let reading = f64::from(multiple as f32);
                let mass = model.likelihood(reading, hit, (0.0, MAX_RANGE)) * (end - start);
                let at_max = options.z_max + if range < MAX_RANGE { 0.0 } else { options.z_hit };
                let below = |z: f64| if z < MAX_RANGE { cdf(&options, range, z) } else { 1.0 - at_max };
                let before = if start > 0.0 { below(start) } else { 0.0 };
                assert!((mass - (below(end) - before)).abs() < 1e-9, "{name} at {range}: {mass} at {multiple}");
                // The readings below a minimum range at this multiple.
                let limits = (reading, MAX_RANGE);
                let below_min = model.likelihood(f64::NEG_INFINITY, hit, limits);
                assert!((below_min - before).abs() < 1e-9, "{name} at {range}: {below_min} below {multiple}");
                start = end;
            }
        }
    }
}

/// An unlikely reading has a small likelihood, not 0 by cancellation.
#[test]
fn tails_of_rounded_readings_have_a_likelihood() {
    let options = BeamModelOptions { z_hit: 1.0, z_max: 0.0, sigma_hit: 0.1, ..BeamModelOptions::default() };
    let smooth = BeamModel::new(options).expect("a good model");
    let rounded = BeamModel::new(BeamModelOptions { range_step: 1e-4, ..options }).expect("a good model");
    for reading in [3.5, 4.2, 5.0, 5.7, 6.5] {
        let [smooth, rounded] = [smooth, rounded].map(|model| model.likelihood(reading, Some(5.0), (0.0, MAX_RANGE)));
        assert!((rounded / smooth - 1.0).abs() < 1e-4, "{rounded} {smooth}");
    }
}

#[test]
fn numbers_that_depend_on_the_range_are_checked() {
    let error = |options: BeamModelOptions| BeamModel::new(options).expect_err("a bad model").to_string();
    let default = BeamModelOptions::default();
    let text = error(BeamModelOptions { range_offset: f64::NAN, ..default });
    assert_eq!(text, "range_offset must be finite, got NaN");
    let text = error(BeamModelOptions { range_sigma_base: -0.1, ..default });
    assert_eq!(text, "range_sigma_base must be at least 0, got -0.1");
    let text = error(BeamModelOptions { range_sigma_per_metre: f64::INFINITY, ..default });
    assert!(text.starts_with("range_sigma_per_metre must be"), "{text}");
    let text = error(BeamModelOptions { range_step: -1.0, ..default });
    assert_eq!(text, "range_step must be at least 0, got -1");
    let text = error(BeamModelOptions { range_step_share: 0.6, ..default });
    assert_eq!(text, "range_step_share must be in 0..0.5, got 0.6");
}
