//! Where an obstacle is over time.

use crate::error::{Error, check_finite};
use crate::pose::Pose;

/// Where an obstacle is over time, in the map frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Times \[s\], which increase, and poses.
    waypoints: Vec<(f64, Pose)>,
}

impl Trajectory {
    /// Returns the trajectory of an obstacle that stands at a pose.
    #[must_use]
    pub fn standing(pose: Pose) -> Self {
        Self { waypoints: vec![(0.0, pose)] }
    }

    /// Returns the trajectory through waypoints `[time, x, y, yaw]` \[s, m, m, rad\], with x, y and yaw interpolated linearly. The
    /// obstacle stands at the first one before its time, and at the last one after its time.
    ///
    /// # Errors
    /// - [`Error::Count`]: there is no waypoint.
    /// - [`Error::Number`]: a number is not finite.
    /// - [`Error::Times`]: the times do not increase.
    pub fn new(waypoints: &[[f64; 4]]) -> Result<Self, Error> {
        if waypoints.is_empty() {
            return Err(Error::Count { name: "the number of waypoints", value: 0, needed: "at least 1" });
        }
        let checked = |&[time, x, y, yaw]: &[f64; 4]| Ok((check_finite("time", time)?, Pose::new(x, y, yaw).checked()?));
        let waypoints: Vec<(f64, Pose)> = waypoints.iter().map(checked).collect::<Result<_, Error>>()?;
        if let Some(row) = (1..waypoints.len()).find(|&row| waypoints[row].0 <= waypoints[row - 1].0) {
            return Err(Error::Times { row, times: [waypoints[row - 1].0, waypoints[row].0] });
        }
        Ok(Self { waypoints })
    }

    /// Returns true if the obstacle never moves.
    #[must_use]
    pub fn is_standing(&self) -> bool {
        self.waypoints.len() == 1
    }

    /// Returns the waypoints `[time, x, y, yaw]` \[s, m, m, rad\].
    #[must_use]
    pub fn waypoints(&self) -> impl ExactSizeIterator<Item = [f64; 4]> {
        self.waypoints.iter().map(|&(time, Pose { position, yaw })| [time, position.x, position.y, yaw])
    }

    /// Returns the length of the path \[m\] between two times \[s\], or more.
    #[must_use]
    pub fn travel(&self, from: f64, to: f64) -> f64 {
        let parts =
            self.waypoints.windows(2).skip(self.waypoints.partition_point(|&(time, _)| time <= from).saturating_sub(1));
        let parts = parts.take_while(|parts| parts[0].0 < to);
        let length = |parts: &[(f64, Pose)]| {
            let ((start, first), (end, last)) = (parts[0], parts[1]);
            first.position.distance(last.position) * ((to.min(end) - from.max(start)) / (end - start)).clamp(0.0, 1.0)
        };
        // More, so that it does not fall short by a rounding error.
        parts.map(length).sum::<f64>() * (1.0 + 1e-9)
    }

    /// Returns the pose at a time \[s\].
    #[must_use]
    pub fn pose_at(&self, time: f64) -> Pose {
        let after = self.waypoints.partition_point(|waypoint| waypoint.0 <= time);
        if after == 0 || after == self.waypoints.len() {
            return self.waypoints[after.saturating_sub(1)].1;
        }
        let ((first_time, first), (last_time, last)) = (self.waypoints[after - 1], self.waypoints[after]);
        let share = (time - first_time) / (last_time - first_time);
        Pose {
            position: first.position + share * (last.position - first.position),
            yaw: first.yaw + share * (last.yaw - first.yaw),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_between_two_times_is_that_of_many_small_steps() {
        let way = Trajectory::new(&[[1.0, 0.0, 0.0, 0.0], [2.0, 3.0, 4.0, 1.0], [4.0, 3.0, 4.0, 0.0], [5.0, 3.0, 0.0, 0.0]]);
        let way = way.expect("waypoints");
        let stepped = |from: f64, to: f64| {
            let at = |step: u32| way.pose_at(from + (to - from) * f64::from(step) / 10_000.0).position;
            (0..10_000).map(|step| at(step).distance(at(step + 1))).sum::<f64>()
        };
        for from in [0.0, 1.0, 1.3, 2.0, 3.0, 4.5, 5.0, 9.0] {
            for to in [0.5, 1.0, 1.7, 3.9, 4.0, 4.7, 5.0, 6.0].into_iter().filter(|&to| to >= from) {
                assert!((way.travel(from, to) - stepped(from, to)).abs() < 2e-3, "{from} {to}");
            }
        }
        assert_eq!(way.travel(2.0, 4.0), 0.0);
        assert_eq!(Trajectory::standing(Pose::default()).travel(0.0, 9.0), 0.0);
    }
}
