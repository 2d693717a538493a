//! Unrelated rays, each with its own origin.

use glam::DVec2;

use super::Ray;
use super::ray::flush_tiny;
use super::source::{RayGroup, SAMPLES, Source};
use crate::free_boxes::Sector;
use crate::grid::OccupancyGrid;
use crate::numeric::{GROUP, Group};

/// Rays that each have their own origin.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// The rays; the last group is padded.
    pub groups: &'a [RayColumns],
    /// Number of rays.
    pub count: usize,
    /// Input of the next cast.
    pub upcoming: &'a [[f64; 3]],
}

impl Source for Rays<'_> {
    const SHARES_START_CELLS: bool = false;

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn group(&self, _: usize, group: usize) -> impl RayGroup {
        &self.groups[group]
    }

    fn is_cluttered(&self, grid: &OccupancyGrid, length: i32) -> bool {
        if self.count < SAMPLES {
            return false;
        }
        let sampled =
            (0..SAMPLES).map(|nth| nth * self.count / SAMPLES).map(|ray| self.group(0, ray / GROUP).ray(ray % GROUP));
        // Rays that miss the grid or start in a blocking cell say nothing about clutter.
        let mut lengths = sampled
            .filter(|ray| ray.gap.is_finite())
            .map(|ray| grid.free_boxes().length(ray.col, ray.row, Sector::of(ray.direction)))
            .filter(|&found| found > 0)
            .peekable();
        lengths.peek().is_some() && lengths.all(|found| found <= length)
    }

    #[inline(always)]
    fn upcoming(&self) -> &[[f64; 3]] {
        self.upcoming
    }
}

/// A group of rays in columns: one array for each field of [`Ray`].
#[derive(Debug, Clone, Copy)]
pub struct RayColumns {
    x: Group,
    y: Group,
    dx: Group,
    dy: Group,
    gap: Group,
    col: [i32; GROUP],
    row: [i32; GROUP],
}

impl RayColumns {
    /// Rays that all miss the grid.
    pub const MISSES: Self = {
        let zero = [0.0; GROUP];
        Self { x: zero, y: zero, dx: [1.0; GROUP], dy: zero, gap: [f64::INFINITY; GROUP], col: [0; GROUP], row: [0; GROUP] }
    };

    /// Returns the columns x and y of the origins, then x and y of the directions. After filling them, call
    /// [`start`](Self::start).
    #[inline(always)]
    pub fn origins_and_directions(&mut self) -> [&mut Group; 4] {
        [&mut self.x, &mut self.y, &mut self.dx, &mut self.dy]
    }

    /// Sets the remaining columns from the origins and directions, for rays that start on a grid of this size.
    ///
    /// Returns false if a ray starts off the grid; then the columns are not usable. Directions must be finite.
    #[inline(always)]
    pub fn start(&mut self, (width, height): (usize, usize)) -> bool {
        let (width, height) = (width as f64, height as f64);
        let on_grid = |slot: usize| {
            let (x, y) = (self.x[slot], self.y[slot]);
            (x >= 0.0) & (x < width) & (y >= 0.0) & (y < height)
        };
        let on_grid = (0..GROUP).fold(true, |all, slot| all & on_grid(slot));
        (self.dx, self.dy) = (self.dx.map(flush_tiny), self.dy.map(flush_tiny));
        (self.col, self.row) = (self.x.map(floor), self.y.map(floor));
        self.gap = [0.0; GROUP];
        on_grid
    }

    /// Stores a ray in a slot.
    #[inline]
    pub fn set(&mut self, slot: usize, ray: &Ray) {
        (self.x[slot], self.y[slot]) = ray.origin.into();
        (self.dx[slot], self.dy[slot]) = ray.direction.into();
        (self.col[slot], self.row[slot]) = (ray.col, ray.row);
        self.gap[slot] = ray.gap;
    }
}

impl RayGroup for &RayColumns {
    #[inline(always)]
    fn ray(&self, slot: usize) -> Ray {
        Ray {
            origin: DVec2::new(self.x[slot], self.y[slot]),
            direction: DVec2::new(self.dx[slot], self.dy[slot]),
            col: self.col[slot],
            row: self.row[slot],
            gap: self.gap[slot],
        }
    }
}

/// Returns the floor of a number in [0, 2³¹), in a form that the compiler can vectorise.
#[inline(always)]
fn floor(number: f64) -> i32 {
    // A float64 of 2⁵² or more is whole, so adding 2⁵² rounds to the nearest integer and leaves it in the lowest bits.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let nearest = (number + WHOLE) - WHOLE;
    let floor = if nearest > number { nearest - 1.0 } else { nearest };
    (floor + WHOLE).to_bits() as i32
}
