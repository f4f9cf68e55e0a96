"""A leg on the robot: subject, departures and laboratory give recordings and their truth."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import numpy as np
from scipy.signal import butter, lfilter, sosfilt

from ankle_legs import invariants
from ankle_legs.courses import COURSES
from ankle_legs.measures import DERIVED, active_state, measures
from ankle_legs.movement import FINE, angles, effort, fine_times
from ankle_legs.muscle import Array, integrate
from ankle_legs.subject import ELECTRODES, GRAVITY, LEVER, PARAMETERS, Subject

GAINS = ("g1", "g2", "g3", "g4")
FILM_START = 1.03  # on the robot's clock [s]
FILM_RATE = 1 / 0.03  # frames a second


@dataclass(frozen=True)
class Mounting:
    """How the leg was fixed and wired for a trial."""

    zero: float  # of the torque sensor [Nm]
    electrodes: Array  # what each electrode shows of its muscle's EMG
    crosstalk: Array  # what each electrode (row) hears of each muscle (column)
    delay: float  # of the torque behind the EMG [s]
    noise: float  # of EMG and torque, share of their RMS


@dataclass
class Run:
    """One trial in the making, on the fine grid; departures change it in place."""

    times: Array
    subject: Subject
    mounting: Mounting
    rng: np.random.Generator  # of the trial
    plate: Array  # angle that the robot shows [rad]
    ankle: Array  # angle of the ankle itself
    effort: Array  # of the four muscles, 0 to 1
    emg: Array  # that the muscles make [V]
    excitation: Array  # force that each muscle's EMG asks for [N]
    gain: Array  # on the active force of triceps and tibialis
    extra: Array  # force in parallel to it [N]
    arm: Array  # [m]
    path: Array  # [m]
    length: Array
    force: Array
    active: Array  # activation [N]
    torque: Array  # of the muscles on the ankle, then what the sensor shows [Nm]
    seen: Array  # EMG that the electrodes show [V]
    joint: Array = field(default_factory=lambda: np.zeros(1))  # torque of the joint's tissue [Nm]
    sunk: dict[str, Array] = field(default_factory=dict)  # less turn of the foot, by cause [rad]

    @property
    def step(self) -> float:
        """The fine grid's step [s]."""
        return float(self.times[1] - self.times[0])

    def delayed(self, signal: Array, seconds: float) -> Array:
        """Return a signal (its last axis is time) some seconds later."""
        lag = round(seconds / self.step)
        first = np.repeat(signal[..., :1], lag, axis=-1)
        return np.concatenate([first, signal[..., : signal.shape[-1] - lag]], axis=-1)

    def lagged(self, signal: Array, seconds: float) -> Array:
        """Return a signal after a lag of first order that begins settled."""
        keep = np.exp(-self.step / seconds)
        return np.asarray(lfilter([1 - keep], [1, -keep], signal, zi=keep * signal[..., :1])[0])


@dataclass(frozen=True)
class Departure:
    """A way in which a leg, or its laboratory, is not as the model has it."""

    #: parameters that mean something else with it, and why
    unscored: ClassVar[dict[str, str]] = {}
    #: whether it needs what the muscles did, so that the trial is integrated until it settles
    loops: ClassVar[bool] = False

    def leg(self, subject: Subject) -> Subject:
        """Return the leg with the departure's lasting part."""
        return subject

    def excite(self, run: Run) -> None:
        """Change what drives the muscles."""

    def turn(self, run: Run) -> None:
        """Change the ankle's own angle, from what the muscles did in the last pass."""

    def load(self, run: Run) -> None:
        """Change arm, path, gain or extra force, from what the muscles did in the last pass."""

    def rest(self, angle: Array) -> Array:
        """Return the torque of the joint's own tissue that is held still at an angle [Nm]."""
        return np.zeros(angle.shape)

    def resist(self, angle: Array, step: float) -> Array:
        """Return its torque over a movement [Nm], whose samples are ``step`` seconds apart."""
        del step
        return self.rest(angle)

    def zero(self) -> float:
        """Return how much more than the ankle's own angle the robot shows [rad]."""
        return 0.0

    def measure(self, run: Run) -> None:
        """Change what the sensors show."""


Draw = Callable[[np.random.Generator, float], tuple[Departure, ...]]


def between(
    low: float, high: float, n: int | None = None, *, signed: bool = False, none: float | None = 0.0
) -> Any:
    """Return a departure's field that is drawn evenly, one number or n, of either sign if asked.

    ``none`` is the value that departs from nothing, which strengths of a mixture count from; None:
    the strength does not matter to it.
    """
    return field(metadata={"ends": (low, high), "n": n, "signed": signed, "none": none})


