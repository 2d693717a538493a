//! Contact: worked cases, and drives at random against small steps of an oracle.

mod motion;
mod oracle;
mod worked;
