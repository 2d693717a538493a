//! Laser scanners: the only owner of beam angles; one scan, a batch of scans.

use std::f64::consts::TAU;
use std::iter;

use glam::DVec2;

use crate::beam_model::{BeamModel, Sampler};
use crate::error::{Error, check_number, check_rows};
use crate::obstacles::{Spread, View};
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Caster, Fans, GROUP, Group, Kernel, Sink, Start, UpTo, store};
use crate::threads;
use crate::world::World;

/// Parameters of a [`LaserScanner`], with the defaults of a SICK S300.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScannerOptions {
    /// Field of view in radians, at most a full turn.
    pub fov: f64,
    /// Number of beams, which is the number of ranges.
    pub beam_count: usize,
    /// Returns nearer than this are too close to be valid \[m\].
    pub min_range: f64,
    /// Range of a beam without a return \[m\].
    pub max_range: f64,
    /// Pose of the scanner on the robot: `base_from_laser`.
    pub mount: Pose,
}

impl Default for ScannerOptions {
    fn default() -> Self {
        Self { fov: 4.71, beam_count: 541, min_range: 0.05, max_range: 30.0, mount: Pose::default() }
    }
}

/// Noise on a batch of scans: scan `i` of the batch draws from the stream `(seed, first_index + i)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The model of a beam.
    pub model: BeamModel,
    /// Seed of the streams.
    pub seed: u64,
    /// Index of the first scan.
    pub first_index: u64,
}

/// What a message holds for a beam without a return.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoReturn {
    /// `+inf`, as REP-117 has it.
    #[default]
    Inf,
    /// The maximum range.
    Max,
}

/// The largest number of beams.
pub const MAX_BEAMS: usize = 1_000_000;

/// Fields of view this near to a full turn are one: the last beam would fall on the first.
const FULL_TURN_TOLERANCE: f64 = 1e-6;

/// A planar scanner whose beams spread evenly over its field of view.
#[derive(Debug, Clone)]
pub struct LaserScanner {
    options: ScannerOptions,
    angle_min: f64,
    angle_increment: f64,
    /// Cosines of the beams' angles.
    cos: Vec<Group>,
    /// Sines of the beams' angles.
    sin: Vec<Group>,
    kernel: Option<Kernel>,
}

impl LaserScanner {
    /// The scanner with these parameters.
    ///
    /// Beam `i` points at `angle_min + i · angle_increment`: both ends of the field of view have a beam, unless it is a full turn
    /// (to within 1e-6), whose ends are one. A single beam looks along the middle.
    ///
    /// # Errors
    /// A field of view outside of (0, 2π], no beams or more than a million, ranges that are not `0 <= min < max`, a mount that
    /// is not finite.
    pub fn new(options: ScannerOptions) -> Result<Self, Error> {
        let ScannerOptions { fov, beam_count, min_range, max_range, mount } = options;
        check_number("fov", fov, "in (0, 2π]", |value| value > 0.0 && value < TAU + FULL_TURN_TOLERANCE)?;
        if !(1..=MAX_BEAMS).contains(&beam_count) {
            return Err(Error::Count { name: "beam_count", value: beam_count, needed: "in 1..1000000" });
        }
        check_number("min_range", min_range, "at least 0", |value| value >= 0.0)?;
        check_number("max_range", max_range, "greater than min_range", |value| value > min_range)?;
        check_number("max_range", max_range, "a float32", |value| value <= f32::MAX.into())?;
        check_number("mount x", mount.position.x, "finite", |_| true)?;
        check_number("mount y", mount.position.y, "finite", |_| true)?;
        check_number("mount yaw", mount.yaw, "finite", |_| true)?;
        let gaps = if (fov - TAU).abs() < FULL_TURN_TOLERANCE { beam_count } else { beam_count - 1 };
        let (angle_min, angle_increment) = if beam_count == 1 { (0.0, 0.0) } else { (-0.5 * fov, fov / gaps as f64) };
        let groups = beam_count.div_ceil(GROUP);
        let (mut cos, mut sin) = (vec![[1.0; GROUP]; groups], vec![[0.0; GROUP]; groups]);
        for beam in 0..beam_count {
            let (group, place) = (beam / GROUP, beam % GROUP);
            (sin[group][place], cos[group][place]) = libm::sincos(angle_min + beam as f64 * angle_increment);
        }
        Ok(Self { options, angle_min, angle_increment, cos, sin, kernel: None })
    }

