//! Onward: the beams of a scan that meet glass or a mirror first, and go on from there.

use glam::DVec2;
use rand::RngExt;

use super::places::{NOWHERE, Places, rays_from, turned_by};
use crate::grid::{Cell, OccupancyGrid};
use crate::motion::PoseColumns;
use crate::numeric::{GROUP, Group};
use crate::obstacles::{Obstacles, Passing};
use crate::pose::Pose;
use crate::random::BeamBits;
use crate::raycast::{Beam, Kernel, Path, Sink, Work, follow};
use crate::surface::{Material, Materials};
use crate::world::World;

/// Distinguishes the random numbers of panes from those of the noise. Beams have smaller numbers.
const PANES: u64 = 1 << 40;

/// The glass and the mirrors that the beams of a scan can meet.
pub struct Onward<'a> {
    grid: &'a OccupancyGrid,
    /// Materials of the cells; `None` if none of them is of glass or a mirror.
    materials: Option<&'a Materials>,
    max_range: f64,
    scene: Scene<'a>,
    takes_intensities: bool,
    /// Number of beams of the scan.
    beam_count: usize,
    kernel: Kernel,
}

/// Where beams spread from, and the directions of the frame there.
#[derive(Clone, Copy)]
struct Start {
    /// Position in the map frame \[m\].
    position: DVec2,
    /// Unit vector along the x axis, in the map frame.
    heading: DVec2,
    /// Position in the frame of the grid \[cells\].
    origin: DVec2,
    /// Unit vector along the x axis, in the frame of the grid.
    in_grid: DVec2,
}

impl Start {
    fn new(grid: &OccupancyGrid, map_from_fan: Pose) -> Self {
        let Beam { position, direction, origin, in_grid, .. } = Beam::new(grid, map_from_fan, DVec2::X);
        Self { position, heading: direction, origin, in_grid }
    }

    fn beam(&self, in_fan: DVec2) -> Beam {
        let Self { position, heading, origin, in_grid } = *self;
        let (direction, in_grid) = (heading.rotate(in_fan), in_grid.rotate(in_fan));
        Beam { position, direction, origin, in_grid, first_cell: None }
    }
}

/// The beams of a group that are followed.
struct Choice {
    /// True, as a number, for these beams.
    leads_on: [u32; GROUP],
    /// Index of the first cell that each beam enters; [`NOWHERE`] if it is not known.
    cells: [u32; GROUP],
}

/// The arguments of [`Onward::choose`].
struct Choose<'a> {
    onward: &'a Onward<'a>,
    group: usize,
    directions: (&'a Group, &'a Group),
    to_walls: &'a Group,
    ranges: &'a mut Group,
    choice: &'a mut Choice,
}

impl Work for Choose<'_> {
    #[inline(always)]
    fn run(self) {
        self.onward.choose(self.group, self.directions, self.to_walls, self.ranges, self.choice);
    }
}

/// Where the beams of a scan start, and the obstacles.
enum Scene<'a> {
    /// All beams are taken in one instant.
    Instant { start: Start, obstacles: &'a Obstacles, except: Option<usize> },
    /// Each beam is taken at its own time.
    Passing { map_from_fan: &'a [PoseColumns], passing: &'a Passing<'a> },
}

impl Scene<'_> {
    /// Returns x and y of the origins of a group of beams \[cells\], and of their directions, in the frame of the grid.
    #[inline(always)]
    fn rays(&self, grid: &OccupancyGrid, group: usize, directions: (&Group, &Group)) -> [Group; 4] {
        match self {
            Self::Instant { start, .. } => {
                let [dx, dy] = rotated(start.in_grid, directions);
                [[start.origin.x; GROUP], [start.origin.y; GROUP], dx, dy]
            }
            Self::Passing { map_from_fan, .. } => rays_from(grid, &map_from_fan[group], directions),
        }
    }

    /// Returns x and y of the directions of a group of beams in the map frame.
    #[inline(always)]
    fn directions(&self, group: usize, directions: (&Group, &Group)) -> [Group; 2] {
        match self {
            Self::Instant { start, .. } => rotated(start.heading, directions),
            Self::Passing { map_from_fan, .. } => turned_by(&map_from_fan[group].yaw, directions),
        }
    }
}

