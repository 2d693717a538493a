//! Wall directions: in which direction the wall runs at each blocking cell, from the cells around it.

use std::f64::consts::PI;
use std::ops::Range;

use glam::DVec2;

use crate::batch::for_each_chunk;
use crate::error::Error;
use crate::memory;

/// Number of directions, over half a turn. A multiple of 4, so that 0°, 45°, 90° and 135° are exact.
pub const STEPS: u8 = 252;

/// Mark of a cell that does not block or has no free neighbour.
pub const NO_WALL: u8 = u8::MAX;

/// Mark of a cell at which the direction of the wall is unknown.
pub const UNKNOWN: u8 = u8::MAX - 1;

/// Largest number of cells from a cell to the side of its window.
const MAX_REACH: usize = 5;

/// Smallest one.
const MIN_REACH: usize = 3;

/// Side of the largest window.
const SIDE: usize = 2 * MAX_REACH + 1;

/// Largest mean square distance of cells from a line that count as a straight wall \[cells²\].
///
/// A line of cells has at most 0.17, a wall two cells thick 0.52 nearly always. A right angle has 0.53 and more.
const MAX_SCATTER: f64 = 0.525;

/// Least difference between the mean square distances along and across a wall \[cells²\]: three cells in a row have 0.67.
const MIN_SPREAD: f64 = 0.5;

/// Number of rows that one thread fills at a time.
const ROWS: usize = 16;

/// Name of the memory in errors.
const WALLS: &str = "the directions of the walls";

/// The direction of the wall at each blocking cell that has a free neighbour, one byte for each cell.
///
/// A direction is that of the line that fits the centres of the cells best (total least squares): those that block, have a free
/// neighbour, and are connected with the cell inside of a square window around it. The window has 11 × 11 cells; it shrinks to
/// 9 × 9 and 7 × 7 if the cells in it are not along a line, as near a corner. If they never are, the direction is unknown.
#[derive(Debug)]
pub struct WallDirections {
    /// Direction of each cell in steps of π / [`STEPS`], counterclockwise from the x axis; or [`UNKNOWN`] or
    /// [`NO_WALL`].
    steps: Vec<u8>,
    width: usize,
    tangents: [Tangent; 256],
}

/// A unit vector along a wall: zero if its direction is unknown, and NaN where there is no wall.
///
/// Both components are float32 numbers in one word, so that they are looked up together.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tangent(u64);

impl Tangent {
    fn new(x: f64, y: f64) -> Self {
        Self(u64::from((x as f32).to_bits()) | u64::from((y as f32).to_bits()) << 32)
    }

    /// Returns the x component.
    #[inline(always)]
    pub fn x(self) -> f64 {
        f32::from_bits(self.0 as u32).into()
    }

    /// Returns the y component.
    #[inline(always)]
    pub fn y(self) -> f64 {
        f32::from_bits((self.0 >> 32) as u32).into()
    }
}

/// Cells of a grid, of which some block.
struct Walls<'a, T, B> {
    cells: &'a [T],
    width: usize,
    blocks: B,
}

