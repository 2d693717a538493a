//! Where the ranges of scans go: to one sink per scan, past obstacles, through noise, into an array.

use super::onward::Onward;
use crate::beam_model::Sampler;
use crate::motion::PoseColumns;
use crate::numeric::{GROUP, Group};
use crate::obstacles::{Passing, View};
use crate::random::BeamBits;
use crate::raycast::{Sink, store};
use crate::scorer::{Product, ReadingColumns, Scorer};
use crate::slant::Slant;

/// Sends the groups of several scans to one sink per scan. Groups arrive in order, numbered across all scans.
pub struct SinkPerScan<S, N> {
    /// Sink of the current scan.
    pub sink: S,
    /// Sinks of the following scans.
    pub upcoming: N,
    /// Number of groups in a scan.
    pub groups: usize,
    /// Number of the first group of the current scan.
    pub first: usize,
}

impl<S: Sink, N: Iterator<Item = S>> SinkPerScan<S, N> {
    // Not inlined, to keep the loop over groups small.
    #[inline(never)]
    fn start_next_scan(&mut self) {
        self.first += self.groups;
        self.sink = self.upcoming.next().expect("one sink per scan");
    }
}

impl<S: Sink, N: Iterator<Item = S>> Sink for SinkPerScan<S, N> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        if group == self.first + self.groups {
            self.start_next_scan();
        }
        self.sink.take(group - self.first, ranges);
    }
}

/// The obstacles of one scan.
pub trait Foreground {
    /// Replaces each range \[m\] of a group of beams by the distance to the nearest obstacle, if that is shorter. `cos` and `sin`
    /// are those of the beams' angles.
    fn shorten(&self, group: usize, directions: (&Group, &Group), ranges: &mut Group);
}

impl Foreground for View {
    #[inline(always)]
    fn shorten(&self, group: usize, _: (&Group, &Group), ranges: &mut Group) {
        View::shorten(self, group, ranges);
    }
}

/// The obstacles of a scan that takes time, and where its beams spread from, for each group of the scan.
pub struct PassingBy<'a> {
    pub passing: &'a Passing<'a>,
    pub map_from_fan: &'a [PoseColumns],
}

impl Foreground for PassingBy<'_> {
    #[inline(always)]
    fn shorten(&self, group: usize, directions: (&Group, &Group), ranges: &mut Group) {
        if !self.passing.is_empty() {
            self.passing.shorten(group, &self.map_from_fan[group], directions, ranges);
        }
    }
}

/// Adds what is not in the grid to the ranges, and follows beams through glass and from mirrors; then passes them on to `sink`.
pub struct Beyond<'a, F, S> {
    /// The obstacles that this scan can see; `None` if there is nothing to add.
    pub foreground: Option<F>,
    /// Glass and mirrors; `None` if there are none.
    pub onward: Option<Onward<'a>>,
    /// Slant of the beams; `None` if the scanner is not tilted.
    pub slant: Option<&'a Slant>,
    pub cos: &'a [Group],
    pub sin: &'a [Group],
    pub sink: S,
}

impl<F: Foreground, S: Sink> Sink for Beyond<'_, F, S> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        if self.foreground.is_none() && self.onward.is_none() {
            return self.sink.take(group, ranges);
        }
        let to_walls = ranges;
        let mut ranges = *ranges;
        if let Some(foreground) = &self.foreground {
            foreground.shorten(group, (&self.cos[group], &self.sin[group]), &mut ranges);
        }
        if let Some(onward) = &self.onward {
            let (bits, sink) = (self.sink.bits(), &mut self.sink);
            let end_at = &mut |slot, path: &_| sink.end_at(slot, path);
            onward.follow(group, (&self.cos[group], &self.sin[group]), to_walls, &mut ranges, bits, end_at);
        }
        if let Some(slant) = self.slant {
            ranges = slant.ranges(group, &ranges);
        }
        self.sink.take(group, &ranges);
    }
}

/// Scores the readings of a scan by its ranges.
pub struct Scoring<'a> {
    pub scorer: &'a Scorer,
    pub readings: &'a [ReadingColumns],
    pub product: Product,
    /// Gets the log-likelihood of the scan.
    pub score: &'a mut f64,
}

impl Sink for Scoring<'_> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        let ranges = ranges.map(|range| self.scorer.as_stored(range));
        self.scorer.multiply(&self.readings[group], &ranges, &mut self.product);
        if group + 1 == self.readings.len() {
            *self.score = self.scorer.log_likelihood(&self.product);
        }
    }
}

/// Draws a reading for each range from a beam model and stores it.
pub struct Noisy<'a> {
    pub sampler: Sampler<'a>,
    pub readings: &'a mut [f32],
}

impl Sink for Noisy<'_> {
    fn bits(&self) -> Option<BeamBits> {
        Some(self.sampler.bits())
    }

    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        // Nobody sees what is behind the last beam. A beam without a return takes the least time to draw.
        let padded;
        let count = self.readings.len() - group * GROUP;
        let ranges = if count < GROUP {
            padded = std::array::from_fn(|lane| if lane < count { ranges[lane] } else { f64::INFINITY });
            &padded
        } else {
            ranges
        };
        store(self.readings, group, &self.sampler.sample(group, ranges));
    }
}
