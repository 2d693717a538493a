//! Fans: a fan is a set of rays with the same origin, such as the beams of a scan.

use glam::DVec2;

use super::Ray;
use super::coarse::CoarseBeams;
use super::ray::flush_tiny;
use super::source::{RayGroup, SAMPLES, Source};
use crate::free_boxes::Sector;
use crate::grid::{Cell, OccupancyGrid};
use crate::numeric::Group;
use crate::pose::Pose;

/// Fans with the same ray directions, each in its own frame: the scans of one scanner.
#[derive(Debug, Clone, Copy)]
pub struct Fans<'a> {
    /// Start of each fan; at least one.
    pub starts: &'a [Start],
    /// Cosines of the beams' angles in the frame of a fan.
    pub cos: &'a [Group],
    /// Sines of the same angles.
    pub sin: &'a [Group],
    /// Number of rays in a fan.
    pub count: usize,
    /// Those that are cast first, if the beams are dense.
    pub coarse: Option<&'a CoarseBeams>,
}

/// Origin and heading of a fan, in cells.
#[derive(Debug, Clone, Copy, Default)]
pub struct Start {
    origin: DVec2,
    /// Column and row of the cell that contains the origin; `None` off the grid.
    cell: Option<(i32, i32)>,
    /// Cosine and sine of the fan's yaw.
    heading: DVec2,
}

impl Start {
    /// Returns the start at a pose in the frame of the grid \[m\].
    #[must_use]
    pub fn new(grid: &OccupancyGrid, pose: Pose) -> Self {
        let origin = grid.in_cells(pose.position);
        let (sin, cos) = libm::sincos(pose.yaw);
        let cell = grid.cell_around(origin).map(|cell| (cell.col as i32, cell.row as i32));
        Self { origin, cell, heading: DVec2::new(cos, sin) }
    }

    /// Returns true if all free boxes of the start cell are at most `length` cells long.
    fn is_cluttered(&self, grid: &OccupancyGrid, length: i32) -> bool {
        let (col, row) = self.cell.unwrap_or_default();
        let is_short = |length| Sector::all().all(|sector| grid.free_boxes().length(col, row, sector) <= length);
        // The neighbours are checked first, because a traversal would read them next anyway. The boxes of the eight sectors
        // lie far apart in memory: reading them takes 3 % of a scan whose beams never leave their start cell.
        let is_enclosed = length > 0 && is_enclosed(grid, (col, row));
        debug_assert!(!is_enclosed || is_short(1), "{:?} is enclosed, but has a long free box", self.cell);
        is_enclosed || is_short(length)
    }
}

/// Returns true if each of the four neighbours of a cell blocks or is off the grid, so that no ray leaves the cell.
fn is_enclosed(grid: &OccupancyGrid, (col, row): (i32, i32)) -> bool {
    let stops = |col: i32, row: i32| match (usize::try_from(col), usize::try_from(row)) {
        (Ok(col), Ok(row)) if col < grid.width() && row < grid.height() => grid.is_blocking(Cell { col, row }),
        _ => true,
    };
    stops(col - 1, row) && stops(col + 1, row) && stops(col, row - 1) && stops(col, row + 1)
}

impl Fans<'_> {
    /// Largest number of fans that gain from being cast together.
    pub const MAX: usize = 8;

    /// Returns true if all fans start on the grid and have finite directions.
    #[must_use]
    pub fn are_on_grid(&self) -> bool {
        self.starts.iter().all(|start| start.cell.is_some() && start.heading.is_finite())
    }

    /// Returns true if [`Source::is_cluttered`] gives the same answer for each of the fans.
    #[must_use]
    pub fn are_alike(&self, grid: &OccupancyGrid, length: i32) -> bool {
        // Free boxes of length 0 exist only in blocking cells. Rays that start there end there, so the method of casting
        // them does not matter.
        if self.count < SAMPLES || self.starts.len() == 1 || length == 0 {
            return true;
        }
        let cluttered = self.starts.iter().filter(|start| start.is_cluttered(grid, length)).count();
        cluttered == 0 || cluttered == self.starts.len()
    }
}

impl Source for Fans<'_> {
    const SHARES_START_CELLS: bool = true;

    #[inline(always)]
    fn fans(&self) -> usize {
        self.starts.len()
    }

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn group(&self, fan: usize, group: usize) -> impl RayGroup {
        let Start { origin, cell, heading } = self.starts[fan];
        FanGroup { origin, cell: cell.unwrap_or_default(), heading, cos: &self.cos[group], sin: &self.sin[group] }
    }

    #[inline(always)]
    fn dense(&self) -> Option<(Fans<'_>, &CoarseBeams)> {
        self.coarse.map(|coarse| (*self, coarse))
    }

    fn is_cluttered(&self, grid: &OccupancyGrid, length: i32) -> bool {
        self.count >= SAMPLES && self.starts.iter().all(|start| start.is_cluttered(grid, length))
    }
}

/// One group of rays of a fan.
struct FanGroup<'a> {
    origin: DVec2,
    cell: (i32, i32),
    heading: DVec2,
    cos: &'a Group,
    sin: &'a Group,
}

impl RayGroup for FanGroup<'_> {
    #[inline(always)]
    fn ray(&self, slot: usize) -> Ray {
        let turned = self.heading.rotate(DVec2::new(self.cos[slot], self.sin[slot]));
        let direction = DVec2::new(flush_tiny(turned.x), flush_tiny(turned.y));
        Ray { origin: self.origin, direction, col: self.cell.0, row: self.cell.1, gap: 0.0 }
    }
}
