"""The interface of tf2_ros and tf2_geometry_msgs on the bus: a buffer with a history, its listener, and broadcasters."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Callable
from copy import deepcopy
from functools import partial
from operator import itemgetter
from typing import Any

from ..bus.node import BusNode
from ..handle import Handle
from ..instant import NANOSECONDS, Duration, Instant
from ..messages import Header, Point, Pose, TFMessage, Time, TransformStamped, Vector3
from ..nodes.interface import QoS
from ..nodes.rigid_transform import RigidTransform

CACHE_TIME = Duration(seconds=10)
"""How long a buffer keeps transforms by default."""


class TransformException(Exception):
    """Base class of the exceptions of tf2."""


class LookupException(TransformException):
    """A frame is unknown."""


class ConnectivityException(TransformException):
    """Two frames are in different trees."""


class ExtrapolationException(TransformException):
    """The time is before the first or after the last transform."""


class Buffer(Handle):
    """Keeps the transforms of the last seconds, with the interface of `tf2_ros.Buffer`.

    Args:
        cache_time: How long transforms are kept, counted back from the last one of a frame.
        node: Ignored.
    """

    def __init__(self, cache_time: Duration | None = None, node: Any = None) -> None:
        self._cache_ns = (cache_time or CACHE_TIME).nanoseconds
        self.clear()

    def clear(self) -> None:
        """Removes all transforms."""
        self._parents: dict[str, str] = {}
        self._history: dict[str, list[tuple[int, RigidTransform]]] = {}
        self._static: dict[str, RigidTransform] = {}

    def save(self) -> Any:
        """Returns the state that `restore` takes."""
        return dict(self._parents), {frame: list(poses) for frame, poses in self._history.items()}, dict(self._static)

    def restore(self, state: Any) -> None:
        """Puts the buffer back into a saved state."""
        parents, history, static = state
        self._parents, self._static = dict(parents), dict(static)
        self._history = {frame: list(poses) for frame, poses in history.items()}

    def set_transform(self, transform: TransformStamped, authority: str = "") -> None:
        """Adds a transform. A transform to another parent replaces the earlier ones.

        Raises:
            ValueError: The transform is not finite, or its quaternion is zero.
        """
        child, parent = transform.child_frame_id, transform.header.frame_id
        stamp, pose = transform.header.stamp.nanoseconds, _rigid(transform)
        self._static.pop(child, None)
        if self._parents.get(child) != parent:
            self._history[child] = []
        self._parents[child] = parent
        history = [entry for entry in self._history.get(child, []) if entry[0] != stamp]
        insort(history, (stamp, pose), key=itemgetter(0))
        oldest = history[-1][0] - self._cache_ns
        self._history[child] = history[bisect_left(history, oldest, key=itemgetter(0)) :]

    def set_transform_static(self, transform: TransformStamped, authority: str = "") -> None:
        """Adds a transform that is valid at all times. Raises the errors of `set_transform`."""
        self._static[transform.child_frame_id] = _rigid(transform)
        self._parents[transform.child_frame_id] = transform.header.frame_id

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Instant | Time, timeout: Duration | None = None
    ) -> TransformStamped:
        """Returns the pose of the source frame in the target frame.

        Args:
            target_frame: Frame of the result.
            source_frame: Frame whose pose is wanted.
            time: Time of the pose. Poses between two transforms are interpolated. Zero is the latest time at which all
                transforms between the frames are known.
            timeout: Ignored, because simulated time stands still during a callback.

        Raises:
            LookupException: A frame is unknown.
            ConnectivityException: The frames are not connected.
            ExtrapolationException: The time is before the first or after the last transform.
        """
        known = {*self._parents, *self._parents.values()}
        for name, frame in (("target_frame", target_frame), ("source_frame", source_frame)):
            if frame not in known:
                raise LookupException(f'"{frame}" passed to lookupTransform argument {name} does not exist. ')
        from_source, from_target = self._up(source_frame), self._up(target_frame)
        common = next((frame for frame in from_source if frame in from_target), None)
        if common is None:
            raise ConnectivityException(
                f"Could not find a connection between '{target_frame}' and '{source_frame}' because they are not part of "
                "the same tree."
            )
        up, down = from_source[: from_source.index(common)], from_target[: from_target.index(common)]
        time_ns = time.nanoseconds or min((self._history[f][-1][0] for f in up + down if f not in self._static), default=0)
        pose = self._to_ancestor(down, time_ns).inverse() * self._to_ancestor(up, time_ns)
        header = Header(Time.from_nanoseconds(time_ns), target_frame)
        return TransformStamped(header, source_frame, pose.to_transform())

    def can_transform(
        self, target_frame: str, source_frame: str, time: Instant | Time, timeout: Duration | None = None
    ) -> bool:
        """Returns True if `lookup_transform` finds a pose."""
        try:
            self.lookup_transform(target_frame, source_frame, time, timeout)
        except TransformException:
            return False
        return True

    def transform(self, object_stamped: Any, target_frame: str, timeout: Duration | None = None) -> Any:
        """Returns a PoseStamped, PointStamped or Vector3Stamped in another frame.

        Raises:
            TransformException: As for `lookup_transform`.
            TypeError: The object is of another type.
        """
        kind = type(object_stamped).__name__
        if kind not in TRANSFORMED:
            raise TypeError(f"the stand-in transforms {', '.join(TRANSFORMED)}, got {kind}")
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        return TRANSFORMED[kind](object_stamped, found)

    def _up(self, frame: str) -> list[str]:
        """Returns a frame and its ancestors, nearest first."""
        found = [frame]
        while (parent := self._parents.get(found[-1])) is not None and parent not in found:
            found.append(parent)
        return found

    def _to_ancestor(self, frames: list[str], time_ns: int) -> RigidTransform:
        """Returns the pose of the first of consecutive frames in the parent of the last one."""
        pose = RigidTransform()
        for frame in frames:
            pose = (self._static[frame] if frame in self._static else self._at(frame, time_ns)) * pose
        return pose

    def _at(self, frame: str, time_ns: int) -> RigidTransform:
        history = self._history[frame]
        after = bisect_left(history, time_ns, key=itemgetter(0))
        if after < len(history) and history[after][0] == time_ns:
            return history[after][1]
        if after in (0, len(history)):
            where, there = ("past", history[0][0]) if after == 0 else ("future", history[-1][0])
            raise ExtrapolationException(
                f"Lookup would require extrapolation into the {where}.  Requested time {time_ns / NANOSECONDS:.6f} but the "
                f"{'earliest' if after == 0 else 'latest'} data is at time {there / NANOSECONDS:.6f}, of frame [{frame}]"
            )
        (before_ns, before), (after_ns, later) = history[after - 1], history[after]
        return before.interpolate(later, (time_ns - before_ns) / (after_ns - before_ns))


class TransformListener(Handle):
    """Fills a buffer from /tf and /tf_static, with the interface of `tf2_ros.TransformListener`.

    Args:
        buffer: Buffer to fill. `Simulation.restore` restores it.
        node: Node to subscribe through.
        **_: Other arguments of tf2_ros, such as `spin_thread`, are ignored.
    """

    def __init__(self, buffer: Buffer, node: BusNode, **_: Any) -> None:
        self._node = node
        if buffer not in node._bus.nodes:
            node._bus.nodes.append(buffer)
        self._subscriptions = [
            node.create_subscription(TFMessage, topic, partial(self._add, add), QoS.LATCHED)
            for topic, add in (("/tf", buffer.set_transform), ("/tf_static", buffer.set_transform_static))
        ]

    def unregister(self) -> None:
        """Ends the subscriptions."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)

    def _add(self, add: Callable[[TransformStamped], None], message: TFMessage) -> None:
        for transform in message.transforms:
            try:
                add(transform)
            except ValueError as error:
                self._node.get_logger().warning(f"transform of {transform.child_frame_id} refused: {error}")


