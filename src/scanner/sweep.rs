//! Scans that take time: each beam is taken from where the robot is at its own time.

use std::ops::Range;

use super::onward::Onward;
use super::sinks::{Beyond, Noisy, PassingBy, SinkPerScan};
use super::surfaces::{Moving, Surfaced};
use super::{LaserScanner, Noise};
use crate::batch::{check_rows, for_each_chunk, thread_count};
use crate::beam_model::Sampler;
use crate::error::{Error, check_number};
use crate::grid::OccupancyGrid;
use crate::motion::{Course, PoseColumns};
use crate::numeric::GROUP;
use crate::numeric::sincos::Last;
use crate::obstacles::{MovingObstacle, Passing};
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Caster, Fans, Sink, StoreRanges, Sweep};

/// How the robots of a batch move, one for each scan, while their scans are taken.
#[derive(Debug, Clone, Copy)]
pub enum Courses<'a> {
    /// Each robot moves at a constant twist.
    Arcs {
        /// Poses `[x, y, yaw]` \[m, rad\] at the time of beam 0.
        poses: &'a [[f64; 3]],
        /// Twists `[vx, vy, wz]` in the robot's frame \[m/s, rad/s\], one for each pose.
        twists: &'a [[f64; 3]],
    },
    /// The poses of each robot at the times of all beams, robot by robot.
    Poses(&'a [[f64; 3]]),
}

/// A batch of scans that take time.
///
/// Beam `i` is taken `i` times [`time_increment`](LaserScanner::time_increment) after beam 0.
#[derive(Debug, Clone, Copy)]
pub struct Sweeps<'a> {
    /// How the robots move.
    pub courses: Courses<'a>,
    /// Time in which the head turns through the field of the beams \[s\].
    pub scan_duration: f64,
    /// Obstacles, which move in the same way during each of the scans.
    pub obstacles: &'a [MovingObstacle<'a>],
}

impl<'a> Courses<'a> {
    /// Returns how one robot moves.
    fn course(&self, robot: usize, beam_count: usize) -> Course<'a> {
        match self {
            Self::Arcs { poses, twists } => Course::Arc { start: poses[robot].into(), twist: twists[robot].into() },
            Self::Poses(poses) => Course::Poses(&poses[robot * beam_count..][..beam_count]),
        }
    }

    /// Returns the number of robots, after a check of all numbers.
    fn checked(&self, beam_count: usize, threads: Option<usize>) -> Result<usize, Error> {
        match self {
            Self::Arcs { poses, twists } => {
                check_rows("poses", poses, threads)?;
                check_rows("twists", twists, threads)?;
                if twists.len() != poses.len() {
                    return Err(Error::Length { name: "twists", value: twists.len(), needed: poses.len() });
                }
                Ok(poses.len())
            }
            Self::Poses(poses) => {
                check_rows("poses", poses, threads)?;
                let robots = poses.len() / beam_count;
                if robots * beam_count != poses.len() {
                    return Err(Error::Length { name: "poses", value: poses.len(), needed: (robots + 1) * beam_count });
                }
                Ok(robots)
            }
        }
    }
}

impl LaserScanner {
    /// Returns the time from one beam to the next \[s\] of a scan whose head turns through the field in `scan_duration`
    /// seconds; 0 with a single beam.
    ///
    /// A full turn takes one time increment longer than from the first beam to the last.
    #[must_use]
    pub fn time_increment(&self, scan_duration: f64) -> f64 {
        if self.beams.gaps() == 0 { 0.0 } else { scan_duration / self.beams.gaps() as f64 }
    }

