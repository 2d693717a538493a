//! Rays side by side, as the vector kernels take them.

use super::Clearance;
use super::source::{GROUP, Group, Places};

/// Rays in a block: one scan of 1081 beams, or two of 541.
pub const BLOCK: usize = 1088;

/// Numbers of an [`Each`]: vectors at the end may reach beyond the block.
const ROOM: usize = BLOCK + 2 * GROUP;

/// A number for each ray of a block, and some room.
pub type Each<T> = [T; ROOM];

/// One axis of the rays of a block, in float32. Cells are counted from the one after the first.
#[repr(C, align(64))]
pub struct RoughAxis {
    /// Number of the cell the ray is in.
    pub cell: Each<f32>,
    /// Cells along the other axis for each one along this one.
    pub slope: Each<f32>,
    /// Where along the other axis the line after the first cell is crossed.
    pub intercept: Each<f32>,
}

/// A block of rays that are on their way, and where they ended.
#[repr(C, align(64))]
pub struct Block {
    /// The axis along which a ray goes farther.
    pub major: RoughAxis,
    /// The other one.
    pub minor: RoughAxis,
    /// Where in the clearance's lengths the cell (0, 0) is: the one after the first along both axes.
    pub base: Each<i32>,
    /// From a row to the next in the sector's plane.
    pub stride: Each<i32>,
    /// Number of the ray.
    pub number: Each<i32>,
    /// Numbers of the rays that ended, in that order.
    pub ended: Each<i32>,
    /// The cells of those rays: the major number, and 65,536 times the minor one; from the first cell on.
    pub ended_in: Each<i32>,
    /// The same in the order of the rays.
    pub cells: Each<i32>,
    /// How far the rays came, each fan in groups of its own.
    pub distances: [Group; BLOCK / GROUP],
}

impl RoughAxis {
    const EMPTY: Self = Self { cell: [0.0; ROOM], slope: [0.0; ROOM], intercept: [0.0; ROOM] };

    #[inline(always)]
    fn aim(&mut self, at: usize, slope: f32, first: f32, first_of_other: f32) {
        self.cell[at] = -1.0;
        self.slope[at] = slope;
        self.intercept[at] = first * slope - first_of_other;
    }
}

impl Block {
    /// A block whose rays are yet to be aimed.
    #[must_use]
    pub fn new() -> Box<Self> {
        let zero = [0; ROOM];
        Box::new(Self {
            major: RoughAxis::EMPTY,
            minor: RoughAxis::EMPTY,
            base: zero,
            stride: zero,
            number: zero,
            ended: zero,
            ended_in: zero,
            cells: zero,
            distances: [[0.0; GROUP]; BLOCK / GROUP],
        })
    }

    /// Puts a group of rays into the block, from place `at` on.
    #[inline(always)]
    pub fn aim(&mut self, clearance: &Clearance, rays: &impl Places, at: usize) {
        let (width, height) = (clearance.width() as i32, clearance.height() as i32);
        let plane = clearance.plane() as i32;
        for place in 0..GROUP {
            let ray = rays.ray(place);
            let (left, down) = (ray.direction.x < 0.0, ray.direction.y < 0.0);
            let (ax, ay) = (ray.direction.x.abs(), ray.direction.y.abs());
            let steep = ay > ax;
            let (x, y) = (f64::from(ray.col), f64::from(ray.row));
            let first_x = if left { ray.origin.x - x } else { (x + 1.0) - ray.origin.x };
            let first_y = if down { ray.origin.y - y } else { (y + 1.0) - ray.origin.y };
            let col = if left { width - 1 - ray.col } else { ray.col };
            let row = if down { height - 1 - ray.row } else { ray.row };
            let stride = if steep { height } else { width } + 2;
            let (along, across) = if steep { (row, col) } else { (col, row) };
            let sector = i32::from(left) | i32::from(down) << 1 | i32::from(steep) << 2;
            let at = at + place;
            let (first_x, first_y) = (first_x as f32, first_y as f32);
            let (first_major, first_minor) = if steep { (first_y, first_x) } else { (first_x, first_y) };
            let (major, minor) = if steep { (ay as f32, ax as f32) } else { (ax as f32, ay as f32) };
            self.major.aim(at, minor / major, first_major, first_minor);
            self.minor.aim(at, major / minor, first_minor, first_major);
            self.base[at] =
                sector.wrapping_mul(plane).wrapping_add((across + 2).wrapping_mul(stride)).wrapping_add(along + 2);
            self.stride[at] = stride;
            self.number[at] = at as i32;
        }
    }

    /// Where in the clearance's lengths the first cell of a ray is.
    #[inline(always)]
    #[must_use]
    pub fn start(&self, at: usize) -> usize {
        // Which is the one before the cell (0, 0) along both axes.
        self.base[at].wrapping_sub(self.stride[at]).wrapping_sub(1) as u32 as usize
    }
}

/// Whether the numbers of a block can name every byte of the lengths.
pub fn fits(clearance: &Clearance) -> bool {
    i32::try_from(clearance.lengths().len()).is_ok()
}
