"""News for browsers: what happens anywhere in the server reaches every stream that listens."""

import asyncio
import json
import threading
from collections.abc import AsyncIterator, Callable
from typing import Any

from fastapi.responses import StreamingResponse

#: A stream that lags so many messages behind loses the oldest; states are sent whole.
_WAITING = 64
#: Something is sent at least this often [s], so that a dead connection is noticed.
_KEEP_ALIVE = 15.0
#: The message that ends a stream.
_CLOSED = ""

#: The event and its data.
Message = tuple[str, Any]
_Listener = tuple[asyncio.AbstractEventLoop, "asyncio.Queue[Message]"]


class Events:
    """Topics, those who listen to them, and messages from any thread."""

    def __init__(self) -> None:
        self._listeners: dict[str, set[_Listener]] = {}
        self._lock = threading.Lock()

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

    def close(self) -> None:
        """End all streams."""
        with self._lock:
            topics = list(self._listeners)
        for topic in topics:
            self.tell(topic, _CLOSED, None)

    def answer(
        self, *topics: str, first: Callable[[], list[Message]] = list, last: str = _CLOSED
    ) -> StreamingResponse:
        """A stream of server-sent events: how things stand, then what happens.

        The `first` messages are made once the stream listens, so that nothing is missed; after the
        event `last` it ends.
        """
        headers = {"x-accel-buffering": "no", "cache-control": "no-store"}
        stream = self._stream(topics, first, last)
        return StreamingResponse(stream, media_type="text/event-stream", headers=headers)

    async def _stream(
        self, topics: tuple[str, ...], first: Callable[[], list[Message]], last: str
    ) -> AsyncIterator[str]:
        queue: asyncio.Queue[Message] = asyncio.Queue(_WAITING)
        listener = (asyncio.get_running_loop(), queue)
        with self._lock:
            for topic in topics:
                self._listeners.setdefault(topic, set()).add(listener)
        try:
            yield ": surae\n\n"  # makes proxies and browsers begin
            waiting = await asyncio.to_thread(first)
            while True:
                try:
                    event, data = waiting.pop(0) if waiting else await _next(queue)
                except TimeoutError:
                    yield ": keep-alive\n\n"
                    continue
                if event == _CLOSED:
                    return
                yield f"event: {event}\ndata: {json.dumps(data, allow_nan=False)}\n\n"
                if event == last:
                    return
        finally:
            with self._lock:
                for topic in topics:
                    self._listeners[topic].discard(listener)
                    if not self._listeners[topic]:
                        del self._listeners[topic]


async def _next(queue: "asyncio.Queue[Message]") -> Message:
    return await asyncio.wait_for(queue.get(), _KEEP_ALIVE)


def _put(queue: "asyncio.Queue[Message]", message: Message) -> None:
    if queue.full():
        queue.get_nowait()
    queue.put_nowait(message)
