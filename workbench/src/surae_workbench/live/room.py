"""The room of a measurement: what is requested, what is recorded, and, in a rehearsal, the leg."""

import threading
from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Unpack

import numpy as np
import numpy.typing as npt

from surae.api import (
    DEVICES,
    MUSCLES,
    Given,
    Protocol,
    Trajectory,
    allowed_range,
    as_device,
    held_to_torque,
    load_of,
    read_protocol,
    ready_protocols,
    ready_trajectory,
    requested_limits,
    smooth_step,
    telling,
    write_protocol_csv,
)
from surae.base.cleaning import cleaned
from surae.base.errors import InputError, SuraeError
from surae.base.files import PathLike
from surae.base.frozen import read_only
from surae.base.names import TELLING
from surae.base.units import FloatArray
from surae.base.words import N_
from surae.processes import Child
from surae_workbench.live import rehearsal
from surae_workbench.live.alarms import EVERY, Alarm, Watch
from surae_workbench.live.laboratory import Laboratory
from surae_workbench.live.recorder import Show, Tell
from surae_workbench.live.showing import Roles, roles_of
from surae_workbench.live.stream import Stream
from surae_workbench.live.target import NAME as TARGET
from surae_workbench.live.target import TargetStream
from surae_workbench.live.trials import Trials, TrialsOptions, silent

#: The name of the target of maximum contractions.
MAXIMUM = "maximum"
#: Rate of a target's file [Hz].
_RATE = 256.0
#: A trial goes on after its movement for so long [s].
_AFTER = 0.5
#: A watched folder is looked at this often [s].
_WATCH = 1.0
#: Endings of files that a program is still writing.
_UNFINISHED = (".tmp", ".part", ".partial", ".crdownload")
#: States of a stream that sends nothing.
QUIET = ("silent", "lost")
#: The simulated laboratory is waited for so long [s]: the first time, all is compiled.
_PATIENCE = 180.0


class RoomOptions(TrialsOptions, total=False):
    """What a room may be made with beside the folder of its trials, see `Room`."""

    watch: PathLike | None
    leg: int | None
    device: str | None
    span: tuple[float, float] | None


