//! Where the rays of a cast come from.

use super::Ray;
use super::coarse::CoarseBeams;
use super::fans::Fans;
use crate::free_boxes::Sector;
use crate::grid::OccupancyGrid;

/// Number of free boxes that [`Source::is_cluttered`] looks up.
pub const SAMPLES: usize = Sector::COUNT;

/// Rays over a grid, in cells: one or more fans with the same number of rays each, in groups of
/// [`GROUP`](crate::numeric::GROUP).
pub trait Source: Copy {
    /// True if many rays start in the same cell.
    const SHARES_START_CELLS: bool;

    /// Returns the number of fans.
    fn fans(&self) -> usize {
        1
    }

    /// Returns the number of rays in a fan.
    fn count(&self) -> usize;

    /// Returns the rays of one group of a fan. Entries past the last ray are padding.
    fn group(&self, fan: usize, group: usize) -> impl RayGroup;

    /// Returns true if every sampled ray starts where free boxes are at most `length` cells long. Always false for fewer
    /// than [`SAMPLES`] rays.
    fn is_cluttered(&self, grid: &OccupancyGrid, length: i32) -> bool;

    /// Returns the fans and their coarse beams, if they are dense.
    fn dense(&self) -> Option<(Fans<'_>, &CoarseBeams)> {
        None
    }

    /// Returns the input of the next cast, which a kernel may prefetch.
    fn upcoming(&self) -> &[[f64; 3]] {
        &[]
    }
}

/// The rays of a group, by their slots in it.
pub trait RayGroup {
    /// Returns the ray in a slot.
    fn ray(&self, slot: usize) -> Ray;
}
