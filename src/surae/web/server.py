"""The server: a socket, an address for the user, and uvicorn until Ctrl-C."""

import secrets
import socket
import sys
import threading
import webbrowser

import click
import uvicorn

from surae.errors import InputError
from surae.files import PathLike
from surae.web.app import create_app
from surae.web.security import Policy, is_loopback
from surae.web.workbench import Workbench


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
            log_level="error",
            access_log=False,
            server_header=False,
            date_header=False,
            proxy_headers=False,
            timeout_graceful_shutdown=2,
            h11_max_incomplete_event_size=64 * 1024,
        )
        server = _Server(config, address, open_browser and sys.stdout.isatty())
        server.run(sockets=[listening])
    except KeyboardInterrupt:
        pass
    finally:
        bench.close()
        listening.close()
    if server.failed:
        raise InputError("the server could not start")


class _Server(uvicorn.Server):
    """Says where it is once it answers."""

    def __init__(self, config: uvicorn.Config, address: str, open_browser: bool) -> None:
        super().__init__(config)
        self._address, self._open = address, open_browser
        self.failed = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if not self.started:
            return
        self.failed = False
        click.echo(f"surae workbench: {self._address}  (Ctrl-C ends it)")
        if self._open:
            threading.Thread(target=webbrowser.open, args=(self._address,), daemon=True).start()


def _listen(host: str, port: int) -> socket.socket:
    """A socket that listens."""
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        family, kind, protocol, _, place = found[0]
        made = socket.socket(family, kind, protocol)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind(place)
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
    return f"http://{shown}:{port}/" + ("" if token is None else f"?token={token}")
