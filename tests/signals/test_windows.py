"""Long recordings are thinned to windows, by what was asked and done and not by the torque."""

from dataclasses import replace

import numpy as np
import pytest

from surae import api
from surae.base.errors import InputError
from surae.recording import Channel, Recording
from surae.settings import FitSettings
from surae.signals import ModelInputs, inputs_as_given
from surae.signals.windows import FAMILY, LEAD_S, ONE, are_windows, parted, prepared_parts


def long(seconds, rate=50.0, moving=()):
    time = np.arange(round(seconds * rate)) / rate
    rng = np.random.default_rng(1)
    moves = sum(((time >= a) & (time < b) for a, b in moving), np.zeros(len(time), bool))
    values = {
        "angle": (0.01 + 0.3 * moves) * np.sin(2 * time),
        "torque": rng.standard_normal(len(time)),
        **{
            f"emg_{m}": 1e-5 * (1 + 9 * moves) * rng.standard_normal(len(time))
            for m in ("ta", "gl", "sol", "gm")
        },
    }
    units = {"angle": "rad", "torque": "Nm"}
    channels = {r: Channel(r, time, v, units.get(r, "V"), "made") for r, v in values.items()}
    return Recording("long", channels)


def as_given(parts) -> tuple[ModelInputs, ...]:
    """Recordings as model inputs, nothing filtered."""
    made = []
    for each in parts:
        channels = each.channels
        time = channels["angle"].time
        still = np.zeros(len(time))
        emg = np.column_stack([channels[f"emg_{m}"].values for m in ("ta", "gl", "sol", "gm")])
        motion = channels["angle"].values, still, still
        torque = channels["torque"].values
        made.append(inputs_as_given(each.name, 50.0, time, motion, emg, torque=torque))
    return tuple(made)


def fitted(recording, *, family):
    """A recording as it is fitted."""
    (made,) = prepared_parts([recording], as_given, family=family)
    return made


@pytest.mark.parametrize(("family", "limits"), [(True, FAMILY), (False, ONE)])
def test_windows_are_where_much_moves_one_in_each_part(family, limits) -> None:
    longest, count, seconds = limits
    total = 2.0 * longest
    wanted = [(i + 0.25) * total / count for i in range(count)]
    recording = long(total, moving=[(w, w + seconds) for w in wanted])
    made = fitted(recording, family=family)
    spans = made.name.removeprefix("long, ").removesuffix(" s").split(", ")
    begins = [float(span.split(" to ")[0]) for span in spans]
    np.testing.assert_allclose(begins, wanted, atol=6.0)
    for i, begin in enumerate(begins):
        assert spans[i] == f"{begin:.0f} to {begin + seconds:.0f}"
    torque = replace(
        recording.channels["torque"], values=np.zeros(recording.channels["torque"].time.size)
    )
    other = replace(recording, channels={**recording.channels, "torque": torque})
    assert fitted(other, family=family).name == made.name


@pytest.mark.parametrize(
    ("seconds", "read"), [(301.0, 300.0), (307.0, 300.0), (420.0, 375.0), (3600.0, 450.0)]
)
def test_windows_never_overlap_and_are_no_shorter_than_the_longest_whole(seconds, read) -> None:
    recording = long(seconds, moving=[(200.0, 290.0)])
    made = fitted(recording, family=True)
    signal = recording.channels["torque"].values
    counted = np.flatnonzero(np.isin(signal, made.torque[made.counts]))  # each is found once
    assert made.counted / 50.0 == pytest.approx(read, abs=0.5)
    assert read >= FAMILY[0]
    assert len(counted) == made.counted
    np.testing.assert_allclose(np.diff(made.time), 0.02, atol=1e-9)
    assert any("one after another" in str(step) for step in made.steps)


