"""The services that put things into a simulated world: those of simulation_interfaces (ROS 2) and of gazebo_msgs (ROS 1).

The classes have the fields that the simulator uses.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from .messages import Header, Message, Pose, PoseStamped, Twist


@dataclass(slots=True, eq=False)
class Result(Message):
    """Whether a service did what it was asked for, and why not."""

    ros_type = "simulation_interfaces/msg/Result"

    OK: ClassVar[int] = 1
    NOT_FOUND: ClassVar[int] = 2
    OPERATION_FAILED: ClassVar[int] = 4

    result: int = 0
    error_message: str = ""


@dataclass(slots=True, eq=False)
class Resource(Message):
    """What an entity looks like: a file, or its content."""

    ros_type = "simulation_interfaces/msg/Resource"
    uri: str = ""
    resource_string: str = ""


@dataclass(slots=True, eq=False)
class EntityState(Message):
    """Pose and velocity of an entity."""

    ros_type = "simulation_interfaces/msg/EntityState"
    header: Header = field(default_factory=Header)
    pose: Pose = field(default_factory=Pose)
    twist: Twist = field(default_factory=Twist)


@dataclass(slots=True, eq=False)
class SpawnEntityRequest(Message):
    """Request to add an entity. Version 1 of the definition has `uri` and `resource_string` instead of `entity_resource`."""

    ros_type = "simulation_interfaces/srv/SpawnEntity_Request"
    optional = ("entity_resource", "uri", "resource_string")
    name: str = ""
    allow_renaming: bool = False
    entity_resource: Resource = field(default_factory=Resource)
    uri: str = ""
    resource_string: str = ""
    initial_pose: PoseStamped = field(default_factory=PoseStamped)


@dataclass(slots=True, eq=False)
class SpawnEntityResponse(Message):
    """The result, and the name that the entity has got."""

    ros_type = "simulation_interfaces/srv/SpawnEntity_Response"

    NAME_NOT_UNIQUE: ClassVar[int] = 101
    NAME_INVALID: ClassVar[int] = 102
    UNSUPPORTED_FORMAT: ClassVar[int] = 103
    NO_RESOURCE: ClassVar[int] = 104
    RESOURCE_PARSE_ERROR: ClassVar[int] = 106
    INVALID_POSE: ClassVar[int] = 109

    result: Result = field(default_factory=Result)
    entity_name: str = ""


class SpawnEntity:
    """Service that adds an entity."""

    ros_type = "simulation_interfaces/srv/SpawnEntity"
    Request = SpawnEntityRequest
    Response = SpawnEntityResponse


@dataclass(slots=True, eq=False)
class DeleteEntityRequest(Message):
    """Request to remove an entity."""

    ros_type = "simulation_interfaces/srv/DeleteEntity_Request"
    entity: str = ""


@dataclass(slots=True, eq=False)
class DeleteEntityResponse(Message):
    """The result."""

    ros_type = "simulation_interfaces/srv/DeleteEntity_Response"
    result: Result = field(default_factory=Result)


class DeleteEntity:
    """Service that removes an entity."""

    ros_type = "simulation_interfaces/srv/DeleteEntity"
    Request = DeleteEntityRequest
    Response = DeleteEntityResponse


@dataclass(slots=True, eq=False)
class SetEntityStateRequest(Message):
    """Request to move an entity. Version 1 of the definition has no flags: it always sets pose and velocity."""

    ros_type = "simulation_interfaces/srv/SetEntityState_Request"
    optional = ("set_pose", "set_twist")
    entity: str = ""
    state: EntityState = field(default_factory=EntityState)
    set_pose: bool = True
    set_twist: bool = True


@dataclass(slots=True, eq=False)
class SetEntityStateResponse(Message):
    """The result."""

    ros_type = "simulation_interfaces/srv/SetEntityState_Response"

    INVALID_POSE: ClassVar[int] = 101

    result: Result = field(default_factory=Result)


class SetEntityState:
    """Service that moves an entity."""

    ros_type = "simulation_interfaces/srv/SetEntityState"
    Request = SetEntityStateRequest
    Response = SetEntityStateResponse


@dataclass(slots=True, eq=False)
class ModelState(Message):
    """Pose and velocity of a model."""

    ros_type = "gazebo_msgs/msg/ModelState"
    model_name: str = ""
    pose: Pose = field(default_factory=Pose)
    twist: Twist = field(default_factory=Twist)
    reference_frame: str = ""


@dataclass(slots=True, eq=False)
class SpawnModelRequest(Message):
    """Request to add a model, described by SDF or URDF."""

    ros_type = "gazebo_msgs/srv/SpawnModel_Request"
    model_name: str = ""
    model_xml: str = ""
    initial_pose: Pose = field(default_factory=Pose)
    reference_frame: str = ""


@dataclass(slots=True, eq=False)
class SpawnModelResponse(Message):
    """Whether the model was added, and why not."""

    ros_type = "gazebo_msgs/srv/SpawnModel_Response"
    success: bool = False
    status_message: str = ""


class SpawnModel:
    """Service that adds a model."""

    ros_type = "gazebo_msgs/srv/SpawnModel"
    Request = SpawnModelRequest
    Response = SpawnModelResponse


@dataclass(slots=True, eq=False)
class DeleteModelRequest(Message):
    """Request to remove a model."""

    ros_type = "gazebo_msgs/srv/DeleteModel_Request"
    model_name: str = ""


@dataclass(slots=True, eq=False)
class DeleteModelResponse(Message):
    """Whether the model was removed, and why not."""

    ros_type = "gazebo_msgs/srv/DeleteModel_Response"
    success: bool = False
    status_message: str = ""


class DeleteModel:
    """Service that removes a model."""

    ros_type = "gazebo_msgs/srv/DeleteModel"
    Request = DeleteModelRequest
    Response = DeleteModelResponse


@dataclass(slots=True, eq=False)
class SetModelStateRequest(Message):
    """Request to move a model."""

    ros_type = "gazebo_msgs/srv/SetModelState_Request"
    model_state: ModelState = field(default_factory=ModelState)


@dataclass(slots=True, eq=False)
class SetModelStateResponse(Message):
    """Whether the model was moved, and why not."""

    ros_type = "gazebo_msgs/srv/SetModelState_Response"
    success: bool = False
    status_message: str = ""


class SetModelState:
    """Service that moves a model."""

    ros_type = "gazebo_msgs/srv/SetModelState"
    Request = SetModelStateRequest
    Response = SetModelStateResponse
