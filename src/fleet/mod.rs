//! Fleets: many robots that are stepped together, each in a world of its own.

mod member;
mod robot;
mod words;

use std::sync::Arc;

use crate::batch::for_each_heavy_chunk_watched;
use crate::beam_model::BeamModel;
use crate::contact::ContactMode;
use crate::error::{Error, check_number};
use crate::grid::OccupancyGrid;
use crate::interrupt::Watch;
use crate::memory;
use crate::motion::{Limits, Twist, nanoseconds};
use crate::pose::Pose;
use crate::scanner::{LaserScanner, Shot};
use crate::shape::Shape;
use crate::world::World;
use member::Member;
pub use member::Touch;
use robot::Body;
use words::{Reader, Writer};

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

/// What the robots of a fleet are. A list has one element for all robots, or one for each.
#[derive(Debug, Clone)]
pub struct FleetOptions {
    /// Outline of the robots; `None` if they touch nothing.
    pub footprint: Option<Shape>,
    /// What a contact does to the motion.
    pub contact: ContactMode,
    /// Limits on the velocity of the wheels and its change; empty for no limits.
    pub limits: Vec<Limits>,
    /// Share of the commanded motion that slipping wheels lose, in 0..1; empty for none.
    pub slip: Vec<f64>,
    /// The scanner on each robot; `None` for no scans.
    pub scanner: Option<LaserScanner>,
    /// Noise of the ranges; empty for true ranges.
    pub noise: Vec<BeamModel>,
    /// Least free distance \[m\] around the footprint of a robot at a pose that is drawn.
    pub clearance: f64,
}

/// Robots that are stepped together, each alone in a world of its own: one of the grids.
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
///     slip: vec![],
///     scanner: None,
///     noise: vec![],
///     clearance: 0.0,
/// };
/// // Two robots, 2 m and 5 m before the wall, drive at 1 m/s for 3 s. The first one stops 0.5 m before the wall.
/// let mut fleet = Fleet::new(vec![grid], options, &[[5.0, 0.5, 0.0], [2.0, 0.5, 0.0]], &[1, 2], &[0, 0])?;
/// fleet.step(&[[1.0, 0.0, 0.0]; 2], 3.0, None, None)?;
/// let x: Vec<f64> = fleet.poses().map(|pose| pose.position.x).collect();
/// assert!((x[0] - 6.5).abs() < 1e-6 && (x[1] - 5.0).abs() < 1e-12);
/// assert!(fleet.touches().next().expect("a robot").is_some());
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Fleet {
    grids: Vec<Arc<OccupancyGrid>>,
    options: FleetOptions,
    members: Vec<Member>,
    /// Where a step happens, so that nothing changes if it fails.
    next: Vec<Member>,
}

/// The state of some robots of a fleet.
#[derive(Debug, Clone)]
pub struct FleetState {
    /// Indices of the robots in their fleet.
    robots: Vec<usize>,
    members: Vec<Member>,
}

impl FleetState {
    /// Returns the indices of the robots in their fleet.
    #[must_use]
    pub fn robots(&self) -> &[usize] {
        &self.robots
    }

    /// Returns the state as words of 64 bits, the same number for each robot, to store it. Their meaning may change with the
    /// version.
    #[must_use]
    pub fn to_words(&self) -> Vec<u64> {
        let mut words = Writer::default();
        for (&robot, member) in self.robots.iter().zip(&self.members) {
            words.word(robot as u64);
            member.write(&mut words);
        }
        words.0
    }

    /// Returns the state of these words.
    ///
    /// # Errors
    /// - [`Error::State`]: they are not those of a state.
    /// - [`Error::Number`]: a limit is negative.
    pub fn from_words(words: &[u64]) -> Result<Self, Error> {
        let (mut robots, mut members) = (Vec::new(), Vec::new());
        let mut words = Reader(words.iter());
        while !words.0.as_slice().is_empty() {
            memory::push(ROBOTS, &mut robots, words.at_most(u64::from(u32::MAX))? as usize)?;
            memory::push(ROBOTS, &mut members, Member::read(&mut words)?)?;
        }
        Ok(Self { robots, members })
    }
}

