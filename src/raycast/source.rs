//! Where rays come from: the beams of a scan, or rays that have nothing to do with each other.

use glam::DVec2;

use super::ray::still;
use super::{Ray, Sector};
use crate::grid::{Cell, OccupancyGrid};

/// Rays come in groups of this many, so that loops over them have a fixed length.
pub const GROUP: usize = 32;

/// Boxes that are looked up to tell whether rays are hemmed in.
const LOOK_UPS: usize = Sector::COUNT;

/// A number for each ray of a group.
pub type Group = [f64; GROUP];

/// Rays over a grid, in cells.
pub trait Source: Copy {
    /// Whether all rays start in one cell.
    const START_TOGETHER: bool;

    /// Number of rays.
    fn count(&self) -> usize;

    /// The ray at a place of a group. Behind the last ray there are others of no meaning, up to the group's end.
    fn ray(&self, group: usize, place: usize) -> Ray;

    /// Whether rays start among blocking cells so dense that no free box around them is longer than this, as far as a few look-ups
    /// tell; a few rays need not be asked.
    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool;

    /// What is going to be read after these rays, which kernels may have fetched from memory in good time.
    fn upcoming(&self) -> &[[f64; 3]] {
        &[]
    }
}

/// Rays that start at one place of the grid.
#[derive(Debug, Clone, Copy)]
pub struct Fan<'a> {
    /// Where the rays start.
    pub origin: DVec2,
    /// The cell of the origin, which is on the grid.
    pub cell: (i32, i32),
    /// Cosine and sine of the angle that the directions are turned by.
    pub heading: DVec2,
    /// Cosines of the directions' angles before that turn.
    pub cos: &'a [Group],
    /// Sines of those angles, as many.
    pub sin: &'a [Group],
    /// Number of rays.
    pub count: usize,
}

impl Source for Fan<'_> {
    const START_TOGETHER: bool = true;

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn ray(&self, group: usize, place: usize) -> Ray {
        let turned = self.heading.rotate(DVec2::new(self.cos[group][place], self.sin[group][place]));
        let direction = DVec2::new(still(turned.x), still(turned.y));
        Ray { origin: self.origin, direction, col: self.cell.0, row: self.cell.1, gap: 0.0 }
    }

    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool {
        let (col, row) = self.cell;
        let is_short = |length| Sector::all().all(|sector| grid.clearance().length(col, row, sector) <= length);
        // The cells beside are what a traversal reads next; the boxes lie far from each other in memory, and waiting for all of
        // them takes 3 % of a scan that gets nowhere.
        let is_boxed_in = length > 0 && is_boxed_in(grid, self.cell);
        debug_assert!(!is_boxed_in || is_short(1), "{:?} is boxed in, and has room", self.cell);
        self.count >= LOOK_UPS && (is_boxed_in || is_short(length))
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
    fn ray(&self, group: usize, place: usize) -> Ray {
        let rays = &self.groups[group];
        Ray {
            origin: DVec2::new(rays.x[place], rays.y[place]),
            direction: DVec2::new(rays.dx[place], rays.dy[place]),
            col: rays.col[place],
            row: rays.row[place],
            gap: rays.gap[place],
        }
    }

    fn is_hemmed_in(&self, grid: &OccupancyGrid, length: i32) -> bool {
        if self.count < LOOK_UPS {
            return false;
        }
        // Those that start in walls or pass the grid by tell nothing.
        let rays = (0..LOOK_UPS).map(|nth| nth * self.count / LOOK_UPS).map(|ray| self.ray(ray / GROUP, ray % GROUP));
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
