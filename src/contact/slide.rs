//! Slide mode: motion along the walls and obstacles that a footprint meets.

use glam::DVec2;

use super::approach::{Failure, Footprint, Hit};
use super::blockers::Blockers;
use super::path::Path;
use crate::motion::Twist;
use crate::pose::{Pose, rotate};

/// Largest number of contacts handled in one step. After one more the footprint stands still for the rest of the step.
const MAX_CONTACTS: usize = 8;

/// Returns the pose, in the frame of the grid, after `duration` seconds of a path with the first contact `first`.
///
/// After each contact the footprint moves on a straight line, at the allowed twist nearest to the wanted one.
///
/// # Errors
/// That of [`Footprint::first_contact`].
pub fn slide(
    footprint: &mut Footprint,
    blockers: &mut Blockers<'_>,
    path: Path,
    first: Hit,
    duration: f64,
) -> Result<Pose, Failure> {
    let mut pose = path.pose_at(first.time);
    let wanted = Twist { linear: rotate(path.twist().linear, pose.yaw), angular: path.twist().angular };
    let (mut hits, mut elapsed) = (vec![first], first.time);
    while hits.len() <= MAX_CONTACTS {
        let line = Path::Line(pose, allowed_twist(wanted, &hits));
        let Some(hit) = footprint.first_contact(blockers, line, duration - elapsed)? else {
            return Ok(line.pose_at(duration - elapsed));
        };
        pose = line.pose_at(hit.time);
        elapsed += hit.time;
        hits.push(hit);
    }
    Ok(pose)
}

/// Returns a twist near the wanted one that moves no contact point into the wall or obstacle it touches.
///
/// It keeps the wanted turn rate if any linear velocity is allowed with it. Otherwise it does not turn.
fn allowed_twist(wanted: Twist, hits: &[Hit]) -> Twist {
    let turning = nearest_allowed_velocity(wanted.linear, wanted.angular, hits);
    match turning {
        Some(linear) => Twist { linear, ..wanted },
        None => Twist { linear: nearest_allowed_velocity(wanted.linear, 0.0, hits).unwrap_or_default(), angular: 0.0 },
    }
}

/// Returns the allowed linear velocity nearest to the wanted one at a given turn rate, `None` if no velocity is allowed.
///
/// A contact point moves at `v + angular · perp(offset)`. It must not move along `toward`, so a contact allows the
/// velocities with `v · toward <= limit`, a half-plane. The nearest point of the intersection of these half-planes is the
/// wanted velocity, its projection onto one boundary, or the corner of two boundaries:
///
/// ```text
///   v · toward > limit, not allowed
///   --------------------*------------ boundary
///                       ^ nearest allowed velocity
///   (the wanted velocity lies above it)
/// ```
fn nearest_allowed_velocity(wanted: DVec2, angular: f64, hits: &[Hit]) -> Option<DVec2> {
    let bounds: Vec<(DVec2, f64)> =
        hits.iter().map(|hit| (hit.toward, -angular * hit.toward.dot(hit.offset.perp()))).collect();
    let slack = 1e-12 * (wanted.length() + bounds.iter().map(|bound| bound.1.abs()).fold(0.0, f64::max));
    let is_allowed = |velocity: &DVec2| bounds.iter().all(|&(toward, limit)| velocity.dot(toward) <= limit + slack);
    let projection = |&(toward, limit): &(DVec2, f64)| wanted - (wanted.dot(toward) - limit) * toward;
    let corner = |a: (DVec2, f64), b: (DVec2, f64)| {
        let sine = a.0.perp_dot(b.0);
        // Parallel boundaries have no corner.
        (sine.abs() > 1e-9).then(|| (a.1 * b.0 - b.1 * a.0).perp() / -sine)
    };
    let projections = bounds.iter().map(projection);
    let corners = bounds.iter().flat_map(|&a| bounds.iter().filter_map(move |&b| corner(a, b)));
    let by_distance = |a: &DVec2, b: &DVec2| a.distance_squared(wanted).total_cmp(&b.distance_squared(wanted));
    std::iter::once(wanted).chain(projections).chain(corners).filter(is_allowed).min_by(by_distance)
}
