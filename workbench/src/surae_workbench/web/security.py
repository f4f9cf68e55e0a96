"""Who may ask, and how: everything that is checked before a request reaches the application.

A page of another site that runs in a user's browser can send requests here. It is stopped by the
name it asked for (Host: no DNS rebinding), by where it comes from (Origin, Sec-Fetch-Site), by a
cookie that only our own pages send (SameSite=Strict) and by a token that only our own pages know.
"""

import asyncio
import hmac
import ipaddress
import re
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Protocol
from urllib.parse import quote, urlencode

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from surae.base.errors import SuraeError
from surae.processes import one_line
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.sessions import BrowserSession

CSRF_HEADER = "x-csrf-token"
#: Pages are as local as what they show: nothing from outside, no script or style within a page.
CONTENT_SECURITY_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "font-src 'self'; connect-src 'self'; worker-src 'self'; frame-src 'self'; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "content-security-policy": CONTENT_SECURITY_POLICY,
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
    "cache-control": "no-store",
}
#: Largest body of a request that uploads no file [bytes].
_BODY = 2 * 2**20
#: The next piece of a body is waited for so long [s].
_PATIENCE = 20.0
#: API routes that need no session: one makes it, the other describes the API.
_OPEN = ("/api/session", "/api/openapi.json")
#: What a program is told that has not asked for a session.
NO_SESSION = "no session: GET /api/session first, and send its cookie"
_HOST = re.compile(r"(\[(?P<v6>[0-9A-Fa-f:.]+)\]|(?P<name>[0-9A-Za-z._-]+))(:[0-9]{0,5})?")
_LOOPBACK = ("localhost", "127.0.0.1", "::1")
#: Those who give a wrong token wait so long [s], one after the other: nobody tries many.
_GUESS = 0.1
#: What a link on another site gets first: a page of ours that asks again, with its cookies.
_AGAIN = (
    '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>surae</title>'
    '<meta http-equiv="refresh" content="0"></head></html>'
)


@dataclass(frozen=True, slots=True)
class Policy:
    """What a server allows."""

    hosts: frozenset[str]  #: Names by which it may be asked for, without port.
    #: Whether it may be asked for by any IP address: it listens on all of them.
    any_address: bool = False
    token: str | None = None  #: What everybody has to know; None where nobody has to.
    upload_bytes: int = 512 * 2**20  #: Largest file.

    @classmethod
    def of(cls, host: str, token: str | None = None, upload_bytes: int = 512 * 2**20) -> "Policy":
        """The policy of a server that listens on `host`."""
        if is_loopback(host):
            return cls(frozenset({*_LOOPBACK, host.lower()}), False, token, upload_bytes)
        # Not the full name, which would ask the network.
        names = {host.lower(), socket.gethostname().lower(), *_LOOPBACK}
        return cls(frozenset(names), host in ("0.0.0.0", "::"), token, upload_bytes)

    def allows_host(self, host: str) -> bool:
        """Whether a request may name the server so."""
        name = _host_name(host)
        if name in self.hosts:
            return True
        return self.any_address and _is_address(name)


