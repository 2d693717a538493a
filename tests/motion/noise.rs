//! Odometry noise: the book's table, derivatives by differences, and covariances that agree with the samples.

use glam::{DMat3, DVec3};
use mobile_robot_simulator::{MotionNoise, Pose, Twist, integrate, random, wrap_angle};

const SEED: u64 = 60;

/// A drive in which everything varies: straight on, bends, sideways, a turn in place, backwards.
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

/// Poses and twists of the drive without noise.
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

/// (x, y, yaw) between two poses.
fn error(believed: Pose, real: Pose) -> DVec3 {
    (believed.position - real.position).extend(wrap_angle(believed.yaw - real.yaw))
}

#[test]
fn without_noise_the_sample_is_the_arc() {
    let (pose, twist) = (Pose::new(1.0, 2.0, 3.0), Twist::from([0.5, -0.1, 0.7]));
    let sample = MotionNoise::default().sample_from(pose, twist, 0.3, SEED, 0).unwrap();
    assert_eq!(sample, integrate(pose, twist, 0.3));
    let still = noise().sample_from(pose, Twist::default(), 0.3, SEED, 0).unwrap();
    assert_eq!(still, pose);
}

#[test]
fn a_draw_is_named_by_seed_and_index() {
    let sample = |seed, index| noise().sample_from(Pose::default(), [1.0, 0.0, 0.5].into(), 0.1, seed, index).unwrap();
    assert_eq!(sample(1, 2), sample(1, 2));
    assert!(sample(1, 2) != sample(1, 3) && sample(1, 2) != sample(2, 2));
    // The bytes are part of the promise.
    assert_eq!(sample(7, 0).to_array().map(f64::to_bits), BYTES);
}

const BYTES: [u64; 3] = [4_591_108_198_738_614_313, 4_567_048_458_422_381_726, 4_586_087_938_714_051_914];

/// Variances of v̂, ω̂ and γ̂, got back from where the samples end: lines 2 to 4 of the table.
#[test]
fn samples_are_spread_as_the_table_says() {
    let (v, w, dt) = (0.8, -0.5, 0.25);
    let [a1, a2, a3, a4, a5, a6] = noise().alpha();
    let mut stream = random::stream(SEED, 1);
    let draws = 40_000;
    let mut sums = [[0.0; 2]; 3];
    for _ in 0..draws {
        let end = noise().sample(Pose::default(), [v, 0.0, w].into(), dt, &mut stream);
        // On the circle through the origin along x, the chord points along half of the turn.
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
        // Four standard deviations of either, which for the variance is √(2/n) of it.
        assert!(mean.abs() < 4.0 * (variance / f64::from(draws)).sqrt(), "{mean}");
        assert!((found / variance - 1.0).abs() < 4.0 * (2.0 / f64::from(draws)).sqrt(), "{found} {variance}");
    }
}

/// `F·P·Fᵀ + V·M·Vᵀ` with F and V by central differences of the motion itself.
#[test]
fn covariances_agree_with_differences() {
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

/// The squared error of the pose at the end of the drive, normalised by its covariance: on average over n drives it is 3, and n
/// times that is distributed as χ² with 3n degrees of freedom, whose 99 % band is taken (Bar-Shalom 2001, sec. 5.4).
#[test]
fn errors_are_as_large_as_their_covariance_says() {
    let drive = drive();
    let end = {
        let (pose, twist) = drive[drive.len() - 1];
        integrate(pose, twist, STEP)
    };
    let drives = 2000;
    let covariance = drive
        .iter()
        .fold(DMat3::ZERO, |covariance, &(pose, twist)| noise().propagate(covariance, pose, twist, STEP).unwrap());
    let (mut sum, mut by_own) = (0.0, 0.0);
    let mut outside = 0;
    for seed in 0..drives {
        let (mut believed, mut own) = (drive[0].0, DMat3::ZERO);
        for (index, &(_, twist)) in drive.iter().enumerate() {
            // As a robot has to: along the way that it believes it went.
            own = noise().propagate(own, believed, twist, STEP).unwrap();
            believed = noise().sample_from(believed, twist, STEP, seed, index as u64).unwrap();
        }
        let error = error(believed, end);
        let squared = error.dot(covariance.inverse() * error);
        sum += squared;
        by_own += error.dot(own.inverse() * error);
        // The 99th percentile of χ² with 3 degrees of freedom.
        outside += u32::from(squared > 11.345);
    }
    for mean in [sum, by_own].map(|sum| sum / drives as f64) {
        let (low, high) = band(3.0 * drives as f64);
        assert!((low..high).contains(&(mean * drives as f64)), "{mean} not in {low}..{high} over {drives}");
    }
    assert!((6..36).contains(&outside), "{outside} of {drives} beyond the 99th percentile");
}

/// The middle 99 % of χ² with many degrees of freedom (Wilson & Hilferty 1931).
fn band(freedom: f64) -> (f64, f64) {
    let quantile = |normal: f64| {
        let third = 2.0 / (9.0 * freedom);
        freedom * (1.0 - third + normal * third.sqrt()).powi(3)
    };
    (quantile(-2.5758), quantile(2.5758))
}

#[test]
fn bad_input_is_refused_by_name() {
    let error = MotionNoise::new([0.0, 0.0, -1.0, 0.0, 0.0, 0.0]).unwrap_err().to_string();
    assert_eq!(error, "alpha3 must be at least 0, got -1");
    let error = noise().sample_from(Pose::default(), [f64::NAN, 0.0, 0.0].into(), 1.0, 0, 0).unwrap_err().to_string();
    assert_eq!(error, "vx must be finite, got NaN");
    let error = noise().propagate(DMat3::NAN, Pose::default(), Twist::default(), 1.0).unwrap_err().to_string();
    assert_eq!(error, "covariance must be finite, got NaN");
}
