"""The relaxed leg: what rest tells of a known ankle, what it must not say, what changes nothing."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from relaxed_ankle import Ankle, efforts, measured, movement, slow_lags, with_emg
from surae.base.errors import InputError
from surae.inference import Grade
from surae.inference.relaxed.rest import rest_of
from surae.model.knowledge import Knowledge, Plate
from surae.model.statements import StatedZero
from surae.signals.windows import liveliest

ANGLES = (-10.0, 0.0, 10.0)


@pytest.fixture(scope="module")
def plain():
    return surae.relaxed(measured())


def holds(measure, truth):
    low, high = measure.ci95
    return low <= truth <= high


def codes(found):
    return [finding.code for finding in found.findings]


@pytest.mark.parametrize("seed", range(4))
def test_a_tissue_with_a_toe_is_measured(seed) -> None:
    ankle = Ankle(toe=-20.0 + 4.0 * seed, stiff=0.15 + 0.1 * seed)
    m = surae.relaxed(measured(ankle, seed)).measures
    for angle in ANGLES:
        stiffness = m[f"passive_stiffness@{angle:g}deg"]
        assert holds(stiffness, ankle.stiffness(angle))
        assert stiffness.basis == "rest"
        assert stiffness.ci95_device[0] >= stiffness.ci95[0] - 0.01
    assert holds(m["torque_rise"], ankle.torque(20.0) - ankle.torque(-40.0))
    assert m["torque_rise"].value == pytest.approx(
        ankle.torque(20.0) - ankle.torque(-40.0), rel=0.15
    )
    assert holds(m["end_stiffness"], (ankle.torque(20.0) - ankle.torque(10.0)) / 10.0)
    assert holds(m["relaxed_share@10s"], 100.0 * 0.3 / 1.3)


def test_the_slow_stretch_is_the_products(plain) -> None:
    ankle = Ankle()
    degrees = np.arange(-30.0, 15.0, 0.02)
    elastic = ankle.torque(degrees)
    torque = elastic + slow_lags(elastic, 5.0 / 0.02)
    for angle in ANGLES:
        low, at, high = np.interp([angle - 1.0, angle, angle + 1.0], degrees, torque)
        slow = plain.measures[f"slow_stiffness@{angle:g}deg"]
        assert holds(slow, (high - low) / 2.0)
        assert slow.value > plain.measures[f"passive_stiffness@{angle:g}deg"].value
        assert holds(plain.measures[f"slow_torque@{angle:g}deg"], at)


def test_range_and_stiffness_at_a_torque_are_of_one_angle(plain) -> None:
    ankle = Ankle()
    at = plain.measures["range_at_torque@5Nm"]
    degrees = np.arange(-40.0, 20.0, 0.01)
    assert holds(at, float(np.interp(5.0, ankle.torque(degrees), degrees)))
    beyond = plain.measures["range_at_torque@15Nm"]
    assert beyond.value is None
    assert beyond.note.code == "none/rest-torque"


def test_the_curve_gives_what_the_measures_say(plain) -> None:
    curve = plain.curve
    mean, covariance = curve.stiffness([0.0, 10.0])
    assert mean[1] == pytest.approx(plain.measures["passive_stiffness@10deg"].value, rel=0.03)
    assert np.all(np.linalg.eigvalsh(covariance) > 0.0)
    slow, _ = curve.slow_stiffness(10.0)
    assert slow[0] == pytest.approx(plain.measures["slow_stiffness@10deg"].value, rel=0.03)
    torque, _ = curve.torque([10.0 - 1e-3, 10.0 + 1e-3])
    assert mean[1] == pytest.approx((torque[1] - torque[0]) / 2e-3, rel=1e-5)
    drawn = curve.curve_draws([-10.0, 10.0], 4000)
    rises = drawn[:, 1] - drawn[:, 0]
    (low, high), V = curve.torque([-10.0, 10.0])
    assert rises.mean() == pytest.approx(high - low, rel=0.03)
    assert rises.std() == pytest.approx(np.sqrt(V[0, 0] + V[1, 1] - 2.0 * V[0, 1]), rel=0.15)


def test_effort_is_no_rest_nor_what_is_near_it() -> None:
    time, _ = movement()
    inputs = surae.prepare(measured(emg=efforts(time, (10.0, 30.0))))
    rest = rest_of([inputs])
    assert rest.by == "emg"
    mask = rest.masks[0]
    for start in (10.0, 30.0):
        near = (inputs.time > start - 0.2) & (inputs.time < start + 2.0 + 1.2)
        assert not mask[near].any()
    assert mask[(inputs.time > 15.0) & (inputs.time < 29.0)].all()


def test_a_working_calf_does_not_change_the_curve() -> None:
    time, _ = movement()
    emg = efforts(time, (8.0, 26.0, 51.0))
    beside = 3e5 * emg[:, 2]
    own = surae.relaxed(measured(emg=emg, beside=beside)).measures
    stiffness = own["passive_stiffness@10deg"]
    assert holds(stiffness, Ankle().stiffness(10.0))
    assert stiffness.value == pytest.approx(Ankle().stiffness(10.0), rel=0.2)


# What must not be said, or is said


def test_torque_that_no_electrode_shows_is_doubted() -> None:
    time, _ = movement()
    beside = 3e4 * efforts(time, (8.0, 18.0, 26.0, 42.0, 51.0))[:, 2]
    found = surae.relaxed(measured(beside=beside))
    assert found.curve.grade is Grade.DOUBTFUL
    assert "relaxed/noisy" in codes(found)
    assert not any(m.verdict == "identified" for m in found.measures.values())


def test_a_tone_that_does_not_stop_is_no_rest() -> None:
    time, _ = movement()
    tonic = np.full((len(time), 4), 2e-5)
    working = measured(emg=efforts(time, (8.0, 26.0), top=3e-4), name="active")
    toned = measured(emg=tonic, beside=0.6, name="toned")
    found = surae.relaxed([working, toned])
    assert "relaxed/tone" in codes(found)
    assert [trial.seconds > 0.0 for trial in found.curve.trials] == [True, False]
    alone = surae.relaxed(working)
    assert "relaxed/tone" not in codes(alone)


def toned(torque):
    """A calf that works by some hundredths of its largest, and never lets go, and what it pulls."""
    time, _ = movement()
    emg = efforts(time, (8.0, 26.0, 51.0), top=3e-4)
    tone = 3.0e-6 * (1.0 + np.sin(2.0 * np.pi * time / 9.0) * np.sin(2.0 * np.pi * time / 2.3))
    tone[time < 3.0] = 0.0
    emg[:, 1:] += tone[:, None]
    beside = 3e5 * efforts(time, (8.0, 26.0, 51.0), top=3e-4)[:, 2] + torque * tone / 3e-6
    return measured(emg=emg, beside=beside, name="toned")


def test_a_little_tone_is_said_and_taken_off() -> None:
    found = surae.relaxed(toned(1.0))
    assert "relaxed/tone_calf" in codes(found)
    assert "relaxed/tone_tibialis" not in codes(found)
    stiffness = found.measures["passive_stiffness@10deg"]
    assert holds(stiffness, Ankle().stiffness(10.0))
    assert stiffness.value == pytest.approx(Ankle().stiffness(10.0), rel=0.15)


def test_emg_at_rest_that_pulls_nothing_is_no_tone() -> None:
    found = surae.relaxed(toned(0.0))
    assert not [code for code in codes(found) if code.startswith("relaxed/tone_")]


def test_a_step_of_the_zero_is_found_and_taken_off(plain) -> None:
    time, _ = movement()
    found = surae.relaxed(measured(beside=1.5 * (time > 30.3)))
    (step,) = found.curve.steps
    assert step.kind == "step"
    assert step.time == pytest.approx(30.3, abs=0.3)
    assert step.value == pytest.approx(1.5, abs=0.3)
    assert "relaxed/step" in codes(found)
    for name in ("passive_stiffness@10deg", "torque_rise"):
        assert found.measures[name].value == pytest.approx(plain.measures[name].value, rel=0.1)
    assert not plain.curve.steps


def test_a_heavy_plate_is_said_and_a_tared_one_is_not() -> None:
    heavy = measured(Ankle(weight=7.5, inertia=0.1))
    assert {"relaxed/plate", "relaxed/heavy"} & {*codes(surae.relaxed(heavy))}
    known = surae.relaxed(measured(), knowledge=Knowledge(plate=Plate()))
    assert not {"relaxed/plate", "relaxed/heavy"} & {*codes(known)}
    assert known.curve.readings["plate"] == 0.0


def test_a_reflex_in_fast_stretches_is_said() -> None:
    assert "relaxed/reflex" in codes(surae.relaxed(measured(Ankle(reflex=3.0))))


def test_no_reflex_is_said_where_there_is_none(plain) -> None:
    assert "relaxed/reflex" not in codes(plain)
    assert plain.curve.grade is Grade.ADEQUATE


def test_a_short_rest_is_doubted() -> None:
    found = surae.relaxed(measured().crop(0.0, 9.0))
    assert "relaxed/short" in codes(found)
    assert found.curve.grade is Grade.DOUBTFUL


def test_what_rest_did_not_pass_is_withheld() -> None:
    time, degrees = movement()
    emg = efforts(time, (5.0, 7.0, 9.0, 11.0, 13.0))  # as the ankle comes by
    only = measured(emg=emg).crop(0.0, 21.0)
    m = surae.relaxed(only, angles=(-10.0,)).measures
    assert m["passive_stiffness@-10deg"].value is None
    assert m["passive_stiffness@-10deg"].note.code == "none/rest-not-passed"
    low = measured(moved=(time, np.minimum(degrees, 5.0)))
    away = surae.relaxed(low, angles=(15.0,)).measures["passive_stiffness@15deg"]
    assert away.value is None
    assert away.note.code == "none/rest-beyond"


def test_a_leg_that_never_rests_is_refused_in_one_line() -> None:
    time, _ = movement()
    emg = np.repeat(1e-4 * np.abs(np.sin(2.0 * np.pi * time))[:, None], 4, axis=1)
    with pytest.raises(InputError, match="at rest for a second"):
        surae.relaxed(measured(emg=emg))


# What is known


def test_a_stated_zero_turns_the_curve() -> None:
    zero = StatedZero(value=5.0, sd=0.5)
    known = surae.relaxed(measured(), angles=(10.0,), knowledge=Knowledge(angle_zero_deg=zero))
    free = surae.relaxed(measured(), angles=(5.0,))
    name = "passive_stiffness@{:g}deg".format
    assert known.measures[name(10.0)].value == pytest.approx(
        free.measures[name(5.0)].value, rel=1e-6
    )
    assert known.curve.zero_deg == 5.0


# What changes nothing


def same(one, two, part):
    """Whether all measures agree within a part of their half-widths."""
    assert one.findings == two.findings
    for name, m in one.measures.items():
        other = two.measures[name]
        assert (m.value is None) == (other.value is None), name
        if m.value is not None:
            half = 0.5 * (m.ci95[1] - m.ci95[0])
            assert abs(m.value - other.value) <= part * half, name


@pytest.fixture(scope="module")
def active():
    time, _ = movement()
    emg = efforts(time, (8.0, 26.0, 51.0))
    return measured(emg=emg, beside=3e5 * emg[:, 2], name="active")


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_the_scale_of_emg(active, factor) -> None:
    same(surae.relaxed(active), surae.relaxed(with_emg(active, factor)), 1e-6)


def test_order_of_trials(active) -> None:
    other = measured(seed=5, name="other")
    same(surae.relaxed([active, other]), surae.relaxed([other, active]), 0.02)


def test_twice_the_rate_by_interpolation(plain) -> None:
    recording = measured()
    channels = {}
    for role, c in recording.channels.items():
        time = np.linspace(c.time[0], c.time[-1], 2 * len(c.time) - 1)
        channels[role] = replace(c, time=time, values=np.interp(time, c.time, c.values))
    same(plain, surae.relaxed(replace(recording, channels=channels)), 0.1)


def test_an_unused_electrode(active) -> None:
    channels = {r: c for r, c in active.channels.items() if r != "emg_ta"}
    same(surae.relaxed(active), surae.relaxed(replace(active, channels=channels)), 0.02)


def test_another_clock(active) -> None:
    channels = {r: replace(c, time=c.time + 100.0) for r, c in active.channels.items()}
    same(surae.relaxed(active), surae.relaxed(replace(active, channels=channels)), 0.02)


def test_a_trial_cut_in_two(plain) -> None:
    whole = measured()
    halves = [
        replace(whole.crop(0.0, 38.0), name="first"),
        replace(whole.crop(38.01, 60.0), name="second"),
    ]
    two = surae.relaxed(halves)
    for name in ("passive_stiffness@0deg", "passive_stiffness@10deg", "torque_rise"):
        one = plain.measures[name]
        half = 0.5 * (one.ci95[1] - one.ci95[0])
        assert abs(two.measures[name].value - one.value) < 0.5 * half, name


@pytest.fixture(scope="module")
def long():
    """Seven minutes of slow ramps, efforts between them."""
    time = np.arange(420 * 64) / 64.0
    degrees = -10.0 + 30.0 * np.sin(2.0 * np.pi * time / 30.0)
    emg = efforts(time, np.arange(10.0, 410.0, 55.0))
    beside = 3e5 * emg[:, 2]
    return measured(emg=emg, beside=beside, moved=(time, degrees), name="long")


def test_a_long_recording_is_used_whole(long) -> None:
    found = surae.relaxed(long)
    assert found.curve.seconds > 340.0
    for angle in ANGLES:
        assert holds(found.measures[f"passive_stiffness@{angle:g}deg"], Ankle().stiffness(angle))
    windows = surae.relaxed(liveliest(long, 3, 20.0))
    assert windows.curve.seconds < 60.0
    for name in ("passive_stiffness@10deg", "torque_rise", "end_stiffness"):
        of_some = windows.measures[name]
        assert of_some.ci95[0] <= found.measures[name].value <= of_some.ci95[1], name


def test_holds_of_several_trials_tell_with_one_zero() -> None:
    ankle = Ankle(noise=0.05)
    time = np.arange(15 * 128) / 128.0
    trials = [
        measured(ankle, seed, moved=(time, np.full(len(time), at)), name=f"at {at:g}")
        for seed, at in enumerate((-25.0, -15.0, -5.0, 0.0, 5.0, 10.0, 18.0))
    ]
    mean, V = surae.relaxed(trials).curve.torque([0.0, 18.0])
    sd = np.sqrt(V[0, 0] + V[1, 1] - 2.0 * V[0, 1])
    assert abs(mean[1] - mean[0] - (ankle.torque(18.0) - ankle.torque(0.0))) < 2.0 * sd
    assert sd < 1.5


def holding(*degrees):
    """The relaxed ankle held at angles, a trial each."""
    time = np.arange(20 * 64) / 64.0
    return [
        measured(Ankle(noise=0.05), k, moved=(time, np.full(len(time), at)), name=f"at {at:g}")
        for k, at in enumerate(degrees)
    ]


def test_one_hold_tells_nothing_of_a_curve() -> None:
    found = surae.relaxed(holding(5.0))
    assert {m.value for m in found.measures.values()} == {None}
    assert {m.note.code for m in found.measures.values()} == {"none/rest-one"}


def test_holds_alone_tell_a_slope_and_nothing_that_relaxes() -> None:
    ankle = Ankle()
    m = surae.relaxed(holding(-5.0, 5.0, 15.0)).measures
    assert holds(m["end_stiffness"], (ankle.torque(15.0) - ankle.torque(5.0)) / 10.0)
    assert holds(m["torque_rise"], ankle.torque(15.0) - ankle.torque(-5.0))
    for name in ("relaxed_share@10s", "hysteresis"):
        assert m[name].note.code == "none/rest-still"


def test_trials_with_zeros_of_their_own_are_said() -> None:
    one = measured(name="one")
    other = measured(Ankle(zero=-3.0), seed=3, name="other")
    assert "relaxed/apart" in codes(surae.relaxed([one, other]))
    alike = measured(seed=3, name="other")
    assert "relaxed/apart" not in codes(surae.relaxed([one, alike]))
