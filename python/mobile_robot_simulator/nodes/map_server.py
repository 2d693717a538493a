"""Map servers: the nodes that offer a map as a service and on a latched topic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .. import messages
from .._core import OccupancyGrid
from ..handle import Handle, Handles
from ..maps import load_map
from ..parameters import MapParameters
from .interface import Node, Publisher, QoS
from .map_messages import to_message


@dataclass(frozen=True)
class MapServerSnapshot:
    """Saved state of a `MapServer`.

    Attributes:
        running: Publisher and service, None while the server is stopped.
        publisher: Publisher of the map, None before the first start.
        message: The map.
    """

    running: Handles | None
    publisher: Publisher[messages.OccupancyGrid] | None
    message: messages.OccupancyGrid


class MapServer(Handle):
    """Offers one map through the service GetMap and publishes it on a latched topic.

    Args:
        node: Node that publishes the map and offers the service.
        grid: The map, copied: later changes to the grid are served once `serve` is called.
        topic: Name of the topic.
        service: Name of the service.
        frame_id: Frame of the grid's origin.
    """

    def __init__(
        self,
        node: Node,
        grid: OccupancyGrid,
        *,
        topic: str = "map",
        service: str = "static_map",
        frame_id: str = "map",
    ) -> None:
        self._node, self._topic, self._service = node, topic, service
        self._frame_id = frame_id
        self._message = to_message(grid, frame_id)
        self._publisher: Publisher[messages.OccupancyGrid] | None = None
        self._running: Handles | None = None

    def __repr__(self) -> str:
        return f"MapServer(topic={self._topic!r}, service={self._service!r})"

    def start(self) -> None:
        """Publishes the map and starts to answer requests. Has no effect if the server is running."""
        if self._running is not None:
            return
        with Handles() as handles:
            publisher = self._node.create_publisher(messages.OccupancyGrid, self._topic, QoS.LATCHED)
            handles.add(self._node.destroy_publisher, publisher)
            service = self._node.create_service(messages.GetMap, self._service, self._answer)
            handles.add(self._node.destroy_service, service)
            publisher.publish(self._message)
            self._publisher, self._running = publisher, handles

    def serve(self, grid: OccupancyGrid) -> None:
        """Serves another map from now on, and publishes it if the server is running."""
        self._message = to_message(grid, self._frame_id)
        if self._running is not None and self._publisher is not None:
            self._publisher.publish(self._message)

    def stop(self) -> None:
        """Stops serving the map. `start` resumes."""
        if self._running is not None:
            self._running.close()
            self._running = None

    def save(self) -> MapServerSnapshot:
        """Returns the state that `restore` takes."""
        return MapServerSnapshot(self._running, self._publisher, self._message)

    def restore(self, state: MapServerSnapshot) -> None:
        """Puts the server back into a saved state. The bus restores what the handles refer to."""
        self._running, self._publisher, self._message = state.running, state.publisher, state.message

    def _answer(self, request: messages.GetMapRequest, response: messages.GetMapResponse) -> messages.GetMapResponse:
        response.map = self._message
        return response


class MapFileServer:
    """Serves the map of a map_server YAML file.

    Args:
        node: Node that publishes the map and offers the service.
        parameters: File, names of topic and service, and frame.

    Raises:
        OSError: A file cannot be read.
        ValueError: The file contains no valid map.
    """

    def __init__(self, node: Node, parameters: MapParameters) -> None:
        self._node = node
        self._parameters = parameters
        self._server = self._load(parameters)
        self._is_running = False

    @property
    def parameters(self) -> MapParameters:
        """Current parameters."""
        return self._parameters

    def set_parameters(self, **values: Any) -> None:
        """Changes parameters by name. If one has a new value, loads the file again and serves its map at once.

        Args:
            **values: New values, by the names of `MapParameters`.

        Raises:
            ValueError: A value is invalid, or the file contains no valid map. Nothing changes.
            OSError: The file cannot be read. Nothing changes.
        """
        parameters = self._parameters.changed(values)
        if parameters != self._parameters:
            server = self._load(parameters)
            self._server.stop()
            self._parameters, self._server = parameters, server
            if self._is_running:
                server.start()

    def start(self) -> None:
        """Publishes the map and starts to answer requests. Has no effect if the server is running."""
        self._is_running = True
        self._server.start()

    def stop(self) -> None:
        """Stops serving the map. `start` resumes."""
        self._is_running = False
        self._server.stop()

    def _load(self, parameters: MapParameters) -> MapServer:
        return MapServer(
            self._node,
            load_map(parameters.yaml_filename),
            topic=parameters.topic_name,
            service=parameters.service_name,
            frame_id=parameters.frame_id,
        )
