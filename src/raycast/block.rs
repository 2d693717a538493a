//! A block: up to [`BLOCK`] rays in columns, as the vector kernels read them.

use super::source::RayGroup;
use crate::free_boxes::{FreeBoxes, Sector};
use crate::numeric::{GROUP, Group};

/// Largest number of rays in a block: enough for one scan of 1081 beams, or two of 541.
pub const BLOCK: usize = 1088;

/// Length of a [`Column`]. The last vectors may reach past the end of the block.
const CAPACITY: usize = BLOCK + 2 * GROUP;

/// One number for each ray of a block, and padding.
pub type Column<T> = [T; CAPACITY];

/// One axis of the rays of a block, in float32.
///
/// Cells are numbered along the axis: the ray starts in cell -1, and the next cell is 0.
#[repr(C, align(64))]
pub struct Axis32 {
    /// Cell the ray is in.
    pub cell: Column<f32>,
    /// Cells moved along the other axis for each cell along this one.
    pub slope: Column<f32>,
    /// Coordinate along the other axis at which the ray crosses line 0, the far line of its first cell.
    pub intercept: Column<f32>,
}

/// Rays that are cast together, and their results.
///
/// ```text
///   place              0      1      2    ...
///   major.cell       [ .      .      . ]        Columns of the active rays. After a few steps the
///   minor.cell       [ .      .      . ]        rays that are still active move up to the front.
///   base, stride, .. [ .      .      . ]
///   number           [ 0      1      4 ]        The ray that is in this place.
///
///   ended            [ 3      2 ]               Numbers of the rays that have ended, in that order,
///   ended_in         [ cell   cell ]            and their cells.
/// ```
#[repr(C, align(64))]
pub struct Block {
    /// Axis along which a ray moves farther.
    pub major: Axis32,
    /// The other axis.
    pub minor: Axis32,
    /// Index, in the codes of the free boxes, of cell 0 along both axes.
    pub base: Column<i32>,
    /// Number of codes in one row of the sector's plane.
    pub stride: Column<i32>,
    /// Number of the ray.
    pub number: Column<i32>,
    /// Numbers of the rays that have ended, in the order in which they ended.
    pub ended: Column<i32>,
    /// Last cells of those rays, one number each: `major + 65536 · minor`, with cells numbered from the first cell, 0.
    pub ended_in: Column<i32>,
    /// The same cells, ordered by the number of the ray.
    pub cells: Column<i32>,
    /// Distances of the rays. Each fan starts a new group.
    pub distances: [Group; BLOCK / GROUP],
}

impl Axis32 {
    const EMPTY: Self = Self { cell: [0.0; CAPACITY], slope: [0.0; CAPACITY], intercept: [0.0; CAPACITY] };

    /// Places a ray at its start. `first` and `first_of_other` are the distances to the far lines of its first cell.
    #[inline(always)]
    fn set(&mut self, at: usize, slope: f32, first: f32, first_of_other: f32) {
        self.cell[at] = -1.0;
        self.slope[at] = slope;
        self.intercept[at] = first * slope - first_of_other;
    }
}

impl Block {
    /// Returns a block without rays.
    #[must_use]
    pub fn new() -> Box<Self> {
        let zero = [0; CAPACITY];
        Box::new(Self {
            major: Axis32::EMPTY,
            minor: Axis32::EMPTY,
            base: zero,
            stride: zero,
            number: zero,
            ended: zero,
            ended_in: zero,
            cells: zero,
            distances: [[0.0; GROUP]; BLOCK / GROUP],
        })
    }

    /// Stores a group of rays from place `at` on.
    #[inline(always)]
    pub fn set_group(&mut self, free_boxes: &FreeBoxes, rays: &impl RayGroup, at: usize) {
        let (width, height) = (free_boxes.width() as i32, free_boxes.height() as i32);
        let plane = free_boxes.plane() as i32;
        for slot in 0..GROUP {
            let ray = rays.ray(slot);
            let sector = Sector::of(ray.direction);
            let first_x = sector.x().to_far_line(ray.origin.x, ray.col) as f32;
            let first_y = sector.y().to_far_line(ray.origin.y, ray.row) as f32;
            let (first_major, first_minor) = sector.order(first_x, first_y);
            let (major, minor) = sector.order(ray.direction.x.abs() as f32, ray.direction.y.abs() as f32);
            let (along, across) = sector.order(sector.x().cell(ray.col, width), sector.y().cell(ray.row, height));
            let stride = sector.order(width, height).0 + 2;
            let at = at + slot;
            self.major.set(at, minor / major, first_major, first_minor);
            self.minor.set(at, major / minor, first_minor, first_major);
            self.base[at] = (sector.number() as i32)
                .wrapping_mul(plane)
                .wrapping_add((across + 2).wrapping_mul(stride))
                .wrapping_add(along + 2);
            self.stride[at] = stride;
            self.number[at] = at as i32;
        }
    }

    /// Returns the index, in the codes of the free boxes, of the first cell of a ray.
    #[inline(always)]
    #[must_use]
    pub fn start(&self, at: usize) -> usize {
        // Cell -1 along both axes.
        self.base[at].wrapping_sub(self.stride[at]).wrapping_sub(1) as u32 as usize
    }
}

/// Returns true if an int32 can hold every index into the codes of the free boxes.
pub fn fits(free_boxes: &FreeBoxes) -> bool {
    i32::try_from(free_boxes.codes().len()).is_ok()
}
