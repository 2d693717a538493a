//! Fleets: many robots that are stepped together, each in a world of its own or several in one.

mod command;
mod joints;
mod member;
mod odometer;
mod options;
mod robot;
mod rollout;
mod scan;
mod state;
mod step;
mod words;
mod worlds;

use std::sync::Arc;

use glam::DVec2;

use crate::batch::for_each_heavy_chunk_watched;
use crate::error::{Error, check_number};
use crate::free_area::Distances;
use crate::grid::{Cell, OccupancyGrid};
use crate::interrupt::Watch;
use crate::memory;
use crate::motion::{DriveCommands, Twist, nanoseconds};
use crate::obstacles::Trajectory;
use crate::pose::{Pose, rotate};
use crate::shape::Shape;
use command::Command;
use member::Member;
pub use member::{Report, Thing, Touch};
pub use options::FleetOptions;
pub use rollout::Rollout;
pub use state::FleetState;
use step::Scene;
pub use worlds::FleetObstacle;
use worlds::{FleetWorld, Worlds};

/// Largest absolute velocity that a robot can be commanded to move at, for each axis \[m/s, m/s, rad/s\].
pub const MAX_COMMAND: f64 = 1e3;

/// Longest step \[s\].
const MAX_DURATION: f64 = 1e6;

/// Name of the robots in an error.
const ROBOTS: &str = "the robots of a fleet";

/// Work of one robot in one step, in beams.
const WEIGHT: usize = 64;

/// Number of robots that one thread works on at a time.
const CHUNK: usize = 16;

/// Robots that are stepped together. Each world has one of the grids, obstacles, and one robot or several, which see and touch
/// each other.
///
/// Each robot moves, touches and measures as a robot of the Python class `Simulation`, to the last bit, whatever the other
/// robots do and however many threads work.
///
/// ```
/// use std::sync::Arc;
/// use mobile_robot_simulator::{ContactMode, Fleet, FleetOptions, GridOptions, OccupancyGrid, Pose, Shape, Unknown};
///
/// // A row of ten cells of 1 m; the cell from x = 7 m to x = 8 m is occupied.
/// let mut cells = vec![0; 10];
/// cells[7] = 100;
/// let options =
///     GridOptions { resolution: 1.0, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
/// let grid = Arc::new(OccupancyGrid::new(cells, 10, options)?);
/// let options = FleetOptions {
///     footprint: Some(Shape::disc(0.5)?),
///     contact: ContactMode::Stop,
///     limits: vec![],
///     drives: vec![],
///     slip: vec![],
///     scanner: None,
///     noise: vec![],
///     surfaces: vec![],
///     odometry_noise: vec![],
///     clearance_limit: None,
///     clearance: 0.0,
/// };
/// // Two robots, 2 m and 5 m before the wall, drive at 1 m/s for 3 s. The first one stops 0.5 m before the wall.
/// let mut fleet = Fleet::new(vec![grid], options, &[[5.0, 0.5, 0.0], [2.0, 0.5, 0.0]], &[1, 2], &[0, 0], &[0, 1], vec![])?;
/// fleet.step(&[[1.0, 0.0, 0.0]; 2], 3.0, None, None)?;
/// let x: Vec<f64> = fleet.poses().map(|pose| pose.position.x).collect();
/// assert!((x[0] - 6.5).abs() < 1e-6 && (x[1] - 5.0).abs() < 1e-12);
/// assert!(fleet.reports().next().expect("a robot").touch.is_some());
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Fleet {
    grids: Vec<Arc<OccupancyGrid>>,
    options: FleetOptions,
    worlds: Worlds,
    /// The robots, world by world.
    members: Vec<Member>,
    /// Where a step happens, so that nothing changes if it fails.
    next: Vec<Member>,
}

