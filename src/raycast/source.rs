//! Where rays come from: the beams of scans, or rays that have nothing to do with each other.

use glam::DVec2;

use super::ray::still;
use super::{Ray, Sector};
use crate::grid::{Cell, OccupancyGrid};
use crate::pose::Pose;

/// Rays come in groups of this many, so that loops over them have a fixed length.
pub const GROUP: usize = 32;

/// Boxes that are looked up to tell whether rays are hemmed in.
const LOOK_UPS: usize = Sector::COUNT;

/// A number for each ray of a group.
pub type Group = [f64; GROUP];

/// Rays over a grid, in cells.
pub trait Source: Copy {
    /// Whether many rays start in one cell.
    const START_TOGETHER: bool;

    /// Number of fans, which are one after the other.
    fn fans(&self) -> usize {
        1
    }

    /// Number of rays of a fan.
    fn count(&self) -> usize;

    /// The rays of a group of a fan. Behind the last ray there are others of no meaning, up to the group's end.
    fn group(&self, fan: usize, group: usize) -> impl Places;

    /// Whether all rays start among blocking cells so dense that no free box around them is longer than this, as far as a few look-ups
    /// tell; a few rays need not be asked.
    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool;

    /// What is going to be read after these rays, which kernels may have fetched from memory in good time.
    fn upcoming(&self) -> &[[f64; 3]] {
        &[]
    }
}

/// The rays of a group, by their places in it.
pub trait Places {
    /// The ray at a place.
    fn ray(&self, place: usize) -> Ray;
}

/// Where the rays of a fan start.
#[derive(Debug, Clone, Copy, Default)]
pub struct Start {
    origin: DVec2,
    /// The cell of the origin, if that is on the grid.
    cell: Option<(i32, i32)>,
    /// Cosine and sine of the angle that the directions are turned by.
    heading: DVec2,
}

impl Start {
    /// The start at a pose in the frame of the grid \[m\].
    #[must_use]
    pub fn new(grid: &OccupancyGrid, pose: Pose) -> Self {
        let origin = pose.position / grid.resolution();
        let (sin, cos) = libm::sincos(pose.yaw);
        Self { origin, cell: grid.clearance().cell_at(origin), heading: DVec2::new(cos, sin) }
    }

    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool {
        let (col, row) = self.cell.unwrap_or_default();
        let is_short = |length| Sector::all().all(|sector| grid.clearance().length(col, row, sector) <= length);
        // The cells beside are what a traversal reads next; the boxes lie far from each other in memory, and waiting for all of
        // them takes 3 % of a scan that gets nowhere.
        let is_boxed_in = length > 0 && is_boxed_in(grid, (col, row));
        debug_assert!(!is_boxed_in || is_short(1), "{:?} is boxed in, and has room", self.cell);
        is_boxed_in || is_short(length)
    }
}

/// Fans of rays in the same directions, but for what each is turned by: the beams of scans.
#[derive(Debug, Clone, Copy)]
pub struct Fans<'a> {
    /// Where each fan starts; at least one.
    pub starts: &'a [Start],
    /// Cosines of the directions' angles before they are turned.
    pub cos: &'a [Group],
    /// Sines of those angles, as many.
    pub sin: &'a [Group],
    /// Number of rays of a fan.
    pub count: usize,
}

impl Fans<'_> {
    /// The most fans that are worth casting at a time.
    pub const MOST: usize = 8;

    /// Whether all rays start on the grid, and have a direction.
    #[must_use]
    pub fn are_on_grid(&self) -> bool {
        self.starts.iter().all(|start| start.cell.is_some() && start.heading.is_finite())
    }

    /// Whether all fans are hemmed in, as [`Source::is_hemmed_in`] has it, or none is.
    #[must_use]
    pub fn are_alike(&self, grid: &OccupancyGrid, length: i32) -> bool {
        // What starts in a wall ends there: with no box too short to jump over, it does not matter which are.
        if self.count < LOOK_UPS || self.starts.len() == 1 || length == 0 {
            return true;
        }
        let hemmed_in = self.starts.iter().filter(|start| start.is_hemmed_in(grid, length)).count();
        hemmed_in == 0 || hemmed_in == self.starts.len()
    }
}

/// A group of the rays of a fan.
struct FanGroup<'a> {
    origin: DVec2,
    cell: (i32, i32),
    heading: DVec2,
    cos: &'a Group,
    sin: &'a Group,
}

impl Places for FanGroup<'_> {
    #[inline(always)]
    fn ray(&self, place: usize) -> Ray {
        let turned = self.heading.rotate(DVec2::new(self.cos[place], self.sin[place]));
        let direction = DVec2::new(still(turned.x), still(turned.y));
        Ray { origin: self.origin, direction, col: self.cell.0, row: self.cell.1, gap: 0.0 }
    }
}

