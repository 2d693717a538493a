//! Scans in one instant, each of which has a scanner, a world and a random stream of its own.

use super::LaserScanner;
use super::sinks::Noisy;
use super::surfaces::{Still, Surfaced};
use crate::batch::{for_each_heavy_chunk, thread_count};
use crate::beam_model::{BeamModel, Sampler};
use crate::error::Error;
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Fans, StoreRanges};
use crate::surface::SurfaceModel;
use crate::world::World;

/// One scan of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shot<'a> {
    pub scanner: &'a LaserScanner,
    pub world: World<'a>,
    pub map_from_base: Pose,
    /// Noise of the readings; `None` for true ranges.
    pub noise: Option<ShotNoise<'a>>,
}

/// The noise of one scan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShotNoise<'a> {
    pub model: &'a BeamModel,
    /// How what a beam meets changes its reading; `None` for not at all.
    pub surface: Option<&'a SurfaceModel>,
    /// Seed and index of the random stream.
    pub seed: u64,
    pub index: u64,
}

impl ShotNoise<'_> {
    /// Returns the random bits of the scan.
    pub fn bits(&self) -> BeamBits {
        BeamBits::new(self.seed, self.index)
    }
}

impl<'a> Shot<'a> {
    /// Returns true if both scans can be cast together.
    fn goes_with(&self, other: &Self) -> bool {
        self.scanner.casts_as(other.scanner)
            && std::ptr::eq(self.world.grid, other.world.grid)
            && self.noise.is_some() == other.noise.is_some()
            && self.surface() == other.surface()
    }

    /// Returns the surface model if it changes something.
    fn surface(&self) -> Option<&'a SurfaceModel> {
        self.noise?.surface.filter(|surface| !surface.is_off())
    }
}

/// Writes the readings \[m\] of each scan to its row: those of [`scan_batch`](LaserScanner::scan_batch) for its scanner, world, pose
/// and noise alone.
///
/// Successive scans of equal scanners on the same grid, with the same surface model, are the fastest.
///
/// # Errors
/// Those of [`scan_batch`](LaserScanner::scan_batch).
///
/// # Panics
/// If there is not a row for each scan, with an element for each of its beams.
pub(crate) fn scan_each(shots: &[Shot<'_>], threads: Option<usize>, rows: &mut [&mut [f32]]) -> Result<(), Error> {
    if shots.is_empty() {
        return Ok(());
    }
    let fits = |(row, shot): (&&mut [f32], &Shot<'_>)| row.len() == shot.scanner.options.beam_count;
    assert!(rows.len() == shots.len() && rows.iter().zip(shots).all(fits), "rows must have one element per beam");
    shots.iter().try_for_each(|shot| shot.map_from_base.checked().map(drop))?;
    let readings: usize = rows.iter().map(|row| row.len()).sum();
    let threads_used = thread_count(threads, readings)?;
    let mut at_a_time = Fans::MAX;
    for together in shots.chunk_by(Shot::goes_with) {
        let Shot { scanner, world, .. } = together[0];
        scanner.prepare(world, together[0].surface(), threads)?;
        at_a_time = at_a_time.min(scanner.caster(world)?.fans_per_cast(shots.len(), scanner.cos.len(), threads_used));
    }
    for_each_heavy_chunk(threads, rows, readings / shots.len(), at_a_time, |chunk, mut rows| {
        let shots = &shots[chunk * at_a_time..][..rows.len()];
        for together in shots.chunk_by(Shot::goes_with) {
            let (own, others) = rows.split_at_mut(together.len());
            rows = others;
            together[0].scanner.cast_together(&together.iter().copied(), own.iter_mut().map(|row| &mut **row))?;
        }
        Ok(())
    })
}

impl LaserScanner {
    /// Returns true if both scanners cast the same beams in the same way.
    fn casts_as(&self, other: &Self) -> bool {
        std::ptr::eq(self, other) || (self.options == other.options && self.kernel == other.kernel)
    }

    /// Builds what scans in a world need, on `threads` threads (default: all cores).
    ///
    /// # Errors
    /// - [`Error::Tilted`]: the scanner is tilted, and surfaces change the readings.
    /// - [`Error::Memory`], [`Error::Kernel`]: as in [`scan`](Self::scan).
    pub(super) fn prepare(
        &self,
        world: World<'_>,
        surface: Option<&SurfaceModel>,
        threads: Option<usize>,
    ) -> Result<(), Error> {
        if surface.is_some() {
            if self.slant.is_some() {
                return Err(Error::Tilted);
            }
            world.grid.walls(threads)?;
        }
        self.caster(world)?.prepare(threads)
    }

    /// Casts scans that go with each other.
    pub(super) fn cast_together<'a, 'b>(
        &self,
        shots: &(impl Iterator<Item = Shot<'a>> + Clone),
        readings: impl Iterator<Item = &'b mut [f32]>,
    ) -> Result<(), Error> {
        let Some(first) = shots.clone().next() else { return Ok(()) };
        let (grid, max_range, caster) = (first.world.grid, self.options.max_range, self.caster(first.world)?);
        let scans = shots.clone().map(|shot| (shot.map_from_base * self.base_from_fan, shot.world));
        if first.noise.is_none() {
            return self.cast(caster, grid, scans, readings.map(|ranges| StoreRanges { max_range, ranges }));
        }
        let noises = shots.clone().filter_map(|shot| shot.noise);
        let samplers = noises.clone().map(|noise| Sampler::new(noise.model, max_range, noise.bits()));
        let Some(surface) = first.surface() else {
            let sinks = samplers.zip(readings).map(|(sampler, readings)| Noisy { sampler, readings });
            return self.cast(caster, grid, scans, sinks);
        };
        let walls = grid.walls(Some(1))?;
        let footprints = self.footprints(caster, grid, &scans.clone().zip(noises.clone()), surface)?;
        let sinks = samplers.zip(noises).zip(scans.clone()).zip(readings).enumerate();
        let sinks = sinks.map(|(number, (((sampler, noise), (map_from_fan, world)), readings))| Surfaced {
            scene: Still::new(world, map_from_fan),
            grid,
            walls,
            surface,
            footprints: footprints.as_ref().map(|footprints| footprints.of_scan(number, self.cos.len())),
            sampler,
            fixed: BeamBits::of_places(noise.seed),
            max_range,
            cos: &self.cos,
            sin: &self.sin,
            ends: Vec::new(),
            readings,
        });
        self.cast(caster, grid, scans, sinks)
    }
}