def drawn(*kinds: type[Departure]) -> Draw:
    """Return a function that draws departures of these kinds."""

    def draw_one(kind: type[Departure], rng: np.random.Generator, strength: float) -> Departure:
        values = {}
        for one in fields(kind):
            how: Any = one.metadata
            (low, high), n = how["ends"], how["n"]
            value: Any = rng.uniform(low, high) if n is None else rng.uniform(low, high, n)
            value = value * rng.choice([-1, 1], n) if how["signed"] else value
            if how["none"] is not None:
                value = how["none"] + strength * (value - how["none"])
            values[one.name] = value
        return kind(**values)

    return lambda rng, strength: tuple(draw_one(kind, rng, strength) for kind in kinds)


@dataclass(frozen=True)
class Leg:
    """A leg with hidden truth."""

    family: str
    seed: int
    subject: Subject
    departures: tuple[Departure, ...]
    laboratory: bool = True  # crosstalk, delay; without it only a zero and noise
    rigid: bool = False

    def rng(self, *what: int) -> np.random.Generator:
        """Return the random numbers of one purpose."""
        return generator(self.family, self.seed, *what)

    def mounting(self, number: int) -> Mounting:
        """Draw a mounting; number 0 is the leg's first."""
        rng = self.rng(1, number)
        crosstalk = np.eye(4)
        if self.laboratory:
            crosstalk += rng.uniform(0, 0.08, (4, 4)) * (1 - np.eye(4))
        delay = float(np.clip(self.rng(2).normal(0.040, 0.007), 0.02, 0.06))
        return Mounting(
            zero=float(rng.uniform(-6, 6)),
            electrodes=np.exp(0.2 * rng.normal(size=4)) if number else np.ones(4),
            crosstalk=crosstalk,
            delay=delay if self.laboratory else 0.0,
            noise=0.03,
        )

    def condition(self, trial: int) -> tuple[Subject, Mounting]:
        """Return whose leg, and how mounted, a trial has.

        Trials 1 to 3 differ in movement and effort alone; the leg of trials 4 to 6 is mounted anew;
        from 7 on it is mounted as at first, and treated.
        """
        subject = self.treated() if trial > 6 else self.subject
        return subject, self.mounting(1 if 4 <= trial <= 6 else 0)

    def usual(self, trial: int) -> tuple[str, float]:
        """Return a trial's kind and seconds, if nobody asks for others."""
        del trial
        return "active", 35.0

    def treated(self) -> Subject:
        """Return the leg after a treatment: its passive triceps is softer, and may be weaker."""
        rng, v = self.rng(5), self.subject.values
        share = float(rng.uniform(0.55, 0.75))
        if rng.random() < 0.5:  # less force at every length
            changed = {"x0_tri": v["x0_tri"] - np.log(share) / v["k_tri"]}
        else:  # less stiff, with the same force at the neutral length
            k = v["k_tri"] * share
            neutral = float(self.subject.geometry.paths[0, 0])
            changed = {"k_tri": k, "x0_tri": neutral - (neutral - v["x0_tri"]) * v["k_tri"] / k}
        if rng.random() < 0.5:
            changed |= {g: v[g] * float(rng.uniform(0.6, 0.75)) for g in ("g2", "g3", "g4")}
        return self.subject.with_values(**changed)

    def lasting(self, subject: Subject) -> Subject:
        """Return the leg with what departs in it for good."""
        for departure in self.departures:
            subject = departure.leg(subject)
        return subject

    def truth(
        self,
        subject: Subject,
        mounting: Mounting,
        trial: int,
        kinds: Sequence[str] = ("active",),
        seconds: float = 35.0,
        moves: Sequence[tuple[int, float]] = (),
    ) -> dict[str, Any]:
        """Return parameters and measures of a visit of trials, and why some have no true value.

        ``moves`` are the movements' numbers and seconds, if not those of the trials that follow.
        """
        moves = moves or [(trial + i, seconds) for i in range(len(kinds))]
        unscored = {k: why for d in self.departures for k, why in d.unscored.items()}
        if self.rigid:
            unscored |= dict.fromkeys(("dlt_tri", "dlt_tib"), "this leg's tendons are rigid")
        values: dict[str, float | None] = dict(subject.values)
        for i, name in enumerate(GAINS):
            values[name] = subject.values[name] / float(mounting.electrodes[i])
        measures = self.measures(subject, mounting, kinds, moves)
        derived = {m: why for p, why in unscored.items() for m in DERIVED.get(p, ())}
        unscored |= derived | invariants.unscored(unscored)
        for name in unscored:
            for one in [m for m in measures if m.startswith(name)]:
                measures[one] = None
            if name in values:
                values[name] = None
        return {
            "parameters": {name: values[name] for name in PARAMETERS},
            "measures": measures,
            "unscored": unscored,
        }

    def measures(
        self,
        subject: Subject,
        mounting: Mounting,
        kinds: Sequence[str],
        moves: Sequence[tuple[int, float]],
    ) -> dict[str, float | None]:
        """Return the measures over what the trials of a visit moved and activated."""
        lasting, moved, drives = self.lasting(subject), [], []
        for (number, seconds), kind in zip(moves, kinds, strict=True):
            run = _start(fine_times(seconds), lasting, mounting, self.rng(3, number), kind)
            for departure in self.departures:
                departure.excite(run)
                if not departure.loops:
                    departure.turn(run)
            moved.append(run.ankle[::FINE])  # where the ankle itself was
            drives.append(_drives(run))
        ends = np.percentile(np.concatenate(moved), [1, 99])
        step, active = run.step, []
        for i, muscle in enumerate(lasting.muscles()):
            states = [active_state(muscle, drive[i], step)[::FINE] for drive in drives]
            active.append(float(np.percentile(np.concatenate(states), 99)))
        largest = (active[0], active[1])
        return self.read(subject, mounting, (float(ends[0]), float(ends[1])), largest)

    def read(
        self,
        subject: Subject,
        mounting: Mounting,
        ends: tuple[float, float],
        active: tuple[float, float],
    ) -> dict[str, float | None]:
        """Return the measures of a leg that moved between two angles, as active as that."""
        lasting = self.lasting(subject)
        shown = [subject.values[g] / float(mounting.electrodes[j]) for j, g in enumerate(GAINS)]
        weights = (float(sum(shown[1:])), float(shown[0]))
        made = measures(lasting, weights, self.rest, self.resist, ends, active)
        return made | invariants.invariants(lasting, shown, ends, active)

    def rest(self, angle: Array) -> Array:
        """Return the torque of the joint's own tissue, at rest at an angle [Nm]."""
        return np.asarray(sum((d.rest(angle) for d in self.departures), np.zeros(angle.shape)))

    def resist(self, angle: Array, step: float) -> Array:
        """Return the torque of the joint's own tissue over a movement [Nm]."""
        return np.asarray(
            sum((d.resist(angle, step) for d in self.departures), np.zeros(angle.shape))
        )

    def record(
        self,
        trial: int,
        seconds: float = 35.0,
        kind: str = "active",
        *,
        movement: int | None = None,
        mounting: Mounting | None = None,
    ) -> Run:
        """Return a trial, simulated; the leg's departures are at work in it.

        ``movement`` is the number of another movement and effort, in the trial's condition.
        """
        subject, mounted = self.condition(trial)
        subject, mounting = self.lasting(subject), mounting or mounted
        rng = self.rng(3, trial if movement is None else movement)
        run = _start(fine_times(seconds), subject, mounting, rng, kind)
        for departure in self.departures:
            departure.excite(run)
        _integrate(run, self.departures)
        run.torque = run.torque + self.resist(run.ankle, run.step)
        speed = np.gradient(run.plate, run.step)
        weight = GRAVITY * LEVER * np.cos(run.ankle)
        run.torque = run.torque + subject.values["m"] * (
            LEVER**2 * np.gradient(speed, run.step) + weight
        )
        run.seen = mounting.crosstalk @ (mounting.electrodes[:, None] * run.emg)
        for departure in self.departures:
            departure.measure(run)
        return run

    def columns(self, run: Run, trial: int, *, raw: bool = False) -> dict[str, Array]:
        """Return what is recorded of a trial: envelopes at 128 Hz, or raw EMG at 1024."""
        rng, noise = self.rng(4, trial), run.mounting.noise
        every = 2 if raw else FINE
        columns = {"time_s": run.times[::every], "angle_rad": run.plate[::every]}
        torque = run.torque[::every]
        size = noise * np.sqrt(np.mean(torque**2))
        columns["torque_Nm"] = torque + run.mounting.zero + size * rng.normal(size=torque.size)
        if raw:  # each muscle's own noise, of a mean size of one, crosses to the electrodes
            band = butter(2, [20, 400], "bandpass", fs=1 / run.step, output="sos")
            source = sosfilt(band, rng.normal(size=run.emg.shape))
            source *= np.sqrt(np.pi / 2) / source.std(axis=1, keepdims=True)
            shown = run.mounting.electrodes[:, None] * run.emg
            mixed = run.mounting.crosstalk @ (shown * source)
            seen = (mixed * run.seen / (run.mounting.crosstalk @ shown))[:, ::every]
            seen += 2e-6 * rng.normal(size=seen.shape)
        else:
            seen = run.seen[:, ::every]
            sizes = noise * np.sqrt(np.mean(seen**2, axis=1, keepdims=True))
            seen = np.abs(seen + sizes * rng.normal(size=seen.shape))
        return columns | {f"emg_{name}_V": row for name, row in zip(ELECTRODES, seen, strict=True)}

    def seen_fascicles(self) -> dict[str, dict[str, float]]:
        """Return how filmed fascicles see their group's length: a scale and a zero of their own."""
        rng = self.rng(7)
        return {
            name: {"scale": float(rng.uniform(low, 2 - low)), "zero_mm": float(rng.normal(0, zero))}
            for name, low, zero in (("fascicle_gm", 0.9, 6.0), ("fascicle_tib", 0.95, 4.0))
        }

    def film(self, run: Run, trial: int) -> dict[str, Array]:
        """Return fascicles' lengths at 33 Hz; their tracker drifts by 1 to 2 mm over seconds."""
        rng, times = self.rng(6, trial), np.arange(FILM_START, run.times[-1], 1 / FILM_RATE)
        columns = {"time_s": times}
        for i, (name, how) in enumerate(self.seen_fascicles().items()):
            length = how["scale"] * 1e3 * np.interp(times, run.times, run.length[i])
            kicks = rng.normal(size=(3, times.size))
            for row, (size, seconds) in enumerate(((rng.uniform(0.5, 1), 5.0), (0.25, 0.15))):
                keep = np.exp(-1 / (FILM_RATE * seconds))
                settled = lfilter([np.sqrt(1 - keep**2)], [1, -keep], kicks[row])
                length = length + size * settled
            columns[f"{name}_mm"] = length + how["zero_mm"] + 0.1 * kicks[2]
        return columns


