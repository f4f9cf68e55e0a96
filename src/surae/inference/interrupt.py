"""Ctrl-C between two evaluations of a model, never within one.

Python turns the signal into an exception wherever it happens to be. Within the machinery of
compiled code that exception is lost or becomes another one, and so would be the best fit so far.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_requested = threading.Event()


@contextmanager
def postponed_interrupt() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt at the next `checkpoint`; a second one at once.

    Does nothing outside the main thread, or where somebody else handles the signal.
    """
    if (
        threading.current_thread() is not threading.main_thread()
        or signal.getsignal(signal.SIGINT) is not signal.default_int_handler
    ):
        yield
        return

    def handle(number: int, frame: FrameType | None) -> None:
        if _requested.is_set():
            signal.default_int_handler(number, frame)
        _requested.set()

    _requested.clear()
    signal.signal(signal.SIGINT, handle)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        _requested.clear()


def checkpoint() -> None:
    """Raise KeyboardInterrupt where Ctrl-C was pressed since the last time."""
    if _requested.is_set() and threading.current_thread() is threading.main_thread():
        _requested.clear()
        raise KeyboardInterrupt
