"""A position in coarse steps, a torque at its limit, both filtered since: said, or not claimed."""

from functools import cache

import numpy as np
import pytest
from scipy import signal

from ankle_legs import perturbed
from perturbed_ankle import Ankle
from surae.base.words import Message
from surae.nerve.channels import without
from surae.nerve.impedance import perturbed as told_of
from surae.nerve.judged import Number
from surae.nerve.limits import repeats_its_largest
from surae.nerve.perturbed_records import ReflexPath
from surae.nerve.reflex_claim import Claimed
from surae.nerve.steps import steps_of
from surae.recording import Recording

RATE = 1000.0


def smooth(values: np.ndarray, hz: float = 60.0) -> np.ndarray:
    return signal.sosfiltfilt(signal.butter(2, hz, fs=RATE, output="sos"), values)


def in_steps(values: np.ndarray, deg: float) -> np.ndarray:
    step = np.deg2rad(deg)
    return np.round((values + 3e-4) / step) * step


def moved(levels: str, seed: int, noise: float = 1e-5) -> np.ndarray:
    """A foot that a servo turns to new levels each 0.15 to 0.4 s, within 2° [rad]."""
    draw, n = np.random.default_rng(seed), 30_000
    ends = np.cumsum(draw.uniform(0.15, 0.4, 400) * RATE).astype(int)
    any_level = draw.uniform(-0.017, 0.017, 400)
    sizes = {
        "any": any_level,
        "two": draw.choice([-0.017, 0.017], 400),
        "lattice of the command": np.round(any_level / 0.0085) * 0.0085,
    }[levels]
    told = sizes[np.searchsorted(ends, np.arange(n))]
    b, a = signal.bilinear([120.0**2], [1.0, 1.6 * 120.0, 120.0**2], RATE)
    return 0.05 + signal.lfilter(b, a, told) + noise * draw.standard_normal(n)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("deg", [0.1, 0.2])
def test_steps_are_found_though_the_position_was_smoothed(deg, seed) -> None:
    step, note = steps_of(smooth(in_steps(moved("any", seed), deg)), RATE)
    assert np.rad2deg(step) == pytest.approx(deg, rel=0.01)
    assert "before it was smoothed" in str(note)
    step, note = steps_of(in_steps(moved("any", seed), deg), RATE)
    assert np.rad2deg(step) == pytest.approx(deg, rel=0.01)
    assert "comes in steps" in str(note)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("levels", ["any", "two", "lattice of the command"])
@pytest.mark.parametrize("filtered", [False, True])
def test_no_steps_are_claimed_of_a_position_that_has_none(levels, filtered, seed) -> None:
    """Nor where a device is told few levels, or a noisy sensor is filtered."""
    angle = moved(levels, seed)
    assert steps_of(smooth(angle) if filtered else angle, RATE) == (0.0, None)


@pytest.mark.parametrize("seed", range(3))
def test_fine_steps_are_not_called_coarse(seed) -> None:
    for angle in (in_steps(moved("any", seed), 0.01), smooth(in_steps(moved("any", seed), 0.01))):
        step, note = steps_of(angle, RATE)
        assert not step > 0.0
        assert note is None or "exactly still" in str(note)


def test_two_levels_do_not_show_their_steps_but_that_they_are_no_sensors() -> None:
    step, note = steps_of(smooth(in_steps(moved("two", 1), 0.2)), RATE)
    assert np.isnan(step)
    assert "exactly still" in str(note)


@cache
def record(family: str, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict]:
    """Time, angle, torque and true measures of a leg of another simulator."""
    made = perturbed.record(family, seed)
    time, angle, torque = (made.columns[n] for n in ("time_s", "angle_rad", "torque_Nm"))
    return time, angle, torque, made.truth["measures"]


def limited(torque: np.ndarray, part: float) -> np.ndarray:
    """A torque that is at its limits for a part of the time, and then filtered."""
    cut = np.clip(torque, *np.quantile(torque, [part / 2, 1.0 - part / 2]))
    sections = signal.butter(2, 60.0, fs=RATE, output="sos")
    return signal.sosfilt(sections, cut - cut[0]) + cut[0]


