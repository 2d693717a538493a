//! Numbers in groups, and functions of them that give the same bytes on every machine.

pub mod elementary;
pub mod exponential;
mod group;
pub mod normal;
pub mod sincos;

pub use group::{GROUP, Group};
