//! The points of a grid at which a disc is free, as a set of squares from which points are drawn uniformly.
//!
//! All lengths are in cells, all points in cells from the corner of the grid.

mod distances;
mod runs;

use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::sync::Arc;

use glam::DVec2;
use rand::Rng;

use crate::error::Error;
use crate::fork::Lock;
use crate::interrupt::Watch;
use crate::memory;

pub use distances::Distances;
use runs::Runs;

/// What the memory is for, in errors.
const PLACES: &str = "the free places of the grid";

/// Smallest side of a square is 2 to the power of minus this.
const MAX_LEVEL: usize = 12;

/// Squares are split until those whose points have to be tested cover at most this part of those that are free.
const TESTED_SHARE: f64 = 0.125;

/// Largest number of squares to split further, or the number of cells if that is larger.
const MAX_SPLIT: usize = 1 << 20;

/// Number of cells between two looks at whether the call was interrupted.
const CELLS_PER_CHECK: usize = 1024;

/// Number of points that are tried before a draw is given up.
const ATTEMPTS: usize = 1 << 20;

/// Relative rounding error of [`Distances::between_centers`], with some margin.
const ROUNDING: f64 = 1e-6;

/// The points of known free cells at which a disc of one radius is free.
///
/// ```text
///   +---+---+---+---+
///   |///|   |   |   |   Squares of level 0 are cells. A cell that is free in part is split into four squares of level 1,
///   |///+---+-+-+   |   and so on. Squares at the end of which some points are free and some are not are kept: their
///   |///| | | | |   |   points are tested one by one.
///   +---+---+---+---+
/// ```
#[derive(Debug)]
pub struct FreeArea {
    radius: f64,
    /// Distances that differ by less than this from the radius are tested by the caller.
    slack: f64,
    /// Number of columns of the grid.
    width: usize,
    /// Cells of which each point is free.
    cells: Runs,
    /// Squares of which each point is free, for each level from level 1 on.
    squares: Vec<Vec<Square>>,
    /// Squares of the last level of which some points may be free.
    tested: Vec<Square>,
    /// Number of squares of the last level that cover all of these.
    count: u64,
}

/// A square of side 2⁻ˡ at level l: column and row of its lower-left corner, in units of its side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Square {
    col: u32,
    row: u32,
}

/// A square that was drawn.
#[derive(Debug, Clone, Copy)]
pub struct Pick {
    square: Square,
    level: usize,
    /// True if some of its points may not be free.
    is_tested: bool,
}

/// The distances of a grid and the free area of the radius asked for last. Both are built when first needed.
#[derive(Debug, Default)]
pub struct FreeAreas(Lock<Built>);

#[derive(Debug, Default, Clone)]
struct Built {
    distances: Option<Arc<Distances>>,
    area: Option<Arc<FreeArea>>,
}

impl FreeAreas {
    /// Returns the distances; builds them if they are not built yet.
    pub fn distances(&self, build: impl FnOnce() -> Result<Distances, Error>) -> Result<Arc<Distances>, Error> {
        if let Some(distances) = self.built().distances {
            return Ok(distances);
        }
        // The lock is not held meanwhile. Two threads may build the same distances.
        let distances = Arc::new(build()?);
        self.change(|built| built.distances = Some(Arc::clone(&distances)));
        Ok(distances)
    }

    /// Returns the free area for this radius; builds it if another radius was asked for last.
    pub fn area(
        &self,
        radius: f64,
        build: impl FnOnce() -> Result<Option<FreeArea>, Error>,
    ) -> Result<Option<Arc<FreeArea>>, Error> {
        if let Some(area) = self.built().area
            && area.radius == radius
        {
            return Ok(Some(area));
        }
        let Some(area) = build()?.map(Arc::new) else { return Ok(None) };
        self.change(|built| built.area = Some(Arc::clone(&area)));
        Ok(Some(area))
    }

    fn built(&self) -> Built {
        self.0.lock().clone()
    }

    fn change(&self, set: impl FnOnce(&mut Built)) {
        set(&mut self.0.lock());
    }
}

impl Clone for FreeAreas {
    fn clone(&self) -> Self {
        Self(Lock::new(self.built()))
    }
}

