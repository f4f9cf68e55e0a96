"""How well delay and reflex are found again: a Markdown table.

The truth does not come from the drives under test: it is simulated at 1000 Hz by the models as they
are, their EMG shifted by whole milliseconds and the reflex added to it as if it were EMG, and then
sampled at 125 Hz, where a millisecond is an eighth of a sample.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from surae.base.units import FloatArray
from surae.inference import assess, fit_problem, make_problem
from surae.model import ModelOptions, get_model
from surae.model.geometry import paths
from surae.protocol import Protocol, generate
from surae.signals import ModelInputs
from surae.studies import virtual_subject, virtual_trial

FINE, COARSE = 1000, 125
OPTIONS = ModelOptions()
#: Known from an active trial where there is none.
ACTIVE = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
#: Name, model, trials, freed, known, whether the truth has a delay and a reflex.
CASES = (
    ("emd", "muscle", ("active",), ("emd",), (), (True, False)),
    ("emd, beta known", "muscle", ("active",), ("emd",), ("beta",), (True, False)),
    ("emd", "muscle-tendon", ("active",), ("emd",), (), (True, False)),
    ("reflex, active and stretches", "muscle", ("active", "fast"), ("reflex",), (), (False, True)),
    ("reflex, stretches alone", "muscle", ("fast",), ("reflex",), ACTIVE, (False, True)),
    ("both", "muscle", ("active", "fast"), ("emd", "reflex"), (), (True, True)),
    (
        "reflex, active and stretches",
        "muscle-tendon",
        ("active", "fast"),
        ("reflex",),
        (),
        (False, True),
    ),
)


def active_trial(seed: int) -> ModelInputs:
    """Multiple holds with a chirp, part passive, at 1000 Hz."""
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=float(FINE)
    )
    return virtual_trial(virtual_subject(seed), generate(protocol), noise=0.0)


def fast_stretches() -> ModelInputs:
    """Passive stretches of 0.85 rad both ways, peaks of 1.5 to 6 rad/s, a second's rest each."""
    low, high = -0.5, 0.35
    pieces = [np.full(FINE // 2, low)]
    for peak in (1.5, 3.0, 4.5, 6.0):
        for start, end in ((low, high), (high, low)):
            count = round(2.0 * (high - low) / peak * FINE)
            s = np.arange(1, count + 1) / count
            pieces.append(start + (end - start) * (s - np.sin(2 * np.pi * s) / (2 * np.pi)))
            pieces.append(np.full(FINE, end))
    angle = np.concatenate(pieces)
    velocity = np.gradient(angle, 1 / FINE)
    return ModelInputs(
        name="fast passive stretches",
        rate_hz=float(FINE),
        time=np.arange(len(angle)) / FINE,
        angle=angle,
        velocity=velocity,
        acceleration=np.gradient(velocity, 1 / FINE),
        emg=np.zeros((len(angle), 4)),
        emg_unit="V",
        torque=None,
        prepared=True,
    )


def later(signal: FloatArray, samples: int) -> FloatArray:
    """The signal, so many samples later, held at its start."""
    return np.concatenate([np.repeat(signal[:1], samples, axis=0), signal])[: len(signal)]


def measured(
    fine: ModelInputs, model: str, truth: dict[str, float], noise: float, rng: np.random.Generator
) -> ModelInputs:
    """The trial as it would be recorded: torque of the truth with white noise, at 125 Hz."""
    tri, tib = paths(angle=fine.angle, velocity=fine.velocity, options=OPTIONS)
    emg = later(fine.emg, round(1e3 * truth["emd"])).copy()
    for channel, weight, gain, path in ((2, "g3", "reflex_tri", tri), (0, "g1", "reflex_tib", tib)):
        stretch = later(np.maximum(path.speed, 0.0), round(1e3 * truth["reflex_delay"]))
        emg[:, channel] += truth[gain] / truth[weight] * stretch
    spec = get_model(model)
    p = spec.vector({n: v for n, v in truth.items() if n in spec.names}, OPTIONS)
    every = slice(None, None, FINE // COARSE)
    torque = spec.simulator(replace(fine, emg=emg), OPTIONS).torque(p)[every]
    torque += noise * np.abs(torque).mean() * rng.standard_normal(len(torque))
    sampled = {
        name: np.ascontiguousarray(getattr(fine, name)[every])
        for name in ("time", "angle", "velocity", "acceleration", "emg")
    }
    return replace(fine, rate_hz=float(COARSE), torque=torque, **sampled)


def errors(
    case: tuple, seeds: Sequence[int], noise: float, starts: int
) -> Iterator[tuple[str, float, float, float | None, bool | None]]:
    """Parameter, truth, estimate, standard error and whether the interval holds the truth."""
    _, model, trials, freed, known, (delayed, reflexive) = case
    for seed in seeds:
        rng = np.random.default_rng([seed, 11])
        drawn = {
            "emd": 1e-3 * rng.integers(20, 101) * delayed,
            "reflex_tri": rng.uniform(1e3, 4e3) * reflexive,
            "reflex_tib": rng.uniform(5e2, 2e3) * reflexive,
            "reflex_delay": 1e-3 * rng.integers(35, 91),
        }
        truth = dict(virtual_subject(seed).truth(model, OPTIONS)) | drawn
        recorded = [
            measured(
                active_trial(seed) if kind == "active" else fast_stretches(),
                model,
                truth,
                noise,
                rng,
            )
            for kind in trials
        ]
        fixed = {name: truth[name] for name in known}
        assessed = assess(
            fit_problem(make_problem(recorded, model, free=freed, fixed=fixed), starts=starts)
        )
        for name in (*drawn, "f0"):
            p = assessed.parameters.get(name)
            if p is not None and p.free:
                covered = None if p.ci95 is None else p.ci95[0] <= truth[name] <= p.ci95[1]
                yield name, truth[name], p.value, p.trusted_sem, covered


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--subjects", type=int, default=30)
    parser.add_argument("--starts", type=int, default=2)
    parser.add_argument("--noise", type=float, default=0.05)
    given = parser.parse_args()
    print(
        "| freed | model | parameter | mean truth | bias | spread | median SEM | RMS error / SEM "
        "| in 95 % interval |\n|---|---|---|--:|--:|--:|--:|--:|--:|"
    )
    for case in CASES:
        rows = list(errors(case, range(given.subjects), given.noise, given.starts))
        for name in dict.fromkeys(row[0] for row in rows):
            own = [row for row in rows if row[0] == name]
            known = [(e - t, sem, held) for _, t, e, sem, held in own if sem is not None]
            error, sem, covered = np.array(known, dtype=float).T
            print(
                f"| {case[0]} | {case[1]} | {name} | {np.mean([r[1] for r in own]):.4g} "
                f"| {error.mean():+.2g} | {error.std(ddof=1):.2g} | {np.median(sem):.2g} "
                f"| {np.sqrt(np.mean((error / sem) ** 2)):.2f} "
                f"| {covered.sum():.0f} of {len(known)} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
