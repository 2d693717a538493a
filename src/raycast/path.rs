//! Path: the way of a beam through glass and from mirror to mirror.

use glam::DVec2;

use super::Ray;
use super::ray::flush_tiny;
use super::track::Track;
use super::traversal::{Side, Walk};
use crate::free_boxes::{FreeBoxes, length};
use crate::grid::{Cell, OccupancyGrid};
use crate::obstacles::Body;
use crate::pose::Pose;
use crate::surface::{Material, MaterialKind};

/// Largest number of mirrors on a path. A beam that meets one more has no return.
pub const MAX_BOUNCES: usize = 16;

/// Distance \[m\] from a mirror at which a reflected beam starts, so that rounding cannot put its start into the mirror.
const CLEARANCE: f64 = 1e-9;

/// A beam: where it starts and where it points.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    /// Start in the map frame \[m\].
    pub position: DVec2,
    /// Direction in the map frame: a unit vector.
    pub direction: DVec2,
    /// Start in the frame of the grid \[cells\].
    pub origin: DVec2,
    /// Direction in the frame of the grid: a unit vector.
    pub in_grid: DVec2,
    /// The first blocking cell that it enters, if that is known.
    pub first_cell: Option<Cell>,
}

impl Beam {
    /// Returns the beam from a pose in the map, in a direction in the frame there.
    pub fn new(grid: &OccupancyGrid, map_from_fan: Pose, direction: DVec2) -> Self {
        // The expressions of the fast kernels, so that ranges have the same bits.
        let grid_from_fan = grid.pose_in_grid(map_from_fan);
        let turned = |yaw: f64| {
            let (sin, cos) = libm::sincos(yaw);
            DVec2::new(cos, sin).rotate(direction)
        };
        Self {
            position: map_from_fan.position,
            direction: turned(map_from_fan.yaw),
            origin: grid.in_cells(grid_from_fan.position),
            in_grid: turned(grid_from_fan.yaw),
            first_cell: None,
        }
    }
}

/// Where the path of a beam ends, and what became of its light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// Length of the whole path \[m\].
    pub length: f64,
    /// Share of the light that reaches the last surface, 0 to 1.
    pub light: f64,
    /// What the last surface is made of.
    pub material: Material,
    /// Cosine of the angle of incidence at the last surface; NaN if the path ends inside something.
    pub cosine: f64,
    /// Direction of the last part of the path, in the map frame: a unit vector.
    pub direction: DVec2,
    /// The cell at which the path ends; `None` if it ends at an obstacle.
    pub cell: Option<Cell>,
}

impl Path {
    /// Returns how much light comes back, relative to a white wall at a right angle and a distance of 1 m.
    ///
    /// It is `reflectivity · cos α / length²` (a Lambertian surface, and the inverse square law), times the share of the light
    /// that is left on the way there and back. It is 0 inside something.
    pub fn intensity(&self) -> f64 {
        let intensity = self.share() * self.cosine / (self.length * self.length);
        if intensity.is_finite() { intensity } else { 0.0 }
    }

    /// Returns the share of the light that the last surface would return at a right angle, on the way there and back.
    pub fn share(&self) -> f64 {
        self.light * self.light * self.material.reflectivity
    }
}

/// A surface that a straight part of a path meets.
struct Meeting<'a> {
    /// Distance from the start of the part \[m\].
    distance: f64,
    /// Unit normal of the surface, in the map frame; `None` if the part starts inside.
    normal: Option<DVec2>,
    material: &'a Material,
    /// The cell whose surface it is; `None` for an obstacle.
    cell: Option<Cell>,
    next: Next,
}

/// Where the grid is entered by a beam that a surface reflects.
#[derive(Clone, Copy)]
enum Next {
    /// In the cell before the surface, at the start of this ray; its direction is not yet that of the reflection.
    From(Ray),
    /// Nowhere: the beam leaves the grid.
    Outside,
    /// Wherever the outline of an obstacle is.
    Anywhere,
}

/// The cells of a grid that a straight part of a path enters, without those where only the inside of a pane goes on.
struct Cells<'a> {
    grid: &'a OccupancyGrid,
    ray: Ray,
    walk: Walk,
    /// How the ray jumps over free cells; `None` if it has not jumped yet.
    jumps: Option<Jumps<'a>>,
    /// The cell before the current one; `None` before the first one, or off the grid.
    before: Option<Cell>,
    /// Side through which the current cell was entered; `None` if the ray starts in it.
    side: Option<Side>,
}

