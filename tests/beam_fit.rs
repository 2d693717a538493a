//! Fits of the beam model: parameters that sampled readings were drawn with are found again.

use mobile_robot_simulator::{BeamFit, BeamModel, BeamModelOptions};

const MAX_RANGE: f64 = 30.0;

/// Returns readings of true ranges from 1 m to 21 m, of which one in ten has no return, and these true ranges.
fn data(options: BeamModelOptions, count: usize, seed: u64) -> (Vec<f32>, Vec<f32>) {
    let range = |index: usize| if index % 10 == 9 { f64::INFINITY } else { 1.0 + (index as f64 * 0.618_034).fract() * 20.0 };
    let ranges: Vec<f64> = (0..count).map(range).collect();
    let mut readings = vec![0.0; count];
    BeamModel::new(options).expect("a model").sample(&ranges, MAX_RANGE, (seed, 0), &mut readings);
    (
        readings.iter().map(|&reading| reading as f32).collect(),
        ranges.iter().map(|&range| range.min(MAX_RANGE) as f32).collect(),
    )
}

fn fit(options: BeamModelOptions, count: usize, seed: u64) -> BeamFit {
    let (readings, ranges) = data(options, count, seed);
    BeamModel::fit(readings, ranges, (0.0, MAX_RANGE)).expect("a fit")
}

fn parameters(options: BeamModelOptions) -> [f64; 6] {
    let BeamModelOptions { sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand, .. } = options;
    [sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand]
}

fn models() -> Vec<BeamModelOptions> {
    let model = |sigma_hit, lambda_short, [z_hit, z_short, z_max, z_rand]: [f64; 4]| BeamModelOptions {
        sigma_hit,
        lambda_short,
        z_hit,
        z_short,
        z_max,
        z_rand,
        ..BeamModelOptions::default()
    };
    vec![
        model(0.05, 1.0, [0.5, 0.2, 0.15, 0.15]),
        model(0.2, 0.5, [0.4, 0.25, 0.15, 0.2]),
        model(0.01, 2.0, [0.3, 0.3, 0.2, 0.2]),
        model(0.5, 1.0, [0.5, 0.2, 0.1, 0.2]),
    ]
}

/// With 1e5 readings, 2 % is two to four standard errors of the weakest parameter of these models, whose seed is fixed.
#[test]
fn all_parameters_are_found_within_two_percent() {
    for options in models() {
        let fit = fit(options, 100_000, 2);
        assert!(fit.has_converged && fit.unidentified.is_empty() && fit.count == 100_000);
        let found = parameters(fit.model.options());
        for ((found, expected), error) in found.iter().zip(parameters(options)).zip(fit.standard_errors) {
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{found} instead of {expected}, standard error {error}: {options:?}"
            );
            assert!(error < 0.012 * expected, "standard error {error} of {expected}");
        }
    }
}

/// The errors of many fits, in standard errors, have a mean of 0 and a standard deviation of 1.
#[test]
fn standard_errors_are_those_of_many_fits() {
    const FITS: u64 = 100;
    let options = models()[1];
    let mut sums = [[0.0; 2]; 6];
    for seed in 0..FITS {
        let fit = fit(options, 4000, 100 + seed);
        let found = parameters(fit.model.options());
        for (parameter, sum) in sums.iter_mut().enumerate() {
            let deviation = (found[parameter] - parameters(options)[parameter]) / fit.standard_errors[parameter];
            *sum = [sum[0] + deviation, sum[1] + deviation * deviation];
        }
    }
    for [sum, squares] in sums {
        let count = FITS as f64;
        assert!((sum / count).abs() < 0.4, "mean {}", sum / count);
        assert!((0.6..1.5).contains(&(squares / count)), "variance {}", squares / count);
    }
}

/// A wide hit part loses much of its mass at 0 and at the maximum range. Without that loss, σ would be too small.
#[test]
fn the_truncation_of_hits_counts() {
    let options = BeamModelOptions { sigma_hit: 6.0, z_hit: 0.9, z_max: 0.1, ..BeamModelOptions::default() };
    let (readings, ranges) = data(options, 100_000, 4);
    let fit = BeamModel::fit(readings, ranges, (0.0, MAX_RANGE)).expect("a fit");
    let (found, error) = (fit.model.options().sigma_hit, fit.standard_errors[0]);
    assert!((found - 6.0).abs() < 4.0 * error && error < 0.06, "{found}, standard error {error}");
}

