//! The first contact of a footprint along its path, found by conservative advancement.

use glam::DVec2;

use super::blockers::{Blocker, Blockers};
use super::path::{Kinematics, Path};
use crate::error::Error;
use crate::pose::Pose;
use crate::shape::{Shape, edges};

/// A footprint that a contact stops is at most this far \[m\] from the wall or obstacle, and does not overlap it.
pub const TOLERANCE: f64 = 1e-6;

/// Once the gap has reached its target, a step may still reduce it by this much \[m\], so that rounding does not stop a
/// footprint that moves along a wall.
const CREEP: f64 = 1e-10;

/// A footprint approaches a piece if it gets nearer at more than this fraction of its top speed.
const MIN_APPROACH: f64 = 1e-9;

/// Largest turn \[rad\] in one section of a path. Short sections keep the bound on acceleration tight.
const MAX_SECTION_TURN: f64 = 0.5;

/// Largest length of one section of a path \[m\].
const MAX_STRIDE: f64 = 1e7;

/// Largest number of sections of a path.
const MAX_SECTIONS: f64 = 1e5;

/// Largest number of steps in one section within the tolerance of something that the footprint hardly approaches.
const MAX_CREEPS: usize = 200;

/// A footprint: a skeleton (the corners of a polygon, or the centre of a disc) and a radius around it.
#[derive(Debug, Clone)]
pub struct Footprint {
    /// Skeleton in the frame of the footprint \[m\].
    corners: Vec<DVec2>,
    radius: f64,
    /// Distance from the origin to the farthest point \[m\].
    reach: f64,
    /// Skeleton at the pose last given to `place`, in the frame of the grid \[m\].
    placed: Vec<DVec2>,
}

/// Where and when a footprint met a piece of the world, in the frame of the grid.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Time from the start of the path \[s\].
    pub time: f64,
    /// The point of contact, on the piece \[m\].
    pub point: DVec2,
    /// Unit vector from the footprint towards the piece.
    pub toward: DVec2,
    /// Vector from the footprint's origin to the point of the footprint that met the piece \[m\].
    pub offset: DVec2,
    /// Index of the obstacle; `None` for the grid.
    pub obstacle: Option<usize>,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// The path has more than [`MAX_SECTIONS`] sections.
    TooLong,
    /// There is not enough memory for the pieces near the path.
    Memory(Error),
}

impl Footprint {
    pub fn new(shape: &Shape) -> Self {
        let (corners, radius) = shape.skeleton();
        Self { corners: corners.to_vec(), radius, reach: shape.reach(), placed: Vec::with_capacity(corners.len()) }
    }

    /// Returns the footprint scaled by `scale` about its origin.
    pub fn scaled(&self, scale: f64) -> Self {
        let corners = self.corners.iter().map(|&corner| scale * corner).collect();
        Self { corners, radius: scale * self.radius, reach: scale * self.reach, placed: Vec::new() }
    }

    /// Distance from the origin to the farthest point \[m\].
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns true if the footprint at a pose shares a point with a blocking cell or an obstacle.
    pub fn overlaps(&mut self, pose: Pose, blockers: &Blockers<'_>) -> bool {
        self.place(pose);
        blockers.overlap(&self.placed, self.radius)
    }

