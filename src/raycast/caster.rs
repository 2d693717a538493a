//! Casting of scans and of unrelated rays: from poses in the map frame to ranges in metres.

use std::cell::RefCell;
use std::slice;

use glam::DVec2;

use super::Ray;
use super::block::{self, Block};
use super::fans::Fans;
use super::kernel::{self, Dense, Kernel, Work};
use super::rays::{RayColumns, Rays};
use super::sink::{InMetres, Sink, StoreRanges};
use super::source::{RayGroup, Source};
use crate::batch::{check_rows, for_each_chunk};
use crate::error::{Error, check_number};
use crate::grid::OccupancyGrid;
use crate::memory;
use crate::numeric::elementary::directions;
use crate::numeric::{GROUP, Group};
use crate::obstacles::Obstacles;
use crate::pose::Pose;
use crate::world::World;

/// Casts rays over one grid up to one maximum range, with one kernel.
///
/// ```
/// use mobile_robot_simulator::raycast::{Caster, Kernel};
/// use mobile_robot_simulator::{GridOptions, Obstacles, OccupancyGrid, Pose, Unknown};
///
/// // One row of four cells of 0.5 m; the last one blocks. Its near side is at x = 1.5.
/// let options =
///     GridOptions { resolution: 0.5, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
/// let grid = OccupancyGrid::new(vec![0, 0, 0, 100], 4, options)?;
/// let rays = [[0.25, 0.25, 0.0], [0.25, 0.25, 3.0], [1.75, 0.25, 0.0]];
/// let mut ranges = [0.0; 3];
/// Caster::new(&grid, 10.0, Kernel::Traversal)?.cast_rays(Obstacles::NONE, &rays, None, &mut ranges)?;
/// // Onto the wall, off the grid, and from within the wall.
/// assert_eq!(ranges, [1.25, 10.0, 0.0]);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Caster<'grid> {
    grid: &'grid OccupancyGrid,
    kernel: Kernel,
    max_range: f64,
    /// Distance \[cells\] at which a kernel may stop following a ray: any hit beyond it is out of range.
    limit: f64,
}

/// Number of rays that one thread casts at a time.
const CHUNK: usize = 1024;
const _: () = assert!(CHUNK.is_multiple_of(GROUP) && CHUNK <= block::BLOCK);

impl<'grid> Caster<'grid> {
    /// Returns a caster for rays over `grid`. A ray without a hit within `max_range` metres has no return.
    ///
    /// # Errors
    /// [`Error::Number`] if `max_range` is not positive, not finite or too large for a float32.
    pub fn new(grid: &'grid OccupancyGrid, max_range: f64, kernel: Kernel) -> Result<Self, Error> {
        check_number("max_range", max_range, "positive", |value| value > 0.0)?;
        check_number("max_range", max_range, "within the range of float32", |value| value <= f32::MAX.into())?;
        // One cell longer than the maximum range, so that rounding cannot drop a hit that is in range. The comparison in
        // metres, by `InMetres`, decides which hits are in range.
        let limit = max_range / grid.resolution() + 1.0;
        Ok(Self { grid, kernel, max_range, limit })
    }

    /// Builds the free boxes of the grid if the kernel uses them, on `threads` threads (default: all cores).
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub(crate) fn prepare(&self, threads: Option<usize>) -> Result<(), Error> {
        if self.kernel.uses_free_boxes() { self.grid.prepare(threads) } else { Ok(()) }
    }

