"""Bodies of requests as they come: not too large, not too slow, and not too many at a time.

Who they come from is told by session: one address may be a whole clinic, behind a proxy.
"""

import asyncio
from collections import Counter

from starlette.types import Message, Receive

from surae_workbench.web.http_errors import RefusedError

#: Bodies that may be on their way at a time, of one session and of all: each holds a connection.
_OF_ONE, _OF_ALL = 64, 128
#: So many bytes have to come while the server waits for so long [s]; it then waits anew.
_LEAST, _PATIENCE = 64 * 1024, 20.0


class Bodies:
    """All bodies that are on their way."""

    def __init__(self) -> None:
        self._coming: Counter[str] = Counter()

    def take(self, receive: Receive, who: str, limit: int) -> "Body":
        """One more, of whom and of at most so many bytes; to be closed.

        It is refused to whom has too many on their way.
        """
        if self._coming[who] >= _OF_ONE:
            raise RefusedError(
                503, f"{_OF_ONE} of your requests are still on their way; send fewer at a time"
            )
        if self._coming.total() >= _OF_ALL:
            raise RefusedError(503, "the server is busy with other uploads; try again soon")
        self._coming[who] += 1
        return Body(receive, who, limit, self._coming)


class Body:
    """One body, to be received in the place of `receive`."""

    def __init__(self, receive: Receive, who: str, limit: int, coming: Counter[str]) -> None:
        self._receive, self._who, self._all, self._coming = receive, who, coming, True
        self._left, self._limit = limit, limit
        self._fresh, self._patience = 0, _PATIENCE

    async def __call__(self) -> Message:
        """The next piece."""
        if not self._coming:
            return await self._receive()
        clock = asyncio.get_running_loop().time
        begin = clock()
        try:
            message = await asyncio.wait_for(self._receive(), self._patience)
        except TimeoutError:
            raise RefusedError(
                408, f"less than {_LEAST / 1024:g} KiB came in {_PATIENCE:g} s; try again"
            ) from None
        self._patience -= clock() - begin
        size = len(message.get("body", b""))
        self._left -= size
        if self._left < 0:
            raise RefusedError(413, too_large(self._limit))
        self._fresh += size
        if self._fresh >= _LEAST:
            self._fresh, self._patience = 0, _PATIENCE
        if not message.get("more_body", False):
            self.close()
        return message

    def close(self) -> None:
        """It has come, or nobody waits for the rest."""
        if self._coming:
            self._coming = False
            self._all[self._who] -= 1
            if not self._all[self._who]:
                del self._all[self._who]


def too_large(limit: int) -> str:
    """What is said of more bytes than `limit`."""
    return f"too large: at most {limit / 2**20:g} MiB; cut or downsample it"
