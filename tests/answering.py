"""A web server within this process, which answers and ends as soon as it is asked to."""

import asyncio
import socket
import threading
import time
from typing import Any

import uvicorn


class Answering:
    """An application on a free port of this computer, served by a thread until it is closed."""

    def __init__(self, app: Any, listening: socket.socket | None = None, **how: Any) -> None:
        self.socket = _listening() if listening is None else listening
        self.address = f"http://127.0.0.1:{self.socket.getsockname()[1]}"
        self._server = _Prompt(uvicorn.Config(app, **{"log_level": "error", **how}))
        self._thread = threading.Thread(
            target=self._server.run, kwargs={"sockets": [self.socket]}, daemon=True
        )
        self._thread.start()
        assert self._server.begun.wait(60.0), "the server did not start"

    def close(self) -> None:
        """End it, with what it still answers; it may have ended already."""
        if self._thread.is_alive():
            self._server.end()
            self._thread.join(60.0)
        self.socket.close()


class _Prompt(uvicorn.Server):
    """uvicorn looks ten times a second whether it is to end, and as often at what is open."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.begun, self._loop, self._ends = threading.Event(), None, asyncio.Event()

    async def main_loop(self) -> None:
        self._loop = asyncio.get_running_loop()
        self.begun.set()
        await self._ends.wait()

    def end(self) -> None:
        self._loop.call_soon_threadsafe(self._ends.set)

    async def shutdown(self, sockets: object = None) -> None:
        del sockets  # they are closed by whom they belong to
        for server in self.servers:
            server.close()
        state, most = self.server_state, time.monotonic() + 1.0
        for connection in list(state.connections):
            connection.shutdown()
        while (state.connections or state.tasks) and time.monotonic() < most:
            await asyncio.sleep(0.002)
        for task in state.tasks:
            task.cancel()
        await self.lifespan.shutdown()


def _listening() -> socket.socket:
    """A socket that is named TCP's, as `surae serve` has it.

    Of another asyncio does not know that its small answers are to be sent at once: each then waits
    for 40 ms.
    """
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    made.bind(("127.0.0.1", 0))
    made.listen(128)
    return made