impl FreeArea {
    /// Returns the free area for a disc of this radius; `None` if it has no area.
    ///
    /// `is_known_free` tells for each cell, by its index, whether a point in it may be drawn. `slack` is a bound on the
    /// rounding errors of points. Cost: linear in the number of cells.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(
        distances: &Distances,
        radius: f64,
        slack: f64,
        is_known_free: impl Fn(usize) -> bool,
    ) -> Result<Option<Self>, Error> {
        let (width, centers) = (distances.width(), distances.between_centers());
        let (watch, mut split, mut stored) = (Watch::new(), Vec::new(), Ok(()));
        let is_whole = |&(index, &between): &(usize, &f32)| {
            let between = f64::from(between);
            // No point of a cell is farther from a blocking cell than the two centres are.
            if !is_known_free(index) || between * (1.0 + ROUNDING) < radius {
                return false;
            }
            let is_free = radius == 0.0 || between * (1.0 - ROUNDING) - SQRT_2 >= radius + slack;
            if !is_free {
                stored = stored.clone().and(memory::push(PLACES, &mut split, Square::cell(index, width)));
            }
            is_free
        };
        let goes_on = |&(index, _): &(usize, &f32)| !index.is_multiple_of(CELLS_PER_CHECK) || !watch.is_interrupted();
        let whole = centers.iter().enumerate().take_while(goes_on).filter(is_whole);
        let cells = Runs::new(whole.map(|(index, _)| index as u32))?;
        watch.end()?;
        stored?;
        let (mut squares, mut level, mut area) = (Vec::new(), 0, f64::from(cells.len()));
        let max_split = MAX_SPLIT.max(centers.len());
        while level < MAX_LEVEL && split.len() <= max_split {
            let side = side(level);
            if split.len() as f64 * side * side <= TESTED_SHARE * area {
                break;
            }
            level += 1;
            let half_diagonal = FRAC_1_SQRT_2 * 0.5 * side;
            let (mut whole, mut partly) = (Vec::new(), Vec::new());
            for square in split.iter().flat_map(|square| square.quarters()) {
                watch.check()?;
                let far = radius + half_diagonal + slack;
                let clearance = distances.clearance(square.center(level), far);
                if clearance >= far {
                    memory::push(PLACES, &mut whole, square)?;
                } else if clearance >= radius - half_diagonal - slack {
                    memory::push(PLACES, &mut partly, square)?;
                }
            }
            area += whole.len() as f64 * 0.25 * side * side;
            squares.push(whole);
            split = partly;
        }
        if area == 0.0 && (level == MAX_LEVEL || split.is_empty()) {
            return Ok(None);
        }
        let units = |(index, squares): (usize, &Vec<Square>)| (squares.len() as u64) << (2 * (level - 1 - index));
        let whole = (u64::from(cells.len()) << (2 * level)) + squares.iter().enumerate().map(units).sum::<u64>();
        let count = whole + split.len() as u64;
        Ok(Some(Self { radius, slack, width, cells, squares, tested: split, count }))
    }

    /// Draws a point uniformly from the free area; `None` if the area is so small that no draw finds it.
    ///
    /// `first` is drawn from the stream by [`pick`](Self::pick). `is_free` decides about a point at which rounding errors
    /// matter.
    pub fn draw(
        &self,
        distances: &Distances,
        first: Pick,
        stream: &mut impl Rng,
        is_free: impl Fn(DVec2) -> bool,
    ) -> Option<DVec2> {
        let mut pick = first;
        for _ in 0..ATTEMPTS {
            let Pick { square, level, is_tested } = pick;
            let bits = stream.next_u64();
            // Numbers in (0, 1), never 0 or 1.
            let share = |bits: u32| (f64::from(bits) + 0.5) / 4_294_967_296.0;
            let at = square.corner(level) + side(level) * DVec2::new(share(bits as u32), share((bits >> 32) as u32));
            let within = at - at.floor();
            let mut is_close = within.min_element() < self.slack || within.max_element() > 1.0 - self.slack;
            let mut is_blocked = false;
            if is_tested {
                let clearance = distances.clearance(at, self.radius + self.slack);
                is_blocked = clearance < self.radius - self.slack;
                is_close |= clearance < self.radius + self.slack;
            }
            if !is_blocked && (!is_close || is_free(at)) {
                return Some(at);
            }
            pick = self.pick(stream);
        }
        None
    }

    /// Draws a square, in proportion to its area.
    pub fn pick(&self, stream: &mut impl Rng) -> Pick {
        let mut unit = ((u128::from(stream.next_u64()) * u128::from(self.count)) >> 64) as u64;
        let last = self.squares.len();
        let units = u64::from(self.cells.len()) << (2 * last);
        if unit < units {
            let cell = self.cells.get((unit >> (2 * last)) as u32);
            return Pick { square: Square::cell(cell as usize, self.width), level: 0, is_tested: false };
        }
        unit -= units;
        for (squares, level) in self.squares.iter().zip(1..) {
            let shift = 2 * (last - level);
            let units = (squares.len() as u64) << shift;
            if unit < units {
                return Pick { square: squares[(unit >> shift) as usize], level, is_tested: false };
            }
            unit -= units;
        }
        Pick { square: self.tested[unit as usize], level: last, is_tested: true }
    }
}