    /// The parameters.
    #[must_use]
    pub fn options(&self) -> ScannerOptions {
        self.options
    }

    /// Angle of beam 0 in the scanner's frame.
    #[must_use]
    pub fn angle_min(&self) -> f64 {
        self.angle_min
    }

    /// Angle of the last beam.
    #[must_use]
    pub fn angle_max(&self) -> f64 {
        self.angle(self.options.beam_count - 1)
    }

    /// Angle from one beam to the next.
    #[must_use]
    pub fn angle_increment(&self) -> f64 {
        self.angle_increment
    }

    /// Angle of a beam in the scanner's frame.
    #[must_use]
    pub fn angle(&self, beam: usize) -> f64 {
        self.angle_min + beam as f64 * self.angle_increment
    }

    /// Ranges \[m\] from the robot's pose `map_from_base`, the maximum range where there is no return.
    ///
    /// # Panics
    /// If `ranges` does not have an element for each beam.
    ///
    /// # Errors
    /// A kernel asked for by the environment that this machine does not have.
    pub fn scan<'a>(&self, world: impl Into<World<'a>>, map_from_base: Pose, ranges: &mut [f32]) -> Result<(), Error> {
        let (world, max_range) = (world.into(), self.options.max_range);
        assert_eq!(ranges.len(), self.options.beam_count, "one range per beam");
        self.cast(self.caster(world)?, world, iter::once(map_from_base), iter::once(UpTo { max_range, ranges }));
        Ok(())
    }

    /// Readings \[m\] from each robot's pose, `[x, y, yaw]` in the map frame: as many for each as there are beams, one pose after
    /// the other. The same for any number of threads.
    ///
    /// # Errors
    /// Poses that are not finite, a wrong number of `readings`, no threads to be had.
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
        let max_range = self.options.max_range;
        let caster = self.caster(world)?;
        world.grid.prepare(threads);
        let at_a_time = caster.at_a_time(poses.len(), self.cos.len(), threads::sharing(threads, readings.len())?);
        threads::for_each_chunk(threads, readings, at_a_time * beam_count, |chunk, readings| {
            let first = chunk * at_a_time;
            let poses = poses[first..].iter().map(|&pose| Pose::from(pose)).take(readings.len() / beam_count);
            let readings = readings.chunks_exact_mut(beam_count);
            if let Some(Noise { model, seed, first_index }) = &noise {
                let sinks = (first..).zip(readings).map(|(scan, readings)| {
                    let bits = BeamBits::new(*seed, first_index.wrapping_add(scan as u64));
                    Noisy { sampler: Sampler::new(model, max_range, bits), readings }
                });
                self.cast(caster, world, poses, sinks);
            } else {
                self.cast(caster, world, poses, readings.map(|ranges| UpTo { max_range, ranges }));
            }
        })
    }

    /// Marks, as REP-117 asks of a message, readings that are no valid return: too close `-inf`, no return as `no_return` says.
    pub fn mark_invalid(&self, readings: &mut [f32], no_return: NoReturn) {
        let (min, max) = (self.options.min_range as f32, self.options.max_range as f32);
        let missing = if no_return == NoReturn::Inf { f32::INFINITY } else { max };
        for reading in readings {
            if *reading < min {
                *reading = f32::NEG_INFINITY;
            } else if *reading >= max {
                *reading = missing;
            }
        }
    }

    /// Points \[m\] of the map frame that the valid returns among `readings` came from, `[x, y]` each.
    ///
    /// # Errors
    /// Not one reading for each beam.
    pub fn end_points(&self, map_from_base: Pose, readings: &[f32]) -> Result<Vec<[f64; 2]>, Error> {
        if readings.len() != self.options.beam_count {
            return Err(Error::Length { name: "readings", value: readings.len(), needed: self.options.beam_count });
        }
        let map_from_laser = map_from_base * self.options.mount;
        let valid = self.options.min_range as f32..self.options.max_range as f32;
        let returns = readings
            .iter()
            .zip(self.cos.as_flattened().iter().zip(self.sin.as_flattened()))
            .filter(|(reading, _)| valid.contains(reading));
        let point = |(&reading, (&cos, &sin)): (&f32, (&f64, &f64))| {
            map_from_laser.transform_point(DVec2::new(cos, sin) * f64::from(reading)).to_array()
        };
        Ok(returns.map(point).collect())
    }

    /// The same scanner, casting by this kernel.
    #[must_use]
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel: Some(kernel), ..self }
    }

    fn caster<'a>(&self, world: World<'a>) -> Result<Caster<'a>, Error> {
        Ok(Caster::new(world.grid, self.options.max_range, self.kernel.map_or_else(Kernel::chosen, Ok)?))
    }

    /// Casts all beams from each pose, with a sink for each.
    fn cast(
        &self,
        caster: Caster<'_>,
        World { grid, obstacles }: World<'_>,
        poses: impl Iterator<Item = Pose> + Clone,
        sinks: impl Iterator<Item = impl Sink>,
    ) {
        let Self { cos, sin, options: ScannerOptions { beam_count, max_range, mount, .. }, .. } = self;
        let map_from_laser = |map_from_base: Pose| map_from_base * *mount;
        let mut starts = [Start::default(); Fans::MOST];
        let mut count = 0;
        for (start, map_from_base) in starts.iter_mut().zip(poses.clone()) {
            *start = Start::new(grid, grid.pose_in_grid(map_from_laser(map_from_base)));
            count += 1;
        }
        debug_assert!(poses.clone().nth(Fans::MOST).is_none(), "more scans than are cast at a time");
        let mut sinks = poses.zip(sinks).map(|(map_from_base, sink)| {
            let view = || View::new(obstacles, map_from_laser(map_from_base), self.spread(), *max_range);
            let view = (!obstacles.is_empty()).then(view).filter(|view| !view.is_empty());
            Shortened { view, cos, sin, sink }
        });
        let Some(sink) = sinks.next() else { return };
        let fans = Fans { starts: &starts[..count], cos, sin, count: *beam_count };
        caster.cast_fans(fans, InTurn { sink, upcoming: sinks, groups: cos.len(), first: 0 });
    }

    fn spread(&self) -> Spread {
        let Self { options: ScannerOptions { beam_count, .. }, angle_min, angle_increment, .. } = *self;
        Spread { angle_min, angle_increment, beam_count }
    }
}

