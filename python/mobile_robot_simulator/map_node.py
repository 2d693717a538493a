"""The map as messages: MapServer hands it out as a service and as a latched topic, MapFileServer one of a file."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from . import messages
from ._core import OccupancyGrid
from .handles import Handle
from .maps import load_map
from .node_interface import Node, QoS
from .parameters import MapParameters


def to_message(grid: OccupancyGrid, frame_id: str = "map") -> messages.OccupancyGrid:
    """The message that carries a grid."""
    height, width = grid.shape
    origin = messages.Pose.from_planar(grid.origin)
    info = messages.MapMetaData(resolution=grid.resolution, width=width, height=height, origin=origin)
    return messages.OccupancyGrid(messages.Header(frame_id=frame_id), info, grid.cells.reshape(-1))


def from_message(message: messages.OccupancyGrid, *, unknown: Literal["free", "occupied"] = "free") -> OccupancyGrid:
    """The grid that a message carries.

    raises: ValueError for data that does not fill the map, or that no grid can hold.
    """
    info, data = message.info, np.asarray(message.data)
    if data.dtype.kind not in "iu" or data.min(initial=0) < -1 or data.max(initial=0) > 100:
        raise ValueError(f"a map's data must be integers in -1..100, got {data.dtype} values such as {data.ravel()[:4]}")
    if data.size != info.width * info.height:
        raise ValueError(f"a map of {info.width}x{info.height} cells must have as many values, got {data.size}")
    cells = data.astype(np.int8, copy=False).reshape(info.height, info.width)
    return OccupancyGrid(cells, resolution=_resolution(info), origin=info.origin.to_planar(), unknown=unknown)


def _resolution(info: messages.MapMetaData) -> float:
    """The resolution that was meant: a message on the wire carries float32, which is not 0.05 but nearly so."""
    rounded = np.float32(info.resolution)
    return float(str(rounded)) if info.resolution == rounded else info.resolution


def is_of(message: messages.OccupancyGrid, grid: OccupancyGrid) -> bool:
    """Whether a message carries the very cells of a grid, in the same place."""
    info = message.info
    return (
        (info.height, info.width) == grid.shape
        and _resolution(info) == grid.resolution
        and info.origin == messages.Pose.from_planar(grid.origin)
        and np.array_equal(message.data, grid.cells.reshape(-1))
    )


def with_unknown(grid: OccupancyGrid, unknown: Literal["free", "occupied"]) -> OccupancyGrid:
    """The same grid with another reading of its unknown cells."""
    return OccupancyGrid(
        grid.cells,
        resolution=grid.resolution,
        origin=grid.origin,
        occupied_threshold=grid.occupied_threshold,
        unknown=unknown,
    )


class MapServer(Handle):
    """Serves one map: GetMap on a service, and the map itself on a latched topic."""

    def __init__(
        self,
        node: Node,
        grid: OccupancyGrid,
        *,
        topic: str = "/map",
        service: str = "/static_map",
        frame_id: str = "map",
    ) -> None:
        self._node, self._topic, self._service = node, topic, service
        self._message = to_message(grid, frame_id)
        self._handles: tuple[object, object] | None = None

    def start(self) -> None:
        """Publish the map, and answer requests from now on."""
        if self._handles is not None:
            return
        publisher = self._node.create_publisher(messages.OccupancyGrid, self._topic, QoS.LATCHED)
        service = self._node.create_service(messages.GetMap, self._service, self._answer)
        self._handles = publisher, service
        publisher.publish(self._message)

    def stop(self) -> None:
        """No longer serve the map."""
        if self._handles is not None:
            publisher, service = self._handles
            self._node.destroy_publisher(publisher)
            self._node.destroy_service(service)
            self._handles = None

    def save(self) -> Any:
        """Whether the map is served."""
        return self._handles

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        self._handles = state

    def _answer(self, request: messages.GetMapRequest, response: messages.GetMapResponse) -> messages.GetMapResponse:
        response.map = self._message
        return response


class MapFileServer:
    """Serves the map of a map_server YAML file."""

    def __init__(self, node: Node, parameters: MapParameters) -> None:
        self._node = node
        self._parameters = parameters
        self._server = self._load(parameters)
        self._running = False

    @property
    def parameters(self) -> MapParameters:
        """The parameters in use."""
        return self._parameters

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by their names, from now on; of another file, the map is served at once.

        raises: ValueError for a value that cannot be, or a file that holds no map; OSError for one that can't be read.
        Then nothing changes.
        """
        parameters = self._parameters.changed(values)
        if parameters != self._parameters:
            server = self._load(parameters)
            self._server.stop()
            self._parameters, self._server = parameters, server
            if self._running:
                server.start()

    def start(self) -> None:
        """Serve the map from now on."""
        self._running = True
        self._server.start()

    def stop(self) -> None:
        """No longer serve it."""
        self._running = False
        self._server.stop()

    def _load(self, parameters: MapParameters) -> MapServer:
        return MapServer(
            self._node,
            load_map(parameters.yaml_filename),
            topic=parameters.topic_name,
            service=parameters.service_name,
            frame_id=parameters.frame_id,
        )
