//! From a ray to a range: the boundary at which it enters the first blocking cell.

mod block;
mod clearance;
mod kernel;
mod pages;
mod ray;
mod sector;
mod source;
mod track;
mod traversal;

use std::cell::RefCell;
use std::slice;

use glam::DVec2;

pub use clearance::Clearance;
pub use kernel::{KERNEL_VARIABLE, Kernel, Sink};
pub use ray::Ray;
pub use sector::Sector;
pub(crate) use source::{Fans, Start};
pub use source::{GROUP, Group, Places, RayGroup, Rays, Source};
pub use traversal::traverse;

use crate::elementary::directions;
use crate::error::{Error, check_number, check_rows};
use crate::grid::OccupancyGrid;
use crate::obstacles::Obstacles;
use crate::pose::Pose;
use crate::threads;
use crate::world::World;
use block::Block;
use kernel::Work;

/// Casts rays over one grid up to one range.
#[derive(Debug, Clone, Copy)]
pub struct Caster<'grid> {
    grid: &'grid OccupancyGrid,
    kernel: Kernel,
    max_range: f64,
    limit: f64,
}

impl<'grid> Caster<'grid> {
    /// A caster over `grid` up to `max_range` metres.
    #[must_use]
    pub fn new(grid: &'grid OccupancyGrid, max_range: f64, kernel: Kernel) -> Self {
        // One cell more than the range asks for: what counts is decided on the range in metres alone.
        let limit = max_range / grid.resolution() + 1.0;
        Self { grid, kernel, max_range, limit }
    }

    /// Hands over, group by group, ranges in metres, infinite where there is no return within the maximum.
    ///
    /// # Panics
    /// If the sink casts.
    pub fn cast(&self, source: impl Source, sink: impl Sink) {
        thread_local! {
            static BLOCK: RefCell<Box<Block>> = RefCell::new(Block::new());
        }
        // Before the block is taken, as building may have this thread do other work.
        self.grid.clearance();
        let sink = InMetres { resolution: self.grid.resolution(), max_range: self.max_range, sink };
        BLOCK.with_borrow_mut(|block| kernel::cast(self.kernel, self.grid, source, self.limit, block, sink));
    }

    /// How many of a number of fans, each of so many groups of rays, had best be cast at a time where so many threads share them.
    #[must_use]
    pub fn at_a_time(&self, fans: usize, groups: usize, threads: usize) -> usize {
        // What a thread needs to even out what takes longer.
        const SHARES: usize = 8;
        if self.kernel == Kernel::Traversal {
            return 1;
        }
        (block::BLOCK / GROUP / groups.max(1)).min(fans / (SHARES * threads.max(1))).clamp(1, Fans::MOST)
    }

    /// [`cast`](Self::cast) of fans, group by group and fan by fan. They may start off the grid.
    ///
    /// # Panics
    /// If the sink casts, or several fans have more groups than fit into a block.
    pub(crate) fn cast_fans(&self, fans: Fans<'_>, mut sink: impl Sink) {
        if fans.are_on_grid() && fans.are_alike(self.grid, self.kernel.not_worth_jumping()) {
            return self.cast(fans, sink);
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
            groups.resize(fan.cos.len(), RayGroup::ASTRAY);
            for (group, rays) in groups.iter_mut().enumerate() {
                let fan = fan.group(0, group);
                for place in 0..GROUP {
                    let Ray { origin, direction, .. } = fan.ray(place);
                    self.enter(rays, place, origin, direction);
                }
            }
            self.cast(Rays { groups: &groups, count: fan.count, upcoming: &[] }, sink);
        }
    }

    /// Ranges in metres of unrelated rays, each `[x, y, direction]` in the map frame, to the nearest of grid and obstacles; the
    /// maximum where there is no return.
    ///
    /// # Errors
    /// Rays that are not finite, a wrong number of `ranges`, no threads to be had.
    pub fn cast_rays(
        &self,
        obstacles: &Obstacles,
        rays: &[[f64; 3]],
        threads: Option<usize>,
        ranges: &mut [f32],
    ) -> Result<(), Error> {
        thread_local! {
            static GROUPS: RefCell<Vec<RayGroup>> = const { RefCell::new(Vec::new()) };
        }
        check_rows("rays", rays, threads)?;
        if ranges.len() != rays.len() {
            return Err(Error::Length { name: "out", value: ranges.len(), needed: rays.len() });
        }
        self.grid.prepare(threads);
        threads::for_each_chunk(threads, ranges, CHUNK, |chunk, ranges| {
            let (these, upcoming) = rays[chunk * CHUNK..].split_at(ranges.len());
            GROUPS.with_borrow_mut(|groups| {
                groups.resize(these.len().div_ceil(GROUP), RayGroup::ASTRAY);
                self.kernel.with_features(Enter { caster: self, rays: these, groups });
                let upcoming = &upcoming[..upcoming.len().min(CHUNK)];
                self.cast(Rays { groups, count: these.len(), upcoming }, UpTo { max_range: self.max_range, ranges });
            });
            if obstacles.is_empty() {
                return;
            }
            for (range, ray) in ranges.iter_mut().zip(these) {
                *range = range.min(obstacles.cast_pose(Pose::from(*ray), f64::from(*range)) as f32);
            }
        })
    }