/// What [`Fleet::reset`] gives to each robot of the fleet; `None` to leave it to the robot.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reset<'a> {
    /// Poses `[x, y, yaw]` in the map frame \[m, rad\]. Default: drawn from free space.
    pub poses: Option<&'a [[f64; 3]]>,
    /// Seeds with which the random streams start again. Default: the streams go on.
    pub seeds: Option<&'a [u64]>,
    /// Index of the grid of each robot. Default: the grid stays.
    pub grids: Option<&'a [usize]>,
}

impl Fleet {
    /// Returns a fleet of robots with these poses `[x, y, yaw]` in the map frame \[m, rad\], seeds, indices of their grids, and
    /// numbers of their worlds.
    ///
    /// Robots with the same number share a world. If there are no poses, they are drawn from free space.
    ///
    /// # Errors
    /// - [`Error::Count`]: there is no robot.
    /// - [`Error::Length`]: a list has another length than the seeds.
    /// - [`Error::Index`]: a grid does not exist.
    /// - [`Error::Row`]: a pose is not finite.
    /// - [`Error::Number`]: the slip is not in 0..1, or the clearance is negative or not finite.
    /// - [`Error::NoWorld`]: an obstacle is in a world without a robot.
    /// - Those of [`OccupancyGrid::draw_free_poses`].
    pub fn new(
        grids: Vec<Arc<OccupancyGrid>>,
        options: FleetOptions,
        poses: &[[f64; 3]],
        seeds: &[u64],
        grid_of: &[usize],
        world_of: &[u64],
        obstacles: Vec<FleetObstacle>,
    ) -> Result<Self, Error> {
        let count = seeds.len();
        if count == 0 {
            return Err(Error::Count { name: "the number of robots", value: 0, needed: "at least 1" });
        }
        if world_of.len() != count {
            return Err(Error::Length { name: "world_of", value: world_of.len(), needed: count });
        }
        let (options, worlds) = (options.checked(count)?, Worlds::new(world_of, obstacles)?);
        let still = Member::new(options.body(0))?;
        let members = memory::filled(ROBOTS, still, count)?;
        let mut fleet = Self { grids, options, worlds, members, next: Vec::new() };
        let poses = (!poses.is_empty()).then_some(poses);
        fleet.reset(&memory::filled(ROBOTS, true, count)?, Reset { poses, seeds: Some(seeds), grids: Some(grid_of) })?;
        Ok(fleet)
    }

    /// Returns the number of robots.
    #[must_use]
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Returns false: a fleet has at least one robot.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Returns what the robots are.
    #[must_use]
    pub fn options(&self) -> &FleetOptions {
        &self.options
    }

    /// Replaces the grids, for example by ones with other cells.
    ///
    /// # Errors
    /// [`Error::Length`]: there are not as many as before.
    pub fn use_grids(&mut self, grids: Vec<Arc<OccupancyGrid>>) -> Result<(), Error> {
        if grids.len() != self.grids.len() {
            return Err(Error::Length { name: "grids", value: grids.len(), needed: self.grids.len() });
        }
        for member in &mut self.members {
            if !Arc::ptr_eq(&self.grids[member.grid], &grids[member.grid]) {
                member.robot.look_again();
            }
        }
        self.grids = grids;
        Ok(())
    }

    /// Iterates over the poses of the robots in the map frame, with yaws in (-π, π].
    #[must_use]
    pub fn poses(&self) -> impl ExactSizeIterator<Item = Pose> {
        self.in_order().map(|member| member.pose)
    }

    /// Iterates over the velocities of the robots, each in the robot's own frame.
    #[must_use]
    pub fn velocities(&self) -> impl ExactSizeIterator<Item = Twist> {
        self.in_order().map(|member| member.velocity)
    }

    /// Iterates over the times of the robots since their last reset \[s\].
    #[must_use]
    pub fn times(&self) -> impl ExactSizeIterator<Item = f64> {
        self.in_order().map(Member::time)
    }

    /// Iterates over the seeds of the robots.
    #[must_use]
    pub fn seeds(&self) -> impl ExactSizeIterator<Item = u64> {
        self.in_order().map(|member| member.seed)
    }

