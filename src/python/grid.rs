//! `OccupancyGrid` for Python.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec2;
use numpy::{PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{shape, typed, vector};
use super::pose::{Pose, PoseArgument};
use super::{stream_number, whole_number};
use crate::{Cell, GridOptions, Unknown};

/// Occupancy of the plane in square cells, as nav_msgs/OccupancyGrid has it.
///
/// cells: (H, W) int8, row 0 at the bottom; -1 unknown, 0..100 occupancy. Copied.
/// resolution: side of a cell [m]. origin: pose of the lower-left corner of cell (0, 0) in the map frame, yaw included.
/// occupied_threshold: cells of this value and above block beams, 1..100. unknown: "free" or "occupied", what unknown cells
/// are to beams. Off the grid is free.
/// What casting needs is built at the first cast, 8 bytes a cell, and kept.
///
/// raises: ValueError for a value out of its range; TypeError for cells that are not int8.
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct OccupancyGrid {
    /// The grid itself. Casts that began before cells were changed go on with the grid they began with.
    core: Mutex<Arc<crate::OccupancyGrid>>,
    /// The array handed out, until cells change.
    cells: Mutex<Option<Py<PyArray2<i8>>>>,
}

impl OccupancyGrid {
    /// The grid as it is now.
    pub fn core(&self) -> Arc<crate::OccupancyGrid> {
        // A grid is whole even where somebody who held it panicked.
        Arc::clone(&self.core.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl OccupancyGrid {
    #[new]
    #[pyo3(signature = (cells, *, resolution, origin = PoseArgument(crate::Pose::default()), occupied_threshold = None, unknown = "free"))]
    fn new(
        py: Python<'_>,
        cells: &Bound<'_, PyAny>,
        resolution: f64,
        origin: PoseArgument,
        occupied_threshold: Option<&Bound<'_, PyAny>>,
        unknown: &str,
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
        let options = GridOptions { resolution, origin: origin.0, occupied_threshold: threshold, unknown };
        let cells: Vec<i8> = cells.as_array().iter().copied().collect();
        let core = py.detach(|| crate::OccupancyGrid::new(cells, width, options))?;
        Ok(Self { core: Mutex::new(Arc::new(core)), cells: Mutex::new(None) })
    }

    /// Values of the cells, (H, W) int8, row 0 at the bottom. Read-only.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        let mut cells = self.cells.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(array) = &*cells {
            return Ok(array.bind(py).clone());
        }
        let core = self.core();
        let flat = vector(py, core.cells().to_vec());
        // Before a view is made, or the view could be made writeable again.
        flat.readwrite().make_nonwriteable();
        let array = flat.reshape([core.height(), core.width()])?;
        *cells = Some(array.clone().unbind());
        Ok(array)
    }

    /// Gives the cells of a rectangle new values; what casting needs is kept, but for what the rectangle changes.
    ///
    /// row, col: the rectangle's lowest row and column. cells: (H, W) int8, -1 unknown, 0..100 occupancy. Copied.
    /// Scans of other threads that are under way go on with the old values, and arrays got from `cells` keep them.
    /// raises: ValueError for values out of range and for a rectangle that is not on the grid; TypeError for another dtype.
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
        let values: Vec<i8> = values.as_array().iter().copied().collect();
        py.detach(|| {
            let mut core = self.core.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::make_mut(&mut core).set_cells(corner, width, &values)
        })?;
        *self.cells.lock().unwrap_or_else(PoisonError::into_inner) = None;
        Ok(())
    }

    /// Number of rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.core().height(), self.core().width())
    }

    /// Side of a cell [m].
    #[getter]
    fn resolution(&self) -> f64 {
        self.core().resolution()
    }

    /// Pose of the lower-left corner of cell (0, 0) in the map frame.
    #[getter]
    fn origin(&self) -> Pose {
        Pose(self.core().options().origin)
    }

    /// Cells of this value and above block beams.
    #[getter]
    fn occupied_threshold(&self) -> i8 {
        self.core().options().occupied_threshold
    }

    /// What unknown cells are to beams, "free" or "occupied".
    #[getter]
    fn unknown(&self) -> &'static str {
        match self.core().options().unknown {
            Unknown::Free => "free",
            Unknown::Occupied => "occupied",
        }
    }

    fn __copy__(&self) -> Self {
        // Cells are shared until one of the two changes them.
        Self { core: Mutex::new(self.core()), cells: Mutex::new(None) }
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__()
    }

    /// Builds what casting needs now rather than at the first cast.
    fn prepare(&self, py: Python<'_>) {
        let core = self.core();
        py.detach(|| core.prepare(None));
    }

    /// The cell (row, column) that a point of the map frame lies in, or None off the grid.
    fn cell_at(&self, x: f64, y: f64) -> Option<(usize, usize)> {
        self.core().cell_at(DVec2::new(x, y)).map(|cell| (cell.row, cell.col))
    }

    /// Centre (x, y) of a cell in the map frame [m].
    ///
    /// raises: ValueError for a cell that the grid does not have.
    fn center(&self, row: &Bound<'_, PyAny>, col: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let (row, col) = (whole_number("row", row, "at least 0")?, whole_number("col", col, "at least 0")?);
        Ok(self.core().checked_center(Cell { col, row })?.into())
    }

    /// Whether no blocking cell reaches into a disc around a point of the map frame [m], exactly. Off the grid is free.
    ///
    /// raises: ValueError for numbers that are not finite or a negative radius.
    fn is_free_disc(&self, x: f64, y: f64, radius: f64) -> PyResult<bool> {
        Ok(self.core().is_free_disc(DVec2::new(x, y), radius)?)
    }

    /// A pose drawn from the known free cells' centres, where a disc of this radius [m] is free.
    ///
    /// The draw is named by the seed alone: the same on every machine.
    /// raises: ValueError if there is no such place.
    #[pyo3(signature = (*, radius, seed))]
    fn draw_free_pose(&self, py: Python<'_>, radius: f64, seed: &Bound<'_, PyAny>) -> PyResult<Pose> {
        let seed = stream_number("seed", Some(seed))?;
        Ok(Pose(py.detach(|| self.core().draw_free_pose(radius, seed))?))
    }

    fn __repr__(&self) -> String {
        let [x, y, yaw] = self.core().options().origin.to_array();
        format!(
            "<OccupancyGrid {}x{} cells of {} m, origin ({x}, {y}, {yaw})>",
            self.core().width(),
            self.core().height(),
            self.core().resolution()
        )
    }

    #[allow(clippy::type_complexity, reason = "what pickle asks for")]
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((Bound<'py, PyAny>,), Bound<'py, pyo3::types::PyDict>)> {
        let keywords = pyo3::types::PyDict::new(py);
        keywords.set_item("resolution", self.resolution())?;
        keywords.set_item("origin", self.origin())?;
        keywords.set_item("occupied_threshold", self.occupied_threshold())?;
        keywords.set_item("unknown", self.unknown())?;
        Ok(((self.cells(py)?.into_any(),), keywords))
    }
}
