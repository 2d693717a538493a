//! Kernels: methods of casting rays. All of them give the same bytes.
//!
//! The plain traversal is the specification. Each of the others runs a jump loop, compiled for one instruction set: a ray
//! jumps from free box to free box until it enters a blocking cell.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod dense;
mod gaps;
mod lanes;
mod march;
mod portable;
#[cfg(target_arch = "x86_64")]
mod processor;
mod scalar;

use super::Ray;
use super::block::{Block, fits};
use super::sink::Sink;
use super::source::{RayGroup, Source};
use super::traversal::traverse;
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::lazy::Lazy;
use crate::numeric::GROUP;
pub use dense::Dense;
#[cfg(target_arch = "x86_64")]
use lanes::Lanes;
pub use lanes::Work;

/// A method of casting rays. Kernels differ in speed only: all give the same bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// The plain traversal, cell by cell. Needs no free boxes.
    Traversal,
    /// Jumps over free boxes, on any processor.
    Portable,
    /// Jumps with vectors of 8 rays. Needs AVX2.
    Avx2,
    /// Jumps with vectors of 16 rays. Needs AVX-512.
    Avx512,
    /// The same, with the gather instruction of AVX-512, which only some processors run fast.
    Avx512Gather,
}

/// Environment variable that names the kernel to use instead of the fastest one.
pub const KERNEL_VARIABLE: &str = "MOBILE_ROBOT_SIMULATOR_KERNEL";

impl Kernel {
    /// All kernels. Each is usually faster than those before it; the last one only on some processors.
    pub const ALL: [Self; 5] = [Self::Traversal, Self::Portable, Self::Avx2, Self::Avx512, Self::Avx512Gather];

    /// Returns the default kernel: the one named by [`KERNEL_VARIABLE`], else the fastest that this machine can run.
    ///
    /// The variable is read once for each process.
    ///
    /// # Errors
    /// [`Error::Kernel`]: the name is unknown, or this machine cannot run that kernel.
    pub fn chosen() -> Result<Self, Error> {
        static CHOSEN: Lazy<Kernel> = Lazy::new();
        let choose = || match std::env::var(KERNEL_VARIABLE) {
            Ok(name) => Kernel::named(&name),
            Err(std::env::VarError::NotPresent) => {
                let fastest = Kernel::ALL.into_iter().rfind(|kernel| kernel.is_available() && kernel.is_fast());
                Ok(fastest.unwrap_or(Kernel::Portable))
            }
            Err(std::env::VarError::NotUnicode(name)) => Kernel::named(&name.to_string_lossy()),
        };
        CHOSEN.get_or_build(choose).copied()
    }

    /// Returns the kernel with this name.
    ///
    /// # Errors
    /// [`Error::Kernel`]: the name is unknown, or this machine cannot run that kernel.
    pub fn named(name: &str) -> Result<Self, Error> {
        let available = || Self::ALL.into_iter().filter(|kernel| kernel.is_available());
        available().find(|kernel| kernel.name() == name).ok_or_else(|| Error::Kernel {
            value: name.to_owned(),
            available: available().map(Self::name).collect::<Vec<_>>().join(", "),
        })
    }

    /// Returns the name of the kernel: `traversal`, `portable`, `avx2`, `avx512` or `avx512-gather`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Traversal => "traversal",
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Avx512Gather => "avx512-gather",
        }
    }

    /// Runs work with the instruction set of the kernel enabled.
    #[inline]
    pub(crate) fn with_features(self, work: impl Work) {
        #[cfg(target_arch = "x86_64")]
        {
            if let (Self::Avx512 | Self::Avx512Gather, Some(lanes)) = (self, avx512::Avx512::<false>::new()) {
                return lanes.with_features(work);
            }
            if let (Self::Avx2, Some(lanes)) = (self, avx2::Avx2::new()) {
                return lanes.with_features(work);
            }
        }
        work.run();
    }

    /// Returns the length of free boxes \[cells\] up to which jumps are no faster than the plain traversal. Measured on
    /// grids whose cells block at random.
    pub(super) fn break_even_length(self) -> i32 {
        match self {
            Self::Traversal | Self::Portable => 6,
            Self::Avx2 => 1,
            Self::Avx512 | Self::Avx512Gather => 0,
        }
    }

    /// Returns true if the kernel is faster on this processor than those before it in [`ALL`](Self::ALL).
    fn is_fast(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512Gather => processor::gathers_fast(),
            _ => true,
        }
    }

    /// Returns true if the kernel jumps over free boxes.
    pub(super) fn uses_free_boxes(self) -> bool {
        self != Self::Traversal
    }

    /// Returns true if this machine can run the kernel.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Traversal | Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => avx2::Avx2::new().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 | Self::Avx512Gather => avx512::Avx512::<false>::new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 | Self::Avx512Gather => false,
        }
    }
}

/// Sends each group's hit distances \[cells\] to the sink, fan by fan; infinite if a ray hits nothing. Beyond `limit` the
/// value is unspecified but larger than it.
///
/// In clutter, where jumps gain nothing, every kernel uses the plain traversal. A kernel that this machine cannot run is
/// replaced by the portable one. On a grid that is too large for int32 indices, rays are cast one at a time.
pub fn cast<S: Source>(
    kernel: Kernel,
    grid: &OccupancyGrid,
    source: S,
    limit: f64,
    buffers: &mut (Box<Block>, Dense),
    mut sink: impl Sink,
) {
    if kernel == Kernel::Traversal || source.is_cluttered(grid, kernel.break_even_length()) {
        return kernel.with_features(Traverse { grid, source, limit, sink });
    }
    let free_boxes = grid.free_boxes();
    if !fits(free_boxes) {
        return cast_each(source, &mut sink, |ray| scalar::cast(free_boxes, ray, limit));
    }
    #[cfg(target_arch = "x86_64")]
    {
        if let (Kernel::Avx512Gather, Some(lanes)) = (kernel, avx512::Avx512::<true>::new()) {
            return march::cast(lanes, free_boxes, source, limit, buffers, &mut sink);
        }
        if let (Kernel::Avx512, Some(lanes)) = (kernel, avx512::Avx512::<false>::new()) {
            return march::cast(lanes, free_boxes, source, limit, buffers, &mut sink);
        }
        if let (Kernel::Avx2, Some(lanes)) = (kernel, avx2::Avx2::new()) {
            return march::cast(lanes, free_boxes, source, limit, buffers, &mut sink);
        }
    }
    march::cast(portable::Portable, free_boxes, source, limit, buffers, &mut sink);
}

/// Casts all rays by the plain traversal.
struct Traverse<'a, S, K> {
    grid: &'a OccupancyGrid,
    source: S,
    limit: f64,
    sink: K,
}

impl<S: Source, K: Sink> Work for Traverse<'_, S, K> {
    #[inline(always)]
    fn run(mut self) {
        cast_each(self.source, &mut self.sink, |ray| ray.gap + traverse(self.grid, ray, self.limit).max(0.0));
    }
}

/// Casts one ray after the other.
#[inline(always)]
fn cast_each<S: Source>(source: S, sink: &mut impl Sink, cast: impl Fn(&Ray) -> f64) {
    let mut distances = [f64::INFINITY; GROUP];
    let groups = source.count().div_ceil(GROUP);
    for fan in 0..source.fans() {
        for group in 0..groups {
            let count = (source.count() - group * GROUP).min(GROUP);
            let rays = source.group(fan, group);
            for (slot, distance) in distances[..count].iter_mut().enumerate() {
                *distance = cast(&rays.ray(slot));
            }
            sink.take(fan * groups + group, &distances);
        }
    }
}
