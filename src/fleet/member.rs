//! A robot of a fleet with its random streams, and what the caller of a step is told about it.

use std::sync::Arc;

use glam::DVec2;

use super::odometer::Odometer;
use super::robot::{Body, Robot};
use super::words::{Reader, Writer};
use super::{FleetOptions, Reset};
use crate::contact::Contact;
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::motion::{MotionNoise, Twist, seconds};
use crate::pose::Pose;
use crate::shape::Shape;

/// What a robot touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// The point of contact in the map frame \[m\].
    pub point: DVec2,
    /// Unit vector in the map frame towards the robot; zero if its origin is inside of what it touched.
    pub normal: DVec2,
    /// What it touched.
    pub what: Thing,
}

/// Something that a robot can touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Thing {
    /// A blocking cell of the grid.
    Wall,
    /// The obstacle with this index in the fleet.
    Obstacle(usize),
    /// The robot with this index in the fleet.
    Robot(usize),
}

/// What a caller is told about a robot after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Pose in the map frame, with its yaw in (-π, π].
    pub pose: Pose,
    /// Velocity in its own frame.
    pub velocity: Twist,
    /// Pose that its odometry reports, in the odometry frame.
    pub odometry: Pose,
    /// What it touched first; `None` for nothing.
    pub touch: Option<Touch>,
    /// Distance to the nearest thing \[m\]; NaN if it was not measured.
    pub clearance: f64,
}

/// A robot of a fleet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member {
    pub robot: Robot,
    odometer: Odometer,
    /// Index of its grid.
    pub grid: usize,
    /// Seed of its random streams.
    pub seed: u64,
    /// Index of its next scan.
    pub scans: u64,
    /// Index of the next pose that is drawn for it.
    draws: u64,
    /// Its pose in the map frame, with its yaw in (-π, π].
    pub pose: Pose,
    /// Pose in the map frame with which others can collide until the next multiple of the time step.
    pub frozen: Pose,
    /// Its velocity in its own frame.
    pub velocity: Twist,
    /// What it touched first in its last step.
    pub touch: Option<Touch>,
    /// Distance to the nearest thing after its last step \[m\]; NaN if it was not measured.
    pub clearance: f64,
}

impl Member {
    /// Returns a robot at the origin.
    ///
    /// # Errors
    /// Never.
    pub fn new(body: Body<'_>) -> Result<Self, Error> {
        let pose = Pose::default();
        Ok(Self {
            robot: Robot::new(pose, 0, body)?,
            odometer: Odometer::new(0, 0),
            grid: 0,
            seed: 0,
            scans: 0,
            draws: 0,
            pose,
            frozen: pose,
            velocity: Twist::default(),
            touch: None,
            clearance: f64::NAN,
        })
    }

    /// Writes the robot as words.
    pub fn write(&self, words: &mut Writer) {
        self.robot.write(words);
        self.odometer.write(words);
        for word in [self.grid as u64, self.seed, self.scans, self.draws] {
            words.word(word);
        }
        words.numbers(self.pose.to_array());
        words.numbers(self.frozen.to_array());
        words.numbers(self.velocity.to_array());
        words.option(self.touch.map(|Touch { point, normal, .. }| [point.x, point.y, normal.x, normal.y]));
        let what = match self.touch.map_or(Thing::Wall, |touch| touch.what) {
            Thing::Wall => [0, 0],
            Thing::Obstacle(index) => [1, index as u64],
            Thing::Robot(index) => [2, index as u64],
        };
        for word in what {
            words.word(word);
        }
        words.option(Some([self.clearance]).filter(|[clearance]| clearance.is_finite()));
    }

    /// Returns the robot that was written.
    ///
    /// # Errors
    /// [`Error::State`]: the words are not those of a robot.
    pub fn read(words: &mut Reader<'_>) -> Result<Self, Error> {
        let (robot, odometer) = (Robot::read(words)?, Odometer::read_words(words)?);
        let grid = words.at_most(u64::from(u32::MAX))? as usize;
        let (seed, scans, draws) = (words.word()?, words.word()?, words.word()?);
        let (pose, frozen, velocity) = (words.pose()?, words.pose()?, words.twist()?);
        let (touch, kind, index) = (words.option()?, words.at_most(2)?, words.at_most(u64::from(u32::MAX))? as usize);
        let what = [Thing::Wall, Thing::Obstacle(index), Thing::Robot(index)][kind as usize];
        let touch = touch.map(|[x, y, nx, ny]| Touch { point: DVec2::new(x, y), normal: DVec2::new(nx, ny), what });
        let clearance = words.option()?.map_or(f64::NAN, |[clearance]| clearance);
        Ok(Self { robot, odometer, grid, seed, scans, draws, pose, frozen, velocity, touch, clearance })
    }

