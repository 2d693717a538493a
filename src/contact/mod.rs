//! Contact between a robot's footprint and blocking cells or obstacles: overlap, clearance, and motion until contact.
//!
//! Internally everything is in the frame of the grid, in metres from its corner. Poses, points and normals that go in or
//! come out are in the map frame.

mod approach;
mod blockers;
mod path;
mod slide;

use glam::DVec2;

use crate::batch::{check_rows, for_each_chunk};
use crate::error::{Error, check_finite, check_number};
use crate::motion::{Twist, integrate};
use crate::pose::{Pose, rotate};
use crate::shape::Shape;
use crate::world::World;
use approach::{Failure, Footprint, Hit};
use blockers::Blockers;
use path::Path;

pub use approach::TOLERANCE as CONTACT_TOLERANCE;

/// How a robot moves after its first contact in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactMode {
    /// The robot stands still for the rest of the step.
    #[default]
    Stop,
    /// The robot continues along the wall or obstacle, with the part of its velocity that does not press into it.
    Slide,
    /// The robot continues through the wall or obstacle as if it were not there. The contact is only reported.
    Report,
}

/// Where and when a footprint first met a blocking cell or an obstacle.
///
/// ```text
///   footprint                 wall or obstacle
///   +--------+                 |///////
///   |        |     normal      |///////
///   |   o    |        <--------x point
///   |        |                 |///////
///   +--------+                 |///////
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The point of contact, on the wall or obstacle, in the map frame \[m\].
    pub point: DVec2,
    /// Unit vector in the map frame from the wall or obstacle towards the footprint; zero if it contains the robot's origin.
    pub normal: DVec2,
    /// Time of the contact as a fraction of the step, from 0 to 1.
    pub fraction: f64,
    /// Index of the obstacle in [`Obstacles`](crate::Obstacles); `None` for a blocking cell of the grid.
    pub obstacle: Option<usize>,
}

impl Contact {
    /// Returns the contact if its numbers are in their domains.
    ///
    /// # Errors
    /// [`Error::Number`]: a point or normal that is not finite, a normal longer than 1, or a fraction outside 0 to 1.
    pub fn checked(self) -> Result<Self, Error> {
        check_finite("point x", self.point.x)?;
        check_finite("point y", self.point.y)?;
        check_finite("normal x", self.normal.x)?;
        check_finite("normal y", self.normal.y)?;
        // Rounding may make a unit vector a little longer.
        check_number("length of normal", self.normal.length(), "at most 1", |length| length <= 1.0 + 1e-9)?;
        check_number("fraction", self.fraction, "in 0..1", |fraction| (0.0..=1.0).contains(&fraction))?;
        Ok(self)
    }
}

/// Returns true if a footprint at a pose shares a point with a blocking cell or an obstacle.
///
/// Edges count: two outlines that only touch share a point. `pose` is that of the footprint's frame in the map frame.
///
/// # Errors
/// - [`Error::Number`]: the pose is not finite.
/// - [`Error::Memory`]: there is not enough memory for the cells and obstacles near the footprint.
pub fn touches<'a>(world: impl Into<World<'a>>, footprint: &Shape, pose: Pose) -> Result<bool, Error> {
    let (world, mut footprint) = (world.into(), Footprint::new(footprint));
    let pose = world.grid.pose_in_grid(pose.checked()?);
    let blockers = Blockers::around(world, pose.position, footprint.reach())?;
    Ok(footprint.overlaps(pose, &blockers))
}

/// Returns true if a quick look shows that a robot touches nothing for `duration` seconds. False means that it may.
///
/// During this time, each component of its velocity must lie between those of `twists`, or between zero and one of them. `pose`
/// is its pose at the start in the map frame.
///
/// # Errors
/// [`Error::Number`]: the pose is not finite.
pub fn stays_clear<'a>(
    world: impl Into<World<'a>>,
    footprint: &Shape,
    pose: Pose,
    twists: [Twist; 2],
    duration: f64,
) -> Result<bool, Error> {
    /// Farthest look in cells, so that a look is cheap.
    const LIMIT: f64 = 100.0;
    let world = world.into();
    let center = world.grid.pose_in_grid(pose.checked()?).position;
    // A time step follows an arc between two poses of the path, which may be longer than the path, but not twice as long.
    let radius = footprint.reach() + MARGIN + 2.0 * top_speed(twists) * duration;
    Ok(radius <= LIMIT * world.grid.resolution() && Blockers::is_empty_around(world, center, radius))
}