/// Readings below a minimum range are known to be there, and not which they are.
#[test]
fn marks_of_readings_below_the_minimum_range_count() {
    const MIN_RANGE: f32 = 0.8;
    for options in [models()[0], models()[3]] {
        let (readings, ranges) = data(options, 100_000, 3);
        let marked = readings.iter().map(|&reading| if reading < MIN_RANGE { f32::NEG_INFINITY } else { reading });
        let limits = (f64::from(MIN_RANGE), MAX_RANGE);
        let fit = BeamModel::fit(marked.clone(), ranges.iter().copied(), limits).expect("a fit");
        assert_eq!(fit.count, 100_000);
        let found = parameters(fit.model.options());
        for ((found, expected), error) in found.iter().zip(parameters(options)).zip(fit.standard_errors) {
            assert!((found - expected).abs() < 4.0 * error, "{found} instead of {expected}, standard error {error}");
            assert!(error < 0.03 * expected);
        }
        let likelihoods = fit.model.likelihoods(marked, ranges, limits).expect("ranges");
        let log_likelihood: f64 = likelihoods.iter().map(|likelihood| likelihood.ln()).sum();
        assert!((log_likelihood - fit.log_likelihood).abs() < 1e-6 * log_likelihood.abs());
    }
}

/// No change of a parameter makes the readings more likely.
#[test]
fn the_fit_is_a_maximum_of_the_likelihood() {
    let (readings, ranges) = data(models()[3], 20_000, 5);
    let fit = BeamModel::fit(readings.iter().copied(), ranges.iter().copied(), (0.0, MAX_RANGE)).expect("a fit");
    let log_likelihood = |options| {
        let model = BeamModel::new(options).expect("a model");
        let all = model.likelihoods(readings.iter().copied(), ranges.iter().copied(), (0.0, MAX_RANGE)).expect("ranges");
        all.iter().map(|likelihood| likelihood.ln()).sum::<f64>()
    };
    let best = log_likelihood(fit.model.options());
    assert!((best - fit.log_likelihood).abs() < 1e-6 * best.abs());
    for change in [0.99, 1.01] {
        let options = fit.model.options();
        for changed in [
            BeamModelOptions { sigma_hit: options.sigma_hit * change, ..options },
            BeamModelOptions { lambda_short: options.lambda_short * change, ..options },
            BeamModelOptions { z_hit: options.z_hit * change, ..options },
            BeamModelOptions { z_short: options.z_short * change, ..options },
            BeamModelOptions { z_max: options.z_max * change, ..options },
            BeamModelOptions { z_rand: options.z_rand * change, ..options },
        ] {
            assert!(log_likelihood(changed) < best, "{changed:?}");
        }
    }
}

/// Where λ is far below the inverse of the true ranges, short readings are almost as uniform as random ones. The likelihood
/// then has a long ridge, along which plain expectation maximization takes 1500 steps.
#[test]
fn a_fit_does_not_creep_along_a_ridge() {
    let weights = BeamModelOptions { z_hit: 0.7, z_short: 0.15, z_max: 0.05, z_rand: 0.1, ..BeamModelOptions::default() };
    let options = BeamModelOptions { sigma_hit: 0.1, lambda_short: 0.01, ..weights };
    let (readings, ranges) = data(options, 20_000, 2);
    let fit = BeamModel::fit(readings.iter().copied(), ranges.iter().copied(), (0.0, MAX_RANGE)).expect("a fit");
    let drawn_with = BeamModel::new(options).expect("a model");
    let all = drawn_with.likelihoods(readings, ranges, (0.0, MAX_RANGE)).expect("ranges");
    assert!(fit.log_likelihood > all.iter().map(|likelihood| likelihood.ln()).sum());
    assert!(fit.has_converged && fit.iterations < 100, "{} iterations", fit.iterations);
}

#[test]
fn what_the_readings_do_not_determine_is_named() {
    let only = |z_hit, z_short, z_max, z_rand| BeamModelOptions {
        sigma_hit: 0.1,
        lambda_short: 1.0,
        z_hit,
        z_short,
        z_max,
        z_rand,
        ..BeamModelOptions::default()
    };
    let hits = fit(only(1.0, 0.0, 0.0, 0.0), 10_000, 1);
    assert_eq!(hits.unidentified, ["lambda_short"]);
    assert!((hits.model.options().sigma_hit - 0.1).abs() < 0.003 && hits.standard_errors[1].is_nan());
    let shorts = fit(only(0.0, 1.0, 0.0, 0.0), 10_000, 1);
    assert!((shorts.model.options().lambda_short - 1.0).abs() < 0.05, "{shorts:?}");
    let failures = fit(only(0.0, 0.0, 1.0, 0.0), 1000, 1);
    assert_eq!(failures.unidentified, ["sigma_hit", "lambda_short"]);
    assert!(failures.model.options().z_max > 0.99, "{failures:?}");
    let exact = BeamModel::fit([5.0; 100], [5.0; 100], (0.0, MAX_RANGE)).expect("a fit");
    assert!(exact.model.options().sigma_hit <= 1e-6 * MAX_RANGE && exact.log_likelihood.is_finite());
}

