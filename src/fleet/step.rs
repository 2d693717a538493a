//! One step of a world: its robots move one after another, in time steps, as in the Python class `World`.

use glam::DVec2;

use super::FleetOptions;
use super::command::Command;
use super::member::{Member, Thing};
use super::robot::STEP_NS;
use super::worlds::{FleetObstacle, FleetWorld, Worlds};
use crate::contact::{Search, clearance};
use crate::error::Error;
use crate::free_area::Distances;
use crate::grid::OccupancyGrid;
use crate::interrupt::Watch;
use crate::motion::{FOREVER, seconds};
use crate::obstacles::Obstacles;
use crate::world::World;

/// What does not change during a step of a world.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    pub options: &'a FleetOptions,
    pub worlds: &'a Worlds,
    pub world: &'a FleetWorld,
    pub grid: &'a OccupancyGrid,
    /// Distances of the cells of the grid to its walls; `None` for robots that touch nothing.
    pub distances: Option<&'a Distances>,
    pub watch: &'a Watch,
}

/// What is around the robots of a world at one time: its obstacles, and after them its robots in their order.
#[derive(Debug)]
pub enum Around<'a> {
    /// Obstacles that never move, around a robot that is alone.
    Standing(&'a Obstacles),
    Moving(Obstacles),
}

impl<'a> Scene<'a> {
    /// Returns the indices of the robots of the world in the fleet.
    fn robots(&self) -> &[usize] {
        &self.worlds.order[self.world.robots.clone()]
    }

    /// Moves the robots of the world for a duration \[ns\], each at its command. [`look`](Self::look) then tells where they are.
    ///
    /// `search` is `None` at first. A caller who keeps it for the next step of this world saves time.
    ///
    /// # Errors
    /// - [`Error::Number`]: a pose is not finite, a robot is far too fast, or the time would be too long.
    /// - [`Error::Memory`], [`Error::Interrupted`].
    pub fn step(
        &self,
        members: &mut [Member],
        command_of: impl Fn(usize) -> Option<Command>,
        duration_ns: i64,
        search: &mut Option<Search<'a>>,
    ) -> Result<(), Error> {
        let (options, end_ns) = (self.options, members[0].robot.time_ns() + duration_ns);
        if end_ns >= FOREVER {
            return Err(Error::Number { name: "the time of a world", value: seconds(end_ns), needed: "below 4.6e9 s" });
        }
        for (member, &robot) in members.iter_mut().zip(self.robots()) {
            match command_of(robot) {
                Some(command) => member.robot.command(command, options.body(robot))?,
                None => member.robot.go_on(options.body(robot))?,
            }
            member.touch = None;
        }
        self.move_until(members, end_ns, search)
    }

