//! The Python class `OccupancyGrid`.

use std::ops::Deref;
use std::sync::Arc;

use glam::DVec2;
use numpy::{PyArray2, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyImportError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{check_out, fill, shape, type_name, typed, vector};
use super::material::{Material, layer};
use super::number::Argument;
use super::pose::{Pose, PoseArgument};
use super::random_stream::SeedArgument;
use super::{Recipe, recipe, thread_count, whole_number};
use crate::fork::Lock;
use crate::memory;
use crate::{Cell, GridOptions, Unknown};

/// A map of square cells, each with an occupancy, as in `nav_msgs/OccupancyGrid`.
///
/// Row 0 is at the bottom. A cell contains its lower and left edges. Outside the grid is free. The first scan builds a
/// lookup table of 8 bytes per cell, which the grid keeps; `prepare` builds it earlier.
///
/// Args:
///     cells: (H, W) int8, -1 for unknown cells, otherwise the occupancy 0 to 100. The array is copied. A side has at most
///         65535 cells, the grid at most 2000000000.
///     resolution: Side of a cell [m].
///     origin: Pose (x, y, yaw) of the lower-left corner of cell (0, 0) in the map frame [m, m, rad], yaw included.
///     occupied_threshold: Cells with this value or more block beams and robots, 1 to 100. None means the default.
///     unknown: How unknown cells act, "free" or "occupied". Occupied cells block beams and robots.
///     materials: (H, W) uint8, the number of the material of each cell, which only matters where a cell blocks. None means
///         walls of one material.
///     material_table: The material of each number, 1 to 255 of them, each a `Material` or the name of one. None means
///         ("wall", "glass", "mirror", "dark").
///
/// Raises:
///     ValueError: The array has another shape or no cells, or a value is outside its range or not finite.
///     TypeError: The cells are not int8, or another argument has the wrong type.
///
/// Examples:
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=0.5)
///     >>> grid
///     OccupancyGrid(3x1 cells, 0.5 m, origin=(0.0, 0.0, 0.0), occupied_threshold=60, unknown='free')
///     >>> grid.cell_at(1.2, 0.1)
///     (0, 2)
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct OccupancyGrid {
    /// The grid itself. A cast keeps the grid that it started with, even if cells change during the cast.
    core: Lock<Arc<crate::OccupancyGrid>>,
    /// The array that `cells` returns, cached until cells change.
    cells: Lock<Option<Py<PyArray2<i8>>>>,
}

impl OccupancyGrid {
    /// Returns the current grid.
    pub fn core(&self) -> Arc<crate::OccupancyGrid> {
        Arc::clone(&self.core.lock())
    }
}

#[pymethods]
impl OccupancyGrid {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(cells, *, resolution, origin=(0.0, 0.0, 0.0), occupied_threshold=60, unknown='free', \
                          materials=None, material_table=None)",
        signature = (
            cells,
            *,
            resolution,
            origin = PoseArgument(crate::Pose::default()),
            occupied_threshold = None,
            unknown = "free",
            materials = None,
            material_table = None,
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        py: Python<'_>,
        cells: &Bound<'_, PyAny>,
        resolution: Argument<f64>,
        origin: PoseArgument,
        occupied_threshold: Option<&Bound<'_, PyAny>>,
        unknown: &str,
        materials: Option<&Bound<'_, PyAny>>,
        material_table: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let cells = typed::<i8>("cells", cells)?;
        let [_, width] = *cells.shape() else {
            return Err(PyValueError::new_err(format!("cells must have shape (H, W), got {}", shape(cells.shape()))));
        };
        let unknown = match unknown {
            "free" => Unknown::Free,
            "occupied" => Unknown::Occupied,
            other => return Err(PyValueError::new_err(format!("unknown must be 'free' or 'occupied', got '{other}'"))),
        };
        let threshold = match occupied_threshold {
            None => crate::OCCUPIED_THRESHOLD,
            Some(value) => whole_number("occupied_threshold", value, "in 1..100")?,
        };
        let resolution = resolution.named("resolution")?;
        let options = GridOptions { resolution, origin: origin.0, occupied_threshold: threshold, unknown };
        let cells = memory::collected("the cells of the grid", cells.as_array().iter().copied())?;
        let materials = match (materials, material_table) {
            (None, Some(_)) => return Err(PyValueError::new_err("material_table needs materials, got None")),
            (materials, table) => materials.map(|numbers| layer(numbers, table)).transpose()?.map(Arc::new),
        };
        let core = py.detach(|| crate::OccupancyGrid::new(cells, width, options)?.with_materials(materials))?;
        Ok(Self { core: Lock::new(Arc::new(core)), cells: Lock::new(None) })
    }

