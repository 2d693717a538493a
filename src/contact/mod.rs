//! Contact of a robot's footprint with blocking cells and obstacles.

mod approach;
mod blockers;
mod path;
mod slide;

use glam::DVec2;

use crate::error::{Error, check_number};
use crate::motion::{Twist, integrate};
use crate::pose::{Pose, rotate};
use crate::shape::Shape;
use crate::world::World;
use approach::{Footprint, Hit};
use blockers::Blockers;
use path::Path;

pub use approach::TOLERANCE as CONTACT_TOLERANCE;

/// What contact does to a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactMode {
    /// It stops the robot for the rest of the step.
    #[default]
    Stop,
    /// The robot goes on along what it met.
    Slide,
    /// Nothing: the robot goes through, and the contact is reported.
    Report,
}

/// Where and when a robot met something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// On what it met, in the map frame \[m\].
    pub point: DVec2,
    /// Unit vector of the map frame from what it met to the robot; zero if the robot's origin is inside of it.
    pub normal: DVec2,
    /// Share of the step that was over, 0 to 1.
    pub fraction: f64,
    /// Index of the obstacle; none for a wall of the grid.
    pub obstacle: Option<usize>,
}

/// Whether a footprint at a pose shares a point with a blocking cell or an obstacle, all of them with their edges.
///
/// # Errors
/// A pose that is not finite.
pub fn touches<'a>(world: impl Into<World<'a>>, footprint: &Shape, pose: Pose) -> Result<bool, Error> {
    let (world, mut footprint) = (world.into(), Footprint::new(footprint));
    let pose = world.grid.pose_in_grid(pose.checked()?);
    let blockers = Blockers::around(world, pose.position, footprint.reach());
    Ok(footprint.overlaps(pose, &blockers))
}

/// Distance \[m\] from a footprint at a pose to the nearest blocking cell or obstacle: 0 if they share a point, `limit` if there is
/// none within it.
///
/// # Errors
/// A pose that is not finite, a limit that is not positive.
pub fn clearance<'a>(world: impl Into<World<'a>>, footprint: &Shape, pose: Pose, limit: f64) -> Result<f64, Error> {
    let (world, mut footprint) = (world.into(), Footprint::new(footprint));
    let pose = world.grid.pose_in_grid(pose.checked()?);
    check_number("limit", limit, "positive", |value| value > 0.0)?;
    let mut blockers = Blockers::around(world, pose.position, footprint.reach());
    if footprint.overlaps(pose, &blockers) {
        return Ok(0.0);
    }
    // What is near is found without a look at all that is far.
    let extent = (world.grid.width() + world.grid.height()) as f64 * world.grid.resolution();
    let mut within = (4.0 * world.grid.resolution()).min(limit);
    loop {
        blockers.gather(pose.position, footprint.reach() + within);
        let gap = footprint.gap(pose, &blockers);
        if gap <= within || within >= limit {
            return Ok(gap.min(limit));
        }
        within = if within > extent { limit } else { (2.0 * within).min(limit) };
    }
}

/// Where a robot comes to from `pose` under a constant twist in `dt` seconds, and the first contact on its way.
///
/// The way is the exact arc of [`integrate`]; without contact so is the pose. In mode Stop the robot stops within
/// [`CONTACT_TOLERANCE`] of what it meets, never in it. In mode Slide it goes on for the rest of the step with what is left of its
/// velocity: the linear part loses as little as it takes for no point of contact to be driven into what it met, and keeps its
/// direction in the map while the robot turns on; where nothing will do, as in a corner, it stops turning too. In mode Report
/// nothing holds it.
///
/// A robot that overlaps something at the start is in contact from the start, and moves as the largest smaller copy of itself,
/// scaled about its origin, that does not: it may go away, along or out, but no deeper. One whose origin is inside goes free.
///
/// # Errors
/// A pose, given or reached, or a twist that is not finite, a `dt` that is negative or leads the robot farther than 100000 times its own size.
pub fn advance<'a>(
    world: impl Into<World<'a>>,
    footprint: &Shape,
    pose: Pose,
    twist: Twist,
    dt: f64,
    mode: ContactMode,
) -> Result<(Pose, Option<Contact>), Error> {
    let world = world.into();
    pose.checked()?;
    for (name, value) in ["vx", "vy", "wz"].into_iter().zip(twist.to_array()) {
        check_number(name, value, "finite", |_| true)?;
    }
    check_number("dt", dt, "at least 0", |value| value >= 0.0)?;
    let free = integrate(pose, twist, dt).checked()?;
    let start = world.grid.pose_in_grid(pose);
    let mut footprint = Footprint::new(footprint);
    let mut blockers = Blockers::around(world, start.position, footprint.reach());
    let overlap = if footprint.overlaps(start, &blockers) {
        let Some(shrunk) = shrink(&mut footprint, start, &mut blockers) else {
            return Ok((free, Some(inside(pose, blockers.obstacle_at(start.position)))));
        };
        footprint = shrunk;
        footprint.nearest(start, &blockers).map(|hit| contact(world, &hit, 0.0))
    } else {
        None
    };
    let path = Path::Arc(start, twist);
    let Some(hit) = footprint.first_contact(world, path, dt)? else { return Ok((free, overlap)) };
    let fraction = if dt > 0.0 { hit.time / dt } else { 0.0 };
    let first = overlap.unwrap_or_else(|| contact(world, &hit, fraction));
    let pose = match mode {
        ContactMode::Stop => integrate(pose, twist, hit.time),
        ContactMode::Slide => world.grid.options().origin * slide::slide(&mut footprint, world, path, hit, dt)?,
        ContactMode::Report => free,
    };
    Ok((pose, Some(first)))
}

/// The largest smaller copy of a footprint that overlaps nothing, none if its origin is inside of something.
fn shrink(footprint: &mut Footprint, pose: Pose, blockers: &mut Blockers<'_>) -> Option<Footprint> {
    if blockers.holds(pose.position) {
        return None;
    }
    let (mut free, mut blocked) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (free + blocked);
        if footprint.scaled(middle).overlaps(pose, blockers) { blocked = middle } else { free = middle }
    }
    (free > 0.0).then(|| footprint.scaled(free))
}

/// Halvings of the scale of a footprint that overlaps something: down to a billionth of its size.
const HALVINGS: u32 = 30;

fn contact(world: World<'_>, hit: &Hit, fraction: f64) -> Contact {
    let map_from_grid = world.grid.options().origin;
    let point = map_from_grid.transform_point(hit.point);
    Contact { point, normal: rotate(-hit.toward, map_from_grid.yaw), fraction, obstacle: hit.obstacle }
}

fn inside(pose: Pose, obstacle: Option<usize>) -> Contact {
    Contact { point: pose.position, normal: DVec2::ZERO, fraction: 0.0, obstacle }
}
