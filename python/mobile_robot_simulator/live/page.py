"""LivePage: the page of a live view. It is drawn in the browser, by live_page.js and the modules in assets/."""

from __future__ import annotations

from nicegui.element import Element


class LivePage(Element, component="live_page.js", esm={"live": "assets"}):
    """The whole page.

    Args:
        viewer: Identifier of the page, which it shows to the server's WebSocket.
    """

    def __init__(self, viewer: str) -> None:
        super().__init__()
        self._props["viewer"] = viewer
