"""Which way the measured dynamometer counts torque, settled from its passive trials.

A joint that nobody moves by will resists: it pulls back from where it is turned to. The torque of
our convention, positive when the triceps pulls, therefore rises with dorsiflexion. Only gravity
could do something else, and it is far too small.
"""

import numpy as np
import pytest

from surae.recording import inspect
from surae.recording.formats import open_table
from surae.recording.source import open_source

#: The largest m the model allows [kg], at its distance from the axis [m].
_MOST_GRAVITY = 3.0 * 9.81 * 0.15


@pytest.fixture(scope="module")
def channels(shared):
    """Crank angle [deg, plantarflexion positive], crank torque [Nm], TA envelope [V] at 2 kHz."""

    def load(name):
        table = open_table(open_source(shared / "dynamometer" / f"{name}.mat"))
        loaded = table.load(("Angle", "Torque", "EMG_TA"))
        time = loaded["Angle"].time
        torque = np.interp(time, loaded["Torque"].time, loaded["Torque"].values)
        emg = np.interp(time, loaded["EMG_TA"].time, loaded["EMG_TA"].values)
        envelope = np.convolve(np.abs(emg - emg.mean()), np.ones(500) / 500, "same")
        return time, loaded["Angle"].values, torque, envelope

    return load


def test_the_passive_trials_are_passive(channels):
    for name in ("Pas_10", "Pas_Sho2Long"):
        assert channels(name)[3].max() < 0.01 * channels("Ref_Long_01")[3].max()


def test_passive_crank_torque_rises_towards_plantarflexion(channels):
    time, angle, torque, _ = channels("Pas_Sho2Long")
    dorsiflexed, plantarflexed = time < 4.0, time > 14.0
    assert angle[dorsiflexed].mean() == pytest.approx(-20.1, abs=0.2)
    assert angle[plantarflexed].mean() == pytest.approx(20.7, abs=0.2)
    change = torque[plantarflexed].mean() - torque[dorsiflexed].mean()
    assert change == pytest.approx(10.67, abs=0.1)
    ramp = (np.abs(angle) < 18.0) & (time > 4.5) & (time < 13.5)
    slope = np.polyfit(angle[ramp], torque[ramp], 1)[0]
    assert slope == pytest.approx(0.227, abs=0.01)
    # Turned by 40° gravity changes by at most 2 sin 20° of its largest torque: 3.0 Nm.
    assert change > 3 * _MOST_GRAVITY * 2 * np.sin(np.deg2rad(20.0))
    # In every quarter of the ramp, so no single event makes the slope.
    for low in (-18.0, -9.0, 0.0, 9.0):
        part = ramp & (angle >= low) & (angle < low + 9.0)
        assert np.polyfit(angle[part], torque[part], 1)[0] > 0.1


def test_held_still_passive_torque_lies_beside_the_ramp(channels):
    """The ramp gives way, so its torque is the lesser by friction within the tissue, 1.1 Nm."""
    _, angle, torque, _ = channels("Pas_10")
    time, ramp_angle, ramp_torque, _ = channels("Pas_Sho2Long")
    near = (np.abs(ramp_angle - angle.mean()) < 0.5) & (time > 5.0) & (time < 13.0)
    assert torque.mean() == pytest.approx(ramp_torque[near].mean(), abs=1.5)


def test_voluntary_dorsiflexion_raises_crank_torque_at_a_fixed_angle(channels):
    _, angle, torque, envelope = channels("Ref_Long_01")
    active, rest = envelope > 0.5 * envelope.max(), envelope < 0.05 * envelope.max()
    assert np.ptp(np.convolve(angle, np.ones(500) / 500, "valid")) < 0.5
    assert torque[active].mean() - torque[rest].mean() == pytest.approx(25.2, abs=0.5)
    assert np.corrcoef(envelope, torque)[0, 1] > 0.9


def test_so_crank_torque_is_positive_when_the_tibialis_pulls(channels, shared):
    """Both signs are -1, as the example mapping has them; inspection says they go together."""
    inspection = inspect(shared / "dynamometer" / "Pas_Sho2Long.mat")
    assert inspection.direction.startswith("'Torque' rises with 'Angle' (r = +0.99)")
    assert "the same sign" in inspection.direction
    for name in ("Ref_Long_01", "PL_50_01"):
        assert inspect(shared / "dynamometer" / f"{name}.mat").direction == ""
    example = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    assert example.count("sign = -1") == 2