    /// Iterates over the indices of the robots' grids.
    #[must_use]
    pub fn grid_of(&self) -> impl ExactSizeIterator<Item = usize> {
        self.in_order().map(|member| member.grid)
    }

    /// Iterates over what a caller is told about each robot after a step.
    #[must_use]
    pub fn reports(&self) -> impl ExactSizeIterator<Item = Report> {
        self.in_order().map(Member::report)
    }

    /// Returns the obstacles.
    #[must_use]
    pub fn obstacles(&self) -> &[FleetObstacle] {
        &self.worlds.obstacles
    }

    /// Replaces obstacles: tuples of the index of an obstacle that is in one world, its shape, and its trajectory from now on, or
    /// `None` if it is not there. If there is an error, nothing has changed.
    ///
    /// # Errors
    /// - [`Error::NoObstacle`]: there is no obstacle with an index.
    /// - [`Error::EachWorld`]: an obstacle is in each world.
    /// - [`Error::Memory`].
    pub fn replace_obstacles(&mut self, changes: Vec<(usize, Shape, Option<Trajectory>)>) -> Result<(), Error> {
        for world in self.worlds.replace(changes)? {
            for member in &mut self.members[self.worlds.all[world].robots.clone()] {
                member.robot.look_again();
            }
        }
        Ok(())
    }

    /// Iterates over the robots in their order.
    fn in_order(&self) -> impl ExactSizeIterator<Item = &Member> {
        self.worlds.place_of.iter().map(|&place| &self.members[place])
    }

