"""A workbench on a free port, browsers that know how to speak to it, and a trial to work on."""

import contextlib
import json
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar

import httpx
import pytest

from answering import Answering
from surae.processes import Child, End
from surae_workbench.web.app import create_app
from surae_workbench.web.security import Policy
from surae_workbench.web.workbench import Workbench

#: Seconds that anything may take on a computer that is busy with other things.
PATIENCE = 300.0


class Browser(httpx.Client):
    """One browser: its own cookies, and the token of its session in every request."""

    def __init__(self, address: str) -> None:
        # The certificates of the world's authorities would be read, and nobody here shows one.
        super().__init__(base_url=address, timeout=PATIENCE, verify=False)
        self.address = address
        self.headers["X-CSRF-Token"] = self.get("/api/session").json()["csrf"]

    def upload(self, path: Path) -> str:
        answer = self.post("/api/uploads", params={"name": path.name}, content=path.read_bytes())
        assert answer.status_code == 201, answer.text
        return str(answer.json()["id"])

    def recording(self, path: Path, **more: Any) -> str:
        """Import a CSV with our column names as it is."""
        content = self.get(f"/api/uploads/{self.upload(path)}/inspect")
        assert content.status_code == 200, content.text
        assert content.json()["ready"], content.text
        answer = self.post("/api/imports", json={"mapping": content.json()["mapping"], **more})
        assert answer.status_code == 201, answer.text
        return str(answer.json()["id"])

    def change(self, **change: Any) -> dict[str, Any]:
        """Change the draft; of the muscle model, which is quick, unless told otherwise."""
        change = {"model": "muscle", **change}
        answer = self.patch("/api/draft", json={"change": change, "label": "test"})
        assert answer.status_code == 200, answer.text
        return dict(answer.json())

    def job(self, answer: httpx.Response) -> dict[str, Any]:
        """Wait for the job that was asked for; to ask how it is would keep it from its work."""
        assert answer.status_code == 202, answer.text
        path = f"/api/jobs/{answer.json()['id']}"
        for _ in self.events(f"{path}/events"):
            pass
        job = self.get(path).json()
        assert job["state"] not in ("queued", "running"), job
        return dict(job)

    def followed(self) -> tuple[dict[str, Any], list[tuple[str, Any]]]:
        """A fit of the draft, and its events from before its end: one may end unheard."""
        for _ in range(20):
            answer = self.post("/api/fits", json={})
            assert answer.status_code == 202, answer.text
            events = list(self.events(f"/api/jobs/{answer.json()['id']}/events"))
            if events[0][1]["state"] in ("queued", "running"):
                break
        return events[-1][1], events

    def events(self, path: str) -> Iterator[tuple[str, Any]]:
        """Server-sent events as they come."""
        end = time.monotonic() + PATIENCE
        with self.stream("GET", path) as answer:
            assert answer.status_code == 200
            event = ""
            for line in answer.iter_lines():
                assert time.monotonic() < end, f"not done in {PATIENCE} s: {event}"
                if line.startswith("event: "):
                    event = line.removeprefix("event: ")
                elif line.startswith("data: "):
                    yield event, json.loads(line.removeprefix("data: "))


class Server:
    """A workbench that answers on this computer."""

    def __init__(self, folder: Path, **policy: Any) -> None:
        self.bench = Workbench(folder, 2)
        app = create_app(self.bench, Policy.of("127.0.0.1", **policy))
        self._answering = Answering(app)
        self.address = self._answering.address
        self._browsers = contextlib.ExitStack()

    def browser(self) -> Browser:
        made = Browser(self.address)
        self._browsers.callback(made.close)
        return made

    def close(self) -> None:
        self._browsers.close()
        self._answering.close()


class LentChild:
    """A child process for the time of a call: then another, or the next server's, has it.

    Each begins with importing what computes, which takes longer than most of what is asked of it.
    """

    _idle: ClassVar[list[Child]] = []

    def __init__(self, nice: int = 0) -> None:
        del nice  # whoever has it next may be in a hurry
        self._child: Child | None = None
        self._closed = False
        self._lock = threading.Lock()

    @property
    def process(self) -> int | None:
        return self._child and self._child.process

    def call(self, *asked: Any, **more: Any) -> End:
        with self._lock:
            if self._closed:
                return End("cancelled", message="cancelled before it began")
            self._child = child = self._idle.pop() if self._idle else Child(calls=None)
        try:
            return child.call(*asked, **more)
        finally:
            with self._lock:
                self._child = None
                if not self._closed:
                    self._idle.append(child)

    def interrupt(self) -> None:
        with self._lock:
            if self._child is not None:
                self._child.interrupt()

    def close(self) -> None:
        with self._lock:
            self._closed = True
            if self._child is not None:
                self._child.close()

    @classmethod
    def end(cls) -> None:
        for child in cls._idle:
            child.close()


Serve = Callable[..., Server]


@pytest.fixture(scope="session", autouse=True)
def lent() -> Iterator[None]:
    """Servers within this process lend each other their children."""
    with pytest.MonkeyPatch.context() as patched:
        for module in ("jobs", "request_workers"):
            patched.setattr(f"surae_workbench.web.{module}.Child", LentChild)
        yield
    LentChild.end()


def least(tries: Callable[[], float], limit: float) -> float:
    """The least of some times, the first below `limit` if any: what else a computer does adds."""
    end, least = time.monotonic() + 60.0, tries()
    while least >= limit and time.monotonic() < end:
        least = min(least, tries())
    return least


@pytest.fixture(scope="session")
def trial(trial_csv) -> Path:
    return trial_csv


@pytest.fixture
def serve(tmp_path) -> Iterator[Serve]:
    """Start a server on a project of its own; all end with the test."""
    with contextlib.ExitStack() as stack:

        def start(name: str = "project", **policy: Any) -> Server:
            server = Server(tmp_path / name, **policy)
            stack.callback(server.close)
            return server

        yield start


@pytest.fixture(scope="session")
def server(tmp_path_factory) -> Iterator[Server]:
    """One server for tests that leave nothing behind that another would meet."""
    made = Server(tmp_path_factory.mktemp("web") / "project")
    yield made
    made.close()


@pytest.fixture
def browser(server) -> Browser:
    return server.browser()


@pytest.fixture(scope="session")
def recorded(server, trial) -> str:
    """The trial in the shared server's project."""
    return server.browser().recording(trial)
