//! The Python functions `commands_from_actions` and `judge_steps`.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyUntypedArrayMethods, ndarray::Array2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{elements, fill, pairs, rows, shape, typed, vector};
use super::number::Argument;
use crate::memory;
use crate::{Reward, Steps, Verdicts};

/// Returns the command of each robot: the shares of the largest velocity that its action asks for, cut to [-1, 1].
///
/// Args:
///     actions: (N, 2), shares along x and in rotation, or (N, 3), along x, along y and in rotation.
///     max_velocity: As many largest velocities [m/s, rad/s].
///     out: (N, 3) float64 in C order to write the commands to; None for a new array.
///
/// Returns:
///     (N, 3) float64, rows (vx, vy, wz) [m/s, m/s, rad/s].
///
/// Raises:
///     ValueError: A shape is wrong, an action is not finite, or a velocity is not positive and finite.
///     TypeError: An argument has the wrong type or dtype.
///
/// Examples:
///     >>> import numpy as np
///     >>> from mobile_robot_simulator._core import commands_from_actions
///     >>> commands_from_actions(np.array([[0.5, -2.0]]), (0.6, 1.5))
///     array([[ 0.3,  0. , -1.5]])
#[pyfunction]
#[pyo3(signature = (actions, max_velocity, *, out = None))]
pub fn commands_from_actions<'py>(
    py: Python<'py>,
    actions: &Bound<'py, PyAny>,
    max_velocity: &Bound<'py, PyAny>,
    out: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = typed::<f64>("actions", actions)?;
    let max_velocity: Vec<f64> = elements("max_velocity", max_velocity, None)?;
    let (&[count, 2 | 3], true) = (array.shape(), array.shape().get(1) == Some(&max_velocity.len())) else {
        let (actions, velocities) = (shape(array.shape()), shape(&[max_velocity.len()]));
        let needed = "(N, 2) and (2,), or (N, 3) and (3,)";
        let text = format!("actions and max_velocity must have shapes {needed}, got {actions} and {velocities}");
        return Err(PyValueError::new_err(text));
    };
    let actions = memory::collected("the actions", array.as_array().iter().copied())?;
    fill(py, out, &[count, 3], |commands: &mut [f64]| {
        crate::commands_from_actions(&actions, &max_velocity, commands.as_chunks_mut().0)
    })
}

/// Rewards, their parts, whether each robot is at its goal, and whether its time is over.
type Judgement<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<bool>>);

/// Returns what a step of each of some robots on their ways to goals is worth.
///
/// Args:
///     before: (N, 2), distance [m] and bearing [rad] of each robot's goal before the step, as from `Fleet.relative`.
///     after: (N, 2), the same after the step.
///     contacts: (N,) bool, whether each robot touched something.
///     velocities: (N, 3), rows (vx, vy, wz) after the step [m/s, m/s, rad/s].
///     elapsed: (N,) int64, number of steps of the episode of each robot, with this one.
///     duration: Duration of the step [s].
///     weights: Five weights: for each metre of progress, for the goal, for a contact, for each second, and for each radian turned.
///     goal_radius: Distance at which a robot is at its goal, unless it touches something [m].
///     step_limit: Number of steps after which the time of an episode is over.
///
/// Returns:
///     The rewards, (N,) float64; their parts in the order of the weights, (5, N) float64; whether each robot is at its goal, (N,)
///     bool; and whether its time is over, (N,) bool, false for episodes that have ended otherwise.
///
/// Raises:
///     ValueError: A shape is wrong, a weight is not finite, or the duration or the radius is not positive.
///     TypeError: An argument has the wrong type or dtype.
///     OverflowError: `step_limit` is too large.
///
/// Examples:
///     >>> import numpy as np
///     >>> from mobile_robot_simulator._core import judge_steps
///     >>> rewards, parts, reached, truncated = judge_steps(
///     ...     before=np.array([[1.0, 0.0]]),
///     ...     after=np.array([[0.25, 0.0]]),
///     ...     contacts=np.array([False]),
///     ...     velocities=np.zeros((1, 3)),
///     ...     elapsed=np.array([7]),
///     ...     duration=0.5,
///     ...     weights=(1.0, 10.0, -10.0, -0.5, 0.0),
///     ...     goal_radius=0.3,
///     ...     step_limit=600,
///     ... )
///     >>> rewards, parts[:, 0], reached, truncated
///     (array([10.5]), array([ 0.75, 10.  ,  0.  , -0.25,  0.  ]), array([ True]), array([False]))
#[pyfunction]
#[pyo3(signature = (*, before, after, contacts, velocities, elapsed, duration, weights, goal_radius, step_limit))]
#[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
pub fn judge_steps<'py>(
    py: Python<'py>,
    before: &Bound<'py, PyAny>,
    after: &Bound<'py, PyAny>,
    contacts: &Bound<'py, PyAny>,
    velocities: &Bound<'py, PyAny>,
    elapsed: &Bound<'py, PyAny>,
    duration: Argument<f64>,
    weights: Argument<[f64; Reward::PARTS]>,
    goal_radius: Argument<f64>,
    step_limit: i64,
) -> PyResult<Judgement<'py>> {
    const WHAT: &str = "the rewards";
    let [progress, goal, contact, time, turning] = weights.named("weights")?;
    let (before, after) = (pairs("before", before, None)?, pairs("after", after, None)?);
    let contacts: Vec<bool> = elements("contacts", contacts, None)?;
    let velocities = rows("velocities", velocities, None)?;
    let elapsed: Vec<i64> = elements("elapsed", elapsed, None)?;
    let steps = Steps {
        before: &before,
        after: &after,
        contacts: &contacts,
        velocities: &velocities,
        elapsed: &elapsed,
        duration: duration.named("duration")?,
    };
    let count = before.len();
    let mut rewards = memory::filled(WHAT, 0.0, count)?;
    let mut parts = memory::filled(WHAT, 0.0, Reward::PARTS * count)?;
    let (mut reached, mut truncated) = (memory::filled(WHAT, false, count)?, memory::filled(WHAT, false, count)?);
    let verdicts = Verdicts { rewards: &mut rewards, parts: &mut parts, reached: &mut reached, truncated: &mut truncated };
    let reward = Reward { progress, goal, contact, time, turning };
    reward.judge(steps, goal_radius.named("goal_radius")?, step_limit, verdicts)?;
    let parts = Array2::from_shape_vec((Reward::PARTS, count), parts).expect("a row for each part");
    Ok((vector(py, rewards), parts.into_pyarray(py), vector(py, reached), vector(py, truncated)))
}
