//! Courses: where a robot or an obstacle is at the time of each beam of a scan.

use glam::DVec2;

use super::{Twist, integrate, sinc_of};
use crate::batch::check_rows;
use crate::error::Error;
use crate::numeric::sincos::{self, Last};
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;

/// Where a robot or an obstacle is, in the map frame, while one scan is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Course<'a> {
    /// A constant twist from a pose on, at which it is at the time of beam 0. The poses are those of
    /// [`integrate`](crate::integrate), to the last bit.
    Arc {
        /// Pose at the time of beam 0.
        start: Pose,
        /// Velocity in its own frame.
        twist: Twist,
    },
    /// A pose `[x, y, yaw]` \[m, rad\] for each beam.
    Poses(&'a [[f64; 3]]),
}

/// Poses at the times of a group of beams, in columns \[m, rad\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseColumns {
    pub x: Group,
    pub y: Group,
    pub yaw: Group,
}

impl PoseColumns {
    /// Poses at the origin.
    pub const ORIGIN: Self = Self { x: [0.0; GROUP], y: [0.0; GROUP], yaw: [0.0; GROUP] };
}

impl Course<'_> {
    /// Checks that all numbers are finite, and that there is a pose for each beam.
    ///
    /// # Errors
    /// [`Error::Number`], [`Error::Row`], [`Error::Length`].
    pub(crate) fn check(&self, beam_count: usize) -> Result<(), Error> {
        match self {
            Self::Arc { start, twist } => start.checked().and(twist.checked()).map(|_| ()),
            Self::Poses(given) if given.len() != beam_count => {
                Err(Error::Length { name: "the poses of an obstacle", value: given.len(), needed: beam_count })
            }
            Self::Poses(given) => check_rows("the poses of an obstacle", given, Some(1)),
        }
    }

    /// Writes the poses at the times of a group of beams; beam `i` is taken at `i · time_increment` seconds. `last` is for
    /// [`sincos`](sincos::sincos).
    #[inline(always)]
    pub(crate) fn write_poses(&self, group: usize, time_increment: f64, poses: &mut PoseColumns, last: &mut Last) {
        match self {
            Self::Arc { start, twist } => write_arc(*start, *twist, group, time_increment, poses, last),
            Self::Poses(given) => {
                let last = given.len() - 1;
                for slot in 0..GROUP {
                    [poses.x[slot], poses.y[slot], poses.yaw[slot]] = given[(group * GROUP + slot).min(last)];
                }
            }
        }
    }

    /// Returns the middle of the positions, and a distance from it that none of them exceeds \[m\].
    pub(crate) fn bounds(&self, duration: f64) -> (DVec2, f64) {
        match self {
            Self::Arc { start, twist } => {
                let middle = integrate(*start, *twist, 0.5 * duration);
                (middle.position, 0.5 * twist.linear.length() * duration)
            }
            Self::Poses(given) => {
                let positions = given.iter().map(|&[x, y, _]| DVec2::new(x, y));
                let low = positions.clone().fold(DVec2::INFINITY, DVec2::min);
                let high = positions.fold(DVec2::NEG_INFINITY, DVec2::max);
                (low.midpoint(high), 0.5 * low.distance(high))
            }
        }
    }
}

/// The same steps as [`integrate`](super::integrate), for a group.
#[inline(always)]
fn write_arc(start: Pose, twist: Twist, group: usize, time_increment: f64, poses: &mut PoseColumns, last: &mut Last) {
    let (mut time, mut half, mut middle) = ([0.0; GROUP], [0.0; GROUP], [0.0; GROUP]);
    for slot in 0..GROUP {
        time[slot] = (group * GROUP + slot) as f64 * time_increment;
        let turn = twist.angular * time[slot];
        half[slot] = 0.5 * turn;
        poses.yaw[slot] = start.yaw + turn;
        middle[slot] = start.yaw + half[slot];
    }
    let (mut sin_half, mut sin, mut cos) = ([0.0; GROUP], [0.0; GROUP], [0.0; GROUP]);
    sincos::sin(&half, &mut sin_half);
    sincos::sincos(&middle, &mut sin, &mut cos, last);
    let (vx, vy) = (twist.linear.x, twist.linear.y);
    for slot in 0..GROUP {
        let scale = time[slot] * sinc_of(half[slot], sin_half[slot]);
        poses.x[slot] = start.position.x + (cos[slot] * vx - sin[slot] * vy) * scale;
        poses.y[slot] = start.position.y + (sin[slot] * vx + cos[slot] * vy) * scale;
    }
}