impl<'a> Cells<'a> {
    /// Returns the cells from the start of a ray on.
    fn new(grid: &'a OccupancyGrid, ray: Ray) -> Self {
        let has_entered = ray.gap > 0.0;
        let through_column = ray.direction.x != 0.0 && ray.origin.x.fract() == 0.0;
        let side = has_entered.then_some(if through_column { Side::Column } else { Side::Row });
        Self { grid, ray, walk: Walk::new(&ray), jumps: None, before: None, side }
    }

    /// Goes to a cell on the way, with only free cells before it.
    fn go_to(&mut self, cell: Cell) {
        let (col, row) = (cell.col as i64, cell.row as i64);
        if (col, row) != (self.ray.col.into(), self.ray.row.into()) {
            self.jump(col, row);
        }
    }

    /// Returns the next surface, before `limit` \[m\] from the start of the ray.
    fn next_meeting(&mut self, limit: f64) -> Option<Meeting<'a>> {
        let grid = self.grid;
        loop {
            let cell = self.walk.cell(grid)?;
            let distance = (self.ray.gap + self.walk.distance.max(0.0)) * grid.resolution();
            if distance >= limit {
                return None;
            }
            if !grid.is_blocking(cell) {
                self.leave(cell);
                continue;
            }
            let material = grid.material(cell);
            let meets = !(self.is_in_glass() && material.kind == MaterialKind::Glass);
            let meeting = meets.then(|| Meeting {
                distance,
                normal: self.side.map(|side| grid.direction_in_map(side.normal())),
                material,
                cell: Some(cell),
                next: self.next(),
            });
            self.before = Some(cell);
            self.side = Some(self.walk.step());
            if meeting.is_some() {
                return meeting;
            }
        }
    }

    /// Goes from a free cell to the next one, or to one farther on the way with only free cells between them.
    fn leave(&mut self, cell: Cell) {
        let Some(free_boxes) = self.grid.built_free_boxes() else {
            self.before = Some(cell);
            self.side = Some(self.walk.step());
            return;
        };
        let jumps = self.jumps.get_or_insert_with(|| Jumps::new(free_boxes, &self.ray));
        let (col, row) = jumps.next_end(&self.ray, cell);
        self.jump(col, row);
    }

    fn jump(&mut self, col: i64, row: i64) {
        let side = self.walk.jump(&self.ray, col, row);
        let back = |number: i64, is_up: bool| (if is_up { number - 1 } else { number + 1 }) as usize;
        self.before = Some(match side {
            Side::Column => Cell { col: back(col, self.ray.direction.x >= 0.0), row: row as usize },
            Side::Row => Cell { col: col as usize, row: back(row, self.ray.direction.y >= 0.0) },
        });
        self.side = Some(side);
    }

    /// Returns true if the current cell is entered from inside a pane, or if the ray starts in it.
    fn is_in_glass(&self) -> bool {
        let is_glass = |cell| self.grid.is_blocking(cell) && self.grid.material(cell).kind == MaterialKind::Glass;
        self.side.is_none() || self.before.is_some_and(is_glass)
    }

    /// Returns the ray back into the cell before, from the point where the current cell is entered.
    fn next(&self) -> Next {
        let (Some(before), Some(cell), Some(side)) = (self.before, self.walk.cell(self.grid), self.side) else {
            return Next::Outside;
        };
        let at = self.ray.origin + self.ray.direction * self.walk.distance;
        let (low, between) = (DVec2::new(before.col as f64, before.row as f64), |a: usize, b: usize| a.max(b) as f64);
        let origin = match side {
            Side::Column => DVec2::new(between(before.col, cell.col), at.y.clamp(low.y, low.y + 1.0)),
            Side::Row => DVec2::new(at.x.clamp(low.x, low.x + 1.0), between(before.row, cell.row)),
        };
        Next::From(Ray { origin, direction: self.ray.direction, col: before.col as i32, row: before.row as i32, gap: 0.0 })
    }
}

/// The jumps of a ray over free boxes.
struct Jumps<'a> {
    free_boxes: &'a FreeBoxes,
    track: Track,
}

impl<'a> Jumps<'a> {
    fn new(free_boxes: &'a FreeBoxes, ray: &Ray) -> Self {
        Self { free_boxes, track: Track::new(free_boxes, ray) }
    }

