"""Takes the map, which is latched, and counts its walls."""

from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy


class MapListener(Node):
    def __init__(self):
        super().__init__("map_listener")
        qos = QoSProfile(history=QoSHistoryPolicy.KEEP_LAST, depth=1)
        qos.reliability = QoSReliabilityPolicy.RELIABLE
        qos.durability = QoSDurabilityPolicy.TRANSIENT_LOCAL
        self.create_subscription(OccupancyGrid, "/map", self.on_map, qos)
        self.walls = None

    def on_map(self, msg):
        self.walls = sum(1 for cell in msg.data if cell == 100)