impl Source for Fans<'_> {
    const START_TOGETHER: bool = true;

    #[inline(always)]
    fn fans(&self) -> usize {
        self.starts.len()
    }

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn group(&self, fan: usize, group: usize) -> impl Places {
        let Start { origin, cell, heading } = self.starts[fan];
        FanGroup { origin, cell: cell.unwrap_or_default(), heading, cos: &self.cos[group], sin: &self.sin[group] }
    }

    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool {
        self.count >= LOOK_UPS && self.starts.iter().all(|start| start.is_hemmed_in(grid, length))
    }
}

/// Whether the four cells beside a cell block or are off the grid, so that no ray gets any farther.
fn is_boxed_in(grid: &OccupancyGrid, (col, row): (i32, i32)) -> bool {
    let stops = |col: i32, row: i32| match (usize::try_from(col), usize::try_from(row)) {
        (Ok(col), Ok(row)) if col < grid.width() && row < grid.height() => grid.is_blocking(Cell { col, row }),
        _ => true,
    };
    stops(col - 1, row) && stops(col + 1, row) && stops(col, row - 1) && stops(col, row + 1)
}

/// A group of rays each with an origin of its own, side by side.
#[derive(Debug, Clone, Copy)]
pub struct RayGroup {
    x: Group,
    y: Group,
    dx: Group,
    dy: Group,
    gap: Group,
    col: [i32; GROUP],
    row: [i32; GROUP],
}

impl RayGroup {
    /// Rays that never get to the grid.
    pub const ASTRAY: Self = {
        let zero = [0.0; GROUP];
        Self { x: zero, y: zero, dx: [1.0; GROUP], dy: zero, gap: [f64::INFINITY; GROUP], col: [0; GROUP], row: [0; GROUP] }
    };

    /// Where the rays start, by column and by row, and their directions, likewise: to be followed by [`start`](Self::start).
    #[inline(always)]
    pub fn parts(&mut self) -> [&mut Group; 4] {
        [&mut self.x, &mut self.y, &mut self.dx, &mut self.dy]
    }

    /// Starts the rays of these parts, whose directions are finite, if all of them start on a grid of this size; returns whether they
    /// do.
    #[inline(always)]
    pub fn start(&mut self, (width, height): (usize, usize)) -> bool {
        let (width, height) = (width as f64, height as f64);
        let on_grid = |place: usize| {
            let (x, y) = (self.x[place], self.y[place]);
            (x >= 0.0) & (x < width) & (y >= 0.0) & (y < height)
        };
        let on_grid = (0..GROUP).fold(true, |all, place| all & on_grid(place));
        (self.dx, self.dy) = (self.dx.map(still), self.dy.map(still));
        (self.col, self.row) = (self.x.map(floor), self.y.map(floor));
        self.gap = [0.0; GROUP];
        on_grid
    }

    /// Puts a ray at a place.
    #[inline]
    pub fn set(&mut self, place: usize, ray: &Ray) {
        (self.x[place], self.y[place]) = ray.origin.into();
        (self.dx[place], self.dy[place]) = ray.direction.into();
        (self.col[place], self.row[place]) = (ray.col, ray.row);
        self.gap[place] = ray.gap;
    }
}

impl Places for &RayGroup {
    #[inline(always)]
    fn ray(&self, place: usize) -> Ray {
        Ray {
            origin: DVec2::new(self.x[place], self.y[place]),
            direction: DVec2::new(self.dx[place], self.dy[place]),
            col: self.col[place],
            row: self.row[place],
            gap: self.gap[place],
        }
    }
}

/// The floor of a number in [0, 2³¹), in a form that vectorises.
#[inline(always)]
fn floor(number: f64) -> i32 {
    // Numbers of 2⁵² and more are whole: adding it rounds to the nearest one, which its lowest bits are then.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let nearest = (number + WHOLE) - WHOLE;
    let floor = if nearest > number { nearest - 1.0 } else { nearest };
    (floor + WHOLE).to_bits() as i32
}

/// Rays each with an origin of its own.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// The rays, filled up to whole groups.
    pub groups: &'a [RayGroup],
    /// Number of rays.
    pub count: usize,
    /// Where the rays after these are to be found.
    pub upcoming: &'a [[f64; 3]],
}

impl Source for Rays<'_> {
    const START_TOGETHER: bool = false;

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn group(&self, _: usize, group: usize) -> impl Places {
        &self.groups[group]
    }

    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool {
        if self.count < LOOK_UPS {
            return false;
        }
        // Those that start in walls or pass the grid by tell nothing.
        let rays =
            (0..LOOK_UPS).map(|nth| nth * self.count / LOOK_UPS).map(|ray| self.group(0, ray / GROUP).ray(ray % GROUP));
        let found = rays.filter(|ray| ray.gap.is_finite());
        let mut found = found
            .map(|ray| grid.clearance().length(ray.col, ray.row, Sector::of(ray.direction)))
            .filter(|&found| found > 0)
            .peekable();
        found.peek().is_some() && found.all(|found| found <= length)
    }

    #[inline(always)]
    fn upcoming(&self) -> &[[f64; 3]] {
        self.upcoming
    }
}
