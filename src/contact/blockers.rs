//! The pieces of the world near a footprint: edges of blocking cells and outlines of obstacles, in the frame of the grid.

use std::ops::Range;

use glam::DVec2;

use crate::error::Error;
use crate::grid::Cell;
use crate::memory;
use crate::obstacles::Body;
use crate::shape::{encloses, intersect};
use crate::world::World;

/// A convex piece of the world, in the frame of the grid \[m\].
#[derive(Debug, Clone, Copy)]
pub enum Piece {
    /// A straight edge of an obstacle or of the blocking cells: start and end.
    Edge(DVec2, DVec2),
    /// A disc: centre and radius.
    Disc(DVec2, f64),
}

/// A piece, and the index of the obstacle that it belongs to; `None` for the grid.
#[derive(Debug, Clone, Copy)]
pub struct Blocker {
    pub piece: Piece,
    pub obstacle: Option<usize>,
}

/// The pieces of a world within some distance of a point.
pub struct Blockers<'a> {
    world: World<'a>,
    near: Vec<Blocker>,
}

impl<'a> Blockers<'a> {
    /// Returns no pieces yet.
    pub fn none(world: World<'a>) -> Self {
        Self { world, near: Vec::new() }
    }

    /// Returns the pieces within `radius` \[m\] of a point in the frame of the grid.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn around(world: World<'a>, center: DVec2, radius: f64) -> Result<Self, Error> {
        let mut blockers = Self::none(world);
        blockers.gather(center, radius)?;
        Ok(blockers)
    }

    /// Returns true if there are no pieces within `radius` \[m\] of a point in the frame of the grid. May return false though
    /// there are none.
    pub fn is_empty_around(world: World<'_>, center: DVec2, radius: f64) -> bool {
        let grid = world.grid;
        let (cols, mut rows) = grid.cells_between(grid.in_cells(center - radius), grid.in_cells(center + radius));
        let in_map = grid.options().origin.transform_point(center);
        let is_near = |(index, body): (usize, &Body)| {
            let (middle, reach) = body.bounds();
            world.except != Some(index) && middle.distance(in_map) <= radius + reach
        };
        !world.obstacles.bodies().iter().enumerate().any(is_near) && !rows.any(|row| grid.has_blocking(row, cols.clone()))
    }

    /// Replaces the pieces by those within `radius` \[m\] of another point. May add pieces that are a little farther away.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn gather(&mut self, center: DVec2, radius: f64) -> Result<(), Error> {
        self.near.clear();
        self.gather_cells(center, radius)?;
        self.gather_obstacles(center, radius)
    }

    fn add(&mut self, piece: Piece, obstacle: Option<usize>) -> Result<(), Error> {
        memory::push("the walls and obstacles near a footprint", &mut self.near, Blocker { piece, obstacle })
    }

    /// Iterates over the pieces.
    pub fn iter(&self) -> impl Iterator<Item = &Blocker> {
        self.near.iter()
    }

    /// Adds the edges between blocking and free cells.
    ///
    /// Edges of neighbouring cells in a straight line are merged into one: a footprint that slides along a wall must not be
    /// caught at the seam between two cells.
    ///
    /// ```text
    ///   +---+---+---+            +-----------+
    ///   |///|///|///|            |///////////|
    ///   +---+---+---+   becomes  +---+   +---+   8 edges instead of 10
    ///       |///|                    |///|
    ///       +---+                    +---+
    /// ```
    fn gather_cells(&mut self, center: DVec2, radius: f64) -> Result<(), Error> {
        let grid = self.world.grid;
        let (low, high) = (grid.in_cells(center - radius), grid.in_cells(center + radius));
        let (cols, rows) = grid.cells_between(low, high);
        if !rows.clone().any(|row| grid.has_blocking(row, cols.clone())) {
            return Ok(());
        }
        let blocks = |col: usize, row: usize| grid.blocks(Cell { col, row });
        let corner = |col: usize, row: usize| grid.corner(Cell { col, row });
        // Most rows and columns have no edges. To find those that have takes far less time than to look for runs in all.
        for row in (rows.start..=rows.end).filter(|&row| grid.has_edge_below(row, cols.clone())) {
            let is_edge = |col| blocks(col, row.wrapping_sub(1)) != blocks(col, row);
            for run in runs(cols.clone(), is_edge) {
                self.add(Piece::Edge(corner(run.start, row), corner(run.end, row)), None)?;
            }
        }
        let mut has_edge = memory::filled("the columns near a footprint", false, cols.len() + 1)?;
        rows.clone().for_each(|row| grid.mark_edges_on_left(row, cols.clone(), &mut has_edge));
        for col in (cols.start..=cols.end).filter(|&col| has_edge[col - cols.start]) {
            let is_edge = |row| blocks(col.wrapping_sub(1), row) != blocks(col, row);
            for run in runs(rows.clone(), is_edge) {
                self.add(Piece::Edge(corner(col, run.start), corner(col, run.end)), None)?;
            }
        }
        Ok(())
    }

    /// Adds the outlines of the obstacles whose bounding circle is near.
    fn gather_obstacles(&mut self, center: DVec2, radius: f64) -> Result<(), Error> {
        let grid_from_map = self.world.grid.options().origin.inverse();
        let (sin, cos) = libm::sincos(grid_from_map.yaw);
        let to_grid = |point: DVec2| grid_from_map.position + DVec2::new(cos, sin).rotate(point);
        for (index, body) in self.world.obstacles.bodies().iter().enumerate() {
            let (middle, reach) = body.bounds();
            if self.world.except == Some(index) || to_grid(middle).distance(center) > radius + reach {
                continue;
            }
            if body.radius() > 0.0 {
                self.add(Piece::Disc(to_grid(middle), body.radius()), Some(index))?;
            } else {
                for (start, end) in body.edges() {
                    self.add(Piece::Edge(to_grid(start), to_grid(end)), Some(index))?;
                }
            }
        }
        Ok(())
    }

    /// Returns true if a point in the frame of the grid lies inside a blocking cell or an obstacle.
    pub fn holds(&self, point: DVec2) -> bool {
        self.world.grid.block_at(self.world.grid.in_cells(point)) || self.obstacle_at(point).is_some()
    }

    /// Returns the index of the first obstacle that contains a point in the frame of the grid, `None` if there is none.
    pub fn obstacle_at(&self, point: DVec2) -> Option<usize> {
        let bodies = self.world.obstacles.bodies();
        if bodies.is_empty() {
            return None;
        }
        let in_map = self.world.grid.options().origin.transform_point(point);
        let mut bodies = bodies.iter().enumerate();
        bodies.find(|&(index, body)| self.world.except != Some(index) && body.contains(in_map)).map(|(index, _)| index)
    }

    /// Returns true if a footprint overlaps anything: an edge meets a piece, or one of the two is inside the other.
    pub fn overlap(&self, corners: &[DVec2], radius: f64) -> bool {
        corners.iter().any(|&corner| self.holds(corner))
            || self.near.iter().any(|blocker| {
                let gap = |side| blocker.piece.nearest(side).gap(radius);
                encloses(corners, blocker.piece.ends().0) || crate::shape::edges(corners).any(|side| gap(side) <= 0.0)
            })
    }
}

