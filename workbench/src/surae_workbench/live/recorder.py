"""Streams of the Lab Streaming Layer: taken, written to disk, then shown; lost and found again."""

import json
import re
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
import numpy.typing as npt

from surae.base.names import TARGET_SOURCE
from surae.base.units import FloatArray
from surae.base.words import N_
from surae.processes import where
from surae_workbench.live.identity import Identities
from surae_workbench.live.lsl import lsl
from surae_workbench.live.meeting import Meeting
from surae_workbench.live.stream import Stream
from surae_workbench.live.xdf import XdfLog

#: Streams are asked for samples this often [s], and for their clocks: at first, and then.
_POLL = 0.015
_CLOCK_FIRST = 1.0
_CLOCK = 5.0
#: So many samples are taken at a time at most, and so many values.
_SAMPLES = 4096
_VALUES = 2**20
#: The disk has what is older than this [s].
_SYNC = 1.0
#: Stamps further from where they are expected than this [s], and than so many samples, are a gap.
_GAP = 0.05
_GAP_SAMPLES = 5.0
#: A stream that is silent for this long [s] is said to be.
_SILENT = 0.5
#: Clock measurements that a new file begins with.
_CLOCKS = 120

#: A stream's name in its description.
_NAMED = re.compile(r"<name>[^<]*</name>")
_DISK = N_("the disk takes nothing ({why}): make room now; {seconds} s are kept in memory")
_AGAIN = N_("a part of the recorder failed and began again; report it ({where})")

#: Told of what happens: "lost", "back", "layout", "gap", "jump", "disk", with plain data.
Tell = Callable[[str, Mapping[str, Any]], None]


#: New samples of a stream: our times [s] and values, shape (n, channels).
Show = Callable[[Stream, FloatArray, npt.NDArray[Any]], None]


#: What is to be written: since when [s], where, and how.
_Piece = tuple[float, XdfLog, Callable[[XdfLog], None]]


