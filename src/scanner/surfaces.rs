//! Readings that depend on the surface that each beam meets.

use glam::DVec2;

use super::footprint::{ScanFootprints, turned};
use super::hits::hit_obstacle;
use super::onward::{draws, path_in_world, path_passing};
use super::places::{NOWHERE, Places, rays_from};
use crate::beam_model::{HitColumns, Sampler};
use crate::grid::OccupancyGrid;
use crate::motion::PoseColumns;
use crate::numeric::sincos::Last;
use crate::numeric::{GROUP, Group};
use crate::obstacles::Passing;
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Beam, Path, Sink, Sweep, cell_hit, hit_of, store};
use crate::surface::{Material, SurfaceModel};
use crate::wall_directions::{Tangent, WallDirections};
use crate::world::World;

/// Number of the first obstacle among the things that a beam can meet; cells come before.
const FIRST_OBSTACLE: u64 = 1 << 31;

/// Bits of the number of a beam in the name of a fixed random number.
const BEAM_BITS: u32 = 20;

/// Distinguishes the random numbers that say which beams have no return from the others. Beams have smaller numbers.
const NO_RETURNS: u64 = 1 << 41;

/// Scale of the highest 53 bits of a word, as a number in \[0, 1).
const PER_BITS: f64 = 1.0 / (1_u64 << 53) as f64;

/// The beams of one scan.
pub trait Scene {
    /// Returns x and y of the origins of a group of beams \[cells\], and of their directions, in the frame of the grid.
    fn rays(&self, group: usize, directions: (&Group, &Group)) -> [Group; 4];

    /// Returns the obstacle that a beam enters nearer than `limit` \[m\], and the product of the beam's direction and its normal;
    /// no product if the beam starts inside.
    fn obstacle(&self, beam: usize, in_fan: DVec2, limit: f64) -> Option<(usize, Option<f64>)>;

    /// Returns the material of an obstacle.
    fn material(&self, obstacle: usize) -> Material;

    /// Follows a beam, in a direction in the frame from which the beams spread; `None` if it has no return. `draw` is for panes.
    fn path(&self, beam: usize, in_fan: DVec2, max_range: f64, draw: impl FnMut() -> f64) -> Option<Path>;
}

/// What the beams of a group meet.
struct Met {
    /// Cosines of the incidences.
    cosines: Group,
    /// Numbers of the cells and obstacles, if errors are fixed for each of them.
    numbers: [u64; GROUP],
    /// Shares of the light that the surfaces return at a right angle.
    shares: Group,
}

/// Where a beam ends that meets glass or a mirror first.
pub struct End {
    slot: usize,
    cosine: f64,
    number: u64,
    share: f64,
}

impl End {
    fn new(grid: &OccupancyGrid, walls: &WallDirections, slot: usize, path: &Path) -> Self {
        let place = path.cell.map(|cell| cell.row * grid.width() + cell.col);
        let direction = grid.direction_in_grid(path.direction);
        let of_wall = place.and_then(|place| walls.tangent(place)).map(|tangent| direction.perp_dot(tangent).abs());
        let cosine = of_wall.unwrap_or(if path.cosine.is_nan() { 1.0 } else { path.cosine });
        let number = place.map_or(FIRST_OBSTACLE, |place| place as u64);
        Self { slot, cosine, number, share: path.share() }
    }
}

/// A scan that is taken in one instant.
pub struct Still<'a> {
    pub world: World<'a>,
    pub map_from_fan: Pose,
    /// Origin of the beams \[cells\], and cosine and sine of their heading.
    pub origin: DVec2,
    pub heading: DVec2,
}

impl<'a> Still<'a> {
    pub fn new(world: World<'a>, map_from_fan: Pose) -> Self {
        let Pose { position, yaw } = world.grid.pose_in_grid(map_from_fan);
        let (sin, cos) = libm::sincos(yaw);
        Self { world, map_from_fan, origin: world.grid.in_cells(position), heading: DVec2::new(cos, sin) }
    }
}

impl Scene for Still<'_> {
    #[inline(always)]
    fn rays(&self, _: usize, (cos, sin): (&Group, &Group)) -> [Group; 4] {
        let [mut dx, mut dy] = [[0.0; GROUP]; 2];
        for slot in 0..GROUP {
            (dx[slot], dy[slot]) = self.heading.rotate(DVec2::new(cos[slot], sin[slot])).into();
        }
        [[self.origin.x; GROUP], [self.origin.y; GROUP], dx, dy]
    }

    fn obstacle(&self, _: usize, in_fan: DVec2, limit: f64) -> Option<(usize, Option<f64>)> {
        let (sin, cos) = libm::sincos(self.map_from_fan.yaw);
        let direction = DVec2::new(cos, sin).rotate(in_fan);
        let obstacles = (self.world.obstacles, self.world.except);
        hit_obstacle(obstacles, self.map_from_fan.position, direction, limit).map(|(index, _, product)| (index, product))
    }

    fn material(&self, obstacle: usize) -> Material {
        *self.world.obstacles.bodies()[obstacle].material()
    }

    fn path(&self, _: usize, in_fan: DVec2, max_range: f64, draw: impl FnMut() -> f64) -> Option<Path> {
        path_in_world(self.world, Beam::new(self.world.grid, self.map_from_fan, in_fan), max_range, draw)
    }
}

