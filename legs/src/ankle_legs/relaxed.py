"""Relaxed legs: families whose tissue, or whose handling, departs from every simple curve.

A leg has visits of three trials each: passive ramps, efforts with rests between, holds. Trials 1
to 3 are its first visit; for trials 4 to 6 it is placed anew and has not changed; for trials 7 to 9
it is placed anew and one thing of it has changed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ankle_legs import look
from ankle_legs.curve import Ankle, own_measures, shown_measures
from ankle_legs.handling import (
    Between,
    HeelLift,
    MovedZero,
    Play,
    Setup,
    SoftPlate,
    StretchReflex,
    Tilted,
    Tone,
)
from ankle_legs.leg import Departure, Leg, Mounting, Run, drawn
from ankle_legs.movement import FINE
from ankle_legs.muscle import Array
from ankle_legs.subject import Subject, draw
from ankle_legs.tissue import Form, Tissue, Yielding

VISIT = 3  # trials
KINDS = ("ramps", "bouts", "ladder")
FAST = ("stretches", "bouts", "ladder")  # where what is fast is what matters
SECONDS = {"ramps": (35, 60), "bouts": (45, 80), "ladder": (40, 60), "stretches": (45, 60)}
#: What changes in a leg between its first visit and that of trials 7 to 9: how, in words.
CHANGES = {
    "softer": "all passive torque is 30 % less",
    "stiffer": "all passive torque is 30 % more",
    "longer": "the passive curve begins 4 degrees later",
    "shorter": "the passive curve begins 4 degrees sooner",
    "weaker": "the calf makes 30 % less force for its EMG",
    "relaxing": "twice as much of the tissue's torque relaxes",
    "late": "the torque follows the EMG 30 ms later",
}
MOST = 25.0  # relaxed torque at which a robot turns back [Nm]
SLACKER = float(np.radians(4.0))


@dataclass(frozen=True)
class RelaxedLeg(Leg):
    """A leg whose relaxed curve is asked for."""

    kinds: tuple[str, ...] = KINDS
    change: str = "softer"
    trial: int = 0  # that it is placed for; 0: it is not
    done: dict[tuple[Any, ...], Run] = field(default_factory=dict, compare=False, repr=False)

    def usual(self, trial: int) -> tuple[str, float]:
        """Return a trial's kind and seconds, if nobody asks for others."""
        kind = self.kinds[(trial - 1) % VISIT]
        low, high = SECONDS[kind]
        return kind, float(np.round(self.rng(31, trial).uniform(low, high)))

    def condition(self, trial: int) -> tuple[Subject, Mounting]:
        """Return whose leg, and how mounted, a trial has."""
        visit = (trial - 1) // VISIT
        mounting = self.mounting(visit)
        if self.changed(trial) and self.change == "late":
            mounting = replace(mounting, delay=mounting.delay + 0.030)
        return self._turned_back(trial), mounting

    def _turned_back(self, trial: int) -> Subject:
        """Return the muscles of a trial, with a range in which the robot does not feel too much."""
        subject = self.treated() if self.changed(trial) else self.subject
        one = self if self.trial else self.placed(trial)
        low, high = subject.range
        angles = np.linspace(low, high, 60)
        ankle = angles - sum(d.zero() for d in one.departures)
        far = one.lasting(subject).passive_torque(ankle) + one.rest(ankle) > MOST
        if far.any():
            high = float(angles[np.argmax(far)])
        return replace(subject, range=(low, high))

    def changed(self, trial: int) -> bool:
        """Return whether the leg has changed by then."""
        return trial > 2 * VISIT

    def treated(self) -> Subject:
        """Return the leg's muscles after the change."""
        v, subject = self.subject.values, self.subject
        if self.change in ("softer", "stiffer"):
            share = float(np.log(0.7 if self.change == "softer" else 1.3))
            return subject.with_values(
                x0_tri=v["x0_tri"] - share / v["k_tri"], x0_tib=v["x0_tib"] - share / v["k_tib"]
            )
        if self.change == "weaker":
            return subject.with_values(**{g: 0.7 * v[g] for g in ("g2", "g3", "g4")})
        if self.change == "relaxing":  # the relaxed force stays
            k_rel = 2 * v["k_rel"]
            more = float(np.log((1 + k_rel) / (1 + v["k_rel"])))
            return subject.with_values(
                k_rel=k_rel,
                x0_tri=v["x0_tri"] - more / v["k_tri"],
                x0_tib=v["x0_tib"] - more / v["k_tib"],
            )
        if self.change in ("longer", "shorter"):
            turn = SLACKER if self.change == "longer" else -SLACKER
            slopes = subject.geometry.paths[:, 1]
            return subject.with_values(
                x0_tri=v["x0_tri"] + turn * float(slopes[0]),
                x0_tib=v["x0_tib"] + turn * float(slopes[1]),
            )
        return subject

    def _treated_tissue(self, tissue: Tissue) -> Tissue:
        scale = {"softer": 0.7, "stiffer": 1.3}.get(self.change, 1.0)
        shift = {"longer": SLACKER, "shorter": -SLACKER}.get(self.change, 0.0)
        more = 2.0 if self.change == "relaxing" else 1.0
        return replace(
            tissue,
            size=scale * tissue.size,
            other_size=scale * tissue.other_size,
            shift=tissue.shift + shift,
            shares=more * tissue.shares,
        )

    def setup(self, visit: int) -> Setup:
        """Draw how the leg is placed for a visit."""
        rng = self.rng(32, visit)
        return Setup(
            turned=float(np.radians(np.clip(rng.normal(0, 1.5), -4, 4))),
            tilt=float(np.radians(np.clip(rng.normal(0, 2.0), -5, 5))),
            foot=float(np.clip(rng.normal(0, 0.08), -0.2, 0.2)),
            drift=float(np.clip(rng.normal(0, 0.4), -1.2, 1.2)),
            wander=float(rng.uniform(0.03, 0.2)),
            friction=float(rng.uniform(0.05, 0.4)),
            reach=float(rng.uniform(0.004, 0.02)),
        )

    def placed(self, trial: int) -> RelaxedLeg:
        """Return the leg as it is in a trial: changed or not, and placed."""
        departures = self.departures
        if self.changed(trial):
            departures = tuple(
                self._treated_tissue(d) if isinstance(d, Tissue) else d for d in departures
            )
        setup = self.setup((trial - 1) // VISIT)
        return replace(self, departures=(setup, *departures), trial=trial, done={})

    def record(
        self,
        trial: int,
        seconds: float | None = None,
        kind: str | None = None,
        *,
        movement: int | None = None,
        mounting: Mounting | None = None,
    ) -> Run:
        """Return a trial, simulated, of the kind and length that is usual for it or asked for."""
        usual = self.usual(trial)
        return Leg.record(
            self.placed(trial),
            trial,
            usual[1] if seconds is None else seconds,
            kind or usual[0],
            movement=movement,
            mounting=mounting,
        )

    def truth(
        self,
        subject: Subject,
        mounting: Mounting,
        trial: int,
        kinds: Sequence[str] = (),
        seconds: float | None = None,
        moves: Sequence[tuple[int, float]] = (),
    ) -> dict[str, Any]:
        """Return parameters and measures of a visit, at the ankle's and at the device's angles."""
        kinds = kinds or (self.usual(trial)[0],)
        each = [self.usual(trial + i)[1] if seconds is None else seconds for i in range(len(kinds))]
        moves = moves or [(trial + i, one) for i, one in enumerate(each)]
        placed = self.placed(trial)
        truth = Leg.truth(placed, subject, mounting, trial, kinds, moves=moves)
        untrue = {name for d in self.departures for name in d.unscored}
        runs = placed.runs(kinds, moves)
        ankle = placed.ankle()
        of_ankle = own_measures(ankle, _ends([run.ankle for run in runs]))
        shown = shown_measures(ankle, _ends([run.plate for run in runs]))
        for measures in (of_ankle, shown):
            for name in [n for n in measures if n.startswith(tuple(untrue))]:
                measures[name] = None
        truth["measures"] |= of_ankle  # found by doing, whatever single parameters mean
        setup = placed.departures[0]
        return truth | {
            "device": shown,
            "zero_deg": float(np.degrees(setup.zero())),
            "change": self.change if self.changed(trial) else None,
        }

    def measures(
        self,
        subject: Subject,
        mounting: Mounting,
        kinds: Sequence[str],
        moves: Sequence[tuple[int, float]],
    ) -> dict[str, float | None]:
        """Return the muscles' measures of a leg that is placed."""
        runs = self.runs(kinds, moves)
        states = np.concatenate([run.active[:, ::FINE] for run in runs], axis=1)
        active = np.percentile(states, 99, axis=1)
        ends = _ends([run.ankle for run in runs])
        return self.read(subject, mounting, ends, (float(active[0]), float(active[1])))

    def runs(self, kinds: Sequence[str], moves: Sequence[tuple[int, float]]) -> list[Run]:
        """Return the trials of a visit of a leg that is placed."""
        for (number, seconds), kind in zip(moves, kinds, strict=True):
            if (number, seconds, kind) not in self.done:
                run = Leg.record(self, self.trial, seconds, kind, movement=number)
                self.done[number, seconds, kind] = run
        keys = zip(moves, kinds, strict=True)
        return [self.done[number, seconds, kind] for (number, seconds), kind in keys]

    def ankle(self) -> Ankle:
        """Return what the relaxed leg is, from device to bone."""
        return Ankle(
            self.lasting(self.condition(self.trial)[0]),
            tuple(d.conditioned() for d in self.departures if isinstance(d, Tissue)),
            tuple(d for d in self.departures if isinstance(d, Between)),
            sum(d.zero() for d in self.departures),
        )


def _ends(angles: list[Array]) -> tuple[float, float]:
    """Return the first and the 99th percentile of angles at 128 Hz."""
    low, high = np.percentile(np.concatenate([angle[::FINE] for angle in angles]), [1, 99])
    return float(low), float(high)


Draws = Callable[[np.random.Generator, Subject], tuple[Departure, ...]]


def _spectrum(rng: np.random.Generator) -> dict[str, Any]:
    """Draw how tissue relaxes: two to four times, a tenth to a half in all."""
    n = int(rng.integers(2, 5))
    seconds = np.exp(rng.uniform(np.log(0.15), np.log(12.0), n))
    shares = rng.uniform(0.1, 0.5) * rng.dirichlet(np.full(n, 2.0))
    return {"seconds": seconds, "shares": shares}


def tissue(
    rng: np.random.Generator,
    subject: Subject,
    kind: str = "exponential",
    more: Mapping[str, Any] | None = None,
) -> Tissue:
    """Draw a tissue of a form, whose size is what people of the population have.

    ``more`` are fields of the tissue that are given, not drawn.
    """
    low, high = subject.range
    patient = subject.population == "patient"
    size = float(np.clip(np.exp(rng.normal(np.log(14 if patient else 10), 0.35)), 4, 22))
    span = high - low
    forms = {
        "exponential": {"bend": rng.uniform(0.12, 0.4)},
        "toe": {"slack": high - rng.uniform(0.3, 0.6) * span, "bend": rng.uniform(0.015, 0.06)},
        "linear-quadratic": {
            "slack": high - rng.uniform(0.45, 0.85) * span,
            "bend": rng.uniform(0.1, 0.35),
        },
        "capsule": {
            "slack": high - rng.uniform(0.08, 0.2),
            "bend": rng.uniform(0.2, 0.5),
            "stop": rng.uniform(0.03, 0.08),
            "share": rng.uniform(0.35, 0.65),
        },
    }
    calf = Form(kind, end=high, **{name: float(v) for name, v in forms[kind].items()})
    front = Form("exponential", end=-low, bend=float(rng.uniform(0.1, 0.3)))
    given = {"muscle": float(rng.uniform(0.0, 0.25))} | _spectrum(rng) | dict(more or {})
    sort = Yielding if "softens" in given else Tissue
    return sort(calf, size, front, float(rng.uniform(0.5, 3.0)), **given)


def _form(kind: str) -> Draws:
    return lambda rng, subject: (tissue(rng, subject, kind),)


def _rated(rng: np.random.Generator, subject: Subject) -> tuple[Departure, ...]:
    """Draw tissue that relaxes over all times alike, as a power law does, and drags."""
    seconds = np.geomspace(0.03, 120.0, 12)
    shares = np.full(12, rng.uniform(0.3, 0.9) / 12) * (seconds / 2.0) ** -rng.uniform(0.0, 0.12)
    more = {
        "seconds": seconds,
        "shares": shares,
        "drag": float(rng.uniform(0.05, 0.3)),
        "power": float(rng.uniform(0.2, 0.6)),
        "constant": float(rng.uniform(0.0, 0.8)),
    }
    return (tissue(rng, subject, more=more),)


def _yielding(rng: np.random.Generator, subject: Subject) -> tuple[Departure, ...]:
    """Draw tissue that softens over repeated stretches, and holds after rest."""
    more = {
        "softens": rng.uniform(0.15, 0.35),
        "travel": rng.uniform(1.5, 5.0),
        "grip": rng.uniform(0.3, 2.0),
        "reach": rng.uniform(0.01, 0.03),
        "rebuild": rng.uniform(2.0, 8.0),
    }
    return (tissue(rng, subject, more={name: float(value) for name, value in more.items()}),)


def _plain(rng: np.random.Generator, subject: Subject) -> tuple[Departure, ...]:
    """Draw tissue that is not what the family is about: one of two smooth forms."""
    return (tissue(rng, subject, "exponential" if rng.random() < 0.6 else "linear-quadratic"),)


def _handled(*kinds: type[Departure]) -> Draws:
    return lambda rng, subject: (*_plain(rng, subject), *drawn(*kinds)(rng, 1.0))


def _two(rng: np.random.Generator, subject: Subject) -> tuple[Departure, ...]:
    """Draw tissue of one of these families and two of what may be wrong beside it, weaker."""
    forms: tuple[Draws, ...] = (_form("toe"), _form("linear-quadratic"), _form("capsule"), _rated)
    kinds = (HeelLift, Play, MovedZero, StretchReflex, Tone, Tilted, SoftPlate)
    chosen = sorted(rng.permutation(len(kinds))[:2].tolist())
    tissues = forms[int(rng.integers(len(forms)))](rng, subject)
    calm = (d.undragged() if isinstance(d, Tissue) else d for d in tissues)  # or nothing settles
    return (*calm, *(d for i in chosen for d in drawn(kinds[i])(rng, 0.6)))


FAMILIES: dict[str, Draws] = {
    "ra": _form("exponential"),
    "rb": _form("toe"),
    "rc": _form("linear-quadratic"),
    "rd": _form("capsule"),
    "re": _rated,
    "rf": _yielding,
    "rg": _handled(Play),
    "rh": _handled(HeelLift),
    "ri": _handled(MovedZero),
    "rj": _handled(StretchReflex),
    "rk": _handled(Tone),
    "rm": _handled(Tilted),
    "rn": _handled(look.Untared),
    "ro": _handled(SoftPlate),
    "rp": _two,
}
STRETCHED = ("re", "rj", "rp")


def leg(family: str, seed: int, draws: Draws, kinds: tuple[str, ...], rng: Any) -> RelaxedLeg:
    """Return a relaxed leg; seeds that follow each other change in one thing after another."""
    population = "patient" if rng.random() < 1 / 3 else "healthy"
    subject = draw(rng, population)
    change = tuple(CHANGES)[seed % len(CHANGES)]
    departures = draws(rng, subject)
    return RelaxedLeg(family, seed, subject, departures, kinds=kinds, change=change)
