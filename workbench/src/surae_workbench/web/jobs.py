"""Work that takes time: queued, done by worker processes, followed by browsers, and kept.

A job is an entry of the project from the moment it is asked for. When the server ends, however it
does, those that were not finished are found at the next start and marked as interrupted.
"""

import logging
import queue
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from surae.base.errors import SuraeError
from surae.processes import Child, where
from surae_workbench.web import answers
from surae_workbench.web.database import ACTIVE, new_id
from surae_workbench.web.events import Events, Message
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import Project, when
from surae_workbench.web.rows import Entry
from surae_workbench.web.sessions import BrowserSession

_log = logging.getLogger("surae_workbench.web")

#: Jobs that may wait; more are a script gone wild.
_WAITING = 500
#: Computing must not slow down the pages.
_NICE = 10
#: The line that jobs of some kinds wait in; all others are fits.
_LANES = {"study": "studies", "design": "studies"}

#: Keeps what a task has made; the id of the result, None where there is none.
Finish = Callable[[Entry, Mapping[str, Any]], str | None]


class Jobs:
    """All jobs of a project, of which so many `fits` run at a time.

    One study or design is made beside them.
    """

    def __init__(self, project: Project, events: Events, fits: int) -> None:
        self._project = project
        self._events = events
        self._finish: dict[str, Finish] = {}
        counts = {"fits": fits, "studies": 1}
        self._lanes = {name: queue.SimpleQueue[str | None]() for name in counts}
        self._workers: dict[str, Child] = {}  # by the job that they are at
        self._progress: dict[str, dict[str, Any]] = {}
        self._cancelled: set[str] = set()
        self._lock = threading.Lock()
        self._closed = False
        # What the last server left unfinished.
        for job in () if project.unkept else project.database.active():
            message = "the server ended meanwhile; ask for it again"
            project.change(
                "job", job["id"], state="interrupted", ended=time.time(), message=message
            )
        self._threads = {
            threading.Thread(target=self._serve, args=(name,), daemon=True): name
            for name, count in counts.items()
            for _ in range(count)
        }

    def start(self, finish: Mapping[str, Finish]) -> None:
        """Begin to work; `finish` has what is done with the result of each kind of job."""
        self._finish = dict(finish)
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Stop working; what runs is interrupted, what waits stays for the next start to mark."""
        with self._lock:
            self._closed = True
            workers = list(self._workers.values())
        for worker in workers:
            worker.close()
        for lane in self._threads.values():
            self._lanes[lane].put(None)
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
    ) -> answers.Job:
        """Ask for a job; the answer is how it stands.

        `label` is what lists call it; `task` is what the worker is given; `about` is the entry
        that it is about.
        """
        if self._closed:
            raise RefusedError(503, "the server is shutting down")
        if len(self._project.database.active()) >= _WAITING:
            raise RefusedError(409, f"{_WAITING} jobs are waiting already; cancel some first")
        id_ = new_id()
        self._project.database.add(
            "job",
            {
                "kind": kind,
                "label": label[:200],
                "state": "queued",
                "session": session.key,
                "task": dict(task),
                "about": about,
                "message": "",
                "result": None,
                "started": None,
                "ended": None,
            },
            id_,
        )
        job = self._project.need("job", id_)
        self._tell(job)
        self._lanes[_lane(job)].put(id_)
        return self.shown(job, session)

    def cancel(self, id_: str) -> Entry:
        """Stop a job, as Ctrl-C does: what it has found so far is kept."""
        with self._lock:
            job = self._project.need("job", id_)
            if id_ in self._workers:
                self._cancelled.add(id_)
                self._workers[id_].interrupt()
            elif job["state"] == "queued":
                self._end(id_, "cancelled", "cancelled before it began", None)
            else:
                raise RefusedError(409, f"this job has ended already: {job['state']}")
        return self._project.need("job", id_)

    def of(self, about: str) -> list[Entry]:
        """Jobs about an entry that wait or are at work."""
        return [job for job in self._project.database.active() if job["about"] == about]

    def shown(self, job: Entry, session: BrowserSession | None) -> answers.Job:
        """A job as the API shows it."""
        return answers.Job(
            **{key: job[key] for key in ("id", "kind", "label", "state", "message", "result")},
            fit=job["task"].get("fit"),
            recordings=job["task"].get("recordings", []),
            position=self._position(job),
            created=when(job["created"]),
            progress=self._progress.get(job["id"]) if job["state"] == "running" else None,
            mine=session is not None and job["session"] == session.key,
        )

    def news(self, job: Entry) -> list[Message]:
        """How a job stands, as messages."""
        state = self.shown(job, None).model_dump(exclude={"mine"})
        return [("state", state)] if job["state"] in ACTIVE else [("state", state), ("end", state)]

    def _position(self, job: Entry) -> int | None:
        """Its place among those that wait."""
        if job["state"] != "queued":
            return None
        active = [each for each in self._project.database.active() if _lane(each) == _lane(job)]
        waiting = [each["id"] for each in active if each["state"] == "queued"]
        return waiting.index(job["id"]) + 1 if job["id"] in waiting else None

    def _serve(self, lane: str) -> None:
        """What the thread of one worker does."""
        worker = Child(nice=_NICE)
        while (id_ := self._lanes[lane].get()) is not None and not self._closed:
            try:
                if (job := self._begun(id_, worker)) is not None:
                    self._run(job, worker)
            except Exception as error:  # ours to mend; the others' jobs go on
                _log.error("internal error in a job: %s", where(error))
                with suppress(SuraeError):
                    self._end(id_, "failed", "internal error; the server's log tells more", None)
            finally:
                with self._lock:
                    self._workers.pop(id_, None)
                    self._cancelled.discard(id_)
        worker.close()

    def _begun(self, id_: str, worker: Child) -> Entry | None:
        """A job that a worker takes up; None where it was cancelled while it waited."""
        with self._lock:
            job = self._project.database.get("job", id_)
            if job is None or job["state"] != "queued":
                return None
            job = self._project.change("job", id_, state="running", started=time.time())
            self._workers[id_] = worker
        for waiting in self._project.database.active():
            self._tell(waiting)
        return job

    def _run(self, job: Entry, worker: Child) -> None:
        id_ = job["id"]

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
        stopped = id_ in self._cancelled
        message = end.message
        result = None
        state = "cancelled" if stopped or end.how == "cancelled" else "failed"
        if end.how == "done":
            state = "cancelled" if end.value.get("interrupted") else "done"
            message = str(end.value.get("message", ""))
            try:
                result = self._finish[job["kind"]](job, end.value)
            except SuraeError as refusal:  # what it was about is gone, or the disk is full
                state = "failed"
                message = str(refusal)
        self._end(id_, state, self._project.hidden(message), result)

    def _end(self, id_: str, state: str, message: str, result: str | None) -> None:
        self._progress.pop(id_, None)
        job = self._project.change(
            "job", id_, state=state, message=message, result=result, ended=time.time()
        )
        self._project.database.forget_jobs()
        self._tell(job)

    def _tell(self, job: Entry) -> None:
        for event, data in self.news(job):
            self._events.tell(f"job:{job['id']}", event, data)
        self._events.changed("jobs")


def _lane(job: Entry) -> str:
    return _LANES.get(job["kind"], "fits")