/// A scan that takes time.
pub struct Moving<'a> {
    pub grid: &'a OccupancyGrid,
    pub sweep: Sweep<'a>,
    pub passing: &'a Passing<'a>,
}

impl Scene for Moving<'_> {
    #[inline(always)]
    fn rays(&self, group: usize, (beam_cos, beam_sin): (&Group, &Group)) -> [Group; 4] {
        let mut poses = PoseColumns::ORIGIN;
        self.sweep.write_poses(group, &mut poses, &mut [Last::default(); 2]);
        rays_from(self.grid, &poses, (beam_cos, beam_sin))
    }

    fn obstacle(&self, beam: usize, in_fan: DVec2, limit: f64) -> Option<(usize, Option<f64>)> {
        let Pose { position, yaw } = self.map_from_fan(beam);
        let (sin, cos) = libm::sincos(yaw);
        self.passing.hit(beam, position, DVec2::new(cos, sin).rotate(in_fan), limit)
    }

    fn material(&self, obstacle: usize) -> Material {
        self.passing.material(obstacle)
    }

    fn path(&self, beam: usize, in_fan: DVec2, max_range: f64, draw: impl FnMut() -> f64) -> Option<Path> {
        let (place, followed) = ((beam / GROUP, beam % GROUP), Beam::new(self.grid, self.map_from_fan(beam), in_fan));
        path_passing(self.grid, self.passing, place, followed, max_range, draw)
    }
}

impl Moving<'_> {
    /// Returns where a beam starts.
    fn map_from_fan(&self, beam: usize) -> Pose {
        let mut poses = PoseColumns::ORIGIN;
        self.sweep.write_poses(beam / GROUP, &mut poses, &mut [Last::default(); 2]);
        let slot = beam % GROUP;
        Pose::new(poses.x[slot], poses.y[slot], poses.yaw[slot])
    }
}

/// Draws a reading for each range from a beam model, as the surface that the beam meets changes it, and stores it.
pub struct Surfaced<'a, S> {
    pub scene: S,
    pub grid: &'a OccupancyGrid,
    pub walls: &'a WallDirections,
    pub surface: &'a SurfaceModel,
    /// Footprints of the beams; `None` if they have no width.
    pub footprints: Option<ScanFootprints<'a>>,
    pub sampler: Sampler<'a>,
    /// Bits of the fixed random numbers.
    pub fixed: BeamBits,
    pub max_range: f64,
    pub cos: &'a [Group],
    pub sin: &'a [Group],
    /// Where beams of the next group end that meet glass or a mirror first.
    pub ends: Vec<End>,
    pub readings: &'a mut [f32],
}

