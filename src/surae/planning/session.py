"""Which steps of a laboratory, and how many trials, make most of a leg known in so many minutes.

Each trial's information on each leg is computed once; a step of the laboratory narrows the priors
of what it measures. So every set of steps and trials is judged, by how many of the leg's parameters
it makes known, as `expect` judges a protocol, with the same nuisances.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import part
from surae.base.frozen import Comparable, FrozenDict
from surae.base.normal import NORMAL
from surae.base.records import Plain
from surae.base.tables import Tabular, TextTable
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.judging.verdict import IDENTIFIED
from surae.inference.posterior.laplace import DYNAMICS, ORDER
from surae.model.knowledge import GEOMETRY_SD, Knowledge, Plate
from surae.model.knowledge_priors import priors_of
from surae.model.laboratory import laboratory
from surae.model.parameters import CROSSTALK
from surae.model.registry import get_model
from surae.model.statements import StatedArm, StatedAxis
from surae.planning.information import information, shared
from surae.planning.legs import Legs
from surae.planning.search import Aim
from surae.protocol import Trajectory
from surae.recording.described import ALONE, EMPTY

#: Minutes between two trials, and what a step takes beside its trial; what crosstalk is known to
#: from contractions of one muscle at a time.
_BETWEEN = 0.25
_CROSSTALK = 0.02
#: Trials of each kind at most.
_MOST = 4


@filed(what="what")
@dataclass(frozen=True, slots=True)
class SessionStep:
    """A step of a session."""

    name: str  #: As `session.toml` calls it.
    minutes: float  #: How long it takes.
    times: int = 1  #: How often.
    #: Parameters of the fifteen that are expected to be known with it and all steps before it, a
    #: mean over legs, and how many the whole session would lose without it.
    known: float = 0.0
    loses: float = 0.0

    @property
    def what(self) -> Message:
        """What to do, a sentence."""
        return Message(f"step/{self.name.replace(' ', '-')}")


#: Steps beside the trials, and the minutes that each takes.
_STEPS = (
    SessionStep(EMPTY, 0.8),
    SessionStep("axis", 0.75),
    SessionStep("geometry", 2.75),
    SessionStep(ALONE, 1.05),
)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SessionPlan(Tabular, Comparable, Plain):
    """The steps that make most known within so many minutes."""

    legs: str  #: Whose legs.
    minutes: float  #: Of the leg's time, in all.
    steps: tuple[SessionStep, ...]  #: In the order in which each adds most in its time.
    #: By parameter, the part of the legs in which it would be identified.
    parameters: Mapping[str, float]
    #: Relative standard error of what was aimed at by name, root mean square over the legs.
    aimed: Mapping[str, float] = field(default_factory=FrozenDict)

    @property
    def known(self) -> float:
        """How many of the parameters are expected to be identified, a mean over legs."""
        return sum(self.parameters.values())

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each step.
        """
        spent = 0.0
        rows = list[tuple[str, ...]]()
        for s in self.steps:
            spent += s.minutes * s.times
            times = f" ({s.times} times)" if s.times > 1 else ""
            rows.append(
                (s.name + times, s.what, f"{spent:.1f}", f"{s.known:.1f}", f"−{s.loses:.1f}")
            )
        sure = [n for n, share in self.parameters.items() if share > 0.5]
        below = f"identified in most legs: {', '.join(sure) or 'none'}"
        if self.aimed:
            aims = ", ".join(f"{name} {part(error)}" for name, error in self.aimed.items())
            below = f"standard error of what was aimed at: {aims}; {below}"
        return TextTable(
            ("step", "what to do", "minutes so far", "known so far", "without it"),
            tuple(rows),
            above=(f"{self.legs}; of {len(self.parameters)} parameters, each within 10 %",),
            below=(below, "Skipping a step is allowed: the last column is its price."),
        )


def best_session(
    trials: Mapping[str, Trajectory],
    legs: Legs,
    noise: float,
    minutes: float,
    aim: Aim | None = None,
) -> SessionPlan:
    """The best session of these kinds of trials, by name, within `minutes`: for an aim, or all."""
    with one_blas_thread():
        informations = [shared(information(each, legs, noise), legs) for each in trials.values()]
        kinds = [
            SessionStep(name, float(each.time[-1]) / 60.0 + _BETWEEN)
            for name, each in trials.items()
        ]
        judge = _Judge(legs, informations[0].names, [each.matrices for each in informations])
        every = (*_STEPS, *kinds)
        aimed_at = (
            None if aim is None else np.array([legs.free.index(n) for n in informations[0].names])
        )
        best: tuple[float, float, tuple[int, ...]] | None = None
        for counts in product(*[range(2)] * len(_STEPS), *[range(_MOST)] * len(kinds)):
            spent = sum(n * step.minutes for n, step in zip(counts, every, strict=True))
            if spent > minutes or not any(counts[len(_STEPS) :]):
                continue
            worth = float(judge(counts).sum())
            if aim is not None:
                worth = -float(np.log(_errors(judge, counts, aim, aimed_at)).mean())
            rank = (worth, -spent, counts)
            best = rank if best is None or rank > best else best
        if best is None:
            least = min(kind.minutes for kind in kinds)
            raise InputError(f"minutes is {minutes:g}; one trial takes {least:.2g}")
        chosen = best[2]
        ordered = tuple(_ordered(judge, chosen, every))
        shares = FrozenDict(zip(judge.names, judge(chosen).tolist(), strict=True))
        aimed = {}
        if aim is not None:
            errors = np.sqrt(np.mean(_errors(judge, chosen, aim, aimed_at) ** 2, axis=0))
            aimed = dict(zip(aim.wanted, errors.tolist(), strict=True))
    return SessionPlan(legs.name, -best[1], ordered, shares, FrozenDict(aimed))