#[test]
fn readings_that_say_nothing_are_left_out_and_others_are_checked() {
    let readings = [f32::NAN, f32::NEG_INFINITY, -1.0, 4.0, 5.0, f32::INFINITY, 31.0];
    let fit = BeamModel::fit(readings, [5.0, 5.0, 5.0, 0.0, 5.0, 5.0, 5.0], (0.0, MAX_RANGE)).expect("a fit");
    assert_eq!(fit.count, 3);
    assert!((fit.model.options().z_max - 2.0 / 3.0).abs() < 1e-6);
    let error = |readings: &[f32], ranges: &[f32], max_range: f64| {
        BeamModel::fit(readings.iter().copied(), ranges.iter().copied(), (0.0, max_range)).unwrap_err().to_string()
    };
    assert_eq!(error(&[], &[], 30.0), "the number of readings to fit must be at least 1, got 0");
    assert_eq!(error(&[f32::NAN], &[5.0], 30.0), "the number of readings to fit must be at least 1, got 0");
    assert_eq!(error(&[1.0], &[-5.0], 30.0), "true_ranges must be at least 0, got -5");
    assert_eq!(error(&[1.0], &[5.0], 0.0), "max_range must be positive, got 0");
}

#[test]
fn an_offset_is_found() {
    for (options, offset) in [(models()[0], 0.037), (models()[1], -0.12)] {
        let (readings, ranges) = data(options, 100_000, 6);
        // The true ranges of the map are too short by the offset.
        let moved: Vec<f32> = ranges.iter().map(|&range| if range < 30.0 { range - offset as f32 } else { range }).collect();
        let fit = BeamModel::fit_with_offset(readings, moved, (0.0, MAX_RANGE)).expect("a fit");
        let error = fit.standard_errors[6];
        let found = fit.offset.expect("an offset");
        assert!((found - offset).abs() < 4.0 * error && error < 0.01 * options.sigma_hit, "{found} {error}");
        for ((found, expected), error) in
            parameters(fit.model.options()).iter().zip(parameters(options)).zip(fit.standard_errors)
        {
            assert!((found - expected).abs() < 4.0 * error, "{found} instead of {expected}, standard error {error}");
        }
    }
    let none = BeamModel::fit_with_offset([f32::INFINITY; 50], [5.0; 50], (0.0, MAX_RANGE)).expect("a fit");
    assert!(none.offset == Some(0.0) && none.standard_errors[6].is_nan() && none.unidentified.contains(&"offset"));
}

/// Readings of each band are drawn with another σ.
#[test]
fn sigma_grows_with_incidence_as_it_was_drawn() {
    let (mut readings, mut ranges, mut incidences) = (Vec::new(), Vec::new(), Vec::new());
    let sigma = |band: usize| 0.03 + 0.01 * band as f64;
    let middle = |band: usize| ((band as f32 + 0.5) * 15.0).to_radians();
    for band in 0..5 {
        let (some, of) = data(BeamModelOptions { sigma_hit: sigma(band), ..models()[0] }, 20_000, 7);
        readings.extend(some);
        ranges.extend(of);
        incidences.extend(std::iter::repeat_n(middle(band), 20_000));
    }
    // Not an incidence.
    readings.extend([5.0; 1000]);
    ranges.extend([5.0; 1000]);
    incidences.extend([f32::NAN; 1000]);
    let fit = BeamModel::fit(readings.iter().copied(), ranges.iter().copied(), (0.0, MAX_RANGE)).expect("a fit");
    let sigmas = fit.model.sigma_by_incidence(&readings, &ranges, &incidences, (0.0, MAX_RANGE)).expect("sigmas");
    for (band, found) in sigmas.into_iter().enumerate().take(5) {
        assert!((found / sigma(band) - 1.0).abs() < 0.05, "{found} in band {band}");
    }
    assert!(sigmas[5].is_nan());
    // 90° as a float32 is in the last band.
    let last = [std::f32::consts::FRAC_PI_2; 20];
    let sigmas = fit.model.sigma_by_incidence(&[5.1; 20], &[5.0; 20], &last, (0.0, MAX_RANGE)).expect("sigmas");
    assert!((sigmas[5] - 0.1).abs() < 0.01 && sigmas[0].is_nan());
}
