//! The worlds of a fleet: which robots share one, and what else is in it.

use std::ops::Range;
use std::sync::Arc;

use super::ROBOTS;
use crate::error::Error;
use crate::memory;
use crate::obstacles::{Obstacles, Trajectory};
use crate::shape::Shape;

/// An obstacle of a fleet.
#[derive(Debug, Clone)]
pub struct FleetObstacle {
    /// Its outline in its own frame.
    pub shape: Shape,
    /// Where it is over the time of its world; `None` if it is not there.
    pub trajectory: Option<Trajectory>,
    /// The world it is in; `None` if there is one in each world.
    pub world: Option<u64>,
}

/// Some robots, and the obstacles around them.
#[derive(Debug, Clone)]
pub struct FleetWorld {
    number: u64,
    /// Indices of its obstacles in the fleet, with those that are not there.
    slots: Arc<Vec<usize>>,
    /// Places of its robots in [`Worlds::order`].
    pub robots: Range<usize>,
    /// Indices of the obstacles in the fleet that are there.
    pub obstacles: Arc<Vec<usize>>,
    /// The obstacles, if none of them ever moves.
    pub standing: Option<Arc<Obstacles>>,
}

/// All worlds of a fleet.
#[derive(Debug, Clone)]
pub struct Worlds {
    /// The robots, world by world.
    pub order: Vec<usize>,
    /// Place of each robot in `order`.
    pub place_of: Vec<usize>,
    /// The worlds, by their numbers.
    pub all: Vec<FleetWorld>,
    /// Index in `all` of the world of the robot at each place.
    pub world_at: Vec<usize>,
    pub obstacles: Vec<FleetObstacle>,
}

impl Worlds {
    /// Returns the worlds of robots with these numbers.
    ///
    /// # Errors
    /// - [`Error::NoWorld`]: an obstacle is in a world without a robot.
    /// - [`Error::Memory`].
    pub fn new(world_of: &[u64], obstacles: Vec<FleetObstacle>) -> Result<Self, Error> {
        let count = world_of.len();
        let mut order = memory::collected(ROBOTS, 0..count)?;
        order.sort_by_key(|&robot| world_of[robot]);
        for (obstacle, of) in obstacles.iter().enumerate() {
            if let Some(world) = of.world
                && order.binary_search_by_key(&world, |&robot| world_of[robot]).is_err()
            {
                return Err(Error::NoWorld { obstacle, world });
            }
        }
        let mut place_of = memory::filled(ROBOTS, 0, count)?;
        order.iter().enumerate().for_each(|(place, &robot)| place_of[robot] = place);
        let world_at = memory::with_room(ROBOTS, count)?;
        let mut found = Self { order, place_of, all: Vec::new(), world_at, obstacles };
        // The obstacles of each world follow those that are in each world.
        let mut slots = memory::collected("the obstacles", 0..found.obstacles.len())?;
        slots.sort_by_key(|&index| found.obstacles[index].world);
        let common = slots.partition_point(|&index| found.obstacles[index].world.is_none());
        let (common, mut own) = slots.split_at(common);
        let mut first = 0;
        while first < count {
            let number = world_of[found.order[first]];
            let robots = found.order[first..].iter().take_while(|&&robot| world_of[robot] == number).count();
            found.world_at.resize(first + robots, found.all.len());
            let robots = first..first + robots;
            first = robots.end;
            let (of_world, others) =
                own.split_at(own.partition_point(|&index| found.obstacles[index].world <= Some(number)));
            own = others;
            let world = match found.all.last() {
                Some(world) if of_world.is_empty() && world.slots.len() == common.len() => {
                    FleetWorld { number, robots, ..world.clone() }
                }
                _ => {
                    let mut slots = [common, of_world].concat();
                    slots.sort_unstable();
                    found.world(FleetWorld {
                        number,
                        slots: Arc::new(slots),
                        robots,
                        obstacles: Arc::default(),
                        standing: None,
                    })?
                }
            };
            memory::push(ROBOTS, &mut found.all, world)?;
        }
        Ok(found)
    }

    /// Returns a world with the obstacles that are there now.
    fn world(&self, world: FleetWorld) -> Result<FleetWorld, Error> {
        let trajectory = |index: &usize| self.obstacles[*index].trajectory.as_ref();
        let obstacles: Vec<usize> = world.slots.iter().copied().filter(|index| trajectory(index).is_some()).collect();
        let stand = obstacles.iter().filter_map(trajectory).all(Trajectory::is_standing);
        let standing = if stand { Some(Arc::new(self.at(&obstacles, 0.0)?)) } else { None };
        Ok(FleetWorld { obstacles: Arc::new(obstacles), standing, ..world })
    }

    /// Replaces the shapes and trajectories of obstacles with these indices, each of which must be in one world. Returns the
    /// indices of the changed worlds in [`all`](Self::all). If there is an error, nothing has changed.
    ///
    /// # Errors
    /// - [`Error::NoObstacle`]: there is no obstacle with an index.
    /// - [`Error::EachWorld`]: an obstacle is in each world.
    /// - [`Error::Memory`].
    pub fn replace(&mut self, changes: Vec<(usize, Shape, Option<Trajectory>)>) -> Result<Vec<usize>, Error> {
        let mut changed = memory::with_room(ROBOTS, changes.len())?;
        for &(obstacle, ..) in &changes {
            let Some(found) = self.obstacles.get(obstacle) else {
                return Err(Error::NoObstacle { obstacle, count: self.obstacles.len() });
            };
            let Some(number) = found.world else { return Err(Error::EachWorld { obstacle }) };
            changed.extend(self.all.binary_search_by_key(&number, |world| world.number));
        }
        changed.sort_unstable();
        changed.dedup();
        let mut swap = changes;
        let mut swap_all = |obstacles: &mut [FleetObstacle]| {
            for (obstacle, shape, trajectory) in &mut swap {
                std::mem::swap(&mut obstacles[*obstacle].shape, shape);
                std::mem::swap(&mut obstacles[*obstacle].trajectory, trajectory);
            }
        };
        swap_all(&mut self.obstacles);
        let worlds: Result<Vec<_>, _> = changed.iter().map(|&world| self.world(self.all[world].clone())).collect();
        match worlds {
            Ok(worlds) => {
                for (&index, world) in changed.iter().zip(worlds) {
                    self.all[index] = world;
                }
                Ok(changed)
            }
            Err(error) => {
                swap_all(&mut self.obstacles);
                Err(error)
            }
        }
    }

    /// Returns some obstacles, all of which are there, at a time \[s\].
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn at(&self, obstacles: &[usize], time: f64) -> Result<Obstacles, Error> {
        Obstacles::new(obstacles.iter().filter_map(|&index| {
            let FleetObstacle { shape, trajectory, .. } = &self.obstacles[index];
            Some((shape, trajectory.as_ref()?.pose_at(time)))
        }))
    }
}
