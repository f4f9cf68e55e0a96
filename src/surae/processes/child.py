"""A child process that does calls, one at a time: started, asked, stopped, and made again."""

import os
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from surae.base.errors import ComputationError, InputError
from surae.processes.messages import received, send

#: What JSON holds, with bytes and arrays of numbers anywhere in it.
Plain = Any
Hear = Callable[[Mapping[str, Any]], None]

#: A child that was asked to stop and does not is killed after this [s].
_PATIENCE = 20.0
#: What a call may take by the clock, as a multiple of its processor time: machines are busy.
_WAITING = 6.0
#: A child is made anew after so many calls, whatever its libraries still hold.
_CALLS = 50
#: One thread for linear algebra, in the words of the libraries.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True, slots=True)
class End:
    """How a call ended."""

    #: "done", "refused", "failed", "cancelled", "killed": "refused" where the input was wrong;
    #: "killed" where the process died.
    how: str
    value: Plain = None  #: What the function returned, where it is done.
    message: str = ""  #: Else why there is none, in a line.
    #: The lines of code of an error that should not have been; without its text, which may hold
    #: names.
    where: str = ""

    def result(self) -> Plain:
        """What the function returned; its InputError, or for all else a ComputationError."""
        if self.how == "done":
            return self.value
        kind = InputError if self.how == "refused" else ComputationError
        raise kind(self.message + (f" ({self.where})" if self.where else ""))


class Child:
    """One process that does one call at a time, made when needed, and anew after so many `calls`.

    It ends with whoever holds this, closed or not; `nice` is by how much it makes way for others.
    """

    def __init__(self, nice: int = 0, calls: int | None = _CALLS) -> None:
        self._nice = nice
        self._calls = calls
        self._process: subprocess.Popen[bytes] | None = None
        self._end: weakref.finalize[..., Child] | None = None
        self._owner = 0
        self._lock = threading.Lock()
        _children.add(self)
        self._busy = self._killed = self._closed = self._interrupted = False
        self._done = self._serial = 0

    @property
    def process(self) -> int | None:
        """The number of the process; None where there is none."""
        return None if self._process is None else self._process.pid

    def call(
        self,
        function: str,
        arguments: Mapping[str, Plain],
        *,
        hear: Hear | None = None,
        seconds: float | None = None,
        memory: int | None = None,
        unless: Callable[[], bool] = lambda: False,
    ) -> End:
        """Call a function, ``module:name``, and wait for what it returns.

        `hear` is called with every message that it tells on the way. When it has worked for
        `seconds` (processor time, where the system counts it), or has taken six times as long by
        the clock, the process is killed; `memory` is the address space that it may use [bytes],
        where the system can limit it. `unless` says whether it was cancelled before it began; from
        then on `interrupt` reaches it.
        """
        with self._lock:
            if self._closed or unless():
                return End("cancelled", message="cancelled before it began")
            process = self._started()
            self._busy = True
            self._killed = False
            self._interrupted = False
            self._serial += 1
            serial = self._serial
        wait = None if seconds is None else _WAITING * seconds
        timer = None if wait is None else _later(wait, lambda: self._kill(serial))
        end: End | None = None
        try:
            request = {
                "call": serial,
                "function": function,
                "arguments": arguments,
                "memory": memory,
                "seconds": seconds,
            }
            end = _conversation(process, request, hear)
        finally:
            if timer is not None:
                timer.cancel()
            with self._lock:
                self._busy = False
                self._done += 1
                # Ctrl-C in the middle of an import leaves half a module behind, for good.
                if end is None or self._interrupted or self._done == self._calls:
                    self._drop()
        if end is not None:
            return end
        late = self._killed or process.returncode == -getattr(signal, "SIGXCPU", 0)
        why = "it took too long" if late else "its process was killed or crashed"
        return End("killed", message=f"{why}; nothing else was touched, try again")

    def interrupt(self) -> None:
        """Stop the call at work as Ctrl-C does; kill its process when it does not react."""
        with self._lock:
            process = self._process
            if process is None or process.stdin is None or not self._busy:
                return
            self._interrupted = True
            serial = self._serial
            with suppress(OSError):
                send(process.stdin, {"interrupt": serial})
        _later(_PATIENCE, lambda: self._kill(serial))

    def close(self) -> None:
        """End the process, for good."""
        with self._lock:
            self._closed = True
            self._drop()

    def _started(self) -> "subprocess.Popen[bytes]":
        if self._owner != os.getpid():  # a copy of this program: the child is the original's
            self._process, self._owner = None, os.getpid()
        if self._process is None or self._process.poll() is not None:
            self._drop()
            self._process = _start(self._nice)
            self._end = weakref.finalize(self, _ended, self._process, self._owner)
            self._done = 0
        return self._process

    def _kill(self, serial: int) -> None:
        """Kill the process if that call, not a later one, is still at work."""
        with self._lock:
            if self._process is not None and self._busy and serial == self._serial:
                self._killed = True
                self._process.kill()

    def _drop(self) -> None:
        self._process = None
        if self._end is not None:
            self._end()


