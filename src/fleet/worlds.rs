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
    /// Where it is over the time of its world.
    pub trajectory: Trajectory,
    /// The world it is in; `None` if there is one in each world.
    pub world: Option<u64>,
}

/// Some robots, and the obstacles around them.
#[derive(Debug, Clone)]
pub struct FleetWorld {
    /// Places of its robots in [`Worlds::order`].
    pub robots: Range<usize>,
    /// Indices of its obstacles in the fleet.
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
        let is_in_each = found.obstacles.iter().all(|obstacle| obstacle.world.is_none());
        let mut first = 0;
        while first < count {
            let number = world_of[found.order[first]];
            let robots = found.order[first..].iter().take_while(|&&robot| world_of[robot] == number).count();
            found.world_at.resize(first + robots, found.all.len());
            let robots = first..first + robots;
            first = robots.end;
            let world = match found.all.last() {
                Some(world) if is_in_each => FleetWorld { robots, ..world.clone() },
                _ => {
                    let of_world = |obstacle: &FleetObstacle| obstacle.world.is_none_or(|world| world == number);
                    let indices = found.obstacles.iter().enumerate().filter(|(_, obstacle)| of_world(obstacle));
                    let obstacles: Arc<Vec<usize>> = Arc::new(indices.map(|(index, _)| index).collect());
                    let stand = obstacles.iter().all(|&index| found.obstacles[index].trajectory.is_standing());
                    let standing = if stand { Some(Arc::new(found.at(&obstacles, 0.0)?)) } else { None };
                    FleetWorld { robots, obstacles, standing }
                }
            };
            memory::push(ROBOTS, &mut found.all, world)?;
        }
        Ok(found)
    }

    /// Returns some obstacles at a time \[s\].
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn at(&self, obstacles: &[usize], time: f64) -> Result<Obstacles, Error> {
        Obstacles::new(obstacles.iter().map(|&index| {
            let FleetObstacle { shape, trajectory, .. } = &self.obstacles[index];
            (shape, trajectory.pose_at(time))
        }))
    }
}
