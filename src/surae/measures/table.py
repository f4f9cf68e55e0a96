"""What a measure is, and all of them, once: `surae measures` and their page are made of them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from surae.base.docstrings import docstring
from surae.measures import active, invariant, passive
from surae.measures.evoked import evoked_share
from surae.measures.leg import GROUPS, Leg
from surae.recording import MUSCLE_NAMES

#: Names of the groups, and what stands in the docstring of a measure that each of them has.
_WORDS = {
    "tri": {
        "muscles": "calf muscles",
        "short": "calf muscles",
        "have": "have",
        "work": "work",
        "add": "add",
        "begin": "begin",
        "their": "their",
        "tendon": "Achilles tendon",
        "beyond": "above",
        "direction": "plantarflexion",
        "sign": "",
        "direction_end": "dorsiflexion",
        "percentile": "99th",
        "in_all": " in all three of them",
        "weights": "g2 + g3 + g4",
    },
    "tib": {
        "muscles": "tibialis anterior",
        "short": "tibialis",
        "have": "has",
        "work": "works",
        "add": "adds",
        "begin": "begins",
        "their": "its",
        "tendon": "tibialis tendon",
        "beyond": "below",
        "direction": "dorsiflexion",
        "sign": "−",
        "direction_end": "plantarflexion",
        "percentile": "1st",
        "in_all": "",
        "weights": "g1",
    },
    **{name: {"muscle": muscle} for name, muscle in MUSCLE_NAMES.items()},
    "tissue": {"part": "tissue"},
    "neural": {"part": "active contraction"},
    "inertial": {"part": "inertia"},
    "gravitational": {"part": "gravity"},
}


@dataclass(frozen=True, slots=True)
class Definition:
    """One measure."""

    name: str  #: Without the point, which follows an ``@``.
    unit: str  #: Of its value.
    #: The function of a leg, a point (an angle in degrees; 0 where it has none) and, if there is
    #: one, what it is `of`; its docstring has meaning, formula and source.
    compute: Callable[..., float] = field(compare=False)
    #: Unit of the point it is evaluated at: ``"deg"`` for an angle; empty where there is none.
    at: str = ""
    #: Where it is evaluated by default; angles are the user's.
    points: tuple[float, ...] = (0.0,)
    of: str = ""  #: A muscle group, or a part of the torque; empty where it is of the whole leg.
    is_angle: bool = False  #: Whether its value is an angle, of which 10 % mean nothing.
    #: Whether it is made of the recordings and not of the leg alone; it is never negative then.
    of_recordings: bool = False
    #: Of one over the range that was moved, from where to where [deg]; its point is the end of that
    #: range, infinity for the recordings' own. No zero of the angle matters to it.
    span: Callable[[Leg, float], tuple[float, float]] | None = field(default=None, compare=False)
    #: Code of why two sessions cannot be compared by it, or a sentence; empty where they can.
    alone: str = ""
    #: Whether its value is counted from the zero of the angle, without which it is surer.
    from_zero: bool = False

    def value(self, leg: Leg, at: float) -> float:
        """The measure of a leg at a point."""
        return self.compute(leg, at, self.of) if self.of else self.compute(leg, at)

    @property
    def is_at_rest(self) -> bool:
        """Whether trials at rest show it, of the leg or of a muscle group."""
        return self.name.removesuffix(f"_{self.of}") in AT_REST

    @property
    def meaning(self) -> str:
        """What it is, in one sentence."""
        return self._paragraphs()[0]

    @property
    def formula(self) -> str:
        """How it is computed, and after whom."""
        return " ".join(self._paragraphs()[1:])

    def named(self, point: float) -> str:
        """The name with the point it is evaluated at."""
        return f"{self.name}@{point:g}{self.at}" if self.at else self.name

    def _paragraphs(self) -> list[str]:
        text = docstring(self.compute).strip()
        if self.of:
            text = text.format(group=self.of, **_WORDS[self.of])
        return [" ".join(part.split()) for part in text.split("\n\n")]


_RANGE = "alone/range"
_EFFORT = "alone/effort"
_MOVEMENT = "alone/movement"
_FILM = "alone/film"
#: What stands first everywhere, for it needs no zero of the angle.
LEADING = ("end_stiffness", "end_torque")
#: Those of the relaxed leg that its trials at rest show by themselves, whatever a model says.
AT_REST = frozenset(
    (
        *LEADING,
        "torque_rise",
        "passive_torque",
        "passive_stiffness",
        "quick_stiffness",
        "slow_torque",
        "slow_stiffness",
        "neutral_angle",
    )
)
#: Why a measure in units of EMG cannot be compared between sessions.
ELECTRODES = "alone/electrodes"

_D = Definition


def _pair(
    name: str,
    unit: str,
    compute: Callable[[Leg, float, str], float],
    at: str = "",
    points: tuple[tuple[float], tuple[float]] = ((0.0,), (0.0,)),
    **more: Any,
) -> tuple[Definition, Definition]:
    """A measure of each group."""
    tri, tib = (
        _D(f"{name}_{group}", unit, compute, at, point, group, **more)
        for group, point in zip(GROUPS, points, strict=True)
    )
    return tri, tib


def _moved(name: str, unit: str, compute: Callable[[Leg, float], float], span: Any) -> Definition:
    return _D(name, unit, compute, points=(math.inf,), span=span, alone=_RANGE)


def _moved_each(
    name: str, unit: str, compute: Callable[[Leg, float, str], float], span: Any, **more: Any
) -> tuple[Definition, ...]:
    ends = ((math.inf,), (math.inf,))
    return _pair(name, unit, compute, "", ends, span=span, alone=_RANGE, **more)


def _part(name: str, compute: Callable[[Leg, float, str], float], of: str) -> Definition:
    return _D(name, "%", compute, of=of, of_recordings=True, alone=_MOVEMENT)


#: What torque tells of the muscles whatever arms and paths are; first among what a fit tells.
INVARIANT: tuple[Definition, ...] = (
    *_pair("passive_exponent", "1/rad", invariant.passive_exponent),
    *_pair("active_width", "deg", invariant.active_width),
    *_pair("optimal_angle", "deg", active.optimal_angle, is_angle=True, from_zero=True),
    *_pair(
        "tendon_rotational_stiffness",
        "Nm/deg",
        invariant.tendon_rotational_stiffness,
        "Nm",
        ((25.0,), (4.0,)),
    ),
    *(
        _D(f"torque_gain_{muscle}", "Nm/V", invariant.torque_gain, of=muscle, alone=ELECTRODES)
        for muscle in MUSCLE_NAMES
    ),
    *_pair("maximal_torque", "Nm", invariant.maximal_torque, of_recordings=True, alone=_EFFORT),
    *_pair("working_point", "deg", invariant.working_point, is_angle=True, from_zero=True),
)
DEFINITIONS: tuple[Definition, ...] = (
    _moved("end_stiffness", "Nm/deg", passive.end_stiffness, passive.last_degrees),
    _moved("end_torque", "Nm", passive.end_torque, passive.at_end),
    *_moved_each("end_stiffness", "Nm/deg", passive.end_stiffness_of, passive.last_degrees),
    *_moved_each("end_torque", "Nm", passive.end_torque_of, passive.at_end),
    _moved("torque_rise", "Nm", passive.torque_rise, Leg.range_to),
    *_moved_each("slack_before_end", "deg", passive.slack_before_end, Leg.range_to, is_angle=True),
    *_moved_each(
        "optimum_before_end", "deg", active.optimum_before_end, Leg.range_to, is_angle=True
    ),
    *_moved_each("shortest_length", "%", invariant.shortest_length, Leg.range_to),
    *_moved_each("longest_length", "%", invariant.longest_length, Leg.range_to),
    *INVARIANT,
    _D("passive_torque", "Nm", passive.passive_torque, "deg"),
    *_pair("passive_torque", "Nm", passive.passive_torque_of, "deg"),
    _D("passive_stiffness", "Nm/deg", passive.passive_stiffness, "deg"),
    *_pair("passive_stiffness", "Nm/deg", passive.passive_stiffness_of, "deg"),
    _D("joint_stiffness", "Nm/deg", passive.joint_stiffness),
    _D("quick_stiffness", "Nm/deg", passive.quick_stiffness, "deg"),
    _D("slow_torque", "Nm", passive.slow_torque, "deg"),
    _D("slow_stiffness", "Nm/deg", passive.slow_stiffness, "deg"),
    _D("neutral_angle", "deg", passive.neutral_angle, is_angle=True),
    *_pair("slack_angle", "deg", passive.slack_angle, is_angle=True),
    _D(
        "range_at_torque",
        "deg",
        passive.range_at_torque,
        "Nm",
        (5.0, 10.0, 12.0, 15.0),
        is_angle=True,
    ),
    _D("stiffness_at_torque", "Nm/deg", passive.stiffness_at_torque, "Nm", (10.0,)),
    _moved("hysteresis", "%", passive.hysteresis, passive.slow_loop),
    _D("relaxed_share", "%", passive.relaxed_share, "s", (10.0,)),
    _D("dissipated_energy", "mJ", passive.dissipated_energy),
    *_pair(
        "active_torque_max",
        "Nm",
        active.active_torque_max,
        "deg",
        of_recordings=True,
        alone=_EFFORT,
    ),
    *_pair("torque_per_emg", "Nm/mV", active.torque_per_emg, alone=ELECTRODES),
    _D("active_stiffness", "Nm/deg", active.active_stiffness, "Nm", (20.0,)),
    _D("damping", "Nm·s/deg", active.damping, "Nm", (20.0,)),
    _D("activation_half_time", "ms", active.activation_half_time),
    _D("bandwidth", "Hz", active.bandwidth),
    _D("delay", "ms", active.delay),
    _D("reflex_gain", "Nm·s/deg", active.reflex_gain),
    _D("reflex_share", "%", active.reflex_share, of_recordings=True, alone=_MOVEMENT),
    _part("tissue_share", active.torque_share, "tissue"),
    _part("neural_share", active.torque_share, "neural"),
    _part("inertia_share", active.torque_share, "inertial"),
    _part("gravity_share", active.torque_share, "gravitational"),
    _part("tissue_work_share", active.work_share, "tissue"),
    _part("neural_work_share", active.work_share, "neural"),
    *_pair("tendon_stiffness", "N/mm", passive.tendon_stiffness, "N", ((500.0,), (100.0,))),
    *_pair("tendon_secant", "N/mm", passive.tendon_secant, of_recordings=True, alone=_EFFORT),
    _D("optimal_fascicle_tib", "mm", passive.optimal_fascicle_tib, of_recordings=True, alone=_FILM),
    *_pair("tendon_strain", "%", passive.tendon_strain, "N", ((500.0,), (100.0,))),
    _D(
        "evoked_share",
        "%",
        evoked_share,
        of_recordings=True,
        alone="it goes with the movement and effort of each session",
    ),
)