    /// Moves all robots for `duration` seconds, each at its command `[vx, vy, wz]` \[m/s, m/s, rad/s\] in its own frame, within
    /// its limits and as far as its wheels and contact let it. Then writes a scan of each robot to `readings`, if they are given.
    ///
    /// For Ackermann drives, a command can also be a speed and a steering angle; see [`DriveCommands`].
    ///
    /// The reading of beam `b` of robot `i` is `readings[i * beam_count + b]`. If there is an error, no robot has moved.
    ///
    /// # Errors
    /// - [`Error::Length`]: `commands` or `readings` has the wrong length.
    /// - [`Error::Command`]: a command is not finite, or larger than [`MAX_COMMAND`].
    /// - [`Error::Steered`]: the commands have steering angles, which the robots do not have.
    /// - [`Error::Number`]: `duration` is not positive, or longer than 10⁶ s, or the time of a world would reach 2⁶² ns.
    /// - Those of [`LaserScanner::scan_batch`](crate::LaserScanner::scan_batch).
    ///
    /// # Panics
    /// If readings are given for a fleet without a scanner.
    pub fn step<'a>(
        &mut self,
        commands: impl Into<DriveCommands<'a>>,
        duration: f64,
        threads: Option<usize>,
        readings: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        let (commands, scans) = (commands.into(), readings.is_some());
        if commands.len() != self.len() {
            return Err(Error::Length { name: "commands", value: commands.len(), needed: self.len() });
        }
        self.check_commands(commands, None)?;
        let duration_ns = check_duration(duration)?;
        let distances = self.distances()?;
        self.make_next()?;
        let watch = Watch::new();
        let Self { grids, options, worlds, members, next } = self;
        let scene_of = |world, members: &[Member]| scene(grids, &distances, options, worlds, world, members[0].grid, &watch);
        let mut rest = &mut next[..];
        let mut crowds = memory::with_room(ROBOTS, worlds.all.len())?;
        for world in &worlds.all {
            let (own, others) = rest.split_at_mut(world.robots.len());
            rest = others;
            crowds.push((world, own));
        }
        let weight = WEIGHT * options.effort() * commands.len().div_ceil(crowds.len());
        for_each_heavy_chunk_watched(&watch, threads, &mut crowds, weight, CHUNK, |_, crowds| {
            // The first look of a robot at the walls near it would wait for memory. All of these looks are made to wait together.
            for (world, _) in crowds.iter() {
                let Member { grid, pose, .. } = members[world.robots.start];
                if let (Some(distances), Some(Cell { col, row })) = (distances.get(grid), grids[grid].cell_at(pose.position))
                {
                    distances.prefetch(col, row);
                }
            }
            for (world, next) in crowds {
                next.copy_from_slice(&members[world.robots.clone()]);
                let (scene, members) = (scene_of(world, next), &mut **next);
                scene.step(members, |robot| Some(Command::of(commands, robot)), duration_ns, &mut None)?;
                scene.look(members)?;
                scene.measure_clearance(members)?;
                if scans {
                    members.iter_mut().for_each(Member::count_scan);
                }
            }
            Ok(())
        })?;
        if let Some(readings) = readings {
            self.scan_members((&self.next, true), |_| true, threads, readings)?;
        }
        std::mem::swap(&mut self.members, &mut self.next);
        Ok(())
    }

    /// Writes the next scan of each chosen robot, as they stand, to `readings`, in their order.
    ///
    /// # Errors
    /// - [`Error::Length`]: `mask` or `readings` has the wrong length.
    /// - Those of [`LaserScanner::scan_batch`](crate::LaserScanner::scan_batch).
    ///
    /// # Panics
    /// If the fleet has no scanner.
    pub fn scan(&mut self, mask: &[bool], threads: Option<usize>, readings: &mut [f32]) -> Result<(), Error> {
        self.check_mask(mask)?;
        self.scan_members((&self.members, false), |robot| mask[robot], threads, readings)?;
        for (place, member) in self.members.iter_mut().enumerate() {
            if mask[self.worlds.order[place]] {
                member.count_scan();
            }
        }
        Ok(())
    }

    /// Puts each chosen robot at a pose, where it stands still. The time of its world begins at 0, unless other robots stay in it.
    ///
    /// A pose that is drawn depends on nothing but the grid, the radius of the footprint, and the seed of the robot with the
    /// number of poses drawn before. If there is an error, nothing has changed.
    ///
    /// # Errors
    /// - [`Error::Length`]: a list does not have one element for each robot of the fleet.
    /// - [`Error::Index`]: a grid does not exist.
    /// - [`Error::Row`]: the pose of a chosen robot is not finite.
    /// - [`Error::Worlds`]: robots of one world would be on different grids.
    /// - Those of [`OccupancyGrid::draw_free_poses`].
    pub fn reset(&mut self, mask: &[bool], reset: Reset<'_>) -> Result<(), Error> {
        self.check_mask(mask)?;
        let lengths = [
            ("poses", reset.poses.map(<[_]>::len)),
            ("seeds", reset.seeds.map(<[_]>::len)),
            ("grids", reset.grids.map(<[_]>::len)),
        ];
        for (name, length) in lengths {
            if let Some(value) = length.filter(|&length| length != self.len()) {
                return Err(Error::Length { name, value, needed: self.len() });
            }
        }
        let Self { grids, options, worlds, members, .. } = self;
        let watch = Watch::new();
        let mut changed: Vec<(usize, Member)> = Vec::new();
        for world in &worlds.all {
            let robots = &worlds.order[world.robots.clone()];
            if !robots.iter().any(|&robot| mask[robot]) {
                continue;
            }
            watch.check()?;
            let is_new = robots.iter().all(|&robot| mask[robot]);
            let time_ns = if is_new { 0 } else { members[world.robots.start].robot.time_ns() };
            let first = changed.len();
            for (place, &robot) in world.robots.clone().zip(robots) {
                let mut member = members[place];
                if mask[robot] {
                    member.begin(robot, time_ns, reset, grids, options)?;
                }
                member.frozen = member.robot.pose_for_others(options.body(robot))?;
                memory::push(ROBOTS, &mut changed, (place, member))?;
            }
            check_crowd(robots, changed[first..].iter().map(|(_, member)| member))?;
        }
        for (place, member) in changed {
            members[place] = member;
        }
        Ok(())
    }

    /// Writes the distance \[m\] and the bearing \[rad\] in (-π, π] of a goal `[x, y]` \[m\] for each chosen robot, seen from it: 0
    /// is straight ahead, positive is to the left. `goals` has a goal for each robot, `seen` a row for each chosen one.
    ///
    /// # Errors
    /// - [`Error::Length`]: a list has another length.
    /// - [`Error::Element`]: the goal of a chosen robot is not finite. Nothing is written.
    pub fn relative(&self, mask: Option<&[bool]>, goals: &[[f64; 2]], seen: &mut [[f64; 2]]) -> Result<(), Error> {
        mask.map_or(Ok(()), |mask| self.check_mask(mask))?;
        let is_chosen = |robot: usize| mask.is_none_or(|mask| mask[robot]);
        let count = mask.map_or(self.len(), |mask| mask.iter().filter(|&&is_chosen| is_chosen).count());
        for (name, value, needed) in [("goals", goals.len(), self.len()), ("out", seen.len(), count)] {
            if value != needed {
                return Err(Error::Length { name, value, needed });
            }
        }
        let chosen = || goals.iter().enumerate().filter(|(robot, _)| is_chosen(*robot));
        for (row, goal) in chosen() {
            if let Some(&value) = goal.iter().find(|number| !number.is_finite()) {
                return Err(Error::Element { name: "goals", row, value, needed: "finite" });
            }
        }
        for ((robot, &goal), seen) in chosen().zip(seen) {
            let pose = self.members[self.worlds.place_of[robot]].pose;
            // The inverse of the pose, applied to the goal, with one rotation for both.
            let turn = rotate(DVec2::X, -pose.yaw);
            let offset = turn.rotate(-pose.position) + turn.rotate(goal.into());
            *seen = [offset.length(), libm::atan2(offset.y, offset.x)];
        }
        Ok(())
    }

    /// Returns the distances of the cells of each grid; none if the robots touch nothing.
    fn distances(&self) -> Result<Vec<Arc<Distances>>, Error> {
        let grids = if self.options.footprint.is_some() { &self.grids[..] } else { &[] };
        grids.iter().map(|grid| grid.distances_of_cells()).collect()
    }

    fn check_mask(&self, mask: &[bool]) -> Result<(), Error> {
        if mask.len() == self.len() {
            Ok(())
        } else {
            Err(Error::Length { name: "mask", value: mask.len(), needed: self.len() })
        }
    }

    /// Makes room for the robots after a step.
    fn make_next(&mut self) -> Result<(), Error> {
        if self.next.is_empty() {
            self.next = memory::collected(ROBOTS, self.members.iter().copied())?;
        }
        Ok(())
    }
}

