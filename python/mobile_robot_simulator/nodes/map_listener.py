"""MapListener: how a node gets the map, from a service and from a topic."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

from .. import messages
from .._core import OccupancyGrid
from ..handle import Handles
from ..messages import GetMap
from .future import Future
from .interface import Client, Node, QoS
from .map_messages import carries_grid, from_message, with_unknown

Unknown = Literal["free", "occupied"]
"""Treatment of unknown cells."""

MAP_REQUEST_PERIOD = 1.0
"""Time between two attempts to request the map [s]."""

MAP_REQUEST_TIMEOUT_NS = 10_000_000_000
"""Time after which an unanswered map request is repeated [ns]."""


@dataclass(frozen=True)
class MapListenerSnapshot:
    """Saved state of a `MapListener`.

    Attributes:
        grid: The map, None before it has arrived. The cells themselves are not saved.
        unknown: Treatment of unknown cells.
        requested_ns: Time of the unanswered request [ns], None if there is none.
    """

    grid: OccupancyGrid | None
    unknown: Unknown
    requested_ns: int | None


class MapListener:
    """Gets the map of a node.

    It requests the map from a service, and repeats the request until the map has arrived. A map on the topic replaces the
    current one.

    Args:
        node: Node that subscribes and requests.
        use: Called with each new map.
        unknown: Treatment of unknown cells.
        grid: Map that is known already. `use` is not called with it.
    """

    def __init__(
        self, node: Node, use: Callable[[OccupancyGrid], None], unknown: Unknown, grid: OccupancyGrid | None = None
    ) -> None:
        self._node, self._use = node, use
        self._unknown, self._grid = unknown, grid
        self._source = self._failure = ""
        self._requested_ns: int | None = None

    @property
    def grid(self) -> OccupancyGrid | None:
        """The map, None before it has arrived."""
        return self._grid

    def find_missing(self) -> dict[str, str]:
        """Returns what `WaitingLog` needs to know: where the map comes from while it has not arrived, else nothing."""
        return {} if self._grid is not None else {"the map": f"{self._source}{self._failure}"}

    def start(self, *, topic: str, service: str, handles: Handles) -> None:
        """Subscribes to the topic, and requests the map now and periodically until it has arrived.

        Args:
            topic: Topic of maps that replace the current one. Empty for none.
            service: Name of the GetMap service.
            handles: Takes what has to be released to stop.
        """
        node, self._requested_ns, self._failure = self._node, None, ""
        self._source = f"from service {node.resolve_service_name(service)}"
        if topic:
            self._source = f"on topic {node.resolve_topic_name(topic)} or {self._source}"
        if topic:
            maps = node.create_subscription(messages.OccupancyGrid, topic, self._take, QoS.LATCHED)
            handles.add(node.destroy_subscription, maps)
        client = node.create_client(GetMap, service)
        handles.add(node.destroy_client, client)
        self._request(client)
        requesting = node.create_timer(MAP_REQUEST_PERIOD, partial(self._request, client))
        handles.add(node.destroy_timer, requesting)

    def set_unknown(self, unknown: Unknown) -> None:
        """Treats the unknown cells of the current map and of all later ones in another way."""
        if unknown != self._unknown:
            self._unknown = unknown
            if self._grid is not None:
                self._grid = with_unknown(self._grid, unknown)
                self._use(self._grid)

    def save(self) -> MapListenerSnapshot:
        """Returns the state that `restore` takes."""
        return MapListenerSnapshot(self._grid, self._unknown, self._requested_ns)

    def restore(self, state: MapListenerSnapshot) -> None:
        """Puts the listener back into a saved state. Does not call `use`."""
        self._grid, self._unknown, self._requested_ns = state.grid, state.unknown, state.requested_ns

    def _now_ns(self) -> int:
        return self._node.get_clock().now().nanoseconds

    def _request(self, client: Client) -> None:
        """Requests the map, unless it has arrived or a request is pending."""
        now_ns, requested_ns = self._now_ns(), self._requested_ns
        is_pending = requested_ns is not None and 0 <= now_ns - requested_ns < MAP_REQUEST_TIMEOUT_NS
        if self._grid is None and not is_pending and client.service_is_ready():
            self._requested_ns = now_ns
            client.call_async(GetMap.Request()).add_done_callback(self._take_response)

    def _take_response(self, future: Future) -> None:
        self._requested_ns = None
        error = future.exception()
        if error is None:
            self._take(future.result().map)
        else:
            self._failure = f", whose last call failed: {error}"

    def _take(self, message: messages.OccupancyGrid) -> None:
        """Replaces the map, unless the message carries the same one or is invalid."""
        if self._grid is not None and carries_grid(message, self._grid):
            return
        logger = self._node.get_logger()
        try:
            self._grid = from_message(message, unknown=self._unknown)
        except ValueError as error:
            logger.warning(f"map refused: {error}")
            return
        height, width = self._grid.shape
        logger.info(f"using a map of {width}x{height} cells of {self._grid.resolution:g} m")
        self._use(self._grid)