    /// Returns the time in the robot's world \[s\].
    pub fn time(&self) -> f64 {
        seconds(self.robot.time_ns())
    }

    /// Returns what a caller is told about the robot.
    pub fn report(&self) -> Report {
        let Self { pose, velocity, touch, clearance, .. } = *self;
        Report { pose, velocity, odometry: self.odometer.pose, touch, clearance }
    }

    /// Begins the random streams of another seed.
    fn use_seed(&mut self, seed: u64) {
        (self.seed, self.scans, self.draws) = (seed, 0, 0);
        self.odometer = Odometer::new(0, 0);
    }

    /// Draws a pose from the free space of a grid, for a disc of this radius \[m\].
    ///
    /// # Errors
    /// Those of [`OccupancyGrid::draw_free_poses`].
    fn draw_pose(&mut self, grid: &OccupancyGrid, radius: f64) -> Result<Pose, Error> {
        let mut pose = [[0.0; 3]];
        grid.draw_free_poses(radius, self.seed, self.draws, Some(1), &mut pose)?;
        self.draws = self.draws.wrapping_add(1);
        Ok(Pose::from(pose[0]))
    }

    /// Puts the robot at a pose in the map frame, where it stands still from a time \[ns\] on.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    fn put(&mut self, pose: Pose, time_ns: i64, body: Body<'_>) -> Result<(), Error> {
        self.robot = Robot::new(pose, time_ns, body)?;
        self.odometer = Odometer::new(time_ns, self.odometer.index());
        (self.touch, self.clearance) = (None, f64::NAN);
        self.pose = self.robot.map_pose(body)?.wrapped();
        self.velocity = self.robot.velocity(body)?;
        Ok(())
    }

    /// Begins an episode: another grid, seed or pose, as a reset says.
    ///
    /// # Errors
    /// - [`Error::Index`]: the grid does not exist.
    /// - [`Error::Row`]: the pose is not finite.
    /// - Those of [`OccupancyGrid::draw_free_poses`].
    pub fn begin(
        &mut self,
        robot: usize,
        time_ns: i64,
        Reset { poses, seeds, grids }: Reset<'_>,
        all_grids: &[Arc<OccupancyGrid>],
        options: &FleetOptions,
    ) -> Result<(), Error> {
        if let Some(grids) = grids {
            self.grid = grids[robot];
        }
        let Some(grid) = all_grids.get(self.grid) else {
            return Err(Error::Index { name: "grid", robot, value: self.grid, count: all_grids.len() });
        };
        if let Some(seeds) = seeds {
            self.use_seed(seeds[robot]);
        }
        let pose = match poses.map(|poses| poses[robot]) {
            Some(value) if !value.iter().all(|number| number.is_finite()) => {
                return Err(Error::Row { name: "poses", row: robot, value });
            }
            Some(pose) => Pose::from(pose),
            None => self.draw_pose(grid, options.footprint.as_ref().map_or(0.0, Shape::reach) + options.clearance)?,
        };
        self.put(pose, time_ns, options.body(robot))
    }

    /// Counts a scan, so that the next one has other noise.
    pub fn count_scan(&mut self) {
        self.scans = self.scans.wrapping_add(1);
    }

    /// Notes a contact, if it is the first one of the step.
    pub fn note(&mut self, contact: Contact, what: Thing) {
        self.touch.get_or_insert(Touch { point: contact.point, normal: contact.normal, what });
    }

    /// Computes where the robot is after a step and how it moves, and reads its odometer.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn look(&mut self, body: Body<'_>, noise: Option<&MotionNoise>) -> Result<(), Error> {
        self.pose = self.robot.map_pose(body)?.wrapped();
        self.velocity = self.robot.velocity(body)?;
        let wheels = self.robot.wheels_now(body)?.wrapped();
        self.odometer.read(wheels, self.robot.time_ns(), noise, self.seed)
    }
}
