"""News for browsers: what happens anywhere in the server reaches every stream that listens."""

import asyncio
import json
import threading
from collections import Counter
from collections.abc import AsyncIterator, Callable
from typing import Any

from surae_workbench.web.http_errors import RefusedError

#: A stream that lags so many messages behind loses the oldest; states are sent whole.
_WAITING = 64
#: Something is sent at least this often [s], so that a dead connection is noticed.
_KEEP_ALIVE = 15.0
#: Streams that are open at a time, of one browser and of all: each holds a connection.
_OF_ONE, _OF_ALL = 24, 120
#: The message that ends a stream.
_CLOSED = ""

Listener = tuple[asyncio.AbstractEventLoop, "asyncio.Queue[tuple[str, Any]]"]


class Events:
    """Topics, those who listen to them, and messages from any thread."""

    def __init__(self) -> None:
        self._listeners: dict[str, set[Listener]] = {}
        self._lock = threading.Lock()
        self._open: Counter[str] = Counter()

    def tell(self, topic: str, event: str, data: Any) -> None:
        """Send a message to all who listen to a topic now."""
        with self._lock:
            listeners = list(self._listeners.get(topic, ()))
        for loop, queue in listeners:
            try:
                loop.call_soon_threadsafe(_put, queue, (event, data))
            except RuntimeError:  # its loop is closed: the server ends
                continue

    def changed(self, what: str) -> None:
        """Tell all browsers that a list has changed."""
        self.tell("project", "changed", {"what": what})

    def queue(self, waiting: int) -> None:
        """Tell all browsers how many requests wait for files to be read."""
        self.tell("project", "queue", {"waiting": waiting})

    def close(self) -> None:
        """End all streams."""
        with self._lock:
            topics = list(self._listeners)
        for topic in topics:
            self.tell(topic, _CLOSED, None)

    def refuse_more(self, who: str) -> None:
        """Refuse one more stream to whom has too many."""
        with self._lock:
            if self._open[who] >= _OF_ONE or self._open.total() >= _OF_ALL:
                raise RefusedError(503, "too many windows follow the server; close some of them")

    async def stream(
        self,
        who: str,
        topics: tuple[str, ...],
        first: Callable[[], list[tuple[str, Any]]],
        last: str = "",
        view: Callable[[Any], Any] = lambda data: data,
    ) -> AsyncIterator[str]:
        """A stream of server-sent events: how things stand, then what happens.

        `who` listens to `topics`. The `first` messages are made once the stream listens, so that
        nothing is missed; after the event `last` it ends; `view` is what this listener sees of a
        message's data.
        """
        queue: asyncio.Queue[tuple[str, Any]] = asyncio.Queue(_WAITING)
        listener = (asyncio.get_running_loop(), queue)
        with self._lock:
            self._open[who] += 1
            for topic in topics:
                self._listeners.setdefault(topic, set()).add(listener)
        try:
            for event, data in await asyncio.to_thread(first):
                yield _written(event, view(data))
                if event == last:
                    return
            while True:
                try:
                    event, data = await asyncio.wait_for(queue.get(), _KEEP_ALIVE)
                except TimeoutError:
                    yield ": keep-alive\n\n"
                    continue
                if event == _CLOSED:
                    return
                yield _written(event, view(data))
                if event == last:
                    return
        finally:
            with self._lock:
                self._open[who] -= 1
                self._open += Counter()  # forgets those that are zero
                for topic in topics:
                    listeners = self._listeners.get(topic, set())
                    listeners.discard(listener)
                    if not listeners:
                        self._listeners.pop(topic, None)


def _put(queue: "asyncio.Queue[tuple[str, Any]]", message: tuple[str, Any]) -> None:
    if queue.full():
        queue.get_nowait()
    queue.put_nowait(message)


def _written(event: str, data: Any) -> str:
    return f"event: {event}\ndata: {json.dumps(data, allow_nan=False)}\n\n"
