"""Starts a map server, the robot and the laser on ROS 2.

ros2 launch mobile_robot_simulator simulator.launch.py map_file:=/path/to/map.yaml
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

PACKAGE = "mobile_robot_simulator"


def generate_launch_description() -> LaunchDescription:
    """Returns the description of the three nodes.

    `publish_map_transform` is on. All other parameters that are not in `params_file` have their defaults on ROS 2.
    """
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "map_file",
                default_value="",
                description="YAML file of the map, in the format of map_server; if empty, another node must serve the map",
            ),
            DeclareLaunchArgument(
                "params_file", default_value="", description="parameter file, in the format of --params-file; empty for none"
            ),
            DeclareLaunchArgument(
                "use_sim_time", default_value="true", description="true: the laser and the map server follow /clock"
            ),
            DeclareLaunchArgument(
                "speed_factor", default_value="1.0", description="simulated seconds per second of wall time"
            ),
            OpaqueFunction(function=create_nodes),
        ]
    )


def create_nodes(context: LaunchContext) -> list[Node]:
    """Returns the nodes. Without a map file there is no map server."""
    use_sim_time, speed_factor = LaunchConfiguration("use_sim_time"), LaunchConfiguration("speed_factor")
    map_file, params_file = (LaunchConfiguration(name).perform(context) for name in ("map_file", "params_file"))
    # ROS warns about a parameter file that is empty.
    files = [params_file] if params_file else []
    robot = create_node(
        "mobile_robot_simulator_node", [{"publish_map_transform": True, "speed_factor": speed_factor}, *files]
    )
    laser = create_node("laser_scanner_simulator_node", [{"use_sim_time": use_sim_time}, *files])
    if not map_file:
        return [robot, laser]
    return [create_node("map_server", [{"yaml_filename": map_file, "use_sim_time": use_sim_time}]), robot, laser]


def create_node(name: str, parameters: list[object]) -> Node:
    """Returns a node, whose executable has the same name."""
    return Node(package=PACKAGE, executable=name, name=name, output="screen", parameters=parameters)