/// The nearest points of an edge of a footprint and of a piece; the same point twice if they meet.
#[derive(Debug, Clone, Copy)]
pub struct Nearest {
    /// Point on the footprint's edge; its centre for a disc.
    pub own: DVec2,
    /// Point on the piece; its centre for a disc.
    pub other: DVec2,
    /// Radius of the piece around `other`, 0 for an edge.
    pub radius: f64,
}

impl Nearest {
    /// Returns the distance \[m\] between piece and footprint, given the footprint's radius; zero or less if they meet.
    pub fn gap(&self, radius: f64) -> f64 {
        self.own.distance(self.other) - self.radius - radius
    }

    fn closer(self, other: Self) -> Self {
        if other.own.distance_squared(other.other) < self.own.distance_squared(self.other) { other } else { self }
    }
}

impl Piece {
    /// Returns the start and end of an edge; the centre of a disc, twice.
    pub fn ends(&self) -> (DVec2, DVec2) {
        match *self {
            Self::Edge(start, end) => (start, end),
            Self::Disc(center, _) => (center, center),
        }
    }

    /// Returns the radius of a disc \[m\], 0 for an edge.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Edge(..) => 0.0,
            Self::Disc(_, radius) => radius,
        }
    }

    /// Returns the nearest points of the piece and of a side of a footprint. The side may be a single point.
    pub fn nearest(&self, side: (DVec2, DVec2)) -> Nearest {
        let toward = |own: DVec2, other: DVec2| Nearest { own, other, radius: 0.0 };
        match *self {
            Self::Disc(center, radius) => Nearest { radius, ..toward(nearest_on(side, center), center) },
            Self::Edge(start, end) => {
                let edge = (start, end);
                if intersect(side, edge) {
                    return toward(start, start);
                }
                toward(side.0, nearest_on(edge, side.0))
                    .closer(toward(side.1, nearest_on(edge, side.1)))
                    .closer(toward(nearest_on(side, start), start))
                    .closer(toward(nearest_on(side, end), end))
            }
        }
    }
}

