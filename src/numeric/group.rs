//! Groups of numbers, one number for each ray of a group of rays.

/// Number of rays in a group. A fixed length lets the compiler vectorise loops over a group.
pub const GROUP: usize = 32;

/// One number for each ray of a group.
pub type Group = [f64; GROUP];
