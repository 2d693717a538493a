//! Odometry noise: variances of the book's table, derivatives against differences, covariances against samples.

use glam::{DMat3, DVec3};
use mobile_robot_simulator::{MotionNoise, Pose, Twist, integrate, random, wrap_angle};

const SEED: u64 = 60;

/// Twist and number of steps of each part of a drive: straight ahead, bends, a turn in place, sideways, backwards.
const DRIVE: [([f64; 3], u32); 6] = [
    ([0.5, 0.0, 0.0], 40),
    ([0.5, 0.0, 0.4], 40),
    ([0.0, 0.0, -0.8], 30),
    ([0.4, 0.0, -0.2], 40),
    ([0.0, 0.3, 0.1], 20),
    ([-0.3, 0.0, 0.3], 30),
];

const STEP: f64 = 0.1;

fn noise() -> MotionNoise {
    MotionNoise::new([0.02, 0.01, 0.005, 0.01, 0.002, 0.003]).unwrap()
}

/// Returns the pose before each step of the drive without noise, and the twist of the step.
fn drive() -> Vec<(Pose, Twist)> {
    let mut pose = Pose::new(1.0, -2.0, 0.5);
    let twists = DRIVE.iter().flat_map(|&(twist, steps)| (0..steps).map(move |_| Twist::from(twist)));
    twists
        .map(|twist| {
            let before = pose;
            pose = integrate(pose, twist, STEP);
            (before, twist)
        })
        .collect()
}

/// Returns the difference (x, y, yaw) of two poses.
fn difference(noisy: Pose, exact: Pose) -> DVec3 {
    (noisy.position - exact.position).extend(wrap_angle(noisy.yaw - exact.yaw))
}

#[test]
fn without_noise_a_sample_is_the_end_of_the_arc() {
    let (pose, twist) = (Pose::new(1.0, 2.0, 3.0), Twist::from([0.5, -0.1, 0.7]));
    let sample = MotionNoise::default().sample_from(pose, twist, 0.3, SEED, 0).unwrap();
    assert_eq!(sample, integrate(pose, twist, 0.3));
    let still = noise().sample_from(pose, Twist::default(), 0.3, SEED, 0).unwrap();
    assert_eq!(still, pose);
}

#[test]
fn a_sample_depends_on_seed_and_index_and_never_changes() {
    let sample = |seed, index| noise().sample_from(Pose::default(), [1.0, 0.0, 0.5].into(), 0.1, seed, index).unwrap();
    assert_eq!(sample(1, 2), sample(1, 2));
    assert!(sample(1, 2) != sample(1, 3) && sample(1, 2) != sample(2, 2));
    // These bits must not change between versions.
    assert_eq!(sample(7, 0).to_array().map(f64::to_bits), BYTES);
}

const BYTES: [u64; 3] = [4_591_108_198_738_614_313, 4_567_048_458_422_381_726, 4_586_087_938_714_051_914];

/// Computes v̂, ω̂ and γ̂ from the end of each sample and compares their variances with lines 2 to 4 of table 5.3.
#[test]
fn samples_have_the_variances_of_the_table() {
    let (v, w, dt) = (0.8, -0.5, 0.25);
    let [a1, a2, a3, a4, a5, a6] = noise().alpha();
    let mut stream = random::stream(SEED, 1);
    let draws = 40_000;
    let mut sums = [[0.0; 2]; 3];
    for _ in 0..draws {
        let end = noise().sample(Pose::default(), [v, 0.0, w].into(), dt, &mut stream);
        // The arc starts at the origin along x, so its chord points in the direction of half the turn.
        let turn = 2.0 * libm::atan2(end.position.y, end.position.x);
        let chord = end.position.length();
        let found = [chord * turn / (2.0 * libm::sin(0.5 * turn)) / dt, turn / dt, (end.yaw - turn) / dt];
        for ((sum, value), mean) in sums.iter_mut().zip(found).zip([v, w, 0.0]) {
            *sum = [sum[0] + (value - mean), sum[1] + (value - mean) * (value - mean)];
        }
    }
    let expected = [a1 * v * v + a2 * w * w, a3 * v * v + a4 * w * w, a5 * v * v + a6 * w * w];
    for (sum, variance) in sums.iter().zip(expected) {
        let (mean, found) = (sum[0] / f64::from(draws), sum[1] / f64::from(draws));
        // Four standard errors: that of the mean is √(variance/n), the relative one of the variance is √(2/n).
        assert!(mean.abs() < 4.0 * (variance / f64::from(draws)).sqrt(), "{mean}");
        assert!((found / variance - 1.0).abs() < 4.0 * (2.0 / f64::from(draws)).sqrt(), "{found} {variance}");
    }
}

