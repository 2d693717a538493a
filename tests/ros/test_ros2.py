"""What is particular to ROS 2: /clock, QoS, parameter files, parameters of nav2_loopback_sim, and its launch file."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import time
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from scenes import record_drive
from test_nodes import LASER, MAP, NAME, ODOM, QUIET, SCAN, TF, twist
from worlds import find, seconds, wait_until

CLOCK = "rosgraph_msgs/msg/Clock"
ROOT = Path(__file__).parents[2]


def test_commands_are_stamped_by_default(world: Any) -> None:
    world.start("robot", publish_rate=50.0)
    odom = world.subscribe("/odom", ODOM)
    publish = world.publisher("/cmd_vel", "geometry_msgs/msg/TwistStamped")
    odom.wait_for(1)
    publish(find("geometry_msgs/msg/TwistStamped")(twist=twist(0.25, 0.0)))
    odom.next(lambda it: it.twist.twist.linear.x == 0.25)


def test_a_change_of_speed_does_not_make_the_clock_jump(world: Any) -> None:
    world.start("robot", publish_rate=50.0)
    clock = world.subscribe("/clock", CLOCK)
    for speed in (1.0, 4.0, 0.5, 2.0):
        assert world.set_parameter(NAME, "speed_factor", speed)
        time.sleep(0.3)
        first = len(clock)
        time.sleep(1.5)
        stamps = np.array([seconds(it.clock) for it in clock[first:]])
        walls = np.array(clock.times[first : first + len(stamps)])
        assert np.polyfit(walls - walls[0], stamps - stamps[0], 1)[0] == pytest.approx(speed, rel=0.03)
    steps = np.diff([seconds(it.clock) for it in clock])
    assert steps.min() >= 0.0
    assert np.median(steps) == pytest.approx(0.01, rel=0.05)
    assert steps.max() < 0.3
    assert not world.set_parameter(NAME, "speed_factor", 0.0)


@pytest.mark.parametrize("together", [True, False])
def test_the_laser_follows_simulated_time(world: Any, map_file: Path, together: bool) -> None:
    if together:
        world.start("all", map_file=map_file, laser_frequency=10.0, publish_rate=50.0, speed_factor=3.0, **QUIET)
    else:
        world.start("map", map_file=map_file)
        world.start("robot", publish_rate=50.0, speed_factor=3.0, publish_map_transform=True)
        world.start("laser", laser_frequency=10.0, use_sim_time=True)
    scan, clock = world.subscribe("/scan", SCAN), world.subscribe("/clock", CLOCK)
    scan.wait_for(10)
    start, began = len(scan), time.monotonic()
    time.sleep(4.0)
    assert (len(scan) - start) / (time.monotonic() - began) == pytest.approx(30.0, rel=0.1)
    assert seconds(scan[-1].header.stamp) == pytest.approx(seconds(clock[-1].clock), abs=0.3)


def test_subscribers_of_every_qos_are_compatible(world: Any, map_file: Path) -> None:
    world.start("all", map_file=map_file, **QUIET)
    for best_effort in (False, True):
        for topic, ros_type in (("/scan", SCAN), ("/odom", ODOM), ("/tf", TF), ("/clock", CLOCK)):
            world.subscribe(topic, ros_type, best_effort=best_effort).wait_for(2)
    late = world.subscribe("/map", MAP, latched=True)
    wait_until(lambda: late, "the map")


def test_parameters_of_nav2_loopback_sim_are_logged_once(world: Any, map_file: Path) -> None:
    process = world.start(
        "all",
        map_file=map_file,
        update_duration=0.02,
        odom_publish_dur=0.05,
        scan_publish_dur=0.05,
        publish_map_odom_tf=True,
        base_frame_id="base_footprint",
        scan_frame_id="base_scan",
        scan_range_min=0.1,
        scan_range_max=8.0,
        scan_angle_min=-3.1415,
        scan_angle_max=3.1415,
        scan_angle_increment=0.02617,
        scan_use_inf=False,
        scan_noise_std=0.0,
        enable_stamped_cmd_vel=False,
        laser_mount="[0.0, 0.0, 0.0]",
    )
    scan, odom = world.subscribe("/scan", SCAN), world.subscribe("/odom", ODOM)
    last = scan.next()
    assert (last.header.frame_id, last.range_max, len(last.ranges)) == ("base_scan", 8.0, 240)
    assert last.scan_time == pytest.approx(0.05)
    assert max(last.ranges) <= 8.0
    assert odom.next().child_frame_id == "base_footprint"
    world.publisher("/cmd_vel", "geometry_msgs/msg/Twist")(twist(0.25, 0.0))
    odom.next(lambda it: it.twist.twist.linear.x == 0.25)
    for name in ("update_duration", "base_frame_id", "scan_angle_min", "enable_stamped_cmd_vel"):
        assert process.output.count(f"{name} (a parameter of nav2_loopback_sim) sets") == 1
    result = world.try_parameter(LASER, "scan_range_max", 5.0)
    refusal = "scan_range_max (a parameter of nav2_loopback_sim) can only be set at startup; set laser_max_range instead"
    assert (result.successful, result.reason) == (False, refusal)


def test_the_parameter_file_of_the_guide_gives_the_defaults_of_nav2_loopback_sim(
    world: Any, map_file: Path, tmp_path: Path
) -> None:
    guide = (ROOT / "docs/guides/ros.md").read_text()
    blocks = re.findall(r"^```yaml\n(/\*\*:\n.*?)^```$", guide, re.MULTILINE | re.DOTALL)
    (text,) = (block for block in blocks if "base_scan" in block)
    file = tmp_path / "loopback.yaml"
    file.write_text(text)
    from worlds import COMMAND

    world.start("map", map_file=map_file, service_name="/map_server/map", topic_name="/unused")
    process = world.run(*COMMAND, "all", "--ros-args", "--params-file", str(file), "-p", "laser_mount:=[0.0, 0.0, 0.0]")
    scan, odom, tf = world.subscribe("/scan", SCAN), world.subscribe("/odom", ODOM), world.subscribe("/tf", TF)
    scan.wait_for(2)
    assert (scan[-1].header.frame_id, len(scan[-1].ranges)) == ("base_scan", 240)
    assert odom[-1].child_frame_id == "base_footprint"
    links = {(link.header.frame_id, link.child_frame_id) for message in tf for link in message.transforms}
    assert links == {("map", "odom"), ("odom", "base_footprint")}
    odom.wait_for(20)
    assert np.median(np.diff([seconds(it.header.stamp) for it in odom])) == pytest.approx(0.01)
    assert "unknown parameter" not in process.output


def test_a_refused_change_has_a_reason(world: Any) -> None:
    world.start("laser")
    result = world.try_parameter(LASER, "laser_beam_count", 0)
    assert (result.successful, result.reason) == (False, "laser_beam_count must be greater than or equal to 1, got 0")


def test_parameter_files_remapping_and_node_names_work(world: Any, tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text("/**:\n  ros__parameters:\n    publish_rate: 20\n    base_link_frame: shell\n")
    from worlds import COMMAND

    world.run(
        *(*COMMAND, "robot", "--ros-args", "--params-file", str(file), "-p", "odom_frame_id:=start"),
        *("-r", "odom:=/moved", "-r", "__node:=tortoise", "-r", "__ns:=/garden"),
    )
    odometry = world.subscribe("/moved", ODOM).next()
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("start", "shell")
    names = wait_until(
        lambda: ("tortoise", "/garden") in world.node.get_node_names_and_namespaces(), "the node under its name"
    )
    assert names


def test_without_a_map_file_all_has_no_map_server(world: Any) -> None:
    world.start("all")
    world.subscribe("/odom", ODOM).wait_for(1)
    wait_until(lambda: LASER in world.node.get_node_names(), "the laser")
    wait_until(lambda: "map_server" not in world.node.get_node_names(), "the end of the map server")


def test_rclpy_reads_our_recordings(tmp_path: Path, map_file: Path) -> None:
    from rclpy.serialization import deserialize_message
    from rosbags.rosbag2 import Reader

    seen: dict[str, Any] = {}
    with Reader(record_drive(map_file, tmp_path / "drive", "mcap")) as reader:
        for connection, _, data in reader.messages():
            seen[connection.topic] = deserialize_message(bytes(data), find(connection.msgtype))
    assert {"/cmd_vel", "/odom", "/scan", "/tf", "/map", "/clock"} <= set(seen)
    assert len(seen["/scan"].ranges) == 541
    assert seen["/odom"].child_frame_id == "base_link"
    assert seen["/map"].info.width == mrs.load_map(map_file).shape[1]


def test_a_workspace_installs_the_package(tmp_path: Path) -> None:
    for step in (
        ["-S", str(ROOT), "-B", str(tmp_path / "build"), f"-DCMAKE_INSTALL_PREFIX={tmp_path}"],
        ["--install", str(tmp_path / "build")],
    ):
        done = subprocess.run(["cmake", *step], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    share = tmp_path / "share" / "mobile_robot_simulator"
    ours = (ROOT / "launch" / "simulator.launch.py").read_text()
    # The second name is that of the original 2.x.
    assert {path.name: path.read_text() for path in (share / "launch").iterdir()} == {
        "simulator.launch.py": ours,
        "simulator.launch": ours,
    }
    assert (share / "package.xml").is_file()
    assert (tmp_path / "share/ament_index/resource_index/packages/mobile_robot_simulator").is_file()
    node = tmp_path / "lib" / "mobile_robot_simulator" / "laser_scanner_simulator_node"
    done = subprocess.run([node, "--ros-args", "-p", "laser_fov:=-1.0"], capture_output=True, text=True, check=False)
    assert "laser_fov must be greater than 0" in done.stderr


def load_launch_file() -> Any:
    loader = SourceFileLoader("simulator_launch", str(ROOT / "launch" / "simulator.launch.py"))
    module = ModuleType(loader.name)
    loader.exec_module(module)
    return module


def test_the_launch_file_starts_the_nodes_that_its_arguments_ask_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """PyPI has no launch_ros, so this test replaces the classes that the launch file uses."""
    values = {"map_file": "", "params_file": ""}

    def stand_in(*arguments: Any, **options: Any) -> Any:
        return SimpleNamespace(arguments=arguments, perform=lambda _: values[arguments[0]], **options)

    for name in ("launch", "launch.actions", "launch.substitutions", "launch_ros", "launch_ros.actions"):
        module: Any = ModuleType(name)
        module.LaunchContext, module.LaunchDescription = object, list
        for item in ("DeclareLaunchArgument", "LaunchConfiguration", "Node", "OpaqueFunction"):
            setattr(module, item, stand_in)
        monkeypatch.setitem(sys.modules, name, module)
    described = load_launch_file().generate_launch_description()
    defaults = {item.arguments[0]: item.default_value for item in described if hasattr(item, "default_value")}
    assert defaults == {"map_file": "", "params_file": "", "use_sim_time": "true", "speed_factor": "1.0"}
    (create_nodes,) = (item.function for item in described if hasattr(item, "function"))

    # Without a file, no empty name is given to ROS, which would warn about it.
    nodes = create_nodes(None)
    assert all(isinstance(part, dict) for node in nodes for part in node.parameters)
    assert "map_server" not in {node.executable for node in nodes}

    values.update(map_file="/map.yaml", params_file="/parameters.yaml")
    nodes = create_nodes(None)
    assert {node.executable for node in nodes} == {path.name for path in (ROOT / "scripts").iterdir()}
    assert [node.executable for node in nodes if "/parameters.yaml" not in node.parameters] == ["map_server"]
    given = {name for node in nodes for part in node.parameters if isinstance(part, dict) for name in part}
    assert given <= {name for model in _models() for name in model.model_fields} | {"use_sim_time"}


def test_ros_2_loads_the_launch_file_under_both_names(tmp_path: Path) -> None:
    """Runs where ROS 2 has launch_ros: in a distribution, not from PyPI."""
    launch = pytest.importorskip("launch")
    pytest.importorskip("launch_ros.actions")
    sources = pytest.importorskip("launch.launch_description_sources")
    for name in ("simulator.launch", "simulator.launch.py"):
        shutil.copy(ROOT / "launch" / "simulator.launch.py", tmp_path / name)
        description = sources.AnyLaunchDescriptionSource(str(tmp_path / name)).get_launch_description(launch.LaunchContext())
        names = [argument.name for argument in description.get_launch_arguments()]
        assert names == ["map_file", "params_file", "use_sim_time", "speed_factor"]


def _models() -> Any:
    from mobile_robot_simulator.ros.configuration import MODELS

    return MODELS.values()
