"""For whom a protocol is judged: draws of a population, or of what a fit leaves open."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import check_known
from surae.base.frozen import Comparable, read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import AssessedFit, FitResult
from surae.inference.uncertainty.combined import ZERO, Uncertainty
from surae.model import ModelOptions, ModelSpec, get_model, with_optional
from surae.model.joint import ANKLE
from surae.model.laboratory import AUTO, COMPLIANT, EACH_TRIAL, NONE, group_of, laboratory, richest
from surae.model.source import Gaussian
from surae.signals import emg_levels, emg_sizes
from surae.studies.leg import EMG_FULL, EMG_REST
from surae.studies.populations import POPULATIONS, TENDONS, virtual_subject

#: Largest deviation of a draw from a fit, as a factor's logarithm; and that of a parameter of
#: which neither fit nor population says how far it may be off.
_WIDEST = np.log(2.0)
_VAGUE = 0.3
#: Seed of the first leg that a protocol is judged by; a design is searched on others.
_SEEDS = 1_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Legs(Comparable):
    """Legs that may be measured, all of one model."""

    name: Message  #: Who they are, in words.
    spec: ModelSpec  #: The model, with its nuisances.
    options: ModelOptions  #: Its switches.
    free: tuple[str, ...]  #: What a fit would estimate: parameters of the leg, then nuisances.
    priors: Mapping[str, Gaussian]  #: Priors of the nuisances.
    values: FloatArray  #: Parameter vectors in the model's order, shape (n_legs, n_parameters).
    #: `emg_rest`, `emg_full`: EMG envelope of TA, GL, SOL, GM at rest and at the largest effort, in
    #: `emg_unit`, shape (4,).
    emg_rest: FloatArray
    emg_full: FloatArray
    emg_unit: str = "V"  #: "V", "1": Volts, or a normalised envelope.
    of_fit: bool = False  #: Whether they are what one fit leaves possible.
    films: tuple[str, ...] = ()  #: Muscles that are filmed (`surae.planning.information`).

    @property
    def leg_parameters(self) -> tuple[str, ...]:
        """The parameters of the leg that a fit would estimate."""
        return tuple(name for name in self.free if name not in self.priors)

    @property
    def each_trial(self) -> frozenset[str]:
        """The nuisances that every trial has anew."""
        return frozenset(name for name in self.priors if group_of(name) in EACH_TRIAL)

    @property
    def estimated(self) -> FloatArray:
        """Each leg's values of what a fit would estimate, shape (n_legs, p)."""
        return self.values[:, [self.spec.names.index(name) for name in self.free]]

    def inputs(self, effort: FloatArray) -> FloatArray:
        """EMG envelopes, shape (n, 4), of an effort of that shape."""
        return self.emg_rest + (self.emg_full - self.emg_rest) * effort


def population_legs(
    model: str,
    population: str | None,
    count: int,
    *,
    first: int = 0,
    nuisances: str | Mapping[str, tuple[float, float]] | None = None,
    options: ModelOptions | None = None,
) -> Legs:
    """Legs drawn from a population, or half from each.

    `model` may be ``"auto"``: the family's richest one, with the laboratory's nuisances, all by
    default; a named model has none by default. Legs are of seeds from `first`.
    """
    options = options or ModelOptions()
    if options.anatomy != ANKLE:
        raise InputError("populations are known of the ankle alone; give a fit of the joint")
    if population is not None:
        check_known("population", POPULATIONS, population)
    names = list(POPULATIONS) if population is None else [population]
    spec, priors, free = _spec_of(model, nuisances)
    if not set(POPULATIONS["healthy"]) <= set(spec.names):
        raise InputError(f"nothing typical is known for model {model!r}; choose another model")
    levels = np.full(4, EMG_FULL)
    if "emg_shape" in priors and options.emg_ref is None:
        options = replace(options, emg_ref=tuple(levels.tolist()))
    rows = []
    for k in range(count):
        subject = virtual_subject(
            _SEEDS + first + k,
            names[k % len(names)],
            tendons=model in (AUTO, COMPLIANT) or "pt_tri" in free,
        )
        truth = subject.truth(spec.name, options)
        truth = {n: v for n, v in truth.items() if n not in TENDONS["healthy"] or n in free}
        rows.append(spec.vector(truth | {n: b.mean for n, b in priors.items()}, options))
    return Legs(
        Message(f"legs/{population or 'all'}", n=count),
        spec,
        options,
        free,
        priors,
        read_only(np.array(rows)),
        emg_rest=read_only(np.full(4, EMG_REST)),
        emg_full=read_only(levels),
    )


