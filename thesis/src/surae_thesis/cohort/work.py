"""One subject of the cohort: every recording made once, and all its fits as plain numbers."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import surae
from surae import ComputationError, ModelInputs
from surae.base.units import FloatArray
from surae.inference import vaf
from surae.model import get_model
from surae.signals import Preparation, prepare
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    PASSIVE_PROTOCOL,
    CohortSubject,
    make_cohort,
)
from surae_thesis.cohort.trials import cohort_recording
from surae_thesis.legs import (
    EXPLICIT_HZ,
    RATE_HZ,
    fit_explicit,
    fit_trial,
    motion,
    thesis_leg,
    thesis_trial,
)

#: Models of the thesis by its numbers.
MODELS = {
    "1.0": "muscle",
    "2.0": "muscle-tendon",
    "2.1": "muscle-tendon-strain",
    "2.2": "muscle-tendon-toe",
}
#: Ways to fit several recordings together: model, and what it frees beside its own parameters.
JOINT: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "joint 2.0": ("2.0", ()),
    "joint + tendons": ("2.0", ("dlt_tri", "dlt_tib", "pt_tri")),
}
#: Samples of the largest torque that count as its peaks.
PEAK = 0.05
#: Step of finite differences that look past the chatter of the explicit scheme.
_WIDE = 0.01
#: The EMG weights have no truth: crosstalk and muscles without electrodes are part of them.
_WEIGHTS = ("g1", "g2", "g3", "g4")

Plain = dict[str, Any]


class _Subject:
    """A subject and its recordings as a model reads them, each made once."""

    def __init__(self, who: CohortSubject) -> None:
        self.who = who
        self.recording = cache(lambda protocol, r: cohort_recording(who, protocol, r))
        self.inputs = cache(
            lambda protocol, r, rate: prepare(
                self.recording(protocol, r), Preparation(rate_hz=rate)
            )
        )


def inputs_of(
    who: CohortSubject, protocol: str, repetition: int, rate_hz: float = RATE_HZ
) -> ModelInputs:
    """A recording of the cohort after the default preparation (2.1)."""
    return prepare(cohort_recording(who, protocol, repetition), Preparation(rate_hz=rate_hz))


def member_job(
    *, seed: int, member: int, made: Mapping[str, Any], repetitions: int, explicit: bool
) -> dict[str, Plain]:
    """Fit every model to every recording alone, as the thesis did, and let them predict others.

    How the cohort is `made`: keywords of `make_cohort`.

    Returns
    -------
    dict
        Fits by way, model, protocol and repetition, the way ``"implicit"``, or with `explicit`
        ``"strain"`` too, the tendon models with ε0 as a strain, ``"explicit"``, repetition 1 by
        `fit_explicit`, and ``"wide"``, the same with wide finite differences.
    """
    subject = _Subject(make_cohort(seed, **made)[member])
    fits = {}
    for protocol in subject.who.completed:
        for model, name in MODELS.items():
            if model in ("2.1", "2.2") and protocol != ACTIVE_PROTOCOL:
                continue
            for r in range(1, repetitions + 1):
                targets = _targets(protocol, repetitions) if r == 1 else ()
                label = f"{model} {protocol} {r}"
                fits[f"implicit {label}"] = _implicit(subject, name, protocol, r, targets, seed)
                if explicit and model != "1.0":
                    fits[f"strain {label}"] = _implicit(
                        subject, name, protocol, r, targets, seed, "slack-length"
                    )
                if explicit and model != "1.0" and r == 1:
                    fits[f"explicit {label}"] = _explicit(subject, name, protocol, targets)
                    if (model, protocol) == ("2.0", ACTIVE_PROTOCOL):
                        fits[f"wide {label}"] = _explicit(subject, name, protocol, (), _WIDE)
    return fits


def _targets(protocol: str, repetitions: int) -> tuple[tuple[str, int], ...]:
    """What repetition 1 predicts: the others, and from the multiple holds the ramp and hold."""
    others = tuple((protocol, r) for r in range(2, repetitions + 1))
    if protocol != ACTIVE_PROTOCOL:
        return others
    return others + tuple((PASSIVE_PROTOCOL, r) for r in range(1, repetitions + 1))


def _implicit(
    subject: _Subject,
    model: str,
    protocol: str,
    r: int,
    targets: Sequence[tuple[str, int]],
    seed: int,
    strain: str = "thesis",
) -> Plain:
    inputs = subject.inputs(protocol, r, RATE_HZ)
    options: dict[str, Any] = {} if model == MODELS["1.0"] else {"tendon_strain": strain}
    fit = surae.fit(inputs, model, starts=2, seed=seed, quality=(), **options)
    return fit_record(fit, subject.who, [(p, k, subject.inputs(p, k, RATE_HZ)) for p, k in targets])


def fit_record(
    fit: surae.Fit, who: CohortSubject, targets: Sequence[tuple[str, int, ModelInputs]]
) -> Plain:
    """A fit as plain numbers beside the truth, with what it predicts of other recordings."""
    truth = {**who.subject.parameters, **who.subject.tendons}
    sums = [start.sse for start in fit.result.solution.starts]
    parts = [fit.parts(number) for number in range(len(fit.result.problem.inputs))]
    measured = np.concatenate([_measured(inputs) for inputs in fit.result.problem.inputs])
    missing = np.concatenate(fit.result.residuals)
    return {
        "n": fit.result.problem.n,
        "vaf": finite(fit.vaf),
        # Whether the default start alone finds the best minimum, to a thousandth of its sum.
        "first_start": bool(sums[0] <= 1.001 * min(sums)),
        "parameters": {
            name: {
                "value": finite(p.value),
                "sem": finite(p.sem),
                "ci95": None if p.ci95 is None else [finite(end) for end in p.ci95],
                "at_bound": p.at_bound,
                "true": None if name in _WEIGHTS else finite(truth.get(name)),
            }
            for name, p in fit.parameters.items()
            if p.free
        },
        "correlation": {
            "names": list(fit.covariance.names),
            "matrix": np.round(fit.covariance.correlation, 6).tolist(),
        },
        "predicted": [
            {"protocol": protocol, "repetition": r, "vaf": _predicted(fit, inputs)}
            for protocol, r, inputs in targets
        ],
        "sizes": {
            **{
                name: finite(max(_largest(getattr(part, name)) for part in parts))
                for name in ("neural", "tissue", "inertial")
            },
            "short_at_peaks": _short(measured, missing),
        },
    }


def _explicit(
    subject: _Subject,
    model: str,
    protocol: str,
    targets: Sequence[tuple[str, int]],
    step: float | None = None,
) -> Plain:
    """A fit by the thesis's scheme in the same form."""
    inputs = subject.inputs(protocol, 1, EXPLICIT_HZ)
    fit, above = fit_explicit(inputs, model, **({} if step is None else {"step": step}))
    predicted = []
    for other, r in targets:
        target = subject.inputs(other, r, EXPLICIT_HZ)
        try:
            torque = surae.simulate(model, fit["values"], target, integrator="explicit-euler")
            share = finite(vaf(_measured(target), _measured(target) - torque))
        except ComputationError:
            share = None
        predicted.append({"protocol": other, "repetition": r, "vaf": share})
    return {
        "vaf": finite(fit["vaf"]),
        "parameters": {
            name: {
                "value": value,
                "sem": finite(fit["sem"].get(name)),
                "at_bound": name in fit["bounded"],
            }
            for name, value in fit["values"].items()
        },
        "correlation": fit["correlation"],
        "predicted": predicted,
        "sizes": {"short_at_peaks": _short(_measured(inputs), -above)},
    }


