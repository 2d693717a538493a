//! Footprints: beams that have a width, and what they read at an edge.

use std::ops::Range;

use glam::DVec2;
use rand::RngExt;

use super::LaserScanner;
use super::each::ShotNoise;
use super::sweep::Plan;
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::memory;
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Caster, Path, Sink};
use crate::surface::{Footprint, SurfaceModel};
use crate::world::World;

/// Distinguishes the random numbers of edges from the others. Beams have smaller numbers.
const EDGES: u64 = 1 << 42;

/// The footprints of the beams of some scans: the ranges \[m\] of their right and of their left ends, scan by scan.
pub struct Footprints {
    footprint: Footprint,
    ends: [Vec<Group>; 2],
}

/// The footprints of the beams of one scan.
#[derive(Clone, Copy)]
pub struct ScanFootprints<'a> {
    footprint: Footprint,
    right: &'a [Group],
    left: &'a [Group],
}

impl Footprints {
    /// Returns the footprints of scans with `groups` groups each; `None` if the beams have no width. `cast` writes the ranges of all
    /// beams, turned by an angle \[rad\] from where they are.
    fn new(
        surface: &SurfaceModel,
        groups: usize,
        cast: impl Fn(f64, &mut [Group]) -> Result<(), Error>,
    ) -> Result<Option<Self>, Error> {
        let Some(footprint) = surface.footprint() else { return Ok(None) };
        let mut ends = [Vec::new(), Vec::new()];
        for (ranges, place) in ends.iter_mut().zip([0.0, 1.0]) {
            *ranges = memory::filled("the beams", [f64::INFINITY; GROUP], groups)?;
            cast(footprint.angle(place), ranges)?;
        }
        Ok(Some(Self { footprint, ends }))
    }

    /// Returns the footprints of one scan, given by its place among the scans and its number of groups.
    pub fn of_scan(&self, scan: usize, groups: usize) -> ScanFootprints<'_> {
        let [right, left] = self.ends.each_ref().map(|ranges| &ranges[scan * groups..][..groups]);
        ScanFootprints { footprint: self.footprint, right, left }
    }
}

impl ScanFootprints<'_> {
    /// Returns the ranges \[m\] of a group of beams, infinite without a return, of which some are at edges.
    ///
    /// `path` follows a beam, given by its slot, in a direction at an angle \[rad\] to its own; `end_at` gets the paths at edges.
    #[inline(always)]
    pub fn split(
        &self,
        (group, count): (usize, usize),
        ranges: &Group,
        bits: BeamBits,
        path: impl Fn(usize, f64) -> Option<Path>,
        mut end_at: impl FnMut(usize, &Path),
    ) -> Group {
        let (right, left) = (&self.right[group], &self.left[group]);
        let mut at_edge = [0_u32; GROUP];
        for slot in 0..GROUP {
            at_edge[slot] = u32::from(self.footprint.is_at_edge([right[slot], ranges[slot], left[slot]]));
        }
        // Behind the last beam of a scan, the ranges of a group are those of other beams.
        at_edge.iter_mut().skip(count).for_each(|at_edge| *at_edge = 0);
        let mut ranges = *ranges;
        if at_edge.iter().fold(0, |any, at_edge| any | at_edge) != 0 {
            for slot in (0..GROUP).filter(|&slot| at_edge[slot] != 0) {
                let mut stream = bits.stream((group * GROUP + slot) as u64 | EDGES);
                let mut draw = || stream.random::<f64>();
                let (places, mix) = ([draw(), draw()], draw());
                let [first, second] = places.map(|place| path(slot, self.footprint.angle(place)));
                let length = |path: &Option<Path>| path.as_ref().map_or(f64::INFINITY, |path| path.length);
                ranges[slot] = self.footprint.range([length(&first), length(&second)], mix);
                if let Some(path) = first {
                    end_at(slot, &path);
                }
            }
        }
        ranges
    }
}

/// Stores ranges in metres, infinite without a return, of a scan with noise.
struct StoreGroups<'a> {
    bits: BeamBits,
    ranges: &'a mut [Group],
}

impl Sink for StoreGroups<'_> {
    fn bits(&self) -> Option<BeamBits> {
        Some(self.bits)
    }

    fn take(&mut self, group: usize, ranges: &Group) {
        self.ranges[group] = *ranges;
    }
}

impl LaserScanner {
    /// Returns the footprints of scans that are cast together, given by where their beams spread from; `None` if the beams have no
    /// width.
    pub(super) fn footprints<'a>(
        &self,
        caster: Caster<'_>,
        grid: &OccupancyGrid,
        scans: &(impl Iterator<Item = ((Pose, World<'a>), ShotNoise<'a>)> + Clone),
        surface: &SurfaceModel,
    ) -> Result<Option<Footprints>, Error> {
        let groups = self.cos.len();
        Footprints::new(surface, scans.clone().count() * groups, |angle, ranges| {
            let turned = |map_from_fan: Pose| Pose { yaw: map_from_fan.yaw + angle, ..map_from_fan };
            let sinks = ranges.chunks_exact_mut(groups).zip(scans.clone());
            let sinks = sinks.map(|(ranges, (_, noise))| StoreGroups { bits: noise.bits(), ranges });
            let scans = scans.clone().map(|((map_from_fan, world), _)| (turned(map_from_fan), world));
            self.cast(caster, grid, scans, sinks)
        })
    }

    /// The same for scans that take time.
    pub(super) fn footprints_of_sweeps(
        &self,
        caster: Caster<'_>,
        plan: &Plan<'_>,
        scans: Range<usize>,
        bits: &(impl Iterator<Item = BeamBits> + Clone),
        surface: &SurfaceModel,
    ) -> Result<Option<Footprints>, Error> {
        let groups = self.cos.len();
        Footprints::new(surface, scans.len() * groups, |angle, ranges| {
            let sinks = ranges.chunks_exact_mut(groups).zip(bits.clone());
            let sinks = sinks.map(|(ranges, bits)| StoreGroups { bits, ranges });
            self.cast_sweeps(caster, plan, scans.clone(), angle, sinks)
        })
    }
}

/// Returns a direction turned by an angle \[rad\].
pub fn turned(direction: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin).rotate(direction)
}
