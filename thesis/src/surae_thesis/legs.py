"""Virtual legs and trials as the thesis simulates them (2.5), and two ways to fit them."""

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from surae import ComputationError, FitSettings, ModelInputs
from surae.base.units import FloatArray
from surae.inference import assess, covariance, ipde, make_problem, solve, vaf
from surae.model import ModelOptions, get_model
from surae.protocol import (
    DIRECTIONS,
    TASKS,
    Protocol,
    Trajectory,
    chirp_rate,
    generate,
    named_device,
)
from surae.recording import MUSCLES
from surae.studies import VirtualSubject, stream, virtual_subject, virtual_trial

#: Noise, a part of each signal's mean (2.5.3).
NOISE = 0.05
#: Sampling rates [Hz]: of the muscle model (2.1), and of the thesis's explicit scheme (4.4).
RATE_HZ = 256.0
EXPLICIT_HZ = 1000.0
#: Passive torque of the tibialis at full plantarflexion [Nm]: the axis of Figure 31 reaches −10 Nm,
#: where `surae.studies` has 1 Nm in health; a patient's muscles are stiffer and shorter (2.5.4).
_TIBIALIS = {"healthy": (1.0, (3.0, 5.0)), "patient": (0.85, (6.0, 10.0))}
#: Moment arm and length of the tibialis there [m], equations (5) and (9) at −0.9 rad.
_ARM = 0.0393 - 0.0171 * 0.9
_LENGTH = 0.136 - 1.56 * _ARM
#: Readings of a trial beside the usual one; some were found when the verdict was known.
IN_TURN = "heads in turn"
_LATER = "found afterwards"
LEAD = f"heads lead in turn, the others at 0.4 (one fitted number, {_LATER})"
EARLY = f"active from the first second ({_LATER})"
SLOW = f"tau_rel of 0.9 s ({_LATER})"
#: Table 2 calls ε0 a strain, the printed equations (20) and (21) take it in metres.
STRAIN = "ε0 as a strain"
#: Effort of the heads that do not lead, and the time constant that the thesis does not print [s].
FOLLOWERS = 0.4
SLOW_RELAXATION = 0.9
#: Defaults of MATLAB's lsqnonlin: relative step of its forward differences, and tolerances.
STEP = 1.5e-8
_TOLERANCE = 1e-6
_ITERATIONS = 100


def thesis_leg(
    number: int, population: str = "healthy", *, tendons: bool = False
) -> VirtualSubject:
    """A leg of `surae.studies` whose tibialis resists as the thesis's figures show."""
    drawn = virtual_subject(number, population, tendons=tendons)
    stiffness, torque = _TIBIALIS[population]
    k = stiffness * drawn.parameters["k_tib"]
    force = stream(drawn, "passive tibialis").uniform(*torque) / _ARM
    tibialis = {"k_tib": k, "x0_tib": _LENGTH - math.log(force) / k}
    return replace(drawn, parameters={**drawn.parameters, **tibialis})


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One fit of the thesis's simulations: whose trial, which protocol, which model."""

    seed: int
    model: str
    profile: str
    task: str
    amplitude: float
    factor: float | None
    population: str
    subject: int
    repeat: int
    explicit: bool
    reading: str


def fit_cell(**labels: Any) -> dict[str, Any] | None:
    """Simulate a cell's trial, fit it with the model that made it, and compare with the truth.

    `labels` are the fields of `Cell`.
    """
    cell = Cell(**labels)
    leg = thesis_leg(1_000_000 * cell.seed + cell.subject, cell.population)
    if cell.reading == SLOW:
        leg = replace(leg, parameters={**leg.parameters, "tau_rel": SLOW_RELAXATION})
    rate = EXPLICIT_HZ if cell.explicit else RATE_HZ
    options = {"integrator": "explicit-euler"} if cell.explicit else {}
    strain = {"tendon_strain": "slack-length"} if cell.reading == STRAIN else {}
    trajectory = motion(cell.profile, cell.task, cell.amplitude, cell.factor, rate, cell.reading)
    inputs, torque = thesis_trial(leg, trajectory, cell.model, cell.repeat, **options, **strain)
    seed = cell.seed
    fit = (
        fit_explicit(inputs, cell.model)[0]
        if cell.explicit
        else fit_trial(inputs, cell.model, 2, seed, **strain)
    )
    if fit is None:
        return None
    off = {name: value / leg.parameters[name] - 1.0 for name, value in fit["values"].items()}
    return {"torque": torque, "off": off, **{key: fit[key] for key in ("vaf", "ipde", "sem")}}


def protocol(
    profile: str,
    task: str = "part-passive",
    amplitude: float = 0.2,
    factor: float | None = 0.5,
    rate_hz: float = 512.0,
    device: str = "",
) -> Protocol:
    """A profile with the thesis's chirp A·sin(s·t²), for a device without limits or a named one."""
    return Protocol(
        profile=profile,
        task=task,
        chirp_amplitude=amplitude,
        chirp_rate=chirp_rate(factor or 0.5),
        rate_hz=rate_hz,
        device=named_device(device) if device else None,
    )


@lru_cache(4)
def motion(
    profile: str,
    task: str,
    amplitude: float,
    factor: float | None,
    rate_hz: float,
    reading: str = "",
) -> Trajectory:
    """Motion and effort of a trial; the active task is what follows the passive 11 s (Figure 9).

    By reading, each burst of the triceps is of one head alone (`IN_TURN`) or one leads (`LEAD`), or
    the active task is of the movement's beginning, with effort from its first second (`EARLY`).
    """
    whole = generate(protocol(profile, "part-passive", amplitude, factor, rate_hz))
    first = 0
    if task == "active":
        first = int(np.searchsorted(whole.time, TASKS["part-passive"].passive_until))
    n = len(whole.time) - first
    effort = whole.effort[first:]
    if reading in (IN_TURN, LEAD):
        effort = _in_turn(whole.effort, 0.0 if reading == IN_TURN else FOLLOWERS)[first:]
    part = slice(0, n) if reading == EARLY else slice(first, None)
    return replace(
        whole,
        time=whole.time[:n],
        effort=effort,
        **{name: getattr(whole, name)[part] for name in ("angle", "velocity", "acceleration")},
    )


