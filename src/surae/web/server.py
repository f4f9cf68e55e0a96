"""The server: a socket, an address for the user, and uvicorn until Ctrl-C."""

import asyncio
import os
import secrets
import signal
import socket
import sys
import threading
import webbrowser
from typing import ClassVar
from urllib.parse import quote

import click
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from surae.errors import InputError
from surae.files import PathLike
from surae.web.app import create_app
from surae.web.security import Policy, is_loopback
from surae.web.workbench import Workbench

#: Connections that are served at a time; the twenty browsers of a laboratory need a hundred.
_CONNECTIONS = 250
#: A connection that has not said within this time what it wants is closed [s]; and so is, at once,
#: the oldest of those that have said nothing where one address has more of them than this.
_PATIENCE, _SILENT = 5.0, 32


def serve(
    project: PathLike,
    *,
    host: str,
    port: int,
    token: str | None,
    workers: int,
    upload_bytes: int,
    open_browser: bool,
) -> None:
    """Serve a project until the user stops it.

    Raises
    ------
    InputError
        The address or the project cannot be used.
    """
    if token is None and not is_loopback(host):
        token = secrets.token_urlsafe(24)
    listening = _listen(host, port)
    try:
        bench = Workbench(project, workers)
    except BaseException:
        listening.close()
        raise
    address = _address(host, listening.getsockname()[1], token)
    try:
        app = create_app(bench, Policy.of(host, token, upload_bytes))
        config = uvicorn.Config(
            app,
            http=_Connection,
            ws="none",
            limit_concurrency=_CONNECTIONS,
            log_level="critical",  # tracebacks may hold names of patients; ours go to `_log`
            access_log=False,
            server_header=False,
            date_header=False,
            proxy_headers=False,
            timeout_graceful_shutdown=2,
            h11_max_incomplete_event_size=64 * 1024,
        )
        server = _Server(
            config, bench, address, is_loopback(host), open_browser and sys.stdout.isatty()
        )
        if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
            signal.signal(signal.SIGHUP, server.handle_exit)  # the terminal was closed
        server.run(sockets=[listening])
    except KeyboardInterrupt:
        pass
    finally:
        bench.close()
        listening.close()
    if server.failed:
        raise InputError("the server could not start")


class _Connection(H11Protocol):
    """A connection that may not hold its place without asking for anything."""

    _late: asyncio.TimerHandle | None = None
    #: Those of each address that have not asked for anything, the oldest first.
    _silent: ClassVar[dict[str, list["_Connection"]]] = {}

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._wait()
        # A program that only holds connections open takes their places from its own, not ours.
        waiting = self._silent.setdefault(self._who, [])
        waiting.append(self)
        waiting[:] = [other for other in waiting if other.cycle is None]
        if len(waiting) > _SILENT:
            waiting.pop(0).transport.close()

    @property
    def _who(self) -> str:
        return self.client[0] if self.client else ""

    def on_response_complete(self) -> None:
        self._wait()
        super().on_response_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        if self._late is not None:
            self._late.cancel()
        waiting = self._silent.get(self._who, [])
        if self in waiting:
            waiting.remove(self)
        if not waiting:
            self._silent.pop(self._who, None)
        super().connection_lost(exc)

    def _wait(self) -> None:
        """Wait for the next request."""
        if self._late is not None:
            self._late.cancel()
        self._late = self.loop.call_later(_PATIENCE, self._give_up, self.cycle)

    def _give_up(self, before: object) -> None:
        if self.cycle is before and not self.transport.is_closing():
            self.transport.close()


class _Server(uvicorn.Server):
    """Says where it is once it answers."""

    def __init__(
        self,
        config: uvicorn.Config,
        bench: Workbench,
        address: str,
        local: bool,
        open_browser: bool,
    ) -> None:
        super().__init__(config)
        self._local = local
        self._bench, self._address, self._open = bench, address, open_browser
        self.failed = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if not self.started:
            return
        self.failed = False
        self._bench.warm()
        click.echo(f"surae workbench: {self._address}  (Ctrl-C ends it)")
        if not self._local:
            click.echo(
                "surae: others on this network can read along, token and recordings too: http is "
                "not encrypted; put it behind a server that is, or use an SSH tunnel", err=True
            )  # fmt: skip
        if self._open:
            threading.Thread(target=webbrowser.open, args=(self._address,), daemon=True).start()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        # Streams would never end of themselves, and requests would wait for their files.
        await asyncio.to_thread(self._bench.stop)
        await super().shutdown(sockets)


def _listen(host: str, port: int) -> socket.socket:
    """A socket that listens."""
    try:
        addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        family, kind, protocol, _, place = addresses[0]
        made = socket.socket(family, kind, protocol)
        if os.name == "posix":  # elsewhere it would share the port with another server
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind(place)
            made.listen(128)
        except OSError:
            made.close()
            raise
        made.set_inheritable(False)
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"cannot listen on {host} port {port}: {reason.lower()}; give another --port or --host"
        ) from None
    return made


def _address(host: str, port: int, token: str | None) -> str:
    name = socket.gethostname() if host in ("0.0.0.0", "::") else host
    shown = f"[{name}]" if ":" in name else name
    return f"http://{shown}:{port}/" + ("" if token is None else f"?token={quote(token)}")
