"""The EMG tasks (thesis 2.5.1, Figure 9): the requested effort of each muscle.

Bursts of about one second alternate between plantarflexion (the three heads of the triceps surae)
and dorsiflexion (tibialis anterior). Their lengths, gaps and amplitudes follow a fixed
low-discrepancy sequence, so the same task is always the same. The heads act together, as they do in
a leg, but in proportions and at onsets that differ from burst to burst: were they proportional, the
weights g2, g3 and g4 could not be separated.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import named
from surae.base.units import FloatArray
from surae.base.words import N_
from surae.protocol.profiles import smooth_step
from surae.recording import MUSCLES


@dataclass(frozen=True, slots=True)
class Task:
    """An EMG task."""

    name: str  #: Name in settings and files.
    passive_until: float  #: The subject is relaxed until then [s].
    description: str  #: One sentence.
    #: The muscles of each burst in turn, those of one direction together; none: `DIRECTIONS`.
    turns: tuple[tuple[str, ...], ...] = ()
    #: Time in which an effort rises, and falls [s]; by default half of its length.
    rise: float | None = None

    def with_own(self, passive_seconds: float | None, turns: tuple[str, ...]) -> "Task":
        """The task with a passive part and an order of muscles of one's own, if given.

        Raises
        ------
        InputError
            The task has no passive part, or no bursts; a turn is not muscles of one direction.
        """
        relaxed = self.passive_until if passive_seconds is None else passive_seconds
        if passive_seconds is not None and not 0.0 < self.passive_until < np.inf:
            raise InputError(
                f"passive seconds {passive_seconds:g}: task {self.name!r} does not begin relaxed; "
                "use task 'part-passive'"
            )
        if not relaxed >= 0.0:
            raise InputError(f"passive seconds {relaxed:g}: use 0 or more")
        if turns and self.passive_until == np.inf:
            raise InputError(f"turns: task {self.name!r} has no bursts; leave them out")
        description = self.description
        if passive_seconds is not None:
            description = f"Relaxed to {relaxed:g} s, then alternating bursts."
        if turns:
            description = f"{description} In turn: {', '.join(turns)}."
        return replace(
            self, passive_until=relaxed, description=description, turns=tuple(map(_turn, turns))
        )


def _turn(text: str) -> tuple[str, ...]:
    """The muscles of a burst from their names, as ``gl+sol``."""
    names = tuple(name.strip() for name in text.split("+"))
    if not any(set(names) <= set(muscles) for muscles in DIRECTIONS):
        raise InputError(
            f"turn {text!r}: name muscles that pull together: ta, or of gl, sol and gm one or "
            "several joined by +"
        )
    return names


#: A step of effort is held for so long, after and before a change [s].
_HELD = 2.0
_STEP_RISE = 0.3
#: A PRBS may change every so many seconds, as fast as a person follows a display, within such a
#: time, between rest and such a level.
_CLOCK = 0.5
_CLOCK_RISE = 0.2
_ON = 0.5

TASKS: dict[str, Task] = {
    task.name: task
    for task in (
        Task("part-passive", 11.0, N_("Relaxed to 11 s, then alternating bursts.")),
        Task("active", 0.0, N_("Alternating bursts throughout.")),
        Task("passive", np.inf, N_("Relaxed throughout.")),
        Task(
            "steps",
            0.0,
            N_("Steps of effort, held for 2 s, one direction after the other."),
            rise=_STEP_RISE,
        ),
        Task(
            "prbs",
            0.0,
            N_("Efforts of one level, on and off at random (a PRBS)."),
            rise=_CLOCK_RISE,
        ),
    )
}

#: Muscles of each direction: the first burst is plantarflexion.
DIRECTIONS = (("gl", "sol", "gm"), ("ta",))

#: Time from one burst to the next, by which the onset of a head may be late [s].
GAP = 0.15

#: Root of x⁶ = x + 1: base of the additive recurrence in five dimensions (Roberts 2018): level and
#: length of the burst, and what is each head's own.
_ROOT = 1.134724138401519


def _sequence(k: int, dimension: int) -> float:
    """Element k of a low-discrepancy sequence in [0, 1)."""
    return (0.5 + (k + 1) * _ROOT ** -(dimension + 1)) % 1.0


class Burst(NamedTuple):
    """An effort that rises and falls again."""

    #: `onset`, `length`: when it begins, and how long it lasts [s]; a head may be late by up to
    #: `GAP`.
    onset: float
    length: float
    level: float  #: Part of the largest effort, 0…1.
    direction: int  #: Of `DIRECTIONS`: 0 plantarflexion, 1 dorsiflexion.


def _steps(end: float) -> Iterator[Burst]:
    k = 0
    onset = 0.5
    length = _HELD + 2.0 * _STEP_RISE
    while onset + length + GAP <= end:
        yield Burst(onset, length, 0.2 + 0.6 * _sequence(k, 0), k % 2)
        onset += length + GAP
        k += 1


def _prbs(end: float) -> Iterator[Burst]:
    """A maximum-length sequence of 127 (x⁷ + x⁶ + 1): each run of ones is an effort."""
    k = 0
    onset = 0.5
    register = 0b1010011
    while True:
        run = 0
        while run == 0 or register & 1:
            run += register & 1
            register = register >> 1 | ((register ^ register >> 1) & 1) << 6
            onset += _CLOCK
        if onset + _CLOCK_RISE + GAP > end:
            return
        start = onset - (run + 1) * _CLOCK
        yield Burst(start, run * _CLOCK + _CLOCK_RISE, _ON, k % 2)
        k += 1


def task_bursts(task: "Task", end: float) -> Iterator[Burst]:
    """Every burst of a task that is over by `end` [s]."""
    turns = task.turns or DIRECTIONS
    towards = [int(turn[0] in DIRECTIONS[1]) for turn in turns]
    if task.name in ("steps", "prbs"):
        for k, burst in enumerate((_steps if task.name == "steps" else _prbs)(end)):
            yield burst._replace(direction=towards[k % len(turns)])
        return
    k = 0
    onset = task.passive_until
    while onset + (length := 0.9 + 0.3 * _sequence(k, 1)) + GAP <= end:
        # Hard and easy efforts mix in either direction: 0.4 to 1 of the largest.
        yield Burst(onset, length, 0.4 + 0.6 * _sequence(k, 0), towards[k % len(turns)])
        onset += length + GAP
        k += 1


def head_share(k: int, head: int) -> tuple[float, float]:
    """Part of a burst's level that a head gives in burst k, and of `GAP` by which it is late."""
    share = _sequence(k, head + 2)
    return 0.6 + 0.4 * share, share


