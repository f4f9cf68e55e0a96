"""A folder of trials: started, stopped and judged; what a crash left behind is found again.

Beside each other lie ``trial-01.xdf`` as it came, ``trial-01.h5`` as a recording, ``trial-01.json``
with the verdict, and in ``between-01.xdf`` what came before the next trial. A trial without a
verdict in its JSON broke off: the next start says so, mends and judges it. One program writes to a
folder at a time, and to nothing outside of it.
"""

import json
import re
import sqlite3
import stat
import threading
import time
from collections.abc import Iterable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, Literal, TypedDict

from pydantic import BaseModel, ConfigDict, Field

from surae.api import ROLES
from surae.base.database import lock
from surae.base.errors import InputError, SuraeError
from surae.base.files import PathLike, is_link, read_bytes, shown, write_atomic, write_json
from surae.base.units import FACTORS, kind
from surae.base.units import plain as plain_unit
from surae.processes import Child, End
from surae_workbench.live.recorder import Recorder, Show, Tell
from surae_workbench.live.stream import Stream
from surae_workbench.live.target import KIND
from surae_workbench.live.xdf import mended_xdf
from surae_workbench.web.rows import plain

#: The JSON of a trial, its findings and reasons take far less [bytes].
_LARGEST = 4 * 2**20
#: After the end of a trial, the samples of its last moments are waited for so long at most [s].
_LATE = 0.25
#: A trial is held against so many others at most: it must not be judged later and later.
_EARLIER = 8


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
        self.folder, self._told = Path(folder), tell
        self.limits = dict(limits or {})
        self._betweens = 0
        self._mapping = None if mapping is None else Path(mapping)
        self.joint, self._made = joint, ""
        self._judge, self._refine = Child(calls=None), Child(nice=10, calls=None)
        self._work = ThreadPoolExecutor(1, "live-judge")
        self._later = ThreadPoolExecutor(1, "live-refine")
        self.session: dict[str, Any] = {"state": "waiting"}
        self._pending: Future[None] | None = None
        self._tried: list[int] = []
        self._closed = False
        self._lock = threading.Lock()
        self.trials: dict[int, dict[str, Any]] = {}
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
                unjudged, first = self._known(), self._between()
                self.recorder = Recorder(
                    first, show=show, tell=self._tell, network=network, but=but
                )
            except (OSError, sqlite3.Error) as error:
                why = getattr(error, "strerror", None) or str(error)
                raise InputError(f"{shown(self.folder)}: {why}; give another --output") from None
            self._opened = opened.pop_all()
        self.warm = self._work.submit(self._judge.call, "surae_workbench.live.judge:warm", {})
        self.verdicts = {n: self._work.submit(self._judged, n, None, None) for n in unjudged}
        if joint and self.trials:  # what was known before this start is known again
            self._ask_together()

    def start(self, **about: Any) -> int:
        """Begin a trial; what is known `about` it is kept. Returns its number."""
        with self._lock:
            if self.running is not None:
                raise InputError(f"trial {self.running} is running; stop it first")
            if trouble := self.recorder.full:
                raise InputError(f"no trial is started: {trouble}")
            number = self._free()
            while True:  # somebody else may make the same file at this moment
                try:
                    self.recorder.turn(self.path(number, ".xdf"))
                    break
                except FileExistsError:
                    number += 1
            self.running, self._begun = number, self.recorder.clock()
            self.trials[number] = {
                "trial": number, "state": "recording", "began": _now(), **about, "marks": [],
            }  # fmt: skip
            self._keep(number)  # what was asked for is known after a crash, too
        self.recorder.note("start", trial=number, **about)
        self._tell("trial", self.trials[number])
        return number

    def take(self, path: Path) -> int:
        """Take a file that was recorded otherwise as a trial, and judge it. Returns its number."""
        with self._lock:
            number = self._free()
            self.trials[number] = {
                "trial": number, "state": "being judged", "began": _now(), "protocol": path.name,
                "file": str(path), "marks": [],
            }  # fmt: skip
            self._drop_together()
            self._keep(number)
        self._tell("trial", self.trials[number])
        self.verdicts[number] = self._work.submit(self._judged, number, None, time.monotonic())
        return number

    def mark(self, text: str = "") -> None:
        """Write a mark down, at this moment."""
        number = self.running
        self.recorder.note("mark", text=text)
        if number is not None:
            at = self.recorder.clock() - self._begun
            self.trials[number]["marks"].append({"at": round(at, 3), "text": text})

    def stop(self, begin: float | None = None) -> "Future[dict[str, Any]]":
        """End the trial and have it judged; the future holds what is said of it.

        `begin` is when its target began, in LSL's time [s].
        """
        with self._lock:
            number, self.running = self.running, None
            if number is None:
                raise InputError("no trial is running; start one first")
            self._drop_together()
        ended, now = time.monotonic(), self.recorder.clock()
        self.recorder.note("stop", trial=number)
        while not self.recorder.arrived(now) and time.monotonic() < ended + _LATE:
            time.sleep(0.005)
        origin = self.recorder.turn(self._between())
        self.trials[number]["state"] = "being judged"
        self._tell("trial", self.trials[number])
        late = None if begin is None or origin is None else begin - origin
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
        own = self.folder / "mapping.toml"
        text = mapping_of(list(self.recorder.streams.values()))
        if text and text != self._made:
            with suppress(SuraeError):  # the disk is full; what is there is used
                write_atomic(self.file("mapping.toml"), text)
                self._made = text
        return own if own.exists() else None

    def _judged(self, number: int, begin: float | None, ended: float | None) -> dict[str, Any]:
        """Judge a trial in the child, keep and tell what it says."""
        trial = self.trials[number]
        source = Path(trial["file"]) if "file" in trial else self.path(number, ".xdf")
        while not self.recorder.whole(source) and not self._closed:  # there is room on the disk
            time.sleep(0.05)
        try:
            arguments = self._arguments(number, source, begin)
        except InputError as error:
            judgement: dict[str, Any] = {"why": str(error)}
        else:
            end = self._judge.call("surae_workbench.live.judge:judge", arguments)
            if self._closed and end.how != "done":  # nothing is on disk: the next start judges it
                return trial
            judgement = end.value if end.how == "done" else {"why": end.message}
            if end.how in ("failed", "killed"):  # our mistake, not the trial's
                judgement |= {"verdict": "look", "advice": f"It could not be judged: {end.message}"}
        if "findings" not in judgement:
            judgement = {
                "findings": [], "grade": None, "vaf": None, "reasons": [], "verdict": "repeat",
                "advice": judgement["why"], **judgement,
            }  # fmt: skip
        if "split" in trial:
            judgement |= {"verdict": "repeat", "advice": trial["split"]}
        trial |= judgement
        output = self.folder / f"trial-{number:02d}.h5"
        trial["recording"] = str(output if output.exists() else source)
        trial["state"] = "judged"
        if ended is not None:
            trial["seconds_to_verdict"] = round(time.monotonic() - ended, 3)
        self._keep(number)
        self._tell("trial", trial)
        if self.joint:
            self._ask_together()
        return trial

    def _arguments(self, number: int, source: Path, begin: float | None) -> dict[str, Any]:
        """What the judge needs; InputError where nothing can be judged."""
        mapping = self._mapping if "file" in self.trials[number] else self.mapping
        if mapping is None and "file" not in self.trials[number]:
            raise InputError("the streams do not say which channel is which; give a --mapping")
        target = self.path(number, "-target.csv")
        return {
            "file": str(source),
            "output": str(self.path(number, ".h5")),
            "earlier": self._others(number),
            "mapping": None if mapping is None else str(mapping),
            "efforts": self._efforts([number, *self.trials]),
            "target": None if begin is None or not target.exists() else str(target),
            "begin": begin or 0.0,
        }

    def _tell(self, event: str, data: Mapping[str, Any]) -> None:
        """Pass on what happens; a stream that changed within a trial spoils it."""
        number = self.running
        if event == "layout" and data["split"] and number is not None:
            self.trials[number]["split"] = (
                f"Within the trial {data['stream']} {data['remark']}. Only what came before is in "
                "the recording: record the trial again."
            )
        self._told(event, data)

    def _keep(self, number: int) -> None:
        """Write down what is known of a trial."""
        try:
            write_json(self.path(number, ".json"), self.trials[number])
        except (OSError, SuraeError) as error:
            note = f"its state is not on disk ({error}); the next start judges it again"
            self.trials[number]["note"] = note

    def _others(self, number: int) -> list[str]:
        """Recordings of other trials that were not spoilt: maxima, and the newest."""
        good = [
            other
            for other, trial in sorted(self.trials.items())
            if other != number
            and trial.get("verdict") in ("keep", "look")
            and self.path(other, ".h5").exists()
        ]
        good.sort(key=lambda other: self.trials[other].get("effort") == "maximal")
        return [str(self.path(other, ".h5")) for other in good[-_EARLIER:]]

    def _efforts(self, numbers: Iterable[int]) -> dict[str, str]:
        """The efforts that were asked for, by the name of the recording."""
        return {
            self.path(number, "").stem: str(self.trials[number]["effort"])
            for number in numbers
            if "effort" in self.trials[number]
        }

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
            if trial.get("verdict") in ("keep", "look") and self.path(number, ".h5").exists()
        ]
        moving = [number for number in worth if self.trials[number].get("use") == "fit"]
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
            row, source = self.path(number, ".json"), self.path(number, ".xdf")
            trial = _trial_of(row, number)
            note = f"trial {number} broke off; what had arrived is kept"
            if trial is None and row.exists():
                _set_aside(row)
                note = f"trial {number}: {row.name} is damaged, and was set aside"
            elif trial is None and not source.exists():
                continue  # a target's file alone
            if trial is None or not trial.keys() & {"verdict", "file"}:
                trial = {"trial": number, "marks": [], **(trial or {}), "note": note}
                if source.exists():
                    trial |= {"state": "broken off", "lost_bytes": mended_xdf(source)}
                    self.broken.append(f"{note}, and judged now")
                else:
                    advice = f"{note}, and its recording is not there: record it again"
                    trial |= {"state": "judged", "verdict": "repeat", "advice": advice}
            if "verdict" not in trial:
                unjudged.append(number)
            self.trials[number] = trial
        return unjudged

    def _numbers(self, kind: str) -> list[int]:
        """The numbers that files of a kind in the folder have, in order."""
        form = re.compile(rf"{kind}-([0-9]{{2,9}})(?![0-9])")
        found = (form.match(path.name) for path in self.folder.iterdir())
        return sorted({int(match[1]) for match in found if match})

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


