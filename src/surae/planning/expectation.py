"""What a protocol will tell, before anybody is measured: standard errors and verdicts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from surae.base.file_form import filed
from surae.base.formatting import part
from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.normal import NORMAL
from surae.base.packed import finite
from surae.base.records import Plain
from surae.base.tables import Tabular, TextTable
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.judging.parameter import judge_interval, judge_singular
from surae.inference.judging.verdict import IDENTIFIED, Verdict
from surae.inference.uncertainty.arms_and_paths import assumed_sd
from surae.inference.uncertainty.covariance import Covariance, half_width
from surae.model import adapted
from surae.model.joint import ANKLE
from surae.model.source_table import SOURCES, source_of
from surae.planning.at_rest import ExpectedAtRest
from surae.planning.information import estimated, information, prior_precision
from surae.planning.legs import Legs
from surae.planning.torque import Load, load_of
from surae.protocol import Trajectory

#: Standard deviation of the torque's noise [Nm], white, sample by sample: that of a good sensor.
NOISE = 0.5
#: Legs that an expectation is an average over.
LEGS = 20


@filed("name", "meaning", half_width="relative_half_width")
@dataclass(frozen=True, slots=True)
class Expected:
    """What is expected of one parameter over all legs."""

    #: `name`, `unit`, `meaning`: as of the parameter.
    name: str
    unit: str
    meaning: str
    value: float  #: Middle of the legs' values.
    #: Standard error as a part of the value, root mean square over the legs; None where some leg
    #: has none.
    relative_sem: float | None
    half_width: float | None  #: Half of the 95 % interval as a part of the value, likewise.
    verdict: Verdict  #: Of that interval, by the rule of a fit.
    note: Message  #: Why, in a sentence.
    identified_share: float  #: Part of the legs in which it would be identified.
    #: Parts of the variance by source; they add up to 1. Empty where there is none.
    budget: Mapping[str, float] = field(default_factory=FrozenDict)
    #: Half of the 95 % interval that the fit has without this trial, as a part of the value; None
    #: without a fit.
    now: float | None = None


@dataclass(frozen=True, slots=True)
class ExpectedMeasure:
    """What is expected of one measure of the relaxed ankle, as parts of its value."""

    #: Standard error, root mean square over the legs; None where some leg has none.
    relative_sem: float | None
    #: Change that two such visits would show in four of five cases, the foot mounted anew.
    would_show: float | None


@filed(
    "relative",
    "correlation",
    "of_fit",
    noise="noise_Nm",
    torque="torque_Nm",
    worst="worst",
    weakest="weakest",
    geometric_mean="geometric_mean",
)
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Expectation(Tabular, Comparable, Plain):
    """What a protocol will tell of legs."""

    #: `protocol`, `model`, `legs`: the protocol, the model, and whose legs.
    protocol: str
    model: str
    legs: Message
    seconds: float  #: Duration of the trial [s].
    #: Standard deviation of the torque's noise [Nm], white, sample by sample at `rate_hz`.
    noise: float
    rate_hz: float  #: Sampling rate [Hz].
    parameters: Mapping[str, Expected]  #: The leg's parameters that would be estimated.
    nuisances: tuple[str, ...]  #: What of the laboratory would be estimated along.
    #: Relative standard error of each parameter of each leg; infinite where there is none, shape
    #: (n_legs, n_parameters).
    relative: FloatArray
    #: Of the leg in the middle of the others: names and correlation.
    correlation: Covariance | None
    #: Least and greatest torque of the legs that this is expected of [Nm]; `load` has what the
    #: device must bear.
    torque: tuple[float, float]
    load: Load | None  #: What the protocol asks of a device; None of another joint than the ankle.
    of_fit: bool = False  #: Whether the legs are what one fit leaves possible.
    #: What its rest will tell, by measure; empty where that is nothing, or was not asked.
    at_rest: Mapping[str, ExpectedAtRest] = field(default_factory=FrozenDict)
    #: Of measures by name; empty where the model has none of them.
    measures: Mapping[str, ExpectedMeasure] = field(default_factory=FrozenDict)

    @property
    def asks(self) -> str:
        """What the protocol asks of a device, and of a fitted leg, in words."""
        low, high = self.torque
        of_leg = Message("plan/torque", low=low, high=high, legs=self.legs)
        return of_leg if self.load is None else self.load.text + f"; {of_leg}" * self.of_fit

    @property
    def caution(self) -> Message | None:
        """What this leaves out, a sentence; None where real legs' departures are counted."""
        return None if self.nuisances else Message("plan/caution")

    @property
    def worst(self) -> float | None:
        """The largest relative standard error; None where a parameter has none."""
        sems = [p.relative_sem for p in self.parameters.values()]
        return None if None in sems else max(sem for sem in sems if sem is not None)

    @property
    def weakest(self) -> str:
        """The parameter that `worst` is of."""
        sems = {
            p.name: np.inf if p.relative_sem is None else p.relative_sem
            for p in self.parameters.values()
        }
        return max(sems, key=lambda name: sems[name])

    @property
    def geometric_mean(self) -> float | None:
        """Geometric mean of the relative standard errors; None where a parameter has none."""
        sems = [p.relative_sem for p in self.parameters.values()]
        return None if None in sems else float(np.exp(np.mean(np.log(np.array(sems, float)))))

    @property
    def identified(self) -> int:
        """How many parameters are expected to be identified."""
        return sum(p.verdict is Verdict.IDENTIFIED for p in self.parameters.values())

    def to_dataframe(self) -> Any:
        """What is expected of each parameter as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row each by name: value, relative standard error and half-width, verdict, and the
            shares of the variance by source.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        from surae.recording.frames import records_frame

        return records_frame(self.parameters, "parameter")

    @property
    def rest_told(self) -> Message:
        """What its rest will tell of the relaxed leg, a sentence."""
        sentences = [
            f"{name} ±{100 * each.half_width:.0f} %"
            + (
                ""
                if each.half_width_device is None
                else f" (±{100 * each.half_width_device:.0f} %)"
            )
            for name, each in self.at_rest.items()
        ]
        return Message("plan/at-rest", measures=", ".join(sentences))

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each parameter, and what holds of all.
        """
        of_fit = any(p.now is not None for p in self.parameters.values())
        rows = tuple(
            (
                p.name,
                *([part(p.now)] * of_fit),
                part(p.relative_sem),
                part(p.half_width),
                f"{100 * p.identified_share:.0f} %",
                SOURCES[max(p.budget, key=lambda name: p.budget[name])].label if p.budget else "—",
                str(p.verdict),
            )
            for p in self.parameters.values()
        )
        return TextTable(
            (
                "parameter",
                *(["the fit has"] * of_fit),
                "standard error",
                "95 % within",
                "identified in",
                "most of it",
                "verdict",
            ),
            rows,
            above=(
                f"{self.protocol}: {self.seconds:g} s, {self.legs}, {self.model}, noise "
                f"{self.noise:.2g} Nm at {self.rate_hz:g} Hz",
            ),
            below=(
                f"largest standard error: {part(self.worst)} ({self.weakest}); geometric mean: "
                f"{part(self.geometric_mean)}; identified: {self.identified} of {len(rows)}",
                *([self.rest_told] if self.at_rest else []),
                *(
                    f"{name}: standard error {part(m.relative_sem)}; two such visits would show a "
                    f"change of {part(m.would_show)}"
                    for name, m in self.measures.items()
                ),
                *filter(None, [self.caution]),
                self.asks,
            ),
        )


