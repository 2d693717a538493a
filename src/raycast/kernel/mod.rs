//! The jump loop, once for each instruction set. All of them give the bytes of the plain traversal.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod lanes;
mod march;
mod portable;
mod prefetch;
mod scalar;

use std::sync::LazyLock;

use super::Ray;
use super::block::{Block, fits};
use super::sink::Sink;
use super::source::{RayGroup, Source};
use super::traversal::traverse;
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::numeric::GROUP;
use lanes::Lanes;
pub use lanes::Work;

/// A way to cast rays. They differ in speed only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// The plain cell-by-cell traversal.
    Traversal,
    /// Jumps, on any processor.
    Portable,
    /// Jumps, 8 rays to a vector.
    Avx2,
    /// Jumps, 16 rays to a vector.
    Avx512,
}

/// The environment variable that names a kernel to use in place of the fastest.
pub const KERNEL_VARIABLE: &str = "MOBILE_ROBOT_SIMULATOR_KERNEL";

impl Kernel {
    /// All there are, slowest first.
    pub const ALL: [Self; 4] = [Self::Traversal, Self::Portable, Self::Avx2, Self::Avx512];

    /// The kernel that casts where none is asked for: the one that the environment variable names, or the fastest that this
    /// machine has.
    ///
    /// # Errors
    /// A name that is none, or one of a kernel that this machine cannot run.
    pub fn chosen() -> Result<Self, Error> {
        static CHOSEN: LazyLock<Result<Kernel, Error>> = LazyLock::new(|| match std::env::var(KERNEL_VARIABLE) {
            Ok(name) => Kernel::named(&name),
            Err(std::env::VarError::NotPresent) => {
                Ok(Kernel::ALL.into_iter().rfind(|kernel| kernel.is_available()).unwrap_or(Kernel::Portable))
            }
            Err(std::env::VarError::NotUnicode(name)) => Kernel::named(&name.to_string_lossy()),
        });
        CHOSEN.clone()
    }

    /// The kernel of this name.
    ///
    /// # Errors
    /// A name that is none, or one of a kernel that this machine cannot run.
    pub fn named(name: &str) -> Result<Self, Error> {
        let available = || Self::ALL.into_iter().filter(|kernel| kernel.is_available());
        available().find(|kernel| kernel.name() == name).ok_or_else(|| Error::Kernel {
            value: name.to_owned(),
            available: available().map(Self::name).collect::<Vec<_>>().join(", "),
        })
    }

    /// The name, as the environment variable takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Traversal => "traversal",
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Does some work with the kernel's instruction set.
    #[inline]
    pub(super) fn with_features(self, work: impl Work) {
        #[cfg(target_arch = "x86_64")]
        {
            if let (Self::Avx512, Some(lanes)) = (self, avx512::Avx512::new()) {
                return lanes.with_features(work);
            }
            if let (Self::Avx2, Some(lanes)) = (self, avx2::Avx2::new()) {
                return lanes.with_features(work);
            }
        }
        work.run();
    }

    /// The longest box that is no quicker to jump over than to traverse, as measured among cells that block at random.
    pub(super) fn break_even_length(self) -> i32 {
        match self {
            Self::Traversal | Self::Portable => 6,
            Self::Avx2 => 1,
            Self::Avx512 => 0,
        }
    }

    /// True if the kernel jumps over free boxes.
    pub(super) fn uses_free_boxes(self) -> bool {
        self != Self::Traversal
    }

    /// Whether this machine can run it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Traversal | Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => avx2::Avx2::new().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => avx512::Avx512::new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }
}

/// Hands over, group by group and fan by fan, the distances from the origins of rays to the boundaries by which they enter blocking
/// cells, infinite if there is none; those beyond `limit` are anything beyond it. In cells.
///
/// A kernel that this machine cannot run leaves the work to the portable one, and all but the traversal leave a grid so large that
/// int32 cannot number its bytes to a loop over single rays.
pub fn cast<S: Source>(kernel: Kernel, grid: &OccupancyGrid, source: S, limit: f64, block: &mut Block, mut sink: impl Sink) {
    if kernel == Kernel::Traversal || source.is_cluttered(grid, kernel.break_even_length()) {
        return kernel.with_features(Walk { grid, source, limit, sink });
    }
    let free_boxes = grid.free_boxes();
    if !fits(free_boxes) {
        return each(source, &mut sink, |ray| scalar::cast(free_boxes, ray, limit));
    }
    #[cfg(target_arch = "x86_64")]
    {
        if let (Kernel::Avx512, Some(lanes)) = (kernel, avx512::Avx512::new()) {
            return march::cast(lanes, free_boxes, source, limit, block, &mut sink);
        }
        if let (Kernel::Avx2, Some(lanes)) = (kernel, avx2::Avx2::new()) {
            return march::cast(lanes, free_boxes, source, limit, block, &mut sink);
        }
    }
    march::cast(portable::Portable, free_boxes, source, limit, block, &mut sink);
}

/// Traverses cell by cell.
struct Walk<'a, S, K> {
    grid: &'a OccupancyGrid,
    source: S,
    limit: f64,
    sink: K,
}

impl<S: Source, K: Sink> Work for Walk<'_, S, K> {
    #[inline(always)]
    fn run(mut self) {
        each(self.source, &mut self.sink, |ray| ray.gap + traverse(self.grid, ray, self.limit).max(0.0));
    }
}

/// Casts one ray after the other.
#[inline(always)]
fn each<S: Source>(source: S, sink: &mut impl Sink, cast: impl Fn(&Ray) -> f64) {
    let mut distances = [f64::INFINITY; GROUP];
    let groups = source.count().div_ceil(GROUP);
    for fan in 0..source.fans() {
        for group in 0..groups {
            let count = (source.count() - group * GROUP).min(GROUP);
            let rays = source.group(fan, group);
            for (place, distance) in distances[..count].iter_mut().enumerate() {
                *distance = cast(&rays.ray(place));
            }
            sink.take(fan * groups + group, &distances);
        }
    }
}