/// Returns the point of a segment nearest to a point.
fn nearest_on((start, end): (DVec2, DVec2), point: DVec2) -> DVec2 {
    let along = end - start;
    let square = along.length_squared();
    if square == 0.0 {
        return start;
    }
    start + along * ((point - start).dot(along) / square).clamp(0.0, 1.0)
}

/// Iterates over the maximal runs of successive indices for which `holds` is true.
fn runs(within: Range<usize>, holds: impl Fn(usize) -> bool) -> impl Iterator<Item = Range<usize>> {
    let Range { mut start, end } = within;
    std::iter::from_fn(move || {
        let first = (start..end).find(|&index| holds(index))?;
        start = (first..end).find(|&index| !holds(index)).unwrap_or(end);
        Some(first..start)
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use rand::RngExt;

    use super::*;
    use crate::grid::{GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Unknown};
    use crate::pose::Pose;
    use crate::random;

    /// The sides of length 1 that an edge consists of, as (col, row, whether it is upright).
    fn unit_sides(blocker: &Blocker) -> Vec<(usize, usize, bool)> {
        let Piece::Edge(start, end) = blocker.piece else { panic!("a grid has edges only") };
        let length = (end - start).length();
        assert!(start.x == end.x || start.y == end.y, "{start} {end}");
        assert_eq!(length, length.round());
        let is_upright = start.x == end.x;
        let (col, row) = (start.x as usize, start.y as usize);
        let side = |step: usize| if is_upright { (col, row + step, true) } else { (col + step, row, false) };
        (0..length as usize).map(side).collect()
    }

    #[test]
    fn edges_are_the_sides_between_blocking_and_free_cells() {
        let mut stream = random::stream(6, 0);
        for (width, height, share) in
            [(1, 1, 1.0), (1, 9, 0.5), (9, 1, 0.5), (70, 40, 0.02), (40, 70, 0.3), (50, 50, 0.9), (20, 20, 0.0)]
        {
            // -1 is unknown and blocks here, as 60 does; 59 does not.
            let value = |number: f64| if number > share { 59 } else { [-1, 60, 100][(1e6 * number) as usize % 3] };
            let cells: Vec<i8> = (0..width * height).map(|_| value(stream.random())).collect();
            let options = GridOptions {
                resolution: 1.0,
                origin: Pose::default(),
                occupied_threshold: OCCUPIED_THRESHOLD,
                unknown: Unknown::Occupied,
            };
            let grid = OccupancyGrid::new(cells, width, options).expect("a good grid");
            let blocks = |col: usize, row: usize| grid.blocks(Cell { col, row });
            for _ in 0..100 {
                let center = DVec2::new(stream.random(), stream.random()) * DVec2::new(width as f64, height as f64);
                let radius = stream.random_range(0.1..1.2 * width.max(height) as f64);
                let found = Blockers::around((&grid).into(), center, radius).expect("enough memory");
                let (cols, rows) = grid.cells_between(center - radius, center + radius);
                let mut expected = BTreeSet::new();
                if rows.clone().any(|row| cols.clone().any(|col| blocks(col, row))) {
                    for row in rows.start..=rows.end {
                        for col in cols.start..=cols.end {
                            if col < cols.end && blocks(col, row) != blocks(col, row.wrapping_sub(1)) {
                                expected.insert((col, row, false));
                            }
                            if row < rows.end && blocks(col, row) != blocks(col.wrapping_sub(1), row) {
                                expected.insert((col, row, true));
                            }
                        }
                    }
                }
                let sides: Vec<_> = found.iter().flat_map(unit_sides).collect();
                assert_eq!(sides.len(), expected.len(), "{center} {radius}");
                assert_eq!(sides.into_iter().collect::<BTreeSet<_>>(), expected, "{center} {radius}");
                // Neighbouring edges in a straight line are one edge.
                let starts: Vec<_> =
                    found.iter().map(|blocker| (blocker.piece.ends().0, unit_sides(blocker)[0].2)).collect();
                for blocker in found.iter() {
                    assert!(!starts.contains(&(blocker.piece.ends().1, unit_sides(blocker)[0].2)), "{center} {radius}");
                }
            }
        }
    }
}