    /// Returns the distance \[m\] from a footprint that overlaps nothing to the nearest piece, infinity without pieces.
    pub fn gap(&mut self, pose: Pose, blockers: &Blockers<'_>) -> f64 {
        self.place(pose);
        let gaps =
            blockers.iter().flat_map(|blocker| edges(&self.placed).map(|side| blocker.piece.nearest(side).gap(self.radius)));
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Returns the nearest piece as a hit at time 0, `None` if there are no pieces.
    pub fn nearest(&mut self, pose: Pose, blockers: &Blockers<'_>) -> Option<Hit> {
        self.place(pose);
        let (origin, radius) = (pose.position, self.radius);
        let pairs = blockers
            .iter()
            .flat_map(|blocker| edges(&self.placed).map(move |side| Pair { side, blocker, origin, radius }.nearest()));
        pairs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, hit)| hit)
    }

    /// Computes `placed` for a pose in the frame of the grid.
    fn place(&mut self, pose: Pose) {
        let (sin, cos) = libm::sincos(pose.yaw);
        let heading = DVec2::new(cos, sin);
        self.placed.clear();
        self.placed.extend(self.corners.iter().map(|&corner| pose.position + heading.rotate(corner)));
    }

    /// Returns the first contact on the first `duration` seconds of a path that starts without overlap, if any.
    ///
    /// The footprint overlaps nothing on the path up to the contact, and is then within [`TOLERANCE`] of what it meets. A
    /// footprint that passes something at more than this distance does not meet it.
    ///
    /// Method: conservative advancement (Mirtich 1996). A straight line separates each side of the footprint from each
    /// piece. The side cannot meet the piece before one of its two ends crosses this line:
    ///
    /// ```text
    ///        end \                  |  /
    ///             \                 | /
    ///              \                |/
    ///   side        +---- toward -->+    piece
    ///              /                |\
    ///             /                 | \
    ///        end /                  |  \
    ///                          separating line
    /// ```
    ///
    /// Another line does the same: the one that moves with the side, which the ends of the piece must cross. Where a side
    /// turns about the corner of a wall, one of its ends crosses the first line soon, but no end of the wall crosses the
    /// second. [`Kinematics`] gives times before which an end cannot cross. The later one of the two lines counts. The
    /// footprint advances by the smallest such time of all sides and pieces, and repeats this until the gap is within the
    /// tolerance. Every step covers at least half of the tolerance at top speed, so the search ends.
    ///
    /// `blockers` are those of the world; which of them are gathered before does not matter.
    ///
    /// # Errors
    /// [`Failure`] tells which there are.
    pub fn first_contact(&mut self, blockers: &mut Blockers<'_>, path: Path, duration: f64) -> Result<Option<Hit>, Failure> {
        let top_speed = path.top_speed(self.reach);
        let stride = self.reach.max(4.0 * blockers.world().grid.resolution()).min(MAX_STRIDE);
        let turn = path.twist().angular.abs();
        let sections = (top_speed * duration / stride).max(turn * duration / MAX_SECTION_TURN).ceil().max(1.0);
        if sections.is_nan() || sections > MAX_SECTIONS {
            return Err(Failure::TooLong);
        }
        if top_speed == 0.0 {
            return Ok(None);
        }
        for section in 0..sections as u32 {
            let (start, end) = (duration * f64::from(section) / sections, duration * f64::from(section + 1) / sections);
            let travel = path.twist().linear.length() * (end - start);
            let reach = self.reach + travel + TOLERANCE;
            blockers.gather(path.pose_at(start).position, reach).map_err(Failure::Memory)?;
            if let Some(hit) = self.contact_between(start, end, path, blockers) {
                return Ok(Some(hit));
            }
        }
        Ok(None)
    }

    /// Returns the first contact between two times \[s\] of a path, `None` if there is none.
    fn contact_between(&mut self, start: f64, end: f64, path: Path, blockers: &Blockers<'_>) -> Option<Hit> {
        let top_speed = path.top_speed(self.reach);
        let (mut time, mut creeps) = (start, 0);
        loop {
            let pose = path.pose_at(time);
            self.place(pose);
            let kinematics = path.kinematics_at(pose, end - time, top_speed);
            let approach = self.soonest_approach(pose.position, kinematics, blockers)?;
            let next = time + approach.wait;
            if next >= end {
                return None;
            }
            if approach.gap <= TOLERANCE {
                creeps += 1;
                if approach.speed > MIN_APPROACH * top_speed || creeps > MAX_CREEPS {
                    return Some(Hit { time, ..approach.hit });
                }
            }
            if next == time {
                // The way left is shorter than a rounding error of the way driven.
                return Some(Hit { time, ..approach.hit });
            }
            time = next;
        }
    }

    /// Returns the approach with the shortest wait, over all sides and pieces; `None` if there are no pieces.
    fn soonest_approach(&self, origin: DVec2, kinematics: Kinematics, blockers: &Blockers<'_>) -> Option<Approach> {
        let mut soonest: Option<Approach> = None;
        for blocker in blockers.iter() {
            for side in edges(&self.placed) {
                let pair = Pair { side, blocker, origin, radius: self.radius };
                let limit = soonest.as_ref().map_or(f64::INFINITY, |soonest| soonest.wait);
                soonest = pair.approach_before(limit, kinematics).or(soonest);
            }
        }
        soonest
    }
}

/// How soon a side of the footprint can meet a piece of the world.
struct Approach {
    /// Time \[s\] before which the side cannot meet the piece.
    wait: f64,
    /// Distance between the side and the piece now \[m\].
    gap: f64,
    /// Speed at which the gap closes now \[m/s\].
    speed: f64,
    /// The contact that results if the side meets the piece.
    hit: Hit,
}

/// A side of a footprint and a piece of the world.
struct Pair<'a> {
    side: (DVec2, DVec2),
    blocker: &'a Blocker,
    /// Origin of the footprint.
    origin: DVec2,
    /// Radius of the footprint around its skeleton.
    radius: f64,
}

impl Pair<'_> {
    /// Returns the gap \[m\] and the contact that closing it would give.
    fn nearest(&self) -> (f64, Hit) {
        let nearest = self.blocker.piece.nearest(self.side);
        let toward = (nearest.other - nearest.own).normalize_or_zero();
        let hit = Hit {
            time: 0.0,
            point: nearest.other - nearest.radius * toward,
            toward,
            offset: nearest.own + self.radius * toward - self.origin,
            obstacle: self.blocker.obstacle,
        };
        (nearest.gap(self.radius), hit)
    }

    /// Returns how soon the side can meet the piece, `None` if not before `limit` \[s\].
    ///
    /// The goal is a gap of half the tolerance. If the gap is about as small already, it may shrink by at most `CREEP`.
    fn approach_before(&self, limit: f64, kinematics: Kinematics) -> Option<Approach> {
        let (gap, hit) = self.nearest();
        let (toward, shrink) = (hit.toward, (gap - 0.5 * TOLERANCE).max(CREEP.min(0.5 * gap)).max(0.0));
        // The skeleton's nearest point, and that of the piece without its radius, both without the origin.
        let own = hit.offset - self.radius * toward;
        let first_line = [self.side.0, self.side.1].map(|end| {
            let offset = end - self.origin;
            kinematics.earliest(offset, toward, toward.dot(own - offset) + shrink)
        });
        let fixed = first_line[0].min(first_line[1]);
        if fixed >= limit {
            return None;
        }
        let (start, end) = self.blocker.piece.ends();
        let other = hit.point - self.origin + self.blocker.piece.radius() * toward;
        let second_line = [start, end].map(|end| {
            let offset = end - self.origin;
            kinematics.earliest_of_world(offset, toward, toward.dot(offset - other) + shrink)
        });
        let wait = fixed.max(second_line[0].min(second_line[1]));
        let speed = toward.dot(kinematics.velocity(hit.offset));
        (wait < limit).then_some(Approach { wait, gap, speed, hit })
    }
}
