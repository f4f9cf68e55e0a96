"""The server: a socket, an address for the user, and uvicorn until Ctrl-C."""

import asyncio
import os
import secrets
import signal
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol
from urllib.parse import quote

import click
import uvicorn
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

from surae.base.errors import InputError
from surae.base.files import PathLike
from surae_workbench.web.app import create_app
from surae_workbench.web.security import Policy, is_loopback
from surae_workbench.web.workbench import Workbench

#: Connections that are served at a time; the twenty browsers of a laboratory need a hundred.
_CONNECTIONS = 250
#: A connection that has not said within this time what it wants is closed [s].
_PATIENCE = 5.0


@dataclass(frozen=True, slots=True)
class Address:
    """Where a server listens, the token that is asked for there, and whether a browser is opened.

    A token is made where others reach the address and none is given.
    """

    host: str
    port: int
    token: str | None
    open_browser: bool

    def __post_init__(self) -> None:
        if self.token is None and not is_loopback(self.host):
            object.__setattr__(self, "token", secrets.token_urlsafe(24))

    def url(self, port: int, token: str | None) -> str:
        """What a browser opens, once it is known which port is ours."""
        name = socket.gethostname() if self.host in ("0.0.0.0", "::") else self.host
        shown = f"[{name}]" if ":" in name else name
        return f"http://{shown}:{port}/" + ("" if token is None else f"?token={quote(token)}")


class Served(Protocol):
    """What a server serves: told when it answers, and when it ends."""

    def warm(self) -> None:
        """Get ready, beside the first requests."""
        ...

    def stop(self) -> None:
        """End streams, which would never end of themselves."""
        ...

    def close(self) -> None:
        """Let go of everything."""
        ...


def serve(project: PathLike, address: Address, *, workers: int, upload_bytes: int) -> None:
    """Serve a project until the user stops it."""

    def open_bench() -> tuple[Served, ASGIApp]:
        bench = Workbench(project, workers)
        if bench.project.unkept:
            click.echo(f"surae: {bench.project.unkept}", err=True)
        return bench, create_app(bench, Policy.of(address.host, address.token, upload_bytes))

    run(open_bench, "workbench", address)


def run(
    make: Callable[[], tuple[Served, ASGIApp]],
    name: str,
    address: Address,
    more: Callable[[str], None] = lambda root: None,  # noqa: ARG005
) -> None:
    """Serve an application until the user stops it.

    `make` makes what is served and its application, once the address is ours; `name` is what it is
    called; `more` is called with the address, without token, once it answers.
    """
    listening = _listen(address.host, address.port)
    try:
        served, app = make()
    except BaseException:
        listening.close()
        raise
    taken = listening.getsockname()[1]
    try:
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

        def answers() -> None:
            served.warm()
            url = address.url(taken, address.token)
            click.echo(f"surae {name}: {url}  (Ctrl-C ends it)")
            more(address.url(taken, None))
            if not is_loopback(address.host):
                click.echo(
                    "surae: others on this network can read along, token and recordings too: "
                    "http is not encrypted; put it behind a server that is, or use an SSH tunnel",
                    err=True,
                )
            if address.open_browser and sys.stdout.isatty():
                threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()

        server = _Server(config, answers, served.stop)
        if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
            signal.signal(signal.SIGHUP, server.handle_exit)  # the terminal was closed
        server.run(sockets=[listening])
    except KeyboardInterrupt:
        pass
    finally:
        served.close()
        listening.close()
    if server.failed:
        raise InputError("the server could not start")


class _Connection(H11Protocol):
    """A connection that may not hold its place without asking for anything."""

    _late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._wait()

    def on_response_complete(self) -> None:
        self._wait()
        super().on_response_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        if self._late is not None:
            self._late.cancel()
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
    """Says when it answers, and when it ends."""

    def __init__(
        self, config: uvicorn.Config, answers: Callable[[], None], stops: Callable[[], None]
    ) -> None:
        super().__init__(config)
        self._answers = answers
        self._stops = stops
        self.failed = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self.failed = False
            self._answers()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        # Streams would never end of themselves, and requests would wait for their files.
        await asyncio.to_thread(self._stops)
        await super().shutdown(sockets)


def _listen(host: str, port: int) -> socket.socket:
    """A socket that listens."""
    try:
        addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        family, kind, protocol, _, place = addresses[0]
        listening = socket.socket(family, kind, protocol)
        if os.name == "posix":  # elsewhere it would share the port with another server
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind(place)
            listening.listen(128)
        except OSError:
            listening.close()
            raise
        listening.set_inheritable(False)
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"cannot listen on {host} port {port}: {reason.lower()}; give another --port or --host"
        ) from None
    return listening
