"""Relaxed legs, arms and paths for the last count. Who makes an estimate does not open this file.

Sizes are what physiology and laboratories report. The numbers of the families tell nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np
from scipy.interpolate import PchipInterpolator

from ankle_legs import last, look
from ankle_legs.handling import (
    HeelLift,
    MovedZero,
    Play,
    SoftPlate,
    StretchReflex,
    Tilted,
    Tone,
    pull_calf,
)
from ankle_legs.leg import Departure, Run, between, drawn
from ankle_legs.muscle import Array
from ankle_legs.paths import ARM_SD, Way
from ankle_legs.relaxed import Draws, tissue
from ankle_legs.subject import Subject
from ankle_legs.tissue import SHARED, Form, Tissue

Departures = tuple[Departure, ...]


@dataclass(frozen=True)
class Powered(Form):
    """Nothing before the slack angle, then a power (``bend``) of what is beyond it."""

    def raw(self, angle: Array) -> Array:
        return np.asarray(np.maximum(np.asarray(angle, float) - self.slack, 0.0) ** self.bend)


@dataclass(frozen=True)
class Tabled(Form):
    """Stiffness through five knots of its own, never below zero."""

    knots: tuple[float, ...] = (0.0, 0.1, 0.2, 0.5, 1.0)

    def raw(self, angle: Array) -> Array:
        at = np.linspace(self.slack, self.end, len(self.knots))
        curve = PchipInterpolator(at, self.knots).antiderivative()
        beyond = np.maximum(np.asarray(angle, float) - self.end, 0.0) * self.knots[-1]
        return np.asarray(curve(np.clip(angle, self.slack, self.end)) + beyond)


@dataclass(frozen=True)
class Virgin(Tissue):
    """Tissue is stiffer where it has not been stretched to before (Mullins 1969); else softer."""

    unscored: ClassVar[dict[str, str]] = SHARED | dict.fromkeys(
        ("hysteresis", "dissipated_energy", "relaxed_share"), "it depends on how far it went before"
    )
    more: float = 0.3  # of the torque, at its first time
    width: float = 0.05  # over which it loses that [rad]

    def resist(self, angle: Array, step: float) -> Array:
        farthest = np.maximum.accumulate(angle)
        first = np.exp(-(farthest - angle) / self.width)
        return np.asarray(super().resist(angle, step) * (1 + self.more * first))

    def conditioned(self) -> Tissue:
        return replace(self, more=0.0)


@dataclass(frozen=True)
class Creeping(Departure):
    """The foot creeps in its straps: the angle that is shown wanders off, slower and slower."""

    degrees: float = between(1.5, 4.0, signed=True)  # by the trial's end
    seconds: float = between(8, 30, none=None)

    def measure(self, run: Run) -> None:
        gone = -np.expm1(-run.times / self.seconds)
        run.plate = run.plate + np.radians(self.degrees) * gone / gone[-1]


@dataclass(frozen=True)
class WarmingUp(Departure):
    """The torque sensor warms up: its zero settles exponentially; its gain is a little off."""

    offset: float = between(0.5, 2.5, signed=True)  # at the start [Nm]
    seconds: float = between(5, 40, none=None)
    gain: float = between(0.005, 0.03, signed=True)

    def measure(self, run: Run) -> None:
        run.torque = run.torque * (1 + self.gain) + self.offset * np.exp(-run.times / self.seconds)


@dataclass(frozen=True)
class LettingGo(Departure):
    """It takes the person some time to relax: tone that fades, and comes back for a moment."""

    size: float = between(1.0, 4.0)  # [Nm]
    seconds: float = between(4, 15, none=None)
    shown: float = between(0.3, 1.0, none=None)

    def excite(self, run: Run) -> None:
        at = run.rng.uniform(0.3, 0.9) * run.times[-1]
        again = 0.4 * np.exp(-(((run.times - at) / 1.5) ** 2))
        torque = self.size * (np.exp(-run.times / self.seconds) + again)
        pull_calf(run, torque, self.shown)


def _of(form: type[Form], **how: Any) -> Draws:
    """Draw tissue whose calf's side has another form."""

    def draw_one(rng: np.random.Generator, subject: Subject) -> Departures:
        tissues = tissue(rng, subject)
        low, high = subject.range
        slack = high - float(rng.uniform(0.5, 0.95)) * (high - low)
        bend = float(rng.uniform(1.6, 3.6))
        more = {name: draw_how(rng) for name, draw_how in how.items()}
        return (replace(tissues, form=form("", end=high, bend=bend, slack=slack, **more)),)

    return draw_one


def _knots(rng: np.random.Generator) -> tuple[float, ...]:
    """Draw stiffnesses that rise on the whole, and may fall in between."""
    return tuple(np.cumsum(np.abs(rng.normal(size=5)) ** 2) * np.exp(0.35 * rng.normal(size=5)))


def _sagging(rng: np.random.Generator, subject: Subject) -> Departures:
    low, high = subject.range
    form = Form(
        "sagging",
        end=high,
        bend=float(rng.uniform(0.05, 0.12)),
        slack=low + float(rng.uniform(0.3, 0.6)) * (high - low),
    )
    return (replace(tissue(rng, subject), form=form),)


def _virgin(rng: np.random.Generator, subject: Subject) -> Departures:
    plain = tissue(rng, subject)
    given = {one.name: getattr(plain, one.name) for one in fields(plain)}
    more, width = rng.uniform(0.15, 0.5), rng.uniform(0.02, 0.1)
    return (Virgin(**given, more=float(more), width=float(width)),)


def _with(*kinds: type[Departure]) -> Draws:
    """Draw tissue of any of these forms, and what may be wrong beside it."""
    forms: tuple[Draws, ...] = (_of(Powered), _of(Tabled, knots=_knots), _sagging)

    def draw_some(rng: np.random.Generator, subject: Subject) -> Departures:
        tissues = forms[int(rng.integers(len(forms)))](rng, subject)
        return (*tissues, *drawn(*kinds)(rng, 1.0))

    return draw_some


def _any_two(rng: np.random.Generator, subject: Subject) -> Departures:
    kinds = (
        *(Creeping, WarmingUp, LettingGo, HeelLift, SoftPlate, Play, MovedZero, StretchReflex),
        *(Tone, Tilted, look.Untared, last.Wander),
    )
    chosen = sorted(rng.permutation(len(kinds))[:2].tolist())
    return _with(*(kinds[i] for i in chosen))(rng, subject)


RELAXED: dict[str, Draws] = {
    f"rl-{i}": draws
    for i, draws in enumerate(
        (
            *(_with(Creeping), _of(Powered), _virgin, _with(WarmingUp), _sagging),
            *(_with(LettingGo), _of(Tabled, knots=_knots), _any_two, _with(HeelLift, Play)),
            *(_with(StretchReflex, Tone), _with(SoftPlate, look.Untared), _any_two),
        ),
        start=1,
    )
}
PATHS: dict[str, Way] = {
    f"vl-{i}": way
    for i, way in enumerate(
        (
            Way(ARM_SD, departures=(last.LoadedArm,)),
            Way(ARM_SD, bent=0.25),
            Way(ARM_SD, thesis=True, departures=(last.Skin,)),
            Way(ARM_SD, bent=0.15, departures=(last.Heads,)),
            Way(ARM_SD, bent=0.15, laboratory=False),
            Way(ARM_SD, departures=(last.Ligament, last.Creep)),
        ),
        start=1,
    )
}
