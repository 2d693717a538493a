//! A set of cells, stored as runs of successive ones.

use super::PLACES;
use crate::error::Error;
use crate::memory;

/// Cells in increasing order, as runs, with a table to find the run of the n-th cell.
#[derive(Debug, Default)]
pub struct Runs {
    all: Vec<Run>,
    count: u32,
    /// For each 2^`shift` cells of the set, the run that the first of them is in.
    table: Vec<u32>,
    shift: u32,
}

#[derive(Debug, Clone, Copy)]
struct Run {
    /// Number of cells of the set before this run.
    before: u32,
    /// Index of its first cell.
    cell: u32,
}

impl Runs {
    /// Returns the set of these cells, given by their indices in increasing order.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(cells: impl Iterator<Item = u32>) -> Result<Self, Error> {
        let (mut runs, mut count) = (Vec::<Run>::new(), 0);
        for cell in cells {
            if runs.last().is_none_or(|run| cell - run.cell != count - run.before) {
                memory::push(PLACES, &mut runs, Run { before: count, cell })?;
            }
            count += 1;
        }
        // About as many entries as runs, so that a look-up passes about one run on average.
        let shift = (count / (runs.len() as u32).max(1)).max(1).ilog2();
        let mut run = 0;
        let first_run = |entry: u32| {
            while runs.get(run + 1).is_some_and(|next| next.before <= entry << shift) {
                run += 1;
            }
            run as u32
        };
        let table = memory::collected(PLACES, (0..count.div_ceil(1 << shift)).map(first_run))?;
        Ok(Self { all: runs, count, table, shift })
    }

    /// Returns the number of cells.
    pub fn len(&self) -> u32 {
        self.count
    }

    /// Returns the index of the cell with `number` cells of the set before it.
    pub fn get(&self, number: u32) -> u32 {
        let mut run = self.table[(number >> self.shift) as usize] as usize;
        while self.all.get(run + 1).is_some_and(|next| next.before <= number) {
            run += 1;
        }
        let Run { before, cell } = self.all[run];
        cell + (number - before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cells_come_back_in_order() {
        let sets: [&dyn Fn(&u32) -> bool; 6] =
            [&|_| false, &|_| true, &|cell| *cell == 999, &|cell| cell % 2 == 0, &|cell| cell % 97 > 3, &|cell| {
                *cell > 800 || cell % 50 == 0
            }];
        for is_in in sets {
            let cells: Vec<u32> = (0..1000).filter(|cell| is_in(cell)).collect();
            let runs = Runs::new(cells.iter().copied()).expect("enough memory");
            assert_eq!(runs.len() as usize, cells.len());
            assert!((0..runs.len()).map(|number| runs.get(number)).eq(cells));
        }
    }
}