def is_loopback(host: str) -> bool:
    """Whether only this computer reaches an address."""
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class _Incoming(HTTPConnection):
    """A request before it reaches the application."""

    def __init__(self, scope: Scope) -> None:
        super().__init__(scope)
        self.method, self.path = str(scope["method"]), str(scope["path"])
        self.safe = self.method in ("GET", "HEAD", "OPTIONS")
        #: Whether somebody opens a page.
        self.is_page = self.method == "GET" and not self.path.startswith(("/api/", "/static/"))

    def header(self, name: str) -> str:
        """A header; empty where it is missing or comes twice."""
        values = self.headers.getlist(name)
        return values[0] if len(values) == 1 else ""

    def cookies_of(self, name: str) -> list[str]:
        """The values of the cookies of exactly this name.

        Other programs on this computer set cookies too, in forms that no parser of all takes, and
        even by our own names for a part of our addresses.
        """
        parts = (part for line in self.headers.getlist("cookie") for part in line.split(";"))
        pairs = (part.strip().partition("=") for part in parts)
        return [value for key, _, value in pairs if key == name and len(value) <= 200][:5]

    @property
    def length(self) -> int | None:
        """The announced length of the body."""
        text = self.header("content-length")
        return int(text) if text.isdecimal() and len(text) < 20 else None

    @property
    def has_body(self) -> bool:
        """Whether more comes than the headers."""
        if "content-length" in self.headers:
            return self.length != 0
        return "transfer-encoding" in self.headers

    @property
    def same_origin(self) -> bool:
        """Whether the request comes from a page of ours, or from no page at all."""
        host = self.header("host")
        ours = {f"{scheme}://{host}" for scheme in ("http", "https")}
        return "origin" not in self.headers or self.header("origin") in ours

    @property
    def from_elsewhere(self) -> bool:
        """Whether a browser says that a page of another site asks, or a link on it."""
        return self.header("sec-fetch-site") not in ("", "same-origin", "none")


class Browsers(Protocol):
    """Browsers kept apart by a cookie, see `surae_workbench.web.sessions`."""

    project_id: str

    def open(self, cookies: Sequence[str]) -> BrowserSession | None:
        """The session of the first cookie that has one."""
        ...

    def make(self) -> tuple[BrowserSession, str]:
        """A new session, and its cookie."""
        ...


class Security:
    """ASGI middleware that refuses what the policy does not allow.

    `sessions` are found by cookie, and made for whoever loads a page or asks for
    ``/api/session``.
    """

    def __init__(self, app: ASGIApp, policy: Policy, sessions: Browsers) -> None:
        self._app = app
        self._policy = policy
        self._sessions = sessions
        self._token = None if policy.token is None else _digest(policy.token)
        self._guessing = asyncio.Lock()
        # Cookies do not know ports: without the project in their names, two servers on one
        # computer would throw each other's sessions away.
        self._session_cookie = f"surae_session_{sessions.project_id}"
        self._token_cookie = f"surae_token_{sessions.project_id}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Check a request, then pass it on."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return  # no WebSockets
        request = _Incoming(scope)
        cookies = list[str]()
        guarded = _guarded(send, cookies)
        uploads = request.method == "POST" and request.path == "/api/uploads"
        limit = self._policy.upload_bytes if uploads else _BODY
        answer = await self._refusal(request, cookies, limit)
        if answer is None:
            await self._pass(request, receive, guarded, limit)
        else:
            await answer(scope, receive, guarded)

    async def _refusal(
        self, request: "_Incoming", cookies: list[str], limit: int
    ) -> Response | None:
        """What a request is answered instead of being passed on; None where it may pass."""
        try:
            if not self._policy.allows_host(request.header("host")):
                raise RefusedError(400, "this server does not go by that name (Host)")
            if request.from_elsewhere and request.is_page:
                return HTMLResponse(_AGAIN)
            if request.from_elsewhere or not request.same_origin:
                raise RefusedError(
                    403, "the request comes from another site (Origin, Sec-Fetch-Site)"
                )
            if self._token is not None and (
                not self._knows(request) or (request.is_page and "token" in request.query_params)
            ):
                return await self._ask_token(request, cookies, self._token)
            if (request.length or 0) > limit:
                raise RefusedError(413, _too_large(limit))
            await self._session(request, cookies)
        except SuraeError as error:  # another than ours: the project cannot be read or written
            return _refused(getattr(error, "status", 503), one_line(error))
        return None

    async def _ask_token(self, request: "_Incoming", cookies: list[str], token: str) -> Response:
        """Take the token out of the address, once; refuse who does not know it."""
        query = dict(request.query_params)
        if request.safe and (self._matches(query.pop("token", "")) or self._knows(request)):
            cookies.append(_cookie(self._token_cookie, token))
            # One slash only: two would lead to another server.
            place = quote("/" + request.path.lstrip("/\\"), safe="/")
            return RedirectResponse(place + (f"?{urlencode(query)}" if query else ""), 303)
        async with self._guessing:
            await asyncio.sleep(_GUESS)
        raise RefusedError(403, "this server needs its token; open the address it printed")

    async def _pass(self, request: "_Incoming", receive: Receive, send: Send, limit: int) -> None:
        """Pass a request on, as long as its body is."""
        started = False

        async def noted(message: Message) -> None:
            nonlocal started
            started = started or message["type"] == "http.response.start"
            await send(message)

        body = _limited(receive, limit) if request.has_body else receive
        try:
            await self._app(request.scope, body, noted)
        except RefusedError as error:
            await _refused(error.status, str(error))(request.scope, receive, noted)
        except Exception:  # answered and logged by the application; nothing more to tell
            if not started:
                raise

    async def _session(self, request: "_Incoming", cookies: list[str]) -> None:
        """Find or make the session, and check its CSRF token."""
        if request.path.startswith("/static/"):
            return
        session = await run_in_threadpool(
            self._sessions.open, request.cookies_of(self._session_cookie)
        )
        makes = request.is_page or (request.method, request.path) == ("GET", "/api/session")
        if session is None and makes:
            session, cookie = await run_in_threadpool(self._sessions.make)
            cookies.append(_cookie(self._session_cookie, cookie))
        if session is None and request.path.startswith("/api/") and request.path not in _OPEN:
            raise RefusedError(403, NO_SESSION)
        if not request.safe:
            token = request.header(CSRF_HEADER)
            if session is None or not hmac.compare_digest(token.encode(), session.csrf.encode()):
                raise RefusedError(
                    403, "the header X-CSRF-Token is missing or old; load the page again"
                )
        request.scope.setdefault("state", {})["session"] = session

    def _knows(self, request: "_Incoming") -> bool:
        """Whether the request carries the token, as a cookie or a header."""
        bearer = request.header("authorization")
        if bearer.startswith("Bearer ") and self._matches(bearer.removeprefix("Bearer ").strip()):
            return True
        return any(
            hmac.compare_digest(cookie.encode(), (self._token or "").encode())
            for cookie in request.cookies_of(self._token_cookie)
        )

    def _matches(self, token: str) -> bool:
        return hmac.compare_digest(_digest(token), self._token or "")


