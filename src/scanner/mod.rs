//! Laser scanners: single scans and batches of scans.

mod each;
mod footprint;
mod hits;
mod intensities;
mod onward;
mod order;
mod places;
mod score;
mod sinks;
mod surfaces;
mod sweep;

use std::iter;

use glam::DVec2;

use crate::batch::{check_rows, for_each_chunk, for_each_heavy_chunk, thread_count};
use crate::beam_model::BeamModel;
use crate::beams::{BeamLayout, Beams};
use crate::error::{Error, check_finite, check_number};
use crate::grid::OccupancyGrid;
use crate::memory;
use crate::mount::{Attitude, Mount};
use crate::numeric::{GROUP, Group};
use crate::obstacles::View;
use crate::pose::Pose;
use crate::raycast::{Caster, CoarseBeams, Fans, Kernel, Sink, Start, StoreRanges};
use crate::slant::Slant;
use crate::surface::SurfaceModel;
use crate::world::World;
pub(crate) use each::{Shot, ShotNoise, scan_each};
pub use hits::Hit;
use onward::Onward;
pub use score::{Readings, Score};
use sinks::{Beyond, SinkPerScan};
pub use sweep::{Courses, Sweeps};

/// Parameters of a [`LaserScanner`], with the defaults of a SICK S300.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScannerOptions {
    /// Angles of the beams in the laser frame.
    pub layout: BeamLayout,
    /// Number of beams, equal to the number of ranges of a scan.
    pub beam_count: usize,
    /// Smallest valid range \[m\].
    pub min_range: f64,
    /// Range reported for a beam without a return \[m\].
    pub max_range: f64,
    /// Pose of the laser frame in the robot's base frame: `base_from_laser`.
    pub mount: Mount,
}

impl Default for ScannerOptions {
    fn default() -> Self {
        Self { layout: BeamLayout::Fov(4.71), beam_count: 541, min_range: 0.05, max_range: 30.0, mount: Mount::default() }
    }
}

/// Noise for a batch of scans: the noise of scan `i` is named by `(seed, first_index + i)` and depends on nothing else.
///
/// A batch may therefore be split: its second part starts at `first_index` plus the length of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Distribution of the reading of a beam.
    pub model: BeamModel,
    /// How what a beam meets changes its reading; `None` for not at all.
    pub surface: Option<SurfaceModel>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Index of the first scan of the batch. Indices wrap around at 2⁶⁴.
    pub first_index: u64,
}

impl Noise {
    /// Returns the surface model if it changes something.
    fn surface(&self) -> Option<&SurfaceModel> {
        self.surface.as_ref().filter(|surface| !surface.is_off())
    }
}

/// Value that marks a beam without a return, see [`LaserScanner::mark_invalid`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoReturn {
    /// `+inf`, as in REP-117.
    #[default]
    Inf,
    /// The maximum range of the scanner.
    Max,
    /// 0.1 m less than the maximum range of the scanner, but not less than its minimum range.
    BelowMax,
}

/// Distance of [`NoReturn::BelowMax`] from the maximum range \[m\].
const BELOW_MAX: f32 = 0.1;

/// Number that is added to another, and subtracted again, to round it to a whole number, ties to even.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// Count of quanta from which on a float32 is a whole number of them.
const LARGEST_COUNT: f64 = (1 << 24) as f64;

/// A planar laser scanner whose beams are spread evenly over its field of view.
///
/// ```text
///             y, left
///             ^      beam_count - 1: angle_max
///             |    /
///             |  /
///   laser     +------> x, ahead: angle 0
///                \
///                  \
///                    beam 0: angle_min
/// ```
///
/// Beam `i` points at `angle_min + i · angle_increment` in the laser frame; see [`BeamLayout`]. If the increment is negative,
/// the beams turn clockwise. A tilted scanner measures in space; see [`Mount`] and [`scan`](Self::scan).
#[derive(Debug, Clone)]
pub struct LaserScanner {
    options: ScannerOptions,
    /// Beams in the laser frame.
    beams: Beams,
    /// Pose in the base frame from which the beams spread in the plane, seen from above.
    base_from_fan: Pose,
    /// Beams in that frame; `None` if the scanner is tilted.
    horizontal: Option<Beams>,
    /// Cosines of the angles of the beams in that frame, in groups; the last group is padded.
    cos: Vec<Group>,
    /// Sines of these angles, in groups; the last group is padded.
    sin: Vec<Group>,
    /// Slant of the beams; `None` if the scanner is not tilted.
    slant: Option<Slant>,
    /// Beams that are cast first; `None` if the beams are not dense.
    coarse: Option<CoarseBeams>,
    kernel: Option<Kernel>,
}

