//! Sweeps: a sweep is the rays of a scan that takes time, so that each ray starts where the scanner is at its own time.

use std::cell::RefCell;

use glam::DVec2;

use super::Caster;
use super::kernel::Work;
use super::rays::{RayColumns, Rays};
use super::sink::Sink;
use crate::error::Error;
use crate::memory;
use crate::motion::{Course, PoseColumns};
use crate::numeric::sincos::{Last, sincos};
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;

/// The rays of one scan. Ray `i` is taken at `i · time_increment` seconds.
#[derive(Debug, Clone, Copy)]
pub struct Sweep<'a> {
    /// Where the robot is.
    pub course: Course<'a>,
    /// Time from one ray to the next \[s\].
    pub time_increment: f64,
    /// Pose on the robot from which the rays spread.
    pub base_from_fan: Pose,
    /// Cosines of the beams' angles in that frame.
    pub cos: &'a [Group],
    /// Sines of the same angles.
    pub sin: &'a [Group],
    /// Number of rays.
    pub count: usize,
}

impl Sweep<'_> {
    /// Writes the poses in the map from which the rays of a group spread. `last` is for [`sincos`].
    #[inline(always)]
    pub(crate) fn write_poses(&self, group: usize, poses: &mut PoseColumns, [own, mounted]: &mut [Last; 2]) {
        self.course.write_poses(group, self.time_increment, poses, own);
        mount(self.base_from_fan, poses, mounted);
    }
}

/// The rays of sweeps, ready to be cast.
#[derive(Debug, Clone, Copy)]
pub struct Swept<'a, 'grid> {
    caster: &'a Caster<'grid>,
    rays: Rays<'a>,
    /// The poses in the map from which the rays spread, for each group of all sweeps.
    pub map_from_fan: &'a [PoseColumns],
}

impl Swept<'_, '_> {
    /// Sends ranges in metres to the sink, group by group, sweep by sweep; infinite for no return within the maximum range.
    ///
    /// # Panics
    /// If the sink itself starts a cast.
    pub fn cast(self, sink: impl Sink) {
        self.caster.cast(self.rays, sink);
    }
}

impl Caster<'_> {
    /// Calls `work` with the rays of sweeps that have the same number of rays.
    ///
    /// Each ray has the bytes of the ray of a scan that is taken in one instant, from where the robot is at the time of the
    /// ray.
    ///
    /// # Panics
    /// If `work` calls this function.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub(crate) fn with_sweeps(&self, sweeps: &[Sweep<'_>], work: impl FnOnce(Swept<'_, '_>)) -> Result<(), Error> {
        thread_local! {
            static BUFFERS: RefCell<(Vec<RayColumns>, Vec<PoseColumns>)> = const { RefCell::new((Vec::new(), Vec::new())) };
        }
        let groups = sweeps.iter().map(|sweep| sweep.cos.len()).sum();
        BUFFERS.with_borrow_mut(|(rays, poses)| {
            memory::lengthen("the beams", rays, groups, RayColumns::MISSES)?;
            memory::lengthen("the beams", poses, groups, PoseColumns::ORIGIN)?;
            let (rays, poses) = (&mut rays[..groups], &mut poses[..groups]);
            let mut first = 0;
            for sweep in sweeps {
                let last = first + sweep.cos.len();
                let (rays, poses) = (&mut rays[first..last], &mut poses[first..last]);
                self.kernel().with_features(FillSweep { caster: self, sweep, rays, poses });
                first = last;
            }
            let count = if let [sweep] = sweeps { sweep.count } else { groups * GROUP };
            work(Swept { caster: self, rays: Rays { groups: rays, count, upcoming: &[] }, map_from_fan: poses });
            Ok(())
        })
    }
}

/// Fills groups with the rays of a sweep, and with the poses from which they start.
struct FillSweep<'a, 'grid> {
    caster: &'a Caster<'grid>,
    sweep: &'a Sweep<'a>,
    rays: &'a mut [RayColumns],
    poses: &'a mut [PoseColumns],
}

impl Work for FillSweep<'_, '_> {
    #[inline(always)]
    fn run(self) {
        let Self { caster, sweep, rays, poses } = self;
        let (mut of_poses, mut of_rays) = ([Last::default(); 2], Last::default());
        for (group, (rays, poses)) in rays.iter_mut().zip(poses).enumerate() {
            sweep.write_poses(group, poses, &mut of_poses);
            fill_group(caster, (&sweep.cos[group], &sweep.sin[group]), poses, rays, &mut of_rays);
        }
    }
}

/// Replaces poses of the robot by poses of a frame that is mounted on it.
#[inline(always)]
fn mount(base_from_fan: Pose, poses: &mut PoseColumns, last: &mut Last) {
    let position = base_from_fan.position;
    if position != DVec2::ZERO {
        let (mut sin, mut cos) = ([0.0; GROUP], [0.0; GROUP]);
        sincos(&poses.yaw, &mut sin, &mut cos, last);
        for slot in 0..GROUP {
            poses.x[slot] += cos[slot] * position.x - sin[slot] * position.y;
            poses.y[slot] += sin[slot] * position.x + cos[slot] * position.y;
        }
    }
    for slot in 0..GROUP {
        poses.yaw[slot] += base_from_fan.yaw;
    }
}

/// Fills a group with the rays that start at poses in the map frame, at angles with these cosines and sines.
#[inline(always)]
fn fill_group(
    caster: &Caster<'_>,
    (beam_cos, beam_sin): (&Group, &Group),
    poses: &PoseColumns,
    rays: &mut RayColumns,
    last: &mut Last,
) {
    let [x, y, dx, dy] = rays.origins_and_directions();
    let mut yaws = [0.0; GROUP];
    for slot in 0..GROUP {
        let pose = Pose::new(poses.x[slot], poses.y[slot], poses.yaw[slot]);
        let (origin, yaw) = caster.in_grid(pose);
        (x[slot], y[slot], yaws[slot]) = (origin.x, origin.y, yaw);
    }
    let (mut sin, mut cos) = ([0.0; GROUP], [0.0; GROUP]);
    sincos(&yaws, &mut sin, &mut cos, last);
    let mut are_finite = true;
    for slot in 0..GROUP {
        dx[slot] = cos[slot] * beam_cos[slot] - sin[slot] * beam_sin[slot];
        dy[slot] = sin[slot] * beam_cos[slot] + cos[slot] * beam_sin[slot];
        are_finite &= dx[slot].is_finite();
    }
    caster.start_group(rays, are_finite);
}
