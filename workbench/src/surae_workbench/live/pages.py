"""The operator's page and the subject's, with what they ask for."""

import secrets
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, Literal, Unpack

import click
import numpy as np
from fastapi import Body, FastAPI, Request, Response
from fastapi.responses import JSONResponse, StreamingResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send

from surae._version import __version__
from surae.api import DEVICES, PROFILES, TASKS, Trajectory, ready_protocols
from surae.base.errors import InputError
from surae.base.files import PathLike, template
from surae.base.names import TELLING
from surae_workbench.live.mapping import CHOSEN_ROLES, Chosen
from surae_workbench.live.room import (
    MAXIMUM,
    QUIET,
    Room,
    RoomOptions,
    is_unclear,
    sends_nothing,
)
from surae_workbench.live.showing import Showing, guessed_roles
from surae_workbench.live.target import KIND
from surae_workbench.web.app import bare_app
from surae_workbench.web.events import Events
from surae_workbench.web.language import spoken
from surae_workbench.web.security import Policy, Security
from surae_workbench.web.server import Address, run
from surae_workbench.web.sessions import BrowserSession, key_of

_HERE = Path(__file__).parent
_SUBJECT = ("/subject", "/api/subject")
#: The state of streams and disk is told this often [s].
_HEALTH = 0.5
#: Points of a target's curve on the screen each second.
_POINTS = 20.0


#: What can be loaded, with what each is good for: designed ones first.
_MOVEMENTS = [
    *(
        {"name": each.name, "description": each.description, "designed": True}
        for each in ready_protocols().values()
    ),
    *({"name": name, "description": TELLING[name], "designed": True} for name in TELLING),
    *({"name": each.name, "description": each.description} for each in PROFILES.values()),
    {"name": MAXIMUM, "description": "Largest efforts, held still: what all others are a part of."},
]


class RoomBrowsers:
    """Browsers kept apart by a cookie, for as long as the program runs."""

    def __init__(self, name: str) -> None:
        self.project_id = f"{name}_{secrets.token_hex(4)}"
        self._known: dict[str, BrowserSession] = {}

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
    """A room, made as `Room` is, and the pages that show it."""

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
        room = self.room
        trials = self.room.trials
        low, high = np.degrees(room.range)
        return {
            **self.moment(),
            "curve": _curve(room.trajectory),
            "folder": trials.folder.name,
            "rehearsal": room.laboratory is not None,
            "trials": [trials.trials[number].shown() for number in sorted(trials.trials)],
            "session": trials.session,
            "asked": room.planned,
            "moves": {
                "device": None if room.device is None else room.device.name,
                "devices": list(DEVICES),
                "low": f"{low:.0f}",
                "high": f"{high:.0f}",
            },
            **self.health(),
            "limits": room.limits,
            "profiles": _MOVEMENTS,
            "tasks": list(TASKS),
        }

    def moment(self) -> dict[str, Any]:
        """Which trial is running, and since when; LSL's time."""
        room = self.room
        trials = self.room.trials
        return {"running": trials.running, "begin": room.begin, "now": trials.recorder.clock()}

    def subject(self) -> dict[str, Any]:
        """What the subject's page shows: nothing else."""
        return {**self.moment(), "curve": _curve(self.room.trajectory, angle=False)}

    def health(self) -> dict[str, Any]:
        """How streams and disk do."""
        trials = self.room.trials
        roles = self.room.roles
        self.showing.roles = roles or guessed_roles(trials.offered())
        message, given = trials.recorder.trouble_said
        streams = [s for s in trials.recorder.health() if s["kind"] != KIND]
        quiet = [sends_nothing(s["name"]) for s in streams if s["state"] in QUIET]
        unclear = [is_unclear(message, given) for message, given in trials.doubts]
        return {
            "streams": [{**s, **self._use(s["name"])} for s in streams],
            "mapped": bool(roles),
            "trouble": trials.recorder.trouble,
            "trouble_said": {"message": message, "given": given},
            "roles": sorted(role for role, _, _ in self.showing.roles.values()),
            "ready": self.room.ready,
            "alarms": [alarm.shown() for alarm in (*unclear, *quiet, *self.room.alarms.active)],
        }

    def _use(self, name: str) -> dict[str, Any]:
        """What a stream is good for: its signals, and whether a trial of them was judged well.

        ``bad`` names the newest judged trial in which one of its signals has an error.
        """
        trials = self.room.trials
        streams = (s for s in list(trials.recorder.streams.values()) if s.called == name)
        columns = [column for stream in streams for column in stream.columns]
        used = self.room.roles
        roles = [used[column][0] for column in columns if column in used]
        judged = [t for t in trials.trials.values() if t.state == "judged" and not t.is_unread]
        last = max(judged, key=lambda trial: trial.trial, default=None)
        errors = {
            each["channel"]
            for each in (last.findings if last is not None else ())
            if each.get("severity") == "error"
        }
        bad = last.trial if last is not None and errors & {*roles} else None
        return {"roles": roles, "judged": last is not None, "bad": bad}

    def _frame(self, frame: dict[str, Any]) -> None:
        self.events.tell("frames", "frame", frame)
        self.events.tell(
            "subject",
            "effort",
            {"t": frame["t"], "effort": frame["effort"], "asked": frame["asked"][1:]},
        )

    def _tell(self, event: str, data: Mapping[str, Any]) -> None:
        self.events.tell("room", event, dict(data))

    def _health(self) -> None:
        while not self._ended.wait(_HEALTH):
            with suppress(Exception):  # the next one may do
                self.events.tell("room", "health", self.health())


_Seconds = Annotated[float, Body(ge=0, le=3600, embed=True)]
_Text = Annotated[str, Body(max_length=200, embed=True)]