/// What [`Fleet::reset`] gives to each robot of the fleet; `None` to leave it to the robot.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reset<'a> {
    /// Poses `[x, y, yaw]` in the map frame \[m, rad\]. Default: drawn from free space.
    pub poses: Option<&'a [[f64; 3]]>,
    /// Seeds of the random streams, which begin anew. Default: the streams go on.
    pub seeds: Option<&'a [u64]>,
    /// Index of the grid of each robot. Default: the grid stays.
    pub grids: Option<&'a [usize]>,
}

impl FleetOptions {
    /// Returns what a robot is.
    fn body(&self, robot: usize) -> Body<'_> {
        Body {
            footprint: self.footprint.as_ref(),
            mode: self.contact,
            limits: of_robot(&self.limits, robot).copied(),
            grip: 1.0 - of_robot(&self.slip, robot).copied().unwrap_or(0.0),
        }
    }

    fn checked(self, count: usize) -> Result<Self, Error> {
        let lengths = [("limits", self.limits.len()), ("slip", self.slip.len()), ("noise", self.noise.len())];
        for (name, length) in lengths {
            if length > 1 && length != count {
                return Err(Error::Length { name, value: length, needed: count });
            }
        }
        for &slip in &self.slip {
            check_number("slip", slip, "in 0..1", |slip| (0.0..=1.0).contains(&slip))?;
        }
        check_number("clearance", self.clearance, "at least 0", |clearance| clearance >= 0.0)?;
        Ok(self)
    }
}

/// Returns the element of a list that has one for all robots, or one for each; `None` if it is empty.
fn of_robot<T>(list: &[T], robot: usize) -> Option<&T> {
    if list.len() == 1 { list.first() } else { list.get(robot) }
}

impl Fleet {
    /// Returns a fleet of robots with these poses `[x, y, yaw]` in the map frame \[m, rad\], seeds and indices of their grids.
    ///
    /// If there are no poses, they are drawn from free space.
    ///
    /// # Errors
    /// - [`Error::Count`]: there is no robot.
    /// - [`Error::Length`]: a list has another length than the seeds.
    /// - [`Error::Index`]: a grid does not exist.
    /// - [`Error::Row`]: a pose is not finite.
    /// - [`Error::Number`]: the slip is not in 0..1, or the clearance is negative or not finite.
    /// - Those of [`OccupancyGrid::draw_free_poses`].
    pub fn new(
        grids: Vec<Arc<OccupancyGrid>>,
        options: FleetOptions,
        poses: &[[f64; 3]],
        seeds: &[u64],
        grid_of: &[usize],
    ) -> Result<Self, Error> {
        let count = seeds.len();
        if count == 0 {
            return Err(Error::Count { name: "the number of robots", value: 0, needed: "at least 1" });
        }
        let options = options.checked(count)?;
        let still = Member::new(options.body(0))?;
        let members = memory::filled(ROBOTS, still, count)?;
        let mut fleet = Self { grids, options, members, next: Vec::new() };
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
        self.grids = grids;
        Ok(())
    }

    /// Iterates over the poses of the robots in the map frame, with yaws in (-π, π].
    #[must_use]
    pub fn poses(&self) -> impl ExactSizeIterator<Item = Pose> {
        self.members.iter().map(|member| member.pose)
    }

    /// Iterates over the velocities of the robots, each in the robot's own frame.
    #[must_use]
    pub fn velocities(&self) -> impl ExactSizeIterator<Item = Twist> {
        self.members.iter().map(|member| member.velocity)
    }

    /// Iterates over what each robot touched first in its last step; `None` for nothing.
    #[must_use]
    pub fn touches(&self) -> impl ExactSizeIterator<Item = Option<Touch>> {
        self.members.iter().map(|member| member.touch)
    }

    /// Iterates over the times of the robots since their last reset \[s\].
    #[must_use]
    pub fn times(&self) -> impl ExactSizeIterator<Item = f64> {
        self.members.iter().map(Member::time)
    }

    /// Iterates over the seeds of the robots.
    #[must_use]
    pub fn seeds(&self) -> impl ExactSizeIterator<Item = u64> {
        self.members.iter().map(|member| member.seed)
    }

    /// Iterates over the indices of the robots' grids.
    #[must_use]
    pub fn grid_of(&self) -> impl ExactSizeIterator<Item = usize> {
        self.members.iter().map(|member| member.grid)
    }