def _guarded(send: Send, cookies: list[str]) -> Send:
    """Send with the headers of `_HEADERS`, unless the application gave its own, and cookies."""

    async def wrapped(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
            for cookie in cookies:
                headers.append("set-cookie", cookie)
        await send(message)

    return wrapped


def _limited(receive: Receive, limit: int) -> Receive:
    """Receive a body of at most so many bytes, the next piece of which comes soon."""
    left = limit
    coming = True

    async def take() -> Message:
        nonlocal left, coming
        if not coming:  # what comes now is that nobody waits for the answer any more
            return await receive()
        try:
            message = await asyncio.wait_for(receive(), _PATIENCE)
        except TimeoutError:
            raise RefusedError(408, f"nothing came for {_PATIENCE:g} s; try again") from None
        left -= len(message.get("body", b""))
        if left < 0:
            raise RefusedError(413, _too_large(limit))
        coming = message.get("more_body", False)
        return message

    return take


def _too_large(limit: int) -> str:
    return f"too large: at most {limit / 2**20:g} MiB; cut or downsample it"


def _cookie(name: str, value: str) -> str:
    return f"{name}={value}; Path=/; HttpOnly; SameSite=Strict; Max-Age=31536000"


def _digest(token: str) -> str:
    return sha256(f"surae {token}".encode()).hexdigest()


def _host_name(host: str) -> str:
    """The name in a Host header, without its port; empty where it is malformed."""
    match = _HOST.fullmatch(host)
    return "" if match is None else (match["v6"] or match["name"]).lower()


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _refused(status: int, text: str) -> Response:
    return JSONResponse({"error": text}, status)