/// Distance \[m\] by which a footprint must miss everything if nobody looks for contact: far more than the tolerance of a
/// contact.
pub(crate) const MARGIN: f64 = 1e-3;

/// Returns a speed \[m/s\] that a robot does not exceed whose velocity is between `twists`.
pub(crate) fn top_speed([before, after]: [Twist; 2]) -> f64 {
    before.linear.abs().max(after.linear.abs()).length()
}

/// Returns the distance \[m\] between a footprint at a pose and the nearest blocking cell or obstacle.
///
/// The distance is 0 if they share a point, and `limit` \[m\] if nothing is nearer than that. `pose` is that of the
/// footprint's frame in the map frame.
///
/// # Errors
/// - [`Error::Number`]: the pose is not finite, or `limit` is not positive and finite.
/// - [`Error::Memory`]: as in [`touches`].
pub fn clearance<'a>(world: impl Into<World<'a>>, footprint: &Shape, pose: Pose, limit: f64) -> Result<f64, Error> {
    pose.checked()?;
    check_limit(limit)?;
    distance(world.into(), &mut Footprint::new(footprint), pose, limit)
}

/// Writes the [`clearance`] \[m\] of a footprint at each pose `[x, y, yaw]` \[m, rad\] to `distances`.
///
/// The work is shared by `threads` threads, by default as many as there are cores. The distances do not depend on it.
///
/// # Errors
/// - [`Error::Row`]: a pose is not finite.
/// - [`Error::Length`]: `distances` does not have one element for each pose.
/// - [`Error::Number`]: `limit` is not positive and finite.
/// - [`Error::Count`]: `threads` is 0 or more than 1024.
/// - [`Error::Threads`]: the system could not start the threads.
/// - [`Error::Memory`]: as in [`touches`].
pub fn clearance_batch<'a>(
    world: impl Into<World<'a>>,
    footprint: &Shape,
    poses: &[[f64; 3]],
    limit: f64,
    threads: Option<usize>,
    distances: &mut [f64],
) -> Result<(), Error> {
    /// Number of poses that one thread works on at a time.
    const CHUNK: usize = 64;
    let world = world.into();
    check_rows("poses", poses, threads)?;
    check_limit(limit)?;
    if distances.len() != poses.len() {
        return Err(Error::Length { name: "out", value: distances.len(), needed: poses.len() });
    }
    for_each_chunk(threads, distances, CHUNK, |chunk, distances| {
        let mut footprint = Footprint::new(footprint);
        for (to, &pose) in distances.iter_mut().zip(&poses[chunk * CHUNK..]) {
            *to = distance(world, &mut footprint, pose.into(), limit)?;
        }
        Ok(())
    })
}

fn check_limit(limit: f64) -> Result<f64, Error> {
    check_number("limit", limit, "positive", |value| value > 0.0)
}

/// Returns the clearance of a footprint at a finite pose in the map frame.
fn distance(world: World<'_>, footprint: &mut Footprint, pose: Pose, limit: f64) -> Result<f64, Error> {
    let pose = world.grid.pose_in_grid(pose);
    let mut blockers = Blockers::around(world, pose.position, footprint.reach())?;
    if footprint.overlaps(pose, &blockers) {
        return Ok(0.0);
    }
    // Search near the footprint first and double the distance until something is found: most clearances are short.
    let extent = (world.grid.width() + world.grid.height()) as f64 * world.grid.resolution();
    let mut within = (4.0 * world.grid.resolution()).min(limit);
    loop {
        blockers.gather(pose.position, footprint.reach() + within)?;
        let gap = footprint.gap(pose, &blockers);
        if gap <= within || within >= limit {
            return Ok(gap.min(limit));
        }
        within = if within > extent { limit } else { (2.0 * within).min(limit) };
    }
}