@pytest.mark.parametrize("part", [0.002, 0.01, 0.04])
@pytest.mark.parametrize("every", [1, 2, 5])
def test_short_peaks_that_end_at_one_value_are_at_a_limit(part, every) -> None:
    _, _, torque, _ = record("qa", 1)
    torque = torque[::every]
    assert repeats_its_largest(np.clip(torque, *np.quantile(torque, [part / 2, 1.0 - part / 2])))


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("digit", [0.0, 0.003, 0.5])
def test_peaks_of_a_like_height_are_at_no_limit(digit, seed) -> None:
    """Steps of one size make peaks of one height, but for noise, and a recorder's digits."""
    noise = np.random.default_rng(seed)
    for torque in (record("qa", seed)[2], Ankle(noise=0.03).moved(seed)["torque"]):
        shown = torque + 0.02 * noise.standard_normal(len(torque))
        shown = digit * np.round(shown / digit) if digit else shown
        assert not repeats_its_largest(shown)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), [("qe", 1), ("qg", 2)])
def test_numbers_that_coarse_steps_would_change_are_not_told(family, seed) -> None:
    time, angle, torque, _ = record(family, seed)
    coarse = Recording.from_arrays(
        time, smooth(in_steps(angle, 0.2)), smooth(torque), name="coarse"
    )
    found = told_of(coarse)
    assert any("before it was smoothed" in note for note in found.notes)
    assert found.reflex.verdict == "cannot tell"
    for measure in found.measures.values():
        assert measure.value is None
        assert "steps are too coarse" in measure.note


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), [("qb", 1), ("qj", 1)])
def test_steps_of_unknown_size_let_no_stiffness_be_identified(family, seed) -> None:
    time, angle, torque, true = record(family, seed)
    coarse = smooth(in_steps(angle, 0.2))
    found = told_of(Recording.from_arrays(time, coarse, smooth(torque), name="two levels"))
    assert any("exactly still" in note for note in found.notes)
    stiffness = found.measures["intrinsic_stiffness"]
    low, high = stiffness.ci95
    assert low <= true["intrinsic_stiffness"] <= high
    assert stiffness.verdict != "identified"


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), [("qa", 2), ("qe", 1)])
def test_a_torque_that_was_limited_and_then_filtered_tells_stiffness_alone(family, seed) -> None:
    time, angle, torque, true = record(family, seed)
    cut = Recording.from_arrays(time, angle, limited(torque, 0.02), name="cut")
    found = told_of(cut)
    assert any("as if its channel were at its limit" in note for note in found.notes)
    low, high = found.measures["intrinsic_stiffness"].ci95
    assert low <= true["intrinsic_stiffness"] <= high
    for name, measure in found.measures.items():
        if name != "intrinsic_stiffness":
            assert measure.value is None
            assert "at its channel’s limit" in measure.note


def test_no_reflex_is_bounded_where_the_torque_was_limited() -> None:
    number = Number(70.0, 68.0, 72.0)
    claims = Claimed(
        ReflexPath("none seen", None, "at most 1 %"),
        {"intrinsic_stiffness": number, "inertia": number},
        {"reflex_share": (0.0, 1.0)},
        Message("none"),
    )
    fewer = without(claims, ["inertia", "reflex_share"], Message("at its limit"))
    assert fewer.reflex.verdict == "cannot tell"
    assert [*fewer.numbers] == ["intrinsic_stiffness"]
    assert not fewer.hidden
    assert str(fewer.refused["reflex_share"]) == "at its limit"


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), [("qa", 2), ("qc", 3), ("qg", 1), ("qh", 5)])
def test_neither_is_said_of_legs_whose_channels_are_fine(family, seed) -> None:
    """Bent stiffness, thresholds and noisy sensors are no limits."""
    time, angle, torque, _ = record(family, seed)
    found = told_of(Recording.from_arrays(time, angle, torque, name="fine"))
    assert not any("limit" in note or "steps" in note for note in found.notes)
    assert found.measures["intrinsic_stiffness"].value is not None
    assert found.measures["inertia"].value is not None
