//! Onward: the beams of a scan that meet glass or a mirror first, and go on from there.

use glam::DVec2;
use rand::RngExt;

use crate::grid::OccupancyGrid;
use crate::motion::PoseColumns;
use crate::numeric::{GROUP, Group};
use crate::obstacles::{Obstacles, Passing};
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Beam, Path, Sink, follow};
use crate::surface::Materials;
use crate::world::World;

/// Distance \[cells\] by which a point on the side of a cell is moved into the cell; far more than its rounding error.
const NUDGE: f64 = 1e-6;

/// Distinguishes the random numbers of panes from those of the noise. Beams have smaller numbers.
const PANES: u64 = 1 << 40;

/// The glass and the mirrors that the beams of a scan can meet.
pub struct Onward<'a> {
    grid: &'a OccupancyGrid,
    materials: Option<&'a Materials>,
    max_range: f64,
    scene: Scene<'a>,
    takes_intensities: bool,
}

/// Position \[cells\] from which beams spread in the frame of the grid, and the unit vector along its x axis.
#[derive(Clone, Copy)]
struct Start {
    origin: DVec2,
    heading: DVec2,
}

impl Start {
    fn new(grid: &OccupancyGrid, map_from_fan: Pose) -> Self {
        let grid_from_fan = grid.pose_in_grid(map_from_fan);
        let (sin, cos) = libm::sincos(grid_from_fan.yaw);
        Self { origin: grid.in_cells(grid_from_fan.position), heading: DVec2::new(cos, sin) }
    }
}