def effort(t: FloatArray, task: Task) -> FloatArray:
    """Effort of TA, GL, SOL, GM, shape (n, 4), as a part of the largest; 0 while passive."""
    return burst_effort(t, task_bursts(task, float(t[-1])), task.turns, task.rise)


def burst_effort(
    t: FloatArray,
    bursts: Iterable[Burst],
    turns: Sequence[tuple[str, ...]] = (),
    rise: float | None = None,
) -> FloatArray:
    """The effort, as of `effort`, of numbered bursts that do not overlap in a direction.

    With `turns` burst k is of the muscles of turn k, over and over; else of all of its direction.
    `rise` is the time in which each rises, and falls [s]; None: half of its length.
    """
    target = np.zeros((len(t), len(MUSCLES)))
    for k, burst in enumerate(bursts):
        for i, muscle in enumerate(DIRECTIONS[burst.direction]):
            if turns and muscle not in turns[k % len(turns)]:
                continue
            share, late = head_share(k, i)
            onset = burst.onset + GAP * late
            # Beyond its own span a burst is exactly 0.
            first, last = np.searchsorted(t, (onset, onset + burst.length))
            since = t[first:last] - onset
            inside = np.minimum(since, burst.length - since)
            bump = smooth_step(inside / (rise or 0.5 * burst.length))
            target[first:last, MUSCLES.index(muscle)] += burst.level * share * bump
    return target


def named_task(name: str) -> Task:
    """The task of that name."""
    return named("task", TASKS, name)
