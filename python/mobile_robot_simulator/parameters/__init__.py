"""Parameters of the nodes: names, defaults, units, checks, and the objects of the core that are built from them."""

from .errors import unknown_name as unknown_name
from .laser import LaserParameters
from .lookup import NODES
from .lookup import check_names as check_names
from .lookup import for_node as for_node
from .model import Parameters
from .robot import RobotParameters
from .robot import motion_noise as motion_noise
from .servers import MapParameters, WorldParameters
from .values import Count as Count
from .values import Name as Name
from .values import Number as Number
from .values import Seed as Seed
from .values import is_topic_name as is_topic_name

__all__ = [
    "NODES",
    "LaserParameters",
    "MapParameters",
    "Parameters",
    "RobotParameters",
    "WorldParameters",
]
