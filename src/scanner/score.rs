//! The log-likelihood of scans, given the poses from which they may have been taken.

use super::sinks::Scoring;
use super::sweep::Sweeps;
use super::{LaserScanner, ScannerOptions};
use crate::batch::{check_rows, for_each_heavy_chunk, thread_count};
use crate::beam_model::BeamModel;
use crate::error::{Error, check_number};
use crate::grid::OccupancyGrid;
use crate::memory;
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;
use crate::scorer::{Product, ReadingColumns, Scorer};
use crate::world::World;

/// The readings that are scored \[m\].
#[derive(Debug, Clone, Copy)]
pub enum Readings<'a> {
    /// One scan for all poses.
    One(&'a [f32]),
    /// A scan for each pose, scan by scan.
    Each(&'a [f32]),
}

/// How readings are scored.
#[derive(Debug)]
pub struct Score<'a, M = BeamModel> {
    /// Model of the readings: a [`BeamModel`], or a [`LikelihoodField`](crate::LikelihoodField).
    pub model: &'a M,
    /// The readings.
    pub readings: Readings<'a>,
    /// Numbers of the beams that count; `None` for all. Others are not cast.
    pub beams: Option<&'a [usize]>,
    /// Factor of the log-likelihood: below 1, because errors of neighbouring beams are alike.
    pub temper: f64,
}

// Derived ones would ask the same of the model.
impl<M> Clone for Score<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Score<'_, M> {}

impl<'a> Readings<'a> {
    /// Returns the readings of one scan.
    pub(crate) fn of(self, scan: usize, beam_count: usize) -> &'a [f32] {
        match self {
            Self::One(readings) => readings,
            Self::Each(readings) => &readings[scan * beam_count..][..beam_count],
        }
    }
}

