//! The first contact of a footprint along its path, found by conservative advancement.

use glam::DVec2;

use super::blockers::{Blocker, Blockers};
use super::path::{Kinematics, Path};
use crate::error::Error;
use crate::pose::Pose;
use crate::shape::{Shape, edges};
use crate::world::World;

/// A footprint that a contact stops is at most this far \[m\] from the wall or obstacle, and does not overlap it.
pub const TOLERANCE: f64 = 1e-6;

/// Once the gap has reached its target, a step may still reduce it by this much \[m\], so that rounding does not stop a
/// footprint that moves along a wall.
const CREEP: f64 = 1e-10;

/// A footprint approaches a piece if it gets nearer at more than this fraction of its top speed.
const MIN_APPROACH: f64 = 1e-9;

/// Largest turn \[rad\] in one section of a path. Short sections keep the bound on acceleration tight.
const MAX_SECTION_TURN: f64 = 0.5;

/// Largest number of sections of a path.
const MAX_SECTIONS: f64 = 1e5;

/// Largest number of steps in one section. A step roughly squares the remaining distance, so even a dozen steps are rare.
const MAX_STEPS: usize = 200;

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
        pairs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, hit, _)| hit)
    }

    /// Computes `placed` for a pose in the frame of the grid.
    fn place(&mut self, pose: Pose) {
        let (sin, cos) = libm::sincos(pose.yaw);
        let heading = DVec2::new(cos, sin);
        self.placed.clear();
        self.placed.extend(self.corners.iter().map(|&corner| pose.position + heading.rotate(corner)));
    }

    /// Returns the first contact within `duration` seconds along a path that starts without overlap, if any.
    ///
    /// The footprint overlaps nothing on the path up to the contact.
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
    /// [`Kinematics::earliest`] gives a time before which an end cannot cross. The footprint advances by the smallest such
    /// time of all sides and pieces, and repeats this until the gap is within the tolerance.
    ///
    /// # Errors
    /// [`Error::Number`] if the path has more than [`MAX_SECTIONS`] sections.
    pub fn first_contact(&mut self, world: World<'_>, path: Path, duration: f64) -> Result<Option<Hit>, Error> {
        let top_speed = path.top_speed(self.reach);
        let stride = self.reach.max(4.0 * world.grid.resolution());
        let turn = path.twist().angular.abs();
        let sections = (top_speed * duration / stride).max(turn * duration / MAX_SECTION_TURN).ceil().max(1.0);
        if sections.is_nan() || sections > MAX_SECTIONS {
            let needed = "short enough for a motion of less than 100000 times the footprint";
            return Err(Error::Number { name: "dt", value: duration, needed });
        }
        let mut blockers = Blockers::around(world, DVec2::NAN, 0.0);
        for section in 0..sections as u32 {
            let (start, end) = (duration * f64::from(section) / sections, duration * f64::from(section + 1) / sections);
            let travel = path.twist().linear.length() * (end - start);
            blockers.gather(path.pose_at(start).position, self.reach + travel + TOLERANCE);
            if let Some(hit) = self.contact_between(start, end, path, &blockers) {
                return Ok(Some(hit));
            }
        }
        Ok(None)
    }

    /// Returns the first contact between two times \[s\] of a path, `None` if there is none.
    fn contact_between(&mut self, start: f64, end: f64, path: Path, blockers: &Blockers<'_>) -> Option<Hit> {
        if blockers.is_empty() {
            return None;
        }
        let min_speed = MIN_APPROACH * path.top_speed(self.reach);
        let mut time = start;
        let mut nearest = None;
        for _ in 0..MAX_STEPS {
            let pose = path.pose_at(time);
            self.place(pose);
            let search = Search { kinematics: path.kinematics_at(pose), horizon: end - time };
            let approach = self.soonest_approach(pose.position, search, blockers)?;
            if time + approach.wait >= end {
                return None;
            }
            let hit = Hit { time, ..approach.hit };
            nearest = Some(hit);
            let arrived = approach.gap <= TOLERANCE && approach.speed > min_speed;
            if arrived || time + approach.wait == time {
                break;
            }
            time += approach.wait;
            nearest = Some(Hit { time, ..hit });
        }
        nearest
    }

    /// Returns the approach with the shortest wait, over all sides and pieces; `None` if there are no pieces.
    fn soonest_approach(&self, origin: DVec2, search: Search, blockers: &Blockers<'_>) -> Option<Approach> {
        let mut soonest: Option<Approach> = None;
        for blocker in blockers.iter() {
            for side in edges(&self.placed) {
                for approach in (Pair { side, blocker, origin, radius: self.radius }).approaches(search) {
                    if soonest.as_ref().is_none_or(|soonest| approach.wait < soonest.wait) {
                        soonest = Some(approach);
                    }
                }
            }
        }
        soonest
    }
}

/// How soon one end of a side of the footprint can cross the line that separates the side from a piece of the world.
struct Approach {
    /// Time \[s\] before which the end cannot cross the line; infinite if it cannot cross it within the horizon.
    wait: f64,
    /// Distance between the side and the piece now \[m\].
    gap: f64,
    /// Speed at which the end of the side moves towards the piece \[m/s\].
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

/// The state from which to look ahead for a contact.
#[derive(Clone, Copy)]
struct Search {
    kinematics: Kinematics,
    /// Time to look ahead \[s\].
    horizon: f64,
}

impl Pair<'_> {
    /// Returns the gap \[m\], the contact that closing it would give, and the place of the separating line: its signed
    /// distance \[m\] from the grid's corner along `toward`.
    ///
    /// The line is perpendicular to `toward`. It is moved back by both radii: while the skeleton does not cross it, there is
    /// no contact.
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

    /// Returns how soon each end of the side can come near the line that separates it from the piece.
    ///
    /// The goal is a gap of half the tolerance. If the gap is smaller already, it may shrink by at most `CREEP`.
    fn approaches(&self, search: Search) -> [Approach; 2] {
        let (gap, hit, line) = self.nearest();
        [self.side.0, self.side.1].map(|end| {
            let offset = end - self.origin;
            let speed = hit.toward.dot(search.kinematics.velocity(offset));
            let goal = if gap > 0.5 * TOLERANCE { 0.5 * TOLERANCE } else { gap - CREEP.min(0.5 * gap) };
            let distance = (line - hit.toward.dot(end) - goal).max(0.0);
            Approach { wait: search.kinematics.earliest(offset, hit.toward, distance, search.horizon), gap, speed, hit }
        })
    }
}
