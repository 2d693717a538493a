//! Motion: odometry noise.

mod noise;
