//! Gauss-Legendre quadrature of motions whose velocity is smooth.

use glam::DVec2;

use super::super::Twist;
use super::super::ramp::NODES;
use crate::pose::{Pose, rotate};

/// Largest number of pieces, so that the time is bounded.
const MOST_PIECES: f64 = 1e5;

/// Returns the number of pieces for a motion that may be divided into `pieces` of them.
pub(super) fn piece_count(pieces: f64) -> f64 {
    pieces.ceil().clamp(1.0, MOST_PIECES)
}

/// Calls `visit(time, weight)` for the nodes between two times, in increasing order. The weights add up to `to - from`.
fn for_each_node(from: f64, to: f64, mut visit: impl FnMut(f64, f64)) {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    for (node, weight) in NODES.iter().rev() {
        visit(middle - node * half, weight * half);
    }
    for (node, weight) in NODES {
        visit(middle + node * half, weight * half);
    }
}

/// Returns the integral of a vector over time from 0 to `duration`, in `count` pieces.
pub(super) fn integral<const N: usize>(duration: f64, count: f64, at: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for_each_part(duration, count, |from, to| {
        for_each_node(from, to, |time, weight| {
            for (sum, value) in sum.iter_mut().zip(at(time)) {
                *sum += weight * value;
            }
        });
    });
    sum
}

/// Returns the pose after a time in which the velocity is `twist_at(time)`, in `count` pieces.
///
/// The heading at each node is an integral of its own, from the start of the piece to the node.
pub(super) fn integrate(start: Pose, duration: f64, count: f64, twist_at: impl Fn(f64) -> Twist) -> Pose {
    let (mut moved, mut yaw) = (DVec2::ZERO, start.yaw);
    let turn = |from: f64, to: f64| {
        let mut turned = 0.0;
        for_each_node(from, to, |time, weight| turned += weight * twist_at(time).angular);
        turned
    };
    for_each_part(duration, count, |from, to| {
        for_each_node(from, to, |time, weight| {
            moved += rotate(twist_at(time).linear, yaw + turn(from, time)) * weight;
        });
        yaw += turn(from, to);
    });
    Pose { position: start.position + moved, yaw }
}

fn for_each_part(duration: f64, count: f64, mut visit: impl FnMut(f64, f64)) {
    let (mut piece, mut from) = (1.0, 0.0);
    while piece <= count {
        let to = if piece == count { duration } else { duration * (piece / count) };
        visit(from, to);
        from = to;
        piece += 1.0;
    }
}