class Room:
    """Trials with a target; all that is not named here is as of `Trials`.

    Files that appear in the folder `watch` are trials too. In a rehearsal `leg` says whose leg it
    is; None: the streams are real. `device` moves the leg: a name, or the TOML file of a device,
    refused where there is none; None: it is not known, and no limit is watched. `span` is the
    subject's full plantarflexion and dorsiflexion [rad], refused where the device does not reach so
    far; by default movements are made for a healthy leg, as far as it does.
    """

    def __init__(
        self,
        folder: PathLike,
        *,
        show: Show = silent,
        tell: Tell = silent,
        leg: int | None = None,
        watch: PathLike | None = None,
        device: str | None = None,
        span: tuple[float, float] | None = None,
        **trials: Unpack[TrialsOptions],
    ) -> None:
        self.device = as_device(device)
        self.range = allowed_range(self.device, span)
        self._span = span
        self.laboratory = None if leg is None else Laboratory(leg)
        self.alarms = Watch(self.device, self._agreed)
        self._roles: Roles = {}
        self._show = show
        self._tell = tell
        try:
            self.trials = Trials(
                folder,
                **trials,
                show=self._seen,
                tell=self._heard,
                but=(rehearsal.CONTROL,),
                limits={"device": _place(device), "span": span},
            )
        except BaseException:
            if self.laboratory is not None:
                self.laboratory.close()
            raise
        self.target = TargetStream()
        self.trajectory: Trajectory | None = None
        self._loaded: dict[str, Any] = {}
        self.planned: dict[str, Any] = {}
        #: What the loaded trial asks of the device: sentences, and their parts.
        self.limits: list[dict[str, Any]] = []
        self._expects = Child(nice=10)
        self.begin: float | None = None
        self._timer: threading.Timer | None = None
        self._lock = threading.Lock()
        self._ended = threading.Event()
        threading.Thread(target=self._look, daemon=True, name="live-alarms").start()
        if watch is not None:
            threading.Thread(
                target=self._watch, args=(Path(watch),), daemon=True, name="live-watch"
            ).start()

    def load(
        self, path: PathLike | None = None, name: str = "", *, beyond: bool = False, **protocol: Any
    ) -> None:
        """Load the next trial's target.

        It is a file as `surae protocol` writes it, called `name` if not as the file, refused where
        it asks for more than the device can do, unless `beyond` says that it may; the ``profile``
        of a designed protocol that comes with surae, or of a movement that tells tissue from
        reflex; else a `surae.protocol.Protocol` without device and range, which are the room's.
        These are lowered to what the device can do.
        """
        with self._lock:
            if self.trials.running is not None:
                raise InputError("a trial is running; stop it before another protocol is loaded")
            profile = str(protocol.get("profile", ""))
            given_up: tuple[str, ...] = ()
            if path is None and profile == MAXIMUM:
                trajectory = _maximum(self.range)
                name = MAXIMUM
            elif path is None and profile in TELLING:
                trajectory = telling(profile, self.device, self.range, _RATE)
                name = profile
            elif path is None and profile in ready_protocols():
                trajectory = ready_trajectory(profile, self.device, self.range, _RATE)
                name = profile
            elif path is None:
                settings = Protocol(
                    device=self.device, angle_range=self.range, rate_hz=_RATE, **protocol
                )
                trajectory, given_up = _held(settings)
                name = f"{profile} {protocol.get('task', '')}".strip()
            else:
                trajectory = read_protocol(path)
                name = name or Path(path).stem
            on_device = replace(trajectory.settings, device=self.device)
            limits = requested_limits(replace(trajectory, settings=on_device))
            too_much = [limit.message for limit in limits if limit.exceeded]
            if too_much and path is not None and not beyond:
                raise InputError(f"{cleaned(name)} is not loaded: {'; '.join(too_much)}")
            write_protocol_csv(trajectory, self._file)
            self.trajectory = trajectory
            self._loaded = {"path": path, "name": name, "beyond": beyond, **protocol}
            self.alarms.speed = float(np.abs(trajectory.velocity).max())
            effort = "maximal" if trajectory.settings.task == "maximal" else "active"
            self.planned = {
                "protocol": cleaned(name),
                "seconds": float(trajectory.time[-1]),
                "effort": effort if trajectory.effort.any() else "passive",
            }
            self.limits = [
                *({"text": e.message, **e.message.parts(), "exceeded": e.exceeded} for e in limits),
                *({"text": text} for text in given_up),
                *(_asks(trajectory) if self.device is None else ()),
            ]
            self.target.load(trajectory)
            self._go_back()
            self._tell("protocol", {**self.planned, "limits": self.limits})

    def choose_device(self, device: str | None) -> None:
        """Have another device, or an unknown one, move the leg: what is loaded keeps to it."""
        if self.trials.running is not None:
            raise InputError("a trial is running; stop it before another device is chosen")
        chosen = as_device(device)
        self.range = allowed_range(chosen, self._span)
        self.device = self.alarms.device = chosen
        self.alarms.span = self._agreed
        self.trials.limits |= {"device": _place(device)}
        if self._loaded:
            self.load(**self._loaded)

    @property
    def _agreed(self) -> tuple[float, float] | None:
        """The range that the leg must stay in; None where nobody gave one, nor a device."""
        return None if self.device is None and self._span is None else self.range

    def tells(self) -> list[str]:
        """What the loaded trial will tell, in sentences: of this leg, once it was fitted.

        The numbers are those of ``surae expect next-target.csv --fit joint.json``.
        """
        if self.trajectory is None:
            raise InputError("nothing is loaded; load a movement first")
        of_muscles = self.trajectory.settings.profile not in TELLING
        known = of_muscles and self.trials.session.get("parameters")
        fit = self.trials.file("joint.json") if known else None
        arguments = {"protocol": str(self._file), "fit": None if fit is None else str(fit)}
        sentences: list[str] = self._expects.call(
            "surae_workbench.live.judge:tells", arguments
        ).result()
        return sentences

    @property
    def _file(self) -> Path:
        """The next trial's request."""
        return self.trials.file("next-target.csv")

    def _go_back(self) -> None:
        """Send the device of a rehearsal to where the next trial begins."""
        if self.laboratory is not None and self.trajectory is not None:
            self.laboratory.load(str(self._file.resolve()), max([*self.trials.trials, 0]) + 1)

    @property
    def ready(self) -> bool:
        """Whether a trial can begin: nothing is being loaded, and all are warm and in place."""
        return (
            not self._lock.locked()
            and self.trials.warm.done()
            and not self.trials.doubts
            and (self.laboratory is None or self.laboratory.ready)
        )

    def load_next(self) -> None:
        """Load what was found best to measure next."""
        proposed = self.trials.session.get("proposed")
        if not proposed:  # a file that is there may be of another day
            raise InputError("nothing says yet what to measure next; fit a trial first")
        # It was made for this device, by what this leg is.
        self.load(self.trials.file("measure-next.csv"), name=f"next: {proposed}", beyond=True)

    def start(self, countdown: float = 0.5) -> int:
        """Begin a trial; the target moves after a countdown [s]. Returns the trial's number."""
        with self._lock:
            if self.laboratory is not None:
                self.laboratory.wait(_PATIENCE)
            number = self.trials.start(**self.planned)
            if self.trajectory is not None:
                with suppress(SuraeError):  # on a full disk the trial goes on, and is judged
                    file = self.trials.path(number, "-target.csv")
                    write_protocol_csv(self.trajectory, file)
                self.begin = self.trials.recorder.clock() + countdown
                self.target.begin(self.begin)
                if self.laboratory is not None:
                    self.laboratory.start(self.begin)
                seconds = countdown + self.planned["seconds"] + _AFTER
                self._timer = threading.Timer(seconds, self._over, (number,))
                self._timer.daemon = True
                self._timer.start()
            return number

    def stop(self) -> "Future[dict[str, Any]]":
        """End the trial, and have it judged."""
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
            verdict = self.trials.stop(self.begin)
            self.target.end()
            self.begin = None
            if self.laboratory is not None:
                self.laboratory.stop()
                self._go_back()
            return verdict

    def close(self) -> None:
        """End all."""
        self._ended.set()
        if self._timer is not None:
            self._timer.cancel()
        self._expects.close()
        self.trials.close()
        self.target.close()
        if self.laboratory is not None:
            self.laboratory.close()

    @property
    def roles(self) -> Roles:
        """Which column is which signal; while somebody edits the mapping, as it was before."""
        with suppress(
            SuraeError, OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError
        ):
            self._roles = roles_of(self.trials.mapping)
        return self._roles

    def _seen(self, stream: Stream, times: FloatArray, values: npt.NDArray[Any]) -> None:
        self.alarms.show(stream, times, values)
        self._show(stream, times, values)

    def _heard(self, event: str, data: Mapping[str, Any]) -> None:
        self._tell(event, data)
        if event in QUIET and data["stream"] != TARGET:
            self._alarm(sends_nothing(data["stream"]))

    def _look(self) -> None:
        """Look at what arrives; a mistake of ours ends nothing."""
        while not self._ended.wait(EVERY):
            with suppress(Exception):
                self.alarms.roles = self.roles
                now = self.trials.recorder.clock()
                for alarm in self.alarms.look(now, self.target.now()[1:]):
                    self._alarm(alarm)

    def _alarm(self, alarm: Alarm) -> None:
        """Tell what goes wrong; within a trial it is kept with it."""
        begin = self.begin
        now = self.trials.recorder.clock()
        at = None if begin is None else round(now - begin, 2)
        if self.trials.running is not None:
            self.trials.alarm({"at": at, **alarm.shown()})
        self._tell("alarm", {"at": at, **alarm.shown()})

    def _watch(self, folder: Path) -> None:
        """Take files that appear, once they do not grow any more."""
        known = set(_files(folder))
        growing: dict[Path, int] = {}
        while not self._ended.wait(_WATCH):
            for path, size in _files(folder).items():
                if path not in known and size > 0 and growing.get(path) == size:
                    known.add(path)
                    self.trials.take(path)
                growing[path] = size

    def _over(self, number: int) -> None:
        if self.trials.running == number:
            with suppress(InputError):  # somebody stopped it at this moment
                self.stop()


