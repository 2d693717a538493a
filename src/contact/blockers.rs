//! The pieces of the world near a footprint: edges of blocking cells and outlines of obstacles, in the frame of the grid.

use std::ops::Range;

use glam::DVec2;

use crate::error::Error;
use crate::grid::Cell;
use crate::memory;
use crate::shape::{encloses, intersect};
use crate::world::World;

/// Name of the pieces in an error.
const NEAR: &str = "the walls and obstacles near a footprint";

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
    /// The pieces: first those of the grid.
    near: Vec<Blocker>,
    /// Columns and rows of the cells whose edges are in `near`, and the number of these edges; `None` if there are none yet.
    window: Option<(Range<usize>, Range<usize>, usize)>,
    /// Which cells of the window and of a border around it block, row by row.
    blocks: Vec<bool>,
    /// For each column of the window and the next one, whether it has an edge on its left side.
    has_edge: Vec<bool>,
}

impl<'a> Blockers<'a> {
    /// Returns no pieces yet.
    pub fn none(world: World<'a>) -> Self {
        Self { world, near: Vec::new(), window: None, blocks: Vec::new(), has_edge: Vec::new() }
    }

    /// Returns the world that the pieces belong to.
    pub fn world(&self) -> World<'a> {
        self.world
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
        let is_near = |index: usize| {
            let (middle, reach) = world.obstacles.bodies()[index].bounds();
            world.except != Some(index) && middle.distance(in_map) <= radius + reach
        };
        !world.obstacles.near(in_map, radius).any(is_near) && !rows.any(|row| grid.has_blocking(row, cols.clone()))
    }

    /// Replaces the pieces by those within `radius` \[m\] of another point. May add pieces that are a little farther away.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn gather(&mut self, center: DVec2, radius: f64) -> Result<(), Error> {
        let grid = self.world.grid;
        let (cols, rows) = grid.cells_between(grid.in_cells(center - radius), grid.in_cells(center + radius));
        match &self.window {
            Some((same_cols, same_rows, count)) if (same_cols, same_rows) == (&cols, &rows) => self.near.truncate(*count),
            _ => {
                self.window = None;
                self.near.clear();
                self.gather_cells(cols.clone(), rows.clone())?;
                self.window = Some((cols, rows, self.near.len()));
            }
        }
        self.gather_obstacles(center, radius)
    }

    fn add(&mut self, piece: Piece, obstacle: Option<usize>) -> Result<(), Error> {
        memory::push(NEAR, &mut self.near, Blocker { piece, obstacle })
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
    fn gather_cells(&mut self, cols: Range<usize>, rows: Range<usize>) -> Result<(), Error> {
        let grid = self.world.grid;
        if !rows.clone().any(|row| grid.has_blocking(row, cols.clone())) {
            return Ok(());
        }
        let corner = |col: usize, row: usize| grid.corner(Cell { col, row });
        // The window with a border of one cell on each side; cells off the grid are free.
        let width = cols.len() + 2;
        self.blocks.clear();
        self.has_edge.clear();
        memory::lengthen(NEAR, &mut self.blocks, width * (rows.len() + 2), false)?;
        memory::lengthen(NEAR, &mut self.has_edge, width - 1, false)?;
        let (first_col, first_row) = (cols.start.saturating_sub(1), rows.start.saturating_sub(1));
        for row in first_row..(rows.end + 1).min(grid.height()) {
            let line = &mut self.blocks[(row + 1 - rows.start) * width..][..width];
            grid.copy_blocking(row, first_col..(cols.end + 1).min(grid.width()), &mut line[first_col + 1 - cols.start..]);
            if rows.contains(&row) {
                for (has_edge, pair) in self.has_edge.iter_mut().zip(line.windows(2)) {
                    *has_edge |= pair[0] != pair[1];
                }
            }
        }
        let add = |near: &mut Vec<Blocker>, start, end| {
            memory::push(NEAR, near, Blocker { piece: Piece::Edge(start, end), obstacle: None })
        };
        let mut lines = self.blocks.chunks_exact(width).map(|line| &line[1..width - 1]);
        let mut below = lines.next().unwrap_or_default();
        for (row, line) in (rows.start..).zip(lines) {
            if below != line {
                for run in runs(0..cols.len(), |col| below[col] != line[col]) {
                    add(&mut self.near, corner(cols.start + run.start, row), corner(cols.start + run.end, row))?;
                }
            }
            below = line;
        }
        for (left, _) in self.has_edge.iter().enumerate().filter(|(_, has_edge)| **has_edge) {
            let is_edge = |row: usize| {
                let at = (row + 1) * width + left;
                self.blocks[at] != self.blocks[at + 1]
            };
            for run in runs(0..rows.len(), is_edge) {
                let col = cols.start + left;
                add(&mut self.near, corner(col, rows.start + run.start), corner(col, rows.start + run.end))?;
            }
        }
        Ok(())
    }

    /// Adds the outlines of the obstacles whose bounding circle is near.
    fn gather_obstacles(&mut self, center: DVec2, radius: f64) -> Result<(), Error> {
        if self.world.obstacles.is_empty() {
            return Ok(());
        }
        let grid_from_map = self.world.grid.options().origin.inverse();
        let (sin, cos) = libm::sincos(grid_from_map.yaw);
        let to_grid = |point: DVec2| grid_from_map.position + DVec2::new(cos, sin).rotate(point);
        let in_map = self.world.grid.options().origin.transform_point(center);
        let of_grid = self.near.len();
        let obstacles = self.world.obstacles;
        for index in obstacles.near(in_map, radius) {
            let body = &obstacles.bodies()[index];
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
        // Which of two equal contacts is found depends on their order. The edges of an obstacle stay in theirs.
        self.near[of_grid..].sort_by_key(|blocker| blocker.obstacle);
        Ok(())
    }

    /// Returns true if a point in the frame of the grid lies inside a blocking cell or an obstacle.
    pub fn holds(&self, point: DVec2) -> bool {
        self.world.grid.block_at(self.world.grid.in_cells(point)) || self.obstacle_at(point).is_some()
    }

    /// Returns the index of the first obstacle that contains a point in the frame of the grid, `None` if there is none.
    pub fn obstacle_at(&self, point: DVec2) -> Option<usize> {
        if self.world.obstacles.is_empty() {
            return None;
        }
        let in_map = self.world.grid.options().origin.transform_point(point);
        let World { obstacles, except, .. } = self.world;
        let holds = |&index: &usize| except != Some(index) && obstacles.bodies()[index].contains(in_map);
        obstacles.near(in_map, 0.0).filter(holds).min()
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
    use super::*;
    use crate::grid::{GridOptions, OccupancyGrid, Unknown};
    use crate::obstacles::Obstacles;
    use crate::pose::Pose;
    use crate::random;
    use crate::shape::Shape;
    use rand::RngExt;

    /// Edges between a blocking and a free cell of a window, from a look at each pair of cells.
    fn plain_edges(grid: &OccupancyGrid, cols: Range<usize>, rows: Range<usize>) -> Vec<(DVec2, DVec2)> {
        let blocks = |col: usize, row: usize| {
            col < grid.width() && row < grid.height() && grid.block_at(DVec2::new(col as f64 + 0.5, row as f64 + 0.5))
        };
        let corner = |col: usize, row: usize| grid.corner(Cell { col, row });
        let mut edges = Vec::new();
        if !rows.clone().any(|row| cols.clone().any(|col| blocks(col, row))) {
            return edges;
        }
        for row in rows.start..=rows.end {
            let is_edge = |col: usize| blocks(col, row.wrapping_sub(1)) != blocks(col, row);
            edges.extend(runs(cols.clone(), is_edge).map(|run| (corner(run.start, row), corner(run.end, row))));
        }
        for col in cols.start..=cols.end {
            let is_edge = |row: usize| blocks(col.wrapping_sub(1), row) != blocks(col, row);
            edges.extend(runs(rows.clone(), is_edge).map(|run| (corner(col, run.start), corner(col, run.end))));
        }
        edges
    }

    #[test]
    fn the_pieces_are_the_edges_of_the_cells_however_often_they_are_gathered() {
        let mut stream = random::stream(5, 0);
        let mut found = 0;
        for (width, height, share) in [(1, 1, 1.0), (1, 9, 0.3), (9, 1, 0.3), (23, 31, 0.02), (23, 31, 0.3), (12, 40, 0.9)] {
            let cells = (0..width * height).map(|_| if stream.random::<f64>() < share { 100 } else { 0 }).collect();
            let origin = Pose::default();
            let options = GridOptions { resolution: 0.5, origin, occupied_threshold: 60, unknown: Unknown::Free };
            let grid = OccupancyGrid::new(cells, width, options).unwrap();
            let (disc, square) = (Shape::disc(0.4).unwrap(), Shape::rectangle(1.0, 1.0).unwrap());
            let obstacles = [(&disc, Pose::new(0.5, 0.5, 0.0)), (&square, Pose::new(3.0, 2.0, 0.3))];
            let obstacles = Obstacles::new(obstacles).unwrap();
            let world = World::from((&grid, &obstacles));
            let mut kept = Blockers::none(world);
            let mut center = DVec2::ZERO;
            for turn in 0..600 {
                // Now and then the same window again.
                if turn % 3 > 0 {
                    let size = 0.5 * DVec2::new(width as f64, height as f64);
                    center = size * DVec2::new(stream.random(), stream.random()) * 1.4 - 0.2 * size;
                }
                let radius = [0.1, 0.8, 3.0][stream.random_range(0..3)];
                kept.gather(center, radius).unwrap();
                let (cols, rows) = grid.cells_between(grid.in_cells(center - radius), grid.in_cells(center + radius));
                let listed = |blockers: &Blockers<'_>| -> Vec<_> {
                    blockers.iter().map(|blocker| (blocker.piece.ends(), blocker.obstacle)).collect()
                };
                let pieces = listed(&kept);
                assert_eq!(pieces, listed(&Blockers::around(world, center, radius).unwrap()));
                let edges: Vec<_> =
                    pieces.iter().filter(|(_, obstacle)| obstacle.is_none()).map(|(ends, _)| *ends).collect();
                assert_eq!(edges, plain_edges(&grid, cols, rows), "{width} {height} {center} {radius}");
                found += edges.len();
            }
        }
        assert!(found > 10_000, "{found}");
    }
}
