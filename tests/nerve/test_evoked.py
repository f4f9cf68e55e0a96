"""EMG that answers stretch is told from effort, and said not to be known where nothing was seen."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.measures.evoked import evoked_emg
from surae.measures.leg import NotDefinedError
from surae.measures.table import DEFINITIONS
from surae.signals import ModelInputs

RATE = 128.0


def trial(gain: float = 1e-5, *, effort: float = 5e-5, seed: int = 1) -> ModelInputs:
    """Ramps of 1.5 rad/s each three seconds at rest, each answered, then an effort."""
    time = np.arange(round(40 * RATE)) / RATE
    phase = time % 3.0
    velocity = np.where(phase < 0.25, 1.5, np.where((phase > 1.5) & (phase < 1.75), -1.5, 0.0))
    velocity[time > 30.0] = 0.0
    draw = np.random.default_rng(seed)
    late = np.roll(np.maximum(velocity, 0.0), round(0.045 * RATE))
    emg = 1e-7 + 2e-7 * np.abs(draw.standard_normal((len(time), 4)))
    emg[:, 2] += gain * late
    emg[(time > 32.0) & (time < 36.0), 2] += effort
    return ModelInputs(
        name="ramps",
        rate_hz=RATE,
        time=time,
        angle=np.cumsum(velocity) / RATE,
        velocity=velocity,
        acceleration=np.zeros_like(time),
        emg=read_only(emg),
        emg_unit="V",
        torque=None,
    )


def test_what_answers_stretch_is_found_and_effort_is_not() -> None:
    one = trial()
    evoked = evoked_emg(one)
    late = np.roll(np.maximum(one.velocity, 0.0), round(0.045 * RATE))
    assert np.allclose(evoked[late > 0.0, 2], 1.5e-5, rtol=0.1)
    assert evoked[one.time > 31.0].max() == 0.0
    assert evoked[:, 0].max() == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_none_is_found_where_nothing_answers(seed: int) -> None:
    assert evoked_emg(trial(0.0, seed=seed)).max() == 0.0


def test_effort_in_time_with_the_movement_is_no_answer() -> None:
    """The person pulls before and while the foot is turned: too early for a reflex."""
    one = trial(0.0)
    with_it = np.convolve(np.maximum(one.velocity, 0.0), np.ones(13) / 13, "same")
    emg = one.emg + np.outer(with_it, (0.0, 0.0, 1e-5, 0.0))
    assert evoked_emg(replace(one, emg=read_only(emg))).max() == 0.0


def test_what_was_not_recorded_is_said() -> None:
    one = trial()
    with pytest.raises(NotDefinedError, match="no EMG of the calf"):
        evoked_emg(replace(one, emg=np.zeros_like(one.emg)))
    with pytest.raises(NotDefinedError, match="over 15°/s"):
        evoked_emg(replace(one, velocity=0.1 * one.velocity))
    busy = one.emg + 5e-5 * np.array([0.0, 0.0, 1.0, 0.0])
    assert evoked_emg(replace(one, emg=read_only(busy)))[:, 2].min() >= 0.0


def test_the_measure_says_what_it_is() -> None:
    [evoked_share] = [each for each in DEFINITIONS if each.name == "evoked_share"]
    assert evoked_share.meaning.startswith("Part of EMG that answers stretches")
    assert "25 to 120 ms" in evoked_share.formula