impl<S: Scene> Surfaced<'_, S> {
    /// Returns what each beam of a group meets.
    #[inline(always)]
    fn meet(&mut self, group: usize, ranges: &Group) -> Met {
        let [x, y, dx, dy] = self.scene.rays(group, (&self.cos[group], &self.sin[group]));
        let Places { cells: places, mut is_other, at_column, .. } = Places::new(self.grid, &[x, y, dx, dy], ranges);
        let mut cosines = [0.0; GROUP];
        for slot in 0..GROUP {
            let cos = if at_column[slot] != 0 { dx[slot] } else { dy[slot] }.abs();
            let is_hit = (ranges[slot] > 0.0) & (ranges[slot] < f64::INFINITY);
            cosines[slot] = if is_hit { cos } else { 1.0 };
        }
        let (mut numbers, mut shares) = ([0; GROUP], [Material::WALL.reflectivity; GROUP]);
        let mut tangents = [Tangent::default(); GROUP];
        for slot in 0..GROUP {
            tangents[slot] = self.walls.tangent_at(places[slot] as usize);
        }
        for slot in 0..GROUP {
            let (tx, ty) = (tangents[slot].x(), tangents[slot].y());
            let is_known = (tx != 0.0) | (ty != 0.0);
            let of_wall = (dx[slot] * ty - dy[slot] * tx).abs();
            cosines[slot] = if is_known { of_wall } else { cosines[slot] };
            is_other[slot] |= u32::from(tx.is_nan());
        }
        if self.surface.options().correlation > 0.0 {
            for slot in 0..GROUP {
                numbers[slot] = if places[slot] == NOWHERE { 0 } else { u64::from(places[slot]) };
            }
        }
        if let Some(materials) = self.grid.materials().filter(|_| self.surface.loses_beams()) {
            for slot in (0..GROUP).filter(|&slot| places[slot] != NOWHERE) {
                shares[slot] = materials.of(places[slot] as usize).reflectivity;
            }
        }
        for end in self.ends.drain(..) {
            (cosines[end.slot], numbers[end.slot], shares[end.slot]) = (end.cosine, end.number, end.share);
            is_other[end.slot] = 0;
        }
        // Behind the last beam of a scan, the ranges of a group are those of other beams.
        let count = self.readings.len() - group * GROUP;
        is_other.iter_mut().skip(count).for_each(|other| *other = 0);
        if is_other.iter().fold(0, |any, other| any | other) != 0 {
            for slot in (0..GROUP).filter(|&slot| is_other[slot] != 0) {
                let ray = (DVec2::new(x[slot], y[slot]), DVec2::new(dx[slot], dy[slot]));
                (cosines[slot], numbers[slot], shares[slot]) = self.meet_other(group * GROUP + slot, ray, ranges[slot]);
            }
        }
        Met { cosines, numbers, shares }
    }

    /// Returns the ranges of a group of beams, of which some are at edges.
    #[inline(always)]
    fn split(&mut self, footprints: ScanFootprints<'_>, group: usize, ranges: &Group) -> Group {
        let Self { scene, grid, walls, sampler, max_range, cos, sin, ends, readings, .. } = self;
        let bits = sampler.bits();
        let path = |slot: usize, angle: f64| {
            let (beam, in_fan) = (group * GROUP + slot, DVec2::new(cos[group][slot], sin[group][slot]));
            scene.path(beam, turned(in_fan, angle), *max_range, draws(Some(bits), beam))
        };
        let count = readings.len() - group * GROUP;
        footprints.split((group, count), ranges, bits, path, |slot, path| ends.push(End::new(grid, walls, slot, path)))
    }

    /// Returns the ranges of a group, infinite for beams that have no return because their light is too weak.
    #[inline(always)]
    fn with_losses(&self, group: usize, ranges: &Group, met: &Met) -> Group {
        let bits = self.sampler.bits();
        std::array::from_fn(|slot| {
            let draw = (bits.of((group * GROUP + slot) as u64 | NO_RETURNS) >> 11) as f64 * PER_BITS;
            let is_lost = self.surface.loses(ranges[slot], met.cosines[slot], met.shares[slot], draw);
            if is_lost { f64::INFINITY } else { ranges[slot] }
        })
    }

    /// The same for a beam that does not end on the side of a blocking cell: it meets an obstacle or the corner of a cell.
    #[inline(never)]
    fn meet_other(&self, beam: usize, (origin, direction): (DVec2, DVec2), range: f64) -> (f64, u64, f64) {
        let in_fan = DVec2::new(self.cos[beam / GROUP][beam % GROUP], self.sin[beam / GROUP][beam % GROUP]);
        // The range is a little more than the one at which the obstacle was found, at most.
        if let Some((index, product)) = self.scene.obstacle(beam, in_fan, range * (1.0 + 1e-9) + 1e-9) {
            let cosine = product.map_or(1.0, |product| product.abs().min(1.0));
            return (cosine, FIRST_OBSTACLE + index as u64, self.scene.material(index).reflectivity);
        }
        let origin = origin * self.grid.resolution();
        let (_, normal) = hit_of(self.grid, origin, direction);
        let cell = cell_hit(self.grid, origin, direction);
        let material = cell.map_or(&Material::WALL, |cell| self.grid.material(cell));
        (normal.map_or(1.0, f64::abs), 0, material.reflectivity)
    }
}

impl<S: Scene> Sink for Surfaced<'_, S> {
    fn bits(&self) -> Option<BeamBits> {
        Some(self.sampler.bits())
    }

    fn end_at(&mut self, slot: usize, path: &Path) {
        self.ends.push(End::new(self.grid, self.walls, slot, path));
    }

    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        let split = self.footprints.map(|footprints| self.split(footprints, group, ranges));
        let ranges = split.as_ref().unwrap_or(ranges);
        let met = self.meet(group, ranges);
        let losses = self.surface.loses_beams().then(|| self.with_losses(group, ranges, &met));
        let ranges = losses.as_ref().unwrap_or(ranges);
        let Met { cosines, numbers, .. } = &met;
        let hits = HitColumns {
            cosines,
            weights: self.surface.weights(),
            // Names of the fixed numbers.
            fixed: (self.surface.options().correlation > 0.0).then(|| {
                let beam = |slot: usize| (group * GROUP + slot) as u64;
                std::array::from_fn(|slot| self.fixed.of(numbers[slot] << BEAM_BITS | beam(slot)))
            }),
        };
        let readings = if self.surface.changes_by_incidence() {
            self.sampler.sample_hits(group, ranges, &hits, |part, cos, max| self.surface.hit_part(part, cos, max))
        } else {
            self.sampler.sample_hits(group, ranges, &hits, |part, _, _| part)
        };
        store(self.readings, group, &readings);
    }
}