    /// Returns column and row of the next cell on the way of a ray, from a cell on, that blocks or is off the grid.
    fn next_end(&self, ray: &Ray, cell: Cell) -> (i64, i64) {
        let sector = self.track.sector;
        let codes = self.free_boxes.codes();
        let stride = self.free_boxes.stride(sector);
        let first = self.free_boxes.index(ray.col, ray.row, sector);
        let mut at = sector.order((cell.col as i32 - ray.col).abs(), (cell.row as i32 - ray.row).abs());
        loop {
            let length = length(codes[first + at.1 as usize * stride + at.0 as usize]);
            if length == 0 {
                let (cols, rows) = sector.order(at.0, at.1);
                return (sector.x().ahead(ray.col, cols).into(), sector.y().ahead(ray.row, rows).into());
            }
            at = self.track.step(at, length);
        }
    }
}

impl Side {
    /// Returns the normal in the frame of the grid.
    fn normal(self) -> DVec2 {
        match self {
            Self::Column => DVec2::X,
            Self::Row => DVec2::Y,
        }
    }
}

/// Follows a beam to the surface that returns it; `None` if that is not nearer than `max_range` \[m\] along the path.
///
/// | the beam meets | and then |
/// |---|---|
/// | an opaque surface | the path ends |
/// | a mirror | it is reflected about the normal: of the side of the cell, or of the outline of the obstacle |
/// | glass | the path ends with the probability of the material, else the beam goes straight on |
///
/// Adjacent cells of glass are one pane. A beam meets an obstacle of glass at most once on each straight part of its path. `draw`
/// returns a random number in \[0, 1) for each pane. The light falls at each surface: see [`Material::reflectivity`].
pub fn follow<'b>(
    grid: &OccupancyGrid,
    bodies: &(impl Iterator<Item = &'b Body> + Clone),
    beam: Beam,
    max_range: f64,
    mut draw: impl FnMut() -> f64,
) -> Option<Path> {
    let mut ray = Ray::entering(grid.width(), grid.height(), beam.origin, beam.in_grid);
    let (mut origin, mut direction) = (beam.position, beam.direction);
    let (mut length, mut light, mut first_cell) = (0.0, 1.0, beam.first_cell);
    let mut meetings = Vec::new();
    for _ in 0..=MAX_BOUNCES {
        let limit = max_range - length;
        meetings.clear();
        meetings.extend(bodies.clone().filter_map(|body| meeting(body, origin, direction, limit)));
        meetings.sort_by(|a: &Meeting<'_>, b| b.distance.total_cmp(&a.distance));
        let mut cells = ray.map(|ray| Cells::new(grid, ray));
        if let (Some(cells), Some(first)) = (&mut cells, first_cell.take()) {
            cells.go_to(first);
        }
        let mut cell = None;
        let (mirror, normal) = loop {
            cell = cell.or_else(|| cells.as_mut()?.next_meeting(limit));
            // The nearest surface: that of a cell, unless an obstacle is nearer.
            let body_is_next = match (&cell, meetings.last()) {
                (Some(cell), Some(body)) => body.distance < cell.distance,
                (None, body) => body.is_some(),
                (Some(_), None) => false,
            };
            let met = if body_is_next { meetings.pop()? } else { cell.take()? };
            let cosine = met.normal.map_or(f64::NAN, |normal| normal.dot(direction).abs().min(1.0));
            let end =
                Path { length: length + met.distance, light, material: *met.material, cosine, direction, cell: met.cell };
            match (met.material.kind, met.normal) {
                (MaterialKind::Mirror, Some(normal)) => break (met, normal),
                (MaterialKind::Glass, Some(_)) => {
                    let may_return = libm::acos(cosine) <= met.material.return_angle;
                    if draw() < met.material.return_chance && may_return {
                        return Some(end);
                    }
                    light *= 1.0 - met.material.reflectivity;
                }
                _ => return Some(end),
            }
        };
        length += mirror.distance;
        light *= mirror.material.reflectivity;
        let point = origin + direction * mirror.distance;
        let away = if normal.dot(direction) > 0.0 { -normal } else { normal };
        direction = (direction - 2.0 * normal.dot(direction) * normal).normalize();
        origin = point + away * CLEARANCE;
        let in_grid = grid.direction_in_grid(direction);
        ray = match mirror.next {
            Next::From(ray) => {
                let direction = DVec2::new(flush_tiny(in_grid.x), flush_tiny(in_grid.y));
                Some(Ray { direction, ..ray })
            }
            Next::Outside => None,
            Next::Anywhere => {
                let start = grid.pose_in_grid(Pose { position: origin, yaw: 0.0 }).position;
                Ray::entering(grid.width(), grid.height(), grid.in_cells(start), in_grid)
            }
        };
    }
    None
}

/// Returns how a part of a path from `origin` meets an obstacle before `limit` \[m\].
fn meeting(body: &Body, origin: DVec2, direction: DVec2, limit: f64) -> Option<Meeting<'_>> {
    let material = body.material();
    let is_inside = body.contains(origin);
    if is_inside && material.kind == MaterialKind::Glass {
        return None;
    }
    let distance = if is_inside { 0.0 } else { body.entry(origin, direction) };
    (distance < limit).then(|| {
        let normal = (!is_inside).then(|| body.normal_near(origin + direction * distance));
        Meeting { distance, normal, material, cell: None, next: Next::Anywhere }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Materials;
    use crate::{GridOptions, OCCUPIED_THRESHOLD, Unknown, random};
    use rand::{Rng, RngExt};
    use std::sync::Arc;

    const SIZE: usize = 60;

    /// Cells that block here and there, of all materials, and two mirrors that face each other.
    fn grid(stream: &mut impl Rng) -> OccupancyGrid {
        let is_mirror = |index: usize| index / SIZE == 5 || index / SIZE == 50;
        let numbers = (0..SIZE * SIZE).map(|index| if is_mirror(index) { 2 } else { stream.random_range(0..4) }).collect();
        let cells = (0..SIZE * SIZE).map(|index| i8::from(is_mirror(index) || stream.random_range(0..90) == 0) * 100);
        let (origin, occupied_threshold) = (Pose::new(-1.0, 2.0, 0.3), OCCUPIED_THRESHOLD);
        let options = GridOptions { resolution: 0.1, origin, occupied_threshold, unknown: Unknown::Free };
        let grid = OccupancyGrid::new(cells.collect(), SIZE, options).expect("a grid");
        let materials = Materials::new(numbers, SIZE, Material::NAMED.map(|(_, material)| material).to_vec());
        grid.with_materials(Some(Arc::new(materials.expect("materials")))).expect("the same shape")
    }

    fn first_blocking(grid: &OccupancyGrid, ray: &Ray) -> Option<Cell> {
        let mut walk = Walk::new(ray);
        while !grid.is_blocking(walk.cell(grid)?) {
            walk.step();
        }
        walk.cell(grid)
    }

    #[test]
    fn jumps_and_known_cells_do_not_change_paths() {
        let mut stream = random::stream(6, 0);
        let (mut bounces, mut panes) = (0, 0);
        for _ in 0..5 {
            let grid = grid(&mut stream);
            let beams: Vec<Beam> = (0..4000)
                .map(|_| {
                    let mut along = || (stream.random::<f64>() * 1.4 - 0.2) * SIZE as f64;
                    let origin = DVec2::new(along(), along());
                    let origin = if stream.next_u64().is_multiple_of(4) { origin.round() } else { origin };
                    let (sin, cos) = libm::sincos((stream.next_u64() % 64) as f64 * (std::f64::consts::TAU / 64.0));
                    let (in_grid, resolution) = (DVec2::new(cos, sin), grid.resolution());
                    let direction = grid.direction_in_map(in_grid);
                    let position = DVec2::new(-1.0, 2.0) + grid.direction_in_map(origin) * resolution;
                    Beam { position, direction, origin, in_grid, first_cell: None }
                })
                .collect();
            let path = |beam: Beam| {
                let mut draws = 0_u32;
                let draw = || {
                    draws += 1;
                    f64::from(draws % 3) * 0.45
                };
                let path = follow(&grid, &[].iter(), beam, 40.0, draw);
                (path.map(|path| (path, path.cosine.to_bits(), path.length.to_bits())), draws)
            };
            // As text, in which NaN equals NaN.
            let plain: Vec<_> = beams.iter().map(|&beam| format!("{:?}", path(beam))).collect();
            grid.prepare(Some(1)).expect("enough memory");
            for (beam, plain) in beams.into_iter().zip(&plain) {
                let (found, draws) = path(beam);
                assert_eq!(&format!("{:?}", (found, draws)), plain, "{beam:?}");
                (panes, bounces) = (panes + draws, bounces + u32::from(found.is_some_and(|(path, ..)| path.light < 0.9)));
                let ray = Ray::entering(SIZE, SIZE, beam.origin, beam.in_grid);
                let first_cell = ray.and_then(|ray| first_blocking(&grid, &ray));
                assert_eq!(&format!("{:?}", path(Beam { first_cell, ..beam })), plain, "{beam:?}");
            }
        }
        assert!(bounces > 500 && panes > 500, "{bounces} {panes}");
    }
}
