//! Exact, fast and deterministic simulation of mobile robots and laser scanners on occupancy grids.
//!
//! ```
//! use mobile_robot_simulator::{GridOptions, LaserScanner, OccupancyGrid, Pose, ScannerOptions, Unknown};
//!
//! // A row of ten cells of 1 m; the last one, from x = 9 m on, is occupied.
//! let cells = vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 100];
//! let options =
//!     GridOptions { resolution: 1.0, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
//! let grid = OccupancyGrid::new(cells, 10, options)?;
//!
//! // One beam straight ahead, from a robot at (0.5, 0.5) that faces the occupied cell.
//! let laser = LaserScanner::new(ScannerOptions { beam_count: 1, ..ScannerOptions::default() })?;
//! let mut ranges = [0.0];
//! laser.scan(&grid, Pose::new(0.5, 0.5, 0.0), &mut ranges)?;
//! assert_eq!(ranges, [8.5]);
//! # Ok::<(), mobile_robot_simulator::Error>(())
//! ```
//!
//! # Definitions
//!
//! These definitions hold everywhere in this crate, and in the Python package on top of it.
//!
//! - **Units**: metres, seconds, radians. Numbers are `f64`; ranges are returned as `f32`.
//! - **World**: right-handed, yaw counter-clockwise, x forward, y left (REP-103). A pose is `(x, y, yaw)`.
//! - **Grid**: `(H, W)` cells of `i8`, row 0 at the bottom; -1 is unknown, 0 to 100 is occupancy (`nav_msgs/OccupancyGrid`).
//!   The origin is the pose of the lower-left corner of cell (0, 0), yaw included. In cells from that corner, the cell
//!   `(col, row)` covers `[col, col+1) × [row, row+1)`.
//! - **Blocking**: a cell blocks beams if its value is at least the occupied threshold (default: 60). Unknown cells are free
//!   by default; a grid can also treat them as occupied. Everything outside the grid is free.
//! - **Range**: the distance along the beam to the boundary at which it enters the first blocking cell (Amanatides & Woo
//!   1987). A beam that starts in a blocking cell has range 0. A beam that starts outside the grid enters it at its edge;
//!   the distance to the edge is part of the range. Without a hit within `max_range` the range is exactly `max_range`.
//!   Ranges are not rounded to cells, angles are not rounded to bins, and beams do not pass between diagonal neighbours.
//! - **Obstacles**: discs and simple polygons at poses. The range is the distance to the nearest blocking cell or obstacle,
//!   and 0 for a beam that starts inside one. Noise is added after that; see [`Obstacles`].
//! - **Contact**: footprints, blocking cells and obstacles include their edges, so one shared point is contact. A footprint
//!   stops within 1e-6 m of what it meets, and never inside it; see [`advance`].
//! - **Beams**: beam `i` points at `angle_min + i · angle_increment`, with `angle_increment = fov / (beam_count - 1)`. A
//!   full turn has `angle_increment = fov / beam_count`, so that no beam is repeated. Other layouts, clockwise ones too:
//!   see [`BeamLayout`].
//! - **Time within a scan**: by default all beams are taken in one instant. In a scan that takes time, each beam has the range
//!   of a scan in the instant of the beam; see [`LaserScanner::sweep_batch`].
//! - **Noise**: the beam model of *Probabilistic Robotics*, table 6.1, with each part normalised; see [`BeamModel`].
//! - **Same seed, same bytes**: results are the same for any number of threads, any split of a batch, any instruction set
//!   and any machine. The random stream of a scan depends only on the seed and the index of the scan. Operations that a
//!   result depends on have a fixed order and no fused multiply-adds. Transcendental functions come from the `libm` crate,
//!   with three exceptions: this crate has its own polynomials for the random numbers of the beam model, for the scores of
//!   scans, and for the directions of unrelated rays. So an unrelated ray and the beam of a scan at the same angle may differ
//!   in the last bits.
//! - **Motion**: a twist is integrated exactly (the exponential map of SE(2)), not by Euler steps.

mod batch;
mod beam_fit;
mod beam_model;
mod beams;
mod contact;
mod crew;
mod distance_field;
mod error;
mod fleet;
mod fork;
mod free_area;
mod free_boxes;
mod grid;
mod interrupt;
mod lazy;
mod learning;
mod likelihood_field;
mod memory;
mod motion;
mod mount;
mod numeric;
mod obstacles;
mod pose;
mod prefetch;
mod preset;
#[cfg(feature = "python")]
mod python;
pub mod random;
pub mod raycast;
mod scanner;
mod scorer;
mod shape;
mod slant;
mod surface;
mod wall_directions;
mod world;

pub use beam_fit::{BeamFit, INCIDENCE_BANDS};
pub use beam_model::{BeamModel, BeamModelOptions};
pub use beams::{BeamLayout, FULL_TURN_TOLERANCE, MAX_BEAMS};
pub use contact::{CONTACT_TOLERANCE, Contact, ContactMode, advance, clearance, clearance_batch, stays_clear, touches};
pub use error::Error;
pub use fleet::{Fleet, FleetObstacle, FleetOptions, FleetState, MAX_COMMAND, Report, Reset, Rollout, Thing, Touch};
pub use grid::{Cell, GridOptions, MAX_CELLS, MAX_SIDE, OCCUPIED_THRESHOLD, OccupancyGrid, Unknown};
pub use learning::{Reward, Steps, Verdicts, commands_from_actions};
pub use likelihood_field::{LikelihoodField, LikelihoodFieldOptions};
pub use motion::{
    Course, Drive, DriveCommands, DriveKind, DriveState, Limits, MAX_STEERING, MAX_WHEELS, MotionNoise, Steering, Twist,
    WheelMotion, integrate, integrate_batch, interpolate, trace,
};
pub use mount::Mount;
pub use obstacles::{MovingObstacle, Obstacles, Trajectory};
pub use pose::{Pose, wrap_angle, yaw_from_quaternion};
pub use preset::Preset;
pub use scanner::{Courses, Hit, LaserScanner, NoReturn, Noise, Readings, ScannerOptions, Score, Sweeps};
pub use shape::{MAX_CORNERS, MAX_EXTENT, Shape};
pub use surface::{Material, MaterialKind, Materials, SurfaceModel, SurfaceOptions};
pub use world::World;
