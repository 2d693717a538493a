"""EntityServices: obstacles come, move and go through services, which say what they did and why they did not."""

from __future__ import annotations

import math
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.entity_messages import (
    DeleteEntity,
    DeleteEntityRequest,
    DeleteModel,
    DeleteModelRequest,
    EntityState,
    ModelState,
    Resource,
    Result,
    SetEntityState,
    SetEntityStateRequest,
    SetModelState,
    SetModelStateRequest,
    SpawnEntity,
    SpawnEntityRequest,
    SpawnEntityResponse,
    SpawnModel,
    SpawnModelRequest,
)
from mobile_robot_simulator.messages import Header, Pose, PoseStamped, Twist, Vector3
from mobile_robot_simulator.nodes.world_server import WorldServer
from mobile_robot_simulator.parameters import WorldParameters
from mobile_robot_simulator.physics.world import World

SECOND = 1_000_000_000
DISC = '<robot name="a"><link name="b"><collision><geometry><sphere radius="0.3"/></geometry></collision></link></robot>'


def pose(x: float, y: float, yaw: float = 0.0) -> Pose:
    return Pose.from_planar(mrs.Pose(x, y, yaw))


class Rig:
    """A world without robots, and its server."""

    def __init__(self) -> None:
        self.bus = Bus()
        self.world = World(lambda: self.bus.time_ns)
        self.server = WorldServer(NoCopyNode(self.bus, "world"), WorldParameters(), self.world)
        self.node = NoCopyNode(self.bus, "tester")
        self.server.start()

    def call(self, srv_type: Any, name: str, request: Any) -> Any:
        future = self.node.create_client(srv_type, name).call_async(request)
        self.bus.run_until(self.bus.time_ns)
        return future.result()

    def spawn(self, name: str = "box", model: str = DISC, **fields: Any) -> Any:
        fields.setdefault("initial_pose", PoseStamped(pose=pose(2.0, 1.0, 0.5)))
        request = SpawnEntityRequest(name=name, entity_resource=Resource(resource_string=model), **fields)
        return self.call(SpawnEntity, "spawn_entity", request)

    def set_state(self, **fields: Any) -> Any:
        return self.call(SetEntityState, "set_entity_state", SetEntityStateRequest(**fields)).result

    def pose_after(self, seconds: float) -> tuple[float, float, float]:
        self.bus.run_until(self.bus.time_ns + round(seconds * SECOND))
        return tuple(self.world.obstacles[0].pose(self.bus.time_ns))  # type: ignore[return-value]


def test_an_entity_comes_moves_and_goes() -> None:
    rig = Rig()
    response = rig.spawn()
    assert response.result == Result(Result.OK) and response.entity_name == "box"
    assert rig.world.obstacles[0].shape == mrs.Shape.disc(0.3) and rig.pose_after(1.0) == pytest.approx((2.0, 1.0, 0.5))
    assert rig.set_state(entity="box", state=EntityState(pose=pose(3.0, 0.0))) == Result(Result.OK)
    assert rig.pose_after(1.0) == pytest.approx((3.0, 0.0, 0.0))
    deleted = rig.call(DeleteEntity, "delete_entity", DeleteEntityRequest("box"))
    assert deleted.result == Result(Result.OK) and rig.world.obstacles == []


def test_a_velocity_is_along_the_axes_of_the_map() -> None:
    rig = Rig()
    rig.spawn()
    twist = Twist(linear=Vector3(1.0, 0.5))
    rig.set_state(entity="box", state=EntityState(twist=twist), set_pose=False)
    assert rig.pose_after(2.0) == pytest.approx((4.0, 2.0, 0.5))
    rig.set_state(entity="box", state=EntityState(pose=pose(0.0, 0.0, math.pi / 2)), set_twist=False)
    # Goes on at the velocity in its own frame, which is turned by pi / 2 - 0.5 now.
    angle = math.pi / 2 - 0.5
    x, y = math.cos(angle) - 0.5 * math.sin(angle), math.sin(angle) + 0.5 * math.cos(angle)
    assert rig.pose_after(1.0) == pytest.approx((x, y, math.pi / 2))


def test_version_1_of_the_interfaces_has_the_model_in_another_field() -> None:
    response = Rig().call(SpawnEntity, "spawn_entity", SpawnEntityRequest(name="box", resource_string=DISC))
    assert response.result == Result(Result.OK)


