//! The likelihood field model: how near to a wall the readings of a scan end.

use std::f64::consts::PI;

use glam::DVec2;

use crate::batch::{check_rows, for_each_heavy_chunk};
use crate::distance_field::DistanceField;
use crate::error::{Error, check_number};
use crate::grid::OccupancyGrid;
use crate::memory;
use crate::pose::Pose;
use crate::scanner::{LaserScanner, Readings, Score};

/// Number of scans that a thread scores at a time.
const SCANS: usize = 64;

/// Parameters of a [`LikelihoodField`], with the defaults of AMCL.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LikelihoodFieldOptions {
    /// Standard deviation of the distance from the end of a reading to the nearest wall \[m\].
    pub sigma_hit: f64,
    /// Weight of readings that end at a wall.
    pub z_hit: f64,
    /// Weight of readings that end anywhere.
    pub z_rand: f64,
    /// Largest distance to a wall; longer ones count as this one \[m\].
    pub max_distance: f64,
}

impl Default for LikelihoodFieldOptions {
    fn default() -> Self {
        Self { sigma_hit: 0.2, z_hit: 0.95, z_rand: 0.05, max_distance: 2.0 }
    }
}

/// A model of readings that looks only at where they end, and casts no beams.
///
/// With `d` for the distance from the end of a reading to the nearest wall, the likelihood of the reading is
///
/// ```text
/// z_hit · exp(-d² / 2σ²) / (σ · √(2π)) + z_rand / max_range
/// ```
///
/// `d` is the distance between the centre of the cell in which the reading ends and the centre of the nearest blocking cell,
/// or `max_distance` if that is smaller. Readings without a return and those below the minimum range do not count, and
/// neither do those that may have met the floor. It is not a density of the reading: what lies between the scanner and
/// the end of the beam does not matter, so a pose behind a wall may score as well as the one in front of it.
///
/// Source: Thrun, Burgard & Fox, *Probabilistic Robotics*, 2005, table 6.3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LikelihoodField {
    options: LikelihoodFieldOptions,
}

impl LikelihoodField {
    /// Returns the model with these parameters, the weights scaled to sum to 1.
    ///
    /// # Errors
    /// [`Error::Number`]: `sigma_hit` or `max_distance` is not positive, a weight is negative, or a number is not finite; or
    /// `z_hit` and `z_rand` are both 0.
    pub fn new(options: LikelihoodFieldOptions) -> Result<Self, Error> {
        check_number("sigma_hit", options.sigma_hit, "positive", |value| value > 0.0)?;
        check_number("z_hit", options.z_hit, "at least 0", |value| value >= 0.0)?;
        check_number("z_rand", options.z_rand, "at least 0", |value| value >= 0.0)?;
        check_number("max_distance", options.max_distance, "positive", |value| value > 0.0)?;
        let sum = options.z_hit + options.z_rand;
        check_number("z_hit + z_rand", sum, "positive", |value| value > 0.0)?;
        Ok(Self { options: LikelihoodFieldOptions { z_hit: options.z_hit / sum, z_rand: options.z_rand / sum, ..options } })
    }

    /// Returns the parameters, with the weights after scaling.
    #[must_use]
    pub fn options(&self) -> LikelihoodFieldOptions {
        self.options
    }

    /// Returns the likelihood of a reading that ends at this distance from a wall \[m\].
    #[must_use]
    pub fn likelihood(&self, distance: f64, max_range: f64) -> f64 {
        let LikelihoodFieldOptions { sigma_hit, z_hit, z_rand, max_distance } = self.options;
        let deviation = distance.min(max_distance) / sigma_hit;
        z_hit * libm::exp(-0.5 * deviation * deviation) / (sigma_hit * libm::sqrt(2.0 * PI)) + z_rand / max_range
    }

