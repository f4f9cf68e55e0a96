"""The operator's page and the subject's, with what they ask for."""

import json
import secrets
import threading
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Unpack

import click
import numpy as np
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send

from surae._version import __version__
from surae.api import Trajectory
from surae.errors import InputError, SuraeError
from surae.files import PathLike, template
from surae.processes import one_line
from surae_workbench.live.room import Room, RoomOptions, known
from surae_workbench.live.showing import Showing, roles_of
from surae_workbench.live.target import KIND
from surae_workbench.web import STATIC
from surae_workbench.web.events import Events
from surae_workbench.web.security import Policy, Security
from surae_workbench.web.server import run, token_for
from surae_workbench.web.sessions import BrowserSession, key_of

_HERE = Path(__file__).parent
_SUBJECT = ("/subject", "/api/subject")
#: The state of streams and disk is told this often [s].
_HEALTH = 0.5
#: Points of a target's curve on the screen each second.
_POINTS = 20.0


class RoomBrowsers:
    """Browsers kept apart by a cookie, for as long as the program runs."""

    def __init__(self, name: str) -> None:
        self.project_id = f"{name}_{secrets.token_hex(4)}"
        self._known: dict[str, BrowserSession] = {}

    def hidden(self, text: str) -> str:
        """A message as it is: it names no folder of a project."""
        return text

    def open(self, cookies: Sequence[str]) -> BrowserSession | None:
        """The session of the first cookie that has one."""
        sessions = (self._known.get(key_of(cookie)) for cookie in cookies)
        return next((session for session in sessions if session is not None), None)

    def make(self) -> tuple[BrowserSession, str]:
        """A new session, and its cookie."""
        session, cookie = BrowserSession.new()
        self._known[session.key] = session
        return session, cookie


def _curve(path: Trajectory | None, angle: bool = True) -> dict[str, Any] | None:
    """A target as a page draws it."""
    if path is None:
        return None
    step = max(1, round(1.0 / ((path.time[1] - path.time[0]) * _POINTS)))
    curve: dict[str, Any] = {
        "t": [round(float(t), 3) for t in path.time[::step]],
        "effort": [[round(float(e), 3) for e in row] for row in path.effort[::step]],
    }
    if angle:
        curve["angle"] = [round(float(a), 4) for a in path.angle[::step]]
    return curve


class ServedRoom:
    """A room and the pages that show it.

    Parameters
    ----------
    folder, **room
        As of `Room`.
    """

    def __init__(self, folder: PathLike, **room: Unpack[RoomOptions]) -> None:
        self.events = Events()
        self.showing = Showing(self._frame)
        self.room = Room(folder, show=self.showing.show, tell=self._tell, **room)
        self._ended = threading.Event()

    def warm(self) -> None:
        """Begin to show."""
        self.showing.run(self.room.trials.recorder.clock, self.room.target.now)
        threading.Thread(target=self._health, daemon=True, name="live-health").start()

    def stop(self) -> None:
        """End the streams of browsers."""
        self._ended.set()
        self.showing.close()
        self.events.close()

    def close(self) -> None:
        """Let go of everything."""
        self.stop()
        self.room.close()

    def state(self) -> dict[str, Any]:
        """How all stands."""
        room, trials = self.room, self.room.trials
        low, high = np.degrees(room.range)
        return {
            **self.moment(),
            "curve": _curve(room.trajectory),
            "folder": trials.folder.name,
            "rehearsal": room.laboratory is not None,
            "trials": [trials.trials[number] for number in sorted(trials.trials)],
            "session": trials.session,
            "asked": room.asked,
            "moves": f"{room.device.name}, {low:.0f}° to {high:.0f}°",
            **self.health(),
            **known(),
        }

    def moment(self) -> dict[str, Any]:
        """Which trial is running, and since when; LSL's time."""
        room, trials = self.room, self.room.trials
        return {"running": trials.running, "begin": room.begin, "now": trials.recorder.clock()}

    def subject(self) -> dict[str, Any]:
        """What the subject's page shows: nothing else."""
        return {**self.moment(), "curve": _curve(self.room.trajectory, angle=False)}

    def health(self) -> dict[str, Any]:
        """How streams and disk do."""
        trials = self.room.trials
        with suppress(OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError):
            # Somebody may be editing it: until it can be read again, what it said before holds.
            self.showing.roles = roles_of(trials.mapping)
        return {
            "streams": [s for s in trials.recorder.health() if s["kind"] != KIND],
            "trouble": trials.recorder.trouble,
            "roles": sorted(role for role, _, _ in self.showing.roles.values()),
            "ready": self.room.ready,
        }  # fmt: skip

    def _frame(self, frame: dict[str, Any]) -> None:
        self.events.tell("frames", "frame", frame)
        self.events.tell(
            "subject", "effort",
            {"t": frame["t"], "effort": frame["effort"], "asked": frame["asked"][1:]},
        )  # fmt: skip

    def _tell(self, event: str, data: Mapping[str, Any]) -> None:
        self.events.tell("room", event, dict(data))

    def _health(self) -> None:
        while not self._ended.wait(_HEALTH):
            with suppress(Exception):  # the next one may do
                self.events.tell("room", "health", self.health())