def test_a_name_is_made_up_or_changed_where_that_is_allowed() -> None:
    rig = Rig()
    assert [rig.spawn("").entity_name for _ in range(3)] == ["obstacle", "obstacle_2", "obstacle_3"]
    assert rig.spawn("obstacle", allow_renaming=True).entity_name == "obstacle_4"


@pytest.mark.parametrize(
    ("fields", "code", "message"),
    [
        ({"name": "box"}, SpawnEntityResponse.NAME_NOT_UNIQUE, "there is an obstacle box already"),
        ({"name": "a b"}, SpawnEntityResponse.NAME_INVALID, "the name must have at most 100 letters"),
        ({"model": ""}, SpawnEntityResponse.NO_RESOURCE, "the resource_string must have the model as URDF or SDF"),
        ({"uri": "file:a.sdf"}, SpawnEntityResponse.UNSUPPORTED_FORMAT, "uri must be empty"),
        ({"model": "<sdf/>"}, SpawnEntityResponse.RESOURCE_PARSE_ERROR, "the model must have one geometry"),
        (
            {"initial_pose": PoseStamped(header=Header(frame_id="odom"))},
            SpawnEntityResponse.INVALID_POSE,
            "it must be in frame map, got odom",
        ),
    ],
)
def test_what_cannot_be_added_is_refused_with_the_code_of_the_standard(
    fields: dict[str, Any], code: int, message: str
) -> None:
    rig = Rig()
    rig.spawn("box")
    response = rig.spawn(**{"name": "other", **fields})
    assert (response.result.result, response.entity_name) == (code, "") and message in response.result.error_message
    assert len(rig.world.obstacles) == 1


def test_what_cannot_be_moved_or_removed_is_refused() -> None:
    rig = Rig()
    rig.spawn()
    unknown = Result(Result.NOT_FOUND, "there is no obstacle cart")
    assert rig.set_state(entity="cart") == unknown
    assert rig.call(DeleteEntity, "delete_entity", DeleteEntityRequest("cart")).result == unknown
    fast = rig.set_state(entity="box", state=EntityState(pose=pose(9.0, 9.0), twist=Twist(linear=Vector3(math.nan))))
    assert fast.result == Result.OPERATION_FAILED and "must be at most 1000, got (nan" in fast.error_message
    elsewhere = rig.set_state(entity="box", state=EntityState(header=Header(frame_id="odom")))
    assert elsewhere.result == 101 and "it must be in frame map, got odom" in elsewhere.error_message
    assert rig.pose_after(1.0) == pytest.approx((2.0, 1.0, 0.5))


@pytest.mark.parametrize("service", ["gazebo/spawn_sdf_model", "gazebo/spawn_urdf_model"])
def test_scripts_for_gazebo_work(service: str) -> None:
    rig = Rig()
    spawn = SpawnModelRequest(model_name="box", model_xml=DISC, initial_pose=pose(2.0, 1.0), reference_frame="world")
    added = rig.call(SpawnModel, service, spawn)
    assert (added.success, added.status_message) == (True, "obstacle box added")
    again = rig.call(SpawnModel, service, spawn)
    assert (again.success, again.status_message) == (False, "there is an obstacle box already")
    state = ModelState("box", pose(3.0, 0.0), Twist(linear=Vector3(1.0)), "map")
    moved = rig.call(SetModelState, "gazebo/set_model_state", SetModelStateRequest(state))
    assert (moved.success, moved.status_message) == (True, "obstacle box moved")
    assert rig.pose_after(2.0) == pytest.approx((5.0, 0.0, 0.0))
    state.reference_frame = "odom"
    refused = rig.call(SetModelState, "gazebo/set_model_state", SetModelStateRequest(state))
    assert (refused.success, refused.status_message) == (False, "it must be in frame map, got odom")
    for success, text in ((True, "obstacle box removed"), (False, "there is no obstacle box")):
        removed = rig.call(DeleteModel, "gazebo/delete_model", DeleteModelRequest("box"))
        assert (removed.success, removed.status_message) == (success, text)
    state.reference_frame = ""
    gone = rig.call(SetModelState, "gazebo/set_model_state", SetModelStateRequest(state))
    assert (gone.success, gone.status_message) == (False, "there is no obstacle box")
    assert rig.world.obstacles == []


def test_a_stopped_server_offers_no_services() -> None:
    rig = Rig()
    client = rig.node.create_client(DeleteEntity, "delete_entity")
    assert client.service_is_ready()
    rig.server.stop()
    assert not client.service_is_ready()