    /// Writes the log-likelihood of the readings, as taken from each pose, to `scores`.
    ///
    /// It is `temper · Σ ln p` over the beams that count. The scores do not depend on `threads`. The distances of the grid
    /// are kept until its cells change, see [`OccupancyGrid::distances`].
    ///
    /// ```
    /// use mobile_robot_simulator::{
    ///     GridOptions, LaserScanner, LikelihoodField, LikelihoodFieldOptions, OccupancyGrid, Pose, Readings, ScannerOptions,
    ///     Score, Unknown,
    /// };
    ///
    /// // A row of ten cells of 1 m; the last one is occupied. The beam ahead reads 4 m.
    /// let options =
    ///     GridOptions { resolution: 1.0, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
    /// let grid = OccupancyGrid::new(vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 100], 10, options)?;
    /// let laser = LaserScanner::new(ScannerOptions { beam_count: 1, ..ScannerOptions::default() })?;
    /// let model = LikelihoodField::new(LikelihoodFieldOptions::default())?;
    /// let score = Score { model: &model, readings: Readings::One(&[4.0]), beams: None, temper: 1.0 };
    ///
    /// let mut scores = [0.0; 3];
    /// model.log_likelihoods(&laser, &grid, &[[4.2, 0.5, 0.0], [5.2, 0.5, 0.0], [6.2, 0.5, 0.0]], score, None, &mut scores)?;
    /// assert!(scores[1] > scores[0] && scores[1] > scores[2]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Row`]: a pose is not finite.
    /// - [`Error::Length`]: there is not one reading for each beam, or not one score for each pose.
    /// - [`Error::Number`]: `temper` is not positive and finite, or `max_distance` is longer than 255 cells of the grid.
    /// - [`Error::Count`]: a beam of `beams` does not exist, or `threads` is 0 or more than 1024.
    /// - [`Error::Threads`]: the system could not start the threads.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn log_likelihoods(
        &self,
        laser: &LaserScanner,
        grid: &OccupancyGrid,
        poses: &[[f64; 3]],
        score: Score<'_, Self>,
        threads: Option<usize>,
        scores: &mut [f64],
    ) -> Result<(), Error> {
        check_rows("poses", poses, threads)?;
        laser.check_score(score, poses.len(), scores.len())?;
        let field = grid.distance_field(self.options.max_distance)?;
        let logs = self.logs(&field, grid.resolution(), laser.options().max_range)?;
        // Readings that may be of the floor say nothing of walls.
        let (beam_count, tolerance) = (laser.options().beam_count, 3.0 * self.options.sigma_hit);
        let ends_of = |scan: usize| laser.ends(score.readings.of(scan, beam_count), score.beams, tolerance);
        let shared = if let Readings::One(_) = score.readings { Some(ends_of(0)?) } else { None };
        for_each_heavy_chunk(threads, scores, beam_count, SCANS, |chunk, scores| {
            for (scan, sum_of_scan) in (chunk * SCANS..).zip(scores) {
                let own;
                let ends = if let Some(shared) = &shared {
                    shared
                } else {
                    own = ends_of(scan)?;
                    &own
                };
                *sum_of_scan = score.temper * sum(&field, &logs, grid, Pose::from(poses[scan]), ends);
            }
            Ok(())
        })
    }

    /// Returns the logarithm of the likelihood for each square of a distance of the field.
    fn logs(&self, field: &DistanceField, resolution: f64, max_range: f64) -> Result<Vec<f64>, Error> {
        let mut logs = memory::with_room("the likelihoods", usize::from(field.beyond()) + 1)?;
        let distances = (0..field.beyond()).map(|square| f64::from(square).sqrt() * resolution);
        let all = distances.chain([self.options.max_distance]);
        logs.extend(all.map(|distance| libm::log(self.likelihood(distance, max_range))));
        Ok(logs)
    }
}

/// Returns the sum of the logarithms over the ends of the readings, given in the base frame \[m\].
fn sum(field: &DistanceField, logs: &[f64], grid: &OccupancyGrid, map_from_base: Pose, ends: &[[f64; 2]]) -> f64 {
    let grid_from_base = grid.pose_in_grid(map_from_base);
    let (sin, cos) = libm::sincos(grid_from_base.yaw);
    let log = |&[x, y]: &[f64; 2]| {
        let at = grid_from_base.position + DVec2::new(cos * x - sin * y, sin * x + cos * y);
        logs[usize::from(field.square_at(grid.in_cells(at)))]
    };
    // Four sums, so that an addition does not wait for the one before it.
    let (groups, rest) = ends.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for group in groups {
        let logs = group.each_ref().map(log);
        sums = std::array::from_fn(|place| sums[place] + logs[place]);
    }
    sums.iter().sum::<f64>() + rest.iter().map(log).sum::<f64>()
}
