//! All kernels in one runner, against a reference that is easy to check by reading.

mod golden;
mod maps;
mod methods;
mod random;
