"""A folder of trials: started, stopped and judged; what a crash left behind is found again.

Beside each other lie ``trial-01.xdf`` as it came, ``trial-01.h5`` as a recording, ``trial-01.json``
with the verdict, and in ``between-01.xdf`` what came before the next trial. A trial without a
verdict in its JSON broke off: the next start says so, mends and judges it. One program writes to a
folder at a time, and to nothing outside of it.
"""

import re
import sqlite3
import stat
import threading
import time
from collections.abc import Iterable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any, TypedDict

from pydantic import ValidationError

from surae.api import words_in
from surae.base.cleaning import cleaned
from surae.base.database import lock
from surae.base.errors import InputError, SuraeError
from surae.base.files import PathLike, is_link, shown, write_atomic
from surae.base.names import LANGUAGES
from surae.base.words import N_
from surae.processes import Child, End
from surae_workbench.live.identity import STREAMS, TWICE, Identities
from surae_workbench.live.mapping import Chosen, chosen_text, columns_of, mapping_of, offered
from surae_workbench.live.record import MOST, Judgement, Record, read_record, repaired, said_in
from surae_workbench.live.recorder import Recorder, Show, Tell
from surae_workbench.live.xdf import mended_xdf

#: After the end of a trial, the samples of its last moments are waited for so long at most [s].
_LATE = 0.25
#: A trial is held against so many others at most: it must not be judged later and later.
_EARLIER = 8
#: Why nothing is said of a trial before somebody says which channel is which.
UNMAPPED = N_(
    "The streams do not say which channel is which: choose the channels, and it is judged again."
)
#: The mapping that was chosen in the page.
CHOSEN = "channels.toml"
#: What a recording leaves in its folder beside trials, as a pattern.
_OURS = r"(trial|between)-|(live\.lock|mapping\.toml|channels\.toml|joint\.json|streams\.json)$"


def silent(*what: object) -> None:
    """Show and tell nobody."""


class TrialsOptions(TypedDict, total=False):
    """What trials may be made with beside their folder, see `Trials`."""

    mapping: PathLike | None
    network: bool
    joint: bool


