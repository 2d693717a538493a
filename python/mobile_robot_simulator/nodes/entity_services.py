"""EntityServices: add, move and remove obstacles through the services of simulation_interfaces and of gazebo_msgs."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Any, Protocol, TypeVar

from .._core import Pose, Shape
from ..entity_messages import (
    DeleteEntity,
    DeleteEntityRequest,
    DeleteEntityResponse,
    DeleteModel,
    DeleteModelRequest,
    DeleteModelResponse,
    Result,
    SetEntityState,
    SetEntityStateRequest,
    SetEntityStateResponse,
    SetModelState,
    SetModelStateRequest,
    SetModelStateResponse,
    SpawnEntity,
    SpawnEntityRequest,
    SpawnEntityResponse,
    SpawnModel,
    SpawnModelRequest,
    SpawnModelResponse,
)
from ..handle import Handles
from ..messages import Header, Twist
from ..physics.velocity_profile import Velocity
from .interface import Node
from .model_shapes import shape_of_model
from .transforms import check_frame

R = TypeVar("R", SpawnModelResponse, SetModelStateResponse, DeleteModelResponse)

WORLD = "world"
"""Frame in which Gazebo places models; here it is the frame of the map."""


class Obstacles(Protocol):
    """The obstacles of a world."""

    def has(self, name: str) -> bool:
        """Returns True if there is an obstacle of this name."""

    def check_name(self, name: str) -> None:
        """Raises ValueError if an obstacle cannot have this name."""

    def add(self, name: str, shape: Shape, pose: Pose) -> None:
        """Adds an obstacle."""

    def move(self, name: str, pose: Pose | None, velocity: Velocity | None) -> None:
        """Moves an obstacle, and lets it drive at a velocity in its own frame. None leaves the pose or velocity as it is."""

    def remove(self, name: str) -> None:
        """Removes an obstacle. Raises ValueError if there is none of this name."""


class EntityServices:
    """Services that add, move and remove obstacles. The answer says whether that was done, and why not.

    On ROS 2: `spawn_entity`, `set_entity_state` and `delete_entity`, with the types of simulation_interfaces. On ROS 1:
    `gazebo/spawn_sdf_model`, `gazebo/spawn_urdf_model`, `gazebo/set_model_state` and `gazebo/delete_model`, with those of
    gazebo_msgs. Each is offered where its type is installed. `shape_of_model` says which models there are.

    A velocity is given along the axes of the map. From then on the obstacle keeps it in its own frame, so an obstacle that
    also turns drives along an arc.

    Args:
        node: Node that offers the services.
        obstacles: What they change.
        frame: Frame of the map.
    """

    def __init__(self, node: Node, obstacles: Obstacles, frame: str) -> None:
        self._node, self._obstacles, self._frame = node, obstacles, frame

    def start(self, handles: Handles) -> None:
        """Offers the services until the handles are closed."""
        dialects: tuple[tuple[tuple[Any, str, Callable[[Any, Any], Any]], ...], ...] = (
            (
                (SpawnEntity, "spawn_entity", self._spawn_entity),
                (SetEntityState, "set_entity_state", self._set_entity_state),
                (DeleteEntity, "delete_entity", self._delete_entity),
            ),
            (
                (SpawnModel, "gazebo/spawn_sdf_model", self._spawn_model),
                (SpawnModel, "gazebo/spawn_urdf_model", self._spawn_model),
                (SetModelState, "gazebo/set_model_state", self._set_model_state),
                (DeleteModel, "gazebo/delete_model", self._delete_model),
            ),
        )
        for dialect in dialects:
            for srv_type, name, answer in dialect:
                service = self._node.create_service(srv_type, name, answer)
                if service is None:
                    # The types of one package are all installed, or none is.
                    break
                handles.add(self._node.destroy_service, service)

    # --- simulation_interfaces ---

    def _spawn_entity(self, request: SpawnEntityRequest, response: SpawnEntityResponse) -> SpawnEntityResponse:
        kind, name = SpawnEntityResponse, request.name or "obstacle"
        if self._obstacles.has(name):
            if request.name and not request.allow_renaming:
                response.result = Result(kind.NAME_NOT_UNIQUE, f"there is an obstacle {name} already")
                return response
            name = next(f"{name}_{number}" for number in count(2) if not self._obstacles.has(f"{name}_{number}"))
        model = request.resource_string or request.entity_resource.resource_string
        if request.uri or request.entity_resource.uri or not model:
            code = kind.NO_RESOURCE if not (request.uri or request.entity_resource.uri) else kind.UNSUPPORTED_FORMAT
            response.result = Result(code, "the resource_string must have the model as URDF or SDF, and uri must be empty")
            return response
        code = kind.NAME_INVALID
        try:
            self._obstacles.check_name(name)
            code = kind.RESOURCE_PARSE_ERROR
            shape = shape_of_model(model)
            code = kind.INVALID_POSE
            check_frame(request.initial_pose.header, self._frame)
            pose = request.initial_pose.pose.to_planar()
            code = Result.OPERATION_FAILED
            self._obstacles.add(name, shape, pose)
        except (ValueError, TypeError) as error:
            response.result = Result(code, str(error))
        else:
            response.result, response.entity_name = Result(Result.OK), name
        return response

    def _set_entity_state(self, request: SetEntityStateRequest, response: SetEntityStateResponse) -> SetEntityStateResponse:
        if not self._obstacles.has(request.entity):
            response.result = Result(Result.NOT_FOUND, f"there is no obstacle {request.entity}")
            return response
        code = SetEntityStateResponse.INVALID_POSE
        try:
            check_frame(request.state.header, self._frame)
            pose = request.state.pose.to_planar() if request.set_pose else None
            code = Result.OPERATION_FAILED
            self._move(request.entity, pose, request.state.twist if request.set_twist else None)
        except ValueError as error:
            response.result = Result(code, str(error))
        else:
            response.result = Result(Result.OK)
        return response

    def _delete_entity(self, request: DeleteEntityRequest, response: DeleteEntityResponse) -> DeleteEntityResponse:
        if self._obstacles.has(request.entity):
            self._obstacles.remove(request.entity)
            response.result = Result(Result.OK)
        else:
            response.result = Result(Result.NOT_FOUND, f"there is no obstacle {request.entity}")
        return response

    # --- gazebo_msgs ---

    def _spawn_model(self, request: SpawnModelRequest, response: SpawnModelResponse) -> SpawnModelResponse:
        def act() -> str:
            self._check_gazebo_frame(request.reference_frame)
            if self._obstacles.has(request.model_name):
                raise ValueError(f"there is an obstacle {request.model_name} already")
            self._obstacles.check_name(request.model_name)
            pose = request.initial_pose.to_planar()
            self._obstacles.add(request.model_name, shape_of_model(request.model_xml), pose)
            return f"obstacle {request.model_name} added"

        return _answered(response, act)

    def _set_model_state(self, request: SetModelStateRequest, response: SetModelStateResponse) -> SetModelStateResponse:
        def act() -> str:
            state = request.model_state
            self._check_gazebo_frame(state.reference_frame)
            if not self._obstacles.has(state.model_name):
                raise ValueError(f"there is no obstacle {state.model_name}")
            self._move(state.model_name, state.pose.to_planar(), state.twist)
            return f"obstacle {state.model_name} moved"

        return _answered(response, act)

    def _delete_model(self, request: DeleteModelRequest, response: DeleteModelResponse) -> DeleteModelResponse:
        def act() -> str:
            if not self._obstacles.has(request.model_name):
                raise ValueError(f"there is no obstacle {request.model_name}")
            self._obstacles.remove(request.model_name)
            return f"obstacle {request.model_name} removed"

        return _answered(response, act)

    def _move(self, name: str, pose: Pose | None, twist: Twist | None) -> None:
        self._obstacles.move(name, pose, None if twist is None else (twist.linear.x, twist.linear.y, twist.angular.z))

    def _check_gazebo_frame(self, frame: str) -> None:
        if frame != WORLD:
            check_frame(Header(frame_id=frame), self._frame)


def _answered(response: R, act: Callable[[], str]) -> R:
    """Returns the response to an action that returns a text if it succeeds, and raises ValueError if it does not."""
    try:
        response.status_message, response.success = act(), True
    except (ValueError, TypeError) as error:
        response.status_message, response.success = str(error), False
    return response
