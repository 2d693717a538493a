//! Occupancy grids, and all conversions between the map frame, the frame of a grid and cells.

mod distances;
mod free_poses;
mod walls;

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use crate::distance_field::KeptField;
use crate::error::{Error, check_finite, check_number};
use crate::free_area::FreeAreas;
use crate::free_boxes::{FreeBoxes, Room};
use crate::interrupt::is_pool_thread;
use crate::lazy::Lazy;
use crate::memory;
use crate::pose::Pose;
use crate::surface::{Material, Materials};
use crate::wall_directions::WallDirections;

/// How unknown cells act on beams and robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unknown {
    /// Free: beams and robots pass.
    #[default]
    Free,
    /// Occupied: beams and robots are blocked.
    Occupied,
}

/// Column and row of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// Column, along the x axis of the grid; 0 at the origin.
    pub col: usize,
    /// Row, along the y axis of the grid; 0 at the origin.
    pub row: usize,
}

/// Parameters of an [`OccupancyGrid`]: everything except its cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridOptions {
    /// Side of a cell \[m\].
    pub resolution: f64,
    /// Pose of the lower-left corner of cell (0, 0) in the map frame, yaw included.
    pub origin: Pose,
    /// Smallest value of a cell that blocks beams and robots, 1 to 100.
    pub occupied_threshold: i8,
    /// Whether unknown cells are free or occupied.
    pub unknown: Unknown,
}

/// A map of square cells, each with an occupancy, like `nav_msgs/OccupancyGrid`.
///
/// The origin is the pose of the grid's frame in the map frame. The frame of the grid has its x axis along the columns and
/// its y axis along the rows, in metres; "cells from the corner" are the same coordinates in cells.
///
/// ```text
///        +---+---+---+
///  row 1 |   |   |   |     The marked cell has column 2 and row 0. With a resolution of 0.5 m, its lower-left corner is
///        +---+---+---+     at (2, 0) cells from the corner and at (1, 0) m in the frame of the grid; if the yaw of the
///  row 0 |   |   | # |     origin is 0, it is at origin + (1, 0) m in the map frame.
///        o---+---+---+
///      origin  1   2  column
/// ```
///
/// ```
/// use glam::DVec2;
/// use mobile_robot_simulator::{Cell, GridOptions, OccupancyGrid, Pose, Unknown};
///
/// // Two rows of three cells of 0.5 m, the lower row first; the lower-left corner is at (1, 2).
/// let cells = vec![
///     0, 0, 100, // row 0
///     0, 0, -1, // row 1
/// ];
/// let origin = Pose::new(1.0, 2.0, 0.0);
/// let options = GridOptions { resolution: 0.5, origin, occupied_threshold: 60, unknown: Unknown::Free };
/// let grid = OccupancyGrid::new(cells, 3, options)?;
///
/// assert_eq!(grid.cell_at(DVec2::new(2.1, 2.4)), Some(Cell { col: 2, row: 0 }));
/// assert_eq!(grid.cell_at(DVec2::new(0.9, 2.4)), None);
/// assert_eq!(grid.checked_center(Cell { col: 2, row: 0 })?, DVec2::new(2.25, 2.25));
/// assert!(grid.is_blocking(Cell { col: 2, row: 0 }));
/// assert!(!grid.is_blocking(Cell { col: 2, row: 1 }));
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug)]
pub struct OccupancyGrid {
    cells: Vec<i8>,
    width: usize,
    height: usize,
    options: GridOptions,
    /// Cosine and sine of the rotation from the map frame to the frame of the grid.
    grid_from_map: DVec2,
    free_boxes: Lazy<FreeBoxes>,
    free_areas: FreeAreas,
    kept_field: KeptField,
    wall_directions: Lazy<WallDirections>,
    materials: Option<Arc<Materials>>,
    revision: u64,
}

/// Usual value of [`GridOptions::occupied_threshold`].
pub const OCCUPIED_THRESHOLD: i8 = 60;

