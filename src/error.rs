//! The error type of the crate: what is wrong, what was given, and what is needed.

/// An invalid value.
///
/// Constructors and functions on batches check their input, so the code behind them cannot fail.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number outside its domain.
    #[error("{name} must be {needed}, got {}", shown(*value))]
    Number {
        /// Name of the number.
        name: &'static str,
        /// The number given.
        value: f64,
        /// Its domain.
        needed: &'static str,
    },
    /// An angle that looks like a number of degrees.
    #[error("{name} must be {needed}, got {}; {}° is {:.4} rad", shown(*value), shown(*value), value.to_radians())]
    Degrees {
        /// Name of the angle.
        name: &'static str,
        /// The number given.
        value: f64,
        /// Its domain.
        needed: &'static str,
    },
    /// A name that is not one of the known ones.
    #[error("{what} must be one of {}, got {value:?}", known.join(", "))]
    Name {
        /// What has the name.
        what: &'static str,
        /// The name given, at most 60 characters of it.
        value: String,
        /// The known names.
        known: Vec<&'static str>,
    },
    /// A tilted scanner where only one that measures in the plane can be used.
    #[error("the scanner must not be tilted: its beams meet walls of any height at angles in space")]
    Tilted,
    /// Ends of a field of beams that are equal, or more than a full turn apart.
    #[error("angle_max must differ from angle_min by at most 2π, got {} and {}", shown(*angle_max), shown(*angle_min))]
    Angles {
        /// Angle of the first beam.
        angle_min: f64,
        /// Angle of the last beam.
        angle_max: f64,
    },
    /// Steps between beams that are 0, or together more than a full turn.
    #[error(
        "angle_increment must be other than 0, and turn all beams by at most 2π, got {} for {beam_count} beams",
        shown(*angle_increment)
    )]
    Steps {
        /// Angle from one beam to the next.
        angle_increment: f64,
        /// Number of beams.
        beam_count: usize,
    },
    /// A maximum range that is not above the minimum range.
    #[error("max_range must be greater than min_range, got {} and {}", shown(*max_range), shown(*min_range))]
    Ranges {
        /// The minimum range given.
        min_range: f64,
        /// The maximum range given.
        max_range: f64,
    },
    /// A row of a batch that contains NaN or an infinity.
    #[error("{name} must be finite, got {value:?} in row {row}")]
    Row {
        /// Name of the batch.
        name: &'static str,
        /// Index of the first such row.
        row: usize,
        /// The row given.
        value: [f64; 3],
    },
    /// A number of a batch outside its domain.
    #[error("{name} must be {needed}, got {} in row {row}", shown(*value))]
    Element {
        /// Name of the batch.
        name: &'static str,
        /// Index of the first row with such a number.
        row: usize,
        /// The number given.
        value: f64,
        /// Its domain.
        needed: &'static str,
    },
    /// A command of a robot that is not finite, or too large.
    #[error("{} must be finite and at most 1000 on each axis, got {value:?}", command(*robot, *step))]
    Command {
        /// Index of the first such robot, or of the rollout.
        robot: usize,
        /// Index of the command in the rollout; `None` for a robot, which has only one.
        step: Option<usize>,
        /// The command given.
        value: Vec<f64>,
    },
    /// Times of waypoints that do not increase.
    #[error("the times of waypoints must increase, got {} after {} in row {row}", shown(times[1]), shown(times[0]))]
    Times {
        /// Index of the first waypoint that is not after the one before it.
        row: usize,
        /// Times of the waypoint before it, and of this one \[s\].
        times: [f64; 2],
    },
    /// Robots of one world at different times.
    #[error("robots that share a world must be at the same time, got {} s for robot {robot} and {} s for another", times[0], times[1])]
    Clocks {
        /// Index of a robot.
        robot: usize,
        /// Its time, and that of another robot of its world \[s\].
        times: [f64; 2],
    },
    /// There is no obstacle with this index.
    #[error("the obstacle must be below {count}, got {obstacle}")]
    NoObstacle {
        /// Index given.
        obstacle: usize,
        /// Number of obstacles.
        count: usize,
    },
    /// An obstacle that is to be replaced is in each world.
    #[error("an obstacle that is replaced must be in one world, got obstacle {obstacle}, which is in each world")]
    EachWorld {
        /// Index of the obstacle.
        obstacle: usize,
    },
    /// An obstacle in a world that no robot is in.
    #[error("obstacle {obstacle} must be in the world of a robot, got world {world}, which has none")]
    NoWorld {
        /// Index of the obstacle.
        obstacle: usize,
        /// Number of the world given.
        world: u64,
    },
    /// Robots of one world on different grids.
    #[error("robots that share a world must be on the same grid, got robots {robot} and {other}")]
    Worlds {
        /// Index of a robot.
        robot: usize,
        /// Index of a robot of the same world on another grid.
        other: usize,
    },
    /// Commands of a speed and a steering angle for robots without an Ackermann drive.
    #[error("commands must be rows (vx, vy, wz) for robots without an Ackermann drive, got rows (speed, steering angle)")]
    Steered,
    /// Drives of different kinds in one fleet.
    #[error("the drives of a fleet must be of one kind, got another one for robot {robot}")]
    DriveKinds {
        /// Index of the first robot whose drive is of another kind than that of the first robot.
        robot: usize,
    },
    /// A saved state of a robot with other wheels.
    #[error("the state of robot {robot} must be of a robot with the same drive, got one with another drive or none")]
    OtherDrive {
        /// Index of the robot.
        robot: usize,
    },
    /// Words that are not the state of robots.
    #[error("the words must be those of a saved state, got {problem}")]
    State {
        /// What is wrong with them.
        problem: &'static str,
    },
    /// A robot that a fleet does not have.
    #[error("the robot must be below {count}, got {robot}")]
    NoRobot {
        /// The index given.
        robot: usize,
        /// Number of robots of the fleet.
        count: usize,
    },
    /// An index of something that does not exist, given for a robot.
    #[error("{name} of robot {robot} must be below {count}, got {value}")]
    Index {
        /// Name of the index.
        name: &'static str,
        /// Index of the robot.
        robot: usize,
        /// The index given.
        value: usize,
        /// Number of things that exist.
        count: usize,
    },
    /// A count outside its domain.
    #[error("{name} must be {needed}, got {value}")]
    Count {
        /// Name of the count.
        name: &'static str,
        /// The count given.
        value: usize,
        /// Its domain.
        needed: &'static str,
    },
    /// An array of the wrong length.
    #[error("{name} must have {needed} elements, got {value}")]
    Length {
        /// Name of the array.
        name: &'static str,
        /// Number of elements given.
        value: usize,
        /// Number of elements needed.
        needed: usize,
    },
    /// A cell value outside -1 to 100.
    #[error("cells must be in -1..100, got {value} at row {row}, column {col}")]
    Cell {
        /// Row of the first such cell.
        row: usize,
        /// Column of the first such cell.
        col: usize,
        /// The value given.
        value: i8,
    },
    /// A material of a cell that is not in the table.
    #[error("materials must be numbers of the {count} in the table, got {value} in row {row}, column {col}")]
    Material {
        /// Row of the first such cell.
        row: usize,
        /// Column of the first such cell.
        col: usize,
        /// The number given.
        value: u8,
        /// Number of materials in the table.
        count: usize,
    },
    /// A layer of materials of another shape than its grid.
    #[error("materials must have the shape {grid:?} of the cells, got {layer:?}")]
    Layer {
        /// Rows and columns of the layer.
        layer: (usize, usize),
        /// Rows and columns of the grid.
        grid: (usize, usize),
    },
    /// A cell that is not on the grid.
    #[error("row and column must be below {height} and {width}, got {row} and {col}")]
    OffGrid {
        /// Row of the cell.
        row: usize,
        /// Column of the cell.
        col: usize,
        /// Number of rows of the grid.
        height: usize,
        /// Number of columns of the grid.
        width: usize,
    },
    /// A block of cells that is not on the grid.
    #[error(
        "a block of shape ({}, {}) at row {} and column {} must fit on the grid of shape ({}, {})",
        block.0, block.1, corner.0, corner.1, grid.0, grid.1
    )]
    Block {
        /// Number of rows and columns of the block.
        block: (usize, usize),
        /// Row and column of its first cell.
        corner: (usize, usize),
        /// Number of rows and columns of the grid.
        grid: (usize, usize),
    },
    /// Weights of a beam model that are all 0.
    #[error("at least one of z_hit, z_short, z_max, z_rand must be positive, got {0:?}")]
    Weights([f64; 4]),
    /// A corner of a polygon that is not finite or too far from the origin.
    #[error("a corner must be finite and within 1e6 of the origin, got {value:?} in row {row}")]
    Corner {
        /// Index of the first such corner.
        row: usize,
        /// The corner given.
        value: [f64; 2],
    },
    /// Two consecutive corners of a polygon that are equal.
    #[error("corners must differ, got the same in rows {row} and {next}")]
    RepeatedCorner {
        /// Index of the first of the two corners.
        row: usize,
        /// Index of the second.
        next: usize,
    },
    /// A polygon that crosses or touches itself.
    #[error("edges must meet only at the corners they share, got edges {first} and {second} that meet elsewhere")]
    Edges {
        /// Index of the first edge: the index of the corner where it starts.
        first: usize,
        /// Index of the second edge.
        second: usize,
    },
    /// A grid without known free space for a disc of this radius.
    #[error("no known free place for a disc of radius {} m on this grid, {}", shown(*radius), largest_disc(*largest))]
    NoFreePlace {
        /// Radius of the disc in metres.
        radius: f64,
        /// About the largest radius in metres for which there is a place, rounded down; `None` if no cell is known to be free.
        largest: Option<f64>,
    },
    /// A name that is not the name of a kernel, or a kernel that this machine cannot run.
    #[error("MOBILE_ROBOT_SIMULATOR_KERNEL must be one of {available} on this machine, got {value:?}")]
    Kernel {
        /// The name given.
        value: String,
        /// Names of the kernels that can run.
        available: String,
    },
    /// Memory that the system does not have.
    #[error("not enough memory for {what}, which need {bytes} bytes")]
    Memory {
        /// What the memory is for.
        what: &'static str,
        /// Number of bytes needed.
        bytes: usize,
    },
    /// A call that was ended early, for example by Ctrl-C.
    #[error("the call was interrupted")]
    Interrupted,
    /// Threads that the operating system did not start.
    #[error("could not start {threads} threads: {reason}")]
    Threads {
        /// Number of threads needed.
        threads: usize,
        /// Reason that the system gave.
        reason: String,
    },
}

