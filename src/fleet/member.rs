//! A robot of a fleet with its random streams, and what the caller of a step is told about it.

use glam::DVec2;

use super::robot::{Body, Robot, STEP_NS};
use super::words::{Reader, Writer};
use crate::contact::Contact;
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::interrupt::Watch;
use crate::motion::{Twist, seconds};
use crate::pose::Pose;
use crate::world::World;

/// What a robot touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// The point of contact in the map frame \[m\].
    pub point: DVec2,
    /// Unit vector in the map frame towards the robot; zero if its origin is inside of what it touched.
    pub normal: DVec2,
}

/// A robot of a fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    robot: Robot,
    /// Index of its grid.
    pub grid: usize,
    /// Seed of its random streams.
    pub seed: u64,
    /// Index of its next scan.
    pub scans: u64,
    /// Index of the next pose that is drawn for it.
    draws: u64,
    /// Its pose in the map frame.
    pub pose: Pose,
    /// Its velocity in its own frame.
    pub velocity: Twist,
    /// What it touched first in its last step.
    pub touch: Option<Touch>,
}

impl From<Contact> for Touch {
    fn from(contact: Contact) -> Self {
        Self { point: contact.point, normal: contact.normal }
    }
}

impl Member {
    /// Returns a robot at the origin.
    ///
    /// # Errors
    /// Never.
    pub fn new(body: Body<'_>) -> Result<Self, Error> {
        let pose = Pose::default();
        let robot = Robot::new(pose, body)?;
        Ok(Self { robot, grid: 0, seed: 0, scans: 0, draws: 0, pose, velocity: Twist::default(), touch: None })
    }

    /// Writes the robot as words.
    pub fn write(&self, words: &mut Writer) {
        self.robot.write(words);
        for word in [self.grid as u64, self.seed, self.scans, self.draws] {
            words.word(word);
        }
        words.numbers(self.pose.to_array());
        words.numbers(self.velocity.to_array());
        words.option(self.touch.map(|Touch { point, normal }| [point.x, point.y, normal.x, normal.y]));
    }

    /// Returns the robot that was written.
    ///
    /// # Errors
    /// [`Error::State`]: the words are not those of a robot.
    pub fn read(words: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(Self {
            robot: Robot::read(words)?,
            grid: words.at_most(u64::from(u32::MAX))? as usize,
            seed: words.word()?,
            scans: words.word()?,
            draws: words.word()?,
            pose: words.pose()?,
            velocity: words.twist()?,
            touch: words.option()?.map(|[x, y, nx, ny]| Touch { point: DVec2::new(x, y), normal: DVec2::new(nx, ny) }),
        })
    }

    /// Returns the time since the robot was put at its first pose \[s\].
    pub fn time(&self) -> f64 {
        seconds(self.robot.time_ns())
    }

    /// Begins the random streams of another seed.
    pub fn use_seed(&mut self, seed: u64) {
        (self.seed, self.scans, self.draws) = (seed, 0, 0);
    }

    /// Draws a pose from the free space of a grid, for a disc of this radius \[m\].
    ///
    /// # Errors
    /// Those of [`OccupancyGrid::draw_free_poses`].
    pub fn draw_pose(&mut self, grid: &OccupancyGrid, radius: f64) -> Result<Pose, Error> {
        let mut pose = [[0.0; 3]];
        grid.draw_free_poses(radius, self.seed, self.draws, Some(1), &mut pose)?;
        self.draws = self.draws.wrapping_add(1);
        Ok(Pose::from(pose[0]))
    }

    /// Puts the robot at a pose in the map frame, where it stands still at time 0.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn put(&mut self, pose: Pose, body: Body<'_>) -> Result<(), Error> {
        self.robot = Robot::new(pose, body)?;
        self.touch = None;
        self.look(body)
    }

    /// Moves the robot at a command for a duration \[ns\].
    ///
    /// # Errors
    /// - [`Error::Number`]: a pose is not finite, or the robot is far too fast.
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn step(
        &mut self,
        command: Twist,
        duration_ns: i64,
        body: Body<'_>,
        world: World<'_>,
        watch: &Watch,
    ) -> Result<(), Error> {
        self.touch = None;
        self.robot.command(command, body)?;
        let end_ns = self.robot.time_ns() + duration_ns;
        while self.robot.time_ns() < end_ns {
            watch.check()?;
            let next_ns = (self.robot.time_ns() / STEP_NS + 1) * STEP_NS;
            let next_ns = if body.footprint.is_some() { next_ns.min(end_ns) } else { end_ns };
            let contact = self.robot.advance(next_ns, body, world)?;
            self.touch = self.touch.or(contact.map(Touch::from));
        }
        self.look(body)
    }

    /// Computes where the robot is and how it moves.
    fn look(&mut self, body: Body<'_>) -> Result<(), Error> {
        (self.pose, self.velocity) = (self.robot.map_pose(body)?, self.robot.velocity(body)?);
        Ok(())
    }
}