    /// Writes the readings \[m\] of scans that take time to `readings`, with noise if `noise` is given.
    ///
    /// Each range is that of [`scan`](Self::scan) from where the robot is at the time of the beam, with the obstacles where
    /// they are then, to the last bit. So a scan duration of 0 gives the readings of [`scan_batch`](Self::scan_batch). The
    /// noise of a scan does not depend on its motion. The readings do not depend on `threads`.
    ///
    /// ```
    /// use mobile_robot_simulator::{
    ///     BeamLayout, Courses, GridOptions, LaserScanner, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, ScannerOptions, Sweeps, Unknown,
    /// };
    ///
    /// // A row of ten cells of 1 m; the last one is occupied, from x = 9 m on.
    /// let cells = vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 100];
    /// let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    /// let options = GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free };
    /// let grid = OccupancyGrid::new(cells, 10, options)?;
    ///
    /// // Three beams, all nearly ahead. The robot drives at 2 m/s, so it is 1 m nearer for each beam.
    /// let laser = LaserScanner::new(ScannerOptions { layout: BeamLayout::Fov(1e-9), beam_count: 3, ..ScannerOptions::default() })?;
    /// let courses = Courses::Arcs { poses: &[[1.0, 0.5, 0.0]], twists: &[[2.0, 0.0, 0.0]] };
    /// let mut readings = [0.0; 3];
    /// laser.sweep_batch(&grid, Sweeps { courses, scan_duration: 1.0, obstacles: &[] }, None, None, &mut readings)?;
    /// assert_eq!(readings, [8.0, 7.0, 6.0]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Row`]: a pose or a twist is not finite.
    /// - [`Error::Number`]: `scan_duration` is negative or not finite, or an obstacle's numbers are not finite.
    /// - [`Error::Length`]: there is not one twist for each pose, not one pose for each beam, or `readings` does not have one
    ///   element for each beam of each scan.
    /// - [`Error::Count`], [`Error::Threads`], [`Error::Kernel`], [`Error::Memory`]: as in
    ///   [`scan_batch`](Self::scan_batch).
    pub fn sweep_batch(
        &self,
        grid: &OccupancyGrid,
        sweeps: Sweeps<'_>,
        noise: Option<Noise>,
        threads: Option<usize>,
        readings: &mut [f32],
    ) -> Result<(), Error> {
        let (beam_count, max_range) = (self.options.beam_count, self.options.max_range);
        let plan = self.plan(sweeps, threads)?;
        if readings.len() != plan.scans * beam_count {
            return Err(Error::Length { name: "out", value: readings.len(), needed: plan.scans * beam_count });
        }
        let caster = self.caster(grid.into())?;
        self.prepare(grid.into(), noise.as_ref().and_then(Noise::surface), threads)?;
        let at_a_time = caster.fans_per_cast(plan.scans, self.cos.len(), thread_count(threads, readings.len())?);
        for_each_chunk(threads, readings, at_a_time * beam_count, |chunk, readings| {
            let first = chunk * at_a_time;
            let scans = first..first + readings.len() / beam_count;
            let readings = readings.chunks_exact_mut(beam_count);
            let Some(noise @ Noise { model, seed, first_index, .. }) = &noise else {
                let sinks = readings.map(|ranges| StoreRanges { max_range, ranges });
                return self.cast_sweeps(caster, &plan, scans, 0.0, sinks);
            };
            let bits = scans.clone().map(|scan| BeamBits::new(*seed, first_index.wrapping_add(scan as u64)));
            let samplers = bits.clone().map(|bits| Sampler::new(model, max_range, bits));
            let Some(surface) = noise.surface() else {
                let sinks = samplers.zip(readings).map(|(sampler, readings)| Noisy { sampler, readings });
                return self.cast_sweeps(caster, &plan, scans, 0.0, sinks);
            };
            let walls = grid.walls(Some(1))?;
            let footprints = self.footprints_of_sweeps(caster, &plan, scans.clone(), &bits, surface)?;
            let sinks = samplers.zip(scans.clone()).zip(readings).map(|((sampler, scan), readings)| Surfaced {
                scene: Moving { grid, sweep: self.sweep(&plan, scan, 0.0), passing: &plan.passing },
                grid,
                walls,
                surface,
                footprints: footprints.as_ref().map(|footprints| footprints.of_scan(scan - first, self.cos.len())),
                sampler,
                fixed: BeamBits::of_places(*seed),
                max_range,
                cos: &self.cos,
                sin: &self.sin,
                ends: Vec::new(),
                readings,
            });
            self.cast_sweeps(caster, &plan, scans, 0.0, sinks)
        })
    }