/// Returns a radius that is free somewhere, nearly the largest one; `None` if no cell is known to be free.
///
/// Method: branch and bound. Within a square the clearance differs from that of its centre by at most half of the diagonal.
///
/// # Errors
/// [`Error::Memory`]: there is not enough memory.
pub fn largest_radius(distances: &Distances, is_known_free: impl Fn(usize) -> bool) -> Result<Option<f64>, Error> {
    /// The search ends when a larger radius could be larger by at most this.
    const PRECISION: f64 = 0.01;
    /// Largest number of squares to look at.
    const MAX_SQUARES: usize = 100_000;
    let (width, centers) = (distances.width(), distances.between_centers());
    let cell = |index| Square::cell(index, width);
    let clearance = |square: Square, level: usize| distances.clearance(square.center(level), f64::INFINITY);
    let known = || (0..centers.len()).filter(|&index| is_known_free(index));
    let Some(farthest) = known().max_by(|&a, &b| centers[a].total_cmp(&centers[b])) else { return Ok(None) };
    let mut best = clearance(cell(farthest), 0);
    // Distances that are not negative are in the order of their bits.
    let hopeful = known().filter(|&index| f64::from(centers[index]) > best);
    let mut queue = Vec::new();
    for index in hopeful {
        memory::push(PLACES, &mut queue, (f64::from(centers[index]).to_bits(), 0, cell(index)))?;
    }
    let mut queue = BinaryHeap::from(queue);
    let watch = Watch::new();
    for _ in 0..MAX_SQUARES {
        watch.check()?;
        let Some((bound, level, square)) = queue.pop() else { break };
        if f64::from_bits(bound) <= best + PRECISION || level == MAX_LEVEL {
            break;
        }
        queue.try_reserve(4).map_err(|_| memory::missing::<(u64, usize, Square)>(PLACES, 2 * queue.len()))?;
        for quarter in square.quarters() {
            let found = clearance(quarter, level + 1);
            best = best.max(found);
            queue.push(((found + FRAC_1_SQRT_2 * side(level + 1)).to_bits(), level + 1, quarter));
        }
    }
    // A disc of exactly the largest radius fits at a single point. A little less leaves room to draw from.
    Ok(Some((best - 2.0 * side(MAX_LEVEL)).max(0.0)))
}

impl Square {
    /// Returns the square of level 0 that is the cell with this index, on a grid of `width` columns.
    fn cell(index: usize, width: usize) -> Self {
        Self { col: (index % width) as u32, row: (index / width) as u32 }
    }

    /// Returns the four squares of the next level that cover this one.
    fn quarters(self) -> [Self; 4] {
        let Self { col, row } = self;
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, up)| Self { col: 2 * col + right, row: 2 * row + up })
    }

    fn corner(self, level: usize) -> DVec2 {
        DVec2::new(f64::from(self.col), f64::from(self.row)) * side(level)
    }

    fn center(self, level: usize) -> DVec2 {
        self.corner(level) + 0.5 * side(level)
    }
}

/// Returns the side of a square of a level.
fn side(level: usize) -> f64 {
    1.0 / (1_u64 << level) as f64
}
