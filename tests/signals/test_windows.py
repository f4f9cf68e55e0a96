"""Long recordings are thinned to windows, by what was asked and done and not by the torque."""

from dataclasses import replace

import numpy as np
import pytest

from surae import api
from surae.recording import Channel, Recording
from surae.settings import FitSettings
from surae.signals.windows import FAMILY, ONE, are_windows, parted, thinned


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


@pytest.mark.parametrize(("family", "limits"), [(True, FAMILY), (False, ONE)])
def test_windows_are_where_much_moves_one_in_each_part(family, limits) -> None:
    longest, count, seconds = limits
    total = 2.0 * longest
    wanted = [(i + 0.5) * total / count for i in range(count)]
    recording = long(total, moving=[(w, w + seconds) for w in wanted])
    windows = thinned([recording], family)
    begins = [each.channels["angle"].time[0] for each in windows]
    assert len(windows) == count
    np.testing.assert_allclose(begins, wanted, atol=6.0)
    for each, begin in zip(windows, begins, strict=True):
        time = each.channels["angle"].time
        assert time[-1] - time[0] == pytest.approx(seconds, abs=0.1)
        assert f"long, {begin:.0f} to {begin + seconds:.0f} s" == each.name
    torque = replace(
        recording.channels["torque"], values=np.zeros(recording.channels["torque"].time.size)
    )
    other = replace(recording, channels={**recording.channels, "torque": torque})
    assert [each.name for each in thinned([other], family)] == [each.name for each in windows]


def test_what_is_not_long_is_left_whole() -> None:
    short = long(FAMILY[0] - 1.0)
    assert thinned([short, short], True) == (short, short)
    assert thinned([long(FAMILY[0] + 10.0)], False)[0].name == "long"


def test_a_fit_names_its_windows() -> None:
    inputs = api.inputs_for(FitSettings.of("muscle"), [long(ONE[0] + 100.0, rate=200.0)])
    assert len(inputs) == ONE[1]
    assert all(" to " in each.name for each in inputs)
    names = [each.name for each in inputs]
    seconds = [each.n / each.rate_hz for each in inputs]
    assert are_windows(names, seconds)
    assert not are_windows(names[1:], seconds[1:])
    assert not are_windows(["a", "b", "c"], [FAMILY[2]] * 3)  # three short trials


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
