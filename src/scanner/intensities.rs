//! Intensities: how much light comes back from the surface at which each beam ends.

use super::{LaserScanner, Sweeps};
use crate::batch::{check_rows, for_each_chunk};
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::StoreIntensities;
use crate::world::World;

impl LaserScanner {
    /// Writes the intensity of each beam of a batch of scans to `intensities`, without noise.
    ///
    /// It is `reflectivity · cos α / r²` of the surface at which the range ends, times the share of the light that mirrors and
    /// glass leave on the way there and back: relative to a white wall at a right angle and a distance of 1 m. `r` is the range
    /// \\[m\\], and α the angle of incidence, for a cell that on the side through which the beam enters. Without a return, and
    /// inside something, it is 0.
    ///
    /// `stream` is the seed and the index of the first scan, if panes of glass are drawn as in
    /// [`scan_batch`](Self::scan_batch) with noise; `None` stands for scans without noise. The method is the plain traversal,
    /// which takes some hundred nanoseconds a beam.
    ///
    /// # Errors
    /// - [`Error::Tilted`]: the scanner is tilted.
    /// - Those of [`scan_batch`](Self::scan_batch).
    pub fn intensities<'a>(
        &self,
        world: impl Into<World<'a>>,
        poses: &[[f64; 3]],
        stream: Option<(u64, u64)>,
        threads: Option<usize>,
        intensities: &mut [f32],
    ) -> Result<(), Error> {
        let (world, beam_count) = (world.into(), self.options.beam_count);
        check_rows("poses", poses, threads)?;
        self.check_intensities(poses.len(), intensities)?;
        let caster = self.caster(world)?;
        caster.prepare(threads)?;
        for_each_chunk(threads, intensities, beam_count, |scan, intensities| {
            let scans = std::iter::once((Pose::from(poses[scan]) * self.base_from_fan, world));
            let sink = StoreIntensities { bits: bits(stream, scan), intensities };
            self.cast(caster, world.grid, scans, std::iter::once(sink))
        })
    }

    /// The same for scans that take time: `sweeps` says how robots and obstacles move.
    ///
    /// # Errors
    /// - [`Error::Tilted`]: the scanner is tilted.
    /// - Those of [`sweep_batch`](Self::sweep_batch).
    pub fn intensities_of_sweeps(
        &self,
        grid: &OccupancyGrid,
        sweeps: Sweeps<'_>,
        stream: Option<(u64, u64)>,
        threads: Option<usize>,
        intensities: &mut [f32],
    ) -> Result<(), Error> {
        let plan = self.plan(sweeps, threads)?;
        self.check_intensities(plan.scans, intensities)?;
        let caster = self.caster(grid.into())?;
        caster.prepare(threads)?;
        for_each_chunk(threads, intensities, self.options.beam_count, |scan, intensities| {
            let sink = StoreIntensities { bits: bits(stream, scan), intensities };
            self.cast_sweeps(caster, &plan, scan..scan + 1, 0.0, std::iter::once(sink))
        })
    }

    fn check_intensities(&self, scans: usize, intensities: &[f32]) -> Result<(), Error> {
        let needed = scans * self.options.beam_count;
        if self.slant.is_some() {
            return Err(Error::Tilted);
        }
        if intensities.len() != needed {
            return Err(Error::Length { name: "out", value: intensities.len(), needed });
        }
        Ok(())
    }
}

/// Returns the random bits of a scan of a batch.
fn bits(stream: Option<(u64, u64)>, scan: usize) -> Option<BeamBits> {
    stream.map(|(seed, first_index)| BeamBits::new(seed, first_index.wrapping_add(scan as u64)))
}
