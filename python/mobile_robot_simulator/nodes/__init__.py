"""The nodes: robot, laser scanner and map server, written against one node interface.

They run unchanged on the in-process bus, on ROS 1 and on ROS 2.
"""

from .laser import LaserScannerSimulator
from .map_server import MapFileServer, MapServer
from .robot import MobileRobotSimulator

__all__ = ["LaserScannerSimulator", "MapFileServer", "MapServer", "MobileRobotSimulator"]