class Trials:
    """A session's trials, recorded and judged.

    The `folder` is made where it is missing; trials in it are kept, and numbered on. `mapping` is
    the session's; None where the streams name their channels as we do. `show`, `tell`, `network`
    and `but` are as of `Recorder`; `tell` hears of trials too. With `joint` all trials so far are
    fitted together after each, beside everything else; `limits` are those of `judge.together`.
    """

    def __init__(
        self,
        folder: PathLike,
        *,
        mapping: PathLike | None = None,
        show: Show = silent,
        tell: Tell = silent,
        network: bool = False,
        but: tuple[str, ...] = (),
        joint: bool = True,
        limits: Mapping[str, Any] | None = None,
    ) -> None:
        self.folder = Path(folder)
        self._told = tell
        self.limits = dict(limits or {})
        self._betweens = 0
        self._mapping = None if mapping is None else Path(mapping)
        self.joint = joint
        self._made = ""
        self._begun_with = ""
        self._judge, self._refine = Child(calls=None), Child(nice=10, calls=None)
        self._work = ThreadPoolExecutor(1, "live-judge")
        self._later = ThreadPoolExecutor(1, "live-refine")
        self.session: dict[str, Any] = {"state": "waiting"}
        self._pending: Future[None] | None = None
        self._tried: list[int] = []
        self._closed = False
        self._lock, self._writing = threading.Lock(), threading.Lock()
        self.trials: dict[int, Record] = {}
        #: What is to be said of trials that broke off or are damaged, and are judged now.
        self.broken: list[str] = []
        self.running: int | None = None
        self._begun = 0.0
        with ExitStack() as opened:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                _refuse_shared(self.folder)
                if (held := lock(self.folder / "live")) is None:
                    raise InputError(
                        f"{shown(self.folder)}: another surae live records here; end that one, or "
                        "give another --output"
                    )
                opened.callback(held.close)
                if self._mapping is None and self.file(CHOSEN).exists():
                    self._mapping = self.file(CHOSEN)
                unjudged = self._known()
                first = self._between()
                self._identities = Identities(self.file(STREAMS), columns_of(self._mapping))
                self.recorder = Recorder(
                    first,
                    show=show,
                    tell=self._tell,
                    network=network,
                    but=but,
                    identities=self._identities,
                )
            except (OSError, sqlite3.Error) as error:
                why = getattr(error, "strerror", None) or str(error)
                raise InputError(f"{shown(self.folder)}: {why}; give another --output") from None
            self._opened = opened.pop_all()
        self.warm = self._work.submit(self._judge.call, "surae_workbench.live.judge:warm", {})
        self.verdicts = {n: self._work.submit(self._judged, n, None, None) for n in unjudged}
        self._judge_unread()  # a mapping may have come since
        if joint and self.trials:  # what was known before this start is known again
            self._ask_together()

    def start(
        self, protocol: str | None = None, seconds: float | None = None, effort: str | None = None
    ) -> int:
        """Begin a trial, of which this is asked. Returns its number."""
        with self._lock:
            if self.running is not None:
                raise InputError(f"trial {self.running} is running; stop it first")
            wrong = [message.format(**given) for message, given in self.doubts]
            if trouble := self.recorder.full or " ".join(wrong):
                raise InputError(f"no trial is started: {trouble}")
            self._begun_with = self._own_mapping()
            number = self._free()
            while True:  # somebody else may make the same file at this moment
                try:
                    self.recorder.turn(self.path(number, ".xdf"))
                    break
                except FileExistsError:
                    number += 1
            self.running, self._begun = number, self.recorder.clock()
            record = self.trials[number] = Record.of(
                trial=number,
                state="recording",
                began=_now(),
                protocol=protocol,
                seconds_asked=seconds,
                effort_asked=effort,
            )
            about = {"protocol": record.protocol, "seconds": seconds, "effort": effort}
            # What was asked for is known after a crash, too: by the recording itself.
            self.recorder.note("start", trial=number, began=record.began, **about)
            self._keep(number)
        self._tell("trial", record.shown())
        return number

    def take(self, path: Path) -> int:
        """Take a file that was recorded otherwise as a trial, and judge it. Returns its number."""
        with self._lock:
            number = self._free()
            record = self.trials[number] = Record.of(
                trial=number,
                state="being judged",
                began=_now(),
                protocol=path.name,
                file=str(path),
            )
            self._drop_together()
            self._keep(number)
        self._tell("trial", record.shown())
        self.verdicts[number] = self._work.submit(self._judged, number, None, time.monotonic())
        return number

    def offered(self) -> dict[str, Any]:
        """The channels that can be chosen, and those that are."""
        return offered(list(self.recorder.streams.values()), self.mapping)

    def choose(
        self, channels: Mapping[str, Chosen], emg: str | None = None, *, again: bool = False
    ) -> None:
        """Have a choice of channels be the session's mapping, from now on.

        Trials of which nothing could be read are judged again by it; with `again` all are.
        """
        with self._lock:
            if self.running is not None:
                raise InputError(f"trial {self.running} is running; stop it first")
            streams = list(self.recorder.streams.values())
            text = chosen_text(streams, channels, emg, self.mapping)
            write_atomic(self.file(CHOSEN), text)
            self._mapping = self.file(CHOSEN)
        self._judge_unread(also=list(self.trials) if again else ())

    def _judge_unread(self, also: Iterable[int] = ()) -> None:
        """Judge trials again that nothing could be read of, if another mapping says how now."""
        asked = [n for n, trial in list(self.trials.items()) if trial.is_unread or n in also]
        for number in asked:
            trial = self.trials[number]
            digest = self._digest(self._mapping_of(number))
            source = Path(trial.file) if trial.file else self.path(number, ".xdf")
            if trial.state != "judged" or digest in (None, trial.mapping) or not source.exists():
                continue
            fresh = Judgement.model_validate({}).model_dump()
            self._tell("trial", self._write(number, **fresh, state="being judged").shown())
            self.verdicts[number] = self._work.submit(self._judged, number, trial.begun_s, None)

    def _mapping_of(self, number: int) -> Path | None:
        """The mapping that a trial is read by; None where none is known."""
        trial = self.trials[number]
        if (began := self.path(number, "-mapping.toml")).exists():
            return began
        return self._mapping if trial.file is not None else self.mapping

    @staticmethod
    def _digest(mapping: Path | None) -> str | None:
        """What tells a mapping from others; None where there is none that can be read."""
        with suppress(OSError):
            if mapping is not None:
                return sha256(mapping.read_bytes()).hexdigest()
        return None

    def mark(self, text: str = "") -> None:
        """Write a mark down, at this moment."""
        number = self.running
        text = cleaned(text)
        if number is not None and len(self.trials[number].marks) >= MOST:
            raise InputError(f"this trial has {MOST} marks; begin another one")
        self.recorder.note("mark", text=text)
        if number is not None:
            at = round(self.recorder.clock() - self._begun, 3)
            self._write(number, marks=lambda record: [*record.marks, {"at": at, "text": text}])

    def alarm(self, about: dict[str, Any]) -> None:
        """Write down what goes wrong within the trial, as `record.Alarm` has it."""
        number = self.running
        if number is not None and len(self.trials[number].alarms) < MOST:
            self.recorder.note("alarm", **about)
            self._write(number, alarms=lambda record: [*record.alarms, about])

    def stop(self, begin: float | None = None) -> "Future[dict[str, Any]]":
        """End the trial and have it judged; the future holds what is said of it.

        `begin` is when its target began, in LSL's time [s].
        """
        with self._lock:
            number = self.running
            self.running = None
            if number is None:
                raise InputError("no trial is running; start one first")
            self._drop_together()
            if self._begun_with != self._own_mapping():
                self._keep_mapping(number)
        ended = time.monotonic()
        now = self.recorder.clock()
        self.recorder.note("stop", trial=number)
        while not self.recorder.arrived(now) and time.monotonic() < ended + _LATE:
            time.sleep(0.005)
        origin = self.recorder.turn(self._between())
        self._tell("trial", self._write(number, state="being judged").shown())
        late = None if begin is None or origin is None else begin - origin
        self._write(number, begun_s=late)
        self.verdicts[number] = self._work.submit(self._judged, number, late, ended)
        return self.verdicts[number]

    def close(self) -> None:
        """End, a trial that is running too; it will be judged when the folder is next opened."""
        self._closed = True
        self.recorder.close()
        for child in (self._judge, self._refine):
            child.close()
        for work in (self._work, self._later):
            work.shutdown(cancel_futures=True)
        self._opened.close()

    @property
    def mapping(self) -> Path | None:
        """The session's mapping, or the one that the streams' own names make; None: neither."""
        if self._mapping is not None:
            return self._mapping
        made_here = self.folder / "mapping.toml"
        text, twice = mapping_of(list(self.recorder.streams.values()))
        if self.running is None and twice:  # what is there is of one of them
            return None
        if self.running is None and text and text != self._made:
            with suppress(SuraeError):  # the disk is full; what is there is used
                write_atomic(self.file("mapping.toml"), text)
                self._made = text
                self._judge_unread()
        return made_here if made_here.exists() else None

    @property
    def doubts(self) -> list[tuple[str, dict[str, str]]]:
        """Why no trial can begin: which stream is which; as in the catalogue, and its values."""
        self._identities.columns = columns_of(self._mapping) or self._identities.columns
        doubts = self.recorder.doubts
        if self._mapping is None:
            _, twice = mapping_of(list(self.recorder.streams.values()))
            doubts += [
                (TWICE, {"role": role, "names": " / ".join(columns)})
                for role, columns in twice.items()
            ]
        return doubts

    def _own_mapping(self) -> str:
        """What the mapping says now that the streams' own names make; empty of a given one."""
        if self._mapping is not None:
            return ""
        return mapping_of(list(self.recorder.streams.values()))[0]

    def _keep_mapping(self, number: int) -> None:
        """Keep the mapping that a trial began with beside it: what streams say has changed."""
        if self._begun_with:
            with suppress(SuraeError, OSError):
                write_atomic(self.path(number, "-mapping.toml"), self._begun_with)

    def _write(self, number: int, **changes: Any) -> Record:
        """Change a trial's record; a function gets the record as it is now."""
        with self._writing:
            record = self.trials[number]
            changes = {k: v(record) if callable(v) else v for k, v in changes.items()}
            self.trials[number] = record.but(**changes)
            return self.trials[number]

    def _judged(self, number: int, begin: float | None, ended: float | None) -> dict[str, Any]:
        """Judge a trial in the child, keep and tell what it says."""
        trial = self.trials[number]
        source = Path(trial.file) if trial.file else self.path(number, ".xdf")
        while not self.recorder.whole(source) and not self._closed:  # there is room on the disk
            time.sleep(0.05)
        failed = False
        mapping = self._mapping_of(number)
        digest = self._digest(mapping)
        try:
            arguments = self._arguments(number, source, begin, mapping)
        except InputError as error:
            judgement: dict[str, Any] = _waits() if mapping is None else {"why": str(error)}
        else:
            end = self._judge.call("surae_workbench.live.judge:judge", arguments)
            if self._closed and end.how != "done":  # nothing is on disk: the next start judges it
                return trial.shown()
            judgement = end.value if end.how == "done" else {"why": end.message}
            failed = end.how in ("failed", "killed")
            if failed:  # our mistake, not the trial's
                judgement |= {"verdict": "look", "advice": f"It could not be judged: {end.message}"}
        judgement = {k: v for k, v in judgement.items() if k in Judgement.model_fields}
        if "findings" not in judgement:
            judgement = {"verdict": "repeat", "advice": judgement["why"], **judgement}
        if trial.split is not None or self.trials[number].split is not None:
            judgement |= {
                "verdict": "repeat",
                "advice": self.trials[number].split,
                "translated": {},
            }
        output = self.path(number, ".h5")
        about = {
            "state": "judged",
            "mapping": digest,
            "recording": str(output if output.exists() else source),
            "seconds_to_verdict": None if ended is None else round(time.monotonic() - ended, 3),
        }
        try:
            trial = self._write(number, **judgement, **about)
        except ValidationError:  # our mistake: what is said of a trial has one form
            why = "what was said of it could not be kept; report it"
            trial = self._write(number, **about, verdict="look", advice=why)
        # A mistake of ours is judged again at the next start.
        self._keep(number, judged=not failed)
        self._tell("trial", trial.shown())
        if self.joint:
            self._ask_together()
        return trial.shown()

    def _arguments(
        self, number: int, source: Path, begin: float | None, mapping: Path | None
    ) -> dict[str, Any]:
        """What the judge needs; InputError where nothing can be judged."""
        if mapping is None and self.trials[number].file is None:
            raise InputError(UNMAPPED)
        target = self.path(number, "-target.csv")
        return {
            "file": str(source),
            "output": str(self.path(number, ".h5")),
            "earlier": self._others(number),
            "mapping": None if mapping is None else str(mapping),
            "instructed": self.trials[number].effort_asked,
            "efforts": self._efforts(n for n in list(self.trials) if n != number),
            "target": None if begin is None or not target.exists() else str(target),
            "begin": begin or 0.0,
        }

    def _tell(self, event: str, data: Mapping[str, Any]) -> None:
        """Pass on what happens; a stream that changed within a trial spoils it."""
        number = self.running
        if event == "layout" and data["split"] and number is not None:
            what = (
                f"Within the trial {data['stream']} {data['remark']}. Only what came before is in "
                "the recording: record the trial again."
            )
            self._write(number, split=what)
            self._keep_mapping(number)
        self._told(event, data)

    def _keep(self, number: int, *, judged: bool = True) -> None:
        """Write down what is known of a trial; not its verdict where that is none."""
        record = self.trials[number]
        if not judged:
            record = record.but(state="being judged", verdict=None, advice=None, why=None)
        try:
            record.write(self.path(number, ".json"))
        except (OSError, SuraeError) as error:
            note = f"its state is not on disk ({error}); the next start judges it again"
            self._write(number, note=note)

    def _others(self, number: int) -> list[str]:
        """Recordings of other trials that were not spoilt: maxima, and the newest."""
        good = [
            other
            for other, trial in sorted(self.trials.items())
            if other != number
            and trial.verdict in ("keep", "look")
            and self.path(other, ".h5").exists()
        ]
        good.sort(key=lambda other: self.trials[other].effort == "maximal")
        return [str(self.path(other, ".h5")) for other in good[-_EARLIER:]]

    def _efforts(self, numbers: Iterable[int]) -> dict[str, str]:
        """The efforts that were asked for and made, by the name of the recording."""
        confirmed = {n: self.trials[n].confirmed_effort for n in numbers}
        return {self.path(n, "").stem: effort for n, effort in confirmed.items() if effort}

    def _ask_together(self) -> None:
        """Have all trials fitted together, after a fit that is at work."""
        with self._lock:
            self._drop_together()
            if not self._closed:
                self._pending = self._later.submit(self._together)

    def _drop_together(self) -> None:
        """Cancel a joint fit that has not begun: without the trial that just ended it is of no use.

        That trial's verdict asks for another.
        """
        if self._pending is not None:
            self._pending.cancel()

    def _together(self) -> None:
        """Fit all trials that are worth it jointly, beside everything else."""
        worth = [
            number
            for number, trial in sorted(self.trials.items())
            if trial.verdict in ("keep", "look") and self.path(number, ".h5").exists()
        ]
        moving = [number for number in worth if self.trials[number].use == "fit"]
        if not moving or worth == self._tried:
            return
        self._tried = worth
        self.session = {**self.session, "state": "fitting", "fitting": worth}
        self._tell("session", self.session)
        arguments = {
            "recordings": [str(self.path(number, ".h5")) for number in worth],
            "efforts": self._efforts(worth),
            **self.limits,
        }
        try:
            arguments["output"] = str(self.file("joint.json"))
            arguments["target"] = str(self.file("measure-next.csv"))
        except InputError as error:
            end = End("refused", message=str(error))
        else:
            end = self._refine.call("surae_workbench.live.judge:together", arguments)
        if end.how == "done":
            rows = (*self.session.get("parameters", ()), *self.session.get("measures", ()))
            before = {row["name"]: row["value"] for row in rows}
            self.session = {"state": "fitted", "trials": worth, "before": before, **end.value}
        else:
            self.session = {**self.session, "state": "failed", "why": end.message}
        self._tell("session", self.session)

    def _known(self) -> list[int]:
        """Take up the trials in the folder; the numbers of those to be judged yet, mended."""
        unjudged = []
        for number in self._numbers("trial"):
            row = self.path(number, ".json")
            source = self.path(number, ".xdf")
            note = f"trial {number} broke off; what had arrived is kept"
            try:
                trial = read_record(row, number)
            except InputError:  # of a newer surae, which reads it
                raise
            except ValueError:
                trial = repaired(row, number, source)
                _set_aside(row)
                note = f"trial {number}: {row.name} is damaged, and was set aside"
            else:
                if trial is None and not source.exists():
                    continue  # a target's file alone
                trial = trial or repaired(row, number, source)
            if trial.verdict is None and trial.file is None:
                if source.exists():
                    lost = mended_xdf(source)
                    known = {k: v for k, v in said_in(source).items() if not getattr(trial, k)}
                    trial = trial.but(state="broken off", lost_bytes=lost, note=note, **known)
                    self.broken.append(f"{note}, and judged now")
                else:
                    advice = f"{note}, and its recording is not there: record it again"
                    trial = trial.but(state="judged", verdict="repeat", note=note, advice=advice)
            if trial.verdict is None:
                unjudged.append(number)
            self.trials[number] = trial
        return unjudged

    def _numbers(self, kind: str) -> list[int]:
        """The numbers that files of a kind in the folder have, in order."""
        form = re.compile(rf"{kind}-([0-9]{{2,9}})(?![0-9])")
        matches = (form.match(path.name) for path in self.folder.iterdir())
        return sorted({int(match[1]) for match in matches if match})

    def _free(self) -> int:
        """The number of the next trial: no file in the folder has it, and no trial."""
        return max([0, *self._numbers("trial"), *self.trials]) + 1

    def path(self, number: int, suffix: str) -> Path:
        """A file of a trial."""
        return self.file(f"trial-{number:02d}{suffix}")

    def file(self, name: str) -> Path:
        """A file in the folder; InputError where it is a link, which leads out of it."""
        path = self.folder / name
        if is_link(path):
            raise InputError(f"{shown(path)} is a link; put the file itself there, or remove it")
        return path

    def _between(self) -> Path:
        self._betweens = max([*self._numbers("between"), self._betweens]) + 1
        return self.folder / f"between-{self._betweens:02d}.xdf"


def _waits() -> dict[str, Any]:
    """What is said of a trial as long as nobody says which channel is which: it waits for that."""
    translated = {language: {"advice": words_in(language)(UNMAPPED)} for language in LANGUAGES}
    return {"verdict": "look", "advice": UNMAPPED, "why": UNMAPPED, "translated": translated}


def _refuse_shared(folder: Path) -> None:
    """Refuse links and files that lie elsewhere too: what is written here stays here."""
    for path in folder.iterdir():
        ours = re.match(_OURS, path.name)
        state = path.lstat()
        single = stat.S_ISREG(state.st_mode) and state.st_nlink == 1
        if is_link(path) or (ours and not single):
            raise InputError(
                f"{shown(path)} is no file of its own: it leads elsewhere, or others share it; put "
                "the file itself there, or give another --output"
            )


def _set_aside(path: Path) -> None:
    """Give a file another name; nothing is deleted."""
    number = 1
    while (aside := path.with_name(f"{path.name}.damaged-{number}")).exists():
        number += 1
    path.rename(aside)


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%S%z")
