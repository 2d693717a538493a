"""The simulator's nodes: robot, laser scanner, map server and world server.

They use only the node interface (`nodes.interface.Node`), so they run unchanged on the in-process bus, on ROS 1 and on
ROS 2.
"""

from .future import Future
from .interface import Node, QoS
from .laser import LaserScannerSimulator
from .map_messages import from_message, to_message
from .map_server import MapFileServer, MapServer
from .robot import MobileRobotSimulator
from .transforms import TransformBuffer, TransformListener
from .world_server import WorldServer

__all__ = [
    "Future",
    "LaserScannerSimulator",
    "MapFileServer",
    "MapServer",
    "MobileRobotSimulator",
    "Node",
    "QoS",
    "TransformBuffer",
    "TransformListener",
    "WorldServer",
    "from_message",
    "to_message",
]
