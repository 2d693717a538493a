"""Starts a map server, the robot and the laser on ROS 2.

ros2 launch mobile_robot_simulator simulator.launch.py map_file:=/path/to/map.yaml
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node

PACKAGE = "mobile_robot_simulator"


def generate_launch_description() -> LaunchDescription:
    """Returns the description of the three nodes.

    `publish_map_transform` is on. All other parameters that are not in `params_file` have their defaults on ROS 2.
    """
    map_file, params_file = LaunchConfiguration("map_file"), LaunchConfiguration("params_file")
    use_sim_time, speed_factor = LaunchConfiguration("use_sim_time"), LaunchConfiguration("speed_factor")
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "map_file",
                default_value="",
                description="YAML file of the map, in the format of map_server; if empty, another node must serve the map",
            ),
            DeclareLaunchArgument(
                "params_file", default_value="/dev/null", description="parameter file, in the format of --params-file"
            ),
            DeclareLaunchArgument(
                "use_sim_time", default_value="true", description="true: the laser and the map server follow /clock"
            ),
            DeclareLaunchArgument(
                "speed_factor", default_value="1.0", description="simulated seconds per second of wall time"
            ),
            Node(
                package=PACKAGE,
                executable="map_server",
                name="map_server",
                output="screen",
                condition=IfCondition(PythonExpression(["'", map_file, "' != ''"])),
                parameters=[{"yaml_filename": map_file, "use_sim_time": use_sim_time}],
            ),
            Node(
                package=PACKAGE,
                executable="mobile_robot_simulator_node",
                name="mobile_robot_simulator_node",
                output="screen",
                parameters=[{"publish_map_transform": True, "speed_factor": speed_factor}, params_file],
            ),
            Node(
                package=PACKAGE,
                executable="laser_scanner_simulator_node",
                name="laser_scanner_simulator_node",
                output="screen",
                parameters=[{"use_sim_time": use_sim_time}, params_file],
            ),
        ]
    )
