"""What is claimed as an error was tried; noise, digits, clocks and short trials claim nothing."""

from dataclasses import replace

import numpy as np
import pytest

import surae
import surae.api
from surae.base.frozen import read_only
from surae.inference.diagnosis.quick import independent
from surae.quality import check_recording
from surae.quality.lag import LEADS, lead_of_onsets
from surae.quality.numeric import digit_of, held_for
from surae.quality.trial import signals_of
from surae.recording import Recording


@pytest.fixture(scope="module")
def leg() -> Recording:
    """An active trial of a leg of another generator, envelopes."""
    make = pytest.importorskip("ankle_legs.make")
    one = make.leg("d", 14)
    columns = one.columns(one.record(1, 35.0, "active"), 1, raw=False)
    emg = np.column_stack([v for name, v in columns.items() if name[:4] == "emg_"])
    signals = (columns[name] for name in ("time_s", "angle_rad", "torque_Nm"))
    return Recording.from_arrays(*signals, emg, emg_kind="envelope")


def changed(recording: Recording, part: str, change) -> Recording:
    channels = {
        role: replace(c, values=read_only(change(c.values))) if role.startswith(part) else c
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


def within(recording: Recording, first: float, last: float) -> Recording:
    channels = {}
    for role, c in recording.channels.items():
        inside = (c.time >= first) & (c.time < last)
        time, values = read_only(c.time[inside]), read_only(c.values[inside])
        channels[role] = replace(c, time=time, values=values)
    return replace(recording, channels=channels)


def told(recording: Recording) -> dict[str, surae.quality.Finding]:
    return {f.code: f for f in surae.check(recording).findings}


def test_samples_of_a_slow_residual_are_worth_few() -> None:
    rng = np.random.default_rng(1)
    white = rng.standard_normal(4000)
    assert independent(white) == pytest.approx(4000, rel=0.15)
    slow = np.zeros(4000)
    for k in range(1, 4000):
        slow[k] = 0.9 * slow[k - 1] + white[k]
    assert independent(slow) == pytest.approx(4000 * 0.1 / 1.9, rel=0.35)  # (1 − φ)/(1 + φ)


@pytest.mark.parametrize("lag", [-0.3, 0.0, 0.25, 0.5])
def test_onsets_say_by_how_much_emg_is_late(leg, lag) -> None:
    late = changed(leg, "emg_", lambda v: np.roll(v, round(lag * 128.0)))
    lead = lead_of_onsets(signals_of(late))
    assert lead == pytest.approx(0.18 - lag, abs=0.03)
    assert (LEADS[0] <= lead <= LEADS[1]) == (lag == 0.0)
    found = told(late)
    assert ("emg-torque-lag" in found) == (lag != 0.0)
    assert not {"angle-sign", "torque-sign", "electrodes-swapped"} & set(found)
    if lag:
        assert found["emg-torque-lag"].severity == "error"


def test_emg_without_onsets_says_nothing_of_a_lag(leg) -> None:
    rng = np.random.default_rng(2)
    noise = changed(leg, "emg_", lambda v: np.abs(rng.standard_normal(len(v))))
    assert lead_of_onsets(signals_of(noise)) is None


def test_a_lag_that_no_shift_ends_is_not_claimed(shared, tmp_path) -> None:
    """PL_100_01 is followed ever better by EMG that is ever later, its own hardly changing."""
    written = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    mapping = tmp_path / "map.toml"
    file = str(shared / "repeats" / "PL_100_01.mat")
    mapping.write_text(written.replace("PL_50_01.mat", file), encoding="utf-8")
    assert "emg-torque-lag" not in told(surae.read(mapping))


def test_of_strides_nothing_false_is_said(shared) -> None:
    for path in sorted((shared / "strides").glob("adult_*.csv")):
        quality = surae.check(path)
        codes = {f.code for f in quality.findings if f.severity != "info"}
        assert codes == {"rom-not-covered", "trial-too-short"}
        assert not quality.count("error")
        assert "angle-sign" in {skip.check for skip in quality.skipped}


def test_a_short_trial_is_not_examined_for_signs(leg) -> None:
    turned = changed(within(leg, 6.0, 10.5), "angle", np.negative)
    quality = surae.check(turned)
    assert not {"angle-sign", "torque-sign"} & {f.code for f in quality.findings}
    assert "angle-sign" in {skip.check for skip in quality.skipped}
    assert "angle-sign" in told(changed(leg, "angle", np.negative))


@pytest.mark.parametrize("wide", [1, 2])
def test_spikes_of_a_sensor_are_no_steps_and_a_step_is(leg, wide) -> None:
    rng = np.random.default_rng(3)
    at = rng.choice(np.arange(100, 4000, 40), 12, replace=False)

    def spiked(v):
        v = v.copy()
        for k in at:
            v[k : k + wide] += 0.045
        return v

    noise = [f for f in told(changed(leg, "angle", spiked)).values() if f.code == "position-steps"]
    assert [f.severity for f in noise] in ([], ["info"])  # wide ones stand beside themselves
    stepped = changed(leg, "angle", lambda v: v + 0.045 * (np.arange(v.size) > at[0]))
    assert told(stepped)["position-steps"].severity == "error"


@pytest.mark.parametrize("degrees", [0.25, 1.0])
def test_digits_of_a_recorder_are_information(leg, degrees) -> None:
    digit = np.deg2rad(degrees)
    coarse = changed(leg, "angle", lambda v: digit * np.round(v / digit))
    assert digit_of(coarse.channels["angle"].values) == pytest.approx(digit)
    assert digit_of(leg.channels["angle"].values) == 0.0
    steps = [f for f in check_recording(coarse).findings if f.code == "position-steps"]
    assert all(f.severity == "info" for f in steps)
    torque = changed(leg, "torque", lambda v: 0.25 * np.round(v / 0.25))
    assert "torque-limit" not in told(torque)


def test_values_of_a_slower_clock_are_information(leg) -> None:
    """100 Hz values, each kept until the next, in a file of 1000 Hz."""
    time = np.arange(0.0, 30.0, 1e-3)
    slow = np.floor(time * 100.0) / 100.0 + leg.channels["angle"].time[0]
    signals = {r: np.interp(slow, c.time, c.values) for r, c in leg.channels.items()}
    emg = np.column_stack([signals[f"emg_{m}"] for m in ("ta", "gl", "sol", "gm")])
    kept = Recording.from_arrays(
        time, signals["angle"], signals["torque"], emg, emg_kind="envelope"
    )
    assert held_for(signals["angle"]) == 10
    codes = {f.code: f.severity for f in check_recording(kept).findings}
    assert codes.get("position-steps", "info") == "info"
    assert "torque-limit" not in codes


@pytest.mark.parametrize(
    ("factor", "severity"), [(1e-3, "warning"), (1.0, None), (1e3, "info"), (1e6, "warning")]
)
def test_the_unit_of_all_emg_stops_nothing(leg, factor, severity) -> None:
    found = told(changed(leg, "emg_", lambda v: factor * v))
    assert getattr(found.get("emg-unit"), "severity", None) == severity
    assert "active-not-active" not in found
