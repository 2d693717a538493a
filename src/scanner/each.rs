//! Batches of scans in which each scan has a world and a random stream of its own.

use super::LaserScanner;
use super::sinks::Noisy;
use crate::batch::{for_each_chunk, thread_count};
use crate::beam_model::{BeamModel, Sampler};
use crate::error::Error;
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::StoreRanges;
use crate::world::World;

/// One scan of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shot<'a> {
    pub world: World<'a>,
    pub map_from_base: Pose,
    /// Noise of the readings, and seed and index of its random stream; `None` for true ranges.
    pub noise: Option<(&'a BeamModel, u64, u64)>,
}

impl Shot<'_> {
    /// Returns true if both scans can be cast together.
    fn goes_with(&self, other: &Self) -> bool {
        std::ptr::eq(self.world.grid, other.world.grid) && self.noise.is_some() == other.noise.is_some()
    }
}

impl LaserScanner {
    /// Writes the readings \[m\] of each scan: those of [`scan_batch`](Self::scan_batch) for its world, pose and noise alone.
    ///
    /// Successive scans on the same grid are the fastest.
    ///
    /// # Errors
    /// Those of [`scan_batch`](Self::scan_batch).
    pub(crate) fn scan_each(&self, shots: &[Shot<'_>], threads: Option<usize>, readings: &mut [f32]) -> Result<(), Error> {
        let (beam_count, max_range) = (self.options.beam_count, self.options.max_range);
        if readings.len() != shots.len() * beam_count {
            return Err(Error::Length { name: "out", value: readings.len(), needed: shots.len() * beam_count });
        }
        let Some(first) = shots.first() else { return Ok(()) };
        for together in shots.chunk_by(Shot::goes_with) {
            self.caster(together[0].world)?.prepare(threads)?;
        }
        let threads_used = thread_count(threads, readings.len())?;
        let at_a_time = self.caster(first.world)?.fans_per_cast(shots.len(), self.cos.len(), threads_used);
        for_each_chunk(threads, readings, at_a_time * beam_count, |chunk, mut readings| {
            let shots = &shots[chunk * at_a_time..][..readings.len() / beam_count];
            for together in shots.chunk_by(Shot::goes_with) {
                let (own, others) = readings.split_at_mut(together.len() * beam_count);
                readings = others;
                self.cast_together(together, max_range, own.chunks_exact_mut(beam_count))?;
            }
            Ok(())
        })
    }

    fn cast_together<'a>(
        &self,
        shots: &[Shot<'_>],
        max_range: f64,
        readings: impl Iterator<Item = &'a mut [f32]>,
    ) -> Result<(), Error> {
        let grid = shots[0].world.grid;
        let caster = self.caster(shots[0].world)?;
        let scans = shots.iter().map(|shot| (shot.map_from_base, shot.world));
        if shots[0].noise.is_none() {
            return self.cast(caster, grid, scans, readings.map(|ranges| StoreRanges { max_range, ranges }));
        }
        let sinks = shots.iter().zip(readings).filter_map(|(shot, readings)| {
            let (model, seed, index) = shot.noise?;
            Some(Noisy { sampler: Sampler::new(model, max_range, BeamBits::new(seed, index)), readings })
        });
        self.cast(caster, grid, scans, sinks)
    }
}