    /// Moves all robots for `duration` seconds, each at its command `[vx, vy, wz]` \[m/s, m/s, rad/s\] in its own frame, within
    /// its limits and as far as contact lets it. Then writes a scan of each robot to `readings`, if they are given.
    ///
    /// The reading of beam `b` of robot `i` is `readings[i * beam_count + b]`. If there is an error, no robot has moved.
    ///
    /// # Errors
    /// - [`Error::Length`]: `commands` or `readings` has the wrong length.
    /// - [`Error::Command`]: a command is not finite, or larger than [`MAX_COMMAND`].
    /// - [`Error::Number`]: `duration` is not positive, or longer than 10⁶ s.
    /// - Those of [`LaserScanner::scan_batch`].
    ///
    /// # Panics
    /// If readings are given for a fleet without a scanner.
    pub fn step(
        &mut self,
        commands: &[[f64; 3]],
        duration: f64,
        threads: Option<usize>,
        readings: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        if commands.len() != self.len() {
            return Err(Error::Length { name: "commands", value: commands.len(), needed: self.len() });
        }
        let is_bad = |command: &[f64; 3]| !command.iter().all(|number| number.abs() <= MAX_COMMAND);
        if let Some(robot) = commands.iter().position(is_bad) {
            return Err(Error::Command { robot, value: commands[robot] });
        }
        let needed = "at least 1e-9 and at most 1e6";
        check_number("duration", duration, needed, |duration| (1e-9..=MAX_DURATION).contains(&duration))?;
        let duration_ns = nanoseconds(duration);
        self.prepare_next()?;
        let watch = Watch::new();
        let Self { grids, options, next, .. } = self;
        for_each_heavy_chunk_watched(&watch, threads, next, WEIGHT, CHUNK, |chunk, members| {
            for (robot, member) in (chunk * CHUNK..).zip(members) {
                let world = World::from(&*grids[member.grid]);
                member.step(commands[robot].into(), duration_ns, options.body(robot), world, &watch)?;
            }
            Ok(())
        })?;
        if let Some(readings) = readings {
            scan(grids, options, next.iter_mut().enumerate(), threads, readings)?;
        }
        std::mem::swap(&mut self.members, &mut self.next);
        Ok(())
    }

    /// Writes the next scan of each chosen robot, as they stand, to `readings`, in their order.
    ///
    /// # Errors
    /// - [`Error::Length`]: `mask` or `readings` has the wrong length.
    /// - Those of [`LaserScanner::scan_batch`].
    ///
    /// # Panics
    /// If the fleet has no scanner.
    pub fn scan(&mut self, mask: &[bool], threads: Option<usize>, readings: &mut [f32]) -> Result<(), Error> {
        self.check_mask(mask)?;
        self.prepare_next()?;
        let Self { grids, options, next, .. } = self;
        let chosen = next.iter_mut().enumerate().filter(|(robot, _)| mask[*robot]);
        scan(grids, options, chosen, threads, readings)?;
        std::mem::swap(&mut self.members, &mut self.next);
        Ok(())
    }