def generator(family: str, seed: int, *what: int) -> np.random.Generator:
    """Return random numbers that belong to a family, a seed and a purpose."""
    return np.random.default_rng([zlib.crc32(family.encode()), seed, *what])


def _start(
    times: Array, subject: Subject, mounting: Mounting, rng: np.random.Generator, kind: str
) -> Run:
    if kind in COURSES:
        angle, active = COURSES[kind](rng, times, *subject.range)
    else:
        angle = angles(rng, times, *subject.range, kind)
        active = effort(rng, times, kind)
    arms = subject.geometry.arm(np.zeros(1))[:, 0]
    peak = np.array([subject.torque[1] / arms[1], *[subject.torque[0] / arms[0]] * 3])
    gains = np.array([subject.values[name] for name in ("g1", "g2", "g3", "g4")])
    rest = rng.uniform(1e-6, 3e-6, 4)
    emg = rest[:, None] + active * (peak / gains)[:, None]
    pair = np.zeros((2, times.size))
    return Run(
        times=times,
        subject=subject,
        mounting=mounting,
        rng=rng,
        plate=angle,
        ankle=angle,
        effort=active,
        emg=emg,
        excitation=gains[:, None] * emg,
        gain=np.ones_like(pair),
        extra=pair,
        arm=subject.geometry.arm(angle),
        path=subject.geometry.path(angle),
        length=pair,
        force=pair,
        active=pair,
        torque=np.zeros(times.size),
        seen=emg,
    )


