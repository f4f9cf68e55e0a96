"""What a request asks for, and answers to it, before any application is involved."""

import json
from typing import Any
from urllib.parse import parse_qsl, quote

from starlette.types import Scope, Send

_SAFE = ("GET", "HEAD", "OPTIONS")


class Asked:
    """A request before it reaches the application."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.method: str = scope["method"]
        self.path: str = scope["path"]
        self.query: str = scope.get("query_string", b"").decode("latin-1")
        self._headers: list[tuple[bytes, bytes]] = list(scope["headers"])
        self.safe = self.method in _SAFE

    def header(self, name: str) -> str:
        """A header; empty where it is missing or comes twice."""
        values = [value for key, value in self._headers if key == name.encode()]
        return values[0].decode("latin-1") if len(values) == 1 else ""

    def cookies(self, name: str) -> list[str]:
        """The values of the cookies of exactly this name.

        Other programs on this computer set cookies too, in forms that no parser of all takes, and
        even by our own names for a part of our addresses.
        """
        lines = [value.decode("latin-1") for key, value in self._headers if key == b"cookie"]
        pairs = (part.strip().partition("=") for line in lines for part in line.split(";"))
        return [value for key, _, value in pairs if key == name and len(value) <= 200][:5]

    @property
    def parameters(self) -> dict[str, str]:
        """What the address asks for."""
        return dict(parse_qsl(self.query, keep_blank_values=True))

    @property
    def length(self) -> int | None:
        """The announced length of the body."""
        text = self.header("content-length")
        return int(text) if text.isdecimal() and len(text) < 20 else None

    @property
    def same_origin(self) -> bool:
        """Whether the request comes from a page of ours, or from no page at all."""
        origin = self.header("origin")
        if any(key == b"origin" for key, _ in self._headers) and not origin:
            return False
        if not origin:
            return True
        return origin in {f"{scheme}://{self.header('host')}" for scheme in ("http", "https")}

    @property
    def from_elsewhere(self) -> bool:
        """Whether a browser says that a page of another site asks, or a link on it."""
        return self.header("sec-fetch-site") not in ("", "same-origin", "none")

    @property
    def is_page(self) -> bool:
        """Whether somebody opens a page."""
        path = self.path
        return self.method == "GET" and not path.startswith(("/api/", "/static/"))


async def refuse(send: Send, status: int, text: str) -> None:
    """Answer with an error, one line, as the application does."""
    await respond(send, status, json.dumps({"error": text}).encode(), [])


async def redirect(send: Send, to: str) -> None:
    """Send the browser to another page of ours."""
    # One slash only, and nothing that a browser leaves out, such as a tab: two slashes would lead
    # to another server.
    path, mark, query = to.partition("?")
    place = quote("/" + path.lstrip("/\\"), safe="/") + mark + quote(query, safe="=&%+")
    await respond(send, 303, b"{}", [(b"location", place.encode())])


async def respond(
    send: Send,
    status: int,
    body: bytes,
    headers: list[tuple[bytes, bytes]],
    kind: bytes = b"application/json",
) -> None:
    """Answer with a whole body."""
    start: dict[str, Any] = {
        "type": "http.response.start",
        "status": status,
        "headers": [
            (b"content-type", kind),
            (b"content-length", str(len(body)).encode()),
            *headers,
        ],
    }
    await send(start)
    await send({"type": "http.response.body", "body": body})
