"""What samples count: windows of time, peaks of torque and EMG."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.signals import ModelInputs, Weighting, settled, weighted
from surae.signals.weighting import activity


def trial(**changes: object) -> ModelInputs:
    """Ten seconds at 100 Hz: torque 1 Nm, 50 Nm from 4 to 6 s; EMG of SOL from 7 to 9 s."""
    time = np.arange(1000) / 100.0
    zeros = np.zeros(1000)
    emg = np.zeros((1000, 4))
    emg[700:900, 2] = 3e-4
    torque = np.where((time >= 4) & (time < 6), 50.0, 1.0)
    inputs = ModelInputs(
        "t", 100.0, read_only(time), zeros, zeros, zeros, read_only(emg), "V", read_only(torque)
    )
    return replace(inputs, **changes)  # type: ignore[arg-type]


def one(weighting: Weighting, **changes: object) -> ModelInputs:
    (made,) = weighted([trial(**changes)], weighting)
    return made


def test_windows_include_both_ends_and_multiply() -> None:
    made = one(Weighting(windows=((1.0, 2.0, 0.0), (5.0, 8.0, 3.0), (7.0, math.inf, 0.5))))
    expected = np.ones(1000)
    expected[100:201] = 0.0
    expected[500:801] *= 3.0
    expected[700:] *= 0.5
    assert_array_equal(made.weight, expected)
    assert made.emphasised
    assert not made.weight.flags.writeable
    assert made.steps == (
        "Weights: 1 … 2 s left out of the fit.",
        "Weights: 5 … 8 s counts 3 times.",
        "Weights: 7 … the end counts 0.5 times.",
    )


def test_leaving_out_alone_is_no_emphasis() -> None:
    made = one(Weighting(windows=((-math.inf, 2.0, 0.0),)))
    assert not made.emphasised
    assert made.counted == 799
    assert made.steps == ("Weights: the beginning … 2 s left out of the fit.",)


def test_weights_of_the_recording_stay() -> None:
    before = np.where(np.arange(1000) < 50, 0.0, 2.0)
    made = one(Weighting(windows=((1.0, 2.0, 2.0),)), weight=before)
    assert_array_equal(made.weight[:50], 0.0)
    assert_array_equal(made.weight[50:100], 2.0)
    assert_array_equal(made.weight[100:201], 4.0)


def test_a_peak_counts_so_many_times_as_much_as_rest() -> None:
    made = one(Weighting(peaks=9.0))
    assert made.weight.mean() == pytest.approx(1.0)
    # Rest has 1/50 of the peak's torque.
    assert made.weight[500] / made.weight[100] == pytest.approx(10.0 / (1 + 9 / 50))
    assert (np.diff(made.weight[350:450]) >= -1e-12).all()
    assert made.emphasised


def test_peaks_of_emg_are_those_of_the_muscles_recorded() -> None:
    made = one(Weighting(peaks=4.0, activity="emg"), missing_emg=("ta", "gl"))
    assert made.weight[800] / made.weight[100] == pytest.approx(5.0)
    assert made.weight[500] == pytest.approx(made.weight[100])


def test_an_artefact_is_no_higher_than_a_peak() -> None:
    torque = trial().torque.copy()
    torque[50:53] = -431.0
    level = activity(trial(torque=torque), "torque")
    assert level.max() == 1.0
    assert level[500] == pytest.approx(1.0)


def test_weights_do_not_follow_the_noise() -> None:
    noise = np.random.default_rng(1).standard_normal(1000)
    level = activity(trial(torque=trial().torque + 10 * noise), "torque")
    peak = slice(425, 575)
    assert np.corrcoef(level[peak], noise[peak])[0, 1] < 0.35
    assert level[peak].min() > 0.8


def test_a_silent_recording_has_no_peaks() -> None:
    assert_allclose(activity(trial(torque=np.zeros(1000)), "torque"), 0.0)


def test_shared_windows_may_miss_some_recordings_but_not_all() -> None:
    late = trial(time=read_only(trial().time + 100.0))
    first, second = weighted([trial(), late], Weighting(windows=((1.0, 2.0, 0.0),)))
    assert first.counted == 899
    assert second is late
    with pytest.raises(InputError, match=r"window 50 … 60 s holds no sample \(t: 0 … 9.99 s, t: "):
        weighted([trial(), late], Weighting(windows=((50.0, 60.0, 0.0),)))
    with pytest.raises(InputError, match="holds no sample"):
        weighted([trial(), late], [Weighting(), Weighting(windows=((1.0, 2.0, 0.0),))])


def test_each_recording_may_have_its_own() -> None:
    first, second = weighted([trial(), trial()], [Weighting(), Weighting(((1.0, 2.0, 0.0),))])
    assert first.weight is None
    assert second.counted == 899
    with pytest.raises(InputError, match="1 weightings for 2 recordings"):
        weighted([trial(), trial()], [Weighting()])


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"windows": ((2.0, 1.0, 0.0),)}, "end must follow its start"),
        ({"windows": ((1.0, 2.0, -1.0),)}, "weight is -1"),
        ({"windows": ((1.0, 2.0, math.inf),)}, "weight is inf"),
        ({"windows": ((1.0, math.nan, 0.0),)}, "give a start, an end"),
        ({"windows": ((1.0, 2.0),)}, "give a start, an end"),
        ({"windows": ("1:2",)}, "give a start, an end"),
        ({"peaks": -1.0}, "peaks is -1"),
        ({"peaks": math.inf}, "peaks is inf"),
        ({"peaks": True}, "peaks is True"),
        ({"activity": "angle"}, "use one of: torque, emg"),
    ],
)
def test_what_has_no_meaning(given, complaint) -> None:
    with pytest.raises(InputError, match=complaint):
        Weighting(**given)


def test_nothing_left_or_nothing_to_weigh_by() -> None:
    with pytest.raises(InputError, match="leave no sample to count"):
        one(Weighting(windows=((-math.inf, math.inf, 0.0),)))
    with pytest.raises(InputError, match="no torque whose peaks"):
        one(Weighting(peaks=1.0), torque=None)
    with pytest.raises(InputError, match="no EMG whose peaks"):
        one(Weighting(peaks=1.0, activity="emg"), missing_emg=("ta", "gl", "sol", "gm"))


def begins(level: float, *, steady: float = 0.0) -> ModelInputs:
    """A burst in the middle, over noise, of a recording that begins at a part of its height."""
    t = np.arange(0.0, 10.0, 0.01)
    noise = np.abs(np.random.default_rng(3).standard_normal((len(t), 4)))
    burst = np.maximum(np.exp(-(((t - 5.0) / 0.8) ** 2)), level * (t < 1.0))
    emg = 1e-6 * noise + np.outer(1e-4 * burst * (steady == 0.0) + steady, [1.0, 0.5, 0.0, 1.0])
    return trial(emg=emg)


def test_nothing_counts_until_an_effort_from_before_the_recording_is_forgotten() -> None:
    rest, active = settled([begins(0.0), begins(0.4)])
    assert rest.weight is None
    assert rest.steps == ()
    assert np.flatnonzero(active.counts)[0] == 71
    assert not active.emphasised
    assert "what their EMG was before" in active.steps[-1]


def test_steady_emg_and_short_recordings_count_whole() -> None:
    assert settled([begins(0.0, steady=1e-4)])[0].weight is None
    short = begins(0.4)
    cut = {name: getattr(short, name)[:250] for name in ("time", "emg")}
    assert settled([replace(short, **cut)])[0].weight is None


def stride(seconds: float = 1.1, last: float = 0.0) -> ModelInputs:
    """A cycle in an effort that ends as it began, its last angle off by a part of its range."""
    t = np.arange(0.0, seconds, 0.01)
    phase = 2.0 * np.pi * t / t[-1]
    angle = 0.2 * np.sin(phase)
    angle[-1] += 0.4 * last
    level = 1e-4 * (1.0 + 0.8 * np.cos(phase))
    return replace(
        trial(emg=np.outer(level, np.ones(4))),
        time=t,
        angle=angle,
        velocity=np.gradient(angle, 0.01),
        acceleration=np.zeros_like(t),
        torque=20.0 * np.sin(phase),
    )


def test_a_stride_has_its_end_before_it() -> None:
    (made,) = settled([as_it_is := stride()])
    assert made.n == as_it_is.n + 70
    assert np.array_equal(made.counts, np.arange(made.n) >= 70)
    np.testing.assert_array_equal(made.emg[:70], as_it_is.emg[-71:-1])
    np.testing.assert_array_equal(made.angle[70:], as_it_is.angle)
    np.testing.assert_allclose(np.diff(made.time), 0.01)
    assert "ends as it began" in str(made.steps[-1])


def test_a_piece_that_ends_elsewhere_counts_as_it_is() -> None:
    assert settled([elsewhere := stride(last=0.2)])[0] is elsewhere
    drifted = stride()
    drifted = replace(drifted, torque=drifted.torque + np.linspace(0.0, 9.0, drifted.n))
    assert settled([drifted])[0] is drifted
