//! Ray casting: finds the boundary at which a ray enters the first blocking cell.
//!
//! [`Kernel::Traversal`] is the specification. The other kernels jump over the free space of the grid and give the same
//! bytes.

mod block;
mod caster;
mod coarse;
mod fans;
mod hit;
mod kernel;
mod path;
mod ray;
mod rays;
mod sink;
mod source;
mod sweep;
#[cfg(test)]
mod tests;
mod track;
mod traversal;

pub use caster::{Caster, cast_rays};
pub(crate) use coarse::CoarseBeams;
pub(crate) use fans::{Fans, Start};
pub(crate) use hit::{cell_hit, hit_of};
pub(crate) use kernel::Work;
pub use kernel::{KERNEL_VARIABLE, Kernel};
pub(crate) use path::{Beam, Path, follow};
use ray::Ray;
pub(crate) use sink::{Sink, StoreIntensities, StoreRanges, store};
pub(crate) use sweep::Sweep;