def _drives(run: Run) -> tuple[Array, Array]:
    """Return what the activations of triceps and tibialis follow [N]."""
    late = run.delayed(run.excitation, run.mounting.delay)
    return late[1:].sum(axis=0), late[0]


def _integrate(run: Run, departures: tuple[Departure, ...]) -> None:
    """Integrate both muscles, again and again where a departure needs what they did."""
    drive = _drives(run)
    constants = [muscle.constants() for muscle in run.subject.muscles()]
    looping = any(d.loops for d in departures)
    for _ in range(60 if looping else 1):
        before = run.torque + run.joint
        run.ankle = run.plate
        for departure in departures:
            departure.turn(run)
        run.gain, run.extra = np.ones_like(run.gain), np.zeros_like(run.extra)
        run.arm, run.path = (
            run.subject.geometry.arm(run.ankle),
            run.subject.geometry.path(run.ankle),
        )
        for departure in departures:
            departure.load(run)
        passes = [
            integrate(run.step, run.path[i], drive[i], run.gain[i], run.extra[i], constants[i])
            for i in range(2)
        ]
        run.length = np.array([p[0] for p in passes])
        run.force = np.array([p[1] for p in passes])
        run.active = np.array([p[2] for p in passes])
        pulls = run.arm * run.force
        run.torque = pulls[0] - pulls[1]
        if not looping or np.max(np.abs(run.torque + run.joint - before)) < 1e-3:
            return
    raise ArithmeticError("the leg and its departures do not settle; take another seed")