    /// Computes where the robots of the world are and how they move, and reads their odometers.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn look(&self, members: &mut [Member]) -> Result<(), Error> {
        for (member, &robot) in members.iter_mut().zip(self.robots()) {
            member.look(self.options.body(robot), self.options.odometry_noise_of(robot))?;
        }
        Ok(())
    }

    fn move_until(&self, members: &mut [Member], end_ns: i64, search: &mut Option<Search<'a>>) -> Result<(), Error> {
        if let ([member], Some(standing)) = (&mut *members, &self.world.standing) {
            return self.move_alone(member, self.robots()[0], standing, end_ns, search);
        }
        if self.options.footprint.is_none() {
            for member in members {
                member.robot.pass(end_ns);
            }
            return Ok(());
        }
        let mut around = None;
        while members[0].robot.time_ns() < end_ns {
            if let ([member], Some(distances)) = (&mut *members, self.distances) {
                let now_ns = member.robot.time_ns();
                let free = |position| self.free_of_moving(position, now_ns - now_ns % STEP_NS, end_ns);
                member.robot.skip(end_ns, self.options.body(self.robots()[0]), (self.grid, distances), free)?;
                if member.robot.time_ns() == end_ns {
                    break;
                }
                if member.robot.time_ns() != now_ns {
                    around = None;
                }
            }
            let around = match &mut around {
                Some(around) => around,
                around => around.insert(self.frozen(members)?),
            };
            let (next_ns, is_whole) = next_time(members[0].robot.time_ns(), end_ns);
            if is_whole {
                self.place_obstacles(around, next_ns)?;
            }
            for (place, (member, &robot)) in members.iter_mut().zip(self.robots()).enumerate() {
                self.watch.check()?;
                let index = self.world.obstacles.len() + place;
                let body = self.options.body(robot);
                let world = World { grid: self.grid, obstacles: around, except: Some(index) };
                let mut search = body.footprint.map(|footprint| Search::new(world, footprint));
                let contact = member.robot.advance(next_ns, body, search.as_mut())?;
                if let Some(contact) = contact {
                    member.note(contact, self.thing(contact.obstacle));
                }
                if is_whole {
                    member.frozen = member.robot.pose_for_others(body)?;
                    if let Some(footprint) = body.footprint {
                        around.place(index, footprint, member.frozen)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Moves a robot that meets nothing but walls and obstacles that stand.
    fn move_alone(
        &self,
        member: &mut Member,
        robot: usize,
        standing: &'a Obstacles,
        end_ns: i64,
        search: &mut Option<Search<'a>>,
    ) -> Result<(), Error> {
        let body = self.options.body(robot);
        let Some(footprint) = body.footprint else {
            member.robot.pass(end_ns);
            return Ok(());
        };
        let world = World::from((self.grid, standing));
        while member.robot.time_ns() < end_ns {
            self.watch.check()?;
            if let Some(distances) = self.distances {
                let free = |position: DVec2| {
                    let gaps = standing.bodies().iter().map(|body| {
                        let (middle, reach) = body.bounds();
                        middle.distance(position) - reach
                    });
                    gaps.fold(f64::INFINITY, f64::min)
                };
                member.robot.skip(end_ns, body, (self.grid, distances), free)?;
                if member.robot.time_ns() == end_ns {
                    break;
                }
            }
            let (next_ns, _) = next_time(member.robot.time_ns(), end_ns);
            let contact = if let Some(contact) = member.robot.stay(next_ns) {
                Some(contact)
            } else {
                let search = search.get_or_insert_with(|| Search::new(world, footprint));
                member.robot.advance(next_ns, body, Some(search))?
            };
            if let Some(contact) = contact {
                member.note(contact, self.thing(contact.obstacle));
            }
        }
        Ok(())
    }

    /// Returns what the robots of the world can collide with from now on until the next multiple of the time step.
    fn frozen(&self, members: &[Member]) -> Result<Obstacles, Error> {
        let now_ns = members[0].robot.time_ns();
        let mut around = self.worlds.at(&self.world.obstacles, seconds(now_ns - now_ns % STEP_NS))?;
        if let Some(footprint) = &self.options.footprint {
            for member in members {
                around.place(around.len(), footprint, member.frozen)?;
            }
        }
        Ok(around)
    }

    /// Returns the distance \[m\] from a position in which there is no obstacle between two times \[ns\].
    fn free_of_moving(&self, position: DVec2, from_ns: i64, to_ns: i64) -> f64 {
        let (from, to) = (seconds(from_ns), seconds(to_ns));
        let gaps = self.world.obstacles.iter().filter_map(|&index| {
            let FleetObstacle { shape, trajectory, .. } = &self.worlds.obstacles[index];
            let trajectory = trajectory.as_ref()?;
            Some(trajectory.pose_at(from).position.distance(position) - shape.reach() - trajectory.travel(from, to))
        });
        gaps.fold(f64::INFINITY, f64::min)
    }

    fn place_obstacles(&self, around: &mut Obstacles, time_ns: i64) -> Result<(), Error> {
        for (place, &index) in self.world.obstacles.iter().enumerate() {
            let FleetObstacle { shape, trajectory, .. } = &self.worlds.obstacles[index];
            if let Some(trajectory) = trajectory {
                around.place(place, shape, trajectory.pose_at(seconds(time_ns)))?;
            }
        }
        Ok(())
    }

    /// Returns what the obstacle with an index around the robots is; `None` stands for a wall.
    fn thing(&self, index: Option<usize>) -> Thing {
        let obstacles = &self.world.obstacles;
        match index {
            None => Thing::Wall,
            Some(index) if index < obstacles.len() => Thing::Obstacle(obstacles[index]),
            Some(index) => Thing::Robot(self.robots()[index - obstacles.len()]),
        }
    }

    /// Returns true if nothing ever moves around the only robot of the world.
    pub fn stands(&self) -> bool {
        self.world.standing.is_some() && self.world.robots.len() == 1
    }

    /// Returns what is around the robots of the world now.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn around(&self, members: &[Member]) -> Result<Around<'a>, Error> {
        if let (1, Some(standing)) = (members.len(), &self.world.standing) {
            return Ok(Around::Standing(standing));
        }
        let mut around = self.worlds.at(&self.world.obstacles, members[0].time())?;
        if let Some(footprint) = &self.options.footprint {
            for member in members {
                around.place(around.len(), footprint, member.pose)?;
            }
        }
        Ok(Around::Moving(around))
    }

    /// Returns the world of a robot of the fleet among what is around.
    pub fn world_of<'b>(&'b self, robot: usize, around: &'b Around<'b>) -> World<'b> {
        let place = self.worlds.place_of[robot] - self.world.robots.start;
        match around {
            Around::Standing(standing) => World::from((self.grid, *standing)),
            Around::Moving(around) => {
                World { grid: self.grid, obstacles: around, except: Some(self.world.obstacles.len() + place) }
            }
        }
    }

    /// Measures the distance from each robot of the world to the nearest thing, up to the limit of the options.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn measure_clearance(&self, members: &mut [Member]) -> Result<(), Error> {
        let (Some(limit), Some(footprint)) = (self.options.clearance_limit, &self.options.footprint) else { return Ok(()) };
        let around = self.around(members)?;
        for (member, &robot) in members.iter_mut().zip(self.robots()) {
            self.watch.check()?;
            member.clearance = clearance(self.world_of(robot, &around), footprint, member.pose, limit)?;
        }
        Ok(())
    }
}

/// Returns the end of the time step after a time, at most `end_ns`, and whether it is a multiple of [`STEP_NS`].
fn next_time(time_ns: i64, end_ns: i64) -> (i64, bool) {
    let next_ns = (time_ns / STEP_NS + 1) * STEP_NS;
    (next_ns.min(end_ns), next_ns <= end_ns)
}