def _refuse_shared(folder: Path) -> None:
    """Refuse links and files that lie elsewhere too: what is written here stays here."""
    for path in folder.iterdir():
        ours = re.match(r"(trial|between)-|(live\.lock|mapping\.toml|joint\.json)$", path.name)
        state = path.lstat()
        own = stat.S_ISREG(state.st_mode) and state.st_nlink == 1
        if is_link(path) or (ours and not own):
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


def mapping_of(streams: list[Stream]) -> str:
    """A mapping for streams that name their channels as we do: ``angle``, ``emg_ta``, with a unit.

    Empty where the angle is not among them, or two say that they are the same.
    """
    lines: dict[str, str] = {}
    for stream in streams:
        for column, label, unit in zip(stream.columns, stream.labels, stream.units, strict=True):
            role, known = plain_unit(label), plain_unit(unit)
            if role not in ROLES or known not in FACTORS[kind(role)] or stream.kind == KIND:
                continue
            if role in lines:
                return ""
            lines[role] = (
                f"[channels.{role}]\ncolumn = {json.dumps(column)}\nunit = {json.dumps(known)}\n"
            )
    return "".join(lines.values()) if "angle" in lines else ""


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%S%z")


class _Trial(BaseModel):
    """Nothing is taken for what it is not; what a newer surae adds is left as it is."""

    model_config = ConfigDict(strict=True, extra="allow", allow_inf_nan=False)

    trial: int
    state: str
    marks: list[dict[str, Any]]
    effort: Literal["maximal", "passive"] | None = None
    protocol: str | None = None
    file: str | None = Field(None, min_length=1)
    note: str | None = None
    verdict: Literal["keep", "look", "repeat"] | None = None
    why: str | None = None
    advice: str | None = None
    grade: str | None = None
    vaf: float | None = None
    findings: list[dict[str, Any]] = []
    reasons: list[str] = []


def _trial_of(path: Path, number: int) -> dict[str, Any] | None:
    """A trial of before, by its number; None where there is no file, or it is damaged."""
    try:
        text = read_bytes(path, _LARGEST).decode()
        trial = plain(text)
        json.dumps(trial, ensure_ascii=False).encode()  # half a character is no text
        known = _Trial.model_validate(trial)
    except (InputError, ValueError):
        return None
    graded = known.grade is None or known.vaf is not None
    return dict(trial) if known.trial == number and graded else None
