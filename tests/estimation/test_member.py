"""Which noise is believed of a residual."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from surae.estimation.member import under_noise
from surae.estimation.mode import Target, white_noise
from surae.estimation.problem import make_problem
from surae.frozen import read_only
from surae.protocol import Protocol, generate
from surae.settings import FitSettings
from surae.studies import virtual_subject, virtual_trial


@pytest.mark.parametrize("leg", [1001, 1002])
def test_noise_is_believed_though_weak_values_move_far(leg):
    # What is weak on a short trial moves far along valleys; what noise explains is as far there.
    motion = generate(
        Protocol(
            profile="multiple-holds", task="part-passive", chirp_amplitude=0.2, chirp_rate=0.5,
            rate_hz=125.0,
        )
    )  # fmt: skip
    subject = virtual_subject(leg)
    clean = virtual_trial(subject, motion, noise=0.0)
    sd, rng = 0.05 * np.abs(clean.torque).mean(), np.random.default_rng([leg - 1000, 5])
    white = sd * np.sqrt(1.0 - 0.9**2) * rng.standard_normal(clean.n)
    noise = lfilter([1.0], [1.0, -0.9], white, zi=[0.9 * sd * rng.standard_normal()])[0]
    trial = replace(clean, torque=read_only(clean.torque + noise))
    problem = make_problem((trial,), FitSettings.of(model="muscle"))
    target = Target(problem, {}, white_noise(problem, 0.05))
    begin = target.descend(target.start(dict(subject.parameters)), evaluations=40, tolerance=0.01)
    believed, _ = under_noise(target, begin)
    assert believed.noise[0].coefficients[0] == pytest.approx(0.9, abs=0.04)
