"""Streams that LSL tells of: which are taken, which are one that was lost, which look alike."""

import time
from collections.abc import Callable, Iterable
from typing import Any

from surae.base.names import TARGET_SOURCE
from surae_workbench.live.identity import ALIKE, WHICH, Identities
from surae_workbench.live.stream import Stream, key_of

#: A lost stream is talked of for so long [s]; whoever is still there then has come back itself, and
#: whoever is there beside one that sends is another.
_ECHO = 3.0
_ANOTHER = "went, and another stream that looks the same took its place"


class Meeting:
    """All streams that were taken, by a slot that one keeps through losses.

    Sources in `but` are not taken; `identities` say what streams are called.
    """

    def __init__(self, but: Iterable[str], identities: Identities) -> None:
        self.streams: dict[str, Stream] = {}
        self.identities = identities
        self._but = frozenset(but)
        #: Names, by LSL's own id, of streams that look like one that is taken.
        self._alike: dict[str, str] = {}
        #: When an id that is not taken was first seen; ids that others have taken the place of.
        self._since: dict[str, float] = {}
        self._gone: set[str] = set()

    def wanted(self, infos: Iterable[Any]) -> list[Any]:
        """Those of the streams that are there now that are to be taken."""
        infos = list(infos)
        there = {info.uid() for info in infos}
        self._alike = {uid: name for uid, name in self._alike.items() if uid in there}
        self._since = {uid: since for uid, since in self._since.items() if uid in there}
        return [info for info in infos if self._is_wanted(info, there)]

    def _is_wanted(self, info: Any, there: set[str]) -> bool:
        uid = info.uid()
        source = info.source_id() or info.hostname()
        alike = [s for s in self.streams.values() if s.key == key_of(info)]
        live = {stream.uid for stream in alike if stream.inlet is not None}
        if source in self._but or uid in live:
            return False
        lost = [stream for stream in alike if stream.inlet is None]
        if uid in self._alike:  # it stays away until the one that it looks like has gone
            return not live and not there & {stream.uid for stream in lost}
        for stream in lost:  # one that has just gone is still talked of for a while
            if stream.uid == uid and time.monotonic() - stream.lost_at <= _ECHO:
                return False
        if live and not lost:  # an echo, or another stream of the same program
            since = self._since.setdefault(uid, time.monotonic())
            twin = time.monotonic() - since > _ECHO and live <= there
            return twin and source != TARGET_SOURCE and uid not in self._gone
        return True

    def is_alike(self, stream: Stream, uid: str) -> bool:
        """Whether a stream looks like one that sends, which is remembered."""
        for other in self.streams.values():
            twin = other.inlet is not None and other.key == stream.key
            if twin and other.labels == stream.labels and other.uid != uid:
                self._alike[uid] = stream.name
                return True
        return False

    def take(self, stream: Stream, uid: str, tell: Callable[..., None]) -> Stream:
        """Give a stream its slot and name: itself, or the one that was lost and is back.

        `tell` hears "stream" of a new one, "layout" of one whose place another has taken.
        """
        lost = [s for s in self.streams.values() if s.key == stream.key and s.inlet is None]
        same = [other for other in lost if other.layout == stream.layout]
        before = next(iter((*same, *lost)), None)
        slot = str(stream.number)
        if before is not None:
            slot = next(key for key, other in self.streams.items() if other is before)
            self._gone.add(before.uid)
        if before is not None and same and uid not in self._alike:
            stream = before
            stream.clocks.clear()  # its computer may have been started again
        elif before is None:
            tell("stream", stream=stream.name, rate_hz=stream.rate_hz)
        else:
            stream.losses = before.losses
            stream.remark = _ANOTHER
            if not same:
                stream.remark = (
                    f"came back as another stream ({stream.layout_text}; before: "
                    f"{before.layout_text})"
                )
            tell("layout", stream=before.called, remark=stream.remark, number=before.number)
        self.streams[slot] = stream
        self._gone.discard(uid)
        self._alike.pop(uid, None)
        stream.uid = uid
        self._name(stream)
        return stream

    def _name(self, new: Stream) -> None:
        """Say what streams are called, now that one is there that was not."""
        every = [stream for stream in self.streams.values() if stream.source != TARGET_SOURCE]
        if any(new is stream for stream in every):
            self.identities.meet(new.identity, [s.identity for s in every if s is not new])
        for stream in every:
            called = self.identities.called(stream.identity)
            stream.told = "" if called == stream.name else called

    @property
    def doubts(self) -> list[tuple[str, dict[str, str]]]:
        """Why no trial can begin, as in the catalogue, and what fills it in."""
        alike = [(ALIKE, {"stream": name}) for name in dict.fromkeys(self._alike.values())]
        return alike + [
            (WHICH, {"stream": name, "names": " / ".join(called)})
            for name, called in self.identities.ambiguous().items()
        ]
