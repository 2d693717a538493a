"""move_base with the local planner DWA (ros-planning/navigation) drives the robot to goals, localized by AMCL."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mobile_robot_simulator as mrs
from localizer import start_localized
from office import ROBOT_RADIUS, START, distance_between, save_office
from test_nodes import pose_message
from workspace import client_environment, find_program
from worlds import find, wait_until

GOALS = (mrs.Pose(27.0, 6.5, 0.0), mrs.Pose(34.0, 12.0, 1.57), mrs.Pose(29.0, 19.0, 3.14), mrs.Pose(20.6, 15.5, -1.57))
"""Along two corridors, up a third one, and through a door into an office."""
SCAN_SOURCE = {"data_type": "LaserScan", "topic": "/scan", "marking": True, "clearing": True, "inf_is_valid": True}
COSTMAP = {
    "robot_radius": ROBOT_RADIUS,
    "update_frequency": 5.0,
    "transform_tolerance": 0.5,
    "inflation_layer": {"inflation_radius": 0.5, "cost_scaling_factor": 5.0},
    "obstacle_layer": {"observation_sources": "scan", "scan": SCAN_SOURCE},
}
LAYERS = {
    "static": {"name": "static_layer", "type": "costmap_2d::StaticLayer"},
    "obstacles": {"name": "obstacle_layer", "type": "costmap_2d::ObstacleLayer"},
    "inflation": {"name": "inflation_layer", "type": "costmap_2d::InflationLayer"},
}
MOVE_BASE = {
    "base_global_planner": "navfn/NavfnROS",
    "base_local_planner": "dwa_local_planner/DWAPlannerROS",
    "controller_frequency": 10.0,
    "global_costmap": {
        **COSTMAP,
        "global_frame": "map",
        "robot_base_frame": "base_link",
        "plugins": [LAYERS["static"], LAYERS["obstacles"], LAYERS["inflation"]],
    },
    "local_costmap": {
        **COSTMAP,
        "global_frame": "odom",
        "robot_base_frame": "base_link",
        "rolling_window": True,
        "width": 5.0,
        "height": 5.0,
        "resolution": 0.05,
        "plugins": [LAYERS["obstacles"], LAYERS["inflation"]],
    },
    "DWAPlannerROS": {
        "min_vel_x": 0.0,
        "max_vel_x": 0.5,
        "min_vel_y": 0.0,
        "max_vel_y": 0.0,
        "min_vel_trans": 0.05,
        "max_vel_trans": 0.5,
        "min_vel_theta": 0.2,
        "max_vel_theta": 1.0,
        "acc_lim_x": 2.5,
        "acc_lim_y": 0.0,
        "acc_lim_theta": 3.2,
        "xy_goal_tolerance": 0.15,
        "yaw_goal_tolerance": 0.25,
        "latch_xy_goal_tolerance": True,
        "sim_time": 1.5,
        "vx_samples": 10,
        "vy_samples": 1,
        "vth_samples": 20,
        "path_distance_bias": 32.0,
        "goal_distance_bias": 20.0,
        "occdist_scale": 0.02,
    },
}
SUCCEEDED = 3
"""Status of a goal that was reached (actionlib_msgs/GoalStatus)."""
ENDED = {2, 3, 4, 5, 8}
"""Statuses of goals that are not pursued any more."""


def test_move_base_reaches_goals_without_contact(world: Any, tmp_path: Path) -> None:
    move_base = find_program("move_base", "move_base")
    map_file = save_office(tmp_path)
    office = start_localized(world, map_file, START, mrs.Pose())
    world.rospy.set_param("/move_base", MOVE_BASE)
    world.run(move_base, "__name:=move_base", environment=client_environment(world.environment))

    status = world.subscribe("move_base/status", "actionlib_msgs/msg/GoalStatusArray")
    send = world.publisher("move_base_simple/goal", "geometry_msgs/msg/PoseStamped")
    status.wait_for(3)
    errors = []
    for sent, goal in enumerate(GOALS, start=1):
        message = find("geometry_msgs/msg/PoseStamped")()
        message.header.frame_id = "map"
        message.pose = pose_message(*goal).pose.pose
        began = world.rospy.Time.now()
        send(message)

        def result(began: Any = began) -> int | None:
            new = [it.status for it in status[-1].status_list if it.goal_id.stamp >= began]
            return new[-1] if new and new[-1] in ENDED else None

        ended_with = wait_until(result, f"the end of goal {sent}", 60.0)
        errors.append(distance_between(office.pose, goal))
        print(f"move_base: goal {sent} ended with status {ended_with}, {errors[-1]:.3f} m away")
        assert ended_with == SUCCEEDED
        assert errors[-1] < 0.3
    print(f"move_base: {len(errors)} goals, largest error {max(errors):.3f} m; odometry {office.odometry_error():.2f} m")
    assert not office.touches_walls(mrs.load_map(map_file), 0.02)
