//! The first contact along a path, by conservative advancement.

use glam::DVec2;

use super::blockers::{Blocker, Blockers};
use super::path::{Moment, Path};
use crate::error::Error;
use crate::pose::Pose;
use crate::shape::{Shape, edges};
use crate::world::World;

/// A footprint that stops is this near to what stopped it \[m\], and not in it.
pub const TOLERANCE: f64 = 1e-6;

/// What is nearer than the goal already, and does not head there, may get this much nearer \[m\]: it takes up what rounding does
/// to motion along a wall.
const CREEP: f64 = 1e-10;

/// Share of the top speed below which nothing heads anywhere.
const HEADING: f64 = 1e-9;

/// A path is searched in pieces of no more than this turn \[rad\], so that its curve is well known.
const LONGEST_TURN: f64 = 0.5;

/// The largest number of pieces.
const MAX_PIECES: f64 = 1e5;

/// Steps in one piece of a path; each about squares the distance left, so that a dozen is much.
const MAX_STEPS: usize = 200;

/// A footprint: a skeleton, scaled about the origin of its frame, and a radius around it.
#[derive(Debug, Clone)]
pub struct Footprint {
    corners: Vec<DVec2>,
    radius: f64,
    reach: f64,
    placed: Vec<DVec2>,
}

/// Where a footprint met something, in the grid's frame.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// When, in seconds from the start of the path.
    pub time: f64,
    /// On the obstacle.
    pub point: DVec2,
    /// Unit vector from the footprint towards the obstacle.
    pub toward: DVec2,
    /// The footprint's point that met it, from its origin.
    pub offset: DVec2,
    /// Index of the obstacle, none for the grid.
    pub obstacle: Option<usize>,
}

impl Footprint {
    pub fn new(shape: &Shape) -> Self {
        let (corners, radius) = shape.skeleton();
        Self { corners: corners.to_vec(), radius, reach: shape.reach(), placed: Vec::with_capacity(corners.len()) }
    }

    /// The same, `scale` times as large.
    pub fn scaled(&self, scale: f64) -> Self {
        let corners = self.corners.iter().map(|&corner| scale * corner).collect();
        Self { corners, radius: scale * self.radius, reach: scale * self.reach, placed: Vec::new() }
    }

    /// Distance from the origin to the farthest point.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether the footprint at a pose overlaps anything.
    pub fn overlaps(&mut self, pose: Pose, blockers: &Blockers<'_>) -> bool {
        self.place(pose);
        blockers.overlap(&self.placed, self.radius)
    }