class TransformBroadcaster:
    """Publishes transforms on /tf, with the interface of `tf2_ros.TransformBroadcaster`.

    Args:
        node: Node to publish through.
        qos: Ignored.
    """

    def __init__(self, node: BusNode, qos: Any = None) -> None:
        self._publisher = node.create_publisher(TFMessage, "/tf", QoS.DEFAULT)

    def sendTransform(self, transform: TransformStamped | list[TransformStamped]) -> None:
        """Publishes one transform or several."""
        self._publisher.publish(TFMessage(transform if isinstance(transform, list) else [transform]))


class StaticTransformBroadcaster:
    """Publishes transforms on /tf_static, with the interface of `tf2_ros.StaticTransformBroadcaster`.

    Each message repeats the earlier transforms of this broadcaster, because later subscribers get its last message only.

    Args:
        node: Node to publish through.
        qos: Ignored.
    """

    def __init__(self, node: BusNode, qos: Any = None) -> None:
        self._publisher = node.create_publisher(TFMessage, "/tf_static", QoS.LATCHED)
        self._sent: dict[str, TransformStamped] = {}

    def sendTransform(self, transform: TransformStamped | list[TransformStamped]) -> None:
        """Publishes one transform or several."""
        for each in transform if isinstance(transform, list) else [transform]:
            self._sent[each.child_frame_id] = each
        self._publisher.publish(TFMessage(list(self._sent.values())))


def do_transform_pose(pose: Pose, transform: TransformStamped) -> Pose:
    """Returns a pose in the frame of the transform's header."""
    return (_rigid(transform) * RigidTransform.from_message(pose.position, pose.orientation)).to_pose()


def do_transform_pose_stamped(pose: Any, transform: TransformStamped) -> Any:
    """Returns a PoseStamped in the frame of the transform's header, with the transform's stamp."""
    return type(pose)(header=deepcopy(transform.header), pose=do_transform_pose(pose.pose, transform))


def do_transform_point(point: Any, transform: TransformStamped) -> Any:
    """Returns a PointStamped in the frame of the transform's header, with the transform's stamp."""
    moved = _rigid(transform).apply((point.point.x, point.point.y, point.point.z))
    return type(point)(header=deepcopy(transform.header), point=Point(*moved))


def do_transform_vector3(vector3: Any, transform: TransformStamped) -> Any:
    """Returns a Vector3Stamped in the frame of the transform's header, with the transform's stamp. It is only rotated."""
    turned = _rigid(transform).rotate((vector3.vector.x, vector3.vector.y, vector3.vector.z))
    return type(vector3)(header=deepcopy(transform.header), vector=Vector3(*turned))


def _rigid(transform: TransformStamped) -> RigidTransform:
    return RigidTransform.from_message(transform.transform.translation, transform.transform.rotation)


TRANSFORMED: dict[str, Callable[[Any, TransformStamped], Any]] = {
    "PointStamped": do_transform_point,
    "PoseStamped": do_transform_pose_stamped,
    "Vector3Stamped": do_transform_vector3,
}
"""How `Buffer.transform` transforms messages, by the name of their type."""
