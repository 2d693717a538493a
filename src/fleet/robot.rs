//! One robot of a fleet: how it moves under commands, limits and contact.
//!
//! The trajectory is that of a robot of the Python class `Simulation`, to the last bit: exact under a constant command, and
//! with contact looked for in time steps of [`STEP_NS`], which end at multiples of it and at each command.

use glam::DVec2;

use super::command::Command;
use super::words::{Reader, Writer};
use crate::contact::{Contact, ContactMode, MARGIN, Search, top_speed};
use crate::error::Error;
use crate::free_area::Distances;
use crate::grid::{Cell, OccupancyGrid};
use crate::motion::{Drive, FOREVER, Limits, MAX_WHEELS, Profile, SteeringProfile, Twist, nanoseconds, seconds};
use crate::pose::{Pose, rotate};
use crate::shape::Shape;

/// Time step in which contact is looked for \[ns\].
pub const STEP_NS: i64 = 20_000_000;

/// Turn in a time step \[rad\] up to which the twist between two poses is unique. It must be below π.
const LARGEST_TURN: f64 = 3.0;

/// What a robot is, as far as it matters for its motion.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a> {
    /// Outline of the robot; `None` if it touches nothing.
    pub footprint: Option<&'a Shape>,
    /// What a contact does to the motion.
    pub mode: ContactMode,
    /// Limits on the velocity of the wheels and its change; `None` for no limits.
    pub limits: Option<&'a Limits>,
    /// Share of the motion of the wheels that the robot makes: 1 without slip.
    pub grip: f64,
    /// The wheels of the robot; `None` if it moves in any direction.
    pub drive: Option<&'a Drive>,
}

/// The motion of a robot up to the present.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot {
    /// Time in the robot's world \[ns\].
    time_ns: i64,
    /// Pose of the odometry frame in the map: the first pose of the robot.
    map_from_odom: Pose,
    /// Cosine and sine of the yaw of that pose, which are needed in each step.
    heading: DVec2,
    /// Pose in the odometry frame at the start of the profile.
    start: Pose,
    /// Velocity of the wheels from the last change of velocity on.
    profile: Profile,
    /// How the wheels steer since the last command; `None` without a drive.
    steering: Option<SteeringProfile>,
    /// Angle by which each wheel had turned at the start of the profile \[rad\]; 0 without a drive.
    rolled: [f64; MAX_WHEELS],
    /// The velocity of the last command. A robot that is blocked does not follow it.
    requested: Twist,
    /// True if contact keeps the robot from following its command.
    is_blocked: bool,
    /// Pose in the map frame to which contact moved the robot at the present; `None` if the profile tells it.
    reached: Option<Pose>,
    /// Pose in the odometry frame, at the start of the profile, of wheels that never slipped; `None` without slip.
    wheels: Option<Pose>,
    /// Pose in the odometry frame at the present, if it has been computed.
    here: Option<Pose>,
    /// The contact of the last time step and its duration \[ns\], if the robot stands pressed against something. The next step of the
    /// same duration has the same contact, as long as the command and the world do not change.
    stuck: Option<(Contact, i64)>,
}

/// What the joints of a robot on wheels do at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joints {
    /// Angle by which each wheel has turned \[rad\].
    pub rolled: [f64; MAX_WHEELS],
    /// Rate of each wheel \[rad/s\].
    pub wheel_rates: [f64; MAX_WHEELS],
    /// Steering angle of the robot \[rad\].
    pub angle: f64,
    /// Rate of change of the steering angle \[rad/s\].
    pub rate: f64,
}

/// A time step with contact. Poses are in the map frame.
struct Step {
    start_ns: i64,
    end_ns: i64,
    duration: f64,
    start: Pose,
    reached: Pose,
    /// Velocity that the robot would have in the step without contact.
    twist: Twist,
}