/// Largest number of columns and of rows.
///
/// Up to this size, the float64 coordinate at which a ray crosses a grid line is off by less than 1e-10 cells. The kernels
/// rely on this bound.
pub const MAX_SIDE: usize = 65_535;

/// Largest number of cells. With a border around the grid their number still fits in 31 bits.
pub const MAX_CELLS: usize = 2_000_000_000;

impl OccupancyGrid {
    /// Returns the grid with these cells, row by row from row 0 on, with `width` cells in each row.
    ///
    /// # Errors
    /// - [`Error::Count`]: no cells, or more than [`MAX_CELLS`], or a side longer than [`MAX_SIDE`].
    /// - [`Error::Length`]: the number of cells is not a multiple of `width`.
    /// - [`Error::Cell`]: a value outside -1 to 100.
    /// - [`Error::Number`]: a resolution that is not positive, an origin that is not finite, or a threshold outside 1 to
    ///   100.
    pub fn new(cells: Vec<i8>, width: usize, options: GridOptions) -> Result<Self, Error> {
        check_counts(cells.len(), width)?;
        let height = cells.len() / width;
        if height * width != cells.len() {
            return Err(Error::Length { name: "cells", value: cells.len(), needed: (height + 1) * width });
        }
        if width.max(height) > MAX_SIDE {
            return Err(Error::Count {
                name: "a side of the grid",
                value: width.max(height),
                needed: "at most 65535 cells",
            });
        }
        if cells.len() > MAX_CELLS {
            return Err(Error::Count { name: "the number of cells", value: cells.len(), needed: "at most 2000000000" });
        }
        check_cells(&cells, width)?;
        check_number("resolution", options.resolution, "positive", |value| value > 0.0)?;
        check_number("occupied_threshold", options.occupied_threshold.into(), "in 1..100", |value| {
            (1.0..=100.0).contains(&value)
        })?;
        let origin = options.origin.to_array();
        check_finite("origin x", origin[0])?;
        check_finite("origin y", origin[1])?;
        check_finite("origin yaw", origin[2])?;
        let (sin, cos) = libm::sincos(-options.origin.yaw);
        Ok(Self {
            cells,
            width,
            height,
            options,
            grid_from_map: DVec2::new(cos, sin),
            free_boxes: Lazy::new(),
            free_areas: FreeAreas::default(),
            kept_field: KeptField::default(),
            wall_directions: Lazy::new(),
            materials: None,
            revision: 0,
        })
    }

    /// Returns the grid with these materials of its cells; `None` stands for walls of one material.
    ///
    /// # Errors
    /// [`Error::Layer`]: the layer has another shape than the cells.
    pub fn with_materials(self, materials: Option<Arc<Materials>>) -> Result<Self, Error> {
        if let Some(layer) = &materials {
            let shape = (layer.numbers().len() / layer.width(), layer.width());
            if shape != (self.height, self.width) {
                return Err(Error::Layer { layer: shape, grid: (self.height, self.width) });
            }
        }
        Ok(Self { materials, ..self })
    }

    /// Returns the materials of the cells; `None` if all are [`Material::WALL`].
    #[must_use]
    pub fn materials(&self) -> Option<&Arc<Materials>> {
        self.materials.as_ref()
    }

    /// Returns the material of a cell.
    ///
    /// # Panics
    /// If the cell is not on the grid.
    #[must_use]
    pub fn material(&self, cell: Cell) -> &Material {
        self.materials.as_ref().map_or(&Material::WALL, |layer| layer.of(cell.row * self.width + cell.col))
    }

    /// Returns how many times [`set_cells`](Self::set_cells) has changed the grid.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Returns the values of the cells, row by row from row 0 on.
    #[must_use]
    pub fn cells(&self) -> &[i8] {
        &self.cells
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the parameters.
    #[must_use]
    pub fn options(&self) -> GridOptions {
        self.options
    }

    /// Returns the side of a cell \[m\].
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.options.resolution
    }

    /// Builds the free boxes on `threads` threads (default: all cores), if they are not built yet.
    ///
    /// All kernels except the plain traversal need them. Without this call, the first cast builds them. They take 8 bytes
    /// per cell.
    ///
    /// # Errors
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn prepare(&self, threads: Option<usize>) -> Result<(), Error> {
        self.free_boxes_by(threads).map(|_| ())
    }