class Recorder:
    """Takes all streams that there are and writes them, from its start to its end.

    `path` is the first file; `show` gets samples once they are written, `tell` what happens;
    `network` is as of `lsl`; sources in `but` are not taken; `identities` say what streams are
    called.
    """

    def __init__(
        self,
        path: Path,
        *,
        show: Show,
        tell: Tell,
        network: bool = False,
        but: Sequence[str] = (),
        identities: Identities | None = None,
    ) -> None:
        self._lsl = lsl(network)
        self._show = show
        self._tell = tell
        self._meeting = Meeting(but, identities or Identities())
        self.streams = self._meeting.streams
        self._lock = threading.RLock()
        self._waiting: deque[_Piece] = deque()
        self._full = ""
        self._wrong = ""
        self._origin: float | None = None
        self._ended = threading.Event()
        self._log: XdfLog | None = XdfLog(path)
        self._numbers = count(1)
        self._events = next(self._numbers)  # the number of the stream of what happens
        self._log.stream(self._events, _EVENTS)  # here, so that a folder without room is refused
        self._names: dict[int, str] = {}  # what streams are called in this file, by number
        self._threads = [
            threading.Thread(
                target=self._steadily, args=(work,), name=f"live{work.__name__}", daemon=True
            )
            for work in (self._take, self._meet, self._measure, self._keep)
        ]
        for thread in self._threads:
            thread.start()

    def clock(self) -> float:
        """Our time [s]."""
        return float(self._lsl.local_clock())

    def turn(self, path: Path | None) -> float | None:
        """Write to another file from now on, or to none.

        Returns the time of the first sample in the file before, ours [s]. Where the file is there
        already, FileExistsError, and all goes on as before.
        """
        with self._lock:
            following = None if path is None else XdfLog(path)
            self._write(_end)
            self._log = following
            self._names = {}
            self._write(lambda log: log.stream(self._events, _EVENTS))
            origin = self._origin
            self._origin = None
        return origin

    def arrived(self, at: float) -> bool:
        """Whether all that was sampled until a moment of ours [s] is here, of streams that send."""
        return all(
            stream.last_s is None or stream.last_s >= at
            for stream in list(self.streams.values())
            if stream.rate_hz > 0 and stream.state == "good"
        )

    def whole(self, path: Path) -> bool:
        """Whether nothing waits for room that belongs to a file."""
        with self._lock:
            return all(log.path != path for _, log, _ in self._waiting)

    def note(self, event: str, **data: Any) -> None:
        """Write down, and tell, what happens."""
        text = json.dumps({"event": event, **data})
        stamp = self.clock()
        self._write(lambda log: log.words(self._events, [stamp], [[text]]))
        self._tell(event, data)

    def health(self) -> list[dict[str, Any]]:
        """How all streams do."""
        now = self.clock()
        with self._lock:
            return [stream.health(now) for stream in self.streams.values()]

    @property
    def trouble(self) -> str:
        """What is wrong with the disk, or with us; empty where nothing is."""
        message, given = self.trouble_said
        return message.format(**given)

    @property
    def trouble_said(self) -> tuple[str, dict[str, str]]:
        """The same as it stands in the catalogue, and what fills it in."""
        if self._full:
            seconds = self._waiting[-1][0] - self._waiting[0][0] if self._waiting else 0.0
            return _DISK, {"why": self._full, "seconds": f"{seconds:.0f}"}
        return (_AGAIN, {"where": self._wrong}) if self._wrong else ("", {})

    @property
    def doubts(self) -> list[tuple[str, dict[str, str]]]:
        """Why no trial can begin, as in the catalogue, and what fills it in."""
        return self._meeting.doubts

    @property
    def full(self) -> str:
        """What is wrong with the disk; empty where nothing is."""
        return self.trouble if self._full else ""

    def close(self) -> None:
        """End, with all on disk."""
        self._ended.set()
        for thread in self._threads:
            thread.join(5.0)
        for stream in self.streams.values():
            stream.inlet = None  # no sender goes on sending to one who is gone
        self.turn(None)
        with self._lock:
            for _, log, _ in self._waiting:
                log.close()

    def _steadily(self, work: Callable[[], None]) -> None:
        """Work until the end; a mistake of ours is told, and does not end a recording."""
        while not self._ended.is_set():
            try:
                work()
            except Exception as error:
                self._wrong = where(error)
                self._ended.wait(_POLL)

    def _take(self) -> None:
        """Take samples, in a circle."""
        while not self._ended.wait(_POLL):
            for stream in list(self.streams.values()):
                if stream.inlet is None:
                    continue
                try:
                    self._pull(stream)
                except self._lsl.util.LostError:
                    self._lose(stream)
                except Exception as error:  # one stream's trouble is not that of others
                    self._wrong = f"{stream.name}: {where(error)}"

    def _pull(self, stream: Stream) -> None:
        """Take what a stream has sent."""
        values, stamps = stream.inlet.pull_chunk(
            timeout=0.0,
            max_samples=min(_SAMPLES, _VALUES // len(stream.labels) + 1),
            as_numpy=True,  # words too: as bytes, since any byte may come
        )
        if len(stamps):
            # Of a much larger buffer.
            self._arrived(stream, stream.mended(stamps.copy(), self.clock()), values.copy())
        elif (
            stream.rate_hz > 0
            and stream.state == "good"
            and stream.last_s is not None
            and self.clock() - stream.last_s > _SILENT
        ):
            stream.state = "silent"
            self.note("silent", stream=stream.called)

    def _arrived(self, stream: Stream, stamps: FloatArray, values: Any) -> None:
        times = stamps + (stream.offset_s or 0.0)
        with self._lock:  # the file that they go to is the one whose origin they may be
            if stream.number not in self._names:
                self._describe(stream)
            if stream.words:
                self._write(lambda log: log.words(stream.number, stamps.tolist(), values.tolist()))
            else:
                self._write(lambda log: log.samples(stream.number, stamps, values))
                stream.not_finite += int(values.size - np.isfinite(values).sum())
                measured = stream.source != TARGET_SOURCE  # no reader takes that for a signal
                if measured and (self._origin is None or times[0] < self._origin):
                    self._origin = float(times[0])
        now = self.clock()
        stream.received += len(stamps)
        if stream.rate_hz > 0:
            self._gaps(stream, stamps)
            stream.rates.append((now, stream.received))
            while stream.rates[0][0] < now - 5.0 and len(stream.rates) > 2:
                del stream.rates[0]
        if stream.state != "good":
            stream.state = "good"
            self.note("back", stream=stream.called)
        stream.stamp, stream.last_s = float(stamps[-1]), float(times[-1])
        if not stream.words:
            try:
                self._show(stream, times, values)
            except Exception as error:  # whoever looks on ends no recording
                self._wrong = where(error)

    def _gaps(self, stream: Stream, stamps: FloatArray) -> None:
        """Notice stamps that are not where the ones before say."""
        before = stamps[0] - 1.0 / stream.rate_hz if stream.stamp is None else stream.stamp
        steps = np.diff(stamps, prepend=before) - 1.0 / stream.rate_hz
        for index in np.flatnonzero(np.abs(steps) > max(_GAP, _GAP_SAMPLES / stream.rate_hz)):
            stream.gaps += 1
            missing = float(steps[index])
            stream.lost_s += max(missing, 0.0)
            self.note("gap" if missing > 0 else "jump", stream=stream.called, seconds=missing)

    def _lose(self, stream: Stream) -> None:
        stream.inlet, stream.state, stream.lost_at = None, "lost", time.monotonic()
        stream.losses += 1
        self.note("lost", stream=stream.called)

    def _meet(self) -> None:
        """Find streams, new ones and those that were lost."""
        resolver = self._lsl.ContinuousResolver(forget_after=2.0)
        while not self._ended.wait(0.05):
            for info in self._meeting.wanted(resolver.results()):
                try:
                    self._open(info)
                except RuntimeError:  # it is gone again, or does not answer
                    continue
                except Exception as error:  # one stream's trouble is not that of others
                    self._wrong = f"{info.name()}: {where(error)}"

    def _measure(self) -> None:
        """Measure the clocks of all streams, in a circle."""
        due: dict[int, float] = {}
        while not self._ended.wait(0.1):
            for stream in list(self.streams.values()):
                inlet = stream.inlet
                if inlet is None or time.monotonic() < due.get(stream.number, 0.0):
                    continue
                wait = _CLOCK_FIRST if len(stream.clocks) < 3 else _CLOCK
                due[stream.number] = time.monotonic() + wait
                with suppress(RuntimeError):  # it is lost, or too late
                    self._measured(stream, float(inlet.time_correction(1.0)))

    def _measured(self, stream: Stream, offset: float) -> None:
        if not abs(offset) < np.inf:
            return
        now = self.clock()
        with self._lock:
            stream.offset_s = offset
            stream.clocks = [*stream.clocks[-_CLOCKS:], (now, offset)]
            if stream.number in self._names:
                self._write(lambda log: log.clock(stream.number, now, offset))

    def _open(self, info: Any) -> None:
        """Take a stream, one that was lost or a new one; RuntimeError where it does not answer."""
        inlet = self._lsl.StreamInlet(info, max_buflen=60, recover=False)
        whole = inlet.info(2.0)
        uid = whole.uid()
        if uid != info.uid():  # another one answers at the address of one that has gone
            return
        stream = Stream.of(next(self._numbers), whole)
        if self._meeting.is_alike(stream, uid):
            return
        inlet.open_stream(2.0)
        with self._lock:
            stream = self._meeting.take(stream, uid, self._met)
            stream.inlet = inlet

    def _met(self, event: str, **data: Any) -> None:
        """Note a stream that is new, or in the place of another of which this file has samples."""
        if "number" in data:
            data["split"] = data.pop("number") in self._names
        self.note(event, **data)

    def _describe(self, stream: Stream) -> None:
        """Tell the file what a stream is, and what is known of its clock.

        Each has a name of its own in a file, so that no column stands for two.
        """
        name = stream.called
        for other in count(2):
            if name not in self._names.values():
                break
            name = f"{stream.called} ({other})"
        named = f"<name>{escape(name)}</name>"
        xml = _NAMED.sub(lambda _: named, stream.xml, count=1)
        self._names[stream.number] = name
        self._write(lambda log: log.stream(stream.number, xml))
        for now, offset in list(stream.clocks):
            self._write(
                lambda log, now=now, offset=offset: log.clock(stream.number, now, offset)  # type: ignore[misc]
            )

    def _keep(self) -> None:
        """Flush every second, and try again where the disk was full."""
        while not self._ended.wait(_SYNC):
            with self._lock:
                self._write(XdfLog.mark)
                log = self._log
            if log is not None and not self._full:
                with suppress(OSError):
                    log.sync()

    def _write(self, write_chunk: Callable[[XdfLog], None]) -> None:
        """Write, or keep in memory for as long as the disk takes nothing; in order."""
        with self._lock:
            if self._log is None:
                return
            self._waiting.append((time.monotonic(), self._log, write_chunk))
            try:
                while self._waiting:
                    _, log, write = self._waiting[0]
                    write(log)
                    self._waiting.popleft()
            except OSError as error:
                before = self._full
                self._full = error.strerror or str(error)
                if not before:
                    self._tell("disk", {"message": self.trouble})
                return
            except Exception:  # our mistake, which what comes after it must not wait for
                self._waiting.popleft()
                raise
            if self._full:
                self._full = ""
                self._tell("disk", {"message": ""})


def _end(log: XdfLog) -> None:
    """End a file, with all on disk."""
    log.mark()
    log.sync()
    log.close()


_EVENTS = (
    '<?xml version="1.0"?><info><name>surae</name><type>Markers</type>'
    "<channel_count>1</channel_count><nominal_srate>0</nominal_srate>"
    "<channel_format>string</channel_format><source_id>surae events</source_id><desc/></info>"
)
