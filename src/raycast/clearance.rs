//! How far a ray may jump: per cell and quadrant, the largest free square.

/// Free squares around each cell of a grid, one for each quadrant of directions.
///
/// The side of a quadrant is that of the largest square that has the cell in its near corner, extends into the quadrant and
/// holds no blocking cell, 255 at most. It is 0 for a blocking cell, and for the border one cell wide around the grid, which
/// stops rays that leave.
#[derive(Debug)]
pub struct Clearance {
    /// Four sides a cell, the quadrant's in bits `8q..8q+8`; border included, row by row from the bottom.
    words: Vec<u32>,
    width: usize,
    height: usize,
}

/// Which way a ray goes: bit 0 is set towards lower columns, bit 1 towards lower rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quadrant(u32);

impl Quadrant {
    /// The quadrant of a direction; both zeros count as positive.
    #[must_use]
    pub fn of(dx: f64, dy: f64) -> Self {
        Self(u32::from(dx < 0.0) | u32::from(dy < 0.0) << 1)
    }
}

impl Clearance {
    /// The squares of a grid whose cells block where `blocks` says so of their index, row by row.
    ///
    /// The classic dynamic programme: a square's side is one more than the least of its three neighbours'.
    #[must_use]
    pub fn new(width: usize, height: usize, blocks: impl Fn(usize) -> bool) -> Self {
        let stride = width + 2;
        let mut words = vec![0u32; stride * (height + 2)];
        // Each pass sees the quadrants that extend towards the rows already done.
        for (rows_down, shifts) in [(true, [16, 24]), (false, [0, 8])] {
            for step in 0..height {
                let row = if rows_down { step } else { height - 1 - step };
                let line = (row + 1) * stride;
                let done = if rows_down { line - stride } else { line + stride };
                for (cols_down, shift) in [(false, shifts[0]), (true, shifts[1])] {
                    let mut beside = 0;
                    for step in 0..width {
                        let col = if cols_down { step } else { width - 1 - step };
                        let at = col + 1;
                        let diagonal = if cols_down { at - 1 } else { at + 1 };
                        let side = |word: u32| (word >> shift) & 0xff;
                        let least = side(words[done + at]).min(side(words[done + diagonal])).min(beside);
                        beside = if blocks(row * width + col) { 0 } else { (least + 1).min(255) };
                        words[line + at] |= beside << shift;
                    }
                }
            }
        }
        Self { words, width, height }
    }

    /// Number of columns, border left out.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows, border left out.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Side of the free square of a cell into a quadrant; columns and rows one off the grid are its border.
    #[must_use]
    pub fn side(&self, col: i32, row: i32, quadrant: Quadrant) -> i32 {
        let index = (row + 1) as usize * (self.width + 2) + (col + 1) as usize;
        ((self.words[index] >> (8 * quadrant.0)) & 0xff) as i32
    }

    /// Whether a cell named by signed numbers lies on the grid.
    #[must_use]
    pub fn contains(&self, col: i32, row: i32) -> bool {
        (0..self.width as i32).contains(&col) && (0..self.height as i32).contains(&row)
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.words.len() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Cell;
    use crate::random;
    use rand::Rng;

    /// The side as its definition has it: grow the square until it meets a blocking cell or the grid's edge.
    fn side_by_definition(blocking: &[bool], width: usize, cell: Cell, (left, down): (bool, bool)) -> i32 {
        let height = blocking.len() / width;
        let blocked = |across: i64, up: i64| {
            let col = cell.col as i64 + if left { -across } else { across };
            let row = cell.row as i64 + if down { -up } else { up };
            let on_grid = (0..width as i64).contains(&col) && (0..height as i64).contains(&row);
            !on_grid || blocking[row as usize * width + col as usize]
        };
        (0..255).find(|&side| (0..=side).any(|i| blocked(i, side) || blocked(side, i))).unwrap_or(255) as i32
    }

    #[test]
    fn sides_are_as_defined() {
        let mut stream = random::stream(1, 0);
        for (width, height, one_in) in [(1, 1, 2), (1, 9, 4), (13, 1, 4), (17, 12, 3), (23, 31, 20), (40, 25, 400)] {
            let blocking: Vec<bool> = (0..width * height).map(|_| stream.next_u64().is_multiple_of(one_in)).collect();
            let clearance = Clearance::new(width, height, |index| blocking[index]);
            for row in 0..height {
                for col in 0..width {
                    for (dx, dy) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                        let expected = side_by_definition(&blocking, width, Cell { col, row }, (dx < 0.0, dy < 0.0));
                        let found = clearance.side(col as i32, row as i32, Quadrant::of(dx, dy));
                        assert_eq!(found, expected, "{width}x{height} ({col}, {row}) towards ({dx}, {dy})");
                    }
                }
            }
        }
    }

    #[test]
    fn sides_stop_at_what_a_byte_holds() {
        let clearance = Clearance::new(300, 300, |_| false);
        assert_eq!(clearance.side(0, 0, Quadrant::of(1.0, 1.0)), 255);
        assert_eq!(clearance.side(299, 299, Quadrant::of(1.0, 1.0)), 1);
    }

    #[test]
    fn the_border_stops_every_quadrant() {
        let clearance = Clearance::new(3, 2, |_| false);
        for (col, row) in [(-1, 0), (3, 1), (0, -1), (2, 2), (-1, -1), (3, 2)] {
            assert!(!clearance.contains(col, row));
            assert_eq!(clearance.side(col, row, Quadrant::of(-1.0, 1.0)), 0);
        }
    }
}