/// Returns x and y of directions in a frame with this x axis.
#[inline(always)]
fn rotated(heading: DVec2, (cos, sin): (&Group, &Group)) -> [Group; 2] {
    let [mut dx, mut dy] = [[0.0; GROUP]; 2];
    for slot in 0..GROUP {
        (dx[slot], dy[slot]) = heading.rotate(DVec2::new(cos[slot], sin[slot])).into();
    }
    [dx, dy]
}

impl<'a> Onward<'a> {
    /// Returns the glass and the mirrors of a world, for a scan in one instant that goes to a sink `S`; `None` if there are none,
    /// and the sink takes ranges.
    pub fn in_world<S: Sink>(
        World { grid, obstacles, except }: World<'a>,
        map_from_fan: Pose,
        (beam_count, max_range): (usize, f64),
        kernel: Kernel,
    ) -> Option<Self> {
        let materials = grid.materials().map(|layer| &**layer).filter(|layer| layer.has_ways_on());
        let takes_intensities = S::TAKES_INTENSITIES;
        let is_needed = takes_intensities || materials.is_some() || obstacles.lead_on();
        is_needed.then(|| {
            let scene = Scene::Instant { start: Start::new(grid, map_from_fan), obstacles, except };
            Self { grid, materials, max_range, scene, takes_intensities, beam_count, kernel }
        })
    }

    /// Returns the same for a scan that takes time.
    pub fn passing_by<S: Sink>(
        grid: &'a OccupancyGrid,
        passing: &'a Passing<'a>,
        map_from_fan: &'a [PoseColumns],
        (beam_count, max_range): (usize, f64),
        kernel: Kernel,
    ) -> Option<Self> {
        let materials = grid.materials().map(|layer| &**layer).filter(|layer| layer.has_ways_on());
        let takes_intensities = S::TAKES_INTENSITIES;
        let is_needed = takes_intensities || materials.is_some() || passing.lead_on();
        let scene = Scene::Passing { map_from_fan, passing };
        is_needed.then_some(Self { grid, materials, max_range, scene, takes_intensities, beam_count, kernel })
    }

    /// Replaces the range \[m\] of each beam of a group that meets glass or a mirror first by the length of its path; or each
    /// range by the intensity, if the sink takes these.
    ///
    /// `to_walls` are the ranges without obstacles, and `bits` the random bits of the scan. `end_at` gets the slot of each beam that
    /// is followed to a surface, and its path.
    // Not inlined, to keep the loop over groups of other scans small.
    #[inline(never)]
    pub fn follow(
        &self,
        group: usize,
        directions: (&Group, &Group),
        to_walls: &Group,
        ranges: &mut Group,
        bits: Option<BeamBits>,
        end_at: &mut dyn FnMut(usize, &Path),
    ) {
        let mut choice = Choice { leads_on: [0; GROUP], cells: [NOWHERE; GROUP] };
        self.kernel.with_features(Choose { onward: self, group, directions, to_walls, ranges, choice: &mut choice });
        // Behind the last beam of a scan, the ranges of a group are those of other beams.
        choice.leads_on.iter_mut().skip(self.beam_count - group * GROUP).for_each(|leads| *leads = 0);
        if choice.leads_on.iter().fold(0, |any, leads| any | leads) != 0 {
            self.follow_some(group, directions, &choice, ranges, bits, end_at);
        }
    }

    /// Chooses the beams to follow; replaces the ranges of the others by intensities if the sink takes these.
    #[inline(always)]
    fn choose(
        &self,
        group: usize,
        directions: (&Group, &Group),
        to_walls: &Group,
        ranges: &mut Group,
        Choice { leads_on, cells }: &mut Choice,
    ) {
        let first = *ranges;
        // A range of 0 is that of a laser inside something.
        let has_surface = |slot: usize| (first[slot] > 0.0) & (first[slot] < self.max_range);
        if self.takes_intensities || self.materials.is_some() {
            let rays = self.scene.rays(self.grid, group, directions);
            let places = Places::new(self.grid, &rays, &first);
            if self.takes_intensities {
                *ranges = self.intensities(group, directions, &places, &first);
            }
            let others_lead_on = self.takes_intensities || self.obstacles_lead_on();
            for slot in 0..GROUP {
                let at_wall = first[slot] == to_walls[slot];
                // Near a corner, it could be another cell.
                let is_sure = at_wall & (places.is_corner[slot] == 0);
                cells[slot] = if is_sure { places.cells[slot] } else { NOWHERE };
                let is_unsure = (cells[slot] == NOWHERE) & (at_wall | others_lead_on);
                leads_on[slot] = u32::from(is_unsure & has_surface(slot));
            }
            if let Some(materials) = self.materials {
                for slot in (0..GROUP).filter(|&slot| cells[slot] != NOWHERE) {
                    leads_on[slot] |= u32::from(materials.leads_on(cells[slot] as usize) & has_surface(slot));
                }
            }
        } else {
            for slot in 0..GROUP {
                leads_on[slot] = u32::from(has_surface(slot) & (first[slot] != to_walls[slot]));
            }
        }
        if self.takes_intensities {
            for (slot, intensity) in ranges.iter_mut().enumerate() {
                *intensity = if has_surface(slot) { *intensity } else { 0.0 };
            }
        }
    }

