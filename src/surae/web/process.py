"""The server's end of a worker: start it, give it a task, hear what happens, stop it."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from surae.web.worker import environment

Heard = Callable[[Mapping[str, Any]], None]

#: A worker that was asked to stop and does not is killed after this [s].
_PATIENCE = 20.0
#: A worker is replaced after so many tasks, whatever its libraries still hold.
_TASKS = 50


class Worker:
    """One process that does one task at a time; it is made when it is needed, and made again."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()
        self._busy = self._killed = self._closed = self._interrupted = False
        self._done = self._serial = 0

    @property
    def process(self) -> int | None:
        """The number of the process; None where there is none."""
        return None if self._process is None else self._process.pid

    def run(
        self,
        task: Mapping[str, Any],
        heard: Heard | None = None,
        seconds: float | None = None,
        unless: Callable[[], bool] = lambda: False,
    ) -> dict[str, Any]:
        """Do a task.

        Parameters
        ----------
        task : mapping
            What `surae.web.tasks` does.
        heard : callable, optional
            Called with every message on the way.
        seconds : float, optional
            When the task has taken so long, its process is killed.
        unless : callable, optional
            Whether it was cancelled before it began; from then on `interrupt` reaches it.

        Returns
        -------
        dict
            ``end`` is ``"done"``, ``"refused"``, ``"failed"``, ``"cancelled"`` or, where the
            process died, ``"killed"``.
        """
        with self._lock:
            if self._closed or unless():
                return {"end": "cancelled", "message": "cancelled before it began"}
            process = self._started()
            self._busy, self._killed, self._interrupted = True, False, False
            self._serial += 1
        timer = None if seconds is None else threading.Timer(seconds, self._kill, [self._serial])
        if timer is not None:
            timer.daemon = True
            timer.start()
        end: dict[str, Any] | None = None
        try:
            end = self._heard(process, task, heard)
        finally:
            if timer is not None:
                timer.cancel()
            with self._lock:
                self._busy = False
                self._done += 1
                # Ctrl-C in the middle of an import leaves half a module behind, for good.
                if end is None or self._interrupted or self._done >= _TASKS:
                    self._drop()
        if end is None:
            why = "it took too long" if self._killed else "its process was killed or crashed"
            end = {"end": "killed", "message": f"{why}; nothing else was touched, try again"}
        return end

    def _heard(
        self, process: "subprocess.Popen[bytes]", task: Mapping[str, Any], heard: Heard | None
    ) -> dict[str, Any] | None:
        """The message that ends the task; None where the process died."""
        if process.stdin is None or process.stdout is None:
            return None
        try:
            process.stdin.write((json.dumps(task, allow_nan=False) + "\n").encode())
            process.stdin.flush()
        except OSError:
            return None
        for line in process.stdout:
            try:
                message: dict[str, Any] = json.loads(line)
            except ValueError:  # half a line: it died while it wrote
                return None
            if "end" in message:
                return message
            if heard is not None:
                heard(message)
        return None

    def interrupt(self) -> None:
        """Stop the task at work as Ctrl-C does; kill it when it does not react."""
        with self._lock:
            process = self._process
            if process is None or not self._busy:
                return
            self._interrupted = True
            with suppress(OSError):
                process.send_signal(signal.SIGINT)
            serial = self._serial
        timer = threading.Timer(_PATIENCE, self._kill, [serial])
        timer.daemon = True
        timer.start()

    def close(self) -> None:
        """End the process, for good."""
        with self._lock:
            self._closed = True
            self._drop()

    def _started(self) -> "subprocess.Popen[bytes]":
        if self._process is None or self._process.poll() is not None:
            self._drop()
            self._process = subprocess.Popen(
                [sys.executable, "-m", "surae.web.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment(),
                start_new_session=True,  # Ctrl-C in the server's terminal is the server's
            )
            self._done = 0
        return self._process

    def _kill(self, serial: int) -> None:
        """Kill the process if that task, not a later one, is still at work."""
        with self._lock:
            if self._process is None or not self._busy or serial != self._serial:
                return
            self._killed = True
            _kill_all(self._process)

    def _drop(self) -> None:
        """Let go of the process; it ends with its standard input, or at once."""
        process, self._process = self._process, None
        if process is None:
            return
        _kill_all(process)
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()
        process.wait()


def _kill_all(process: "subprocess.Popen[bytes]") -> None:
    """Kill a worker with the processes that it made, such as a study's; they are its session."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (AttributeError, OSError):  # a system without, or it is gone
        process.kill()