/// Returns the pose that a robot reaches after `dt` seconds under a constant twist, and its first contact, if any.
///
/// `pose` is that of the robot in the map frame \[m, rad\]; `twist` is in the robot's own frame \[m/s, rad/s\]. The path is
/// the exact arc of [`integrate`]. Without contact the result equals that of `integrate`, to the last bit.
///
/// ```text
///        Stop                  Slide                 Report
///          |//                  ^ |//                   |//
///          |//                 /  |//                   |//   ,o
///          |//                 |  |//                   |// ,'
///        o |//                 o  |//                   |o'//
///      ,'  |//               ,'   |//                 ,'|//
///    ,'    |//             ,'     |//               ,'  |//
/// ```
///
/// - [`Stop`](ContactMode::Stop): the robot stops within [`CONTACT_TOLERANCE`] of the wall or obstacle and does not overlap
///   it.
/// - [`Slide`](ContactMode::Slide): the robot uses the rest of the step to move along it. Its linear velocity becomes the
///   nearest one that moves no contact point into a wall or obstacle, and is constant in the map frame; the robot keeps
///   turning at the commanded rate. If no such velocity exists, as in a corner, it stops turning as well.
/// - [`Report`](ContactMode::Report): the robot reaches the end of the arc.
///
/// A robot that overlaps something at the start is in contact at fraction 0. It then moves as the largest copy of itself,
/// scaled about its origin, that overlaps nothing: it can move away or along, but not deeper. If its origin is inside a
/// blocking cell or an obstacle there is no such copy; the robot then moves freely, and the contact has a zero normal.
///
/// Method: conservative advancement (Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*, 1996).
///
/// ```
/// use mobile_robot_simulator::{
///     ContactMode, GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, Shape, Twist, Unknown, advance,
/// };
///
/// // A row of ten cells of 1 m; the cell from x = 7 m to x = 8 m is occupied.
/// let mut cells = vec![0; 10];
/// cells[7] = 100;
/// let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
/// let grid =
///     OccupancyGrid::new(cells, 10, GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free })?;
///
/// // A disc of radius 0.5 m drives ahead from x = 2 m at 1 m/s for 10 s. It stops at x = 6.5 m after 4.5 s.
/// let (disc, start, ahead) = (Shape::disc(0.5)?, Pose::new(2.0, 0.5, 0.0), Twist::from([1.0, 0.0, 0.0]));
/// let (end, contact) = advance(&grid, &disc, start, ahead, 10.0, ContactMode::Stop)?;
/// let contact = contact.expect("a contact with the wall");
/// assert!((end.position.x - 6.5).abs() <= 1e-6 && (contact.fraction - 0.45).abs() <= 1e-6);
/// assert_eq!(contact.normal.to_array(), [-1.0, 0.0]);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
///
/// # Errors
/// - [`Error::Number`]: `pose`, `twist` or the pose at the end of the arc is not finite, `dt` is negative or not finite, or
///   `dt` is so long that the arc takes more than 100000 sections, each at most as long as the footprint's reach (or four
///   cells, if that is more) and with a turn of at most 0.5 rad.
/// - [`Error::Memory`]: as in [`touches`].
pub fn advance<'a>(
    world: impl Into<World<'a>>,
    footprint: &Shape,
    pose: Pose,
    twist: Twist,
    dt: f64,
    mode: ContactMode,
) -> Result<(Pose, Option<Contact>), Error> {
    Search::new(world.into(), footprint).advance(pose, twist, dt, mode)
}

/// A search for contacts of a footprint in one world. It keeps the walls that it has found for the next path nearby.
pub(crate) struct Search<'a> {
    footprint: Footprint,
    /// Pieces around the start of a path.
    at_start: Blockers<'a>,
    /// Pieces around a section of a path.
    on_path: Blockers<'a>,
}

impl<'a> Search<'a> {
    /// Returns a search that has found nothing yet.
    pub fn new(world: World<'a>, footprint: &Shape) -> Self {
        let blockers = || Blockers::none(world);
        Self { footprint: Footprint::new(footprint), at_start: blockers(), on_path: blockers() }
    }