/// Hands the groups of scans to a sink for each.
struct InTurn<S, N> {
    sink: S,
    /// Those of the scans to come.
    upcoming: N,
    /// Number of groups of a scan.
    groups: usize,
    /// The first group of the scan that is under way.
    first: usize,
}

impl<S: Sink, N: Iterator<Item = S>> InTurn<S, N> {
    // Not to become part of the loop over groups.
    #[inline(never)]
    fn turn_to_next(&mut self) {
        self.first += self.groups;
        self.sink = self.upcoming.next().expect("a sink for each scan");
    }
}

impl<S: Sink, N: Iterator<Item = S>> Sink for InTurn<S, N> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        if group == self.first + self.groups {
            self.turn_to_next();
        }
        self.sink.take(group - self.first, ranges);
    }
}

/// Shortens ranges to what obstacles leave of them.
struct Shortened<'a, S> {
    /// What there is to be seen of them, if anything.
    view: Option<View<'a>>,
    cos: &'a [Group],
    sin: &'a [Group],
    sink: S,
}

impl<S: Sink> Sink for Shortened<'_, S> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        let Some(view) = &self.view else { return self.sink.take(group, ranges) };
        let mut ranges = *ranges;
        let (cos, sin) = (&self.cos[group], &self.sin[group]);
        view.shorten(group * GROUP, |place| DVec2::new(cos[place], sin[place]), &mut ranges);
        self.sink.take(group, &ranges);
    }
}

/// Stores readings sampled from a beam model.
struct Noisy<'a> {
    sampler: Sampler<'a>,
    readings: &'a mut [f32],
}

impl Sink for Noisy<'_> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        store(self.readings, group, &self.sampler.sample(group, ranges));
    }
}