/// Returns a checked duration \[s\] in nanoseconds.
fn check_duration(duration: f64) -> Result<i64, Error> {
    let is_good = |duration: f64| (1e-9..=MAX_DURATION).contains(&duration);
    Ok(nanoseconds(check_number("duration", duration, "at least 1e-9 and at most 1e6", is_good)?))
}

/// Checks that the robots of a world, with these indices, are at the same time and on the same grid.
fn check_crowd<'a>(robots: &[usize], members: impl Iterator<Item = &'a Member>) -> Result<(), Error> {
    let mut first: Option<&Member> = None;
    for (&robot, member) in robots.iter().zip(members) {
        let first = *first.get_or_insert(member);
        if member.robot.time_ns() != first.robot.time_ns() {
            return Err(Error::Clocks { robot, times: [member.time(), first.time()] });
        }
        if member.grid != first.grid {
            return Err(Error::Worlds { robot: robots[0], other: robot });
        }
    }
    Ok(())
}

/// Returns what does not change during a step of a world.
fn scene<'a>(
    grids: &'a [Arc<OccupancyGrid>],
    distances: &'a [Arc<Distances>],
    options: &'a FleetOptions,
    worlds: &'a Worlds,
    world: &'a FleetWorld,
    grid: usize,
    watch: &'a Watch,
) -> Scene<'a> {
    let distances = distances.get(grid).map(|distances| &**distances);
    Scene { options, worlds, world, grid: &grids[grid], distances, watch }
}
