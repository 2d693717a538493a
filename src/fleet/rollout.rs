//! Rollouts: what would happen to one robot under many sequences of commands.

use super::command::Command;
use super::member::Member;
use super::{Fleet, ROBOTS, check_duration, scene};
use crate::batch::for_each_heavy_chunk_watched;
use crate::error::Error;
use crate::interrupt::Watch;
use crate::memory;
use crate::motion::DriveCommands;

/// The future of one robot under one sequence of commands.
#[derive(Debug)]
pub struct Rollout<'a> {
    /// Gets the pose `[x, y, yaw]` in the map frame after each command \[m, rad\].
    pub poses: &'a mut [[f64; 3]],
    /// Gets whether the robot touched something at each command.
    pub contacts: &'a mut [bool],
}

/// Work of one step, in beams.
const WEIGHT: usize = 32;

/// Number of sequences that one thread works on at a time.
const CHUNK: usize = 16;

impl Fleet {
    /// Moves a robot from where it is by each of many sequences of commands, one command after another for `duration` seconds each.
    /// The fleet does not change: each sequence begins with its present state. The other robots of its world go on at their last
    /// commands.
    ///
    /// `commands` has the same number of commands for each rollout, one sequence after another. The results are those of
    /// [`step`](Self::step) without scans.
    ///
    /// # Errors
    /// - [`Error::NoRobot`]: there is no such robot.
    /// - [`Error::Length`]: the number of commands is not that of the poses or contacts of all rollouts.
    /// - Those of [`step`](Self::step).
    pub fn rollout<'a>(
        &self,
        robot: usize,
        commands: impl Into<DriveCommands<'a>>,
        duration: f64,
        threads: Option<usize>,
        rollouts: &mut [Rollout<'_>],
    ) -> Result<(), Error> {
        if robot >= self.len() {
            return Err(Error::NoRobot { robot, count: self.len() });
        }
        let commands = commands.into();
        let (duration_ns, steps) = (check_duration(duration)?, commands.len().checked_div(rollouts.len()).unwrap_or(0));
        self.check_commands(commands, Some(steps))?;
        for Rollout { poses, contacts } in &*rollouts {
            for (name, value) in [("poses", poses.len()), ("contacts", contacts.len())] {
                if value != steps {
                    return Err(Error::Length { name, value, needed: steps });
                }
            }
        }
        let distances = self.distances()?;
        let (watch, place) = (Watch::new(), self.worlds.place_of[robot]);
        let world = &self.worlds.all[self.worlds.world_at[place]];
        let (present, own) = (&self.members[world.robots.clone()], place - world.robots.start);
        let scene = scene(&self.grids, &distances, &self.options, &self.worlds, world, present[own].grid, &watch);
        let (body, weight) = (self.options.body(robot), WEIGHT * steps * present.len());
        for_each_heavy_chunk_watched(&watch, threads, rollouts, weight, CHUNK, |chunk, rollouts| {
            let (mut members, mut search) = (memory::with_room(ROBOTS, present.len())?, None);
            for (number, Rollout { poses, contacts }) in (chunk * CHUNK..).zip(rollouts) {
                members.clear();
                members.extend_from_slice(present);
                let rows = number * steps..(number + 1) * steps;
                for ((row, pose), contact) in rows.zip(&mut **poses).zip(&mut **contacts) {
                    let command = |other| (other == robot).then(|| Command::of(commands, row));
                    scene.step(&mut members, command, duration_ns, &mut search)?;
                    let Member { robot: moved, touch, .. } = &mut members[own];
                    (*pose, *contact) = (moved.map_pose(body)?.wrapped().to_array(), touch.is_some());
                }
            }
            Ok(())
        })
    }
}