/// Compares with `F·P·Fᵀ + V·M·Vᵀ`, where F and V are central differences of `integrate`.
#[test]
fn covariances_agree_with_central_differences() {
    let prior =
        DMat3::from_cols(DVec3::new(0.04, 0.01, 0.002), DVec3::new(0.01, 0.09, -0.003), DVec3::new(0.002, -0.003, 0.01));
    let [a1, a2, a3, a4, a5, a6] = noise().alpha();
    for twist in [[0.5, 0.0, 0.3], [0.5, 0.0, 1e-9], [0.4, -0.3, -2.0], [0.0, 0.0, 1.0], [0.7, 0.0, 0.0], [-0.5, 0.0, 0.05]]
    {
        let (pose, dt) = (Pose::new(1.0, 2.0, 2.2), 0.7);
        let twist = Twist::from(twist);
        let along = twist.linear.try_normalize().unwrap_or(glam::DVec2::X);
        let moved = |by: [f64; 6]| {
            let start = Pose::new(pose.position.x + by[0], pose.position.y + by[1], pose.yaw + by[2]);
            let twist = Twist { linear: twist.linear + by[3] * along, angular: twist.angular + by[4] };
            let end = integrate(start, twist, dt);
            DVec3::new(end.position.x, end.position.y, end.yaw + by[5] * dt)
        };
        let derivative = |index: usize| {
            let mut by = [0.0; 6];
            by[index] = 1e-5;
            (moved(by) - moved(by.map(|value| -value))) / 2e-5
        };
        let by_pose = DMat3::from_cols(derivative(0), derivative(1), derivative(2));
        let by_noise = DMat3::from_cols(derivative(3), derivative(4), derivative(5));
        let (v, w) = (twist.linear.length_squared(), twist.angular * twist.angular);
        let variances = DMat3::from_diagonal(DVec3::new(a1 * v + a2 * w, a3 * v + a4 * w, a5 * v + a6 * w));
        let expected = by_pose * prior * by_pose.transpose() + by_noise * variances * by_noise.transpose();
        let found = noise().propagate(prior, pose, twist, dt).unwrap();
        assert!(found.abs_diff_eq(expected, 1e-9), "{twist:?}: {found} {expected}");
        assert_eq!(found, found.transpose());
    }
}

/// Tests the normalised squared error of the pose at the end of the drive, `eᵀ·P⁻¹·e` (NEES, Bar-Shalom 2001, sec. 5.4).
///
/// Its mean over n drives is 3. Its sum follows χ² with 3n degrees of freedom and must lie in the middle 99 % of it.
#[test]
fn errors_agree_with_the_propagated_covariance() {
    let drive = drive();
    let end = {
        let (pose, twist) = drive[drive.len() - 1];
        integrate(pose, twist, STEP)
    };
    let drives = 2000;
    let covariance = drive
        .iter()
        .fold(DMat3::ZERO, |covariance, &(pose, twist)| noise().propagate(covariance, pose, twist, STEP).unwrap());
    let (mut sum, mut sum_estimated) = (0.0, 0.0);
    let mut outside = 0;
    for seed in 0..drives {
        let (mut noisy, mut estimated) = (drive[0].0, DMat3::ZERO);
        for (index, &(_, twist)) in drive.iter().enumerate() {
            // A robot does not know its true pose, so it has to propagate the covariance along its noisy poses.
            estimated = noise().propagate(estimated, noisy, twist, STEP).unwrap();
            noisy = noise().sample_from(noisy, twist, STEP, seed, index as u64).unwrap();
        }
        let error = difference(noisy, end);
        let squared = error.dot(covariance.inverse() * error);
        sum += squared;
        sum_estimated += error.dot(estimated.inverse() * error);
        // The 99th percentile of χ² with 3 degrees of freedom.
        outside += u32::from(squared > 11.345);
    }
    for mean in [sum, sum_estimated].map(|sum| sum / drives as f64) {
        let (low, high) = band(3.0 * drives as f64);
        assert!((low..high).contains(&(mean * drives as f64)), "{drives} times {mean} is not in {low}..{high}");
    }
    assert!((6..36).contains(&outside), "{outside} of {drives} errors are beyond the 99th percentile");
}

