"""An isolated ROS for each test: starts nodes as processes, and talks to them through the real rospy or rclpy."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

VERSION = os.environ.get("ROS_VERSION", "")
COMMAND = [sys.executable, "-m", "mobile_robot_simulator", f"ros{VERSION}"]
TIMEOUT = 30.0
"""Seconds after which a wait fails."""
RETRY_PERIOD = 3.0
"""Seconds without a response after which a ROS 2 service is called again.

A service that has not discovered its client yet waits 0.1 s for it, and then drops the response
(github.com/ros2/rmw_fastrtps/issues/842).
"""


def find(ros_type: str) -> Any:
    """Returns the class of a message or service in the ROS installation, such as nav_msgs/msg/Odometry."""
    package, section, name = ros_type.split("/")
    return getattr(import_module(f"{package}.{section}"), name)


def seconds(stamp: Any) -> float:
    """Returns a stamp of ROS 1 or ROS 2 in seconds."""
    return stamp.secs + stamp.nsecs * 1e-9 if hasattr(stamp, "secs") else stamp.sec + stamp.nanosec * 1e-9


def wait_until(condition: Callable[[], Any], what: str, timeout: float = TIMEOUT) -> Any:
    """Waits until the condition returns a true value, and returns that value."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.01)
    raise AssertionError(f"timed out after {timeout} s waiting for {what}")


class Inbox(list[Any]):
    """The messages received on a topic, with the wall time of each [s]."""

    def __init__(self) -> None:
        self.times: list[float] = []

    def take(self, message: Any) -> None:
        self.times.append(time.time())
        self.append(message)

    def wait_for(self, count: int, timeout: float = TIMEOUT) -> None:
        """Waits for `count` more messages."""
        wanted = len(self) + count
        wait_until(lambda: len(self) >= wanted, f"{count} messages", timeout)

    def next(self, condition: Callable[[Any], Any] = lambda _: True) -> Any:
        """Waits for a new message that fulfils the condition, and returns it."""
        start = len(self)
        return wait_until(lambda: next((it for it in self[start:] if condition(it)), None), "a message")


class Process:
    """A running command, whose output goes to a file."""

    def __init__(self, arguments: list[str], environment: dict[str, str]) -> None:
        self._log = Path(tempfile.mkstemp(suffix=".log")[1])
        # Otherwise rostopic would keep its output in a buffer.
        environment = {**environment, "PYTHONUNBUFFERED": "1"}
        with self._log.open("w") as log:
            self._process = subprocess.Popen(arguments, env=environment, stdout=log, stderr=subprocess.STDOUT)

    @property
    def output(self) -> str:
        return self._log.read_text(errors="replace")

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    def cpu_seconds(self) -> float:
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def wait(self, timeout: float = TIMEOUT) -> int:
        return self._process.wait(timeout)

    def interrupt(self) -> float:
        """Sends SIGINT (Ctrl-C), and returns how long the process took to end [s]."""
        began = time.monotonic()
        self._process.send_signal(signal.SIGINT)
        self._process.wait(TIMEOUT)
        return time.monotonic() - began

    def kill(self) -> None:
        if self.running:
            self._process.kill()
        self._process.wait(TIMEOUT)


class World(ABC):
    """An isolated ROS, of either version."""

    environment: dict[str, str]

    def __init__(self) -> None:
        self.processes: list[Process] = []
        self.inboxes: list[Any] = []

    def run(self, *arguments: str, environment: dict[str, str] | None = None) -> Process:
        """Starts a command of ROS or of this package."""
        self.processes.append(Process(list(arguments), environment or self.environment))
        return self.processes[-1]

    def start(self, node: str, *, map_file: Path | None = None, remap: tuple[str, ...] = (), **parameters: Any) -> Process:
        """Starts a node with parameters."""
        maps = [str(map_file)] if map_file else []
        return self.run(*COMMAND, node, *maps, *self.arguments(parameters, remap))

    @abstractmethod
    def arguments(self, parameters: dict[str, Any], remap: tuple[str, ...]) -> list[str]: ...

    def end(self) -> None:
        for process in self.processes:
            process.kill()
        # pytest shows this output if the test fails.
        print(*(process.output for process in self.processes))


