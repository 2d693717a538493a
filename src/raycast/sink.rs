//! Where the results of a cast go.

use super::path::Path;
use crate::numeric::{GROUP, Group};
use crate::random::BeamBits;

/// Receives distances or ranges, one group of rays at a time.
///
/// Closures are sinks. A type with an `#[inline(always)]` method becomes part of the kernel that calls it.
pub trait Sink {
    /// True if it takes intensities, which the scanner computes from where beams end, instead of ranges.
    const TAKES_INTENSITIES: bool = false;

    /// Returns the random bits of the scan whose distances it takes; `None` if its readings have no noise.
    fn bits(&self) -> Option<BeamBits> {
        None
    }

    /// Learns where a beam of the group that it takes next ends, given by its slot there. It is called for beams that meet glass
    /// or a mirror first, and sometimes for others.
    fn end_at(&mut self, _slot: usize, _path: &Path) {}

    /// Takes the distances of a group. Entries past the last ray of a fan are padding.
    fn take(&mut self, group: usize, distances: &Group);
}

impl<F: FnMut(usize, &Group)> Sink for F {
    #[inline(always)]
    fn take(&mut self, group: usize, distances: &Group) {
        self(group, distances);
    }
}

/// Converts distances in cells to ranges in metres; a range of `max_range` or more becomes infinite.
pub struct InMetres<S> {
    pub resolution: f64,
    pub max_range: f64,
    pub sink: S,
}

impl<S: Sink> Sink for InMetres<S> {
    #[inline(always)]
    fn take(&mut self, group: usize, distances: &Group) {
        let metres = distances.map(|distance| distance * self.resolution);
        self.sink.take(group, &metres.map(|range| if range < self.max_range { range } else { f64::INFINITY }));
    }
}

/// Stores intensities as float32.
pub struct StoreIntensities<'a> {
    /// Random bits of the scan, for panes of glass; `None` if beams take the likelier way.
    pub bits: Option<BeamBits>,
    pub intensities: &'a mut [f32],
}

impl Sink for StoreIntensities<'_> {
    const TAKES_INTENSITIES: bool = true;

    fn bits(&self) -> Option<BeamBits> {
        self.bits
    }

    #[inline(always)]
    fn take(&mut self, group: usize, intensities: &Group) {
        store(self.intensities, group, intensities);
    }
}

/// Stores ranges as float32, with the maximum range for no return.
pub struct StoreRanges<'a> {
    pub max_range: f64,
    pub ranges: &'a mut [f32],
}

impl Sink for StoreRanges<'_> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        store(self.ranges, group, &ranges.map(|range| range.min(self.max_range)));
    }
}

/// Stores the numbers of a group as float32; padding past the end of `ranges` is dropped.
#[inline(always)]
pub fn store(ranges: &mut [f32], group: usize, numbers: &Group) {
    let numbers = numbers.map(|number| number as f32);
    let rest = &mut ranges[group * GROUP..];
    if let Some(whole_group) = rest.first_chunk_mut() {
        *whole_group = numbers;
    } else {
        store_last(rest, &numbers);
    }
}

// Never inlined: otherwise the compiler merges both cases into one copy of variable length.
#[cold]
#[inline(never)]
fn store_last(rest: &mut [f32], numbers: &[f32; GROUP]) {
    rest.copy_from_slice(&numbers[..rest.len()]);
}
