//! The reward of a robot on its way to a goal.

use crate::error::{Error, check_finite, check_number};

/// What a step of a robot on its way to a goal is worth: the weights of the parts of its reward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reward {
    /// For each metre by which the goal came nearer.
    pub progress: f64,
    /// For reaching the goal.
    pub goal: f64,
    /// For touching something.
    pub contact: f64,
    /// For each second of the step.
    pub time: f64,
    /// For each radian turned.
    pub turning: f64,
}

/// What some robots did in a step; an element for each robot.
#[derive(Debug, Clone, Copy)]
pub struct Steps<'a> {
    /// Distance \[m\] and bearing \[rad\] of the goal before the step.
    pub before: &'a [[f64; 2]],
    /// The same after the step.
    pub after: &'a [[f64; 2]],
    /// True for a robot that touched something.
    pub contacts: &'a [bool],
    /// Velocity `[vx, vy, wz]` after the step \[m/s, m/s, rad/s\].
    pub velocities: &'a [[f64; 3]],
    /// Number of steps of the episode, with this one.
    pub elapsed: &'a [i64],
    /// Duration of the step \[s\].
    pub duration: f64,
}

/// What some steps are worth, to be written; an element for each robot.
#[derive(Debug)]
pub struct Verdicts<'a> {
    /// The rewards.
    pub rewards: &'a mut [f64],
    /// The parts of the rewards: part `k` of robot `i` of N, in the order of the fields of [`Reward`], at `k * N + i`.
    pub parts: &'a mut [f64],
    /// True for a robot at its goal.
    pub reached: &'a mut [bool],
    /// True for a robot whose time is over, and whose episode has not ended otherwise.
    pub truncated: &'a mut [bool],
}

impl Reward {
    /// Number of parts.
    pub const PARTS: usize = 5;

    /// Judges the steps of some robots.
    ///
    /// A robot is at its goal within `goal_radius` \[m\] if it touches nothing. The time of an episode is over after `step_limit`
    /// steps. A robot that turned at the rate `wz` during the whole step turned by `|wz| * duration`.
    ///
    /// # Errors
    /// - [`Error::Number`]: a weight is not finite, or the radius or the duration is not positive and finite.
    /// - [`Error::Length`]: a list has the wrong length.
    pub fn judge(&self, steps: Steps<'_>, goal_radius: f64, step_limit: i64, verdicts: Verdicts<'_>) -> Result<(), Error> {
        let Self { progress, goal, contact, time, turning } = *self;
        let Steps { before, after, contacts, velocities, elapsed, duration } = steps;
        let Verdicts { rewards, parts, reached, truncated } = verdicts;
        for (name, weight) in
            [("progress", progress), ("goal", goal), ("contact", contact), ("time", time), ("turning", turning)]
        {
            check_finite(name, weight)?;
        }
        for (name, number) in [("goal_radius", goal_radius), ("duration", duration)] {
            check_number(name, number, "positive", |number| number > 0.0)?;
        }
        let count = before.len();
        let lengths = [
            ("after", after.len()),
            ("contacts", contacts.len()),
            ("velocities", velocities.len()),
            ("elapsed", elapsed.len()),
            ("rewards", rewards.len()),
            ("reached", reached.len()),
            ("truncated", truncated.len()),
        ];
        for (name, value) in lengths {
            if value != count {
                return Err(Error::Length { name, value, needed: count });
            }
        }
        if parts.len() != Self::PARTS * count {
            return Err(Error::Length { name: "parts", value: parts.len(), needed: Self::PARTS * count });
        }
        for robot in 0..count {
            let [[distance_before, _], [distance, _]] = [before[robot], after[robot]];
            reached[robot] = distance <= goal_radius && !contacts[robot];
            truncated[robot] = elapsed[robot] >= step_limit && !reached[robot] && !contacts[robot];
            let of_robot = [
                (distance_before - distance) * progress,
                if reached[robot] { goal } else { 0.0 },
                if contacts[robot] { contact } else { 0.0 },
                time * duration,
                velocities[robot][2].abs() * (turning * duration),
            ];
            rewards[robot] = of_robot.into_iter().reduce(|sum, part| sum + part).unwrap_or_default();
            for (part, value) in of_robot.into_iter().enumerate() {
                parts[part * count + robot] = value;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Reward, Steps, Verdicts};
    use crate::error::Error;

    const REWARD: Reward = Reward { progress: 2.0, goal: 10.0, contact: -5.0, time: -0.5, turning: -0.25 };
    const STEPS: Steps<'_> = Steps {
        before: &[[3.0, 0.0], [1.0, 0.5], [1.0, 0.5]],
        after: &[[2.5, 0.0], [0.25, 0.5], [0.25, 0.5]],
        contacts: &[false, false, true],
        velocities: &[[1.0, 0.0, -4.0], [0.0; 3], [0.0; 3]],
        elapsed: &[7, 7, 7],
        duration: 0.5,
    };

    /// Rewards, parts, who is at the goal, and whose time is over.
    type Verdict = ([f64; 3], [f64; 15], [bool; 3], [bool; 3]);

    fn judge(reward: Reward, steps: Steps<'_>, goal_radius: f64) -> Result<Verdict, Error> {
        let (mut rewards, mut parts, mut reached, mut truncated) = ([9.0; 3], [9.0; 15], [true; 3], [true; 3]);
        let verdicts =
            Verdicts { rewards: &mut rewards, parts: &mut parts, reached: &mut reached, truncated: &mut truncated };
        reward.judge(steps, goal_radius, 8, verdicts)?;
        Ok((rewards, parts, reached, truncated))
    }

    #[test]
    fn parts_have_their_weights() {
        let (rewards, parts, reached, _) = judge(REWARD, STEPS, 0.25).expect("a verdict");
        assert_eq!(
            parts,
            [1.0, 1.5, 1.5, 0.0, 10.0, 0.0, 0.0, 0.0, -5.0, -0.25, -0.25, -0.25, -0.5, -0.0, -0.0],
            "progress, goal, contact, time, turning of three robots"
        );
        assert_eq!(rewards, [0.25, 11.25, -3.75]);
        assert_eq!(reached, [false, true, false], "the second is just at the goal, the third touches something");
    }

    #[test]
    fn time_ends_only_episodes_that_nothing_else_ends() {
        let (.., truncated) = judge(REWARD, Steps { elapsed: &[8, 8, 8], ..STEPS }, 0.25).expect("a verdict");
        assert_eq!(truncated, [true, false, false]);
        let (.., truncated) = judge(REWARD, STEPS, 0.25).expect("a verdict");
        assert_eq!(truncated, [false; 3]);
    }

    #[test]
    fn bad_numbers_and_lengths_are_errors() {
        let error = |reward, steps, radius| judge(reward, steps, radius).expect_err("an error").to_string();
        assert_eq!(error(Reward { time: f64::NAN, ..REWARD }, STEPS, 1.0), "time must be finite, got NaN");
        assert_eq!(error(REWARD, STEPS, 0.0), "goal_radius must be positive, got 0");
        assert_eq!(error(REWARD, Steps { duration: -1.0, ..STEPS }, 1.0), "duration must be positive, got -1");
        let short = Steps { contacts: &[false], ..STEPS };
        assert_eq!(error(REWARD, short, 1.0), "contacts must have 3 elements, got 1");
    }
}
