"""Everything that a running server has: the project, its browsers, its workers and its caches."""

import threading
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from surae import api
from surae.base.files import PathLike
from surae_workbench.web import sliders
from surae_workbench.web.caches import Cache
from surae_workbench.web.events import Events
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.imports import read_recording
from surae_workbench.web.jobs import Jobs
from surae_workbench.web.places import plural
from surae_workbench.web.project import Project
from surae_workbench.web.request_workers import RequestWorkers
from surae_workbench.web.rows import Entry
from surae_workbench.web.sessions import BrowserSession, BrowserSessions

#: Memory for recordings, for what models read, and for reports [bytes].
_RECORDINGS = 400e6
_PREPARED = 400e6
_REPORTS = 40e6


class Workbench:
    """The server's state, behind all routes: one project, so many fits at a time (`workers`)."""

    def __init__(self, folder: PathLike, workers: int) -> None:
        self.project = Project(folder)
        self.database = self.project.database
        self.events = Events()
        self.sessions = BrowserSessions(self.project, self.events)
        self.jobs = Jobs(self.project, self.events, workers)
        self.workers = RequestWorkers()
        self.reports: Cache[bytes] = Cache(_REPORTS, len)
        self._recordings: Cache[api.Recording] = Cache(
            _RECORDINGS, lambda kept: sum(16.0 * len(c.values) for c in kept.channels.values())
        )
        self._prepared: Cache[api.ModelInputs] = Cache(_PREPARED, lambda kept: 80.0 * kept.n)

    def warm(self) -> None:
        """Load what sliders and reports need, before somebody waits for it."""

        def load() -> None:
            with suppress(Exception):
                sliders.warm()
                self.workers.ask("tasks:warm")

        threading.Thread(target=load, name="warm", daemon=True).start()

    def stop(self) -> None:
        """End streams, jobs and what requests wait for."""
        self.events.close()
        self.workers.close()
        self.jobs.close()

    def close(self) -> None:
        """Let go of everything; once is enough."""
        self.stop()
        self.project.close()

    def recording(self, id_: str) -> api.Recording:
        """A recording of the project."""
        row = self.project.need("recording", id_)
        return self._recordings.get(
            (id_, row.get("version", 0)), lambda: read_recording(self.project.recording_path(row))
        )

    def prepared(self, id_: str, settings: api.FitSettings) -> api.ModelInputs:
        """What a model reads of a recording, prepared as a fit asks, EMG in its own unit."""
        version = self.project.need("recording", id_).get("version", 0)
        key = (id_, version, settings.prepared, settings.preparation)
        return self._prepared.get(key, lambda: settings.prepare(self.recording(id_)))

    def delete(self, session: BrowserSession, kind: str, id_: str) -> None:
        """Delete an entry so that undo brings it back; its files stay."""
        row = self.project.need(kind, id_)
        name = row["code"] if kind == "subject" else row["name"]
        if self.jobs.of(id_):
            raise RefusedError(409, f"a job is at work on this {kind}; cancel it first")
        if any(each["subject"] == id_ for each in self.database.all("recording")):
            raise RefusedError(409, f"subject {name} has recordings; move or delete them first")
        self.sessions.delete(session, kind, id_, f"delete {kind} {name}"[:120])
        self.events.changed(plural(kind))

    def draft_recordings(self, draft: Mapping[str, Any]) -> list[Entry]:
        """The recordings of a draft."""
        if not draft["recordings"]:
            raise RefusedError(400, "no recording is chosen; choose at least one")
        return [self.project.need("recording", id_) for id_ in draft["recordings"]]
