"""A service, a node that awaits it in an async timer, and one that asks it in its constructor."""

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from std_srvs.srv import SetBool


class Dock(Node):
    def __init__(self):
        super().__init__("dock")
        self.srv = self.create_service(SetBool, "dock", self.on_dock)
        self.docked = False

    def on_dock(self, request, response):
        self.docked = request.data
        response.success = True
        response.message = "docked" if request.data else "undocked"
        return response


class AsyncDocker(Node):
    def __init__(self):
        super().__init__("async_docker")
        self.cli = self.create_client(SetBool, "dock", callback_group=MutuallyExclusiveCallbackGroup())
        self.timer = self.create_timer(1.0, self.dock, callback_group=MutuallyExclusiveCallbackGroup())
        self.answers = []

    async def dock(self):
        if not self.cli.service_is_ready():
            return
        self.timer.cancel()
        response = await self.cli.call_async(SetBool.Request(data=True))
        self.answers.append(response.message)


class Undocker(Node):
    def __init__(self):
        super().__init__("undocker")
        self.cli = self.create_client(SetBool, "dock")
        while not self.cli.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("service not available, waiting again...")
        future = self.cli.call_async(SetBool.Request(data=False))
        rclpy.spin_until_future_complete(self, future)
        self.answer = future.result().message