    /// Returns a copy of the grid with all that was built for it.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn try_clone(&self) -> Result<Self, Error> {
        let free_boxes = match self.free_boxes.get() {
            Some(built) => Lazy::from(built.try_clone()?),
            None => Lazy::new(),
        };
        let wall_directions = match self.wall_directions.get() {
            Some(built) => Lazy::from(built.try_clone()?),
            None => Lazy::new(),
        };
        let cells = memory::collected("the cells of the grid", self.cells.iter().copied())?;
        let (free_areas, kept_field) = (self.free_areas.clone(), self.kept_field.clone());
        let materials = self.materials.clone();
        Ok(Self { cells, free_boxes, free_areas, kept_field, wall_directions, materials, ..*self })
    }

    /// Returns the free boxes of the cells if they are built.
    pub(crate) fn built_free_boxes(&self) -> Option<&FreeBoxes> {
        self.free_boxes.get()
    }

    /// Returns the free boxes of the cells; the first call builds them on all cores.
    ///
    /// # Panics
    /// If there is not enough memory to build them. After [`prepare`](Self::prepare) they are there.
    pub(crate) fn free_boxes(&self) -> &FreeBoxes {
        self.free_boxes_by(None).expect("enough memory")
    }

    fn free_boxes_by(&self, threads: Option<usize>) -> Result<&FreeBoxes, Error> {
        // A pool thread must not wait for other threads here. While it waits, it could start a task that needs these free
        // boxes: a deadlock.
        let threads = || if is_pool_thread() { Some(1) } else { threads };
        let blocks = |&value: &i8| self.options.blocks(value);
        self.free_boxes.get_or_build(|| {
            let room = Room::new(self.cells.len(), self.width)?;
            FreeBoxes::new(room, &self.cells, threads(), blocks)
        })
    }

    /// Returns true if the free boxes exist.
    #[cfg(test)]
    pub(crate) fn is_prepared(&self) -> bool {
        self.free_boxes.get().is_some()
    }

    /// Sets the cells of a rectangle: `values` row by row, `width` values in each row, from the cell `corner` on.
    ///
    /// Free boxes and wall directions that exist are updated, at a cost that grows with the rectangle, not with the grid.
    ///
    /// # Errors
    /// The grid is unchanged after an error.
    ///
    /// - [`Error::Count`]: there are no values, or `width` is 0.
    /// - [`Error::Length`]: the number of values is not a multiple of `width`.
    /// - [`Error::Block`]: the rectangle is not on the grid.
    /// - [`Error::Cell`]: a value outside -1 to 100.
    pub fn set_cells(&mut self, corner: Cell, width: usize, values: &[i8]) -> Result<(), Error> {
        check_counts(values.len(), width)?;
        let height = values.len().div_ceil(width);
        if height * width != values.len() {
            return Err(Error::Length { name: "cells", value: values.len(), needed: height * width });
        }
        let last = (corner.row.saturating_add(height - 1), corner.col.saturating_add(width - 1));
        if last.0 >= self.height || last.1 >= self.width {
            let (block, grid) = ((height, width), (self.height, self.width));
            return Err(Error::Block { block, corner: (corner.row, corner.col), grid });
        }
        check_cells(values, width)?;
        for (row, values) in values.chunks_exact(width).enumerate() {
            self.cells[(corner.row + row) * self.width + corner.col..][..width].copy_from_slice(values);
        }
        self.revision += 1;
        self.free_areas = FreeAreas::default();
        self.kept_field = KeptField::default();
        let region = (corner.col..corner.col + width, corner.row..corner.row + height);
        if let Some(walls) = self.wall_directions.get_mut() {
            walls.update(&self.cells, region.clone(), |&value| self.options.blocks(value));
        }
        if let Some(free_boxes) = self.free_boxes.get_mut()
            && free_boxes.update(&self.cells, region, |&value| self.options.blocks(value)).is_err()
        {
            // There is not enough memory to update them. The next cast builds them again.
            self.free_boxes = Lazy::new();
        }
        Ok(())
    }

    /// Returns the pose in the frame of the grid \[m\] of a pose in the map frame.
    #[must_use]
    pub fn pose_in_grid(&self, pose: Pose) -> Pose {
        let origin = self.options.origin;
        Pose { position: self.grid_from_map.rotate(pose.position - origin.position), yaw: pose.yaw - origin.yaw }
    }

    /// Returns a direction of the map frame in the frame of the grid.
    pub(crate) fn direction_in_grid(&self, direction: DVec2) -> DVec2 {
        self.grid_from_map.rotate(direction)
    }

    /// Returns a direction of the frame of the grid in the map frame.
    pub(crate) fn direction_in_map(&self, direction: DVec2) -> DVec2 {
        DVec2::new(self.grid_from_map.x, -self.grid_from_map.y).rotate(direction)
    }

    /// Converts a point in the frame of the grid, or a pair of lengths, from metres to cells.
    #[inline(always)]
    pub(crate) fn in_cells(&self, point: DVec2) -> DVec2 {
        point / self.options.resolution
    }

    /// Converts a point in the map frame to cells from the corner. The floor of the result is the column and row.
    #[must_use]
    pub fn to_cells(&self, point: DVec2) -> DVec2 {
        self.in_cells(self.pose_in_grid(Pose { position: point, yaw: 0.0 }).position)
    }

    /// Returns the cell that contains a point in the map frame; `None` off the grid.
    #[must_use]
    pub fn cell_at(&self, point: DVec2) -> Option<Cell> {
        self.cell_around(self.to_cells(point))
    }

    /// Returns the cell that contains a point, given in cells from the corner; `None` off the grid.
    #[inline]
    pub(crate) fn cell_around(&self, at: DVec2) -> Option<Cell> {
        let at = at.floor();
        let (col, row) = (index_below(at.x, self.width)?, index_below(at.y, self.height)?);
        Some(Cell { col, row })
    }

    /// Returns the columns and rows of the cells that a rectangle meets; `low` and `high` are in cells from the corner.
    pub(crate) fn cells_between(&self, low: DVec2, high: DVec2) -> (Range<usize>, Range<usize>) {
        (span(low.x, high.x, self.width), span(low.y, high.y, self.height))
    }

    /// Returns the lower-left corner of a cell in the frame of the grid \[m\].
    pub(crate) fn corner(&self, cell: Cell) -> DVec2 {
        cell.corner() * self.resolution()
    }

    /// Returns the centre of a cell in the map frame \[m\].
    ///
    /// # Errors
    /// [`Error::OffGrid`]: the cell is not on the grid.
    pub fn checked_center(&self, cell: Cell) -> Result<DVec2, Error> {
        let (Cell { col, row }, width, height) = (cell, self.width, self.height);
        if col < width && row < height { Ok(self.center(cell)) } else { Err(Error::OffGrid { row, col, height, width }) }
    }

    fn center(&self, cell: Cell) -> DVec2 {
        self.options.origin.transform_point((cell.corner() + 0.5) * self.resolution())
    }

    /// Returns true if a cell blocks beams and robots.
    ///
    /// # Panics
    /// If the cell is not on the grid.
    #[must_use]
    pub fn is_blocking(&self, cell: Cell) -> bool {
        assert!(cell.col < self.width && cell.row < self.height, "{cell:?} is not on the grid");
        self.options.blocks(self.cells[cell.row * self.width + cell.col])
    }

    /// Returns true if no blocking cell overlaps the disc of this centre (in the map frame) and radius \[m\].
    ///
    /// Exact: blocking cells are squares, and a square that only touches the edge of the disc does not overlap it.
    /// Everything off the grid is free. The cost grows with the number of cells around the disc.
    ///
    /// # Errors
    /// [`Error::Number`]: a centre that is not finite, or a radius that is not finite or negative.
    pub fn is_free_disc(&self, center: DVec2, radius: f64) -> Result<bool, Error> {
        check_finite("x", center.x)?;
        check_finite("y", center.y)?;
        check_radius(radius)?;
        Ok(self.is_free(center, radius))
    }

    fn is_free(&self, center: DVec2, radius: f64) -> bool {
        let center = self.to_cells(center);
        let radius = radius / self.resolution();
        if self.block_at(center) {
            return false;
        }
        let (cols, rows) = self.cells_between(center - radius, center + radius);
        rows.flat_map(|row| cols.clone().map(move |col| Cell { col, row })).all(|cell| {
            let nearest = center.clamp(cell.corner(), cell.corner() + 1.0);
            nearest.distance_squared(center) >= radius * radius || !self.is_blocking(cell)
        })
    }

    /// Returns true if a point, given in cells from the corner, lies in a blocking cell.
    pub(crate) fn block_at(&self, at: DVec2) -> bool {
        self.cell_around(at).is_some_and(|cell| self.is_blocking(cell))
    }

    /// Returns true if one of these cells of a row blocks beams and robots.
    pub(crate) fn has_blocking(&self, row: usize, cols: Range<usize>) -> bool {
        // Not `any`, which would look at one cell after the other.
        self.cells[row * self.width..][cols].iter().fold(false, |found, &value| found | self.options.blocks(value))
    }

    /// Writes for each of these cells of a row whether it blocks beams and robots.
    pub(crate) fn copy_blocking(&self, row: usize, cols: Range<usize>, blocks: &mut [bool]) {
        for (blocks, &value) in blocks.iter_mut().zip(&self.cells[row * self.width..][cols]) {
            *blocks = self.options.blocks(value);
        }
    }
}

