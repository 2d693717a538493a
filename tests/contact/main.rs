//! Contact: cases worked out by hand, and random drives compared with an oracle that takes small steps.

mod corners;
mod motion;
mod oracle;
mod worked;
