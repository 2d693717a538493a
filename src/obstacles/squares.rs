//! Squares of the plane, each with the obstacles in it: finds those near a point without a look at all of them.
//!
//! Method: spatial hashing (Teschner et al., *Optimized Spatial Hashing for Collision Detection of Deformable Objects*, 2003).

use glam::DVec2;

use super::OBSTACLES;
use crate::error::Error;
use crate::memory;

/// Side of a square \[m\].
const SIDE: f64 = 4.0;

/// Largest reach \[m\] of an obstacle that is kept in a square. The few larger ones are always candidates.
const MAX_REACH: f64 = 1.0;

/// Number of obstacles up to which a look at all of them is as fast.
const FEW: usize = 64;

/// Column and row of a square.
type Square = (i64, i64);

/// The obstacles of each square, by the square that holds the obstacle's centre.
#[derive(Debug)]
pub struct Squares {
    /// Indices of obstacles. Each square has a slot, which it may share with others. Their number is a power of two, or 0 if
    /// there are so few obstacles that none is in a square.
    slots: Vec<Vec<u32>>,
    /// Indices of the obstacles that are larger than a square allows.
    large: Vec<u32>,
}

/// A circle that encloses an obstacle.
#[derive(Debug, Clone, Copy)]
pub struct Circle {
    pub center: DVec2,
    /// Radius \[m\].
    pub reach: f64,
    /// True if the obstacle is a disc: this circle.
    pub is_outline: bool,
}

impl Squares {
    /// Those of no obstacles.
    pub const NONE: Self = Self { slots: Vec::new(), large: Vec::new() };

    /// Takes note that the circle of an obstacle, known by its index, has changed from `before`, which is `None` if it is new,
    /// to the one that `circles` has. Without memory for squares there are none, and searches take longer.
    pub fn update(&mut self, circles: &[Circle], index: usize, before: Option<Circle>) {
        let updated = if circles.len() > 2 * self.slots.len().max(FEW / 2) {
            self.build(circles)
        } else if self.slots.is_empty() {
            Ok(())
        } else {
            self.change(circles, index, before)
        };
        if updated.is_err() {
            *self = Self::NONE;
        }
    }

    fn build(&mut self, circles: &[Circle]) -> Result<(), Error> {
        *self = Self::NONE;
        self.slots = memory::with_room(OBSTACLES, circles.len().next_power_of_two())?;
        self.slots.resize_with(circles.len().next_power_of_two(), Vec::new);
        (0..circles.len()).try_for_each(|index| self.change(circles, index, None))
    }

    fn change(&mut self, circles: &[Circle], index: usize, before: Option<Circle>) -> Result<(), Error> {
        let after = self.place_of(circles[index]);
        let before = before.map(|circle| self.place_of(circle));
        if before == Some(after) {
            return Ok(());
        }
        memory::push(OBSTACLES, self.list(after), index as u32)?;
        if let Some(before) = before {
            let list = self.list(before);
            if let Some(at) = list.iter().position(|&other| other as usize == index) {
                list.swap_remove(at);
            }
        }
        Ok(())
    }

    /// Returns the slot of a circle; `None` for a large one.
    fn place_of(&self, circle: Circle) -> Option<usize> {
        (circle.reach <= MAX_REACH).then(|| self.slot(square_of(circle.center)))
    }

    fn list(&mut self, place: Option<usize>) -> &mut Vec<u32> {
        match place {
            Some(slot) => &mut self.slots[slot],
            None => &mut self.large,
        }
    }

    fn slot(&self, (col, row): Square) -> usize {
        // The two large primes of the source.
        (col.wrapping_mul(73_856_093) ^ row.wrapping_mul(19_349_663)) as usize & (self.slots.len() - 1)
    }

    /// Iterates over the indices of all obstacles whose circle may share a point with that of radius `radius` \[m\] around
    /// `center`, in any order, each once. Returns `None` if a look at all obstacles is faster.
    pub fn near<'a>(&'a self, circles: &'a [Circle], center: DVec2, radius: f64) -> Option<impl Iterator<Item = usize>> {
        let reach = DVec2::splat(radius + MAX_REACH);
        let (low, high) = (((center - reach) / SIDE).floor(), ((center + reach) / SIDE).floor());
        let count = (high - low + DVec2::ONE).element_product();
        // A square takes longer than an obstacle.
        if count.is_nan() || count * 8.0 > self.slots.len() as f64 {
            return None;
        }
        let (cols, rows) = (low.x as i64..=high.x as i64, low.y as i64..=high.y as i64);
        let squares = cols.flat_map(move |col| rows.clone().map(move |row| (col, row)));
        let in_squares = squares.flat_map(move |square| {
            let list = self.slots[self.slot(square)].iter().map(|&index| index as usize);
            list.filter(move |&index| square_of(circles[index].center) == square)
        });
        Some(in_squares.chain(self.large.iter().map(|&index| index as usize)))
    }
}

fn square_of(center: DVec2) -> Square {
    let square = (center / SIDE).floor();
    (square.x as i64, square.y as i64)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::random;

    #[test]
    fn the_squares_find_what_a_look_at_all_obstacles_finds() {
        let mut stream = random::stream(7, 0);
        let mut found = 0;
        for (count, extent, largest) in
            [(1000, 60.0, 0.5), (1000, 60.0, 1.3), (300, 8.0, 0.9), (5000, 4e6, 1.0), (200, 30.0, 9.0)]
        {
            let mut circle = || {
                let center = extent * (DVec2::new(stream.random(), stream.random()) - 0.5);
                Circle { center, reach: largest * stream.random::<f64>(), is_outline: true }
            };
            let (mut squares, mut circles) = (Squares::NONE, Vec::new());
            for index in 0..count {
                circles.push(circle());
                squares.update(&circles, index, None);
            }
            for turn in 0..400 {
                // One obstacle moves, by a little or to another place.
                let (index, mut moved) = (37 * turn % count, circle());
                if turn % 2 == 0 {
                    moved.center = circles[index].center + 1e-3 * moved.center;
                }
                let before = std::mem::replace(&mut circles[index], moved);
                squares.update(&circles, index, Some(before));
                let Circle { center, reach, .. } = circle();
                let Some(near) = squares.near(&circles, center, reach) else { continue };
                let mut near: Vec<usize> = near.collect();
                near.sort_unstable();
                assert!(near.windows(2).all(|pair| pair[0] < pair[1]), "twice the same in {near:?}");
                let meets = |&index: &usize| circles[index].center.distance(center) <= reach + circles[index].reach;
                let expected: Vec<usize> = (0..count).filter(meets).collect();
                assert!(expected.iter().all(|index| near.contains(index)), "{expected:?} {near:?}");
                found += expected.len();
            }
        }
        assert!(found > 500, "{found}");
    }

    #[test]
    fn a_wide_search_and_one_without_an_end_look_at_all_obstacles() {
        let circle = |place| Circle { center: DVec2::new(f64::from(place), 0.0), reach: 0.2, is_outline: true };
        let circles: Vec<Circle> = (0..1000).map(circle).collect();
        let mut squares = Squares::NONE;
        (0..circles.len()).for_each(|index| squares.update(&circles[..=index], index, None));
        assert!(squares.near(&circles, DVec2::ZERO, 0.3).is_some());
        for (center, radius) in [(DVec2::ZERO, 500.0), (DVec2::ZERO, f64::INFINITY), (DVec2::NAN, 1.0)] {
            assert!(squares.near(&circles, center, radius).is_none());
        }
    }
}
