//! Motion along what was met.

use glam::DVec2;

use super::approach::{Footprint, Hit};
use super::path::Path;
use crate::error::Error;
use crate::motion::Twist;
use crate::pose::{Pose, rotate};
use crate::world::World;

/// Contacts that one step takes into account; a robot that meets more stands still for the rest of it.
const MAX_CONTACTS: usize = 8;

/// Pose in the grid's frame after `duration` seconds of a path, from its first contact on along what it meets.
pub fn slide(footprint: &mut Footprint, world: World<'_>, path: Path, first: Hit, duration: f64) -> Result<Pose, Error> {
    let mut pose = path.pose_at(first.time);
    let wanted = Twist { linear: rotate(path.twist().linear, pose.yaw), angular: path.twist().angular };
    let (mut hits, mut elapsed) = (vec![first], first.time);
    while hits.len() <= MAX_CONTACTS {
        let line = Path::Line(pose, allowed(wanted, &hits));
        let Some(hit) = footprint.first_contact(world, line, duration - elapsed)? else {
            return Ok(line.pose_at(duration - elapsed));
        };
        pose = line.pose_at(hit.time);
        elapsed += hit.time;
        hits.push(hit);
    }
    Ok(pose)
}

/// The twist nearest to the one wanted that drives no point of contact into what it met.
fn allowed(wanted: Twist, hits: &[Hit]) -> Twist {
    let turning = nearest_allowed(wanted.linear, wanted.angular, hits);
    match turning {
        Some(linear) => Twist { linear, ..wanted },
        None => Twist { linear: nearest_allowed(wanted.linear, 0.0, hits).unwrap_or_default(), angular: 0.0 },
    }
}

/// The linear velocity nearest to the one wanted: that one, or the nearest on the boundary of one contact or of two.
fn nearest_allowed(wanted: DVec2, angular: f64, hits: &[Hit]) -> Option<DVec2> {
    // Contact k allows the velocities v with v · toward ≤ most.
    let limits: Vec<(DVec2, f64)> =
        hits.iter().map(|hit| (hit.toward, -angular * hit.toward.dot(hit.offset.perp()))).collect();
    let slack = 1e-12 * (wanted.length() + limits.iter().map(|limit| limit.1.abs()).fold(0.0, f64::max));
    let is_allowed = |velocity: &DVec2| limits.iter().all(|&(toward, most)| velocity.dot(toward) <= most + slack);
    let on_one = |&(toward, most): &(DVec2, f64)| wanted - (wanted.dot(toward) - most) * toward;
    let on_two = |a: (DVec2, f64), b: (DVec2, f64)| {
        let sine = a.0.perp_dot(b.0);
        // Parallel boundaries have no corner.
        (sine.abs() > 1e-9).then(|| (a.1 * b.0 - b.1 * a.0).perp() / -sine)
    };
    let ones = limits.iter().map(on_one);
    let twos = limits.iter().flat_map(|&a| limits.iter().filter_map(move |&b| on_two(a, b)));
    let near = |a: &DVec2, b: &DVec2| a.distance_squared(wanted).total_cmp(&b.distance_squared(wanted));
    std::iter::once(wanted).chain(ones).chain(twos).filter(is_allowed).min_by(near)
}