    /// Puts each chosen robot at a pose, where it stands still at time 0.
    ///
    /// A pose that is drawn depends on nothing but the grid, the radius of the footprint, and the seed of the robot with the
    /// number of poses drawn before. If there is an error, nothing has changed.
    ///
    /// # Errors
    /// - [`Error::Length`]: a list does not have one element for each robot of the fleet.
    /// - [`Error::Index`]: a grid does not exist.
    /// - [`Error::Row`]: the pose of a chosen robot is not finite.
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
        self.prepare_next()?;
        let Self { grids, options, next, .. } = self;
        let radius = options.footprint.as_ref().map_or(0.0, Shape::reach) + options.clearance;
        let watch = Watch::new();
        for (robot, member) in next.iter_mut().enumerate().filter(|(robot, _)| mask[*robot]) {
            watch.check()?;
            if let Some(grid) = reset.grids.map(|grids| grids[robot]) {
                if grid >= grids.len() {
                    return Err(Error::Index { name: "grid", robot, value: grid, count: grids.len() });
                }
                member.grid = grid;
            }
            if let Some(seeds) = reset.seeds {
                member.use_seed(seeds[robot]);
            }
            let pose = match reset.poses {
                Some(poses) if !poses[robot].iter().all(|number| number.is_finite()) => {
                    return Err(Error::Row { name: "poses", row: robot, value: poses[robot] });
                }
                Some(poses) => Pose::from(poses[robot]),
                None => member.draw_pose(&grids[member.grid], radius)?,
            };
            member.put(pose, options.body(robot))?;
        }
        std::mem::swap(&mut self.members, &mut self.next);
        Ok(())
    }

    /// Returns the state of the chosen robots.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Memory`].
    pub fn save(&self, mask: &[bool]) -> Result<FleetState, Error> {
        self.check_mask(mask)?;
        let (mut robots, mut members) = (Vec::new(), Vec::new());
        for (robot, member) in self.members.iter().enumerate().filter(|(robot, _)| mask[*robot]) {
            memory::push(ROBOTS, &mut robots, robot)?;
            memory::push(ROBOTS, &mut members, member.clone())?;
        }
        Ok(FleetState { robots, members })
    }

    /// Puts robots into saved states: those that were saved, or those chosen by `mask`, in their order. One saved state can
    /// go to any number of robots.
    ///
    /// # Errors
    /// - [`Error::Length`]: there is neither one state nor one for each of the robots.
    /// - [`Error::Index`]: a saved robot, or the grid of a state, does not exist here.
    pub fn restore(&mut self, state: &FleetState, mask: Option<&[bool]>) -> Result<(), Error> {
        let chosen: Vec<usize> = match mask {
            None => state.robots.clone(),
            Some(mask) => {
                self.check_mask(mask)?;
                (0..self.len()).filter(|&robot| mask[robot]).collect()
            }
        };
        if state.members.len() != 1 && state.members.len() != chosen.len() {
            return Err(Error::Length { name: "the state", value: state.members.len(), needed: chosen.len() });
        }
        let members = || (0..chosen.len()).filter_map(|nth| of_robot(&state.members, nth));
        for (nth, (&robot, member)) in chosen.iter().zip(members()).enumerate() {
            if robot >= self.len() {
                return Err(Error::Index { name: "the place", robot: nth, value: robot, count: self.len() });
            }
            if member.grid >= self.grids.len() {
                return Err(Error::Index { name: "grid", robot, value: member.grid, count: self.grids.len() });
            }
        }
        for (&robot, member) in chosen.iter().zip(members()) {
            self.members[robot].clone_from(member);
        }
        Ok(())
    }

    /// Writes the distance \[m\] and the bearing \[rad\] in (-π, π] of a goal `[x, y]` \[m\] for each robot, seen from it: 0 is
    /// straight ahead, positive is to the left.
    ///
    /// # Errors
    /// [`Error::Length`]: a list does not have one element for each robot.
    pub fn relative(&self, goals: &[[f64; 2]], seen: &mut [[f64; 2]]) -> Result<(), Error> {
        for (name, value) in [("goals", goals.len()), ("out", seen.len())] {
            if value != self.len() {
                return Err(Error::Length { name, value, needed: self.len() });
            }
        }
        for ((member, &goal), seen) in self.members.iter().zip(goals).zip(seen) {
            let offset = member.pose.inverse().transform_point(goal.into());
            *seen = [offset.length(), libm::atan2(offset.y, offset.x)];
        }
        Ok(())
    }

    fn check_mask(&self, mask: &[bool]) -> Result<(), Error> {
        if mask.len() == self.len() {
            Ok(())
        } else {
            Err(Error::Length { name: "mask", value: mask.len(), needed: self.len() })
        }
    }

    fn prepare_next(&mut self) -> Result<(), Error> {
        if self.next.is_empty() {
            self.next = memory::with_room(ROBOTS, self.len())?;
        }
        self.next.clone_from(&self.members);
        Ok(())
    }
}

/// Writes the next scan of each member.
fn scan<'a>(
    grids: &[Arc<OccupancyGrid>],
    options: &FleetOptions,
    members: impl Iterator<Item = (usize, &'a mut Member)>,
    threads: Option<usize>,
    readings: &mut [f32],
) -> Result<(), Error> {
    let scanner = options.scanner.as_ref().expect("a scanner");
    let mut shots = Vec::new();
    for (robot, member) in members {
        let noise = of_robot(&options.noise, robot).map(|model| (model, member.seed, member.scans));
        member.scans = member.scans.wrapping_add(1);
        let world = World::from(&*grids[member.grid]);
        memory::push(ROBOTS, &mut shots, Shot { world, map_from_base: member.pose, noise })?;
    }
    scanner.scan_each(&shots, threads, readings)
}
