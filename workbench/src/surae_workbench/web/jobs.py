"""Work that takes time: queued, done by worker processes, followed by browsers, and kept.

A job is an entry of the project from the moment it is asked for. When the server ends, however it
does, those that were not finished are found at the next start and marked as interrupted.
"""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from surae.errors import SuraeError
from surae.processes import Child, where
from surae_workbench.web.cleanup import JOBS
from surae_workbench.web.database import new_id
from surae_workbench.web.events import Events
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import Project, when
from surae_workbench.web.rows import Entry
from surae_workbench.web.sessions import BrowserSession

_log = logging.getLogger("surae_workbench.web")

#: Jobs that may wait; more are a script gone wild.
_WAITING = 500
#: Computing must not slow down the pages.
_NICE = 10
#: What a job is called when its task has ended so.
_ENDS = {
    "done": "done",
    "refused": "failed",
    "failed": "failed",
    "cancelled": "cancelled",
    "killed": "failed",
}

#: Keeps what a task has made; the id of the result, None where there is none.
Finish = Callable[[Entry, Mapping[str, Any]], str | None]


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of job: the lane that it waits in, and what is done with its result."""

    lane: str
    finish: Finish


@dataclass(slots=True)
class _Lane:
    """A queue, and the workers that serve it."""

    waiting: deque[str] = field(default_factory=deque)
    workers: dict[str, Child] = field(default_factory=dict)


class Jobs:
    """All jobs of a project.

    Parameters
    ----------
    project : Project
        Where they are kept.
    events : Events
        Who hears of them.
    lanes : mapping of str to int
        Lanes and the number of jobs that run at a time in each.
    """

    def __init__(self, project: Project, events: Events, lanes: Mapping[str, int]) -> None:
        self._project, self._events = project, events
        self._kinds: dict[str, Kind] = {}
        self._lanes = {name: _Lane() for name in lanes}
        self._progress: dict[str, dict[str, Any]] = {}
        self._cancelled: set[str] = set()
        self._changed = threading.Condition()
        self._closed = False
        self._mark_interrupted()
        self._threads = [
            threading.Thread(target=self._serve, args=(name,), name=f"{name}-{i}", daemon=True)
            for name, count in lanes.items()
            for i in range(count)
        ]

    def start(self, kinds: Mapping[str, Kind]) -> None:
        """Begin to work."""
        self._kinds = dict(kinds)
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Stop working; what runs is interrupted, what waits stays for the next start to mark."""
        with self._changed:
            self._closed = True
            workers = [w for lane in self._lanes.values() for w in lane.workers.values()]
            self._changed.notify_all()
        for worker in workers:
            worker.close()
        for thread in self._threads:
            if thread.is_alive():
                thread.join(5.0)

    def submit(
        self,
        kind: str,
        label: str,
        session: BrowserSession,
        task: Mapping[str, Any],
        about: str | None,
    ) -> dict[str, Any]:
        """Ask for a job; the answer is how it stands.

        `label` is what lists call it; `task` is what the worker is given; `about` is the entry
        that it is about.
        """
        if kind not in self._kinds:
            raise RefusedError(409, f"this surae has no jobs of kind {kind!r}; it stays as it is")
        lane = self._lanes[self._kinds[kind].lane]
        with self._changed:
            if self._closed:
                raise RefusedError(503, "the server is shutting down")
            if len(lane.waiting) >= _WAITING:
                raise RefusedError(409, f"{_WAITING} jobs are waiting already; cancel some first")
            id_ = new_id()
            self._project.database.add(
                "job",
                {
                    "kind": kind, "label": label, "state": "queued", "session": session.key,
                    "task": dict(task), "about": about, "message": "", "result": None,
                    "started": None, "ended": None,
                },
                id_,
            )  # fmt: skip
            lane.waiting.append(id_)
            self._changed.notify_all()
        job = self._project.need("job", id_)
        self._tell(job)
        return self.shown(job, session)

    def cancel(self, id_: str) -> Entry:
        """Stop a job, as Ctrl-C does: what it has found so far is kept."""
        job = self._project.need("job", id_)
        with self._changed:
            lane = self._lanes[self._kinds[job["kind"]].lane]
            if id_ in lane.waiting:
                lane.waiting.remove(id_)
                self._end(id_, "cancelled", "cancelled before it began", None)
            elif id_ in lane.workers:
                self._cancelled.add(id_)
                lane.workers[id_].interrupt()
            else:
                raise RefusedError(409, f"this job has ended already: {job['state']}")
        return self._project.need("job", id_)

    def of(self, about: str) -> list[Entry]:
        """Jobs about an entry that wait or are at work."""
        return [job for job in self._project.database.active() if job["about"] == about]

    def shown(
        self, job: Entry, session: BrowserSession | None, *, traces: bool = True
    ) -> dict[str, Any]:
        """A job as the API shows it."""
        state, progress = job["state"], self._progress.get(job["id"])
        if progress is not None and not traces:
            progress = {key: value for key, value in progress.items() if key != "traces"}
        started, ended = job["started"], job["ended"]
        until = ended or (time.time() if state == "running" else None)
        return {
            **{key: job[key] for key in ("id", "kind", "label", "state", "message", "result")},
            "fit": job["task"].get("fit"),
            "recordings": job["task"].get("recordings", []),
            "position": self._position(job),
            "created": when(job["created"]),
            "started": when(started),
            "ended": when(ended),
            "seconds": None if started is None or until is None else round(until - started, 3),
            "progress": progress if state == "running" else None,
            "mine": session is not None and job["session"] == session.key,
        }

    def _position(self, job: Entry) -> int | None:
        if job["state"] != "queued":
            return None
        with self._changed:
            waiting = self._lanes[self._kinds[job["kind"]].lane].waiting
            return waiting.index(job["id"]) + 1 if job["id"] in waiting else None

    def _serve(self, name: str) -> None:
        """What the thread of one worker does."""
        lane, worker = self._lanes[name], Child(nice=_NICE)
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or lane.waiting)
                if self._closed:
                    break
                id_ = lane.waiting.popleft()
                lane.workers[id_] = worker
            try:
                self._run(id_, worker)
            except Exception as error:  # ours to mend; the others' jobs go on
                _log.error("internal error in a job: %s", where(error))
                with suppress(SuraeError):
                    self._end(id_, "failed", "internal error; the server's log tells more", None)
            finally:
                with self._changed:
                    lane.workers.pop(id_, None)
                    self._cancelled.discard(id_)
        worker.close()

    def _run(self, id_: str, worker: Child) -> None:
        job = self._project.change("job", id_, state="running", started=time.time())
        self._tell(job)
        for queued in list(self._lanes[self._kinds[job["kind"]].lane].waiting):
            waiting = self._project.database.get("job", queued)
            if waiting is not None:
                self._tell(waiting)

        def heard(message: Mapping[str, Any]) -> None:
            self._progress[id_] = dict(message)
            self._events.tell(f"job:{id_}", "progress", dict(message))

        root = str(self._project.folder)  # which may have been copied since it was asked for
        end = worker.call(
            f"surae_workbench.web.tasks:{job['kind']}",
            {"task": {**job["task"], "id": id_, "root": root}},
            hear=heard,
            unless=lambda: id_ in self._cancelled,
        )
        if self._closed:
            return  # marked as interrupted at the next start
        if end.where:
            _log.error("internal error in a worker: %s", end.where)
        state, result = _ENDS[end.how], None
        message = self._project.hidden(end.message)
        if end.how == "done":
            message = self._project.hidden(str(end.value.get("message", "")))
            try:
                result = self._kinds[job["kind"]].finish(job, end.value)
            except SuraeError as refusal:  # what it was about is gone, or the disk is full
                state, message = "failed", str(refusal)
            if end.value.get("interrupted"):
                state = "cancelled"
        elif id_ in self._cancelled:
            state = "cancelled"
        self._end(id_, state, message, result)

    def _end(self, id_: str, state: str, message: str, result: str | None) -> None:
        self._progress.pop(id_, None)
        job = self._project.change(
            "job", id_, state=state, message=message, result=result, ended=time.time()
        )
        self._project.database.forget_jobs(JOBS)
        self._tell(job)
        self._events.tell(f"job:{id_}", "end", self._owned(job))

    def _tell(self, job: Entry) -> None:
        message = self._owned(job)
        self._events.tell(f"job:{job['id']}", "state", message)
        if message["progress"] is not None:
            message = {**message, "progress": {**message["progress"], "traces": []}}
        self._events.tell("project", "job", message)

    def _owned(self, job: Entry) -> dict[str, Any]:
        """A job with the session that owns it, for `seen_by`."""
        return {**self.shown(job, None), "owner": job["session"]}

    @staticmethod
    def seen_by(session: BrowserSession | None, data: Any) -> Any:
        """What a browser hears of a job: whether it is its own, not whose."""
        if not isinstance(data, dict) or "owner" not in data:
            return data
        seen = {key: value for key, value in data.items() if key != "owner"}
        return {**seen, "mine": session is not None and data["owner"] == session.key}

    def _mark_interrupted(self) -> None:
        """Jobs that the last server left unfinished."""
        for job in self._project.database.active():
            self._project.change(
                "job", job["id"], state="interrupted", ended=time.time(),
                message="the server ended meanwhile; ask for it again",
            )  # fmt: skip