    /// Replaces the numbers of the beams of a group that are to be followed.
    #[inline(never)]
    fn follow_some(
        &self,
        group: usize,
        (cos, sin): (&Group, &Group),
        Choice { leads_on, cells }: &Choice,
        ranges: &mut Group,
        bits: Option<BeamBits>,
        end_at: &mut dyn FnMut(usize, &Path),
    ) {
        for slot in (0..GROUP).filter(|&slot| leads_on[slot] != 0) {
            let (cell, width) = (cells[slot] as usize, self.grid.width());
            let first_cell = (cells[slot] != NOWHERE).then(|| Cell { col: cell % width, row: cell / width });
            // Padding of the last group may end at any cell on its way. Its numbers are dropped.
            let path = self.path((group, slot), DVec2::new(cos[slot], sin[slot]), first_cell, bits);
            ranges[slot] = match &path {
                _ if self.takes_intensities => path.map_or(0.0, |path| path.intensity()),
                Some(path) => {
                    end_at(slot, path);
                    path.length
                }
                None => f64::INFINITY,
            };
        }
    }

    /// Returns the intensities of beams that end at opaque walls, at these places and ranges \[m\]: those of [`Path::intensity`].
    #[inline(always)]
    fn intensities(&self, group: usize, directions: (&Group, &Group), places: &Places, ranges: &Group) -> Group {
        let [dx, dy] = self.scene.directions(group, directions);
        let [of_columns, of_rows] = [DVec2::X, DVec2::Y].map(|normal| self.grid.direction_in_map(normal));
        let mut shares = [Material::WALL.reflectivity; GROUP];
        if let Some(materials) = self.grid.materials() {
            for slot in (0..GROUP).filter(|&slot| places.cells[slot] != NOWHERE) {
                shares[slot] = materials.of(places.cells[slot] as usize).reflectivity;
            }
        }
        let mut intensities = [0.0; GROUP];
        for slot in 0..GROUP {
            let normal = if places.at_column[slot] != 0 { of_columns } else { of_rows };
            let cosine = (normal.x * dx[slot] + normal.y * dy[slot]).abs();
            let cosine = if cosine < 1.0 { cosine } else { 1.0 };
            let intensity = shares[slot] * cosine / (ranges[slot] * ranges[slot]);
            intensities[slot] = if intensity < f64::INFINITY { intensity } else { 0.0 };
        }
        intensities
    }

    fn obstacles_lead_on(&self) -> bool {
        match &self.scene {
            Scene::Instant { obstacles, .. } => obstacles.lead_on(),
            Scene::Passing { passing, .. } => passing.lead_on(),
        }
    }

    /// Returns the path of a beam, given by its group and slot; `None` if it has no return.
    fn path(&self, place: (usize, usize), in_fan: DVec2, first_cell: Option<Cell>, bits: Option<BeamBits>) -> Option<Path> {
        let draw = draws(bits, place.0 * GROUP + place.1);
        match &self.scene {
            Scene::Instant { start, obstacles, except } => {
                let world = World { grid: self.grid, obstacles, except: *except };
                path_in_world(world, Beam { first_cell, ..start.beam(in_fan) }, self.max_range, draw)
            }
            Scene::Passing { passing, map_from_fan } => {
                let columns = &map_from_fan[place.0];
                let map_from_fan = Pose::new(columns.x[place.1], columns.y[place.1], columns.yaw[place.1]);
                let beam = Beam { first_cell, ..Beam::new(self.grid, map_from_fan, in_fan) };
                path_passing(self.grid, passing, place, beam, self.max_range, draw)
            }
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