impl WallDirections {
    /// Returns the directions for a grid with these cells, row by row; `blocks` says which of them block.
    ///
    /// # Errors
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Count`], [`Error::Threads`], [`Error::Interrupted`]: those of a batch on `threads` threads.
    pub fn new<T: Sync>(
        cells: &[T],
        width: usize,
        threads: Option<usize>,
        blocks: impl Fn(&T) -> bool + Sync,
    ) -> Result<Self, Error> {
        let walls = Walls { cells, width, blocks };
        let mut steps = memory::filled(WALLS, NO_WALL, cells.len())?;
        for_each_chunk(threads, &mut steps, ROWS * width, |chunk, steps| {
            for (row, steps) in steps.chunks_exact_mut(width).enumerate() {
                walls.fill(chunk * ROWS + row, 0..width, steps);
            }
            Ok(())
        })?;
        let mut tangents = [Tangent::default(); 256];
        for step in 0..STEPS {
            let (sin, cos) = libm::sincos(angle(step));
            tangents[usize::from(step)] = Tangent::new(cos, sin);
        }
        tangents[usize::from(NO_WALL)] = Tangent::new(f64::NAN, f64::NAN);
        Ok(Self { steps, width, tangents })
    }

    /// Returns a copy.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn try_clone(&self) -> Result<Self, Error> {
        Ok(Self { steps: memory::collected(WALLS, self.steps.iter().copied())?, ..*self })
    }

    /// Finds the directions again that depend on the cells of a rectangle. Takes all cells of the grid, like
    /// [`new`](Self::new).
    pub fn update<T>(&mut self, cells: &[T], (cols, rows): (Range<usize>, Range<usize>), blocks: impl Fn(&T) -> bool) {
        let walls = Walls { cells, width: self.width, blocks };
        // A cell decides whether its neighbours have a free one.
        let around =
            |range: Range<usize>, end: usize| range.start.saturating_sub(MAX_REACH + 1)..end.min(range.end + MAX_REACH + 1);
        let (cols, rows) = (around(cols, self.width), around(rows, cells.len() / self.width));
        for row in rows {
            walls.fill(row, cols.clone(), &mut self.steps[row * self.width..][cols.clone()]);
        }
    }

    /// Returns the steps of all cells, row by row.
    pub fn steps(&self) -> &[u8] {
        &self.steps
    }

    /// Returns a unit vector along the wall at a cell, given by its place among all cells, in the frame of the grid; `None` if the
    /// direction is unknown or there is no wall.
    #[inline(always)]
    pub fn tangent(&self, place: usize) -> Option<DVec2> {
        let tangent = self.tangent_at(place);
        Some(DVec2::new(tangent.x(), tangent.y())).filter(|tangent| tangent.is_finite() && *tangent != DVec2::ZERO)
    }

    /// Returns the same vector; zero if the direction is unknown or the place is not on the grid.
    #[inline(always)]
    pub fn tangent_at(&self, place: usize) -> Tangent {
        // No branch, so that the look-ups of several beams overlap.
        self.tangents[usize::from(self.steps.get(place).copied().unwrap_or(UNKNOWN))]
    }
}

/// Returns the angle of a step \[rad\], 0 to below π.
pub fn angle(step: u8) -> f64 {
    f64::from(step) * (PI / f64::from(STEPS))
}

impl<T, B: Fn(&T) -> bool> Walls<'_, T, B> {
    /// Writes the steps of some cells of a row.
    fn fill(&self, row: usize, cols: Range<usize>, steps: &mut [u8]) {
        for (col, step) in cols.zip(steps) {
            *step = if self.is_surface(col, row) { self.step(col, row) } else { NO_WALL };
        }
    }

    /// Returns true if a cell is on the grid and blocks. Left of column 0 and below row 0, the numbers wrap around.
    fn is_blocking(&self, col: usize, row: usize) -> bool {
        col < self.width && row < self.cells.len() / self.width && (self.blocks)(&self.cells[row * self.width + col])
    }

    /// Returns true if a cell blocks and has a free neighbour.
    fn is_surface(&self, col: usize, row: usize) -> bool {
        self.is_blocking(col, row)
            && !(self.is_blocking(col.wrapping_sub(1), row)
                && self.is_blocking(col + 1, row)
                && self.is_blocking(col, row.wrapping_sub(1))
                && self.is_blocking(col, row + 1))
    }

    /// Returns the step of a cell with a free neighbour.
    fn step(&self, col: usize, row: usize) -> u8 {
        let mut window = [0; SIDE];
        for (y, bits) in window.iter_mut().enumerate() {
            for x in 0..SIDE {
                let at = |center: usize, offset: usize| center.wrapping_add(offset).wrapping_sub(MAX_REACH);
                *bits |= u16::from(self.is_surface(at(col, x), at(row, y))) << x;
            }
        }
        (MIN_REACH..=MAX_REACH).rev().find_map(|reach| line(&connected(&window, reach))).unwrap_or(UNKNOWN)
    }
}

/// One bit for each cell of the largest window.
type Window = [u16; SIDE];

/// Returns the cells that are connected with the middle one, corners included, inside of the window of a reach.
fn connected(window: &Window, reach: usize) -> Window {
    let inside = ((1 << (2 * reach + 1)) - 1) << (MAX_REACH - reach);
    let rows = MAX_REACH - reach..=MAX_REACH + reach;
    let mut found = [0; SIDE];
    found[MAX_REACH] = 1 << MAX_REACH;
    loop {
        let before = found;
        for y in rows.clone() {
            let near = before[y] | before[y.saturating_sub(1)] | before[(y + 1).min(SIDE - 1)];
            found[y] |= (near | near << 1 | near >> 1) & window[y] & inside;
        }
        if found == before {
            return found;
        }
    }
}

/// Returns the step of the line through cells; `None` if they are not along a line.
fn line(window: &Window) -> Option<u8> {
    let cells = || {
        let bits = |bits: u16| (0..SIDE).filter(move |x| bits & 1 << x != 0);
        window.iter().enumerate().flat_map(move |(y, &row)| bits(row).map(move |x| DVec2::new(x as f64, y as f64)))
    };
    let count = cells().count() as f64;
    let mean = cells().sum::<DVec2>() / count;
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for cell in cells() {
        let off = cell - mean;
        (xx, yy, xy) = (xx + off.x * off.x / count, yy + off.y * off.y / count, xy + off.x * off.y / count);
    }
    // The eigenvalues of the matrix of second moments are `middle` ± `spread`.
    let (middle, spread) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
    if middle - spread > MAX_SCATTER || 2.0 * spread < MIN_SPREAD {
        return None;
    }
    let turns = 0.5 * libm::atan2(2.0 * xy, xx - yy) / PI;
    Some((turns * f64::from(STEPS)).round().rem_euclid(STEPS.into()) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    const SIZE: usize = 41;

    /// Draws a wall: the cells whose centres, seen along the wall, are at a distance that counts.
    fn wall(angle: f64, offset: f64, is_wall: impl Fn(f64, f64, f64) -> bool) -> Vec<bool> {
        let (sin, cos) = libm::sincos(angle);
        let distance = |index: usize| {
            let (x, y) = ((index % SIZE) as f64, (index / SIZE) as f64);
            (y - SIZE as f64 / 2.0) * cos - (x - SIZE as f64 / 2.0) * sin - offset
        };
        // Half the width of a line of cells that share sides, and of one of cells that share corners.
        let (sides, corners) = (0.5 * (sin.abs() + cos.abs()), 0.5 * sin.abs().max(cos.abs()));
        (0..SIZE * SIZE).map(|index| is_wall(distance(index), sides, corners)).collect()
    }

    /// Returns the error of the direction at the middle of a wall, in degrees: the median, that of 95 % and the worst.
    fn errors(is_wall: impl Fn(f64, f64, f64) -> bool + Copy) -> [f64; 3] {
        let mut stream = random::stream(8, 0);
        let mut errors = vec![];
        for _ in 0..2000 {
            let (angle, offset) = (PI * stream.random::<f64>(), stream.random::<f64>() - 0.5);
            let cells = wall(angle, offset, is_wall);
            let found = WallDirections::new(&cells, SIZE, Some(1), |&cell| cell).unwrap();
            let nearest = |index: &usize| {
                let (x, y) = (index % SIZE, index / SIZE);
                x.abs_diff(SIZE / 2) + y.abs_diff(SIZE / 2)
            };
            let surface = Walls { cells: &cells, width: SIZE, blocks: |&cell: &bool| cell };
            let middle = (0..SIZE * SIZE).filter(|i| surface.is_surface(i % SIZE, i / SIZE)).min_by_key(nearest).unwrap();
            let tangent = found.tangent(middle).expect("a direction");
            let (sin, cos) = libm::sincos(angle);
            errors.push(libm::asin((tangent.x * sin - tangent.y * cos).abs().min(1.0)).to_degrees());
        }
        errors.sort_by(f64::total_cmp);
        [errors[1000], errors[1900], errors[1999]]
    }

    /// The errors that the documentation states.
    #[test]
    fn directions_are_those_of_known_walls() {
        type IsWall = fn(f64, f64, f64) -> bool;
        let walls: [(&str, IsWall); 5] = [
            ("half plane", |distance, _, _| distance > 0.0),
            ("line of cells that share sides", |distance, sides, _| distance.abs() < sides),
            ("line of cells that share corners", |distance, _, corners| distance.abs() < corners),
            ("two cells thick", |distance, _, _| distance.abs() < 1.0),
            ("three cells thick", |distance, _, _| distance.abs() < 1.6),
        ];
        for (name, is_wall) in walls {
            let [median, most, worst] = errors(is_wall);
            println!("{name}: median {median:.2}°, 95 % {most:.2}°, worst {worst:.2}°");
            assert!(median < 1.0 && most < 3.5 && worst < 9.0, "{name}: {median} {most} {worst}");
        }
    }

    fn draw(rows: &[&str]) -> (Vec<bool>, usize) {
        (rows.iter().rev().flat_map(|row| row.chars().map(|cell| cell == '#')).collect(), rows[0].len())
    }

    /// Returns the direction at a cell in degrees, -1 if it is unknown.
    fn degrees(rows: &[&str], col: usize, row: usize) -> f64 {
        let (cells, width) = draw(rows);
        let found = WallDirections::new(&cells, width, Some(1), |&cell| cell).unwrap();
        match found.steps()[row * width + col] {
            UNKNOWN | NO_WALL => -1.0,
            step => angle(step).to_degrees(),
        }
    }

    #[test]
    fn straight_and_diagonal_walls_are_exact() {
        assert_eq!(degrees(&["......", "######", "......"], 2, 1), 0.0);
        assert_eq!(degrees(&[".#.", ".#.", ".#.", ".#."], 1, 0), 90.0);
        assert_eq!(degrees(&["....#", "...#.", "..#..", ".#...", "#...."], 2, 2), 45.0);
        assert_eq!(degrees(&["#....", ".#...", "..#..", "...#.", "....#"], 2, 2), 135.0);
        // The surfaces of a thick wall are not connected.
        assert_eq!(degrees(&["#############"; 4], 6, 3), 0.0);
    }

    #[test]
    fn near_a_corner_a_direction_is_exact_or_unknown() {
        let corner =
            ["#..........", "#..........", "#..........", "#..........", "#..........", "#..........", "###########"];
        let found: Vec<f64> = (0..11).map(|col| degrees(&corner, col, 0)).collect();
        assert!(found.iter().all(|&degrees| degrees == -1.0 || degrees == 0.0), "{found:?}");
        assert!(found[0] == -1.0 && found[4..].iter().all(|&degrees| degrees == 0.0), "{found:?}");
    }

    #[test]
    fn what_is_no_line_has_no_direction() {
        assert_eq!(degrees(&["...", ".#.", "..."], 1, 1), -1.0);
        assert_eq!(degrees(&["....", ".##.", ".##.", "...."], 1, 1), -1.0);
        // Free cells, and cells inside of a wall.
        assert_eq!(degrees(&["###", "###", "###"], 1, 1), -1.0);
        assert_eq!(degrees(&["...", "###"], 1, 1), -1.0);
    }

    #[test]
    fn an_update_equals_a_new_table() {
        let mut stream = random::stream(9, 0);
        let mut cells: Vec<bool> = (0..40 * 30).map(|_| stream.random_range(0..3) == 0).collect();
        let mut found = WallDirections::new(&cells, 40, Some(1), |&cell| cell).unwrap();
        for _ in 0..50 {
            let (col, row) = (stream.random_range(0..36), stream.random_range(0..27));
            for index in 0..12 {
                cells[(row + index / 4) * 40 + col + index % 4] = stream.random();
            }
            found.update(&cells, (col..col + 4, row..row + 3), |&cell| cell);
            assert!(found.steps() == WallDirections::new(&cells, 40, Some(1), |&cell| cell).unwrap().steps());
        }
    }
}
