//! Path: the way of a beam through glass and from mirror to mirror.

use glam::DVec2;

use super::Ray;
use super::traversal::{Side, Walk};
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
    /// Frame from which the beam starts, in the map frame.
    pub map_from_fan: Pose,
    /// Direction in that frame: a unit vector.
    pub direction: DVec2,
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
        Self { grid, ray, walk: Walk::new(&ray), before: None, side }
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
            let material = grid.material(cell);
            let meets = grid.is_blocking(cell) && !(self.is_in_glass() && material.kind == MaterialKind::Glass);
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
    // The expressions of the fast kernels, so that the first part has the same length to the last bit.
    let grid_from_fan = grid.pose_in_grid(beam.map_from_fan);
    let turned = |yaw: f64, vector: DVec2| {
        let (sin, cos) = libm::sincos(yaw);
        DVec2::new(cos, sin).rotate(vector)
    };
    let in_grid = turned(grid_from_fan.yaw, beam.direction);
    let mut ray = Ray::entering(grid.width(), grid.height(), grid.in_cells(grid_from_fan.position), in_grid);
    let (mut origin, mut direction) = (beam.map_from_fan.position, turned(beam.map_from_fan.yaw, beam.direction));
    let (mut length, mut light) = (0.0, 1.0);
    let mut meetings = Vec::new();
    for _ in 0..=MAX_BOUNCES {
        let limit = max_range - length;
        meetings.clear();
        meetings.extend(bodies.clone().filter_map(|body| meeting(body, origin, direction, limit)));
        meetings.sort_by(|a: &Meeting<'_>, b| b.distance.total_cmp(&a.distance));
        let mut cells = ray.map(|ray| Cells::new(grid, ray));
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
            Next::From(ray) => Some(Ray { direction: in_grid, ..ray }),
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
