"""Parameters with descriptors, and a callback that can refuse them."""

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.node import Node
from rclpy.parameter import Parameter


class SpeedParameters(Node):
    def __init__(self):
        super().__init__("speed_parameters")
        limits = FloatingPointRange(from_value=0.0, to_value=2.0, step=0.0)
        self.declare_parameter("max_speed", 1.0, ParameterDescriptor(description="m/s", floating_point_range=[limits]))
        self.declare_parameters("", [("frame", "odom", ParameterDescriptor(read_only=True)), ("gain", 1.0)])
        self.add_on_set_parameters_callback(self.on_set)
        try:
            self.get_parameter("missing")
        except ParameterNotDeclaredException:
            self.missing = True

    def on_set(self, params):
        for param in params:
            if param.name == "gain" and param.value <= 0.0:
                return SetParametersResult(successful=False, reason="gain must be positive")
        return SetParametersResult(successful=True)

    def try_to_set(self, name, value):
        return self.set_parameters([Parameter(name, Parameter.Type.DOUBLE, value)])[0]
