"""What runs in a child: calls come in on standard input, what happens goes out on the output."""

import math
import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import IO, Any

from surae.base.errors import InputError, SuraeError
from surae.base.files import shown
from surae.processes.messages import FULL, NO_ROOM, one_line, received, send, where

#: To the parent; None in a process that is nobody's child.
_channel: IO[bytes] | None = None
_telling = threading.Lock()


def tell(message: Mapping[str, Any]) -> None:
    """Send a message to whoever called this child; without one, nothing happens."""
    if _channel is not None:
        with _telling, without_interrupt():
            send(_channel, {"told": message})


@contextmanager
def without_interrupt() -> Iterator[None]:
    """Ctrl-C waits for the end of what must not be left half done."""
    if threading.current_thread() is not threading.main_thread():
        yield  # Python raises it in the main thread only
        return
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: pressed.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed and callable(before):
        before(signal.SIGINT, None)


class _AtWork:
    """Which call is at work, so that an interrupt never meets a later one.

    An interrupt may come before its call, which waits in the line, is at work: it waits too.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.serial = 0
        self.interrupted = 0


def serve(parent: int, nice: int) -> None:
    """Do calls until standard input ends."""
    global _channel  # noqa: PLW0603  # a process has one parent
    _end_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(OSError, AttributeError):
        os.nice(nice)
    # What libraries print must not come between the messages.
    _channel = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    calls: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
    at_work = _AtWork()
    threading.Thread(target=_listen, args=(calls, at_work), daemon=True).start()
    for request in iter(calls.get, {}):
        end = _called(request, at_work)
        with _telling:
            try:
                send(_channel, end)
            except (TypeError, ValueError) as error:  # what it returned is no plain data
                send(_channel, _failed(error))
            except OSError:  # the parent is gone
                os._exit(0)


def _end_with(parent: int) -> None:
    """Let Linux kill this process with its parent, whose end `_listen` sees elsewhere."""
    if sys.platform != "linux":
        return
    import ctypes

    set_death_signal = 1
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(set_death_signal, int(signal.SIGKILL), 0, 0, 0)
    if os.getppid() != parent:  # it ended before that was set
        os._exit(1)


def _listen(calls: "queue.SimpleQueue[dict[str, Any]]", at_work: _AtWork) -> None:
    """Take calls and interrupts; when standard input ends, so does the process, at once."""
    with suppress(EOFError, OSError):
        while True:
            message = received(sys.stdin.buffer)
            if "call" in message:
                calls.put(message)
                continue
            with at_work.lock:
                at_work.interrupted = message["interrupt"]
                if at_work.interrupted != at_work.serial:
                    continue
                if hasattr(signal, "pthread_kill"):  # which wakes the main thread too
                    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
                else:
                    import _thread

                    _thread.interrupt_main()
    os._exit(0)


def _called(request: Mapping[str, Any], at_work: _AtWork) -> dict[str, Any]:
    """Do one call; the message that ends it."""
    try:
        _limit("RLIMIT_AS", request["memory"])
        # A busy machine makes no file too large: what counts is the work, not the wait.
        seconds = request["seconds"]
        end = None if seconds is None else math.ceil(time.process_time() + seconds)
        _limit("RLIMIT_CPU", end)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with at_work.lock:
                at_work.serial = request["call"]
                if at_work.interrupted == at_work.serial:
                    raise KeyboardInterrupt
            value = function(request["function"])(**request["arguments"])
        finally:
            with at_work.lock:
                at_work.serial = 0
            signal.signal(signal.SIGINT, signal.SIG_IGN)
    except BrokenPipeError:  # the parent is gone
        os._exit(0)
    except (Exception, KeyboardInterrupt) as error:
        return _ended_by(error)
    return {"how": "done", "value": value}


def function(name: str) -> Callable[..., Any]:
    """The function that ``module:name`` means."""
    module, _, attribute = name.partition(":")
    called: Callable[..., Any] = getattr(import_module(module), attribute)
    return called


def _ended_by(error: BaseException) -> dict[str, Any]:
    """How an error ends a call, and its line."""
    stopped = error, error.__cause__ or error.__context__  # compiled code wraps Ctrl-C
    if any(isinstance(cause, KeyboardInterrupt) for cause in stopped):
        return {"how": "cancelled", "message": "stopped before there was a result"}
    if isinstance(error, MemoryError):
        return {"how": "failed", "message": "not enough memory; cut or downsample the recording"}
    if isinstance(error, OSError) and error.errno in FULL:
        place = f"{shown(error.filename)}: " if error.filename else ""
        return {"how": "failed", "message": f"{place}{NO_ROOM}"}
    if isinstance(error, SuraeError):
        how = "refused" if isinstance(error, InputError) else "failed"
        return {"how": how, "message": one_line(error)}
    return _failed(error)


def _failed(error: BaseException) -> dict[str, Any]:
    """A mistake of ours."""
    text = f"internal error ({type(error).__name__}); report it"
    return {"how": "failed", "message": text, "where": where(error)}


def _limit(what: str, limit: int | None) -> None:
    """Limit this process, where the system can, in memory [bytes] or work [s]; None: not by us."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        which = getattr(resource, what)
        hard = resource.getrlimit(which)[1]
        resource.setrlimit(which, (hard if limit is None else limit, hard))
