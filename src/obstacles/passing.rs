//! Obstacles that move while a scan is taken.

use glam::DVec2;

use super::body::{Side, contains, disc_entry, edge_entry, placed, side};
use super::{Body, MARGIN, OBSTACLES};
use crate::error::Error;
use crate::memory;
use crate::motion::{Course, PoseColumns};
use crate::numeric::sincos::{Last, sincos};
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;
use crate::shape::{MAX_CORNERS, Shape};
use crate::surface::Material;

/// A shape that moves, or stands, while a scan is taken.
#[derive(Debug, Clone, Copy)]
pub struct MovingObstacle<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Where it is while the scan is taken, in the map frame.
    pub course: Course<'a>,
}

/// The obstacles of a scan that takes time.
#[derive(Debug)]
pub(crate) struct Passing<'a> {
    passers: Vec<Passer<'a>>,
    /// Time from one beam to the next \[s\].
    time_increment: f64,
    max_range: f64,
}

#[derive(Debug)]
struct Passer<'a> {
    obstacle: MovingObstacle<'a>,
    /// Centre and radius \[m\] of a circle that encloses the shape during the whole scan.
    bounds: (DVec2, f64),
}

/// Beams of a group: their origins and directions in the map frame.
struct Beams {
    x: Group,
    y: Group,
    dx: Group,
    dy: Group,
}

impl<'a> Passing<'a> {
    /// Returns the obstacles of a scan of `beam_count` beams.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(
        obstacles: &[MovingObstacle<'a>],
        beam_count: usize,
        time_increment: f64,
        max_range: f64,
    ) -> Result<Self, Error> {
        let passers = obstacles.iter().map(|&obstacle| {
            let (middle, distance) = obstacle.course.bounds((beam_count - 1) as f64 * time_increment);
            let reach = (distance + obstacle.shape.reach()) * (1.0 + MARGIN) + MARGIN;
            Passer { obstacle, bounds: (middle, reach) }
        });
        Ok(Self { passers: memory::collected(OBSTACLES, passers)?, time_increment, max_range })
    }

    /// Returns true if there are no obstacles.
    pub fn is_empty(&self) -> bool {
        self.passers.is_empty()
    }

    /// Returns true if an obstacle is of glass or a mirror.
    pub fn lead_on(&self) -> bool {
        self.passers.iter().any(|passer| passer.obstacle.shape.material().leads_on())
    }

    /// Returns the material of an obstacle.
    pub fn material(&self, index: usize) -> Material {
        self.passers[index].obstacle.shape.material()
    }

    /// Returns the obstacles at the time of a beam, given by its group and its slot there.
    pub fn bodies(&self, group: usize, slot: usize) -> Vec<Body> {
        let body = |passer: &Passer<'_>| {
            let mut poses = PoseColumns::ORIGIN;
            passer.obstacle.course.write_poses(group, self.time_increment, &mut poses, &mut Last::default());
            Body::new(passer.obstacle.shape, Pose::new(poses.x[slot], poses.y[slot], poses.yaw[slot])).ok()
        };
        self.passers.iter().filter_map(body).collect()
    }

    /// Replaces each range \[m\] of a group of beams by the distance to the nearest obstacle at the time of the beam, if that is
    /// shorter than the range and `max_range`.
    ///
    /// `map_from_fan` is where the beams of the group spread from; `cos` and `sin` are those of the beams' angles there.
    #[inline(always)]
    pub fn shorten(&self, group: usize, map_from_fan: &PoseColumns, (cos, sin): (&Group, &Group), ranges: &mut Group) {
        let mut beams = Beams { x: map_from_fan.x, y: map_from_fan.y, dx: [0.0; GROUP], dy: [0.0; GROUP] };
        let (mut sin_yaw, mut cos_yaw) = ([0.0; GROUP], [0.0; GROUP]);
        sincos(&map_from_fan.yaw, &mut sin_yaw, &mut cos_yaw, &mut Last::default());
        for slot in 0..GROUP {
            beams.dx[slot] = cos_yaw[slot] * cos[slot] - sin_yaw[slot] * sin[slot];
            beams.dy[slot] = sin_yaw[slot] * cos[slot] + cos_yaw[slot] * sin[slot];
        }
        for passer in &self.passers {
            let (is_near, may_be_inside) = passer.is_near(&beams, ranges, self.max_range);
            if is_near {
                let distances = passer.entries(group, self.time_increment, &beams, may_be_inside);
                for (range, distance) in ranges.iter_mut().zip(distances) {
                    let is_nearer = (distance < *range) & (distance < self.max_range);
                    *range = if is_nearer { distance } else { *range };
                }
            }
        }
    }
}

