"""The studies that the simulation section runs.

The thesis samples the muscle-tendon model at 1000 Hz since its explicit scheme is stiff (4.4); the
implicit one is not, so that both models run at the muscle model's 125 Hz here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import surae
from surae import ComputationError, ModelInputs
from surae.protocol import Protocol, chirp_rate, generate
from surae.studies import VirtualSubject, virtual_subject, virtual_trial
from surae.units import FloatArray
from surae_thesis.claims import INTEGRATOR
from surae_thesis.section import Context, Row
from surae_thesis.simulation.cells import (
    AMPLITUDES,
    CHOSEN_AMPLITUDE,
    CHOSEN_FACTOR,
    EXPLICIT_HZ,
    FACTORS,
    MAGNITUDE,
    MODELS,
    NOISE,
    NOISE_AMPLITUDE,
    NOISE_FACTORS,
    PROFILES,
    RATE_HZ,
    READINGS,
    REPEATS,
    STRAIN,
    TASKS,
    Cells,
    GridCell,
    Study,
    TorqueSize,
    cells,
    level,
    select,
    under,
)

#: Virtual subjects on whom the grid's conclusions are tried again.
_SUBJECTS, _QUICK_SUBJECTS = 10, 5
_QUICK_FACTORS = (0.05, 0.2, 0.35, 0.5, 0.6)
#: What a study of the thesis has in common.
_COMMON: Mapping[str, object] = {
    "model": MODELS, "protocol": PROFILES, "chirp_amplitude": AMPLITUDES,
    "chirp_factor": CHOSEN_FACTOR, "task": "part-passive", "population": "healthy",
    "noise": NOISE, "rate_hz": RATE_HZ, "seed": 1, "starts": 2,
}  # fmt: skip


def studies(context: Context) -> tuple[dict[str, Study], list[Row]]:
    """The cells under each reading, and as the thesis integrated; and the table of the grid."""
    quick, rows = context.quick, {}
    subjects = _QUICK_SUBJECTS if quick else _SUBJECTS
    asked: dict[str, dict[str, object]] = {
        "grid": {"chirp_factor": _QUICK_FACTORS if quick else FACTORS, "task": TASKS},
        "patients": {
            "population": "patient",
            "chirp_factor": (0.1, 0.3, 0.5, 0.6) if quick else FACTORS[::2],
        },
        "strain": {"model": "muscle-tendon", "tendon_strain": "slack-length"},
        **{
            f"explicit-{rate}": {
                "model": "muscle-tendon",
                "integrator": "explicit-euler",
                "rate_hz": rate,
                **(
                    {"protocol": ("multiple-holds", "multi-sine"), "chirp_amplitude": (0.2, 0.3)}
                    if quick and rate == EXPLICIT_HZ
                    else {}
                ),
            }
            for rate in (RATE_HZ, EXPLICIT_HZ)
        },
        "others": {"subjects": subjects},
        "others-active": {
            "subjects": subjects, "task": "active", "chirp_amplitude": CHOSEN_AMPLITUDE,
        },
    }  # fmt: skip
    for name, factors in asked.items():
        text = _toml({**_COMMON, "seed": context.seed, **factors})
        rows[name] = context.study(f"simulation-{name}", text)
    rows["others"] += rows.pop("others-active")
    grid, patients, others = (
        _with_torques(context, name, cells(rows[name]), population)
        for name, population in (
            ("grid", "healthy"), ("patients", "patient"), ("others", "healthy"),
        )
    )  # fmt: skip
    explicit = {rate: cells(rows[f"explicit-{rate}"]) for rate in (RATE_HZ, EXPLICIT_HZ)}
    failed = sum(row["status"] == "failed" for row in rows["grid"])
    equal = {model: _equal_level(select(grid, model=model)) for model in MODELS}
    noise = _noise_cells(context, equal["muscle"])

    def read(some: Cells, reading: str) -> Cells:
        return tuple(under(cell, reading, equal[cell.model]) for cell in some)

    views = {
        reading: Study(
            grid=read(grid, reading),
            noise=noise[reading],
            patients=read(patients, reading),
            others=read(others, reading),
            explicit=explicit,
            failed=failed,
        )
        for reading in READINGS
    }
    for name, some in ((STRAIN, cells(rows["strain"])), (INTEGRATOR, explicit[EXPLICIT_HZ])):
        views[name] = Study(some, (), (), (), explicit)
    return views, rows["grid"]


def _toml(factors: Mapping[str, object]) -> str:
    return "".join(f"{key} = {_value(value)}\n" for key, value in factors.items())


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_value, value))}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _equal_level(grid: Cells) -> float:
    """The noise that is equal in every cell: the mean over them [Nm]."""
    sizes = [NOISE * cell.torque.magnitude for cell in grid if cell.torque is not None]
    return float(np.mean(sizes)) if sizes else np.nan


def _with_torques(context: Context, name: str, some: Cells, population: str) -> Cells:
    """Cells with the size of their torque without noise, simulated again."""
    groups: dict[str, list[GridCell]] = {}
    for cell in some:
        label = f"{cell.model} {cell.profile} {cell.task} {cell.subject}"
        groups.setdefault(label, []).append(cell)
    jobs = {
        label: {
            "model": members[0].model,
            "profile": members[0].profile,
            "task": members[0].task,
            "population": population,
            "truth": dict(members[0].truth),
            "chirps": [[cell.amplitude, cell.factor] for cell in members],
        }
        for label, members in groups.items()
    }
    sizes = context.calls(f"simulation-torque-{name}", torque_sizes, jobs)
    return tuple(
        replace(cell, torque=TorqueSize(*size))
        for label, members in groups.items()
        for cell, size in zip(members, sizes[label], strict=True)
    )


def torque_sizes(
    model: str,
    profile: str,
    task: str,
    population: str,
    truth: Mapping[str, float],
    chirps: Sequence[Sequence[float | None]],
) -> list[list[float]]:
    """`TorqueSize` of the torque at chirps (amplitude, factor)."""
    subject = VirtualSubject(population, 0, truth)
    trials = [_trial(subject, model, profile, task, a or 0.0, s) for a, s in chirps]
    return [_size(trial) for trial in trials]


def _size(trial: ModelInputs) -> list[float]:
    torque = np.zeros(1) if trial.torque is None else trial.torque
    rms = float(np.sqrt(np.mean(torque**2)))
    return [float(np.abs(torque).mean()), abs(float(torque.mean())), rms]


def _trial(
    subject: VirtualSubject, model: str, profile: str, task: str, amplitude: float,
    factor: float | None, noise: float = 0.0, seed: int = 0,
) -> ModelInputs:  # fmt: skip
    chirp = {"chirp_rate": chirp_rate(factor)} if amplitude and factor else {}
    motion: dict[str, Any] = {"profile": profile, "task": task, "rate_hz": float(RATE_HZ), **chirp}
    trajectory = generate(Protocol(chirp_amplitude=amplitude, **motion))
    return virtual_trial(subject, trajectory, model=model, noise=noise, seed=seed)


def _noise_cells(context: Context, equal: float) -> dict[str, Cells]:
    """Repeats of the noise, fitted under every reading: muscle model, part-passive, 0.1 rad."""
    factors = (0.3, 0.5, 0.6) if context.quick else NOISE_FACTORS
    places = [(p, factor, r) for r in READINGS for p in PROFILES for factor in factors]
    jobs = {
        f"{profile} {factor} {reading}": {
            "seed": context.seed, "profile": profile, "factor": factor, "reading": reading,
            "equal": equal,
        }
        for profile, factor, reading in places
    }  # fmt: skip
    made = context.calls("simulation-noise", noise_fits, jobs)
    some: dict[str, list[GridCell]] = {reading: [] for reading in READINGS}
    for (profile, factor, reading), fits in zip(places, made.values(), strict=True):
        some[reading] += [
            GridCell(
                "muscle", profile, "part-passive", NOISE_AMPLITUDE, factor, 1, number, fit["vaf"],
                fit["ipde"], fit["sem"], fit["off"], {},
            )
            for number, fit in enumerate(fits, 1)
            if fit is not None
        ]  # fmt: skip
    return {reading: tuple(several) for reading, several in some.items()}


def noise_fits(
    seed: int, profile: str, factor: float, reading: str, equal: float
) -> list[dict[str, Any] | None]:
    """Fits of one trial under repeats of its noise; None for one that failed."""
    subject = virtual_subject(1_000_000 * seed + 1)
    place = (subject, "muscle", profile, "part-passive", NOISE_AMPLITUDE, factor)
    clean = _trial(*place)
    size = TorqueSize(*_size(clean))
    part = level(size, reading, equal) / level(size, MAGNITUDE, equal)
    fits: list[dict[str, Any] | None] = []
    for repeat in range(1, REPEATS + 1):
        noisy = _trial(*place, noise=NOISE, seed=repeat)
        assert clean.torque is not None  # a simulation has one
        assert noisy.torque is not None
        torque: FloatArray = clean.torque + part * (noisy.torque - clean.torque)
        try:
            fit = surae.fit(
                replace(noisy, torque=torque), "muscle", starts=2, seed=seed, quality=()
            )
        except ComputationError:
            fits.append(None)
            continue
        estimates = {name: p for name, p in fit.parameters.items() if p.free}
        fits.append(
            {
                "vaf": float(fit.vaf),
                "ipde": None if fit.ipde is None else float(fit.ipde),
                "sem": {n: float(p.sem) for n, p in estimates.items() if p.sem is not None},
                "off": {
                    n: float(p.value / subject.parameters[n] - 1.0) for n, p in estimates.items()
                },
            }
        )
    return fits