impl LaserScanner {
    /// Returns the scanner with these parameters. [`BeamLayout`] tells where its beams point.
    ///
    /// # Errors
    /// - [`Error::Degrees`]: an angle of the layout looks like a number of degrees.
    /// - [`Error::Angles`], [`Error::Steps`]: the beams have no field, or turn by more than a full turn.
    /// - [`Error::Number`]: an angle of the layout is not in its domain, `min_range` is negative, `max_range` is too large for
    ///   a float32, or a number is not finite.
    /// - [`Error::Ranges`]: `max_range` is not above `min_range`.
    /// - [`Error::Count`]: `beam_count` is 0 or more than [`MAX_BEAMS`](crate::MAX_BEAMS).
    pub fn new(options: ScannerOptions) -> Result<Self, Error> {
        let ScannerOptions { layout, beam_count, min_range, max_range, mount } = options;
        let beams = Beams::new(layout, beam_count)?;
        check_number("min_range", min_range, "at least 0", |value| value >= 0.0)?;
        check_finite("max_range", max_range)?;
        if max_range <= min_range {
            return Err(Error::Ranges { min_range, max_range });
        }
        check_number("max_range", max_range, "within the range of float32", |value| value <= f32::MAX.into())?;
        mount.checked()?;
        let groups = beam_count.div_ceil(GROUP);
        let (mut cos, mut sin) =
            (memory::filled("the beams", [1.0; GROUP], groups)?, memory::filled("the beams", [0.0; GROUP], groups)?);
        let (heading, horizontal, slant) = match mount.attitude() {
            Attitude::Level => (mount.heading(), Some(beams), None),
            Attitude::UpsideDown => (mount.heading(), Some(beams.mirrored()), None),
            Attitude::Tilted => (0.0, None, Some(Slant::new(mount, beams, max_range, &mut cos, &mut sin)?)),
        };
        if let Some(beams) = horizontal {
            for beam in 0..beam_count {
                let (group, place) = (beam / GROUP, beam % GROUP);
                (sin[group][place], cos[group][place]) = libm::sincos(beams.angle(beam));
            }
        }
        let base_from_fan = Pose { yaw: heading, ..mount.planar() };
        let coarse = match horizontal {
            Some(beams) => CoarseBeams::new(beams.angle_increment().abs(), &cos, &sin, beam_count)?,
            None => None,
        };
        Ok(Self { options, beams, base_from_fan, horizontal, cos, sin, slant, coarse, kernel: None })
    }

    /// Returns the parameters that the scanner was made with.
    #[must_use]
    pub fn options(&self) -> ScannerOptions {
        self.options
    }

    /// Returns the size of the field of the beams \[rad\], from one end to the other.
    #[must_use]
    pub fn fov(&self) -> f64 {
        if let BeamLayout::Fov(fov) = self.options.layout { fov } else { self.beams.field() }
    }

    /// Returns the angle of beam 0 in the laser frame \[rad\].
    #[must_use]
    pub fn angle_min(&self) -> f64 {
        self.beams.angle_min()
    }

    /// Returns the angle of the last beam in the laser frame \[rad\].
    #[must_use]
    pub fn angle_max(&self) -> f64 {
        self.angle(self.options.beam_count - 1)
    }

    /// Returns the angle from one beam to the next \[rad\]: negative if they turn clockwise, 0 if there is only one.
    #[must_use]
    pub fn angle_increment(&self) -> f64 {
        self.beams.angle_increment()
    }

    /// Returns the angle of a beam in the laser frame \[rad\].
    #[must_use]
    pub fn angle(&self, beam: usize) -> f64 {
        self.beams.angle(beam)
    }

