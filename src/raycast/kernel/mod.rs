//! The jump loop, once for each instruction set. All of them give the bytes of the plain traversal.

pub mod portable;