def _in_turn(effort: FloatArray, others: float) -> FloatArray:
    """Effort of which every burst has one head lead, the next each time; of the others a part."""
    heads = [MUSCLES.index(muscle) for muscle in DIRECTIONS[0]]
    pulls = (effort[:, heads] > 0.0).any(axis=1)
    burst = np.cumsum(np.diff(pulls.astype(int), prepend=0) == 1) - 1
    alone = effort.copy()
    for number, head in enumerate(heads):
        alone[burst % len(heads) != number, head] *= others
    return alone


def thesis_trial(
    subject: VirtualSubject, trajectory: Trajectory, model: str, repeat: int, **options: str
) -> tuple[ModelInputs, list[float]]:
    """A trial with the thesis's noise, and the clean torque's mean magnitude, mean and RMS [Nm].

    White noise of 5 % of each signal's mean, the torque's with its sign, is added to EMG and
    torque; it is another in every cell and repeat.
    """
    chosen = ModelOptions.of(**options)
    clean = virtual_trial(subject, trajectory, model=model, options=chosen, noise=0.0)
    settings = trajectory.settings
    assert isinstance(settings, Protocol)  # `motion` has made it
    cell = f"{settings.profile} {settings.chirp_amplitude} {settings.chirp_rate} {clean.n}"
    return with_noise(clean, [subject.seed, repeat, zlib.crc32(cell.encode())])


def with_noise(clean: ModelInputs, seed: Sequence[int]) -> tuple[ModelInputs, list[float]]:
    """A trial without noise as `thesis_trial` gives it."""
    assert clean.torque is not None  # a simulation has one
    rng = np.random.default_rng(seed)
    mean = float(clean.torque.mean())
    emg = clean.emg + NOISE * clean.emg.mean(axis=0) * rng.standard_normal(clean.emg.shape)
    torque = clean.torque + NOISE * abs(mean) * rng.standard_normal(clean.n)
    size = [float(np.abs(clean.torque).mean()), abs(mean), float(np.sqrt(np.mean(clean.torque**2)))]
    return replace(clean, emg=emg, torque=torque), size


def fit_trial(
    inputs: ModelInputs, model: str, starts: int, seed: int, **options: str
) -> dict[str, Any] | None:
    """Fit by surae: VAF [%], IPDE, estimates, standard errors; None where it failed."""
    problem = make_problem([inputs], FitSettings.of(model, starts=starts, seed=seed, **options))
    result = solve(problem)
    if result.status == "failed":
        return None
    judged = assess(result)
    free = {name: p for name, p in judged.parameters.items() if p.free}
    return {
        "vaf": float(judged.vaf),
        "ipde": None if judged.ipde is None else float(judged.ipde),
        "values": {name: float(p.value) for name, p in free.items()},
        "sem": {name: float(p.sem) for name, p in free.items() if p.sem is not None},
    }


def fit_explicit(
    inputs: ModelInputs, model: str, step: float = STEP
) -> tuple[dict[str, Any], FloatArray]:
    """Fit by the thesis's explicit scheme and its kind of optimiser, from the default start.

    Least squares with forward differences (2.2), as MATLAB's lsqnonlin by its defaults; a `step`
    wider than the torque's chatter looks past it.

    Returns
    -------
    dict
        As of `fit_trial`, which estimates are at a bound, and the correlation of the others.
    ndarray, shape (n,)
        What the modelled torque has above the measured one [Nm].
    """
    from scipy.optimize import least_squares

    spec = get_model(model)
    options = ModelOptions.of(integrator="explicit-euler")
    parameters = [p for p in spec.parameters if p.name in spec.free]
    names = tuple(p.name for p in parameters)
    low, high, start = (
        np.array([getattr(p, key) for p in parameters]) for key in ("lower", "upper", "start")
    )
    torque = inputs.torque
    simulator = spec.simulator(inputs, options)
    assert torque is not None

    def residual(scaled: FloatArray) -> FloatArray:
        values = dict(zip(names, (scaled * start).tolist(), strict=True))
        try:
            return np.asarray(simulator.torque(spec.vector(values, options)) - torque)
        except ComputationError:
            return np.full(inputs.n, 1e3)

    end = least_squares(
        residual,
        np.ones(len(start)),
        bounds=(low / start, high / start),
        diff_step=step,
        ftol=_TOLERANCE,
        xtol=_TOLERANCE,
        max_nfev=_ITERATIONS,
    )
    # The standard deviation of what may be between the bounds.
    bounded = {
        p.name: (p.upper - p.lower) / math.sqrt(12.0)
        for p, active in zip(parameters, end.active_mask, strict=True)
        if active
    }
    jacobian = end.jac / start
    known = covariance(np.linalg.qr(jacobian)[1], names, 2.0 * float(end.cost), inputs.n, bounded)
    errors = np.sqrt(np.diag(known.matrix)).tolist()
    fit = {
        "vaf": float(vaf(torque, end.fun)),
        "ipde": float(ipde(known.correlation)),
        "values": dict(zip(names, (end.x * start).tolist(), strict=True)),
        "sem": dict(zip(known.names, errors, strict=True)),
        "bounded": list(bounded),
        "correlation": {"names": list(known.names), "matrix": known.correlation.tolist()},
    }
    return fit, np.asarray(end.fun)
