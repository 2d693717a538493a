//! Exact, fast and deterministic simulation of mobile robots and laser scanners on occupancy grids.
//!
//! # Definitions
//!
//! They hold everywhere, in this crate and in the Python package on top of it.
//!
//! - **Units**: metres, seconds, radians. `f64` inside; ranges leave as `f32`.
//! - **World**: right-handed, yaw counter-clockwise, x forward, y left (REP-103). A pose is `(x, y, yaw)`.
//! - **Grid**: `(H, W)` cells of `i8`, row 0 at the bottom, -1 unknown, 0..100 occupancy (`nav_msgs/OccupancyGrid`). The origin
//!   is the pose of the lower-left corner of cell (0, 0), yaw included. Cell `(col, row)` covers `[col, col+1) × [row, row+1)`.
//! - **Blocking**: a cell blocks a beam when its value is at least the occupied threshold (60). Unknown cells let beams pass,
//!   or block if the grid says so. Outside of the grid is free.
//! - **Range**: the distance along the beam to the boundary at which it enters the first blocking cell (Amanatides & Woo 1987).
//!   A beam that starts in a blocking cell has range 0. A beam that starts outside enters the grid at its edge, and the gap
//!   counts. No hit within `max_range` gives exactly `max_range`. Nothing is rounded to cells, no angle is binned, no diagonal
//!   wall leaks.
//! - **Obstacles**: discs and simple polygons at poses. The range is that to the nearest of grid and obstacles; a beam that starts
//!   inside of one has range 0. Noise comes after; see [`Obstacles`].
//! - **Contact**: footprint, blocking cells and obstacles are taken with their edges, so that sharing one point is contact. A
//!   footprint that is stopped is within 1e-6 m of what stopped it, and not in it; see [`advance`].
//! - **Beams**: beam `i` points at `angle_min + i · angle_increment` with `angle_increment = fov / (beam_count - 1)`; a full turn
//!   has `fov / beam_count`, so that no beam is repeated.
//! - **Noise**: the beam model of *Probabilistic Robotics*, table 6.1, properly normalised; see [`BeamModel`].
//! - **Same seed, same bytes**: for any number of threads, any split of a batch, any instruction set, any machine. The random
//!   stream of a scan is named by (seed, index of the scan); nothing else enters it. Arithmetic is in one order everywhere,
//!   without fused multiply-adds, and transcendental functions are those of the `libm` crate, but for the directions of unrelated
//!   rays, which have polynomials of their own: such a ray and a scan's beam at its angle may differ in the last bits.
//! - **Motion**: a twist is integrated exactly (the exponential of SE(2)), not by Euler steps.

mod batch;
mod beam_model;
mod contact;
mod error;
mod free_boxes;
mod grid;
mod motion;
mod numeric;
mod obstacles;
mod pose;
#[cfg(feature = "python")]
mod python;
pub mod random;
pub mod raycast;
mod scanner;
mod shape;
mod world;

pub use beam_model::{BeamModel, BeamModelOptions};
pub use contact::{CONTACT_TOLERANCE, Contact, ContactMode, advance, clearance, touches};
pub use error::Error;
pub use grid::{Cell, GridOptions, MAX_CELLS, MAX_SIDE, OCCUPIED_THRESHOLD, OccupancyGrid, Unknown};
pub use motion::{Limits, MotionNoise, Twist, integrate, integrate_batch, interpolate};
pub use obstacles::Obstacles;
pub use pose::{Pose, wrap_angle, yaw_from_quaternion};
pub use scanner::{LaserScanner, MAX_BEAMS, NoReturn, Noise, ScannerOptions};
pub use shape::{MAX_CORNERS, MAX_EXTENT, Shape};
pub use world::World;