    /// Puts rays of the map frame into a group.
    #[inline(always)]
    fn enter_all(&self, group: &mut RayGroup, rays: &[[f64; 3]; GROUP]) {
        let [x, y, dx, dy] = group.parts();
        let mut yaws = [0.0; GROUP];
        for (place, &ray) in rays.iter().enumerate() {
            let Pose { position, yaw } = self.grid.pose_in_grid(ray.into());
            let origin = position / self.grid.resolution();
            (x[place], y[place], yaws[place]) = (origin.x, origin.y, yaw);
        }
        let have_directions = directions(&yaws, dx, dy);
        if !(have_directions && group.start((self.grid.width(), self.grid.height()))) {
            let [x, y, dx, dy] = group.parts().map(|part| *part);
            *group = RayGroup::ASTRAY;
            for place in 0..GROUP {
                self.enter(group, place, DVec2::new(x[place], y[place]), DVec2::new(dx[place], dy[place]));
            }
        }
    }

    /// Puts the ray from `origin` along `direction` at a place of a group of rays astray, from where it enters the grid on.
    fn enter(&self, rays: &mut RayGroup, place: usize, origin: DVec2, direction: DVec2) {
        if let Some(ray) = Ray::entering(self.grid.width(), self.grid.height(), origin, direction) {
            rays.set(place, &ray);
        }
    }
}

/// Puts rays of the map frame into groups, and fills the last one up with its first ray.
struct Enter<'a, 'grid> {
    caster: &'a Caster<'grid>,
    rays: &'a [[f64; 3]],
    groups: &'a mut [RayGroup],
}

impl Work for Enter<'_, '_> {
    #[inline(always)]
    fn run(self) {
        let Self { caster, rays, groups } = self;
        for (group, rays) in groups.iter_mut().zip(rays.chunks(GROUP)) {
            if let Some(rays) = rays.first_chunk() {
                caster.enter_all(group, rays);
            } else {
                let mut padded = [rays[0]; GROUP];
                padded[..rays.len()].copy_from_slice(rays);
                caster.enter_all(group, &padded);
            }
        }
    }
}

/// Turns distances in cells into ranges in metres, infinite beyond the maximum.
struct InMetres<S> {
    resolution: f64,
    max_range: f64,
    sink: S,
}

impl<S: Sink> Sink for InMetres<S> {
    #[inline(always)]
    fn take(&mut self, group: usize, distances: &Group) {
        let metres = distances.map(|distance| distance * self.resolution);
        self.sink.take(group, &metres.map(|range| if range < self.max_range { range } else { f64::INFINITY }));
    }
}

/// Stores ranges as float32, the maximum where there is no return.
pub(crate) struct UpTo<'a> {
    pub max_range: f64,
    pub ranges: &'a mut [f32],
}

impl Sink for UpTo<'_> {
    #[inline(always)]
    fn take(&mut self, group: usize, ranges: &Group) {
        store(self.ranges, group, &ranges.map(|range| range.min(self.max_range)));
    }
}

/// Stores the numbers of a group as float32, as far as there is room.
#[inline(always)]
pub(crate) fn store(ranges: &mut [f32], group: usize, numbers: &Group) {
    let numbers = numbers.map(|number| number as f32);
    let rest = &mut ranges[group * GROUP..];
    if let Some(room) = rest.first_chunk_mut() {
        *room = numbers;
    } else {
        store_last(rest, &numbers);
    }
}

// Not to become one copy of unknown length with the other case.
#[cold]
#[inline(never)]
fn store_last(rest: &mut [f32], numbers: &[f32; GROUP]) {
    rest.copy_from_slice(&numbers[..rest.len()]);
}

/// [`Caster::cast_rays`] by the kernel chosen for this machine.
///
/// # Errors
/// Those, a `max_range` that is not positive or too large for a float32, a kernel asked for that this machine does not have.
pub fn cast_rays<'a>(
    world: impl Into<World<'a>>,
    rays: &[[f64; 3]],
    max_range: f64,
    threads: Option<usize>,
    ranges: &mut [f32],
) -> Result<(), Error> {
    let World { grid, obstacles } = world.into();
    check_number("max_range", max_range, "positive", |value| value > 0.0)?;
    check_number("max_range", max_range, "a float32", |value| value <= f32::MAX.into())?;
    Caster::new(grid, max_range, Kernel::chosen()?).cast_rays(obstacles, rays, threads, ranges)
}

/// Rays that one thread takes at a time.
const CHUNK: usize = 1024;
const _: () = assert!(CHUNK.is_multiple_of(GROUP) && CHUNK <= block::BLOCK);