/// Returns the ends of the middle 99 % of χ² with many degrees of freedom (Wilson & Hilferty 1931).
fn band(freedom: f64) -> (f64, f64) {
    let quantile = |normal: f64| {
        let third = 2.0 / (9.0 * freedom);
        freedom * (1.0 - third + normal * third.sqrt()).powi(3)
    };
    (quantile(-2.5758), quantile(2.5758))
}

#[test]
fn the_error_names_the_bad_argument() {
    let error = MotionNoise::new([0.0, 0.0, -1.0, 0.0, 0.0, 0.0]).unwrap_err().to_string();
    assert_eq!(error, "alpha3 must be at least 0, got -1");
    let error = noise().sample_from(Pose::default(), [f64::NAN, 0.0, 0.0].into(), 1.0, 0, 0).unwrap_err().to_string();
    assert_eq!(error, "vx must be finite, got NaN");
    let error = noise().propagate(DMat3::NAN, Pose::default(), Twist::default(), 1.0).unwrap_err().to_string();
    assert_eq!(error, "covariance must be finite, got NaN");
}

#[test]
fn with_a_reference_step_any_division_into_steps_has_the_same_variance() {
    let noise = MotionNoise::new([0.1, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap().with_reference_step(0.1).unwrap();
    let twist = Twist::from([0.5, 0.0, 0.0]);
    for steps in [1, 20, 200, 1000] {
        let (mut covariance, dt) = (DMat3::ZERO, 2.0 / f64::from(steps));
        for _ in 0..steps {
            covariance = noise.propagate(covariance, Pose::default(), twist, dt).unwrap();
        }
        // 20 steps of 0.1 s, each with a variance of 0.1 · 0.5² · 0.1².
        assert!((covariance.x_axis.x - 20.0 * 0.1 * 0.25 * 0.01).abs() < 1e-15, "{steps}: {covariance}");
    }
    assert_eq!(noise.sample_from(Pose::default(), twist, 0.0, 1, 0).unwrap(), Pose::default());
    let error = noise.with_reference_step(0.0).unwrap_err().to_string();
    assert_eq!(error, "reference_step must be more than 0, got 0");
}

#[test]
fn the_mean_velocity_of_a_step_has_the_stated_covariance() {
    let noise = MotionNoise::new([0.02, 0.01, 0.01, 0.02, 0.005, 0.005]).unwrap().with_reference_step(0.1).unwrap();
    let (twist, dt, count) = (Twist::from([0.6, 0.3, 0.2]), 0.02, 20_000);
    let stated = noise.twist_covariance(twist, dt).unwrap();
    let mut sum = DMat3::ZERO;
    for index in 0..count {
        let end = noise.sample_from(Pose::default(), twist, dt, 7, index).unwrap();
        let found = Twist::between(Pose::default(), end, dt);
        let error = (found.linear - twist.linear).extend(found.angular - twist.angular);
        sum += DMat3::from_cols(error * error.x, error * error.y, error * error.z);
    }
    let (found, scale) = (sum * (1.0 / count as f64), stated.x_axis.x);
    // A variance of 20,000 samples has a standard deviation of 1 %.
    assert!((found - stated).abs_diff_eq(DMat3::ZERO, 0.05 * scale.max(stated.z_axis.z)), "{found} {stated}");
    assert!((found.x_axis.x / stated.x_axis.x - 1.0).abs() < 0.05 && (found.z_axis.z / stated.z_axis.z - 1.0).abs() < 0.05);
}
