"""Short work in a process of its own: files of users are read where they can do no harm."""

import logging
import queue
import threading
from typing import Any

from surae.processes import Child
from surae_workbench.web.http_errors import RefusedError

#: Longest that one piece of work may take [s], and the memory that it may use [bytes].
_SECONDS = 180.0
_MEMORY = 12 * 2**30
#: Behind the pages, but ahead of fits, which nobody waits for in front of a page.
_NICE = 3
#: Pieces of work at a time, and how many requests may wait for them.
_WORKERS = 2
_WAITING = 100
#: Threads that answer requests: those that wait take none from the pages.
THREADS = _WAITING + 40
_log = logging.getLogger("surae_workbench.web")


class RequestWorkers:
    """A few workers for what a request waits for."""

    def __init__(self) -> None:
        self._all = [Child(nice=_NICE) for _ in range(_WORKERS)]
        # Who was busy last has loaded what most requests need: nobody waits for that twice.
        self._free: queue.LifoQueue[Child] = queue.LifoQueue()
        for worker in self._all:
            self._free.put(worker)
        self._room = threading.Semaphore(_WORKERS + _WAITING)
        self._closed = False

    def close(self) -> None:
        """End the processes."""
        self._closed = True
        for worker in self._all:
            worker.close()

    def ask(self, function: str, **arguments: Any) -> Any:
        """Call a function of the workbench's, ``module:name``, now, and wait for what it returns.

        It is refused with the function's own line, where that was refused or failed.
        """
        if not self._room.acquire(blocking=False):
            raise RefusedError(
                503, f"{_WAITING} requests wait for files to be read; try again later"
            )
        worker = self._free.get()
        try:
            name = f"surae_workbench.web.{function}"
            end = worker.call(name, arguments, seconds=_SECONDS, memory=_MEMORY)
        finally:
            self._free.put(worker)
            self._room.release()
        if end.how == "done":
            return end.value
        if self._closed:
            raise RefusedError(503, "the server is shutting down")
        if end.where:
            _log.error("internal error in a worker: %s", end.where)
        raise RefusedError(400 if end.how == "refused" else 422, end.message)
