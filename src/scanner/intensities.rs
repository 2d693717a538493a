//! Intensities: how much light comes back from the surface at which each beam ends.

use super::{LaserScanner, Sweeps};
use crate::batch::{check_rows, for_each_chunk, thread_count};
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
    /// [`scan_batch`](Self::scan_batch) with noise; `None` stands for scans without noise.
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
        let at_a_time = caster.fans_per_cast(poses.len(), self.cos.len(), thread_count(threads, intensities.len())?);
        for_each_chunk(threads, intensities, at_a_time * beam_count, |chunk, intensities| {
            let first = chunk * at_a_time;
            let poses = poses[first..].iter().map(|&pose| (Pose::from(pose) * self.base_from_fan, world));
            let poses = poses.take(intensities.len() / beam_count);
            self.cast(caster, world.grid, poses, self.intensity_sinks(stream, first, intensities))
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
        let at_a_time = caster.fans_per_cast(plan.scans, self.cos.len(), thread_count(threads, intensities.len())?);
        let beam_count = self.options.beam_count;
        for_each_chunk(threads, intensities, at_a_time * beam_count, |chunk, intensities| {
            let first = chunk * at_a_time;
            let scans = first..first + intensities.len() / beam_count;
            self.cast_sweeps(caster, &plan, scans, 0.0, self.intensity_sinks(stream, first, intensities))
        })
    }

    /// Returns where the intensities of scans of a batch go, from number `first` on.
    fn intensity_sinks<'a>(
        &self,
        stream: Option<(u64, u64)>,
        first: usize,
        intensities: &'a mut [f32],
    ) -> impl Iterator<Item = StoreIntensities<'a>> {
        let scans = intensities.chunks_exact_mut(self.options.beam_count).enumerate();
        scans.map(move |(nth, intensities)| StoreIntensities { bits: bits(stream, first + nth), intensities })
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
