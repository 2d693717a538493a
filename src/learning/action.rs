//! Commands from actions.

use crate::error::{Error, check_all_finite, check_number};

/// Writes the command `[vx, vy, wz]` of each robot: for each axis the share of the largest velocity that its action asks for, cut
/// to [-1, 1].
///
/// `max_velocity` has the largest velocity \[m/s, rad/s\] along x and in rotation, or along x, along y and in rotation. `actions`
/// has as many numbers for each robot, one robot after another.
///
/// # Errors
/// - [`Error::Length`]: a list has the wrong length.
/// - [`Error::Number`]: a velocity is not positive and finite.
/// - [`Error::Element`]: an action is not finite. Nothing is written.
pub fn commands_from_actions(actions: &[f64], max_velocity: &[f64], commands: &mut [[f64; 3]]) -> Result<(), Error> {
    let width = max_velocity.len();
    if width != 2 && width != 3 {
        return Err(Error::Length { name: "max_velocity", value: width, needed: 3 });
    }
    if actions.len() != commands.len() * width {
        return Err(Error::Length { name: "actions", value: actions.len(), needed: commands.len() * width });
    }
    for &velocity in max_velocity {
        check_number("max_velocity", velocity, "positive", |velocity| velocity > 0.0)?;
    }
    check_all_finite("actions", actions, width)?;
    let axes: &[usize] = if width == 2 { &[0, 2] } else { &[0, 1, 2] };
    for (command, action) in commands.iter_mut().zip(actions.chunks_exact(width)) {
        *command = [0.0; 3];
        for ((&axis, &velocity), &share) in axes.iter().zip(max_velocity).zip(action) {
            command[axis] = share.clamp(-1.0, 1.0) * velocity;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::commands_from_actions;
    use crate::error::Error;

    fn commands(actions: &[f64], max_velocity: &[f64]) -> Result<[[f64; 3]; 2], Error> {
        let mut commands = [[9.0; 3]; 2];
        commands_from_actions(actions, max_velocity, &mut commands)?;
        Ok(commands)
    }

    #[test]
    fn an_action_is_a_share_of_the_largest_velocity() {
        let two = commands(&[0.5, -1.0, 3.0, -2.0], &[0.5, 2.0]).expect("commands");
        assert_eq!(two, [[0.25, 0.0, -2.0], [0.5, 0.0, -2.0]]);
        let three = commands(&[0.5, 0.25, -1.0, 0.0, -9.0, 9.0], &[0.5, 0.4, 2.0]).expect("commands");
        assert_eq!(three, [[0.25, 0.1, -2.0], [0.0, -0.4, 2.0]]);
    }

    #[test]
    fn bad_actions_are_errors() {
        let error =
            |actions: &[f64], max_velocity: &[f64]| commands(actions, max_velocity).expect_err("an error").to_string();
        assert_eq!(error(&[0.0; 3], &[1.0, 1.0]), "actions must have 4 elements, got 3");
        assert_eq!(error(&[0.0; 4], &[1.0, 0.0]), "max_velocity must be positive, got 0");
        assert_eq!(error(&[0.0; 8], &[1.0; 4]), "max_velocity must have 3 elements, got 4");
        assert_eq!(error(&[0.0, 0.0, f64::NAN, 0.0], &[1.0, 1.0]), "actions must be finite, got NaN in row 1");
    }
}
