"""A process of its own that computes: tasks come in as lines of JSON, what happens goes out so.

Run as ``python -m surae.web.worker``. Nothing but JSON passes, results are files. SIGINT stops the
task at work as Ctrl-C stops the command line: the best so far is kept. The process ends with its
standard input, that is, with the server, however that ended.
"""

import contextlib
import json
import os
import signal
import sys
from collections.abc import Callable, Mapping
from typing import Any

from surae.errors import InputError, SuraeError
from surae.web.refusals import one_line

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

    for line in sys.stdin.buffer:
        tell(_done(json.loads(line), tell))


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
        end, message = _told(error)
        return {"end": end, "message": message}


def _told(error: BaseException) -> tuple[str, str]:
    """How an error ends a task, and its line."""
    stopped = error, error.__cause__ or error.__context__  # compiled code wraps Ctrl-C
    if any(isinstance(one, KeyboardInterrupt) for one in stopped):
        return "cancelled", "stopped before there was a result"
    if isinstance(error, MemoryError):
        return "failed", "not enough memory; cut or downsample the recording"
    if isinstance(error, SuraeError):
        return "refused" if isinstance(error, InputError) else "failed", one_line(error)
    return "failed", one_line(f"internal error ({type(error).__name__}: {error})")


def _limit_memory(limit: int) -> None:
    """Refuse memory beyond a limit [bytes], where the system can."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (limit, resource.getrlimit(resource.RLIMIT_AS)[1]))


if __name__ == "__main__":
    main()