impl LaserScanner {
    /// Writes the log-likelihood of the readings, as taken from each pose, to `scores`.
    ///
    /// It is `temper · Σ ln p(reading | range)` over the beams, where `p` is [`BeamModel::likelihood`] and the range is that of
    /// [`scan`](Self::scan): densities in 1/m, or probabilities where readings have one. It is minus infinity if a reading is
    /// impossible. Readings that are NaN do not count. The scores do not depend on `threads`.
    ///
    /// The numbers are those of `BeamModel::likelihood` to within 1e-9 for each beam. No range is stored.
    ///
    /// ```
    /// use mobile_robot_simulator::{
    ///     BeamModel, BeamModelOptions, GridOptions, LaserScanner, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, Readings, ScannerOptions, Score,
    ///     Unknown,
    /// };
    ///
    /// // A row of ten cells of 1 m; the last one is occupied, from x = 9 m on. The beam ahead reads 4 m.
    /// let cells = vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 100];
    /// let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
    /// let options = GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free };
    /// let grid = OccupancyGrid::new(cells, 10, options)?;
    /// let laser = LaserScanner::new(ScannerOptions { beam_count: 1, ..ScannerOptions::default() })?;
    /// let model = BeamModel::new(BeamModelOptions { sigma_hit: 0.5, z_hit: 0.9, z_rand: 0.1, ..BeamModelOptions::default() })?;
    /// let score = Score { model: &model, readings: Readings::One(&[4.0]), beams: None, temper: 1.0 };
    ///
    /// let mut scores = [0.0; 3];
    /// laser.log_likelihoods(&grid, &[[4.0, 0.5, 0.0], [5.0, 0.5, 0.0], [6.0, 0.5, 0.0]], score, None, &mut scores)?;
    /// assert!(scores[1] > scores[0] && scores[1] > scores[2]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Row`]: a pose is not finite.
    /// - [`Error::Length`]: there is not one reading for each beam, or not one score for each pose.
    /// - [`Error::Number`]: `temper` is not positive and finite.
    /// - [`Error::Count`]: a beam of `beams` does not exist; or as in [`scan_batch`](Self::scan_batch).
    /// - [`Error::Threads`], [`Error::Kernel`], [`Error::Memory`]: as in [`scan_batch`](Self::scan_batch).
    pub fn log_likelihoods<'a>(
        &self,
        world: impl Into<World<'a>>,
        poses: &[[f64; 3]],
        score: Score<'_>,
        threads: Option<usize>,
        scores: &mut [f64],
    ) -> Result<(), Error> {
        let world = world.into();
        check_rows("poses", poses, threads)?;
        self.check_score(score, poses.len(), scores.len())?;
        let selected = score.beams.map(|beams| self.selected(beams)).transpose()?;
        let scanner = selected.as_ref().unwrap_or(self);
        let beams = scanner.options.beam_count;
        let scoring = Scorings::new(self, score, Unused::NotCast)?;
        let caster = scanner.caster(world)?;
        caster.prepare(threads)?;
        let work = scores.len().saturating_mul(beams);
        let at_a_time = caster.fans_per_cast(poses.len(), scanner.cos.len(), thread_count(threads, work)?);
        for_each_heavy_chunk(threads, scores, beams, at_a_time, |chunk, scores| {
            let first = chunk * at_a_time;
            let columns = scoring.columns(first, scores.len())?;
            let poses =
                poses[first..].iter().map(|&pose| (Pose::from(pose) * scanner.base_from_fan, world)).take(scores.len());
            scanner.cast(caster, world.grid, poses, scoring.sinks(&columns, scores))
        })
    }

    /// The same for scans that take time: `sweeps` says how robots and obstacles moved.
    ///
    /// All beams are cast, also those that do not count.
    ///
    /// # Errors
    /// Those of [`log_likelihoods`](Self::log_likelihoods) and of [`sweep_batch`](Self::sweep_batch).
    pub fn log_likelihoods_of_sweeps(
        &self,
        grid: &OccupancyGrid,
        sweeps: Sweeps<'_>,
        score: Score<'_>,
        threads: Option<usize>,
        scores: &mut [f64],
    ) -> Result<(), Error> {
        let plan = self.plan(sweeps, threads)?;
        self.check_score(score, plan.scans, scores.len())?;
        let beams = self.options.beam_count;
        let scoring = Scorings::new(self, score, Unused::LeftOut)?;
        let caster = self.caster(grid.into())?;
        caster.prepare(threads)?;
        let work = scores.len().saturating_mul(beams);
        let at_a_time = caster.fans_per_cast(plan.scans, self.cos.len(), thread_count(threads, work)?);
        for_each_heavy_chunk(threads, scores, beams, at_a_time, |chunk, scores| {
            let first = chunk * at_a_time;
            let columns = scoring.columns(first, scores.len())?;
            let scans = first..first + scores.len();
            self.cast_sweeps(caster, &plan, scans, 0.0, scoring.sinks(&columns, scores))
        })
    }

    /// Checks everything but the poses.
    pub(crate) fn check_score<M>(&self, score: Score<'_, M>, scans: usize, scores: usize) -> Result<(), Error> {
        let beam_count = self.options.beam_count;
        check_number("temper", score.temper, "positive", |value| value > 0.0)?;
        let (given, needed) = match score.readings {
            Readings::One(readings) => (readings.len(), beam_count),
            Readings::Each(readings) => (readings.len(), scans * beam_count),
        };
        if given != needed {
            return Err(Error::Length { name: "ranges", value: given, needed });
        }
        if scores != scans {
            return Err(Error::Length { name: "out", value: scores, needed: scans });
        }
        match score.beams.into_iter().flatten().find(|&&beam| beam >= beam_count) {
            Some(&value) => Err(Error::Count { name: "beams", value, needed: "less than beam_count" }),
            None => Ok(()),
        }
    }

    /// Returns the end points of the valid returns of a scan in the base frame \[m\], of some of its beams; `None` for all.
    ///
    /// Beams of a tilted scanner that end within `tolerance` \[m\] of the floor, or behind it, are left out.
    pub(crate) fn ends(&self, readings: &[f32], beams: Option<&[usize]>, tolerance: f64) -> Result<Vec<[f64; 2]>, Error> {
        let is_unlimited = beams.is_none() && self.slant.is_none();
        if is_unlimited {
            return self.end_points(Pose::default(), readings);
        }
        let mut chosen = memory::filled("the readings", f32::NAN, readings.len())?;
        let mut choose = |beam: usize| {
            let floor = self.slant.as_ref().map_or(f64::INFINITY, |slant| slant.floor(beam));
            if f64::from(readings[beam]) < floor - tolerance {
                chosen[beam] = readings[beam];
            }
        };
        match beams {
            Some(beams) => beams.iter().for_each(|&beam| choose(beam)),
            None => (0..readings.len()).for_each(&mut choose),
        }
        self.end_points(Pose::default(), &chosen)
    }

    /// Returns the scanner that has only some of the beams. Angles of its beams are not those of a layout.
    fn selected(&self, beams: &[usize]) -> Result<Self, Error> {
        let groups = beams.len().div_ceil(GROUP);
        let of = |table: &[Group], padding: f64| {
            let mut selected = memory::filled("the beams", [padding; GROUP], groups)?;
            for (to, &beam) in selected.as_flattened_mut().iter_mut().zip(beams) {
                *to = table.as_flattened()[beam];
            }
            Ok::<_, Error>(selected)
        };
        let (cos, sin) = (of(&self.cos, 1.0)?, of(&self.sin, 0.0)?);
        let slant = self.slant.as_ref().map(|slant| slant.selected(beams)).transpose()?;
        let options = ScannerOptions { beam_count: beams.len(), ..self.options };
        Ok(Self { options, cos, sin, slant, horizontal: None, coarse: None, ..*self })
    }
}

