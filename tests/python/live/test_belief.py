"""Belief: where the odometry believes the robot to be."""

import math

import pytest
from sessions import robot

from mobile_robot_simulator.live.belief import Belief
from simulations import drive


def followed(simulation, belief, seconds, moves=0, step=0.02):
    """Runs a simulation and a belief. Returns the last believed pose, and whether the robot was ever moved by hand."""
    moved = False
    for _ in range(round(seconds / step)):
        simulation.run_for(step)
        pose, now_moved = belief.update(simulation.truth, simulation.latest("/odom"), moves)
        moved = moved or now_moved
    return pose, moved


def test_without_drift_the_belief_is_the_truth():
    sim, belief = robot(velocity_timeout=0), Belief()
    sim.run_for(0.01)
    belief.update(sim.truth, sim.latest("/odom"), 0)
    drive(sim, 0.4, 0.3)
    pose, moved = followed(sim, belief, 5.0)
    assert not moved
    assert tuple(pose) == pytest.approx(tuple(sim.pose), abs=1e-9)


def test_with_drift_it_is_what_the_robot_believes():
    sim, belief = robot(velocity_timeout=0, odometry_alphas=[0.1] * 6), Belief()
    drive(sim, 0.4, 0.3)
    pose, _ = followed(sim, belief, 5.0)
    apart = math.dist(tuple(pose)[:2], tuple(sim.pose)[:2])
    believed = sim.robot.believed_pose
    start_apart = math.dist(tuple(pose)[:2], tuple(sim.robot.start_pose * believed)[:2])
    assert apart > 0.1 and start_apart < 0.05  # the frames agree at the first odometry, not at the start


@pytest.mark.parametrize("known", [True, False])
def test_a_move_by_hand_places_the_frame_anew(known):
    sim, belief = robot(odometry_alphas=[0.1] * 6), Belief()
    followed(sim, belief, 1.0)
    sim.set_pose((9.0, 9.0, 1.0))
    pose, moved = followed(sim, belief, 1.0, moves=int(known))
    assert moved and tuple(pose) == pytest.approx((9.0, 9.0, 1.0), abs=1e-9)
