//! The odometer of a robot: the pose that it estimates from the motion of its wheels, exact or with drift.

use super::words::{Reader, Writer};
use crate::error::Error;
use crate::motion::{MotionNoise, Twist, seconds};
use crate::pose::Pose;

/// An odometer, which is read after each step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odometer {
    /// Pose of the wheels at the last reading, in the odometry frame.
    wheels: Pose,
    /// Time of the last reading \[ns\].
    time_ns: i64,
    /// Index of the next draw.
    index: u64,
    /// The pose that was read last, in the odometry frame.
    pub pose: Pose,
}

impl Odometer {
    /// Returns an odometer of a robot at its first pose, at a time \[ns\].
    pub fn new(time_ns: i64, index: u64) -> Self {
        Self { wheels: Pose::default(), time_ns, index, pose: Pose::default() }
    }

    /// Returns the index of the next draw.
    pub fn index(&self) -> u64 {
        self.index
    }

    /// Estimates the pose at a time \[ns\] from that of the wheels.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn read(&mut self, wheels: Pose, time_ns: i64, noise: Option<&MotionNoise>, seed: u64) -> Result<(), Error> {
        if let Some(noise) = noise {
            let duration = seconds(time_ns - self.time_ns);
            if duration > 0.0 {
                let twist = Twist::between(self.wheels, wheels, duration);
                self.pose = noise.sample_from(self.pose, twist, duration, seed, self.index)?.wrapped();
                self.index = self.index.wrapping_add(1);
            }
        } else {
            self.pose = wheels;
        }
        (self.wheels, self.time_ns) = (wheels, time_ns);
        Ok(())
    }

    /// Writes the odometer as words.
    pub fn write(&self, words: &mut Writer) {
        words.numbers(self.wheels.to_array());
        words.word(self.time_ns.unsigned_abs());
        words.word(self.index);
        words.numbers(self.pose.to_array());
    }

    /// Returns the odometer that was written.
    ///
    /// # Errors
    /// [`Error::State`]: the words are not those of an odometer.
    pub fn read_words(words: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(Self { wheels: words.pose()?, time_ns: words.time_ns()?, index: words.word()?, pose: words.pose()? })
    }
}
