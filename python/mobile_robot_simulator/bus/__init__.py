"""Topics, services, timers and parameters in one process, on a virtual clock: the nodes' interface without ROS."""

from .bus import Bus, Publisher, Subscription
from .clock import Clock
from .node import BusNode, Client, Node
from .parameter import Parameter
from .timer import Timer

__all__ = ["Bus", "BusNode", "Client", "Clock", "Node", "Parameter", "Publisher", "Subscription", "Timer"]