def _place(device: str | None) -> str | None:
    """A device as another process finds it: its name, or the whole path of its file."""
    return device if device is None or device in DEVICES else str(Path(device).resolve())


def _asks(trajectory: Trajectory) -> list[dict[str, Any]]:
    """What a movement asks of any device and leg, in a sentence with its parts."""
    message = load_of(trajectory).message
    return [{"text": message, **message.parts()}]


def is_unclear(message: str, given: dict[str, str]) -> Alarm:
    """The alarm of streams of which nobody knows which is which."""
    return Alarm("streams", None, message, given)


def sends_nothing(stream: str) -> Alarm:
    """The alarm of a stream that is silent or lost."""
    what = N_("{stream} sends nothing: look at its program, cable and battery.")
    return Alarm("stream", None, what, {"stream": stream})


def _files(folder: Path) -> dict[Path, int]:
    """The files in a folder with their sizes, in order; none where it cannot be read now.

    Programs that copy write under another name first: such a file may be gone when it is looked at.
    """
    sizes: dict[Path, int] = {}
    with suppress(OSError):
        for path in sorted(folder.iterdir()):
            if path.name.startswith(".") or path.suffix.lower() in _UNFINISHED:
                continue
            with suppress(OSError):
                if path.is_file():
                    sizes[path] = path.stat().st_size
    return sizes


@lru_cache(maxsize=32)
def _held(settings: Protocol) -> tuple[Trajectory, tuple[str, ...]]:
    """A protocol within its device's torque, and what was given up for it."""
    return held_to_torque(settings)


def _maximum(allowed: tuple[float, float]) -> Trajectory:
    """Maximum contractions: first all push down, then pull up.

    The foot is held still, level where the device reaches that.
    """
    time = np.arange(round(18.0 * _RATE) + 1) / _RATE
    level_angle = min(max(0.0, allowed[0]), allowed[1])
    still = np.zeros(len(time))
    effort = np.zeros((len(time), len(MUSCLES)))
    for muscles, begins in ((("gl", "sol", "gm"), 3.0), (("ta",), 11.0)):
        level = smooth_step((time - begins) / 0.5) * smooth_step((begins + 4.0 - time) / 0.5)
        for muscle in muscles:
            effort[:, MUSCLES.index(muscle)] = level
    around = (level_angle - 0.01, level_angle + 0.01)
    settings = Given(profile=MAXIMUM, task="maximal", angle_range=around, rate_hz=_RATE)
    return Trajectory(
        settings=settings,
        time=read_only(time),
        angle=read_only(still + level_angle),
        velocity=read_only(still),
        acceleration=read_only(still),
        effort=read_only(effort),
    )