def expected(
    trajectory: Trajectory,
    legs: Legs,
    noise: float = NOISE,
    *,
    known: FloatArray | None = None,
    now: Mapping[str, float] = FrozenDict(),
    stays: Mapping[str, float] = FrozenDict(),
) -> Expectation:
    """What a trial tells of each leg; `known`, shape (p, p), is there before: by default priors.

    `now` are half widths that a fit has, `stays` what of them no trial lowers (`fit_precision`).
    """
    with one_blas_thread():
        trial = information(trajectory, legs, noise)
        known = prior_precision(trial.names, legs) if known is None else known
        covariances = [estimated(trial.names, matrix + known) for matrix in trial.matrices]
    names = legs.leg_parameters
    table = adapted(legs.spec.parameters, legs.options, legs.emg_unit)
    columns = [legs.spec.names.index(name) for name in names]
    relative = np.full((len(legs.values), len(names)), np.inf)
    shares: list[dict[str, dict[str, float]]] = []
    for k, estimate in enumerate(covariances):
        if estimate is None:
            continue
        for j, (name, column) in enumerate(zip(names, columns, strict=True)):
            value = abs(float(legs.values[k, column]))
            if name in estimate.names and value > 0.0:
                i = estimate.names.index(name)
                sem = np.hypot(estimate.matrix[i, i] ** 0.5 / value, stays.get(name, 0.0) / NORMAL)
                relative[k, j] = min(float(sem), now.get(name, np.inf) / NORMAL)
        shares.append(_shares(estimate, names))
    # the leg whose largest error is the median one
    order = np.argsort(relative.max(axis=1), kind="stable")
    central = covariances[int(order[len(relative) // 2])]
    wide = half_width(1.0, 1e9)
    # of a fit they are in what stays of its intervals
    middle = dict(zip(legs.spec.names, np.median(legs.values, axis=0).tolist(), strict=True))
    beyond = {} if legs.of_fit else assumed_sd(middle, legs.spec, legs.options, legs.priors)
    parameters = {}
    for j, name in enumerate(names):
        p = table[name]
        value = float(np.median(legs.values[:, columns[j]]))
        sem = None
        half = None
        errors = relative[:, j]
        with_arms = np.hypot(errors, beyond.get(name, 0.0))
        share = float(np.mean(wide * with_arms <= IDENTIFIED))
        verdict: Verdict
        if np.isfinite(errors).all() and central is not None:
            sem = float(np.sqrt(np.mean(errors**2)))
            half = wide * float(np.sqrt(np.mean(with_arms**2)))
            verdict, note = judge_interval(name, value, half * abs(value), central)
        else:
            verdict = Verdict.UNDETERMINED
            worst = covariances[int(np.argmax(~np.isfinite(errors)))]
            note = judge_singular(name, worst.directions if worst is not None else ())
        parts = [s[name] for s in shares if name in s and sem is not None]
        budget = {
            source: float(np.mean([part.get(source, 0.0) for part in parts]))
            for source in dict.fromkeys(s for part in parts for s in part)
        }
        parameters[name] = Expected(
            name,
            p.unit,
            p.meaning,
            value,
            sem,
            half,
            verdict,
            note,
            share,
            FrozenDict(budget),
            finite(now[name]) if name in now else None,
        )
    return Expectation(
        protocol=trajectory.settings.profile,
        model=legs.spec.name,
        legs=legs.name,
        seconds=float(trajectory.time[-1]),
        noise=noise,
        rate_hz=trajectory.settings.rate_hz,
        parameters=FrozenDict(parameters),
        nuisances=tuple(n for n in legs.free if n in legs.priors),
        relative=read_only(relative),
        correlation=central,
        load=load_of(trajectory) if legs.options.anatomy == ANKLE else None,
        of_fit=legs.of_fit,
        torque=(float(trial.torque[:, 0].min()), float(trial.torque[:, 1].max())),
    )


def _shares(known: Covariance, of_leg: tuple[str, ...]) -> dict[str, dict[str, float]]:
    """Parts of each variance by source, as the budget of a fit has them."""
    V = known.matrix
    names = known.names
    sources: dict[str, list[int]] = {}
    for j, name in enumerate(names):
        if name not in of_leg and (source := source_of(name)) is not None:
            sources.setdefault(source.name, []).append(j)
    everything = sorted(j for at in sources.values() for j in at)
    shares = {}
    for name in of_leg:
        if name not in names:
            continue
        j = names.index(name)
        marginal = float(V[j, j])
        parts = {"noise": _variance_given(V, j, everything)}
        parts |= {s: max(marginal - _variance_given(V, j, at), 0.0) for s, at in sources.items()}
        total = sum(parts.values())
        shares[name] = {s: part / total for s, part in parts.items()} if total > 0.0 else {}
    return shares


def _variance_given(V: FloatArray, j: int, known: list[int]) -> float:
    """Variance of a parameter with others known; a parameter does not make itself known."""
    known = [i for i in known if i != j]
    if not known:
        return float(V[j, j])
    cross = V[j, known]
    return float(max(V[j, j] - cross @ np.linalg.pinv(V[np.ix_(known, known)]) @ cross, 0.0))
