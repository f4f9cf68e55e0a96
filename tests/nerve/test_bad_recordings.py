"""What is no perturbation, and what of one cannot be used: said in a line, with its remedy."""

from functools import cache

import numpy as np
import pytest
from scipy import signal

import surae
from perturbed_ankle import ramps
from surae.base.errors import InputError
from surae.nerve.piece import Piece
from surae.nerve.response import falls_short
from surae.nerve.samples import limited, usable
from surae.recording import Recording


def arrays(ankle, *, size=1.0, every=1, **parameters):
    """Time, angle and torque of a foot that is moved by `size` times 2°, each `every`-th sample."""
    moved = ankle(**parameters).moved(3)
    middle = moved["angle"].mean()
    moved["angle"] = middle + size * (moved["angle"] - middle)
    moved["torque"] = moved["torque"].mean() + size * (moved["torque"] - moved["torque"].mean())
    return [moved[name][::every] for name in ("time", "angle", "torque")]


def low(values, hz, rate):
    sections = signal.butter(2, hz, fs=rate, output="sos")
    return signal.sosfilt(sections, values - values[0]) + values[0]


def still(t, draw):
    return 5e-4 * draw.standard_normal(len(t))


def creeping(t, draw):
    return 0.01 * t / t[-1] + 1e-5 * draw.standard_normal(len(t))


def glitch(t, draw):
    return np.where(abs(t - 11.0) < 0.01, 0.05, 0.0) + 1e-5 * draw.standard_normal(len(t))


def put_in_place(t, draw):
    return np.where(t > 20.0, 0.03, 0.0) + 1e-5 * draw.standard_normal(len(t))


@pytest.mark.parametrize("rate", [100.0, 500.0, 2000.0])
@pytest.mark.parametrize("moves", [still, creeping, glitch, put_in_place])
def test_a_foot_that_stays_or_moves_once_does_not_move(moves, rate) -> None:
    t, draw = np.arange(0.0, 40.0, 1.0 / rate), np.random.default_rng(1)
    with pytest.raises(InputError, match=r"does not move.*surae protocol prbs"):
        usable("x", t, moves(t, draw), 0.1 * draw.standard_normal(len(t)))


@pytest.mark.parametrize(("size", "every"), [(0.5, 1), (1.0, 2), (4.0, 5)])
@pytest.mark.parametrize("hz", [0.5, 1.5, 2.5])
def test_a_slow_device_has_too_little_bandwidth_whatever_its_size_and_rate(
    ankle, size, every, hz
) -> None:
    t, angle, torque = arrays(ankle, size=size, every=every)
    rate, draw = 500.0 / every, np.random.default_rng(2)
    angle = low(angle, hz, rate) + 5e-5 * draw.standard_normal(len(t))
    with pytest.raises(InputError, match=r"hardly faster.*bandwidth.*holds still"):
        usable("x", t, angle, low(torque, hz, rate))


@pytest.mark.parametrize("hz", [4.0, 6.5, 9.0])
def test_a_tremor_or_tapping_of_one_frequency_is_no_perturbation(hz) -> None:
    t = np.arange(0.0, 40.0, 0.002)
    phase = 2.0 * np.pi * hz * t + 2.0 * np.sin(0.4 * t)
    with pytest.raises(InputError, match="or a movement by will"):
        usable("x", t, 0.02 * np.sin(phase), 0.5 * np.sin(phase + 1.0))


@pytest.mark.parametrize("to", ["first", "last"])
def test_a_torque_that_is_not_there_at_an_end_is_not_made_up(ankle, to) -> None:
    t, angle, torque = arrays(ankle)
    gone = t < 10.0 if to == "first" else t > 30.0
    samples = usable("x", t, angle, np.where(gone, np.nan, torque))
    assert samples.seconds == pytest.approx(30.0, abs=0.01)
    assert samples.notes[0] == "Left out: 10 s without samples."


def test_single_samples_that_are_missing_are_bridged_and_long_gaps_name_their_remedy(ankle) -> None:
    t, angle, torque = arrays(ankle)
    draw = np.random.default_rng(4)
    some = draw.choice(len(t), 200, replace=False)
    samples = usable("x", t, angle, np.where(np.isin(np.arange(len(t)), some), np.nan, torque))
    assert samples.seconds == pytest.approx(40.0, abs=0.5)
    assert (
        np.abs(samples.torque[some] - torque[some])[np.isfinite(samples.torque[some])].max() < 1.0
    )
    with pytest.raises(InputError, match="look why samples are missing"):
        usable("x", t, angle, np.where(t % 3.0 < 0.2, np.nan, torque))


