//! Casting: every method goes through the same runner, and the reference too simple to be wrong goes first.

mod golden;
mod maps;
mod methods;
mod random;