/// What happens to beams that do not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unused {
    /// They are not cast.
    NotCast,
    /// They are cast, and left out of the score.
    LeftOut,
}

/// The scores of a batch.
struct Scorings<'a> {
    scorer: Scorer,
    score: Score<'a>,
    unused: Unused,
    beam_count: usize,
    /// Number of groups of beams that are cast for a scan.
    groups: usize,
    /// The readings that all poses share; empty if there is a scan for each pose.
    shared: Vec<ReadingColumns>,
}

impl<'a> Scorings<'a> {
    fn new(scanner: &LaserScanner, score: Score<'a>, unused: Unused) -> Result<Self, Error> {
        let ScannerOptions { min_range, max_range, beam_count, .. } = scanner.options;
        let scorer = Scorer::new(*score.model, (min_range, max_range), score.temper);
        let cast = score.beams.filter(|_| unused == Unused::NotCast).map_or(beam_count, <[usize]>::len);
        let mut scorings = Self { scorer, score, unused, beam_count, groups: cast.div_ceil(GROUP), shared: Vec::new() };
        if let Readings::One(_) = score.readings {
            scorings.shared = scorings.read(0, 1)?;
        }
        Ok(scorings)
    }

    /// Returns the readings of some scans; empty if all poses share one scan.
    fn columns(&self, first: usize, count: usize) -> Result<Vec<ReadingColumns>, Error> {
        if let Readings::One(_) = self.score.readings { Ok(Vec::new()) } else { self.read(first, count) }
    }

    fn read(&self, first: usize, count: usize) -> Result<Vec<ReadingColumns>, Error> {
        let mut columns = memory::with_room("the readings", count * self.groups)?;
        let mut chosen = memory::filled("the readings", f32::NAN, self.groups * GROUP)?;
        for scan in first..first + count {
            let readings = self.score.readings.of(scan, self.beam_count);
            match (self.score.beams, self.unused) {
                (None, _) => chosen[..readings.len()].copy_from_slice(readings),
                (Some(beams), Unused::NotCast) => {
                    chosen.iter_mut().zip(beams).for_each(|(chosen, &beam)| *chosen = readings[beam]);
                }
                (Some(beams), Unused::LeftOut) => beams.iter().for_each(|&beam| chosen[beam] = readings[beam]),
            }
            columns.extend(chosen.as_chunks().0.iter().map(|readings: &[f32; GROUP]| self.scorer.columns(readings)));
        }
        Ok(columns)
    }

    /// Returns the sinks of some scans, from their readings.
    fn sinks<'b>(&'b self, columns: &'b [ReadingColumns], scores: &'b mut [f64]) -> impl Iterator<Item = Scoring<'b>> {
        scores.iter_mut().enumerate().map(move |(scan, score)| {
            let readings = if columns.is_empty() { &self.shared[..] } else { &columns[scan * self.groups..][..self.groups] };
            Scoring { scorer: &self.scorer, readings, product: Product::ONE, score }
        })
    }
}
