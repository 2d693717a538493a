//! Distances to the nearest blocking cell: of cells from a table, of points exactly.

use glam::DVec2;

use crate::error::Error;
use crate::interrupt::Watch;
use crate::memory;
use crate::prefetch::prefetch;

/// Marks a row without blocking cells to that side. A side of a grid is shorter than this.
const NONE: u16 = u16::MAX;

/// Number of columns that are transformed together, so that each cache line is read once.
const COLUMNS: usize = 16;

/// The Euclidean distance transform of a grid, in cells.
#[derive(Debug)]
pub struct Distances {
    width: usize,
    /// For each cell, the number of cells to the nearest blocking cell of its row: to the left, and to the right. 0 for a
    /// blocking cell.
    in_row: Vec<[u16; 2]>,
    /// For each cell, the distance between its centre and that of the nearest blocking cell, rounded; infinite without one.
    between_centers: Vec<f32>,
}

impl Distances {
    /// Returns the distances for a grid of `width` columns, given which cells block. Cost: linear in the number of cells.
    ///
    /// Method: Felzenszwalb & Huttenlocher, *Distance Transforms of Sampled Functions*, 2012: distances along the rows, then
    /// for each column the lower envelope of one parabola per row.
    ///
    /// # Errors
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn new<T>(cells: &[T], width: usize, blocks: impl Fn(&T) -> bool) -> Result<Self, Error> {
        const TABLE: &str = "the distances of the grid";
        let watch = Watch::new();
        let mut in_row = memory::filled(TABLE, [NONE; 2], cells.len())?;
        for (cells, in_row) in cells.chunks_exact(width).zip(in_row.chunks_exact_mut(width)) {
            watch.check()?;
            fill_row(cells, in_row, &blocks);
        }
        let height = cells.len() / width;
        let mut between_centers = memory::filled(TABLE, f32::INFINITY, cells.len())?;
        let mut columns = memory::filled(TABLE, 0.0, COLUMNS * height)?;
        let mut envelope = memory::with_room(TABLE, height)?;
        for first in (0..width).step_by(COLUMNS) {
            watch.check()?;
            let count = COLUMNS.min(width - first);
            for (row, in_row) in in_row.chunks_exact(width).enumerate() {
                for (column, &[left, right]) in in_row[first..first + count].iter().enumerate() {
                    let nearest = left.min(right);
                    columns[column * height + row] =
                        if nearest == NONE { f64::INFINITY } else { f64::from(nearest) * f64::from(nearest) };
                }
            }
            for column in columns.chunks_exact_mut(height).take(count) {
                fill_column(column, &mut envelope);
            }
            for (row, between_centers) in between_centers.chunks_exact_mut(width).enumerate() {
                for (column, distance) in between_centers[first..first + count].iter_mut().enumerate() {
                    *distance = columns[column * height + row].sqrt() as f32;
                }
            }
        }
        Ok(Self { width, in_row, between_centers })
    }

    /// Returns the number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns, for each cell, the distance between its centre and that of the nearest blocking cell; infinite without one.
    ///
    /// A relative rounding error of up to 1e-7 is left.
    pub fn between_centers(&self) -> &[f32] {
        &self.between_centers
    }

    /// Returns true if no blocking cell is within `radius` \[cells\] of any point of a cell. May return false though there is
    /// none.
    pub fn is_clear(&self, col: usize, row: usize, radius: f64) -> bool {
        // A point of a cell is at most half a diagonal from its centre.
        f64::from(self.between_centers[row * self.width + col]) * (1.0 - 1e-6) - std::f64::consts::SQRT_2 > radius
    }

    /// Loads into the cache what [`is_clear`](Self::is_clear) reads of a cell.
    pub fn prefetch(&self, col: usize, row: usize) {
        prefetch(&self.between_centers, size_of::<f32>() * (row * self.width + col));
    }

    /// Returns the exact distance from a point on the grid to the nearest blocking cell, or `limit` if that is smaller.
    ///
    /// Cost: at most one look-up for each row within that distance.
    pub fn clearance(&self, at: DVec2, limit: f64) -> f64 {
        let height = self.in_row.len() / self.width;
        let (col, row) = ((at.x as usize).min(self.width - 1), (at.y as usize).min(height - 1));
        let mut square = limit * limit;
        let mut look = |row: usize, across: f64| {
            if across * across >= square {
                return false;
            }
            let [left, right] = self.in_row[row * self.width + col];
            let to_left = if left == NONE { f64::INFINITY } else { at.x - (col as f64 - f64::from(left) + 1.0) };
            let to_right = if right == NONE { f64::INFINITY } else { col as f64 + f64::from(right) - at.x };
            let along = to_left.min(to_right).max(0.0);
            square = square.min(along * along + across * across);
            true
        };
        (row..height).all(|other| look(other, (other as f64 - at.y).max(0.0)));
        (0..row).rev().all(|other| look(other, at.y - other as f64 - 1.0));
        square.sqrt()
    }
}