def fit_legs(fit: AssessedFit, count: int, *, seed: int = 0) -> Legs:
    """Legs that a fit leaves possible: its estimate first, then draws of what it left open."""
    result = fit.result
    assessment = fit.assessment
    problem = result.problem
    if result.status == "failed":
        raise InputError("the fit failed and describes no leg; name a population instead")
    priors = dict(result.solution.beliefs)
    centre = problem.spec.vector(result.values, problem.options)
    columns = [problem.spec.names.index(name) for name in problem.free]
    rows = np.tile(centre, (count, 1))
    drawn = _possible(assessment.uncertainty.at_assumed, priors).draw(count - 1, seed)
    rows[1:, columns] = drawn[:, : len(columns)]
    # what the fit's recordings reach, or a typical one if at rest
    unit = problem.inputs[0].emg_unit
    typical = np.array(emg_sizes(problem.inputs)) * (EMG_FULL if unit == "V" else 1.0)
    seen = np.array(emg_levels(problem.inputs))
    levels = np.where(seen > 0.2 * typical, seen, typical)
    return Legs(
        Message("legs/fitted"),
        problem.spec,
        problem.options,
        problem.free,
        priors,
        read_only(rows),
        emg_rest=read_only(np.zeros(4)),
        emg_full=read_only(levels),
        emg_unit=unit,
        of_fit=True,
    )


def noise_of(result: FitResult, rate_hz: float) -> float:
    """White noise [Nm], sample by sample at a rate, that would tell as little as a fit's residual.

    A residual that is correlated over time tells less than its size says: what counts is its
    spectral density at the frequencies of the movement, which the believed intervals know.
    """
    density = 0.0
    for residual, inputs in zip(result.residuals, result.problem.inputs, strict=True):
        n = len(residual)
        power = np.abs(np.fft.rfft(residual - residual.mean())) ** 2 / n
        slow = np.fft.rfftfreq(n, 1.0 / inputs.rate_hz) <= 3.0  # of the movement [Hz]
        slow[0] = False
        level = float(power[slow].mean()) if slow.any() else float(np.var(residual))
        density += max(level, 1e-12) / inputs.rate_hz * n
    density /= sum(len(residual) for residual in result.residuals)
    return float((density * rate_hz) ** 0.5)


def _spec_of(
    model: str, nuisances: str | Mapping[str, tuple[float, float]] | None
) -> tuple[ModelSpec, dict[str, Gaussian], tuple[str, ...]]:
    """The model with its nuisances, their priors, and what is free."""
    base = get_model(richest(model))
    if nuisances is None:
        nuisances = "all" if model == AUTO else NONE
    # what is not planned: films unless asked for, and envelopes, which lag, instead of raw EMG
    unplanned = {n for n in laboratory() if n in base.free or group_of(n) in ("film", "lag")}
    priors = {n: b for n, b in laboratory(nuisances).items() if n not in unplanned}
    spec = with_optional(base, priors)
    priors = {n: b for n, b in priors.items() if n in spec.names}
    return spec, priors, (*base.free, *(n for n in spec.names if n in priors))


def _possible(known: Uncertainty, priors: Mapping[str, Gaussian]) -> Uncertainty:
    """What is known of the leg alone: what has no interval is as far off as in both populations."""
    sd = np.sqrt(np.diag(known.covariance()))
    most = _WIDEST * np.abs(known.values)
    wide = np.zeros((len(sd), len(sd)))
    for j, name in enumerate(known.names):
        if name in (*priors, ZERO):
            most[j] = 0.0
        elif name in (*known.lost, *known.at_bound) or not sd[j] > 0.0:
            most[j], wide[j, j] = 0.0, _spread(name) * abs(known.values[j])
    part = np.minimum(most / np.where(sd > 0.0, sd, 1.0), 1.0)
    rows = np.concatenate([*known.rows.values(), np.zeros((0, len(sd)))]) * part
    return replace(known, rows={"noise": np.concatenate([rows, wide])})


def _spread(name: str) -> float:
    """Standard deviation of a parameter's logarithm in both populations."""
    ranges = [p[name] for p in (*POPULATIONS.values(), *TENDONS.values()) if name in p]
    if not ranges:
        return _VAGUE
    low = min(r[0] for r in ranges)
    high = max(r[1] for r in ranges)
    return float(np.log(high / low) / np.sqrt(12.0))