impl Cell {
    /// Returns the lower-left corner, in cells from the corner of the grid.
    fn corner(self) -> DVec2 {
        DVec2::new(self.col as f64, self.row as f64)
    }
}

impl GridOptions {
    /// Returns true if a cell with this value blocks beams and robots.
    #[must_use]
    pub fn blocks(&self, value: i8) -> bool {
        // No branches, so that loops over cells vectorise.
        (value >= self.occupied_threshold) | ((value < 0) & (self.unknown == Unknown::Occupied))
    }
}

fn check_radius(radius: f64) -> Result<f64, Error> {
    check_number("radius", radius, "at least 0", |value| value >= 0.0)
}

/// Checks that there are cells, and columns.
fn check_counts(cells: usize, width: usize) -> Result<(), Error> {
    for (name, value) in [("the number of cells", cells), ("width", width)] {
        if value == 0 {
            return Err(Error::Count { name, value, needed: "at least 1" });
        }
    }
    Ok(())
}

/// Checks that all values are in -1 to 100. The error names the first one that is not.
fn check_cells(cells: &[i8], width: usize) -> Result<(), Error> {
    match cells.iter().position(|value| !(-1..=100).contains(value)) {
        Some(index) => Err(Error::Cell { row: index / width, col: index % width, value: cells[index] }),
        None => Ok(()),
    }
}

