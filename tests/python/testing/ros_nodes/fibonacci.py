"""The action of the tutorials: a server that awaits a timer between two numbers, and a client that can cancel its goal."""

from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self._action_server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            execute_callback=self.execute_callback,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=self.goal_callback,
            cancel_callback=self.cancel_callback,
        )

    def goal_callback(self, goal_request):
        return GoalResponse.ACCEPT if goal_request.order > 0 else GoalResponse.REJECT

    def cancel_callback(self, goal_handle):
        self.get_logger().info("Received cancel request")
        return CancelResponse.ACCEPT

    async def sleep(self, seconds):
        future = Future()
        timer = self.create_timer(seconds, lambda: future.set_result(None))
        await future
        self.destroy_timer(timer)

    async def execute_callback(self, goal_handle):
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        for i in range(1, goal_handle.request.order):
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result()
            feedback.sequence = [*feedback.sequence, feedback.sequence[i] + feedback.sequence[i - 1]]
            goal_handle.publish_feedback(feedback)
            await self.sleep(1.0)
        goal_handle.succeed()
        result = Fibonacci.Result()
        result.sequence = feedback.sequence
        return result


class FibonacciClient(Node):
    def __init__(self):
        super().__init__("fibonacci_client")
        self._action_client = ActionClient(self, Fibonacci, "fibonacci")
        self.partial, self.accepted, self.status, self.sequence = [], None, None, None
        self.canceling = None

    def send_goal(self, order):
        goal_msg = Fibonacci.Goal()
        goal_msg.order = order
        self._action_client.wait_for_server()
        future = self._action_client.send_goal_async(goal_msg, feedback_callback=self.feedback_callback)
        future.add_done_callback(self.goal_response_callback)

    def goal_response_callback(self, future):
        self.goal_handle = future.result()
        self.accepted = self.goal_handle.accepted
        if self.accepted:
            self.goal_handle.get_result_async().add_done_callback(self.get_result_callback)

    def feedback_callback(self, feedback_msg):
        self.partial.append(list(feedback_msg.feedback.sequence))

    def get_result_callback(self, future):
        self.status, self.sequence = future.result().status, list(future.result().result.sequence)

    @property
    def succeeded(self):
        return self.status == GoalStatus.STATUS_SUCCEEDED

    def cancel(self):
        self.goal_handle.cancel_goal_async().add_done_callback(self.cancel_done)

    def cancel_done(self, future):
        self.canceling = len(future.result().goals_canceling)
