"""The map as messages: MapServer hands it out as a service and as a latched topic."""

from __future__ import annotations

from typing import Literal

import numpy as np

from . import messages
from ._core import OccupancyGrid
from .node_interface import Node, QoS


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
    return OccupancyGrid(cells, resolution=info.resolution, origin=info.origin.to_planar(), unknown=unknown)


def with_unknown(grid: OccupancyGrid, unknown: Literal["free", "occupied"]) -> OccupancyGrid:
    """The same grid with another reading of its unknown cells."""
    return OccupancyGrid(
        grid.cells,
        resolution=grid.resolution,
        origin=grid.origin,
        occupied_threshold=grid.occupied_threshold,
        unknown=unknown,
    )


class MapServer:
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

    def _answer(self, request: messages.GetMapRequest, response: messages.GetMapResponse) -> messages.GetMapResponse:
        response.map = self._message
        return response