class _Channel(BaseModel):
    """The channel that a signal was chosen to be."""

    model_config = ConfigDict(extra="forbid")
    column: str = Field(max_length=400)
    unit: str | None = Field(None, max_length=40)
    sign: Literal[1, -1] = 1


class _Choice(BaseModel):
    """A choice of channels; with `again`, trials are judged again by it."""

    model_config = ConfigDict(extra="forbid")
    channels: dict[Literal[CHOSEN_ROLES], _Channel]  # type: ignore[valid-type]
    emg: Literal["raw", "envelope"] | None = None
    again: bool = False


def create_app(served: ServedRoom, policy: Policy, subject: str | None) -> ASGIApp:
    """The pages as an ASGI application.

    `policy` says who may operate; `subject` is the token of the subject's page, which opens nothing
    else; None where nobody needs one.
    """

    def answer(request: Request, status: int, text: str, headers: Any = None) -> Response:  # noqa: ARG001
        return JSONResponse({"error": text}, status, headers)

    app = bare_app(answer)
    app.router.routes.insert(0, Mount("/static/live", StaticFiles(directory=_HERE / "static")))
    _add_page(app, "/", "operator")
    _add_page(app, "/subject", "subject")
    _add_views(app, served)
    _add_actions(app, served)
    operator = Security(app, policy, RoomBrowsers("live"))
    second = Policy(policy.hosts, policy.any_address, subject, policy.upload_bytes)
    watching = Security(app, second, RoomBrowsers("live_subject"))

    async def dispatched(scope: Scope, receive: Receive, send: Send) -> None:
        """The subject's page, and the files that it is drawn with, have a token of their own."""
        await (watching if _of_subject(scope) else operator)(scope, receive, send)

    return dispatched


def _of_subject(scope: Scope) -> bool:
    """Whether a request is of the subject's page."""
    path = scope.get("path", "")
    if not path.startswith("/static/"):
        return bool(path.startswith(_SUBJECT))
    cookies = b"; ".join(v for k, v in scope["headers"] if k == b"cookie")
    theirs = b"surae_token_live_subject_"
    return theirs in cookies and b"surae_token_live_" not in cookies.replace(theirs, b"")


def _add_page(app: FastAPI, path: str, name: str) -> None:
    """A page, of its template."""

    @app.get(path)
    def shown(request: Request) -> Response:
        text = template(f"{name}.html.j2", "surae_workbench.live").render(
            csrf=request.state.session.csrf, version=__version__, **spoken(request)
        )
        return Response(text, media_type="text/html")


def _add_views(app: FastAPI, served: ServedRoom) -> None:
    """What pages show: as it is now, and what is new."""

    @app.get("/api/live")
    def state() -> dict[str, Any]:
        return served.state()

    @app.get("/api/live/events")
    async def news() -> StreamingResponse:
        return served.events.answer("frames", "room")

    @app.get("/api/subject")
    def subject_state() -> dict[str, Any]:
        return served.subject()

    @app.get("/api/subject/events")
    async def subject_news() -> StreamingResponse:
        return served.events.answer("subject")


def _add_actions(app: FastAPI, served: ServedRoom) -> None:
    """What the operator may do."""
    room = served.room

    @app.post("/api/live/start")
    def start(countdown: _Seconds = 3.0) -> dict[str, int]:
        return {"trial": room.start(countdown)}

    @app.post("/api/live/stop")
    def stop() -> None:
        room.stop()

    @app.post("/api/live/mark")
    def mark(text: _Text = "") -> None:
        room.trials.mark(text)

    @app.post("/api/live/load")
    def load(
        profile: _Text, task: _Text, seconds: _Seconds = 35.0, chirp_amplitude: _Seconds = 0.1
    ) -> None:
        room.load(profile=profile, task=task, duration=seconds, chirp_amplitude=chirp_amplitude)

    @app.post("/api/live/device")
    def device(name: _Text = "") -> None:
        if name and name not in DEVICES:  # no page names a file of this computer
            raise InputError(f"device {name!r} is not known; use one of: {', '.join(DEVICES)}")
        room.choose_device(name or None)

    @app.get("/api/live/channels")
    def channels() -> dict[str, Any]:
        return room.trials.offered()

    @app.post("/api/live/channels")
    def choose(choice: _Choice) -> None:
        chosen = {
            role: Chosen(column=each.column, unit=each.unit, sign=each.sign)
            for role, each in choice.channels.items()
        }
        room.trials.choose(chosen, choice.emg, again=choice.again)

    @app.post("/api/live/tells")
    def tells() -> dict[str, list[str]]:
        return {"tells": room.tells()}

    @app.post("/api/live/next")
    def load_next() -> None:
        room.load_next()

    @app.post("/api/live/forget")
    def forget() -> None:
        served.showing.forget()

    @app.post("/api/live/fault")
    def fault(kind: _Text, at: Annotated[float | None, Body(ge=0, le=3600)] = None) -> None:
        if room.laboratory is None:
            raise InputError("this is no rehearsal: nothing can be made to go wrong")
        room.laboratory.fault(kind=kind, **({} if at is None else {"at": at}))


def serve(folder: PathLike, address: Address, **room: Unpack[RoomOptions]) -> None:
    """Record, show and judge until the user stops it; `room` is as of `Room`."""
    subject = None if address.token is None else secrets.token_urlsafe(12)

    def make() -> tuple[ServedRoom, ASGIApp]:
        served = ServedRoom(folder, **room)
        for sentence in served.room.trials.broken:
            click.echo(f"surae: {sentence}", err=True)
        return served, create_app(served, Policy.of(address.host, address.token), subject)

    def more(root: str) -> None:
        mark = "" if subject is None else f"?token={subject}"
        click.echo(f"the subject's page: {root}subject{mark}")

    run(make, "live", address, more)