impl Error {
    /// Returns the error about a name that is not one of the `known` ones.
    pub(crate) fn unknown(what: &'static str, value: &str, known: Vec<&'static str>) -> Self {
        Self::Name { what, value: value.chars().take(60).collect(), known }
    }
}

/// Formats a number with an exponent where it would have many digits.
fn shown(value: f64) -> String {
    let size = value.abs();
    if size < 1e16 && (size >= 1e-5 || size == 0.0) { value.to_string() } else { format!("{value:?}") }
}

fn command(robot: usize, step: Option<usize>) -> String {
    step.map_or_else(|| format!("the command of robot {robot}"), |step| format!("command {step} of rollout {robot}"))
}

fn largest_disc(radius: Option<f64>) -> String {
    radius.map_or_else(
        || "where no cell is known to be free".to_owned(),
        |radius| format!("where the largest that fits has a radius of {radius} m"),
    )
}

/// Returns `value` if it is finite and `is_valid` is true for it; `needed` describes these values in the error.
pub(crate) fn check_number(
    name: &'static str,
    value: f64,
    needed: &'static str,
    is_valid: impl Fn(f64) -> bool,
) -> Result<f64, Error> {
    if value.is_finite() && is_valid(value) { Ok(value) } else { Err(Error::Number { name, value, needed }) }
}

/// Checks that all numbers of a batch are finite; `width` of them are a row.
pub(crate) fn check_all_finite(name: &'static str, numbers: &[f64], width: usize) -> Result<(), Error> {
    match numbers.iter().position(|number| !number.is_finite()) {
        Some(index) => Err(Error::Element { name, row: index / width, value: numbers[index], needed: "finite" }),
        None => Ok(()),
    }
}

/// Returns `value` if it is finite.
pub(crate) fn check_finite(name: &'static str, value: f64) -> Result<f64, Error> {
    check_number(name, value, "finite", |_| true)
}
