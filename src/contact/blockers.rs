//! What a footprint can run into nearby: outlines of blocking cells and of obstacles, in the grid's frame.

use std::ops::Range;

use glam::DVec2;

use crate::shape::{encloses, intersect};
use crate::world::World;

/// A convex piece, in metres of the grid's frame.
#[derive(Debug, Clone, Copy)]
pub enum Piece {
    /// A straight piece of an outline: of an obstacle, or of the blocking cells together.
    Edge(DVec2, DVec2),
    /// A disc: centre and radius.
    Disc(DVec2, f64),
}

/// A piece, and the index of the obstacle that it is of; none for the grid.
#[derive(Debug, Clone, Copy)]
pub struct Blocker {
    pub piece: Piece,
    pub obstacle: Option<usize>,
}

/// Everything within some distance of a point.
pub struct Blockers<'a> {
    world: World<'a>,
    near: Vec<Blocker>,
}

impl<'a> Blockers<'a> {
    /// What lies within `radius` metres of a point of the grid's frame.
    pub fn around(world: World<'a>, center: DVec2, radius: f64) -> Self {
        let mut blockers = Self { world, near: Vec::new() };
        blockers.gather(center, radius);
        blockers
    }

    /// The same for another point.
    pub fn gather(&mut self, center: DVec2, radius: f64) {
        self.near.clear();
        self.gather_cells(center, radius);
        self.gather_obstacles(center, radius);
    }

    /// The pieces.
    pub fn iter(&self) -> impl Iterator<Item = &Blocker> {
        self.near.iter()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.near.is_empty()
    }

    /// Outlines of the blocking cells.
    ///
    /// As long as they go straight on: at a seam between two cells of a wall there is nothing to be caught at.
    fn gather_cells(&mut self, center: DVec2, radius: f64) {
        let grid = self.world.grid;
        let (resolution, width, height) = (grid.resolution(), grid.width(), grid.height());
        let low = ((center - radius) / resolution).floor();
        let high = ((center + radius) / resolution).floor();
        if low.is_nan() || high.x < 0.0 || high.y < 0.0 {
            return;
        }
        // A float becomes the nearest integer it can: negative ones 0.
        let cols = (low.x as usize).min(width)..(high.x as usize).saturating_add(1).min(width);
        let rows = (low.y as usize).min(height)..(high.y as usize).saturating_add(1).min(height);
        let options = grid.options();
        let blocks = |col: usize, row: usize| col < width && row < height && options.blocks(grid.cells()[row * width + col]);
        let line = |row: usize| &grid.cells()[row * width..][cols.clone()];
        if !rows.clone().any(|row| line(row).iter().any(|&value| options.blocks(value))) {
            return;
        }
        let corner = |col: usize, row: usize| DVec2::new(col as f64, row as f64) * resolution;
        let piece = |start, end| Blocker { piece: Piece::Edge(start, end), obstacle: None };
        for row in rows.start..=rows.end {
            let is_edge = |col| blocks(col, row.wrapping_sub(1)) != blocks(col, row);
            self.near.extend(runs(cols.clone(), is_edge).map(|run| piece(corner(run.start, row), corner(run.end, row))));
        }
        for col in cols.start..=cols.end {
            let is_edge = |row| blocks(col.wrapping_sub(1), row) != blocks(col, row);
            self.near.extend(runs(rows.clone(), is_edge).map(|run| piece(corner(col, run.start), corner(col, run.end))));
        }
    }

    fn gather_obstacles(&mut self, center: DVec2, radius: f64) {
        let grid_from_map = self.world.grid.options().origin.inverse();
        let (sin, cos) = libm::sincos(grid_from_map.yaw);
        let to_grid = |point: DVec2| grid_from_map.position + DVec2::new(cos, sin).rotate(point);
        for (index, body) in self.world.obstacles.bodies().iter().enumerate() {
            let (middle, reach) = body.bounds();
            if to_grid(middle).distance(center) > radius + reach {
                continue;
            }
            if body.radius() > 0.0 {
                let piece = Piece::Disc(to_grid(middle), body.radius());
                self.near.push(Blocker { piece, obstacle: Some(index) });
            } else {
                let edges = body.edges().map(|(start, end)| Piece::Edge(to_grid(start), to_grid(end)));
                self.near.extend(edges.map(|piece| Blocker { piece, obstacle: Some(index) }));
            }
        }
    }

    /// Whether a point lies inside of a blocking cell or an obstacle.
    pub fn holds(&self, point: DVec2) -> bool {
        self.world.grid.block_at(point / self.world.grid.resolution()) || self.obstacle_at(point).is_some()
    }

    /// Index of an obstacle that a point lies inside of.
    pub fn obstacle_at(&self, point: DVec2) -> Option<usize> {
        let bodies = self.world.obstacles.bodies();
        if bodies.is_empty() {
            return None;
        }
        let in_map = self.world.grid.options().origin.transform_point(point);
        bodies.iter().position(|body| body.contains(in_map))
    }

    /// Whether a footprint overlaps anything: an edge meets a piece, it holds a piece, or a piece holds it.
    pub fn overlap(&self, corners: &[DVec2], radius: f64) -> bool {
        corners.iter().any(|&corner| self.holds(corner))
            || self.near.iter().any(|blocker| {
                let gap = |side| blocker.piece.nearest(side).gap(radius);
                encloses(corners, blocker.piece.anchor()) || crate::shape::edges(corners).any(|side| gap(side) <= 0.0)
            })
    }
}

/// The nearest points of a footprint's edge and of a piece; the same point twice if they meet.
#[derive(Debug, Clone, Copy)]
pub struct Nearest {
    /// On the footprint's edge, or its centre.
    pub own: DVec2,
    /// On the piece, or its centre.
    pub other: DVec2,
    /// Radius of the piece around `other`.
    pub radius: f64,
}

impl Nearest {
    /// Distance left between the two, where the footprint has a radius too; not positive if they meet.
    pub fn gap(&self, radius: f64) -> f64 {
        self.own.distance(self.other) - self.radius - radius
    }

    fn closer(self, other: Self) -> Self {
        if other.own.distance_squared(other.other) < self.own.distance_squared(self.other) { other } else { self }
    }
}

impl Piece {
    /// Some point of the piece.
    fn anchor(&self) -> DVec2 {
        match *self {
            Self::Edge(point, _) | Self::Disc(point, _) => point,
        }
    }

    /// Where the piece and a side of a footprint come nearest to each other. The ends of the side may be one point.
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

/// The point of a segment nearest to a point.
fn nearest_on((start, end): (DVec2, DVec2), point: DVec2) -> DVec2 {
    let along = end - start;
    let square = along.length_squared();
    if square == 0.0 {
        return start;
    }
    start + along * ((point - start).dot(along) / square).clamp(0.0, 1.0)
}

/// The longest runs of indices in a row that something holds for.
fn runs(within: Range<usize>, holds: impl Fn(usize) -> bool) -> impl Iterator<Item = Range<usize>> {
    let Range { mut start, end } = within;
    std::iter::from_fn(move || {
        let first = (start..end).find(|&index| holds(index))?;
        start = (first..end).find(|&index| !holds(index)).unwrap_or(end);
        Some(first..start)
    })
}
