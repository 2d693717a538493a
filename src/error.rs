//! The one error type: what was wrong, what was given, what was needed.

/// A value that the simulator cannot work with.
///
/// Constructors and batch entry points check their input, so that nothing behind them can fail.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number outside of its domain.
    #[error("{name} must be {needed}, got {value}")]
    Number {
        /// What the number is.
        name: &'static str,
        /// The number given.
        value: f64,
        /// The domain.
        needed: &'static str,
    },
    /// A row of a batch that holds a NaN or an infinity.
    #[error("{name} must be finite, got {value:?} in row {row}")]
    Row {
        /// What the batch holds.
        name: &'static str,
        /// Index of the first such row.
        row: usize,
        /// The row given.
        value: [f64; 3],
    },
    /// A whole number outside of its domain.
    #[error("{name} must be {needed}, got {value}")]
    Count {
        /// What is counted.
        name: &'static str,
        /// The number given.
        value: usize,
        /// The domain.
        needed: &'static str,
    },
    /// An array that does not have the extent it must have.
    #[error("{name} must have {needed} elements, got {value}")]
    Length {
        /// What the array holds.
        name: &'static str,
        /// The number of elements given.
        value: usize,
        /// The number needed.
        needed: usize,
    },
    /// A cell outside of -1..100.
    #[error("cells must be in -1..100, got {value} at row {row}, column {col}")]
    Cell {
        /// Row of the first such cell.
        row: usize,
        /// Column of the first such cell.
        col: usize,
        /// The value given.
        value: i8,
    },
    /// A cell that the grid does not have.
    #[error("row and column must be below {height} and {width}, got {row} and {col}")]
    OffGrid {
        /// Row of the cell.
        row: usize,
        /// Column of the cell.
        col: usize,
        /// Rows of the grid.
        height: usize,
        /// Columns of the grid.
        width: usize,
    },
    /// Beam model weights of which none is positive.
    #[error("at least one of z_hit, z_short, z_max, z_rand must be positive, got {0:?}")]
    Weights([f64; 4]),
    /// A corner of a polygon that is not finite or too far away.
    #[error("a corner must be finite and within 1e6 of the origin, got {value:?} in row {row}")]
    Corner {
        /// Index of the first such corner.
        row: usize,
        /// The corner given.
        value: [f64; 2],
    },
    /// A corner of a polygon given twice in a row.
    #[error("corners must differ, got the same in rows {row} and {next}")]
    RepeatedCorner {
        /// Index of the corner.
        row: usize,
        /// Index of its repetition.
        next: usize,
    },
    /// A polygon that crosses or touches itself.
    #[error("edges must meet only at the corners they share, got edges {first} and {second} that meet elsewhere")]
    Edges {
        /// Index of an edge, which is that of its first corner.
        first: usize,
        /// Index of another.
        second: usize,
    },
    /// No place for a robot of this radius.
    #[error("no known free place for a disc of radius {radius} m on this grid")]
    NoFreePlace {
        /// Radius of the robot in metres.
        radius: f64,
    },
    /// A name that is not one of the kernels that this machine can run.
    #[error("MOBILE_ROBOT_SIMULATOR_KERNEL must be one of {available} on this machine, got {value:?}")]
    Kernel {
        /// The name given.
        value: String,
        /// The names of those that can run.
        available: String,
    },
    /// The operating system gave no threads.
    #[error("could not start {threads} threads: {reason}")]
    Threads {
        /// The number asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// Checks that `value` is finite and in its domain: `is_valid` is true for it, and `needed` describes the domain.
pub(crate) fn check_number(
    name: &'static str,
    value: f64,
    needed: &'static str,
    is_valid: impl Fn(f64) -> bool,
) -> Result<f64, Error> {
    if value.is_finite() && is_valid(value) { Ok(value) } else { Err(Error::Number { name, value, needed }) }
}

/// Checks that `value` is finite.
pub(crate) fn check_finite(name: &'static str, value: f64) -> Result<f64, Error> {
    check_number(name, value, "finite", |_| true)
}