def joint_job(*, seed: int, member: int, repetitions: int, rate_hz: float) -> dict[str, Plain]:
    """Fit all but the last repetition of all protocols together, by every way, and predict it."""
    who = make_cohort(seed)[member]
    inputs = {
        (p, r): inputs_of(who, p, r, rate_hz)
        for p in who.completed
        for r in range(1, repetitions + 1)
    }
    last = [(p, r, one) for (p, r), one in inputs.items() if r == repetitions]
    several = [one for (_, r), one in inputs.items() if r < repetitions]
    return {
        way: fit_record(
            surae.fit(several, MODELS[model], free=free, starts=2, seed=seed, quality=()), who, last
        )
        for way, (model, free) in JOINT.items()
    }


def baseline_job(*, seed: int, protocol: str, model: str, subjects: int) -> dict[str, float]:
    """Mean standard errors of simulations of the protocol that the thesis chose (4.1.5).

    That is the motion before it was adapted to the device: chirp of 0.2 rad and factor 0.5.
    """
    trajectory = motion(protocol, "part-passive", 0.2, 0.5, RATE_HZ)
    spec = get_model(MODELS[model])
    errors: dict[str, list[float]] = {}
    for number in range(1, subjects + 1):
        drawn = thesis_leg(1_000_000 * seed + number, tendons=True)
        # A tendon of the subject's own only where it is estimated.
        tendons = {name: value for name, value in drawn.tendons.items() if name in spec.free}
        inputs, _ = thesis_trial(replace(drawn, tendons=tendons), trajectory, MODELS[model], 1)
        for name, sem in (fit_trial(inputs, MODELS[model], 2, seed) or {"sem": {}})["sem"].items():
            errors.setdefault(name, []).append(sem)
    return {name: float(np.mean(several)) for name, several in errors.items()}


def strength_job(*, seed: int, member: int) -> dict[str, float]:
    """Largest torque [Nm]: measured, and of the leg on Table 2's tendons with ε0 in metres."""
    who = make_cohort(seed)[member]
    inputs = inputs_of(who, ACTIVE_PROTOCOL, 1)
    printed = surae.simulate("muscle-tendon", who.subject.parameters, inputs)
    return {"measured": _largest(_measured(inputs)), "printed": _largest(printed)}


def _predicted(fit: surae.Fit, inputs: ModelInputs) -> float | None:
    """VAF of a recording that the fit predicts [%]."""
    try:
        return finite(fit.predict(inputs).vaf)
    except ComputationError:
        return None


def _short(measured: FloatArray, missing: FloatArray) -> float | None:
    """What is missing at the largest torques, as a part of them."""
    high = np.abs(measured) >= np.quantile(np.abs(measured), 1.0 - PEAK)
    short = float(np.mean(np.sign(measured[high]) * missing[high]))
    return finite(short / float(np.mean(np.abs(measured[high]))))


def _measured(inputs: ModelInputs) -> FloatArray:
    assert inputs.torque is not None  # every recording of the cohort has one
    return inputs.torque


def _largest(values: Any) -> float:
    return float(np.abs(values).max())


def finite(value: float | None) -> float | None:
    """A number, or None where there is none."""
    return None if value is None or not math.isfinite(value) else float(value)