def test_what_lies_before_a_window_is_simulated_and_does_not_count() -> None:
    made = fitted(long(3600.0, moving=[(0.0, 3600.0)]), family=True)
    begins = np.flatnonzero(np.diff(made.counts.astype(int)) == 1) + 1
    ends = np.flatnonzero(np.diff(made.counts.astype(int)) == -1)
    assert len(ends) == FAMILY[1]
    for begin, end in zip(begins[-3:], ends[:3], strict=True):
        assert begin - end >= LEAD_S * 50.0


def test_model_inputs_of_an_hour_are_read_by_the_same_windows() -> None:
    recording = long(3600.0, moving=[(100.0, 3000.0)])
    (inputs,) = as_given([recording])
    (made,) = prepared_parts([inputs], tuple, family=True)
    other = fitted(recording, family=True)
    assert made.name == other.name
    np.testing.assert_array_equal(made.torque, other.torque)
    np.testing.assert_array_equal(made.weight, other.weight)


def test_what_is_not_long_is_left_whole() -> None:
    (inputs,) = as_given([long(FAMILY[0] - 1.0)])
    assert prepared_parts([inputs, inputs], tuple, family=True) == (inputs, inputs)
    assert fitted(long(FAMILY[0] + 10.0), family=False).name == "long"


def test_a_fit_names_its_windows() -> None:
    (inputs,) = api.inputs_for(FitSettings.of("muscle"), [long(ONE[0] + 100.0, rate=200.0)])
    assert inputs.name.count(" to ") == ONE[1]
    assert inputs.counted / inputs.rate_hz == pytest.approx(ONE[0], abs=1.0)
    assert are_windows(inputs)
    assert not are_windows(api.inputs_for(FitSettings.of("muscle"), [long(20.0, rate=200.0)])[0])


def test_a_stretch_between_windows_may_be_left_out() -> None:
    """It is in the recording, wherever its windows lie; a stretch outside of it is an error."""
    recording = long(ONE[0] + 600.0, rate=200.0)
    (plain,) = api.inputs_for(FitSettings.of("muscle"), [recording])
    first, second = plain.name.split(", ")[1:3]
    gap = float(first.split()[-1]) + 20.0
    assert gap + 20.0 < float(second.split()[0])
    inside = api.Weighting(windows=((gap - 40.0, gap - 30.0, 0.0), (gap, gap + 5.0, 0.0)))
    (less,) = api.inputs_for(FitSettings.of("muscle", weights=inside), [recording])
    assert less.counted == pytest.approx(plain.counted - 10.0 * plain.rate_hz, abs=2)
    outside = api.Weighting(windows=((1e5, 1.1e5, 0.0),))
    with pytest.raises(InputError, match="holds no sample"):
        api.inputs_for(FitSettings.of("muscle", weights=outside), [recording])


def with_gap(begin, end, *roles):
    """A recording of 20 s of which some channels stop for a while."""
    whole = long(20.0, rate=200.0, moving=[(0.0, 20.0)])
    channels = dict(whole.channels)
    for role in roles:
        c = channels[role]
        kept = (c.time <= begin) | (c.time >= end)
        channels[role] = replace(c, time=c.time[kept], values=c.values[kept])
    return replace(whole, channels=channels)


def test_a_recording_in_which_a_stream_stopped_is_fitted_in_parts() -> None:
    for roles in (("angle", "torque"), ("emg_ta", "emg_sol")):
        parts = parted([with_gap(8.0, 9.5, *roles)])
        times = [(p.channels["angle"].time[0], p.channels["angle"].time[-1]) for p in parts]
        np.testing.assert_allclose(times, [(0.0, 8.0), (9.5, 19.995)], atol=0.01)
        inputs = api.inputs_for(FitSettings.of("muscle"), [with_gap(8.0, 9.5, *roles)])
        assert [each.name for each in inputs] == ["long, 0 to 8 s", "long, 10 to 20 s"]
    short = parted([with_gap(1.0, 2.0, "angle")])
    assert [each.name for each in short] == ["long, 2 to 20 s"]
    for whole in (with_gap(8.0, 8.02, "angle"), long(20.0)):  # lost samples are no parts
        assert parted([whole]) == (whole,)