/// Fills the numbers of cells to the nearest blocking cells of one row.
fn fill_row<T>(cells: &[T], in_row: &mut [[u16; 2]], blocks: &impl Fn(&T) -> bool) {
    let mut since = NONE;
    for (cell, [left, _]) in cells.iter().zip(in_row.iter_mut()) {
        since = if blocks(cell) { 0 } else { since.saturating_add(1) };
        *left = since;
    }
    since = NONE;
    for ([left, right], _) in in_row.iter_mut().zip(cells).rev() {
        since = if *left == 0 { 0 } else { since.saturating_add(1) };
        *right = since;
    }
}

/// Replaces the squares of the distances along the rows of one column by the squares of the distances in the plane.
fn fill_column(squares: &mut [f64], envelope: &mut Vec<Parabola>) {
    envelope.clear();
    for (row, &square) in squares.iter().enumerate().filter(|(_, square)| square.is_finite()) {
        let row = row as f64;
        // The parabola that is lowest from `start` on; those that it hides are removed.
        let mut start = f64::NEG_INFINITY;
        while let Some(last) = envelope.last() {
            start = 0.5 * (row + last.row + (square - last.square) / (row - last.row));
            if start > last.start {
                break;
            }
            envelope.pop();
        }
        if envelope.is_empty() {
            start = f64::NEG_INFINITY;
        }
        envelope.push(Parabola { row, square, start });
    }
    let mut current = 0;
    for (row, square) in squares.iter_mut().enumerate() {
        while envelope.get(current + 1).is_some_and(|next| next.start <= row as f64) {
            current += 1;
        }
        if let Some(lowest) = envelope.get(current) {
            let across = row as f64 - lowest.row;
            *square = across * across + lowest.square;
        }
    }
}

/// The square of the distance to the nearest blocking cell of one row, as a function of the row.
struct Parabola {
    row: f64,
    /// Its value at `row`.
    square: f64,
    /// Row from which on it is the lowest one.
    start: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    /// Some grids, from empty to full, as (blocking, width).
    fn grids() -> Vec<(Vec<bool>, usize)> {
        let mut stream = random::stream(3, 0);
        let shares = [0.0, 0.002, 0.02, 0.2, 0.9, 1.0];
        let sizes = [(1, 1), (1, 40), (40, 1), (37, 23), (16, 30), (17, 9)];
        let mut draw = |share: f64, count: usize| (0..count).map(|_| stream.random::<f64>() < share).collect();
        let all = sizes.iter().flat_map(|&(width, height)| shares.map(|share| (share, width, width * height)));
        all.map(|(share, width, count)| (draw(share, count), width)).collect()
    }

    fn blocking_cells((blocking, width): &(Vec<bool>, usize)) -> Vec<DVec2> {
        let corner = |index: usize| DVec2::new((index % width) as f64, (index / width) as f64);
        (0..blocking.len()).filter(|&index| blocking[index]).map(corner).collect()
    }

    #[test]
    fn distances_between_cells_are_those_to_the_nearest_blocking_one() {
        for grid in grids() {
            let distances = Distances::new(&grid.0, grid.1, |&blocks| blocks).expect("enough memory");
            let blocking = blocking_cells(&grid);
            for (index, &found) in distances.between_centers().iter().enumerate() {
                let cell = DVec2::new((index % grid.1) as f64, (index / grid.1) as f64);
                let expected = blocking.iter().map(|other| other.distance(cell)).fold(f64::INFINITY, f64::min);
                assert_eq!(found, expected as f32, "{cell} {grid:?}");
            }
        }
    }

    #[test]
    fn the_clearance_of_a_point_is_its_distance_to_the_nearest_square() {
        let mut stream = random::stream(4, 0);
        for grid in grids() {
            let distances = Distances::new(&grid.0, grid.1, |&blocks| blocks).expect("enough memory");
            let blocking = blocking_cells(&grid);
            for _ in 0..200 {
                let size = DVec2::new(grid.1 as f64, (grid.0.len() / grid.1) as f64);
                let at = size * DVec2::new(stream.random(), stream.random());
                let square = |&corner: &DVec2| at.distance(at.clamp(corner, corner + 1.0));
                let expected = blocking.iter().map(square).fold(f64::INFINITY, f64::min);
                for limit in [0.3, 3.0, f64::INFINITY] {
                    let found = distances.clearance(at, limit);
                    assert!((found - expected.min(limit)).abs() < 1e-12 || found == expected, "{at} {found} {expected}");
                }
            }
        }
    }
}