/// Converts a whole number to an index; `None` if it is not in `0..count`.
fn index_below(whole: f64, count: usize) -> Option<usize> {
    (whole >= 0.0 && whole < count as f64).then_some(whole as usize)
}

/// Returns the indices in `0..count` of the unit intervals that meet the interval from `low` to `high`.
fn span(low: f64, high: f64, count: usize) -> Range<usize> {
    // The cast saturates: negative numbers become 0.
    let (first, last) = (low.floor() as usize, high.floor() as usize);
    first.min(count)..if high < 0.0 { 0 } else { last.saturating_add(1).min(count) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const OPTIONS: GridOptions =
        GridOptions { resolution: 0.5, origin: Pose::new(1.0, 2.0, 0.0), occupied_threshold: 60, unknown: Unknown::Free };

    fn grid(cells: &[i8], width: usize, options: GridOptions) -> OccupancyGrid {
        OccupancyGrid::new(cells.to_vec(), width, options).expect("a good grid")
    }

    #[test]
    fn points_are_in_the_cell_that_contains_them() {
        let grid = grid(&[0; 6], 3, OPTIONS);
        let cell = |x, y| grid.cell_at(DVec2::new(x, y)).map(|cell| (cell.col, cell.row));
        assert_eq!(cell(1.0, 2.0), Some((0, 0)));
        assert_eq!(cell(1.49, 2.5), Some((0, 1)));
        assert_eq!(cell(2.49, 2.99), Some((2, 1)));
        for (x, y) in [(0.99, 2.0), (2.5, 2.0), (1.0, 3.0), (f64::NAN, 2.0), (1e300, 2.0)] {
            assert_eq!(cell(x, y), None, "({x}, {y})");
        }
        assert_eq!(grid.checked_center(Cell { col: 2, row: 1 }), Ok(DVec2::new(2.25, 2.75)));
        let error = grid.checked_center(Cell { col: 3, row: 1 }).unwrap_err();
        assert_eq!(error.to_string(), "row and column must be below 2 and 3, got 1 and 3");
    }

    #[test]
    fn the_yaw_of_the_origin_turns_the_grid() {
        let grid = grid(&[0; 6], 3, GridOptions { origin: Pose::new(1.0, 2.0, FRAC_PI_2), ..OPTIONS });
        // The x axis of the grid points along the y axis of the map: three columns up, two rows to the left.
        assert_eq!(grid.cell_at(DVec2::new(0.3, 3.2)), Some(Cell { col: 2, row: 1 }));
        assert!((grid.center(Cell { col: 2, row: 1 }) - DVec2::new(0.25, 3.25)).length() < 1e-15);
    }

    #[test]
    fn the_threshold_and_the_unknown_option_decide_what_blocks() {
        let cells = [-1, 0, 59, 60, 100];
        let blocking = |options| {
            let grid = grid(&cells, 5, options);
            (0..5).map(|col| grid.is_blocking(Cell { col, row: 0 })).collect::<Vec<_>>()
        };
        assert_eq!(blocking(OPTIONS), [false, false, false, true, true]);
        assert_eq!(blocking(GridOptions { unknown: Unknown::Occupied, ..OPTIONS }), [true, false, false, true, true]);
        assert_eq!(blocking(GridOptions { occupied_threshold: 59, ..OPTIONS }), [false, false, true, true, true]);
    }

    #[test]
    fn a_disc_that_touches_a_wall_is_free() {
        let mut cells = [0; 25];
        cells[12] = 100;
        let grid = grid(&cells, 5, GridOptions { resolution: 1.0, origin: Pose::default(), ..OPTIONS });
        let free = |x, y, radius| grid.is_free_disc(DVec2::new(x, y), radius).expect("a disc");
        // The only blocking cell is the square from (2, 2) to (3, 3).
        assert!(free(0.5, 2.5, 1.5) && !free(0.5, 2.5, 1.5 + 1e-9));
        let corner = 0.5 * 2f64.sqrt();
        assert!(free(1.5, 1.5, corner - 1e-9) && !free(1.5, 1.5, corner + 1e-9));
        assert!(!free(2.5, 2.5, 0.0) && free(3.0, 2.5, 0.0) && !free(2.0, 2.5, 0.0));
        assert!(free(-3.0, 2.5, 5.0) && !free(-3.0, 2.5, 5.1));
        assert!(!free(2.5, 100.0, 200.0));
    }

    #[test]
    fn a_drawn_pose_is_free_and_depends_on_the_seed() {
        let mut cells = vec![-1; 900];
        (0..900).filter(|index| index % 30 > 10).for_each(|index| cells[index] = if index % 7 == 0 { 100 } else { 0 });
        let grid = grid(&cells, 30, OPTIONS);
        for seed in 0..50 {
            let pose = grid.draw_free_pose(0.3, seed).expect("a free place");
            let cell = grid.cell_at(pose.position).expect("on the grid");
            assert_eq!(grid.cells()[cell.row * 30 + cell.col], 0);
            assert_eq!(grid.is_free_disc(pose.position, 0.3), Ok(true));
            assert_eq!(grid.draw_free_pose(0.3, seed), Ok(pose));
        }
        assert_ne!(grid.draw_free_pose(0.3, 0), grid.draw_free_pose(0.3, 1));
        let error = grid.draw_free_pose(30.0, 0).unwrap_err();
        let Error::NoFreePlace { largest: Some(largest), .. } = error else { panic!("{error}") };
        assert!(grid.draw_free_pose(largest, 0).is_ok() && grid.draw_free_pose(largest + 0.01, 0).is_err(), "{error}");
    }

    #[test]
    fn the_error_names_the_bad_parameter() {
        let error =
            |cells: &[i8], width, options| OccupancyGrid::new(cells.to_vec(), width, options).unwrap_err().to_string();
        assert_eq!(error(&[], 3, OPTIONS), "the number of cells must be at least 1, got 0");
        assert_eq!(error(&[0; 5], 0, OPTIONS), "width must be at least 1, got 0");
        assert_eq!(error(&[0; 5], 3, OPTIONS), "cells must have 6 elements, got 5");
        assert_eq!(error(&vec![0; 65_536], 65_536, OPTIONS), "a side of the grid must be at most 65535 cells, got 65536");
        assert_eq!(error(&[0, 0, 0, 101], 2, OPTIONS), "cells must be in -1..100, got 101 at row 1, column 1");
        let options = GridOptions { resolution: 0.0, ..OPTIONS };
        assert_eq!(error(&[0], 1, options), "resolution must be positive, got 0");
        let options = GridOptions { occupied_threshold: 0, ..OPTIONS };
        assert_eq!(error(&[0], 1, options), "occupied_threshold must be in 1..100, got 0");
        let options = GridOptions { origin: Pose::new(0.0, 0.0, f64::NAN), ..OPTIONS };
        assert_eq!(error(&[0], 1, options), "origin yaw must be finite, got NaN");
    }

    #[test]
    fn setting_cells_updates_the_free_boxes() {
        let mut grid = grid(&[0; 12], 4, OPTIONS);
        grid.prepare(Some(1)).expect("enough memory");
        assert_eq!(grid.walls(Some(1)).unwrap().steps(), [crate::wall_directions::NO_WALL; 12]);
        grid.set_cells(Cell { col: 1, row: 1 }, 2, &[100, -1, 0, 60]).expect("a rectangle on the grid");
        assert_eq!(grid.cells(), [0, 0, 0, 0, 0, 100, -1, 0, 0, 0, 60, 0]);
        assert_eq!((grid.revision(), grid.try_clone().unwrap().revision()), (1, 1));
        let rebuilt = OccupancyGrid::new(grid.cells().to_vec(), 4, OPTIONS).expect("a good grid");
        assert_eq!(grid.free_boxes().codes(), rebuilt.free_boxes().codes());
        assert_eq!(grid.walls(None).unwrap().steps(), rebuilt.walls(None).unwrap().steps());
        let error = |grid: &mut OccupancyGrid, col, width, values: &[i8]| {
            grid.set_cells(Cell { col, row: 1 }, width, values).unwrap_err().to_string()
        };
        assert_eq!(
            error(&mut grid, 3, 2, &[0, 0]),
            "a block of shape (1, 2) at row 1 and column 3 must fit on the grid of shape (3, 4)"
        );
        assert_eq!(
            error(&mut grid, 0, 1, &[0; 3]),
            "a block of shape (3, 1) at row 1 and column 0 must fit on the grid of shape (3, 4)"
        );
        assert_eq!(error(&mut grid, 0, 2, &[0; 3]), "cells must have 4 elements, got 3");
        assert_eq!(error(&mut grid, 0, 2, &[]), "the number of cells must be at least 1, got 0");
        assert_eq!(error(&mut grid, 0, 0, &[0; 3]), "width must be at least 1, got 0");
        assert_eq!(error(&mut grid, 0, 2, &[0, 101]), "cells must be in -1..100, got 101 at row 0, column 1");
        assert_eq!(grid.cells(), rebuilt.cells());
    }
}
