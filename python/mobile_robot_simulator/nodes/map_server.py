"""The map as messages: MapServer hands it out as a service and as a latched topic, MapFileServer one of a file."""

from __future__ import annotations

from typing import Any

from .. import messages
from .._core import OccupancyGrid
from ..handle import Handle
from ..maps.map_files import load_map
from ..parameters import MapParameters
from .interface import Node, QoS
from .map_messages import to_message


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