def create_app(served: ServedRoom, policy: Policy, subject: str | None) -> ASGIApp:
    """The pages as an ASGI application.

    `policy` says who may operate; `subject` is the token of the subject's page, which opens nothing
    else; None where nobody needs one.
    """

    def page(name: str) -> Any:
        async def shown(request: Request) -> Response:
            text = template(f"{name}.html.j2", "surae_workbench.live").render(
                csrf=request.state.session.csrf, version=__version__
            )
            return Response(text, media_type="text/html")

        return shown

    async def state(request: Request) -> Response:  # noqa: ARG001
        return JSONResponse(await run_in_threadpool(served.state))

    async def subject_state(request: Request) -> Response:  # noqa: ARG001
        return JSONResponse(await run_in_threadpool(served.subject))

    def stream(*topics: str) -> Any:
        async def news_of(request: Request) -> Response:
            who = request.state.session.key
            served.events.refuse_more(who)
            news = served.events.stream(who, topics, list)
            return StreamingResponse(_paced(news), media_type="text/event-stream")

        return news_of

    async def act(request: Request) -> Response:
        name = request.path_params["name"]
        try:
            body = json.loads(await request.body() or b"{}")
        except ValueError:
            raise InputError("the body is no JSON that can be read") from None
        if not isinstance(body, dict):
            raise InputError("the body must be a table of names and values")
        return JSONResponse(await run_in_threadpool(_act, served, name, body))

    app = Starlette(
        routes=[
            Route("/", page("operator")),
            Route("/subject", page("subject")),
            Route("/api/live", state),
            Route("/api/live/events", stream("frames", "room")),
            Route("/api/live/{name}", act, methods=["POST"]),
            Route("/api/subject", subject_state),
            Route("/api/subject/events", stream("subject")),
            Mount("/static/live", StaticFiles(directory=_HERE / "static")),
            Mount("/static", StaticFiles(packages=STATIC)),
        ],
        exception_handlers={SuraeError: _refused, HTTPException: _missing, ClientDisconnect: _gone},
    )
    operator = Security(app, policy, RoomBrowsers("live"))
    second = Policy(policy.hosts, policy.any_address, subject, policy.upload_bytes)
    watching = Security(app, second, RoomBrowsers("live_subject"))

    async def dispatched(scope: Scope, receive: Receive, send: Send) -> None:
        """The subject's page, and the files that it is drawn with, have a token of their own."""
        path = scope.get("path", "")
        theirs = path.startswith(_SUBJECT)
        if path.startswith("/static/"):
            cookies = b"; ".join(v for k, v in scope["headers"] if k == b"cookie")
            theirs = b"surae_token_live_subject_" in cookies and b"surae_token_live_" not in (
                cookies.replace(b"surae_token_live_subject_", b"")
            )
        await (watching if theirs else operator)(scope, receive, send)

    return dispatched


async def _paced(news: AsyncIterator[str]) -> AsyncIterator[str]:
    """News as they come; the comment first makes proxies and browsers begin."""
    yield ": surae\n\n"
    async for text in news:
        yield text


def _act(served: ServedRoom, name: str, body: Mapping[str, Any]) -> dict[str, Any]:
    """Do what the operator asks for."""
    room = served.room
    if name == "start":
        return {"trial": room.start(_number(body, "countdown", 3.0))}
    if name == "stop":
        room.stop()
    elif name == "mark":
        room.trials.mark(_text(body, "text")[:200])
    elif name == "load":
        room.load(
            profile=_text(body, "profile"),
            task=_text(body, "task"),
            duration=_number(body, "seconds", 35.0),
            chirp_amplitude=_number(body, "chirp_amplitude", 0.1),
        )
    elif name == "next":
        room.load_next()
    elif name == "forget":
        served.showing.forget()
    elif name == "fault" and room.laboratory is not None:
        room.laboratory.fault(**{k: v for k, v in body.items() if k in ("kind", "muscle", "at")})
    else:
        raise InputError(f"there is nothing called {name[:40]!r} to do here")
    return {"running": room.trials.running}


def _number(body: Mapping[str, Any], name: str, default: float) -> float:
    value = body.get(name, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 3600:
        raise InputError(f"{name} must be a number from 0 to 3600")
    return float(value)


def _text(body: Mapping[str, Any], name: str) -> str:
    value = body.get(name, "")
    if not isinstance(value, str):
        raise InputError(f"{name} must be a text")
    return value


async def _refused(request: Request, error: Exception) -> Response:  # noqa: ARG001
    status = getattr(error, "status", 400)
    return JSONResponse({"error": one_line(error)}, status)


async def _missing(request: Request, error: Exception) -> Response:  # noqa: ARG001
    status = getattr(error, "status_code", 404)
    return JSONResponse({"error": "there is no such page"}, status)


async def _gone(request: Request, error: Exception) -> Response:  # noqa: ARG001
    return Response(status_code=400)


def serve(
    folder: PathLike,
    *,
    host: str,
    port: int,
    token: str | None,
    open_browser: bool,
    **room: Unpack[RoomOptions],
) -> None:
    """Record, show and judge until the user stops it.

    `host`, `port`, `token` and `open_browser` are as of `web.server.run`, all else as of
    `room.Room`.
    """
    token = token_for(host, token)
    subject = None if token is None else secrets.token_urlsafe(12)

    def make() -> tuple[ServedRoom, ASGIApp]:
        served = ServedRoom(folder, **room)
        for sentence in served.room.trials.broken:
            click.echo(f"surae: {sentence}", err=True)
        return served, create_app(served, Policy.of(host, token), subject)

    def more(root: str) -> None:
        mark = "" if subject is None else f"?token={subject}"
        click.echo(f"the subject's page: {root}subject{mark}")

    run(make, "live", host=host, port=port, token=token, open_browser=open_browser, more=more)
