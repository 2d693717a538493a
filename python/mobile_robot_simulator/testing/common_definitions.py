"""Definitions of common services and actions, which rosbags does not have. They are those of ROS 2 Humble."""

from __future__ import annotations

SERVICES = {
    "action_msgs/srv/CancelGoal": "action_msgs/GoalInfo goal_info\n---\n"
    "int8 ERROR_NONE=0\nint8 ERROR_REJECTED=1\nint8 ERROR_UNKNOWN_GOAL_ID=2\nint8 ERROR_GOAL_TERMINATED=3\n"
    "int8 return_code\naction_msgs/GoalInfo[] goals_canceling",
    "example_interfaces/srv/AddTwoInts": "int64 a\nint64 b\n---\nint64 sum",
    "lifecycle_msgs/srv/ChangeState": "lifecycle_msgs/Transition transition\n---\nbool success",
    "lifecycle_msgs/srv/GetState": "---\nlifecycle_msgs/State current_state",
    "nav_msgs/srv/GetPlan": "geometry_msgs/PoseStamped start\ngeometry_msgs/PoseStamped goal\nfloat32 tolerance\n---\n"
    "nav_msgs/Path plan",
    "std_srvs/srv/Empty": "---",
    "std_srvs/srv/SetBool": "bool data\n---\nbool success\nstring message",
}
"""Definitions of services by ROS type."""

ACTIONS = {
    "example_interfaces/action/Fibonacci": "int32 order\n---\nint32[] sequence\n---\nint32[] sequence",
    "nav2_msgs/action/NavigateToPose": "geometry_msgs/PoseStamped pose\nstring behavior_tree\n---\n"
    "std_msgs/Empty result\n---\n"
    "geometry_msgs/PoseStamped current_pose\nbuiltin_interfaces/Duration navigation_time\n"
    "builtin_interfaces/Duration estimated_time_remaining\nint16 number_of_recoveries\nfloat32 distance_remaining",
}
"""Definitions of actions by ROS type."""
