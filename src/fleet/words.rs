//! Robots as words of 64 bits, for pickles.

use crate::error::Error;
use crate::motion::{Drive, DriveKind, FOREVER, Limits, Profile, Steering, SteeringProfile, Twist};
use crate::pose::Pose;

/// Number of words of how a robot on wheels steers.
const STEERING_WORDS: usize = 5;

/// Number of words of a drive.
const DRIVE_WORDS: usize = 8;

/// Writes parts of a state as words.
#[derive(Debug, Default)]
pub struct Writer(pub Vec<u64>);

/// Reads them again, and checks that they can be the parts of a state.
#[derive(Debug)]
pub struct Reader<'a>(pub std::slice::Iter<'a, u64>);

impl Writer {
    pub fn word(&mut self, word: u64) {
        self.0.push(word);
    }

    pub fn numbers<const N: usize>(&mut self, numbers: [f64; N]) {
        self.0.extend(numbers.map(f64::to_bits));
    }

    /// Writes numbers that may be missing.
    pub fn option<const N: usize>(&mut self, numbers: Option<[f64; N]>) {
        self.word(u64::from(numbers.is_some()));
        self.numbers(numbers.unwrap_or([0.0; N]));
    }

    pub fn profile(&mut self, Profile { start_ns, velocity, command, until_ns, limits, steering }: &Profile) {
        self.word(start_ns.unsigned_abs());
        self.numbers(velocity.to_array());
        self.numbers(command.to_array());
        self.word(until_ns.unsigned_abs());
        self.option(limits.map(|limits| {
            let [v, a, d] = [limits.velocity(), limits.acceleration(), limits.deceleration()];
            [v[0], v[1], v[2], a[0], a[1], a[2], d[0], d[1], d[2]]
        }));
        self.steering(steering.as_ref());
    }

    /// Writes how a robot on wheels steers.
    pub fn steering(&mut self, steering: Option<&SteeringProfile>) {
        let Some(SteeringProfile { start_ns, steering }) = steering else {
            self.0.extend([0; STEERING_WORDS]);
            return;
        };
        self.word(1);
        self.word(start_ns.unsigned_abs());
        self.numbers([steering.angle, steering.goal, steering.rate]);
    }

    /// Writes the wheels of a robot.
    pub fn drive(&mut self, drive: Option<&Drive>) {
        let Some(drive) = drive else {
            self.0.extend([0; DRIVE_WORDS]);
            return;
        };
        self.word(match drive.kind() {
            DriveKind::Differential => 1,
            DriveKind::Omni => 2,
            DriveKind::Ackermann => 3,
        });
        self.numbers([drive.wheelbase(), drive.track(), drive.wheel_speed_limit()]);
        self.numbers(drive.wheel_radius());
        self.numbers([drive.steering_limit(), drive.steering_rate()]);
    }
}

impl Reader<'_> {
    pub fn word(&mut self) -> Result<u64, Error> {
        self.0.next().copied().ok_or(Error::State { problem: "too few words" })
    }

    /// Reads a word that is at most `largest`.
    pub fn at_most(&mut self, largest: u64) -> Result<u64, Error> {
        self.word().and_then(|word| if word <= largest { Ok(word) } else { Err(Error::State { problem: "a large word" }) })
    }

    pub fn flag(&mut self) -> Result<bool, Error> {
        Ok(self.at_most(1)? == 1)
    }

    pub fn time_ns(&mut self) -> Result<i64, Error> {
        Ok(self.at_most(FOREVER.unsigned_abs())?.cast_signed())
    }

    fn any_numbers<const N: usize>(&mut self) -> Result<[f64; N], Error> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_bits(self.word()?);
        }
        Ok(numbers)
    }

    /// Reads finite numbers.
    pub fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Error> {
        let numbers = self.any_numbers()?;
        if numbers.iter().all(|number| number.is_finite()) {
            Ok(numbers)
        } else {
            Err(Error::State { problem: "a number that is not finite" })
        }
    }

    pub fn option<const N: usize>(&mut self) -> Result<Option<[f64; N]>, Error> {
        let is_some = self.flag()?;
        Ok(Some(self.numbers()?).filter(|_| is_some))
    }

    pub fn pose(&mut self) -> Result<Pose, Error> {
        Ok(Pose::from(self.numbers()?))
    }

    pub fn twist(&mut self) -> Result<Twist, Error> {
        Ok(Twist::from(self.numbers()?))
    }

    pub fn profile(&mut self) -> Result<Profile, Error> {
        let (start_ns, velocity, command) = (self.time_ns()?, self.twist()?, self.twist()?);
        let (until_ns, is_limited) = (self.time_ns()?, self.flag()?);
        let [v, a, d] = [self.any_numbers()?, self.any_numbers()?, self.any_numbers()?];
        let limits = is_limited.then(|| Limits::new(v, a, d)).transpose()?;
        Ok(Profile { start_ns, velocity, command, until_ns, limits, steering: self.steering()? })
    }

    pub fn steering(&mut self) -> Result<Option<SteeringProfile>, Error> {
        let (steers, start_ns, [angle, goal, rate]) = (self.flag()?, self.time_ns()?, self.any_numbers()?);
        Ok(steers.then_some(SteeringProfile { start_ns, steering: Steering { angle, goal, rate } }))
    }

    pub fn drive(&mut self) -> Result<Option<Drive>, Error> {
        let kind = self.at_most(3)?;
        let [wheelbase, track, speed_limit] = self.any_numbers()?;
        let radius: [f64; 2] = self.any_numbers()?;
        let [limit, turn_rate] = self.any_numbers()?;
        let drive = match kind {
            0 => return Ok(None),
            1 => Drive::differential(track, 1.0),
            2 => Drive::omni(wheelbase, track, 1.0),
            _ => Drive::ackermann(wheelbase, track, 1.0, limit, turn_rate),
        };
        Ok(Some(drive?.with_radii(radius)?.with_wheel_speed_limit(speed_limit)?))
    }
}