    /// Distance to the nearest piece that the footprint at a pose does not overlap, infinite if there are none.
    pub fn gap(&mut self, pose: Pose, blockers: &Blockers<'_>) -> f64 {
        self.place(pose);
        let gaps =
            blockers.iter().flat_map(|blocker| edges(&self.placed).map(|side| blocker.piece.nearest(side).gap(self.radius)));
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// The nearest piece to the footprint at a pose, as if it had been met there at once.
    pub fn nearest(&mut self, pose: Pose, blockers: &Blockers<'_>) -> Option<Hit> {
        self.place(pose);
        let (origin, radius) = (pose.position, self.radius);
        let pairs = blockers
            .iter()
            .flat_map(|blocker| edges(&self.placed).map(move |side| Pair { side, blocker, origin, radius }.nearest()));
        pairs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, hit, _)| hit)
    }

    fn place(&mut self, pose: Pose) {
        let (sin, cos) = libm::sincos(pose.yaw);
        let heading = DVec2::new(cos, sin);
        self.placed.clear();
        self.placed.extend(self.corners.iter().map(|&corner| pose.position + heading.rotate(corner)));
    }

    /// The first contact within `duration` seconds along a path that starts free; the footprint is free all the way to it.
    ///
    /// Mirtich's conservative advancement (1996), along the line that separates a side of the footprint from a piece: the side
    /// cannot meet the piece before one of its ends crosses that line.
    ///
    /// # Errors
    /// A duration in which the footprint goes farther than a hundred thousand times its own size.
    pub fn first_contact(&mut self, world: World<'_>, path: Path, duration: f64) -> Result<Option<Hit>, Error> {
        let top_speed = path.top_speed(self.reach);
        let stride = self.reach.max(4.0 * world.grid.resolution());
        let turn = path.twist().angular.abs();
        let pieces = (top_speed * duration / stride).max(turn * duration / LONGEST_TURN).ceil().max(1.0);
        if pieces.is_nan() || pieces > MAX_PIECES {
            let needed = "short enough for a motion of less than 100000 times the footprint";
            return Err(Error::Number { name: "dt", value: duration, needed });
        }
        let mut blockers = Blockers::around(world, DVec2::NAN, 0.0);
        for piece in 0..pieces as u32 {
            let (start, end) = (duration * f64::from(piece) / pieces, duration * f64::from(piece + 1) / pieces);
            let travel = path.twist().linear.length() * (end - start);
            blockers.gather(path.pose_at(start).position, self.reach + travel + TOLERANCE);
            if let Some(hit) = self.contact_between(start, end, path, &blockers) {
                return Ok(Some(hit));
            }
        }
        Ok(None)
    }

    fn contact_between(&mut self, start: f64, end: f64, path: Path, blockers: &Blockers<'_>) -> Option<Hit> {
        if blockers.is_empty() {
            return None;
        }
        let heading = HEADING * path.top_speed(self.reach);
        let mut time = start;
        let mut nearest = None;
        for _ in 0..MAX_STEPS {
            let pose = path.pose_at(time);
            self.place(pose);
            let search = Search { moment: path.moment(pose), horizon: end - time };
            let next = self.next(pose.position, search, blockers)?;
            if time + next.wait >= end {
                return None;
            }
            let hit = Hit { time, ..next.hit };
            nearest = Some(hit);
            let arrived = next.gap <= TOLERANCE && next.speed > heading;
            if arrived || time + next.wait == time {
                break;
            }
            time += next.wait;
            nearest = Some(Hit { time, ..hit });
        }
        nearest
    }

    /// The pair of side and piece that may meet soonest.
    fn next(&self, origin: DVec2, search: Search, blockers: &Blockers<'_>) -> Option<Next> {
        let mut soonest: Option<Next> = None;
        for blocker in blockers.iter() {
            for side in edges(&self.placed) {
                for next in (Pair { side, blocker, origin, radius: self.radius }).ends(search) {
                    if soonest.as_ref().is_none_or(|soonest| next.wait < soonest.wait) {
                        soonest = Some(next);
                    }
                }
            }
        }
        soonest
    }
}

/// How soon a contact may come.
struct Next {
    /// Seconds before which it will not.
    wait: f64,
    /// Distance of the pair now.
    gap: f64,
    /// Speed at which the pair's end heads there.
    speed: f64,
    hit: Hit,
}

/// A side of a footprint and a piece.
struct Pair<'a> {
    side: (DVec2, DVec2),
    blocker: &'a Blocker,
    origin: DVec2,
    radius: f64,
}

/// What to look for from one moment of a path on.
#[derive(Clone, Copy)]
struct Search {
    moment: Moment,
    /// Seconds to look ahead.
    horizon: f64,
}

impl Pair<'_> {
    /// The distance between the two, the contact that it would be, and the line (by its distance from the frame's origin) that the
    /// side cannot meet the piece before it crosses.
    fn nearest(&self) -> (f64, Hit, f64) {
        let nearest = self.blocker.piece.nearest(self.side);
        let toward = (nearest.other - nearest.own).normalize_or_zero();
        let hit = Hit {
            time: 0.0,
            point: nearest.other - nearest.radius * toward,
            toward,
            offset: nearest.own + self.radius * toward - self.origin,
            obstacle: self.blocker.obstacle,
        };
        (nearest.gap(self.radius), hit, toward.dot(nearest.other) - nearest.radius - self.radius)
    }

    /// How soon each end of the side may cross the line that separates it from the piece.
    fn ends(&self, search: Search) -> [Next; 2] {
        let (gap, hit, line) = self.nearest();
        [self.side.0, self.side.1].map(|end| {
            let offset = end - self.origin;
            let speed = hit.toward.dot(search.moment.velocity(offset));
            let goal = if gap > 0.5 * TOLERANCE { 0.5 * TOLERANCE } else { gap - CREEP.min(0.5 * gap) };
            let distance = (line - hit.toward.dot(end) - goal).max(0.0);
            Next { wait: search.moment.earliest(offset, hit.toward, distance, search.horizon), gap, speed, hit }
        })
    }
}