def _errors(
    judge: "_Judge", counts: tuple[int, ...], aim: Aim, places: FloatArray | None
) -> FloatArray:
    """Relative standard errors of what is aimed at, by leg, shape (n_legs, n_wanted)."""
    return replace(aim, slopes=aim.slopes[:, :, places]).errors(judge.covariance(counts))


def _ordered(
    judge: "_Judge", chosen: tuple[int, ...], every: Sequence[SessionStep]
) -> Iterator[SessionStep]:
    """The steps that are done, each time the one that adds most in its time; trials first."""
    done = [0] * len(chosen)
    left = [j for j, n in enumerate(chosen) if n]
    whole = float(judge(chosen).sum())
    before = 0.0
    while left:
        able = left if any(done[len(_STEPS) :]) else [j for j in left if j >= len(_STEPS)]
        ranked = []
        for j in able:
            tried = [*done]
            tried[j] = chosen[j]
            known = float(judge(tuple(tried)).sum())
            ranked.append(((known - before) / (chosen[j] * every[j].minutes), known, j))
        _, before, j = max(ranked)
        done[j] = chosen[j]
        left.remove(j)
        skipped = tuple(0 if i == j else n for i, n in enumerate(chosen))
        loses = whole - float(judge(skipped).sum())
        step = every[j]
        yield SessionStep(step.name, step.minutes, chosen[j], before, loses)


class _Judge:
    """In what part of the legs each of the fifteen is identified, by how often what is done."""

    def __init__(self, legs: Legs, names: tuple[str, ...], matrices: Sequence[FloatArray]) -> None:
        self.names = tuple(n for n in get_model("muscle").names if n in legs.leg_parameters)
        self._at = [names.index(name) for name in self.names]
        self._matrices = matrices
        self._names = names
        self._legs = legs
        columns = [legs.spec.names.index(name) for name in self.names]
        self._values = np.abs(legs.values[:, columns])
        # what no trial tells: the muscles' own filter is not quite the model's
        self._stays = np.array([ORDER if name in DYNAMICS else 0.0 for name in self.names])
        self._known: dict[tuple[int, ...], FloatArray] = {}

    def __call__(self, counts: tuple[int, ...]) -> FloatArray:
        """Parts of the legs, shape (15,)."""
        if counts not in self._known:
            self._known[counts] = self._judged(counts)
        return self._known[counts]

    def _judged(self, counts: tuple[int, ...]) -> FloatArray:
        if not any(counts[len(_STEPS) :]):
            return np.zeros(len(self.names))
        variance = np.diagonal(self.covariance(counts), axis1=1, axis2=2)
        relative = np.sqrt(np.maximum(variance[:, self._at], 0.0)) / self._values
        return np.asarray(np.mean(NORMAL * np.hypot(relative, self._stays) <= IDENTIFIED, axis=0))

    def covariance(self, counts: tuple[int, ...]) -> FloatArray:
        """Of all that a fit would estimate, by leg, shape (n_legs, p, p)."""
        empty, axis, geometry, alone = counts[: len(_STEPS)]
        trials = counts[len(_STEPS) :]
        tri, tib = (StatedArm(48.0, 1.5), StatedArm(39.3, 1.5)) if geometry else (None, None)
        stated = priors_of(
            Knowledge(
                axis_mm=StatedAxis(0.0, 3.0, 0.0) if axis else None,
                plate=Plate() if empty else None,
                geometry_sd_percent=GEOMETRY_SD if geometry else None,
                arm_tri_mm=tri,
                arm_tib_mm=tib,
                geometry="images" if geometry else "",
            )
        )
        priors = laboratory(stated, measured=bool(geometry))
        sds = {n: priors[n].sd if geometry else b.sd for n, b in self._legs.priors.items()}
        crosstalk = dict.fromkeys(CROSSTALK.values(), (0.0, _CROSSTALK)) if alone else {}
        sds |= {n: sd for n, (_, sd) in {**stated, **crosstalk}.items() if n in sds}
        known = np.diag([sds[n] ** -2.0 if n in sds else 0.0 for n in self._names])
        total = sum(n * each for n, each in zip(trials, self._matrices, strict=True)) + known
        scale = 1.0 / np.sqrt(np.maximum(np.diagonal(total, axis1=1, axis2=2), 1e-300))
        scaled = total * scale[:, :, None] * scale[:, None, :]
        inverse = np.linalg.pinv(scaled, rcond=1e-13, hermitian=True)
        return np.asarray(inverse * scale[:, :, None] * scale[:, None, :])
