//! Commands for the robots of a fleet.

use super::{Fleet, MAX_COMMAND};
use crate::error::Error;
use crate::motion::{DriveCommands, DriveKind, Twist};

/// What a robot is told to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Move at a velocity in its own frame, as far as its wheels can.
    Move(Twist),
    /// Drive at a speed \[m/s\], and steer to an angle \[rad\] at no more than a rate \[rad/s\], as an Ackermann drive can.
    Steer { speed: f64, angle: f64, rate: f64 },
}

impl Command {
    /// Returns a command of many.
    pub fn of(commands: DriveCommands<'_>, row: usize) -> Self {
        match commands {
            DriveCommands::Twists(twists) => Self::Move(twists[row].into()),
            DriveCommands::Steered(rows) => {
                let [speed, angle] = rows[row];
                Self::Steer { speed, angle, rate: f64::INFINITY }
            }
        }
    }
}

impl Fleet {
    /// Returns true if the robots steer: then a command can be a speed and a steering angle.
    #[must_use]
    pub fn steers(&self) -> bool {
        self.options.drives.first().is_some_and(|drive| drive.kind() == DriveKind::Ackermann)
    }

    /// Checks commands: one for each robot, or `steps` in a row for each rollout.
    pub(super) fn check_commands(&self, commands: DriveCommands<'_>, steps: Option<usize>) -> Result<(), Error> {
        if matches!(commands, DriveCommands::Steered(_)) && !self.steers() {
            return Err(Error::Steered);
        }
        let is_bad = |row: &usize| !commands.row(*row).iter().all(|number| number.abs() <= MAX_COMMAND);
        let Some(row) = (0..commands.len()).find(is_bad) else { return Ok(()) };
        let count = steps.unwrap_or(1);
        Err(Error::Command { robot: row / count, step: steps.map(|_| row % count), value: commands.row(row).to_vec() })
    }
}
