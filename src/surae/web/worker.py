"""A process of its own that computes: tasks come in as lines of JSON, what happens goes out so.

Run as ``python -m surae.web.worker``. Nothing but JSON passes, results are files. SIGINT stops the
task at work as Ctrl-C stops the command line: the best so far is kept. The process ends with its
standard input, that is, with the server, however that ended.
"""

import contextlib
import json
import os
import queue
import signal
import sys
import threading
from collections.abc import Callable, Mapping
from typing import Any

from surae.errors import InputError, SuraeError
from surae.web.http_errors import FULL, NO_ROOM, one_line, where

#: Computing must not slow down the pages.
_NICE = 10
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")

Tell = Callable[[Mapping[str, Any]], None]


def environment() -> dict[str, str]:
    """The environment of a worker: one thread for linear algebra."""
    return {**os.environ, **dict.fromkeys(_THREADS, "1")}


def main() -> None:
    """Do tasks until standard input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(OSError, AttributeError):
        os.nice(_NICE)
    # What libraries print must not come between the lines of the protocol.
    out = os.dup(1)
    os.dup2(2, 1)

    def tell(message: Mapping[str, Any]) -> None:
        data = (json.dumps(message, allow_nan=False) + "\n").encode()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            while data:
                data = data[os.write(out, data) :]
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(tasks,), daemon=True).start()
    while True:
        end = _done(json.loads(tasks.get()), tell)
        try:
            tell(end)
        except (TypeError, ValueError) as error:  # what it found is nothing that JSON can say
            tell(_failed(error))


def _listen(tasks: "queue.SimpleQueue[bytes]") -> None:
    """Take tasks; when standard input ends, so does the process, even in the middle of one."""
    for line in sys.stdin.buffer:
        tasks.put(line)
    os._exit(0)


def _done(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Do one task; the message that ends it."""
    limit = task.get("memory")
    try:
        if limit is not None:
            _limit_memory(int(limit))
        signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            from surae.web.tasks import TASKS

            return {"end": "done", **TASKS[task["do"]](task, tell)}
        finally:
            signal.signal(signal.SIGINT, signal.SIG_IGN)
    except BrokenPipeError:  # the server is gone
        raise SystemExit(0) from None
    except (Exception, KeyboardInterrupt) as error:
        return _told(error)


def _told(error: BaseException) -> dict[str, Any]:
    """How an error ends a task, and its line."""
    stopped = error, error.__cause__ or error.__context__  # compiled code wraps Ctrl-C
    if any(isinstance(one, KeyboardInterrupt) for one in stopped):
        return {"end": "cancelled", "message": "stopped before there was a result"}
    if isinstance(error, MemoryError):
        text = "not enough memory; cut or downsample the recording"
        return {"end": "failed", "message": text}
    if isinstance(error, OSError) and error.errno in FULL:
        return {"end": "failed", "message": NO_ROOM}
    if isinstance(error, SuraeError):
        end = "refused" if isinstance(error, InputError) else "failed"
        return {"end": end, "message": one_line(error)}
    return _failed(error)


def _failed(error: BaseException) -> dict[str, Any]:
    """A mistake of ours."""
    text = f"internal error ({type(error).__name__}); the server's log tells more"
    return {"end": "failed", "message": text, "where": where(error)}


def _limit_memory(limit: int) -> None:
    """Refuse memory beyond a limit [bytes], where the system can."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (limit, resource.getrlimit(resource.RLIMIT_AS)[1]))


if __name__ == "__main__":
    main()