    /// Writes the true range \[m\] of each beam to `ranges`, seen from a robot at `map_from_base`.
    ///
    /// `ranges[i]` is the distance from the laser to the nearest blocking cell or obstacle along beam `i`: 0 if the laser is
    /// inside one, `max_range` without a return. Walls and obstacles have any height. A tilted scanner measures the distance in
    /// space, and also meets the floor if its height is known. `min_range` is not applied, see [`mark_invalid`](Self::mark_invalid). The
    /// robot may be off the grid.
    ///
    /// ```
    /// use mobile_robot_simulator::{
    ///     BeamLayout, GridOptions, LaserScanner, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, ScannerOptions, Unknown,
    /// };
    ///
    /// // A row of ten cells of 1 m; the cell from x = 7 m to x = 8 m is occupied.
    /// let mut cells = vec![0; 10];
    /// cells[7] = 100;
    /// let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    /// let grid = OccupancyGrid::new(
    ///     cells,
    ///     10,
    ///     GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free },
    /// )?;
    ///
    /// let layout = BeamLayout::Fov(std::f64::consts::PI);
    /// let options = ScannerOptions { layout, beam_count: 3, max_range: 20.0, ..ScannerOptions::default() };
    /// let laser = LaserScanner::new(options)?;
    /// let mut ranges = [0.0; 3];
    /// laser.scan(&grid, Pose::new(2.0, 0.5, 0.0), &mut ranges)?;
    /// assert_eq!(ranges, [20.0, 5.0, 20.0]); // right, ahead, left
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `ranges` does not have one element per beam.
    ///
    /// # Errors
    /// - [`Error::Number`]: `map_from_base` is not finite.
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Kernel`]: the environment variable `MOBILE_ROBOT_SIMULATOR_KERNEL` names a kernel that this machine cannot
    ///   run.
    pub fn scan<'a>(&self, world: impl Into<World<'a>>, map_from_base: Pose, ranges: &mut [f32]) -> Result<(), Error> {
        map_from_base.checked()?;
        let (world, max_range) = (world.into(), self.options.max_range);
        assert_eq!(ranges.len(), self.options.beam_count, "ranges must have one element per beam");
        let caster = self.caster(world)?;
        caster.prepare(None)?;
        self.cast(
            caster,
            world.grid,
            iter::once((map_from_base * self.base_from_fan, world)),
            iter::once(StoreRanges { max_range, ranges }),
        )
    }

    /// Writes the readings \[m\] of one scan per pose to `readings`, with noise if `noise` is given.
    ///
    /// `poses[i]` is `[x, y, yaw]` of the robot in the map frame \[m, rad\]. The reading of beam `b` of scan `i` is
    /// `readings[i * beam_count + b]`. Without noise the readings are those of [`scan`](Self::scan).
    ///
    /// The work is shared by `threads` threads, by default as many as there are cores. The readings do not depend on
    /// `threads`.
    ///
    /// # Errors
    /// - [`Error::Row`]: a pose is not finite.
    /// - [`Error::Tilted`]: the scanner is tilted, and surfaces change the readings.
    /// - [`Error::Length`]: `readings` does not have `poses.len() * beam_count` elements.
    /// - [`Error::Count`]: `threads` is 0 or more than 1024.
    /// - [`Error::Threads`]: the system could not start the threads.
    /// - [`Error::Kernel`], [`Error::Memory`]: as in [`scan`](Self::scan).
    pub fn scan_batch<'a>(
        &self,
        world: impl Into<World<'a>>,
        poses: &[[f64; 3]],
        noise: Option<Noise>,
        threads: Option<usize>,
        readings: &mut [f32],
    ) -> Result<(), Error> {
        let world = world.into();
        let beam_count = self.options.beam_count;
        check_rows("poses", poses, threads)?;
        if readings.len() != poses.len() * beam_count {
            return Err(Error::Length { name: "out", value: readings.len(), needed: poses.len() * beam_count });
        }
        let shot = |scan: usize| {
            let noise = noise.as_ref().map(|Noise { model, surface, seed, first_index }| {
                let index = first_index.wrapping_add(scan as u64);
                ShotNoise { model, surface: surface.as_ref(), seed: *seed, index }
            });
            Shot { scanner: self, world, map_from_base: poses[scan].into(), noise }
        };
        self.prepare(world, noise.as_ref().and_then(Noise::surface), threads)?;
        let threads_used = thread_count(threads, readings.len())?;
        let at_a_time = self.caster(world)?.fans_per_cast(poses.len(), self.cos.len(), threads_used);
        if order::matters(world.grid, poses.len(), beam_count) {
            let mut rows = order::along_curve(world.grid, poses, readings, beam_count)?;
            return for_each_heavy_chunk(threads, &mut rows, beam_count, at_a_time, |_, rows| {
                let mut scans = [0; Fans::MAX];
                scans.iter_mut().zip(rows.iter()).for_each(|(scan, (number, _))| *scan = *number);
                let shots = scans[..rows.len()].iter().map(|&scan| shot(scan));
                self.cast_together(&shots, rows.iter_mut().map(|(_, row)| &mut **row))
            });
        }
        for_each_chunk(threads, readings, at_a_time * beam_count, |chunk, readings| {
            let first = chunk * at_a_time;
            let shots = (first..first + readings.len() / beam_count).map(shot);
            self.cast_together(&shots, readings.chunks_exact_mut(beam_count))
        })
    }

    /// Marks the readings that are not valid returns, in place, as REP-117 requires for a message.
    ///
    /// | reading | becomes |
    /// |---|---|
    /// | below `min_range` | `-inf` |
    /// | `max_range` or more | the value that `no_return` says |
    /// | any other, NaN included | unchanged |
    ///
    /// ```
    /// use mobile_robot_simulator::{LaserScanner, NoReturn, ScannerOptions};
    ///
    /// let options = ScannerOptions { min_range: 0.5, max_range: 8.0, ..ScannerOptions::default() };
    /// let mut readings = [0.25, 3.0, 8.0];
    /// LaserScanner::new(options)?.mark_invalid(&mut readings, NoReturn::Inf);
    /// assert_eq!(readings, [f32::NEG_INFINITY, 3.0, f32::INFINITY]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    pub fn mark_invalid(&self, readings: &mut [f32], no_return: NoReturn) {
        let (min, max) = (self.options.min_range as f32, self.options.max_range as f32);
        let missing = match no_return {
            NoReturn::Inf => f32::INFINITY,
            NoReturn::Max => max,
            // The next float32 below `max` if 0.1 m is less than its spacing.
            NoReturn::BelowMax => (max - BELOW_MAX).min(max.next_down()).max(min),
        };
        for reading in readings {
            // A value for each reading, not a branch, so that the compiler uses vector instructions.
            let value = *reading;
            let far = if value >= max { missing } else { value };
            *reading = if value < min { f32::NEG_INFINITY } else { far };
        }
    }

    /// Rounds readings \[m\], in place, so that they compress well: to the nearest multiple of `quantum`, the largest power of
    /// two that is at most `step`.
    ///
    /// Multiples of a power of two are exact in float32, so a reading changes by at most `quantum / 2`. Readings of `max_range`
    /// and above, which are beams without a return, stay as they are, and so do infinities and NaN. A reading below
    /// `max_range` stays below it: where its nearest multiple would not, it becomes the largest multiple that is, and changes
    /// by less than `quantum`.
    ///
    /// Returns `quantum` \[m\].
    ///
    /// ```
    /// use mobile_robot_simulator::{LaserScanner, ScannerOptions};
    ///
    /// let options = ScannerOptions { max_range: 8.1, ..ScannerOptions::default() };
    /// let mut readings = [1.1, 8.05, 8.1];
    /// assert_eq!(LaserScanner::new(options)?.quantize(&mut readings, 0.3)?, 0.25);
    /// assert_eq!(readings, [1.0, 8.0, 8.1]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Number`]: `step` is not in 1e-6..1.
    pub fn quantize(&self, readings: &mut [f32], step: f64) -> Result<f64, Error> {
        check_number("step", step, "in 1e-6..1 m", |step| (1e-6..=1.0).contains(&step))?;
        // The power of two is the exponent of `step`, without its fraction.
        let quantum = f64::from_bits(step.to_bits() & 0x7ff0_0000_0000_0000);
        let max = self.options.max_range as f32;
        let last = ((f64::from(max) / quantum).ceil() - 1.0) * quantum;
        // Exact, as the inverse of a power of two.
        let per_quantum = quantum.recip();
        for reading in readings {
            let count = f64::from(*reading) * per_quantum;
            // Adding it leaves no bits for a fraction, so the sum is rounded to a whole number.
            let rounded = ((count + WHOLE) - WHOLE) * quantum;
            let rounded = (if rounded < last { rounded } else { last }) as f32;
            // A float32 with a larger count has no fraction. Without a branch, the compiler uses vectors.
            let is_rounded = (count.abs() < LARGEST_COUNT) & (*reading < max);
            *reading = if is_rounded { rounded } else { *reading };
        }
        Ok(quantum)
    }

    /// Returns the end points, seen from above, `[x, y]` \[m\] in the map frame of the valid returns of a scan taken from `map_from_base`.
    ///
    /// A reading is valid if `min_range <= reading < max_range`; the other readings give no point. Points are in the order
    /// of beams.
    ///
    /// # Errors
    /// [`Error::Length`] if `readings` does not have one element per beam.
    pub fn end_points(&self, map_from_base: Pose, readings: &[f32]) -> Result<Vec<[f64; 2]>, Error> {
        if readings.len() != self.options.beam_count {
            return Err(Error::Length { name: "readings", value: readings.len(), needed: self.options.beam_count });
        }
        let map_from_fan = map_from_base * self.base_from_fan;
        let valid = self.options.min_range as f32..self.options.max_range as f32;
        let returns = readings
            .iter()
            .zip(self.cos.as_flattened().iter().zip(self.sin.as_flattened()))
            .enumerate()
            .filter(|(_, (reading, _))| valid.contains(reading));
        let point = |(beam, (&reading, (&cos, &sin))): (usize, (&f32, (&f64, &f64)))| {
            let reading = f64::from(reading);
            let distance = self.slant.as_ref().map_or(reading, |slant| slant.horizontal(beam, reading));
            map_from_fan.transform_point(DVec2::new(cos, sin) * distance).to_array()
        };
        let mut points = memory::with_room("the end points", returns.clone().count())?;
        points.extend(returns.map(point));
        Ok(points)
    }

    /// Returns the same scanner, but casting with `kernel`, regardless of the environment. All kernels give the same ranges.
    #[must_use]
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel: Some(kernel), ..self }
    }

    fn caster<'a>(&self, world: World<'a>) -> Result<Caster<'a>, Error> {
        Caster::new(world.grid, self.options.max_range, self.kernel.map_or_else(Kernel::chosen, Ok)?)
    }

    /// Casts all beams from each pose of the frame from which they spread, among the obstacles of its world, and sends the ranges of
    /// each scan to its own sink.
    fn cast<'a, S: Sink>(
        &self,
        caster: Caster<'_>,
        grid: &OccupancyGrid,
        scans: impl Iterator<Item = (Pose, World<'a>)> + Clone,
        sinks: impl Iterator<Item = S>,
    ) -> Result<(), Error> {
        let Self { cos, sin, slant, options: ScannerOptions { beam_count, max_range, .. }, .. } = self;
        let mut starts = [Start::default(); Fans::MAX];
        let mut count = 0;
        for (start, (map_from_fan, _)) in starts.iter_mut().zip(scans.clone()) {
            *start = Start::new(grid, grid.pose_in_grid(map_from_fan));
            count += 1;
        }
        debug_assert!(scans.clone().nth(Fans::MAX).is_none(), "too many scans for one call");
        // Without obstacles and slant, the array is neither filled nor moved.
        let has_views = slant.is_some() || scans.clone().any(|(_, world)| !world.obstacles.is_empty());
        let mut views = has_views.then_some([const { None }; Fans::MAX]);
        for (view, (map_from_fan, world)) in views.iter_mut().flatten().zip(scans.clone()) {
            let (obstacles, beams) = ((world.obstacles, world.except), self.horizontal);
            let seen = View::new(obstacles, map_from_fan, beams, (cos, sin), *beam_count, *max_range)?;
            *view = (!seen.is_empty() || slant.is_some()).then_some(seen);
        }
        let mut views = views.iter_mut().flatten();
        let mut worlds = scans;
        let mut sinks = sinks.map(|sink| {
            let view = views.next().and_then(Option::take);
            let onward = worlds.next().and_then(|(map_from_fan, world)| {
                Onward::in_world::<S>(world, map_from_fan, (*beam_count, *max_range), caster.kernel())
            });
            Beyond { foreground: view, onward, slant: slant.as_ref(), cos, sin, sink }
        });
        let Some(sink) = sinks.next() else { return Ok(()) };
        let fans = Fans { starts: &starts[..count], cos, sin, count: *beam_count, coarse: self.coarse.as_ref() };
        caster.cast_fans(fans, SinkPerScan { sink, upcoming: sinks, groups: cos.len(), first: 0 })
    }
}
