"""Short work in a process of its own: files of users are read where they can do no harm."""

import logging
import threading
from collections.abc import Callable
from typing import Any

from surae.processes import Child
from surae_workbench.web.http_errors import RefusedError

#: Longest that one piece of work may take [s], and the memory that it may use [bytes].
_SECONDS, _MEMORY = 180.0, 12 * 2**30
#: Behind the pages, but ahead of fits, which nobody waits for in front of a page.
_NICE = 3
_log = logging.getLogger("surae_workbench.web")
#: Pieces of work at a time, and how many requests may wait for them.
_WORKERS, _WAITING = 2, 100
#: Threads that answer requests: those that wait take none from the pages.
THREADS = _WAITING + 40


class RequestWorkers:
    """A few workers for what a request waits for.

    `changed` is called with how many requests wait, whenever that changes.
    """

    def __init__(self, changed: Callable[[int], None]) -> None:
        self._tell = changed
        self._free = [Child(nice=_NICE) for _ in range(_WORKERS)]
        self._all = tuple(self._free)
        self._changed = threading.Condition()
        self._closed = False
        #: Requests that wait for one.
        self.waiting = 0

    def close(self) -> None:
        """End the processes."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        for worker in self._all:
            worker.close()

    def ask(self, function: str, **arguments: Any) -> Any:
        """Call a function of the workbench's, ``module:name``, now, and wait for what it returns.

        It is refused with the function's own line, where that was refused or failed.
        """
        with self._changed:
            if not self._free:
                if self.waiting >= _WAITING:
                    raise RefusedError(
                        503, f"{_WAITING} requests wait for files to be read; try again later"
                    )
                self._wait(+1)
                try:
                    self._changed.wait_for(lambda: self._closed or self._free)
                finally:
                    self._wait(-1)
            if self._closed:
                raise RefusedError(503, "the server is shutting down")
            worker = self._free.pop()
        try:
            end = worker.call(
                f"surae_workbench.web.{function}", arguments, seconds=_SECONDS, memory=_MEMORY
            )
        finally:
            with self._changed:
                self._free.append(worker)
                self._changed.notify()
        if end.how != "done" and self._closed:
            raise RefusedError(503, "the server is shutting down")
        if end.how != "done":
            if end.where:
                _log.error("internal error in a worker: %s", end.where)
            raise RefusedError(400 if end.how == "refused" else 422, end.message)
        return end.value

    def _wait(self, more: int) -> None:
        """So many more wait, or fewer."""
        self.waiting += more
        self._tell(self.waiting)
