"""A short made-up trial, fitted in the few ways a report has to show."""

from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from functools import cached_property

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.inference import AssessedFit, FitResult, assess, fit_problem, make_problem
from surae.model import ModelOptions, get_model
from surae.recording import SourceFile
from surae.report.fit import fit_report
from surae.signals import ModelInputs
from undrawn import blank_figures

TRUTH = {
    "m": 2.0,
    "k_tri": 200.0,
    "k_tib": 110.0,
    "x0_tri": 0.018,
    "x0_tib": 0.065,
    "tau_rel": 2.0,
    "k_rel": 0.4,
    "g1": 6e5,
    "g2": 9e5,
    "g3": 1.3e6,
    "g4": 1e6,
    "l0_tri": 0.045,
    "l0_tib": 0.075,
    "f0": 2.0,
    "beta": 1.0,
}
HOSTILE = '"><script>alert(1)</script>'


def trial(
    name: str = "trial 1", noise: float = 0.3, seed: int = 1, **changes: object
) -> ModelInputs:
    """Ten seconds at 100 Hz, torque noise of `noise` Nm."""
    rate_hz, n = 100.0, 1000
    time = np.arange(n) / rate_hz
    phases = ((0.35, 0.5, 0.0), (0.2, 1.3, 1.0), (0.08, 2.1, 2.0))
    angle, velocity, acceleration = np.full(n, -0.1), np.zeros(n), np.zeros(n)
    for amplitude, frequency, phase in phases:
        w = 2 * np.pi * frequency
        angle += amplitude * np.sin(w * time + phase)
        velocity += amplitude * w * np.cos(w * time + phase)
        acceleration -= amplitude * w**2 * np.sin(w * time + phase)
    emg = np.column_stack(
        [3e-4 * np.maximum(0.0, np.sin(2 * np.pi * f * time + f)) for f in (0.23, 0.31, 0.41, 0.57)]
    )
    inputs = ModelInputs(
        name,
        rate_hz,
        read_only(time),
        read_only(angle),
        read_only(velocity),
        read_only(acceleration),
        read_only(emg),
        "V",
        None,
        steps=("EMG: rectified.",),
        files=(SourceFile("trials/one.csv", "ab" * 32),),
    )
    inputs = replace(inputs, **changes)  # type: ignore[arg-type]
    spec = get_model("muscle")
    vector = np.array([TRUTH[name] for name in spec.names])
    torque = spec.simulator(inputs, ModelOptions()).torque(vector)
    torque = torque + noise * np.random.default_rng(seed).standard_normal(n)
    return replace(inputs, torque=read_only(torque))


class Case(AssessedFit):
    """A fit, what it is worth, and its report, where a test reads it."""

    @cached_property
    def page(self) -> str:
        """All of the report."""
        return fit_report(
            self,
            versions={"surae": "1.2.3"},
            created=datetime(2026, 1, 5, 14, 3),
        ).page()

    @cached_property
    def words(self) -> str:
        """The report without its figures."""
        with blank_figures():
            return Case(self.result, self.assessment).page


def make_case(result: FitResult) -> Case:
    return Case(result, assess(result))


@pytest.fixture(scope="session")
def make_trial() -> Callable[..., ModelInputs]:
    return trial


@pytest.fixture(scope="session")
def make_fitted() -> Callable[[FitResult], Case]:
    return make_case


@pytest.fixture(scope="session")
def plain() -> Case:
    """One recording, all parameters free, white noise."""
    return make_case(fit_problem(make_problem([trial()]), starts=3))


@pytest.fixture(scope="session")
def coloured() -> Case:
    """One recording whose noise is correlated over a fifth of a second."""
    white = np.random.default_rng(3).standard_normal(1000)
    noise = np.zeros(1000)
    for i in range(1, 1000):
        noise[i] = 0.95 * noise[i - 1] + 0.1 * white[i]
    clean = trial(noise=0.0)
    noisy = replace(clean, torque=read_only(clean.torque + noise))
    return make_case(fit_problem(make_problem([noisy]), starts=1))


@pytest.fixture(scope="session")
def joint() -> Case:
    """Two recordings with hostile names, one parameter fixed, one stopped at a bound."""
    files = (SourceFile(f"{HOSTILE}.csv", "cd" * 32),)
    inputs = [trial(), trial(HOSTILE, seed=2, steps=(HOSTILE,), files=files)]
    problem = make_problem(inputs, fixed={"beta": 1.0}, bounds={"f0": (0.3, 1.5)})
    return make_case(fit_problem(problem, starts=2))


@pytest.fixture(scope="session")
def silent() -> Case:
    """No activity of the tibialis anterior: two parameters have no influence."""
    emg = trial().emg.copy()
    emg[:, 0] = 0.0
    return make_case(fit_problem(make_problem([trial(emg=read_only(emg))]), starts=1))