    /// Returns the grid.
    pub(crate) fn grid(&self) -> &'grid OccupancyGrid {
        self.grid
    }

    /// Returns the kernel that casts.
    pub(crate) fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Sends ranges in metres to the sink, group by group; infinite for no return within the maximum range.
    ///
    /// # Panics
    /// If the sink itself starts a cast, or if there is no memory for free boxes that are not prepared.
    pub(super) fn cast(&self, source: impl Source, sink: impl Sink) {
        thread_local! {
            static BUFFERS: RefCell<(Box<Block>, Dense)> = RefCell::new((Block::new(), Dense::default()));
        }
        // This comes before the buffers are borrowed: while the free boxes are built, this thread may run another cast.
        self.prepare(None).expect("enough memory");
        let sink = InMetres { resolution: self.grid.resolution(), max_range: self.max_range, sink };
        BUFFERS.with_borrow_mut(|buffers| kernel::cast(self.kernel, self.grid, source, self.limit, buffers, sink));
    }

    /// Returns the number of fans to cast together on one thread, for a batch of `fans` fans with `groups` groups each that
    /// `threads` threads share.
    #[must_use]
    pub(crate) fn fans_per_cast(&self, fans: usize, groups: usize, threads: usize) -> usize {
        // Each thread gets at least this many casts, so that all threads finish at about the same time.
        const CASTS_PER_THREAD: usize = 8;
        if self.kernel == Kernel::Traversal {
            return 1;
        }
        (block::BLOCK / GROUP / groups.max(1)).min(fans / (CASTS_PER_THREAD * threads.max(1))).clamp(1, Fans::MAX)
    }

    /// Casts fans that may start off the grid; sends ranges to the sink like [`cast`](Self::cast), fan by fan.
    ///
    /// # Panics
    /// If the sink itself starts a cast, or if several fans together do not fit into a block.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub(crate) fn cast_fans(&self, fans: Fans<'_>, mut sink: impl Sink) -> Result<(), Error> {
        if fans.are_on_grid() && fans.are_alike(self.grid, self.kernel.break_even_length()) {
            self.cast(fans, sink);
            return Ok(());
        }
        let mut groups = Vec::new();
        for (number, start) in fans.starts.iter().enumerate() {
            let fan = Fans { starts: slice::from_ref(start), ..fans };
            let first = number * fan.cos.len();
            let sink = |group: usize, ranges: &Group| sink.take(first + group, ranges);
            if fan.are_on_grid() {
                self.cast(fan, sink);
                continue;
            }
            groups.clear();
            if groups.capacity() == 0 {
                groups = memory::with_room("the beams", fan.cos.len())?;
            }
            groups.resize(fan.cos.len(), RayColumns::MISSES);
            for (group, columns) in groups.iter_mut().enumerate() {
                let rays = fan.group(0, group);
                for slot in 0..GROUP {
                    let Ray { origin, direction, .. } = rays.ray(slot);
                    self.enter(columns, slot, origin, direction);
                }
            }
            self.cast(Rays { groups: &groups, count: fan.count, upcoming: &[] }, sink);
        }
        Ok(())
    }

    /// Casts unrelated rays, each `[x, y, yaw]` in the map frame; stores the ranges \[m\] to the nearest of grid and
    /// obstacles.
    ///
    /// The maximum range means no return. The result does not depend on `threads` (default: all cores).
    ///
    /// # Errors
    /// If a ray is not finite, if `ranges` does not have one element per ray, or if the threads cannot be started.
    pub fn cast_rays(
        &self,
        obstacles: &Obstacles,
        rays: &[[f64; 3]],
        threads: Option<usize>,
        ranges: &mut [f32],
    ) -> Result<(), Error> {
        self.cast_rays_past((obstacles, None), rays, threads, ranges)
    }

    /// Same as [`cast_rays`](Self::cast_rays), as if the obstacle with the index `except` were not there.
    fn cast_rays_past(
        &self,
        (obstacles, except): (&Obstacles, Option<usize>),
        rays: &[[f64; 3]],
        threads: Option<usize>,
        ranges: &mut [f32],
    ) -> Result<(), Error> {
        thread_local! {
            static GROUPS: RefCell<Vec<RayColumns>> = const { RefCell::new(Vec::new()) };
        }
        check_rows("rays", rays, threads)?;
        if ranges.len() != rays.len() {
            return Err(Error::Length { name: "out", value: ranges.len(), needed: rays.len() });
        }
        self.prepare(threads)?;
        for_each_chunk(threads, ranges, CHUNK, |chunk, ranges| {
            let (rays, upcoming) = rays[chunk * CHUNK..].split_at(ranges.len());
            GROUPS.with_borrow_mut(|groups| {
                groups.resize(rays.len().div_ceil(GROUP), RayColumns::MISSES);
                self.kernel.with_features(FillGroups { caster: self, rays, groups });
                let upcoming = &upcoming[..upcoming.len().min(CHUNK)];
                self.cast(Rays { groups, count: rays.len(), upcoming }, StoreRanges { max_range: self.max_range, ranges });
            });
            if !obstacles.is_empty() {
                for (range, ray) in ranges.iter_mut().zip(rays) {
                    *range = range.min(obstacles.cast_pose(except, Pose::from(*ray), f64::from(*range)) as f32);
                }
            }
            Ok(())
        })
    }

    /// Fills a group with rays of the map frame.
    #[inline(always)]
    fn fill_group(&self, columns: &mut RayColumns, rays: &[[f64; 3]; GROUP]) {
        let [x, y, dx, dy] = columns.origins_and_directions();
        let mut yaws = [0.0; GROUP];
        for (slot, &ray) in rays.iter().enumerate() {
            let (origin, yaw) = self.in_grid(ray.into());
            (x[slot], y[slot], yaws[slot]) = (origin.x, origin.y, yaw);
        }
        let are_finite = directions(&yaws, dx, dy);
        self.start_group(columns, are_finite);
    }

    /// Returns the position of a pose \[cells\] and its yaw, in the frame of the grid.
    #[inline(always)]
    pub(super) fn in_grid(&self, pose: Pose) -> (DVec2, f64) {
        let Pose { position, yaw } = self.grid.pose_in_grid(pose);
        (self.grid.in_cells(position), yaw)
    }

    /// Completes a group whose origins and directions are filled.
    #[inline(always)]
    pub(super) fn start_group(&self, columns: &mut RayColumns, are_finite: bool) {
        if !(are_finite && columns.start((self.grid.width(), self.grid.height()))) {
            let [x, y, dx, dy] = columns.origins_and_directions().map(|column| *column);
            *columns = RayColumns::MISSES;
            for slot in 0..GROUP {
                self.enter(columns, slot, DVec2::new(x[slot], y[slot]), DVec2::new(dx[slot], dy[slot]));
            }
        }
    }

    /// Stores the part of a ray that is on the grid in a slot of a group; leaves the slot as it is if the ray misses the
    /// grid.
    fn enter(&self, columns: &mut RayColumns, slot: usize, origin: DVec2, direction: DVec2) {
        if let Some(ray) = Ray::entering(self.grid.width(), self.grid.height(), origin, direction) {
            columns.set(slot, &ray);
        }
    }
}