def _ended(process: "subprocess.Popen[bytes]", owner: int) -> None:
    """Kill a process and wait for its end; in a copy of the program that made it, do nothing."""
    if owner != os.getpid():
        return
    process.kill()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError):
                stream.close()
    process.wait()


def guarded(
    function: str,
    arguments: Mapping[str, Plain],
    *,
    seconds: float | None = None,
    memory: int | None = None,
) -> Plain:
    """Call a function where it can do no harm: in a child that is kept for the next call.

    A child has one of its own for that, so that the limits hold there too; they are those of
    `Child.call`. An InputError is the function's own; all else is a ComputationError.
    """
    with _keeping():
        return _guarded_child().call(function, arguments, seconds=seconds, memory=memory).result()


#: All of this program.
_children: "weakref.WeakSet[Child]" = weakref.WeakSet()


@cache
def _keeping() -> threading.Lock:
    """Held while the child of `guarded` is at work."""
    return threading.Lock()


@cache
def _guarded_child() -> Child:
    """The child of `guarded`."""
    return Child()


def _copied() -> None:
    """In a copy of this program: locks that other threads held are nobody's now, nor their work."""
    for made in (_keeping, _guarded_child):
        made.cache_clear()
    for child in tuple(_children):
        child._lock = threading.Lock()
        child._busy = False
        child._process = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_copied)


def _later(seconds: float, action: Callable[[], None]) -> threading.Timer:
    timer = threading.Timer(seconds, action)
    timer.daemon = True
    timer.start()
    return timer


def _start(nice: int) -> "subprocess.Popen[bytes]":
    """A child that waits for calls."""
    code = (
        f"import sys; sys.path[:] = {_import_path()!r}; "
        f"from surae.processes.inside import serve; serve({os.getpid()}, {nice})"
    )
    return (
        _starter(os.getpid())
        .submit(
            subprocess.Popen,
            [sys.executable, "-P", "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, "PYTHONSAFEPATH": "1", **dict.fromkeys(_THREADS, "1")},
        )
        .result()
    )


@cache
def _starter(owner: int) -> ThreadPoolExecutor:
    """The thread that starts children: Linux ends them with the thread that they come from."""
    del owner
    return ThreadPoolExecutor(1, "surae-start")


def _import_path() -> list[str]:
    """List where this program imports from, without the working folder that Python put first."""
    path = [entry for entry in sys.path if entry and Path(entry).is_absolute()]
    first = sys.path[0] if sys.path else ""
    if path and path[0] == first and not sys.flags.safe_path and Path(first) == Path.cwd():
        del path[0]
    ours = str(Path(__file__).resolve().parents[2])
    return path if ours in path else [*path, ours]


def _conversation(
    process: "subprocess.Popen[bytes]", request: Mapping[str, Any], hear: Hear | None
) -> End | None:
    """Ask, and hear what happens until the end of it; None where the process died."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        send(process.stdin, request)
        while True:
            message = received(process.stdout)
            if "told" not in message:
                texts = {name: str(message.get(name, "")) for name in ("message", "where")}
                return End(str(message.get("how")), message.get("value"), **texts)
            if hear is not None:
                hear(message["told"])
    except (OSError, EOFError):
        return None