/// Where the beams of a scan start, and the obstacles.
enum Scene<'a> {
    /// All beams are taken in one instant.
    Instant { map_from_fan: Pose, start: Start, obstacles: &'a Obstacles, except: Option<usize> },
    /// Each beam is taken at its own time.
    Passing { map_from_fan: &'a [PoseColumns], passing: &'a Passing<'a> },
}

impl<'a> Onward<'a> {
    /// Returns the glass and the mirrors of a world, for a scan in one instant that goes to a sink `S`; `None` if there are none,
    /// and the sink takes ranges.
    pub fn in_world<S: Sink>(
        World { grid, obstacles, except }: World<'a>,
        map_from_fan: Pose,
        max_range: f64,
    ) -> Option<Self> {
        let materials = grid.materials().map(|layer| &**layer).filter(|layer| layer.has_ways_on());
        let takes_intensities = S::TAKES_INTENSITIES;
        let is_needed = takes_intensities || materials.is_some() || obstacles.lead_on();
        is_needed.then(|| {
            let start = Start::new(grid, map_from_fan);
            Self {
                grid,
                materials,
                max_range,
                scene: Scene::Instant { map_from_fan, start, obstacles, except },
                takes_intensities,
            }
        })
    }

    /// Returns the same for a scan that takes time.
    pub fn passing_by<S: Sink>(
        grid: &'a OccupancyGrid,
        passing: &'a Passing<'a>,
        map_from_fan: &'a [PoseColumns],
        max_range: f64,
    ) -> Option<Self> {
        let materials = grid.materials().map(|layer| &**layer).filter(|layer| layer.has_ways_on());
        let takes_intensities = S::TAKES_INTENSITIES;
        let is_needed = takes_intensities || materials.is_some() || passing.lead_on();
        is_needed.then_some(Self {
            grid,
            materials,
            max_range,
            scene: Scene::Passing { map_from_fan, passing },
            takes_intensities,
        })
    }

    /// Replaces the range \[m\] of each beam of a group that meets glass or a mirror first by the length of its path; or each
    /// range by the intensity, if the sink takes these.
    ///
    /// `to_walls` are the ranges without obstacles, and `bits` the random bits of the scan. `end_at` gets the slot of each beam that
    /// is followed to a surface, and its path.
    #[inline(never)]
    pub fn follow(
        &self,
        group: usize,
        (cos, sin): (&Group, &Group),
        to_walls: &Group,
        ranges: &mut Group,
        bits: Option<BeamBits>,
        end_at: &mut dyn FnMut(usize, &Path),
    ) {
        for (slot, range) in ranges.iter_mut().enumerate() {
            // A range of 0 is that of a laser inside something.
            if *range <= 0.0 || *range >= self.max_range {
                *range = if self.takes_intensities { 0.0 } else { *range };
                continue;
            }
            let beam = Beam { map_from_fan: self.map_from_fan(group, slot), direction: DVec2::new(cos[slot], sin[slot]) };
            let path = || self.path(beam, group, slot, bits);
            if self.takes_intensities {
                *range = path().map_or(0.0, |path| path.intensity());
                continue;
            }
            let is_wall = *range == to_walls[slot];
            if if is_wall { self.may_lead_on(beam, *range) } else { self.obstacles_lead_on() } {
                *range = path().map_or(f64::INFINITY, |path| {
                    end_at(slot, &path);
                    path.length
                });
            }
        }
    }

    fn map_from_fan(&self, group: usize, slot: usize) -> Pose {
        match &self.scene {
            Scene::Instant { map_from_fan, .. } => *map_from_fan,
            Scene::Passing { map_from_fan, .. } => {
                let columns = &map_from_fan[group];
                Pose::new(columns.x[slot], columns.y[slot], columns.yaw[slot])
            }
        }
    }

    /// Returns true if the cell at the end of a beam may be of glass or a mirror.
    fn may_lead_on(&self, beam: Beam, range: f64) -> bool {
        let Some(materials) = self.materials else { return false };
        let start = match &self.scene {
            Scene::Instant { start, .. } => *start,
            Scene::Passing { .. } => Start::new(self.grid, beam.map_from_fan),
        };
        let direction = start.heading.rotate(beam.direction);
        let end = start.origin + direction * (range / self.grid.resolution());
        let is_near_corner = (end - end.round()).abs().max_element() < NUDGE;
        // Near a corner, the nudge could lead into a cell that the beam does not enter.
        is_near_corner
            || self.grid.cell_around(end + direction * NUDGE).is_none_or(|cell| {
                let index = cell.row * self.grid.width() + cell.col;
                materials.leads_on(index) || !self.grid.is_blocking(cell)
            })
    }

    fn obstacles_lead_on(&self) -> bool {
        match &self.scene {
            Scene::Instant { obstacles, .. } => obstacles.lead_on(),
            Scene::Passing { passing, .. } => passing.lead_on(),
        }
    }

    /// Returns the path of a beam; `None` if it has no return.
    fn path(&self, beam: Beam, group: usize, slot: usize, bits: Option<BeamBits>) -> Option<Path> {
        let draw = draws(bits, group * GROUP + slot);
        match &self.scene {
            Scene::Instant { obstacles, except, .. } => {
                let world = World { grid: self.grid, obstacles, except: *except };
                path_in_world(world, beam, self.max_range, draw)
            }
            Scene::Passing { passing, .. } => path_passing(self.grid, passing, (group, slot), beam, self.max_range, draw),
        }
    }
}

/// Returns what draws for each pane on the way of a beam. Without noise, it draws a half: the beam takes the likelier way.
pub fn draws(bits: Option<BeamBits>, beam: usize) -> impl FnMut() -> f64 {
    let mut stream = bits.map(|bits| bits.stream(beam as u64 | PANES));
    move || stream.as_mut().map_or(0.5, RngExt::random::<f64>)
}

/// Returns the path of a beam of a scan in one instant; `None` if it has no return.
pub fn path_in_world(
    World { grid, obstacles, except }: World<'_>,
    beam: Beam,
    max_range: f64,
    draw: impl FnMut() -> f64,
) -> Option<Path> {
    let bodies = obstacles.bodies().iter().enumerate().filter(|(index, _)| Some(*index) != except);
    follow(grid, &bodies.map(|(_, body)| body), beam, max_range, draw)
}

/// Returns the path of a beam of a scan that takes time, given by its group and slot; `None` if it has no return.
pub fn path_passing(
    grid: &OccupancyGrid,
    passing: &Passing<'_>,
    (group, slot): (usize, usize),
    beam: Beam,
    max_range: f64,
    draw: impl FnMut() -> f64,
) -> Option<Path> {
    let bodies = passing.bodies(group, slot);
    follow(grid, &bodies.iter(), beam, max_range, draw)
}