    /// Values of the cells: (H, W) int8, row 0 at the bottom, read-only.
    ///
    /// The array does not change when `set_cells` changes the grid.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        if let Some(array) = &*self.cells.lock() {
            return Ok(array.bind(py).clone());
        }
        let core = self.core();
        // The lock is not held meanwhile: a thread that waits for it may be the one that this one waits for.
        let flat = vector(py, py.detach(|| memory::collected("the cells of the grid", core.cells().iter().copied()))?);
        // Done before the reshape: a view of a writeable array could be made writeable again.
        flat.readwrite().make_nonwriteable();
        let array = flat.reshape([core.height(), core.width()])?;
        Ok(self.cells.lock().get_or_insert(array.unbind()).bind(py).clone())
    }

    /// Sets the cells of a rectangle.
    ///
    /// Only the part of the lookup table that the rectangle affects is rebuilt. Scans that run in other threads during the
    /// call still see the old values, and so do arrays that `cells` returned before.
    ///
    /// Args:
    ///     row: Lowest row of the rectangle.
    ///     col: Lowest column of the rectangle.
    ///     cells: (H, W) int8, -1 for unknown cells, otherwise the occupancy 0 to 100. The array is copied.
    ///
    /// Raises:
    ///     ValueError: The array has another shape or no cells, a value is out of range, or the rectangle is not on the
    ///         grid.
    ///     TypeError: The cells are not int8, or the row or column is not an integer.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
    ///     >>> grid.set_cells(0, 1, np.array([[100, 50]], np.int8))
    ///     >>> grid.cells
    ///     array([[  0, 100,  50],
    ///            [  0,   0,   0]], dtype=int8)
    fn set_cells(
        &self,
        py: Python<'_>,
        row: &Bound<'_, PyAny>,
        col: &Bound<'_, PyAny>,
        cells: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let corner = Cell { col: whole_number("col", col, "at least 0")?, row: whole_number("row", row, "at least 0")? };
        let values = typed::<i8>("cells", cells)?;
        let [_, width] = *values.shape() else {
            return Err(PyValueError::new_err(format!("cells must have shape (H, W), got {}", shape(values.shape()))));
        };
        let values = memory::collected("the cells", values.as_array().iter().copied())?;
        py.detach(|| {
            let mut core = self.core.lock();
            if Arc::get_mut(&mut core).is_none() {
                *core = Arc::new(core.try_clone()?);
            }
            Arc::get_mut(&mut core).expect("the only reference").set_cells(corner, width, &values)
        })?;
        // Dropped without the lock: a weak reference to the array may call back.
        let old = self.cells.lock().take();
        drop(old);
        Ok(())
    }

    /// Number of times that `set_cells` has changed the grid. A result that was computed from the cells holds while it stays.
    #[getter]
    fn revision(&self) -> u64 {
        self.core().revision()
    }

    /// Number of rows and columns (H, W).
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.core().height(), self.core().width())
    }

    /// Side of a cell [m].
    #[getter]
    fn resolution(&self) -> f64 {
        self.core().resolution()
    }

    /// Pose of the lower-left corner of cell (0, 0) in the map frame, yaw included.
    #[getter]
    fn origin(&self) -> Pose {
        Pose(self.core().options().origin)
    }

    /// Cells with this value or more block beams and robots.
    #[getter]
    fn occupied_threshold(&self) -> i8 {
        self.core().options().occupied_threshold
    }

    /// How unknown cells act, "free" or "occupied". Occupied cells block beams and robots.
    #[getter]
    fn unknown(&self) -> &'static str {
        match self.core().options().unknown {
            Unknown::Free => "free",
            Unknown::Occupied => "occupied",
        }
    }

    /// Numbers of the materials of the cells: (H, W) uint8, read-only; None if all are walls of one material.
    #[getter]
    fn materials<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u8>>>> {
        let core = self.core();
        let Some(layer) = core.materials() else { return Ok(None) };
        let flat = vector(py, memory::collected("the materials", layer.numbers().iter().copied())?);
        flat.readwrite().make_nonwriteable();
        Ok(Some(flat.reshape([core.height(), core.width()])?))
    }

    /// The material of each number in `materials`; None if there are none.
    #[getter]
    fn material_table(&self) -> Option<Vec<Material>> {
        let core = self.core();
        core.materials().map(|layer| layer.table().iter().copied().map(Material).collect())
    }

    /// Returns a copy of the grid with materials of its cells.
    ///
    /// Beams pass glass, and mirrors reflect them; robots touch both.
    ///
    /// Args:
    ///     materials: (H, W) uint8, as in the constructor; None for walls of one material.
    ///     table: The material of each number, as `material_table` in the constructor.
    ///
    /// Raises:
    ///     ValueError: The array has another shape than the cells, or a number is not in the table.
    ///     TypeError: The array is not uint8, or a material is neither a `Material` nor a name.
    ///
    /// Examples:
    ///     A mirror 2 m ahead, and a wall 1 m behind the robot:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[100, 0, 0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> mirror = grid.with_materials(np.array([[0, 0, 0, 0, 2]], np.uint8))
    ///     >>> mrs.LaserScanner(beam_count=1).scan(mirror, (2.0, 0.5, 0.0))
    ///     array([5.], dtype=float32)
    #[pyo3(signature = (materials, *, table = None))]
    fn with_materials(
        &self,
        py: Python<'_>,
        materials: Option<&Bound<'_, PyAny>>,
        table: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let materials = match (materials, table) {
            (None, Some(_)) => return Err(PyValueError::new_err("table needs materials, got None")),
            (materials, table) => materials.map(|numbers| layer(numbers, table)).transpose()?.map(Arc::new),
        };
        let core = self.core();
        let core = py.detach(|| core.try_clone()?.with_materials(materials))?;
        Ok(Self { core: Lock::new(Arc::new(core)), cells: Lock::new(None) })
    }

    fn __copy__(&self) -> Self {
        // Both grids share their cells until one of them changes.
        Self { core: Lock::new(self.core()), cells: Lock::new(None) }
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__()
    }

    /// Builds the lookup table for scans now instead of at the first scan.
    fn prepare(&self, py: Python<'_>) -> PyResult<()> {
        let core = self.core();
        Ok(py.detach(|| core.prepare(None))?)
    }

    /// Returns the cell (row, column) that contains a point, or None if the point is outside the grid.
    ///
    /// Args:
    ///     x: Position along x in the map frame [m].
    ///     y: Position along y in the map frame [m].
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
    ///     >>> grid.cell_at(2.5, 0.5), grid.cell_at(2.5, 2.5)
    ///     ((0, 2), None)
    fn cell_at(&self, x: Argument<f64>, y: Argument<f64>) -> PyResult<Option<(usize, usize)>> {
        let point = DVec2::new(x.named("x")?, y.named("y")?);
        Ok(self.core().cell_at(point).map(|cell| (cell.row, cell.col)))
    }

    /// Returns the centre (x, y) of a cell in the map frame [m].
    ///
    /// Args:
    ///     row: Row of the cell, 0 at the bottom.
    ///     col: Column of the cell, 0 at the left.
    ///
    /// Raises:
    ///     ValueError: The cell is not on the grid.
    ///     TypeError: The row or column is not an integer.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
    ///     >>> grid.center(0, 2)
    ///     (2.5, 0.5)
    fn center(&self, row: &Bound<'_, PyAny>, col: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let (row, col) = (whole_number("row", row, "at least 0")?, whole_number("col", col, "at least 0")?);
        Ok(self.core().checked_center(Cell { col, row })?.into())
    }

    /// Returns True if no blocking cell reaches into a disc.
    ///
    /// The test is exact. A cell that only touches the edge of the disc does not count. Outside the grid is free.
    ///
    /// Args:
    ///     x: Centre of the disc along x in the map frame [m].
    ///     y: Centre of the disc along y in the map frame [m].
    ///     radius: Radius of the disc [m]. With 0, the point itself is tested.
    ///
    /// Raises:
    ///     ValueError: A number is not finite, or the radius is negative.
    ///
    /// Examples:
    ///     The only wall covers x from 2 m to 3 m:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> grid.is_free_disc(0.5, 0.5, 1.5), grid.is_free_disc(0.5, 0.5, 1.6)
    ///     (True, False)
    fn is_free_disc(&self, py: Python<'_>, x: Argument<f64>, y: Argument<f64>, radius: Argument<f64>) -> PyResult<bool> {
        let (core, radius) = (self.core(), radius.named("radius")?);
        let center = DVec2::new(x.named("x")?, y.named("y")?);
        Ok(py.detach(|| core.is_free_disc(center, radius))?)
    }

    /// Returns how far each cell is from the nearest blocking cell.
    ///
    /// The grid keeps what it found, 2 bytes for each cell, until its cells change or another distance is asked for.
    ///
    /// Args:
    ///     max_distance: Largest distance [m], at most 255 cells. Longer ones become this one.
    ///     out: (H, W) float32 in C order, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (H, W) float32, which is `out` if it was given: the Euclidean distance between the centre of the cell and that of the
    ///         nearest blocking cell [m]; 0 for a blocking cell. Row 0 is at the bottom.
    ///
    /// Raises:
    ///     ValueError: `max_distance` is not positive or too long, or `out` is read-only, in use, not in C order or of another
    ///         shape.
    ///     TypeError: An argument has the wrong type or dtype.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[100, 0, 0, 0]], np.int8), resolution=0.5)
    ///     >>> grid.distances(1.25)
    ///     array([[0.  , 0.5 , 1.  , 1.25]], dtype=float32)
    #[pyo3(signature = (max_distance, *, out = None))]
    fn distances<'py>(
        &self,
        py: Python<'py>,
        max_distance: Argument<f64>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (core, max_distance) = (self.core(), max_distance.named("max_distance")?);
        fill(py, out, &[core.height(), core.width()], |distances| core.distances(max_distance, distances))
    }

    /// Returns the direction of the wall at each cell.
    ///
    /// Only blocking cells with a free neighbour have one: that of the straight line through such cells around it that are
    /// connected with it, in a window of 11 x 11 cells, near corners of 9 x 9 or 7 x 7. The grid keeps what it found, 1 byte for
    /// each cell, and follows `set_cells`.
    ///
    /// Args:
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: (H, W) float32 in C order, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (H, W) float32, which is `out` if it was given: the angle from the x axis of the grid to the wall [rad], 0 to below π in
    ///         steps of π/252; NaN where it is unknown, such as in free cells and within about three cells of a corner. Row 0 is
    ///         at the bottom.
    ///
    /// Raises:
    ///     ValueError: `threads` is out of range, or `out` is read-only, in use, not in C order or of another shape.
    ///     TypeError: An argument has the wrong type or dtype.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> slanting = mrs.OccupancyGrid(np.eye(4, dtype=np.int8) * 100, resolution=0.05)
    ///     >>> np.degrees(slanting.wall_directions().diagonal())
    ///     array([45., 45., 45., 45.], dtype=float32)
    #[pyo3(signature = (*, threads = None, out = None))]
    fn wall_directions<'py>(
        &self,
        py: Python<'py>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (core, threads) = (self.core(), thread_count(threads)?);
        fill(py, out, &[core.height(), core.width()], |directions| core.wall_directions(threads, directions))
    }

    /// Returns a random pose at which a disc is free.
    ///
    /// It is the first pose of `draw_free_poses`. The same seed gives the same pose on every machine.
    ///
    /// Args:
    ///     radius: Radius of the disc [m], for example that of the robot.
    ///     seed: Seed of the draw, 0 to 2**64 - 1, or a `RandomStream`, which counts the poses of all calls.
    ///
    /// Raises:
    ///     ValueError: There is no place for the disc, the radius is negative or not finite, or the seed is out of range.
    ///     TypeError: The seed is not an integer.
    ///
    /// Examples:
    ///     Only the first cell is free:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 100, -1]], np.int8), resolution=1.0)
    ///     >>> x, y, yaw = grid.draw_free_pose(radius=0.2, seed=1)
    ///     >>> grid.cell_at(x, y), x <= 0.8
    ///     ((0, 0), True)
    #[pyo3(signature = (*, radius, seed))]
    fn draw_free_pose(&self, py: Python<'_>, radius: Argument<f64>, seed: &Bound<'_, PyAny>) -> PyResult<Pose> {
        let radius = radius.named("radius")?;
        let (core, (seed, index)) = (self.core(), SeedArgument::new(Some(seed), "first_index", None)?.take(1)?);
        let mut pose = [[0.0; 3]];
        py.detach(|| core.draw_free_poses(radius, seed, index, Some(1), &mut pose))?;
        Ok(Pose(pose[0].into()))
    }

    /// Returns many random poses at which a disc is free.
    ///
    /// The position is uniform over all points of known free cells at which `is_free_disc` is True, not only over the centres
    /// of cells. The yaw is uniform over [-π, π). Pose i depends only on the grid, the radius and (seed, first_index + i), so
    /// many poses may be drawn in parts: they are the same bytes for any split, number of threads and machine.
    ///
    /// The first call needs a time that grows with the number of cells. The grid then keeps a table of free places until its
    /// cells change or another radius is asked for, so that a further pose takes about 0.1 µs.
    ///
    /// Args:
    ///     n: Number of poses.
    ///     radius: Radius of the disc [m], for example that of the robot. With 0, the point itself is free.
    ///     seed: Seed of the draw, 0 to 2**64 - 1, or a `RandomStream`, which counts the poses of all calls.
    ///     first_index: Index of the first pose in the random stream, 0 to 2**64 - 1. None means 0, or that of the
    ///         `RandomStream`.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: (N, 3) float64 in C order, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (N, 3) float64, which is `out` if it was given: x, y [m] and yaw [rad] in the map frame.
    ///
    /// Raises:
    ///     ValueError: There is no place for the disc (the error names the largest one that fits), the radius is negative or
    ///         not finite, an integer is out of range, or `out` is read-only, in use, not in C order or of another shape.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     Draw 1000 poses, then 1000 others. The last cell blocks:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> poses = grid.draw_free_poses(1000, radius=0.5, seed=1)
    ///     >>> others = grid.draw_free_poses(1000, radius=0.5, seed=1, first_index=1000)
    ///     >>> poses.shape, bool((poses[:, 0] <= 1.5).all()), bool((poses != others).all())
    ///     ((1000, 3), True, True)
    #[pyo3(signature = (n, *, radius, seed, first_index = None, threads = None, out = None))]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn draw_free_poses<'py>(
        &self,
        py: Python<'py>,
        n: &Bound<'py, PyAny>,
        radius: Argument<f64>,
        seed: &Bound<'py, PyAny>,
        first_index: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let radius = radius.named("radius")?;
        let (core, n, threads) = (self.core(), whole_number("n", n, "at least 0")?, thread_count(threads)?);
        let seed = SeedArgument::new(Some(seed), "first_index", first_index)?;
        check_out::<f64>(out.as_ref(), &[n, 3])?;
        let (seed, first_index) = seed.take(n)?;
        fill(py, out, &[n, 3], |poses: &mut [f64]| {
            core.draw_free_poses(radius, seed, first_index, threads, poses.as_chunks_mut().0)
        })
    }

    /// Draws the grid in Matplotlib axes and returns the axes.
    ///
    /// Walls are dark, free cells white and unknown cells grey. The axes are in metres in the map frame. A grid with more
    /// cells than the axes have pixels is down-sampled so that walls stay visible.
    ///
    /// Args:
    ///     ax: Matplotlib axes to draw in, which then show the whole grid. None opens a new pyplot figure.
    ///
    /// Returns:
    ///     The Matplotlib axes.
    ///
    /// Raises:
    ///     ImportError: Matplotlib is not installed. The extra `plotting` installs it.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> from matplotlib.figure import Figure
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> ax = grid.plot(Figure().add_subplot())
    ///     >>> ax.get_xlabel(), ax.get_ylabel()
    ///     ('x [m]', 'y [m]')
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("mobile_robot_simulator.plotting")?.call_method1("plot_grid", (slf, ax))
    }

    /// Returns a PNG image of the grid for notebooks, or None without Matplotlib: the notebook then shows the repr.
    fn _repr_png_<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match slf.py().import("mobile_robot_simulator.plotting") {
            Ok(plotting) => plotting.call_method1("grid_png", (slf,)).map(Some),
            Err(error) if error.is_instance_of::<PyImportError>(slf.py()) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn __repr__(&self) -> String {
        let core = self.core();
        let (width, height, options) = (core.width(), core.height(), core.options());
        let [x, y, yaw] = options.origin.to_array();
        format!(
            "OccupancyGrid({width}x{height} cells, {} m, origin=({x:?}, {y:?}, {yaw:?}), occupied_threshold={}, \
             unknown='{}')",
            options.resolution,
            options.occupied_threshold,
            self.unknown()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("resolution", self.resolution())?;
        keywords.set_item("origin", self.origin())?;
        keywords.set_item("occupied_threshold", self.occupied_threshold())?;
        keywords.set_item("unknown", self.unknown())?;
        if let (Some(materials), Some(table)) = (self.materials(py)?, self.material_table()) {
            keywords.set_item("materials", materials)?;
            keywords.set_item("material_table", table)?;
        }
        recipe::<Self>(py, PyTuple::new(py, [self.cells(py)?])?, keywords)
    }
}

/// A grid argument: an `OccupancyGrid`.
pub struct GridArgument<'py>(Bound<'py, OccupancyGrid>);

impl<'py> Deref for GridArgument<'py> {
    type Target = Bound<'py, OccupancyGrid>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'py> FromPyObject<'_, 'py> for GridArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(grid) = value.cast::<OccupancyGrid>() {
            return Ok(Self(grid.to_owned()));
        }
        let hint = if value.cast::<PyUntypedArray>().is_ok() {
            "; make one with OccupancyGrid(cells, resolution=...), where cells is an int8 array"
        } else {
            ""
        };
        Err(PyTypeError::new_err(format!("grid must be an OccupancyGrid, got {}{hint}", type_name(&value))))
    }
}