impl Robot {
    /// Returns a robot that stands at a pose in the map frame from a time \[ns\] on.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn new(map_from_base: Pose, time_ns: i64, body: Body<'_>) -> Result<Self, Error> {
        let steering = body.drive.map(|_| SteeringProfile::straight(time_ns));
        let profile =
            Profile { limits: body.limits.copied(), steering, ..Profile::constant(Twist::default(), time_ns, time_ns) };
        let map_from_odom = map_from_base.checked()?;
        Ok(Self {
            time_ns,
            map_from_odom,
            heading: rotate(DVec2::X, map_from_odom.yaw),
            start: Pose::default(),
            profile,
            steering,
            rolled: [0.0; MAX_WHEELS],
            requested: Twist::default(),
            is_blocked: false,
            reached: None,
            wheels: (body.grip != 1.0).then_some(Pose::default()),
            here: None,
            stuck: None,
        })
    }

    /// Writes the robot as words.
    pub fn write(&self, words: &mut Writer) {
        words.word(self.time_ns.unsigned_abs());
        words.numbers(self.map_from_odom.to_array());
        words.numbers(self.start.to_array());
        words.profile(&self.profile);
        words.steering(self.steering.as_ref());
        words.numbers(self.rolled);
        words.numbers(self.requested.to_array());
        words.word(u64::from(self.is_blocked));
        words.option(self.reached.map(Pose::to_array));
        words.option(self.wheels.map(Pose::to_array));
        words.option(self.here.map(Pose::to_array));
    }

    /// Returns the robot that was written.
    ///
    /// # Errors
    /// [`Error::State`]: the words are not those of a robot.
    pub fn read(words: &mut Reader<'_>) -> Result<Self, Error> {
        let (time_ns, map_from_odom) = (words.time_ns()?, words.pose()?);
        Ok(Self {
            time_ns,
            map_from_odom,
            heading: rotate(DVec2::X, map_from_odom.yaw),
            start: words.pose()?,
            profile: words.profile()?,
            steering: words.steering()?,
            rolled: words.numbers()?,
            requested: words.twist()?,
            is_blocked: words.flag()?,
            reached: words.option()?.map(Pose::from),
            wheels: words.option()?.map(Pose::from),
            here: words.option()?.map(Pose::from),
            stuck: None,
        })
    }

    /// Returns the time in the robot's world \[ns\].
    pub fn time_ns(&self) -> i64 {
        self.time_ns
    }

    /// Checks that the robot, as it was read, can be one with this drive.
    ///
    /// # Errors
    /// [`Error::State`]: it steers as no robot with this drive does.
    pub fn check_drive(&self, drive: Option<&Drive>) -> Result<(), Error> {
        let can_steer = |profile: &SteeringProfile| drive.is_some_and(|drive| profile.steering.of(drive).is_ok());
        let steers = [&self.profile.steering, &self.steering].into_iter().flatten().all(can_steer);
        if steers && self.steering.is_some() == drive.is_some() {
            Ok(())
        } else {
            Err(Error::State { problem: "a steering angle that the drive cannot have" })
        }
    }

    /// Returns the wheels now; `None` without a drive.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn joints(&self, body: Body<'_>) -> Result<Option<Joints>, Error> {
        let (Some(steering), Some(drive)) = (&self.steering, body.drive) else { return Ok(None) };
        let (angle, rate) = (steering.angle_at(self.time_ns, drive)?, steering.rate_at(self.time_ns, drive)?);
        let wheel_rates = drive.wheels(self.profile.velocity_at(self.time_ns, body.drive)?, angle);
        let rolled = self.rolled_at(self.time_ns, steering, drive)?;
        Ok(Some(Joints { rolled, wheel_rates, angle, rate }))
    }

    /// Returns the pose in the map frame now.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn map_pose(&mut self, body: Body<'_>) -> Result<Pose, Error> {
        let here = self.pose(self.time_ns, body)?;
        self.here = Some(here);
        Ok(self.in_map(here))
    }

    /// Returns the pose in the map frame that others can collide with.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn pose_for_others(&self, body: Body<'_>) -> Result<Pose, Error> {
        match self.reached {
            Some(reached) => Ok(reached),
            None => Ok(self.in_map(self.pose(self.time_ns, body)?)),
        }
    }

    /// Returns the pose in the odometry frame of wheels that never slipped, now.
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn wheels_now(&self, body: Body<'_>) -> Result<Pose, Error> {
        self.wheel_pose(self.time_ns, body)
    }

    /// Moves the robot, which can touch nothing, to a time \[ns\].
    pub fn pass(&mut self, end_ns: i64) {
        (self.time_ns, self.here) = (end_ns, None);
    }

    /// Moves the robot towards a time \[ns\] without a look for contact, as long as it can meet no wall and no obstacle.
    ///
    /// `distances` are those of the grid. Given a position, `to_obstacles` returns the distance \[m\] in which there is no
    /// obstacle until `end_ns`. The robot ends at `end_ns` or at a multiple of [`STEP_NS`].
    ///
    /// # Errors
    /// [`Error::Number`]: the pose is not finite.
    pub fn skip(
        &mut self,
        end_ns: i64,
        body: Body<'_>,
        (grid, distances): (&OccupancyGrid, &Distances),
        to_obstacles: impl Fn(DVec2) -> f64,
    ) -> Result<(), Error> {
        let (Some(footprint), false) = (body.footprint, self.is_blocked) else { return Ok(()) };
        let position = self.map_pose(body)?.position;
        let at = grid.to_cells(position);
        let Some(Cell { col, row }) = grid.cell_around(at) else { return Ok(()) };
        let speed = top_speed([self.profile.velocity, self.profile.command]);
        // In each time step a robot follows an arc between two poses of its path, which is less than twice as long as the path.
        let reach = footprint.reach() + MARGIN + speed * seconds(STEP_NS);
        let needed = reach + speed * seconds(end_ns - self.time_ns);
        let resolution = grid.resolution();
        let to_walls = if distances.is_clear(col, row, needed / resolution) {
            needed
        } else {
            distances.clearance(at, needed / resolution) * resolution
        };
        let free = to_walls.min(to_obstacles(position));
        let free_ns = if free < needed {
            let safe_ns = self.time_ns + nanoseconds(((free - reach) / speed).max(0.0));
            safe_ns - safe_ns % STEP_NS
        } else {
            end_ns
        };
        if free_ns > self.time_ns {
            (self.time_ns, self.reached, self.here) = (free_ns, None, None);
        }
        Ok(())
    }

    /// Returns the velocity in the robot's own frame now.
    ///
    /// # Errors
    /// [`Error::Number`]: the velocity is not finite.
    pub fn velocity(&self, body: Body<'_>) -> Result<Twist, Error> {
        Ok(self.profile.velocity_at(self.time_ns, body.drive)?.scaled(body.grip))
    }

    /// Commands the robot from now on; its wheels, limits and contact decide what it does.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn command(&mut self, command: Command, body: Body<'_>) -> Result<(), Error> {
        let (Some(before), Some(drive)) = (self.steering, body.drive) else {
            return match command {
                Command::Move(velocity) => self.follow(velocity, body),
                Command::Steer { speed, .. } => self.follow(Twist::from([speed, 0.0, 0.0]), body),
            };
        };
        let (velocity, goal, rate) = match command {
            Command::Move(wanted) => {
                let (velocity, goal) = drive.command(wanted, before.steering.goal);
                (velocity, goal, f64::INFINITY)
            }
            Command::Steer { speed, angle, rate } => (Twist::from([speed, 0.0, 0.0]), angle, rate),
        };
        let steering = before.towards(goal, rate, self.time_ns, drive)?;
        if steering != before {
            (self.steering, self.stuck) = (Some(steering), None);
        }
        self.follow(velocity, body)
    }

    /// Goes on at the last command.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn go_on(&mut self, body: Body<'_>) -> Result<(), Error> {
        self.follow(self.requested, body)
    }

    /// Requests a velocity of the wheels from now on.
    fn follow(&mut self, velocity: Twist, body: Body<'_>) -> Result<(), Error> {
        if velocity != self.requested {
            (self.requested, self.stuck) = (velocity, None);
        }
        let steers_as_before = self.profile.steering.is_none() || self.profile.steering == self.steering;
        let goes_on = velocity == self.profile.command && self.time_ns < self.profile.until_ns && steers_as_before;
        if self.is_blocked || goes_on {
            return Ok(());
        }
        let profile = self.following(self.time_ns, body)?;
        self.begin(profile, None, body)
    }

    /// Forgets what the robot is pressed against, because its world may be another one from now on.
    pub fn look_again(&mut self) {
        self.stuck = None;
    }

    /// Takes a time step that ends at a time \[ns\] and in which nothing changes: the robot stands pressed against something, in a
    /// world that stands. Returns its contact, or `None` if it has to be moved.
    pub fn stay(&mut self, end_ns: i64) -> Option<Contact> {
        let (contact, duration_ns) = self.stuck?;
        if end_ns - self.time_ns != duration_ns {
            return None;
        }
        self.time_ns = end_ns;
        Some(contact)
    }

    /// Moves the robot to a time \[ns\] at most [`STEP_NS`] after the present. Returns its first contact on the way.
    ///
    /// `search` looks for contacts of the body in the world of the robot; `None` if it touches nothing.
    ///
    /// # Errors
    /// - [`Error::Number`]: a pose is not finite, or the robot is far too fast.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn advance(
        &mut self,
        end_ns: i64,
        body: Body<'_>,
        search: Option<&mut Search<'_>>,
    ) -> Result<Option<Contact>, Error> {
        let start_ns = self.time_ns;
        let Some(search) = search else {
            self.pass(end_ns);
            return Ok(None);
        };
        let profile = if self.is_blocked { self.following(start_ns, body)? } else { self.profile };
        let start = self.pose_for_others(body)?;
        (self.here, self.stuck) = (None, None);
        let duration = seconds(end_ns - start_ns);
        let twist = self.twist(&profile, start, (start_ns, end_ns), body)?;
        let (reached, contact) = search.advance(start, twist, duration, body.mode)?;
        self.time_ns = end_ns;
        if let Some(contact) = contact {
            self.reached = Some(reached);
            if body.mode != ContactMode::Report {
                self.is_blocked = true;
                self.begin_after_contact(&Step { start_ns, end_ns, duration, start, reached, twist }, contact, body)?;
            }
        } else {
            // Without contact, the profile tells the pose.
            self.reached = None;
            if self.is_blocked {
                self.is_blocked = false;
                self.begin(profile, None, body)?;
            }
        }
        Ok(contact)
    }

    /// Returns a pose of the odometry frame in the map frame: the product of both poses.
    fn in_map(&self, pose: Pose) -> Pose {
        let Self { map_from_odom: Pose { position, yaw }, heading, .. } = self;
        Pose { position: position + heading.rotate(pose.position), yaw: yaw + pose.yaw }
    }

    /// Returns the pose in the odometry frame at a time \[ns\] from the start of the profile on.
    fn pose(&self, time_ns: i64, body: Body<'_>) -> Result<Pose, Error> {
        if let Some(here) = self.here.filter(|_| time_ns == self.time_ns) {
            return Ok(here);
        }
        self.profile.move_from(self.start, time_ns, body.grip, body.drive)
    }

    /// Returns the pose in the odometry frame of wheels that never slipped, at a time \[ns\].
    fn wheel_pose(&self, time_ns: i64, body: Body<'_>) -> Result<Pose, Error> {
        self.wheels
            .map_or_else(|| self.pose(time_ns, body), |wheels| self.profile.move_from(wheels, time_ns, 1.0, body.drive))
    }

    /// Returns the profile of a robot that follows its command from a time \[ns\] on.
    fn following(&self, time_ns: i64, body: Body<'_>) -> Result<Profile, Error> {
        Ok(Profile {
            start_ns: time_ns,
            velocity: self.profile.ramp_velocity_at(time_ns, body.drive)?,
            command: self.requested,
            until_ns: FOREVER,
            limits: body.limits.copied(),
            steering: self.steering,
        })
    }

    /// Returns the angle by which each wheel has turned at a time \[ns\], in radians.
    fn rolled_at(&self, time_ns: i64, steering: &SteeringProfile, drive: &Drive) -> Result<[f64; MAX_WHEELS], Error> {
        let angle = steering.angle_at(self.profile.start_ns, drive)?;
        let since = self.profile.rolled(time_ns, drive, angle)?;
        Ok(std::array::from_fn(|wheel| self.rolled[wheel] + since[wheel]))
    }

    /// Begins a profile at `pose` in the odometry frame. Default: the pose of the robot.
    fn begin(&mut self, profile: Profile, pose: Option<Pose>, body: Body<'_>) -> Result<(), Error> {
        let time_ns = profile.start_ns;
        if let (Some(steering), Some(drive)) = (&self.steering, body.drive) {
            self.rolled = self.rolled_at(time_ns, steering, drive)?;
        }
        let wheels = if self.wheels.is_some() { Some(self.wheel_pose(time_ns, body)?) } else { None };
        let start = match pose {
            Some(pose) => pose,
            None => self.pose(time_ns, body)?,
        };
        let start = start.wrapped();
        let here = (time_ns == self.time_ns).then_some(start);
        (self.profile, self.wheels, self.start, self.here) = (profile, wheels, start, here);
        Ok(())
    }

    /// Returns the constant velocity of the robot that moves it in a time step, from a pose in the map frame, as the profile
    /// does.
    fn twist(&self, profile: &Profile, start: Pose, (from, to): (i64, i64), body: Body<'_>) -> Result<Twist, Error> {
        let first = profile.velocity_at(from, body.drive)?;
        if profile.is_constant(body.drive) {
            return Ok(first.scaled(body.grip));
        }
        let last = profile.velocity_at(to, body.drive)?;
        if first == last {
            return Ok(first.scaled(body.grip));
        }
        let duration = seconds(to - from);
        if first.angular.abs().max(last.angular.abs()) * duration > LARGEST_TURN {
            let mean = Twist { linear: 0.5 * (first.linear + last.linear), angular: 0.5 * (first.angular + last.angular) };
            return Ok(mean.scaled(body.grip));
        }
        let begun = if self.is_blocked { self.pose(from, body)? } else { self.start };
        Ok(Twist::between(start, self.in_map(profile.move_from(begun, to, body.grip, body.drive)?), duration))
    }

    /// Begins the profiles of a step in which contact stopped or deflected the robot.
    fn begin_after_contact(&mut self, step: &Step, contact: Contact, body: Body<'_>) -> Result<(), Error> {
        let end = self.map_from_odom.inverse() * step.reached;
        let standing = |time_ns| Profile::constant(Twist::default(), time_ns, time_ns);
        if body.mode == ContactMode::Stop && contact.fraction > 0.0 {
            let stopped_ns = step.start_ns + (contact.fraction * (step.end_ns - step.start_ns) as f64) as i64;
            self.begin(Profile::constant(of_wheels(step.twist, body), step.start_ns, stopped_ns), None, body)?;
            self.begin(standing(step.end_ns), Some(end), body)
        } else if step.reached == step.start {
            let is_moving = self.profile.velocity_at(step.start_ns, body.drive)? != Twist::default();
            if is_moving || self.profile.limits.is_some() {
                return self.begin(standing(step.start_ns), None, body);
            }
            // Wheels that still steer may lead the robot away.
            let steering = self.steering.as_ref().zip(body.drive);
            let steers = steering.map_or(Ok(0.0), |(steering, drive)| steering.rate_at(step.start_ns, drive))? != 0.0;
            self.stuck = (!steers).then_some((contact, step.end_ns - step.start_ns));
            Ok(())
        } else {
            // The robot slides along the contact, or drives out of an obstacle that moved onto it.
            let velocity = of_wheels(Twist::between(step.start, step.reached, step.duration), body);
            self.begin(Profile::constant(velocity, step.start_ns, step.end_ns), None, body)?;
            self.begin(Profile::constant(velocity, step.end_ns, FOREVER), Some(end), body)
        }
    }
}

/// Returns the velocity of the wheels when the robot moves at a velocity. Without grip, that of the robot.
fn of_wheels(velocity: Twist, body: Body<'_>) -> Twist {
    if body.grip == 0.0 { velocity } else { velocity.scaled(1.0 / body.grip) }
}
