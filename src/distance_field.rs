//! The distance field of a grid: how far each cell is from the nearest blocking cell, up to some distance.

use std::sync::Arc;

use glam::DVec2;

use crate::error::Error;
use crate::fork::Lock;
use crate::free_area::Distances;
use crate::memory;

/// Largest distance of a field, in cells.
pub const MAX_REACH: f64 = 255.0;

/// What the memory is for, in errors.
const FIELD: &str = "the distance field of the grid";

/// Distances between the centres of cells and that of the nearest blocking cell, up to a distance.
///
/// The cells around the grid have distances too, so that the field ends where nothing is near.
#[derive(Debug)]
pub struct DistanceField {
    /// Largest distance, in cells.
    reach: f64,
    /// Number of cells on each side of the grid.
    margin: usize,
    /// Number of columns and rows, with the margins.
    width: usize,
    height: usize,
    /// For each cell the square of the distance, in cells. Larger ones are [`DistanceField::beyond`].
    squares: Vec<u16>,
}

impl DistanceField {
    /// Returns the field of a grid of `width` columns, given which cells block. `reach` is at most [`MAX_REACH`].
    ///
    /// # Errors
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn new<T>(cells: &[T], width: usize, reach: f64, blocks: impl Fn(&T) -> bool) -> Result<Self, Error> {
        let margin = reach as usize + 1;
        let (inner, width, height) = (width, width + 2 * margin, cells.len() / width + 2 * margin);
        let mut blocking = memory::filled(FIELD, false, width * height)?;
        for (cells, blocking) in cells.chunks_exact(inner).zip(blocking.chunks_exact_mut(width).skip(margin)) {
            cells.iter().zip(&mut blocking[margin..]).for_each(|(cell, is_blocking)| *is_blocking = blocks(cell));
        }
        let mut field = Self { reach, margin, width, height, squares: memory::with_room(FIELD, width * height)? };
        let (largest, beyond) = (reach * reach, field.beyond());
        let distances = Distances::new(&blocking, width, |&is_blocking| is_blocking)?;
        field.squares.extend(distances.between_centers().iter().map(|&distance| {
            // Distances are rounded square roots of whole numbers. Up to the largest one, this rounding gives them back.
            let square = (f64::from(distance) * f64::from(distance)).round();
            if square <= largest { square as u16 } else { beyond }
        }));
        Ok(field)
    }

    /// Returns what stands for the square of a distance of more than the largest one. Smaller squares are below it.
    pub fn beyond(&self) -> u16 {
        (self.reach * self.reach) as u16 + 1
    }

    /// Returns the square of the distance of the cell that contains a point, in cells from the corner of the grid; or
    /// [`beyond`](Self::beyond).
    #[inline(always)]
    pub fn square_at(&self, at: DVec2) -> u16 {
        // A cast of a negative number or of NaN is 0. The outermost cells are far from all blocking ones.
        let at = at + self.margin as f64;
        let (col, row) = ((at.x as usize).min(self.width - 1), (at.y as usize).min(self.height - 1));
        self.squares[row * self.width + col]
    }

    /// Returns the squares of the distances of the cells of the grid, row by row.
    pub fn rows(&self) -> impl Iterator<Item = &[u16]> {
        let inner = self.squares[self.margin * self.width..].chunks_exact(self.width).take(self.height - 2 * self.margin);
        inner.map(|row| &row[self.margin..self.width - self.margin])
    }
}

/// The distance field that was asked for last.
#[derive(Debug, Default)]
pub struct KeptField(Lock<Option<Arc<DistanceField>>>);

impl KeptField {
    /// Returns the field with this reach; builds it if another one was asked for last.
    ///
    /// # Errors
    /// That of `build`.
    pub fn get_or_build(
        &self,
        reach: f64,
        build: impl FnOnce() -> Result<DistanceField, Error>,
    ) -> Result<Arc<DistanceField>, Error> {
        if let Some(field) = self.kept()
            && field.reach == reach
        {
            return Ok(field);
        }
        // The lock is not held meanwhile. Two threads may build the same field.
        let field = Arc::new(build()?);
        *self.0.lock() = Some(Arc::clone(&field));
        Ok(field)
    }

    fn kept(&self) -> Option<Arc<DistanceField>> {
        self.0.lock().clone()
    }
}

impl Clone for KeptField {
    fn clone(&self) -> Self {
        Self(Lock::new(self.kept()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    #[test]
    fn squares_are_those_of_the_distance_to_the_nearest_blocking_cell() {
        let mut stream = random::stream(5, 0);
        for (width, height, share, reach) in
            [(1, 1, 1.0, 3.0), (30, 20, 0.02, 7.3), (20, 31, 0.3, 0.5), (40, 9, 0.01, 255.0), (5, 5, 0.0, 2.0)]
        {
            let cells: Vec<bool> = (0..width * height).map(|_| stream.random::<f64>() < share).collect();
            let field = DistanceField::new(&cells, width, reach, |&blocks| blocks).expect("enough memory");
            let nearest = |col: i64, row: i64| {
                let blocking = (0..cells.len()).filter(|&index| cells[index]);
                let square = |index: usize| {
                    let (across, along) = ((index % width) as i64 - col, (index / width) as i64 - row);
                    across * across + along * along
                };
                let least = blocking.map(square).min().map(|square| square as f64);
                least.filter(|square| *square <= reach * reach).map_or(field.beyond(), |square| square as u16)
            };
            let around = reach as i64 + 3;
            for row in -around..height as i64 + around {
                for col in -around..width as i64 + around {
                    let inside = DVec2::new(stream.random_range(0.01..0.99), stream.random_range(0.01..0.99));
                    let at = DVec2::new(col as f64, row as f64) + inside;
                    assert_eq!(field.square_at(at), nearest(col, row), "{at} {width} {height} {reach}");
                }
            }
            for (row, squares) in field.rows().enumerate() {
                let expected: Vec<u16> = (0..width).map(|col| nearest(col as i64, row as i64)).collect();
                assert_eq!(squares, expected);
            }
            assert_eq!(field.rows().count(), height);
            for far in [1e300, -1e300, f64::NAN] {
                assert_eq!(field.square_at(DVec2::splat(far)), field.beyond());
            }
        }
    }
}