    /// Does what the function [`advance`] does.
    ///
    /// # Errors
    /// Those of the function.
    pub fn advance(
        &mut self,
        pose: Pose,
        twist: Twist,
        dt: f64,
        mode: ContactMode,
    ) -> Result<(Pose, Option<Contact>), Error> {
        let Self { footprint, at_start, on_path } = self;
        let world = at_start.world();
        pose.checked()?;
        twist.checked()?;
        check_number("dt", dt, "at least 0", |value| value >= 0.0)?;
        let free = integrate(pose, twist, dt).checked()?;
        let start = world.grid.pose_in_grid(pose);
        at_start.gather(start.position, footprint.reach())?;
        let mut shrunk = None;
        let overlap = if footprint.overlaps(start, at_start) {
            shrunk = shrink(footprint, start, at_start);
            let Some(shrunk) = &mut shrunk else {
                return Ok((free, Some(inside(pose, at_start.obstacle_at(start.position)))));
            };
            shrunk.nearest(start, at_start).map(|hit| contact(world, &hit, 0.0))
        } else {
            None
        };
        let footprint = shrunk.as_mut().unwrap_or(footprint);
        // From here on the unit of time is the step, so that no velocity is larger than the way driven.
        let path = Path::Arc(start, Twist { linear: twist.linear * dt, angular: twist.angular * dt });
        let in_words = |failure| match failure {
            Failure::Memory(error) => error,
            Failure::TooLong => {
                let needed = "short enough for a motion of less than 100000 times the footprint";
                Error::Number { name: "dt", value: dt, needed }
            }
        };
        let hit = footprint.first_contact(on_path, path, 1.0).map_err(in_words)?;
        let Some(hit) = hit else { return Ok((free, overlap)) };
        let first = overlap.unwrap_or_else(|| contact(world, &hit, hit.time));
        let pose = match mode {
            ContactMode::Stop => integrate(pose, twist, hit.time * dt),
            ContactMode::Slide => {
                world.grid.options().origin * slide::slide(footprint, on_path, path, hit, 1.0).map_err(in_words)?
            }
            ContactMode::Report => free,
        };
        Ok((pose, Some(first)))
    }
}

/// Returns the largest scaled-down copy of a footprint that overlaps nothing; `None` if its origin is inside something.
fn shrink(footprint: &Footprint, pose: Pose, blockers: &Blockers<'_>) -> Option<Footprint> {
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

/// Bisection steps for the scale of a footprint that overlaps something: the scale is found to within 2⁻³⁰, about 1e-9.
const HALVINGS: u32 = 30;

/// Returns a hit as a contact in the map frame.
fn contact(world: World<'_>, hit: &Hit, fraction: f64) -> Contact {
    let map_from_grid = world.grid.options().origin;
    let point = map_from_grid.transform_point(hit.point);
    Contact { point, normal: rotate(-hit.toward, map_from_grid.yaw), fraction, obstacle: hit.obstacle }
}

/// Returns the contact of a robot whose origin is inside a blocking cell or an obstacle.
fn inside(pose: Pose, obstacle: Option<usize>) -> Contact {
    Contact { point: pose.position, normal: DVec2::ZERO, fraction: 0.0, obstacle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{GridOptions, OccupancyGrid, Unknown};
    use crate::obstacles::Obstacles;
    use crate::random;
    use rand::RngExt;

    #[test]
    fn a_search_that_goes_on_finds_what_a_new_one_finds() {
        let mut stream = random::stream(6, 0);
        let mut between = |low: f64, high: f64| low + (high - low) * stream.random::<f64>();
        let cells = (0..30 * 30).map(|_| if between(0.0, 1.0) < 0.08 { 100 } else { 0 }).collect();
        let origin = Pose::new(1.0, -2.0, 0.4);
        let options = GridOptions { resolution: 0.25, origin, occupied_threshold: 60, unknown: Unknown::Free };
        let grid = OccupancyGrid::new(cells, 30, options).unwrap();
        let pillar = Shape::disc(0.2).unwrap();
        let pillars = Obstacles::new([(&pillar, Pose::new(3.0, 2.0, 0.0)), (&pillar, Pose::new(4.0, 3.0, 0.0))]).unwrap();
        let (mut free, mut met) = (0, 0);
        for footprint in [Shape::disc(0.15).unwrap(), Shape::rectangle(0.4, 0.25).unwrap()] {
            for mode in [ContactMode::Stop, ContactMode::Slide, ContactMode::Report] {
                let world = World::from((&grid, &pillars));
                let mut search = Search::new(world, &footprint);
                let mut pose = origin * Pose::new(3.0, 3.0, 0.0);
                for turn in 0..400 {
                    if turn % 20 == 0 {
                        pose = origin * Pose::new(between(0.0, 7.5), between(0.0, 7.5), between(-3.0, 3.0));
                    }
                    let twist = Twist::from([between(-0.5, 1.0), between(-0.3, 0.3), between(-2.0, 2.0)]);
                    let found = search.advance(pose, twist, 0.1, mode).unwrap();
                    assert_eq!(found, advance(world, &footprint, pose, twist, 0.1, mode).unwrap());
                    pose = found.0;
                    *if found.1.is_some() { &mut met } else { &mut free } += 1;
                }
            }
        }
        assert!(met > 300 && free > 300, "{met} {free}");
    }
}