impl Passing<'_> {
    /// Returns the nearest obstacle that a beam enters at its own time before `limit` \[m\], and the product of its direction and
    /// the normal; no product if the beam starts inside, or if there is no memory.
    pub fn hit(&self, beam: usize, origin: DVec2, direction: DVec2, limit: f64) -> Option<(usize, Option<f64>)> {
        let (mut nearest, mut limit) = (None, limit);
        for (index, Passer { obstacle, .. }) in self.passers.iter().enumerate() {
            let mut poses = PoseColumns::ORIGIN;
            obstacle.course.write_poses(beam / GROUP, self.time_increment, &mut poses, &mut Last::default());
            let slot = beam % GROUP;
            let pose = Pose::new(poses.x[slot], poses.y[slot], poses.yaw[slot]);
            let Ok(body) = Body::new(obstacle.shape, pose) else { continue };
            if !body.is_near(origin, direction, limit) {
                continue;
            }
            let inside = body.contains(origin);
            let distance = if inside { 0.0 } else { body.entry(origin, direction) };
            if distance < limit {
                limit = distance;
                nearest = Some((index, (!inside).then(|| body.normal_near(origin + direction * distance).dot(direction))));
            }
        }
        nearest
    }
}

impl Passer<'_> {
    /// Returns true if a beam may meet the shape within its range, and true if a beam may start inside the shape. Quick tests
    /// that never miss a case.
    #[inline(always)]
    fn is_near(&self, beams: &Beams, ranges: &Group, max_range: f64) -> (bool, bool) {
        let (center, reach) = self.bounds;
        let (mut is_near, mut may_be_inside) = (false, false);
        for (slot, &range) in ranges.iter().enumerate() {
            let (to_x, to_y) = (center.x - beams.x[slot], center.y - beams.y[slot]);
            let along = beams.dx[slot] * to_x + beams.dy[slot] * to_y;
            let across = beams.dx[slot] * to_y - beams.dy[slot] * to_x;
            let limit = if range < max_range { range } else { max_range };
            is_near |= (across.abs() <= reach) & (along >= -reach) & (along - reach <= limit);
            may_be_inside |= to_x * to_x + to_y * to_y <= reach * reach;
        }
        (is_near, may_be_inside)
    }

    /// Returns the distance \[m\] at which each beam enters the shape, infinity if it does not.
    #[inline(always)]
    fn entries(&self, group: usize, time_increment: f64, beams: &Beams, may_be_inside: bool) -> Group {
        let mut poses = PoseColumns::ORIGIN;
        self.obstacle.course.write_poses(group, time_increment, &mut poses, &mut Last::default());
        let (mut sin, mut cos) = ([0.0; GROUP], [0.0; GROUP]);
        sincos(&poses.yaw, &mut sin, &mut cos, &mut Last::default());
        let origin = |slot: usize| DVec2::new(beams.x[slot], beams.y[slot]);
        let direction = |slot: usize| DVec2::new(beams.dx[slot], beams.dy[slot]);
        let place = |corner: DVec2, slot: usize| {
            placed(corner, DVec2::new(poses.x[slot], poses.y[slot]), DVec2::new(cos[slot], sin[slot]))
        };
        let (corners, radius) = self.obstacle.shape.skeleton();
        let mut entries = [f64::INFINITY; GROUP];
        if radius > 0.0 {
            for (slot, entry) in entries.iter_mut().enumerate() {
                *entry = disc_entry(place(corners[0], slot) - origin(slot), radius, direction(slot));
            }
        } else {
            let last = corners[corners.len() - 1];
            let mut starts = [Side::default(); GROUP];
            for (slot, start) in starts.iter_mut().enumerate() {
                *start = side(place(last, slot) - origin(slot), direction(slot));
            }
            for &corner in corners {
                for (slot, (start, nearest)) in starts.iter_mut().zip(&mut entries).enumerate() {
                    let end = side(place(corner, slot) - origin(slot), direction(slot));
                    let entry = edge_entry(*start, end);
                    *nearest = if entry < *nearest { entry } else { *nearest };
                    *start = end;
                }
            }
        }
        if may_be_inside {
            for (slot, entry) in entries.iter_mut().enumerate() {
                if is_inside(self.obstacle.shape, |corner| place(corner, slot), origin(slot)) {
                    *entry = 0.0;
                }
            }
        }
        entries
    }
}

/// Returns true if a point is inside a shape whose corners are placed by `place`.
#[inline(never)]
fn is_inside(shape: &Shape, place: impl Fn(DVec2) -> DVec2, point: DVec2) -> bool {
    let (own, radius) = shape.skeleton();
    let mut corners = [DVec2::ZERO; MAX_CORNERS];
    let corners = &mut corners[..own.len()];
    for (corner, &own) in corners.iter_mut().zip(own) {
        *corner = place(own);
    }
    contains(corners, radius, point)
}
