"""A managed node: it makes its publisher and its timer when it is configured, and talks only while it is active."""

from rclpy.lifecycle import Node, Publisher, State, TransitionCallbackReturn
from rclpy.timer import Timer
from std_msgs.msg import String


class LifecycleTalker(Node):
    def __init__(self):
        super().__init__("lifecycle_talker")
        self._count = 0
        self._pub: Publisher | None = None
        self._timer: Timer | None = None

    def publish(self):
        self._count += 1
        self._pub.publish(String(data=f"Lifecycle HelloWorld #{self._count}"))

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        self._pub = self.create_lifecycle_publisher(String, "lifecycle_chatter", 10)
        self._timer = self.create_timer(1.0, self.publish)
        self.get_logger().info("on_configure() is called.")
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: State) -> TransitionCallbackReturn:
        self.get_logger().info("on_activate() is called.")
        return super().on_activate(state)

    def on_deactivate(self, state: State) -> TransitionCallbackReturn:
        self.get_logger().info("on_deactivate() is called.")
        return super().on_deactivate(state)

    def on_cleanup(self, state: State) -> TransitionCallbackReturn:
        self.destroy_timer(self._timer)
        self.destroy_publisher(self._pub)
        self.get_logger().info("on_cleanup() is called.")
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: State) -> TransitionCallbackReturn:
        self.get_logger().info("on_shutdown() is called.")
        return TransitionCallbackReturn.SUCCESS
