"""A session as a design: which trials, how often, within the minutes that there are.

Information of trials adds up, but for what differs from trial to trial (zero, drift). Trials are
added one by one, each time the one that lowers the cost most for its minutes, and then exchanged
as long as that helps.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.assessment.parameter import percent
from surae.errors import InputError
from surae.filed import filed
from surae.frozen import Comparable, FrozenDict, read_only
from surae.protocol import Device, Trajectory
from surae.protocol.effort import Burst
from surae.protocol.planning.aim import Aim, make_aim
from surae.protocol.planning.expectation import Expectation, expected_of
from surae.protocol.planning.information import Information, information, prior_precision, shared
from surae.protocol.planning.legs import Legs
from surae.protocol.planning.plan import Plan, limits_of
from surae.protocol.planning.ready import ready_protocols
from surae.protocol.planning.search import VAGUE
from surae.protocol.planning.torque import within_torque
from surae.records import to_plain
from surae.threads import one_blas_thread
from surae.units import FloatArray

#: Kinds of trials, in the order in which a session makes them.
KINDS = ("rest", "passive", "active", "maximal")
_REST, _MAXIMAL = 10.0, 20.0
#: A trial has to lower the cost, about the logarithm of an error, by this to be worth its minutes.
_WORTH = 0.005


@filed("trajectory")
@dataclass(frozen=True, slots=True, eq=False)
class PlannedTrial(Comparable):
    """A trial that a session may have."""

    #: `name`, `kind`: what it is called, and one of `KINDS`.
    name: str
    kind: str
    seconds: float  #: Duration [s].
    trajectory: Trajectory  #: Movement and effort.


@filed(worst="worst_after_each", without="worst_without")
@dataclass(frozen=True, slots=True, eq=False)
class SessionPlan(Comparable):
    """Trials of a session, and what they will tell together."""

    trials: tuple[PlannedTrial, ...]  #: In the order in which to make them.
    seconds: float  #: Of trials and pauses [s].
    expectation: Expectation  #: Of all trials together.
    #: The largest relative standard error after each of the trials.
    worst: tuple[float | None, ...]
    #: By kind of trial: the largest error of the best session of that length that has none.
    without: Mapping[str, float | None]
    sentences: tuple[str, ...]  #: All that in words.

    def to_json(self) -> dict[str, Any]:
        """Give all of it as plain data."""
        plain: dict[str, Any] = to_plain(self)
        return plain


def possible_trials(
    device: Device | None,
    range_of_motion: tuple[float, float],
    rate_hz: float,
    legs: Legs,
    *,
    effort: bool,
) -> tuple[PlannedTrial, ...]:
    """The trials that a session is made of: at rest, designed ones, and a maximal one held still.

    The subject's range is in rad; the torque of no leg may exceed the device's. `effort`: whether
    the subject can be asked for any.
    """
    possible, refusals = [], []
    for ready in ready_protocols().values():
        if ready.effort and not effort:
            continue
        try:
            trajectory = ready.trajectory(device, range_of_motion, rate_hz, legs)
        except InputError as refusal:
            refusals.append(refusal)
            continue
        kind = "active" if ready.effort else "passive"
        possible.append(PlannedTrial(ready.name, kind, ready.seconds, trajectory))
    if not possible:
        raise refusals[0]
    limits = limits_of(device, range_of_motion)
    pushes = [Burst(1.0 + 3.0 * k, 2.5, 1.0, k % 2) for k in range(6)] if effort else []
    for name, kind, seconds, bursts in (
        ("rest", "rest", _REST, []),
        ("maximal", "maximal", _MAXIMAL, pushes),
    ):
        if kind == "maximal" and not effort:
            continue
        still = Plan(name, seconds, 0.5, 1.0, (), (), tuple(bursts))
        plan, within, _ = within_torque(still, limits, legs, device)
        trajectory = plan.trajectory(within, rate_hz, device=device)
        possible.append(PlannedTrial(name, kind, seconds, trajectory))
    return tuple(possible)


def plan_session(
    trials: Sequence[PlannedTrial],
    legs: Legs,
    *,
    seconds: float,
    pause: float,
    noise: float,
    aim: str,
    known: FloatArray | None = None,
) -> SessionPlan:
    """The trials that tell most together.

    Each trial may be made as often as there is time for: `seconds`, with a `pause` [s] after each
    but the last. `noise` is the standard deviation of the torque's [Nm], sample by sample; `aim` is
    as of `make_aim`; `known`, shape (p, p), is information that there is before, by default the
    priors of the nuisances.
    """
    known = prior_precision(legs.free, legs) if known is None else known
    with one_blas_thread():
        of_trials = [shared(information(t.trajectory, legs, noise), legs) for t in trials]
        at = [legs.free.index(name) for name in of_trials[0].names]
        matrices = np.array([trial.matrices for trial in of_trials])
        sums = _Sums(
            matrices, known[np.ix_(at, at)], legs.estimated[:, at],
            _part(make_aim(aim, legs), at), [t.seconds + pause for t in trials],
            seconds + pause,
        )  # fmt: skip
        everything = range(len(trials))
        counts = sums.best(everything)
        if not counts.any():
            raise InputError(
                f"{seconds:g} s hold none of the trials; the shortest takes "
                f"{min(t.seconds for t in trials):g} s"
            )

        def whole(numbers: FloatArray) -> Expectation:
            total = np.tensordot(numbers, matrices, 1)
            low = min([t.torque[:, 0].min() for t, n in zip(of_trials, numbers, strict=True) if n])
            high = max([t.torque[:, 1].max() for t, n in zip(of_trials, numbers, strict=True) if n])
            torque = np.tile([low, high], (len(legs.values), 1))
            rate_hz = trials[0].trajectory.settings.rate_hz
            length = sum(n * t.seconds for n, t in zip(numbers, trials, strict=True))
            return expected_of(
                Information(of_trials[0].names, total, read_only(torque)), legs, sums.known,
                protocol="session", seconds=float(length), noise=noise, rate_hz=rate_hz,
            )  # fmt: skip

        order = sorted(everything, key=lambda k: (KINDS.index(trials[k].kind), trials[k].name))
        planned, worst, sofar = [], [], np.zeros(len(trials))
        for k in order:
            for _ in range(int(counts[k])):
                sofar[k] += 1
                planned.append(trials[k])
                worst.append(whole(sofar).worst)
        without: dict[str, float | None] = {}
        for kind in dict.fromkeys(t.kind for t in trials):
            if any(counts[k] for k in everything if trials[k].kind == kind):
                others = sums.best([k for k in everything if trials[k].kind != kind])
                without[kind] = whole(others).worst if others.any() else None
        final = whole(counts)
    length = sum(t.seconds for t in planned) + pause * (len(planned) - 1)
    return SessionPlan(
        tuple(planned), length, final, tuple(worst), FrozenDict(without),
        _sentences(trials, counts, length, final, without),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Sums:
    """Costs of sessions by how often each trial is in them."""

    matrices: FloatArray
    known: FloatArray
    values: FloatArray
    aim: Aim
    seconds: list[float]
    most: float

    def cost(self, counts: FloatArray) -> float:
        scale = np.where(np.abs(self.values) > 0.0, np.abs(self.values), 1.0)
        across = scale[:, :, None] * scale[:, None, :]
        total = np.tensordot(counts, self.matrices, 1) + self.known
        vague = VAGUE**-2.0 * np.eye(scale.shape[1])
        return self.aim.cost(np.linalg.inv(total * across + vague) * across)

    def best(self, allowed: Sequence[int]) -> FloatArray:
        """The counts of the smallest cost within the time, by greed and exchange."""
        counts = np.zeros(len(self.matrices))
        cost = self.cost(counts)
        times = np.array(self.seconds)
        while True:
            moves = [_unit(k, counts) for k in allowed]
            moves += [
                _unit(k, counts) - _unit(j, counts) for k in allowed for j in allowed
                if counts[j] > 0 and j != k
            ]  # fmt: skip
            best, gained = None, _WORTH
            for move in moves:
                if (counts + move) @ times > self.most + 1e-9:
                    continue
                new = self.cost(counts + move)
                # what is added counts by its time; an exchange by itself
                gain = (cost - new) / (move @ times / 60.0 if move.sum() > 0 else 1.0)
                if cost - new > _WORTH and gain > gained:
                    best, gained = move, gain
            if best is None:
                return counts
            counts = counts + best
            cost = self.cost(counts)


def _unit(k: int, like: FloatArray) -> FloatArray:
    unit = np.zeros_like(like)
    unit[k] = 1.0
    return unit


def _part(aim: Aim, at: Sequence[int]) -> Aim:
    """The same of some of what a fit would estimate."""
    return replace(aim, slopes=read_only(aim.slopes[:, :, list(at)]))


def _sentences(
    trials: Sequence[PlannedTrial],
    counts: FloatArray,
    seconds: float,
    final: Expectation,
    without: Mapping[str, float | None],
) -> tuple[str, ...]:
    """The session in words."""
    listed = ", ".join(
        f"{int(n)} × {t.name} ({t.seconds:g} s)"
        for n, t in zip(counts, trials, strict=True) if n > 0
    )  # fmt: skip
    sentences = [
        f"{seconds / 60.0:.1f} minutes: {listed}.",
        f"Largest standard error {_percent(final.worst)} ({final.weakest}), geometric mean "
        f"{_percent(final.geometric_mean)}; identified: {final.identified} of "
        f"{len(final.parameters)}.",
    ]
    for kind, worst in without.items():
        pays = worst is None or final.worst is None or worst > 1.02 * final.worst
        sentences.append(
            f"Without {kind} trials the largest error would be {_percent(worst)}: they are "
            f"{'' if pays else 'hardly '}worth their minutes."
        )
    spared = [k for k in dict.fromkeys(t.kind for t in trials) if k not in without]
    if spared:
        sentences.append(
            f"Not worth their minutes for this: {', '.join(spared)} trials (what they do for the "
            "EMG's zero and scale is not counted)."
        )
    return tuple(sentences)


def _percent(part: float | None) -> str:
    return "unknown" if part is None or part > 1.0 else percent(part)