@pytest.mark.parametrize("part", [0.05, 0.25])
@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_a_torque_at_its_limit_is_told_though_noise_lies_on_it(ankle, part, noise) -> None:
    t, angle, torque = arrays(ankle, noise=0.03)
    ends = np.quantile(torque, (part, 1.0 - part))
    torque = np.clip(torque, *ends) + noise * np.random.default_rng(5).standard_normal(len(t))
    with pytest.raises(InputError, match=r"at its limit.*raise the range"):
        usable("x", t, angle, torque)


@pytest.mark.parametrize("seed", range(4))
def test_a_torque_that_has_room_is_not_said_to_be_limited(ankle, seed) -> None:
    moved = ankle(seconds=40.0, noise=0.02 * seed + 0.005, switch=0.15 + 0.1 * seed).moved(seed)
    samples = usable("x", moved["time"], moved["angle"], moved["torque"])
    assert samples.notes == ()


@pytest.mark.parametrize("what", ["one sample", "digits", "rest"])
def test_a_largest_value_of_one_sample_of_digits_or_of_rest_is_no_limit(ankle, what) -> None:
    moved = ankle(seconds=40.0, noise=0.02, switch=0.2).moved(1)
    angle, torque = np.array(moved["angle"]), np.array(moved["torque"])
    if what == "one sample":
        torque[4000] = torque.max() + 0.5 * np.ptp(torque)
    elif what == "digits":
        digit = np.ptp(torque) / 30.0
        torque = digit * np.round(torque / digit)
    else:
        still = np.arange(len(torque)) < 1500
        torque[still], angle[still] = torque.max(), angle[1500]
    assert not limited(angle, torque).any()


@pytest.mark.parametrize("seconds", [1.0, 2.0, 6.0])
def test_contact_is_lost_though_the_plate_has_inertia(ankle, seconds) -> None:
    t, angle, torque = arrays(ankle, noise=0.03)
    plate = 0.004 * np.gradient(np.gradient(low(angle, 60.0, 500.0), t), t) - 2.0
    lost = (t > 14.0) & (t < 14.0 + seconds)
    samples = usable("x", t, angle, np.where(lost, plate, torque))
    inside = slice(int(14.1 * 500), int((13.9 + seconds) * 500))
    assert all(span.stop <= inside.start or span.start >= inside.stop for span in samples.spans)
    assert 40.0 - samples.seconds < seconds + 1.5
    assert "contact lost" in samples.notes[0]


def test_torque_that_is_cut_and_filtered_stays_behind_and_other_torque_does_not(ankle) -> None:
    t, angle, torque = arrays(ankle, seconds=12.0, noise=0.02)
    cut = low(np.clip(torque, *np.quantile(torque, (0.2, 0.8))), 60.0, 500.0)
    whole, less = (
        Piece(t, angle, each, 500.0, 40.0, anchor=0.1, span=(0.0, 12.0)) for each in (torque, cut)
    )
    scale = np.std(cut) / np.std(torque)
    assert falls_short([whole], [whole.torque]) == 0.0
    assert falls_short([less], [scale * whole.torque]) > 0.15


@cache
def stretched():
    """A recording of stretches, and where the first fast one begins [s]."""
    recording = ramps((10.0, 10.0, 120.0, 120.0), neural=6.0)
    return recording, surae.stretches(recording).stretches[4].start_s


@pytest.mark.parametrize("column", ["angle", "torque"])
def test_stretches_are_not_made_of_gaps(column, tmp_path) -> None:
    recording, at = stretched()
    x, y = (recording.channels[name].values for name in ("angle", "torque"))
    t = recording.channels["angle"].time
    values = {"angle": x.copy(), "torque": y.copy()}
    values[column][(t > at - 0.2) & (t < at + 0.2)] = np.nan
    path = tmp_path / "gap.csv"
    rows = zip(t, *(values[n] for n in ("angle", "torque")), strict=True)
    path.write_text(
        "time_s,angle_rad,torque_Nm\n"
        + "".join(",".join("" if np.isnan(v) else f"{v:.6f}" for v in row) + "\n" for row in rows),
        "utf-8",
    )
    found = surae.stretches(path)
    assert not [s for s in found.stretches if abs(s.start_s - at) < 0.5]
    assert "stretches left out with it: 1" in found.notes[0]
    assert found.notes[0] in found.as_table().below


def test_stretches_whose_torque_is_at_its_limit_are_left_out() -> None:
    recording, _ = stretched()
    x, y = (recording.channels[n].values for n in ("angle", "torque"))
    limit = np.quantile(y, 0.98)
    found = surae.stretches(
        Recording.from_arrays(recording.channels["angle"].time, x, np.minimum(y, limit), name="x")
    )
    assert "at its limit" in found.notes[0]
    assert all(s.peak_torque_Nm < np.ptp(y) for s in found.stretches)
