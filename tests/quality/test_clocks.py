"""Two clocks: a lag of the EMG that grows is found with its interval, and not where none grows."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only
from surae.inference.diagnosis.between import drifting_clock, lagging_stream, may_be_apart
from surae.inference.diagnosis.clocks import _solved, clock_drift, estimated_clock
from surae.inference.diagnosis.moving import moved
from surae.inference.diagnosis.quick import quick_fit
from surae.quality.trial import signals_of
from surae.recording import Recording


@pytest.fixture(scope="module")
def leg(tmp_path_factory) -> Recording:
    """A leg of another generator, whose tendons and electrodes no quick fit has."""
    make = pytest.importorskip("ankle_legs.make")
    return surae.read(make.make("a", 7101, tmp_path_factory.mktemp("legs"))[0])


def stamped(recording: Recording, rate: float, late: float = 0.0) -> Recording:
    """The recording whose EMG has stamps of a clock that is fast by a rate [s/s]."""
    channels = {
        role: replace(c, time=read_only(c.time * (1.0 + rate) + late))
        if role.startswith("emg_")
        else c
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


def looked_at(recording: Recording):
    signals = signals_of(recording)
    fit = quick_fit(recording, signals)
    assert fit is not None
    return recording, signals, fit


@pytest.mark.parametrize("rate", [1.5e-3, -2e-3, 4e-3])
def test_a_growing_lag_is_found_with_its_interval(leg, rate):
    drift = clock_drift(*looked_at(stamped(leg, rate)))
    assert drift is not None
    assert drift.certain is (abs(rate) >= 2e-3)  # what is less is a warning
    low, high = drift.ci95
    assert low <= rate <= high
    assert high - low < 2e-3


@pytest.mark.parametrize("late", [0.0, 0.1, -0.1])
def test_a_lag_that_does_not_grow_is_estimated_and_no_drift(leg, late):
    there = looked_at(stamped(leg, 0.0, late))
    assert clock_drift(*there) is None
    as_it_is = estimated_clock(*looked_at(leg), hinted=False)
    found = estimated_clock(*there, hinted=False)
    assert as_it_is is not None
    assert found is not None
    assert found.lag - as_it_is.lag == pytest.approx(late, abs=0.02)


@pytest.mark.slow
def test_electrodes_that_drift_bent_are_no_clock(tmp_path):
    """A leg of which, without bent drifts among the nuisances, a drift of 0.9 ms/s was claimed."""
    make = pytest.importorskip("ankle_legs.make")
    recording = surae.read(make.make("c", 7302, tmp_path, raw=True)[0])
    assert clock_drift(*looked_at(recording)) is None


def test_a_measured_trial_on_one_clock_has_no_drift(shared):
    recording = surae.read(shared / "dynamometer" / "PL_50_01.toml")
    assert clock_drift(*looked_at(recording)) is None


@pytest.mark.parametrize("rate", [0.0, 4e-3])
def test_of_one_electrodes_measured_trial_no_drift_is_told(shared, rate):
    """What the model lacks moves the estimate by more than its interval: nothing is claimed."""
    recording = surae.read(shared / "dynamometer" / "PL_50_01.toml")
    found = estimated_clock(*looked_at(stamped(recording, rate)), hinted=False)
    assert found is None or not found.told


# Angle and torque.


def apart(recording: Recording, stream: str, rate: float = 0.0, late: float = 0.0) -> Recording:
    """The recording whose angle, torque or EMG has stamps of another clock."""
    channels = {
        role: replace(c, time=read_only(c.time * (1.0 + rate) + late))
        if role.startswith(stream)
        else c
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


def test_which_streams_may_be_apart_is_seen_by_their_times(leg):
    assert may_be_apart(leg) == ("angle", "torque", "emg")
    assert may_be_apart(apart(leg, "emg", 1e-3)) == ("emg",)
    assert may_be_apart(apart(leg, "torque", 1e-3)) == ("torque",)
    assert may_be_apart(apart(leg, "angle", late=0.1)) == ("angle",)


@pytest.mark.parametrize("rate", [3e-3, -4e-3])
def test_a_torque_on_a_clock_of_its_own_is_found(leg, rate):
    drift = drifting_clock(*looked_at(apart(leg, "torque", rate)))
    assert drift is not None
    assert drift.stream == "torque"
    low, high = drift.ci95
    assert low <= rate <= high


@pytest.mark.parametrize(("stream", "late"), [("angle", 0.2), ("angle", -0.2), ("torque", 0.2)])
def test_a_stream_that_is_late_or_early_is_named_with_its_interval(leg, stream, late):
    lag = lagging_stream(*looked_at(apart(leg, stream, late=late)), None)
    assert lag is not None
    assert lag.stream == stream
    assert lag.ci95[0] <= late <= lag.ci95[1]
    assert lag.after.r2 > lag.before.r2


def test_streams_that_are_in_step_are_not_said_to_be_apart(leg, shared):
    measured = surae.read(shared / "gait" / "walk36.toml")
    for recording in (leg, measured):
        assert drifting_clock(*looked_at(recording)) is None
        assert lagging_stream(*looked_at(recording), None) is None


def test_a_check_says_a_late_angle_and_how_to_put_it_right(leg):
    quality = surae.check(apart(leg, "angle", late=0.2))
    (finding,) = (f for f in quality.findings if f.code == "angle-torque-lag")
    assert finding.channel == "angle"
    assert finding.value == pytest.approx(0.2, abs=0.06)
    right = apart(apart(leg, "angle", late=0.2), "angle", late=-finding.value)
    assert "angle-torque-lag" not in {f.code for f in surae.check(right).findings}


def test_that_nothing_can_be_told_of_angle_and_torque_has_a_reason(shared):
    quality = surae.check(shared / "dynamometer" / "PL_50_01.toml")
    (skipped,) = (each for each in quality.skipped if each.check == "angle-torque-lag")
    assert "too small" in skipped.reason


@pytest.mark.parametrize(("ppm", "begins"), [(2000, 0.7), (-1500, -12.0)])
def test_a_measured_trial_of_two_clocks_is_put_right_by_its_mapping(shared, tmp_path, ppm, begins):
    """Two lines of the mapping, and the EMG lies where it lay when one clock stamped all."""
    measured = surae.read(shared / "dynamometer" / "PL_50_01.toml")
    emg = measured["emg_ta"]
    since = emg.time - emg.time[0]
    for name, columns in {
        "robot": {"time_s": measured["angle"].time}
        | {r: measured[r].values for r in ("angle", "torque")},
        "emg": {"time_s": begins + since * (1.0 + 1e-6 * ppm), "TA": emg.values},
    }.items():
        head = ",".join(columns)
        rows = np.column_stack(list(columns.values()))
        np.savetxt(tmp_path / f"{name}.csv", rows, "%.17g", ",", header=head, comments="")
    mapping = tmp_path / "map.toml"
    mapping.write_text(
        "fixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }\n"
        '[channels.angle]\nfile = "robot.csv"\ncolumn = "angle"\nunit = "rad"\n'
        '[channels.torque]\nfile = "robot.csv"\ncolumn = "torque"\nunit = "Nm"\n'
        '[channels.emg_ta]\nfile = "emg.csv"\ncolumn = "TA"\nunit = "V"\n'
        f"start_s = {float(emg.time[0])!r}\nclock_ppm = {ppm}\n"
    )
    right = surae.read(mapping)
    np.testing.assert_allclose(right["emg_ta"].time, emg.time, atol=1e-6)
    np.testing.assert_array_equal(right["emg_ta"].values, emg.values)
    codes = [sorted(f.code for f in surae.check(each).findings) for each in (measured, right)]
    assert set(codes[1]) == set(codes[0]) | {"as-read"}


def test_signals_are_moved_by_a_lag_that_grows(leg):
    signals = signals_of(leg)
    there = moved(signals, 0.1, 1e-2)
    time = signals.time
    at = time + 0.1 + 1e-2 * (time - time.mean())
    for muscle, own in signals.fast.items():
        np.testing.assert_allclose(there.fast[muscle], np.interp(at, time, own))


def test_a_coefficient_beside_autocorrelated_errors_has_an_honest_interval():
    rng = np.random.default_rng(3)
    n = 600
    inside = 0
    for _ in range(60):
        columns = np.column_stack([rng.normal(size=n), np.ones(n), np.linspace(-1, 1, n)])
        noise = rng.normal(size=n + 50)
        for k in range(1, len(noise)):
            noise[k] += 0.95 * noise[k - 1]
        found = _solved(columns @ [0.3, 1.0, -2.0] + noise[50:], columns, 1.0)
        assert found is not None
        inside += abs(found.first - 0.3) <= 1.96 * found.sem
        assert found.sem < 0.1  # least squares alone would have three times that
    assert inside >= 54
