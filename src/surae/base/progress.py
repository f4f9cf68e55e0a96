"""Callbacks that follow a long computation."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Called with how many parts are done, and how many there are.
Progress = Callable[[int, int], None]
#: Called with how many starts are done, how many there are, and the best sum of squares so far.
SearchProgress = Callable[[int, int, float], None]
#: A line is shown of what takes longer [s], and no more often than so [s].
_PATIENCE = 2.0
_PACE = 0.5


@contextmanager
def line_of_progress(what: str) -> Iterator[Callable[..., None]]:
    """Say on stderr how far something is that takes longer than two seconds, and take it away.

    What is given back is called with (done, total, …), with nothing to say that it goes on, or with
    words, which are shown at once. A terminal or a notebook shows it; a log has no use for it.
    """
    is_seen = sys.stderr.isatty() or "ipykernel" in sys.modules
    begun = last = time.monotonic()
    counted = ""
    width = 0

    def tell(*news: object) -> None:
        nonlocal last, counted, width
        if len(news) > 1 and isinstance(news[0], int):
            counted = f", {news[0]} of {news[1]} done"
        words = next((f", {word}" for word in news if isinstance(word, str)), "")
        now = time.monotonic()
        if is_seen and (words or (now - begun > _PATIENCE and now - last > _PACE)):
            last = now
            text = f"{what}: {now - begun:.0f} s{words or counted}"
            sys.stderr.write(f"\r{text.ljust(width)}")
            sys.stderr.flush()
            width = len(text)

    try:
        yield tell
    finally:
        if width:
            sys.stderr.write(f"\r{' ' * width}\r")
            sys.stderr.flush()