    /// Writes where each robot is at the time of each beam to `poses`, as `[x, y, yaw]` \[m, rad\]; robot by robot.
    ///
    /// These are the poses from which [`sweep_batch`](Self::sweep_batch) takes the beams. Yaws are not wrapped.
    ///
    /// # Errors
    /// Those of [`sweep_batch`](Self::sweep_batch).
    pub fn beam_poses(&self, courses: Courses<'_>, scan_duration: f64, poses: &mut [[f64; 3]]) -> Result<(), Error> {
        let beam_count = self.options.beam_count;
        let time_increment = self.checked_time_increment(scan_duration)?;
        let scans = courses.checked(beam_count, Some(1))?;
        if poses.len() != scans * beam_count {
            return Err(Error::Length { name: "out", value: poses.len(), needed: scans * beam_count });
        }
        for_each_chunk(Some(1), poses, beam_count, |scan, poses| {
            let course = courses.course(scan, beam_count);
            let (mut columns, mut last) = (PoseColumns::ORIGIN, Last::default());
            for (group, poses) in poses.chunks_mut(GROUP).enumerate() {
                course.write_poses(group, time_increment, &mut columns, &mut last);
                for (slot, pose) in poses.iter_mut().enumerate() {
                    *pose = [columns.x[slot], columns.y[slot], columns.yaw[slot]];
                }
            }
            Ok(())
        })
    }

    fn checked_time_increment(&self, scan_duration: f64) -> Result<f64, Error> {
        check_number("scan_duration", scan_duration, "at least 0", |value| value >= 0.0)?;
        Ok(self.time_increment(scan_duration))
    }

    /// Checks a batch of scans that take time.
    pub(super) fn plan<'a>(&self, sweeps: Sweeps<'a>, threads: Option<usize>) -> Result<Plan<'a>, Error> {
        let Sweeps { courses, scan_duration, obstacles } = sweeps;
        let time_increment = self.checked_time_increment(scan_duration)?;
        let beam_count = self.options.beam_count;
        let scans = courses.checked(beam_count, threads)?;
        for obstacle in obstacles {
            obstacle.course.check(beam_count)?;
        }
        let passing = Passing::new(obstacles, beam_count, time_increment, self.options.max_range)?;
        Ok(Plan { courses, scans, time_increment, passing })
    }

    /// Returns the rays of a scan, turned by an angle \[rad\].
    fn sweep<'a>(&'a self, plan: &Plan<'a>, scan: usize, angle: f64) -> Sweep<'a> {
        self.sweep_of(plan, plan.courses.course(scan, self.options.beam_count), angle)
    }

    /// Returns the rays of a scan from a robot on this course, turned by an angle \[rad\].
    fn sweep_of<'a>(&'a self, plan: &Plan<'_>, course: Course<'a>, angle: f64) -> Sweep<'a> {
        let Self { cos, sin, base_from_fan, options, .. } = self;
        let base_from_fan = Pose { yaw: base_from_fan.yaw + angle, ..*base_from_fan };
        let time_increment = plan.time_increment;
        Sweep { course, time_increment, base_from_fan, cos, sin, count: options.beam_count }
    }

    /// Casts all beams of some scans, turned by an angle \[rad\], and sends the ranges of each scan to its own sink.
    pub(super) fn cast_sweeps<S: Sink>(
        &self,
        caster: Caster<'_>,
        plan: &Plan<'_>,
        scans: Range<usize>,
        angle: f64,
        sinks: impl Iterator<Item = S>,
    ) -> Result<(), Error> {
        let Self { cos, sin, slant, .. } = self;
        let passing = &plan.passing;
        let mut sweeps = [self.sweep_of(plan, Course::Poses(&[]), angle); Fans::MAX];
        let count = scans.len();
        for (place, scan) in sweeps.iter_mut().zip(scans) {
            *place = self.sweep(plan, scan, angle);
        }
        caster.with_sweeps(&sweeps[..count], |swept| {
            let mut scans = swept.map_from_fan.chunks_exact(cos.len());
            let mut sinks = sinks.map(|sink| {
                let scan = scans.next();
                let limits = (self.options.beam_count, self.options.max_range);
                let onward =
                    scan.and_then(|poses| Onward::passing_by::<S>(caster.grid(), passing, poses, limits, caster.kernel()));
                let foreground = scan.filter(|_| !passing.is_empty() || slant.is_some());
                let foreground = foreground.map(|map_from_fan| PassingBy { passing, map_from_fan });
                Beyond { foreground, onward, slant: slant.as_ref(), cos, sin, sink }
            });
            if let Some(sink) = sinks.next() {
                swept.cast(SinkPerScan { sink, upcoming: sinks, groups: cos.len(), first: 0 });
            }
        })
    }
}

/// A batch of scans that take time, after its checks.
pub(super) struct Plan<'a> {
    courses: Courses<'a>,
    pub scans: usize,
    time_increment: f64,
    passing: Passing<'a>,
}
