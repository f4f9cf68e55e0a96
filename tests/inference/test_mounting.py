"""A foot that lies otherwise in one recording of a joint fit is named, and by how much."""

from types import SimpleNamespace

import numpy as np
import pytest

import surae
from surae.inference.judging.of_fit import foot_moved
from surae.inference.posterior.conflict import ZERO_NAME
from surae.inference.posterior.mounting import STAYS, mountings
from surae.inference.result import Mounting
from surae.recording.corrections import Corrections

#: Samples of each recording, their rate [Hz] and the noise of the torque [Nm].
N, RATE, NOISE = 800, 50.0, 0.3


def joint(turned, seconds=16.0, seed=1):
    """A quadratic at its mode: torque is linear in two numbers of the leg and in zeros [deg]."""
    rng = np.random.default_rng(seed)
    blocks, inputs = [], []
    for number, degrees in enumerate(turned):
        n = round(seconds * RATE)
        t = np.arange(n) / RATE
        angle = np.sin(2.0 * np.pi * (0.2 + 0.03 * number) * t)
        by = np.column_stack([angle, np.exp(angle), 8.0 * np.exp(angle)])  # leg, leg, the zero
        by[:, 2] += 4.0
        e = by[:, 2] * np.radians(degrees) + NOISE * rng.standard_normal(n)
        blocks.append(SimpleNamespace(H=by.T @ by / NOISE**2, g=-by.T @ e / NOISE**2))
        inputs.append(SimpleNamespace(name=f"trial {number}", counted=n, rate_hz=RATE))

    class Posterior:
        of = ("k", "x0", ZERO_NAME)
        weight = np.full(3, 1.0)
        mean = np.zeros(3)
        problem = SimpleNamespace(inputs=inputs)

        def reduced(self, every):
            return sum(b.H for b in every), sum(b.g for b in every)

    return Posterior(), SimpleNamespace(z=np.zeros(3), blocks=blocks)


def test_a_foot_that_stayed_is_not_said_to_have_moved() -> None:
    made = mountings(*joint((0.0, 0.0, 0.0, 0.0)))
    assert all(abs(each.turned) < 0.5 for each in made)
    assert all(STAYS <= each.sd < 1.4 * STAYS for each in made)
    assert made[0].probability > 0.9


def test_what_all_share_is_the_zero_of_the_device_and_no_movement() -> None:
    assert mountings(*joint((6.0, 6.0, 6.0)))[0].probability > 0.9


@pytest.mark.parametrize("degrees", [8.0, -8.0])
def test_the_trial_and_its_angle_are_named(degrees) -> None:
    made = mountings(*joint((0.0, degrees, 0.0, 0.0)))
    farthest = max(made, key=lambda each: abs(each.turned) / each.sd)
    assert farthest.trial == "trial 1"
    assert farthest.turned == pytest.approx(degrees, abs=0.5)
    assert farthest.probability < 1e-3


def test_a_repeat_of_one_session_may_turn_a_little() -> None:
    assert mountings(*joint((0.0, 2.0, -1.0)))[0].probability > 0.05


def test_pieces_of_strides_tell_nothing_of_the_foot() -> None:
    assert mountings(*joint((0.0, 8.0, 0.0), seconds=1.1)) == ()


def test_a_moved_foot_speaks_against_a_fit_by_its_trial() -> None:
    stayed = (Mounting("slow", 1.2, 1.8, 0.4), Mounting("walk", -1.2, 1.8, 0.4))
    assert list(foot_moved(stayed)) == list(foot_moved(())) == []
    (said,) = foot_moved((Mounting("slow", -8.2, 2.0, 1e-6), Mounting("walk", 6.2, 2.0, 1e-6)))
    assert said.values["trial"] == "slow"
    assert "by 8° (± 4°)" in str(said)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 8.0])
def test_a_foot_that_moved_between_trials_of_another_generator_is_no_yes(tmp_path, degrees) -> None:
    make = pytest.importorskip("ankle_legs.make")
    (rest,) = make.make("va", 401, tmp_path, (1,), kind="passive")
    (active,) = make.make("va", 401, tmp_path, (2,))
    rotated = Corrections(offset={"angle": np.radians(degrees)})
    trials = [rotated(surae.read(rest)), surae.read(active)]
    fit = surae.session(trials).fit()
    said = [reason for reason in fit.adequacy.against if reason.code == "foot-moved"]
    assert bool(said) == bool(degrees)
    assert (fit.adequacy.grade == "adequate") == (not degrees)