class Ros1World(World):
    """One master for all tests, because a process can only use rospy with one. `end` removes what a test has left on it."""

    _master: Process | None = None

    def __init__(self) -> None:
        super().__init__()
        import rospy

        self.rospy = rospy
        if Ros1World._master is None:
            with socket.socket() as probe:
                probe.bind(("127.0.0.1", 0))
                port = probe.getsockname()[1]
            ros_packages = filter(None, [os.environ.get("ROS_PACKAGE_PATH")])
            os.environ.update(
                ROS_MASTER_URI=f"http://127.0.0.1:{port}",
                ROS_IP="127.0.0.1",
                ROS_ROOT="/usr/share/ros",
                ROS_PACKAGE_PATH=os.pathsep.join([str(Path(__file__).parents[2]), "/usr/share", *ros_packages]),
                ROS_HOME=tempfile.mkdtemp(),
            )
            import rosgraph

            Ros1World._master = Process(["roscore", "-p", str(port)], dict(os.environ))
            wait_until(rosgraph.is_master_online, "roscore")
            rospy.init_node("test", disable_signals=True)
        self.environment = dict(os.environ)

    @classmethod
    def end_all(cls) -> None:
        if cls._master is not None:
            cls._master.interrupt()

    def arguments(self, parameters: dict[str, Any], remap: tuple[str, ...]) -> list[str]:
        return [*(f"_{name}:={value}" for name, value in parameters.items()), *remap]

    @staticmethod
    def in_namespace(name: str) -> tuple[str, ...]:
        """Returns the remapping that puts a node into a namespace."""
        return (f"__ns:=/{name}",)

    def subscribe(self, topic: str, ros_type: str, **_: Any) -> Inbox:
        inbox = Inbox()
        subscriber = self.rospy.Subscriber(topic, find(ros_type), inbox.take, buff_size=2**24, tcp_nodelay=True)
        self.inboxes.append(subscriber)
        return inbox

    def publisher(self, topic: str, ros_type: str, *, latched: bool = False, wait: bool = True) -> Callable[[Any], None]:
        publisher = self.rospy.Publisher(topic, find(ros_type), queue_size=10, latch=latched)
        self.inboxes.append(publisher)
        if wait and not latched:
            wait_until(publisher.get_num_connections, f"a subscriber to {topic}")
        return publisher.publish

    def call(self, service: str, ros_type: str, **fields: Any) -> Any:
        self.rospy.wait_for_service(service, TIMEOUT)
        return self.rospy.ServiceProxy(service, find(ros_type))(**fields)

    def count_publishers(self, topic: str) -> int:
        import rosgraph

        published, _, _ = rosgraph.Master("/test").getSystemState()
        return len(dict(published).get(topic, []))

    def set_parameter(self, node: str, name: str, value: Any) -> bool:
        """Returns whether the change was accepted."""
        key = f"/{node}/{name}"
        before = self.rospy.get_param(key, None)
        self.rospy.set_param(key, value)
        time.sleep(2.5)
        return bool(self.rospy.get_param(key) == value or before == value)

    def end(self) -> None:
        for item in self.inboxes:
            item.unregister()
        super().end()
        import rosgraph

        for name in self.rospy.get_param_names():
            if name.count("/") > 1 and not name.startswith(("/run_id", "/roslaunch")):
                try:
                    self.rospy.delete_param(name)
                except (KeyError, rosgraph.MasterException):
                    continue


class Ros2World(World):
    """A separate domain for each test. Discovery is limited to this machine."""

    _domain = os.getpid() % 50

    def __init__(self) -> None:
        super().__init__()
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        Ros2World._domain = (Ros2World._domain + 1) % 101
        os.environ["ROS_DOMAIN_ID"] = str(Ros2World._domain)
        self.environment = dict(os.environ)
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=Ros2World._domain)
        self.node = rclpy.create_node("test", context=self.context)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    @classmethod
    def end_all(cls) -> None:
        pass

    def _spin(self) -> None:
        from rclpy.executors import ExternalShutdownException

        try:
            self._executor.spin()
        except ExternalShutdownException:
            pass

    def arguments(self, parameters: dict[str, Any], remap: tuple[str, ...]) -> list[str]:
        pairs = [("-p", f"{name}:={value}") for name, value in parameters.items()] + [("-r", item) for item in remap]
        return ["--ros-args", *(word for pair in pairs for word in pair)]

    @staticmethod
    def in_namespace(name: str) -> tuple[str, ...]:
        """Returns the remapping that puts a node into a namespace."""
        return (f"__ns:=/{name}",)

    def subscribe(self, topic: str, ros_type: str, *, latched: bool = False, best_effort: bool = False) -> Inbox:
        inbox = Inbox()
        self.node.create_subscription(find(ros_type), topic, inbox.take, self.qos(latched, best_effort))
        return inbox

    @staticmethod
    def qos(latched: bool = False, best_effort: bool = False) -> Any:
        from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

        return QoSProfile(
            depth=1000,
            reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        )

    def publisher(self, topic: str, ros_type: str, *, latched: bool = False, wait: bool = True) -> Callable[[Any], None]:
        publisher = self.node.create_publisher(find(ros_type), topic, self.qos(latched))
        if wait and not latched:
            wait_until(publisher.get_subscription_count, f"a subscriber to {topic}")
        publish: Callable[[Any], None] = publisher.publish
        return publish

    def call(self, service: str, ros_type: str, **fields: Any) -> Any:
        kind = find(ros_type)
        client = self.node.create_client(kind, service)
        assert client.wait_for_service(TIMEOUT), f"{service} is not offered"
        began, futures = time.monotonic(), list[Any]()

        def response() -> Any:
            if time.monotonic() - began >= RETRY_PERIOD * len(futures):
                futures.append(client.call_async(kind.Request(**fields)))
            return next((future for future in futures if future.done()), None)

        return wait_until(response, f"a response of {service}").result()

    def count_publishers(self, topic: str) -> int:
        return int(self.node.count_publishers(topic))

    def set_parameter(self, node: str, name: str, value: Any) -> bool:
        """Returns whether the change was accepted."""
        return bool(self.try_parameter(node, name, value).successful)

    def try_parameter(self, node: str, name: str, value: Any) -> Any:
        from rclpy.parameter import Parameter

        parameter = Parameter(name, value=value).to_parameter_msg()
        return self.call(f"/{node}/set_parameters", "rcl_interfaces/srv/SetParameters", parameters=[parameter]).results[0]

    def end(self) -> None:
        super().end()
        self.context.try_shutdown()
        self._thread.join(TIMEOUT)
        self.node.destroy_node()


@contextmanager
def new_world() -> Iterator[Any]:
    """Yields an isolated ROS of the version under test."""
    world = {"1": Ros1World, "2": Ros2World}[VERSION]()
    try:
        yield world
    finally:
        world.end()