/// Fills groups with rays of the map frame; pads the last group with the first of its rays.
struct FillGroups<'a, 'grid> {
    caster: &'a Caster<'grid>,
    rays: &'a [[f64; 3]],
    groups: &'a mut [RayColumns],
}

impl Work for FillGroups<'_, '_> {
    #[inline(always)]
    fn run(self) {
        let Self { caster, rays, groups } = self;
        for (columns, rays) in groups.iter_mut().zip(rays.chunks(GROUP)) {
            if let Some(rays) = rays.first_chunk() {
                caster.fill_group(columns, rays);
            } else {
                let mut padded = [rays[0]; GROUP];
                padded[..rays.len()].copy_from_slice(rays);
                caster.fill_group(columns, &padded);
            }
        }
    }
}

/// Casts unrelated rays with the kernel chosen for this machine; see [`Caster::cast_rays`].
///
/// ```
/// use mobile_robot_simulator::raycast::cast_rays;
/// use mobile_robot_simulator::{GridOptions, Obstacles, OccupancyGrid, Pose, Shape, Unknown};
///
/// // One free cell, and a disc of radius 0.5 m around (3, 0).
/// let options =
///     GridOptions { resolution: 1.0, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
/// let grid = OccupancyGrid::new(vec![0], 1, options)?;
/// let disc = Obstacles::new([(&Shape::disc(0.5)?, Pose::new(3.0, 0.0, 0.0))])?;
/// let mut ranges = [0.0; 1];
/// cast_rays((&grid, &disc), &[[0.0, 0.0, 0.0]], 10.0, None, &mut ranges)?;
/// assert_eq!(ranges, [2.5]);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
///
/// # Errors
/// Those of [`Caster::cast_rays`]; also if `max_range` is not positive or too large for a float32, or if the kernel named by
/// [`KERNEL_VARIABLE`](super::KERNEL_VARIABLE) cannot run on this machine.
pub fn cast_rays<'a>(
    world: impl Into<World<'a>>,
    rays: &[[f64; 3]],
    max_range: f64,
    threads: Option<usize>,
    ranges: &mut [f32],
) -> Result<(), Error> {
    let World { grid, obstacles, except } = world.into();
    Caster::new(grid, max_range, Kernel::chosen()?)?.cast_rays_past((obstacles, except), rays, threads, ranges)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{GridOptions, OCCUPIED_THRESHOLD, Unknown};

    fn empty_grid() -> OccupancyGrid {
        let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
        let options = GridOptions { resolution: 0.1, origin, occupied_threshold, unknown: Unknown::Free };
        OccupancyGrid::new(vec![0; 100], 10, options).expect("a good grid")
    }

    #[test]
    fn only_kernels_that_use_free_boxes_build_them() {
        for (kernel, is_prepared) in [(Kernel::Traversal, false), (Kernel::Portable, true)] {
            let grid = empty_grid();
            let mut ranges = [0.0; 40];
            let caster = Caster::new(&grid, 5.0, kernel).expect("a range");
            caster.cast_rays(Obstacles::NONE, &[[0.5; 3]; 40], None, &mut ranges).expect("rays");
            assert_eq!((ranges, grid.is_prepared()), ([5.0; 40], is_prepared), "{}", kernel.name());
        }
    }

    #[test]
    fn the_maximum_range_is_checked() {
        for max_range in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e39] {
            let error = Caster::new(&empty_grid(), max_range, Kernel::Portable).unwrap_err().to_string();
            assert!(error.starts_with("max_range must be "), "{error}");
        }
    }

    #[test]
    fn up_to_half_a_block_is_shared() {
        let grid = empty_grid();
        let caster = Caster::new(&grid, 9.0, Kernel::Portable).expect("a range");
        for beam_count in [1_usize, 5, 31, 32, 33, 95, 129, 360, 541, 544, 1088, 1089] {
            let fans = caster.fans_per_cast(1037, beam_count.div_ceil(GROUP), 2);
            assert_eq!(fans > 1, beam_count <= 544, "{fans} fans of {beam_count} beams");
        }
    }
}
