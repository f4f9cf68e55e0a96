"""`surae.stretches`: stretches of a simulated calf, found and taken apart."""

from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

import surae
from perturbed_ankle import ramps
from surae.base.errors import InputError
from surae.base.words import Message
from surae.nerve.driven import noise_power
from surae.nerve.ramps import Stretched
from surae.recording import MUSCLES, Recording

SPEEDS = (10.0, 10.0, 60.0, 60.0, 120.0, 120.0, 180.0, 180.0)


@cache
def usual():
    """A leg with a reflex, estimated once for several tests."""
    return surae.stretches(ramps(SPEEDS, neural=6.0))


@cache
def silent():
    """The same leg without one."""
    return surae.stretches(ramps(SPEEDS))


def calf(found):
    return [s for s in found.stretches if s.direction == "dorsiflexion"]


def test_every_stretch_is_found_with_its_speed_and_ends() -> None:
    found = calf(silent())
    assert [s.speed_deg_s for s in found] == pytest.approx(SPEEDS, rel=0.05)
    assert [s.from_deg for s in found] == pytest.approx([-20.0] * 8, abs=1.5)
    assert [s.to_deg for s in found] == pytest.approx([10.0] * 8, abs=1.5)


def test_torque_is_taken_apart() -> None:
    found = calf(usual())
    assert [s.elastic_Nm for s in found] == pytest.approx([0.5236 * 20.0] * 8, rel=0.1)
    for s in found[4:]:
        low, high = s.neural_ci95
        assert low < 6.0 < high or s.neural_Nm == pytest.approx(6.0, rel=0.15)
        assert s.neural_note == "with EMG"
    assert all(s.neural_Nm == 0.0 for s in found[:2])


def test_without_emg_only_torque_that_rises_at_rest_is_probably_neural() -> None:
    found = calf(surae.stretches(ramps(SPEEDS, neural=6.0, emg=False, begins=13.0)))
    assert all(s.neural_Nm is None and s.neural_note.startswith("cannot") for s in found[:2])
    told = [s for s in found if s.neural_Nm is not None]
    assert told
    for s in told:
        assert s.neural_note.startswith("probably neural")
        assert s.neural_ci95[0] < 6.0 < s.neural_ci95[1]


@pytest.mark.parametrize("seconds", [0.05, 0.15, 0.4])
def test_tissue_that_relaxes_fast_is_never_called_neural(seconds) -> None:
    found = calf(surae.stretches(ramps(SPEEDS, emg=False, relaxes=20.0, seconds=seconds)))
    assert all(s.neural_Nm is None and s.catch_deg is None for s in found)


def test_silent_muscles_have_no_nerve() -> None:
    assert all(s.neural_Nm == 0.0 and s.catch_deg is None for s in calf(silent()))
    assert silent().threshold["gm"].angle_deg is None


def test_the_threshold_is_that_of_no_velocity() -> None:
    answered = (60.0, 60.0, 90.0, 120.0, 120.0, 180.0, 180.0)
    threshold = surae.stretches(ramps(answered, neural=6.0)).threshold["gm"]
    low, high = threshold.ci95
    assert low < 5.0 < high
    assert threshold.angle_deg == pytest.approx(5.0, abs=3.0)


def test_repeats_give_the_smallest_change_and_single_ones_none() -> None:
    some = usual().smallest_detectable_change
    assert 0.0 < some["neural_Nm"] < 3.0
    once = surae.stretches(ramps((10.0, 120.0), returning=None)).smallest_detectable_change
    assert once["neural_Nm"] is None or once["neural_Nm"] >= 0.0
    assert "elastic_Nm" not in some  # one curve for all: that repeats agree says nothing of it


def test_a_table_has_a_row_for_each_stretch() -> None:
    pytest.importorskip("pandas")
    found = silent()
    table = found.to_dataframe()
    assert len(table) == len(found.stretches) == len(found.as_table().rows)
    assert "emg_onset_gm_deg" in table


def test_no_stretch_is_said(ankle) -> None:
    with pytest.raises(InputError, match="surae impedance"):
        surae.stretches(ankle(seconds=10.0).recording())


def test_the_noise_of_an_envelope_is_its_power_not_what_comes_and_goes() -> None:
    """White noise that activity modulates: one-sided power 2/rate times the activity's square."""
    draw, rate, n = np.random.default_rng(1), 1000.0, 60_000
    time = np.arange(n) / rate
    activity = 0.1 + 1.0 * ((time % 6.0 > 2.0) & (time % 6.0 < 2.5))
    noisy = activity * (1.0 + 0.5 * draw.standard_normal(n))
    still = np.zeros(n)
    for emg, power in ((noisy, 0.25 * 2.0 / rate * np.mean(activity**2)), (activity, 0.0)):
        of = Stretched("x", rate, time, still, still, {"sol": emg}, ())
        assert noise_power([of], "sol") == pytest.approx(power, rel=0.3, abs=1e-6)


@pytest.mark.parametrize(("lasts", "every", "told"), [(0.6, None, False), (0.09, 0.18, True)])
def test_an_answer_by_will_is_no_reflex_but_clonus_is(lasts, every, told) -> None:
    """A burst that lasts in the hold may be by will; beats of clonus at 5.5 Hz may not."""
    made = ramps(SPEEDS, neural=6.0)
    t, x, torque = (made.channels[n] for n in ("angle", "angle", "torque"))
    time, emg = t.time, np.column_stack([made.channels[f"emg_{m}"].values for m in MUSCLES])
    v = np.gradient(x.values, time)
    begins = time[1:][(v[1:] > 0.3) & (v[:-1] <= 0.3)]
    late = np.zeros(len(time))
    for begin in begins[begins > 16.0]:  # in the fast ones
        for beat in range(1 if every is None else 4):
            at = begin + 0.22 + beat * (every or 0.0)
            late = np.maximum(late, 1.0 * ((time > at) & (time < at + lasts)))
    emg[:, 1:] += 5e-5 * late[:, None]
    keep = np.exp(-25.0 * (time[1] - time[0]))
    pull = lfilter([(1.0 - keep) ** 2], [1.0, -2.0 * keep, keep**2], 4.0 * late)
    found = surae.stretches(
        Recording.from_arrays(
            time,
            x.values,
            torque.values + pull,
            name="late",
            emg_kind="envelope",
            emg=emg,
        )
    )
    fast = [s for s in calf(found) if s.speed_deg_s > 100.0]
    assert len(fast) == 4
    if told:
        assert all(s.neural_note == "with EMG" for s in fast)
    else:
        assert any(s.neural_Nm is None and s.neural_note.startswith("late") for s in fast)
        assert all(s.neural_ci95[1] > 6.0 for s in fast)
        assert found.threshold["gm"].angle_deg is None
        assert isinstance(found.threshold["gm"].note, Message)  # said in the reader's language


def beside(made: Recording, torque) -> Recording:
    """A recording with torque of angle and velocity beside its own."""
    angle = made.channels["angle"]
    v = np.gradient(angle.values, angle.time)
    emg = np.column_stack([made.channels[f"emg_{m}"].values for m in MUSCLES])
    return Recording.from_arrays(
        angle.time,
        angle.values,
        made.channels["torque"].values + torque(angle.values, v),
        name="beside",
        emg_kind="envelope",
        emg=emg,
    )


def test_what_is_wrong_in_all_repeats_alike_widens_the_interval() -> None:
    """Tissue that is damped here and there is none that is fitted."""
    found = surae.stretches(
        beside(ramps(SPEEDS, neural=6.0), lambda x, v: 2.0 * v * np.cos(40 * x))
    )
    fast = calf(found)[4:]
    assert all(s.neural_ci95[0] < 6.0 < s.neural_ci95[1] for s in fast)
    half, before = (
        np.mean([np.ptp(s.neural_ci95) for s in own]) for own in (fast, calf(usual())[4:])
    )
    assert half > 1.2 * before


def test_tissue_of_another_law_is_told_as_what_it_is() -> None:
    """Damped by the root of velocity, and relaxing more where it is stiffer: both compete."""

    def relaxing(x, v):
        steep = np.exp(4.0 * x)
        keep = np.exp(-1.0 / (500.0 * 0.3))
        return 3.0 * np.sign(v) * np.sqrt(np.abs(v)) + 4.0 * lfilter(
            [keep, -keep], [1.0, -keep], steep - steep[0]
        )

    for s in calf(surae.stretches(beside(ramps(SPEEDS, neural=6.0), relaxing)))[4:]:
        assert s.neural_Nm == pytest.approx(6.0, rel=0.15)


def test_torque_that_is_no_line_over_emg_is_in_the_interval() -> None:
    """EMG that grows faster than torque (Lloyd and Besier 2003): half of it is a third of EMG."""
    made = ramps(SPEEDS, neural=6.0)
    emg = np.column_stack([made.channels[f"emg_{m}"].values for m in MUSCLES])
    t, x, torque = made.channels["angle"].time, made.channels["angle"], made.channels["torque"]
    bent = emg.max() * (emg / emg.max()) ** 1.6
    found = surae.stretches(
        Recording.from_arrays(
            t,
            x.values,
            torque.values,
            name="bent",
            emg_kind="envelope",
            emg=bent,
        )
    )
    for s in calf(found)[4:]:
        low, high = s.neural_ci95
        assert low < 6.0 < high
        assert high - low < 6.0


def test_tissue_does_not_take_what_a_noisy_emg_leaves(tmp_path) -> None:
    """A tonic reflex answers every stretch, so that tissue looks alike: once none of 20 held."""
    make, nerve = (pytest.importorskip(f"ankle_legs.{name}") for name in ("make", "nerve"))
    said = surae.stretches(make.make("sd", 62, tmp_path)).as_dict()["stretches"]
    assert not any("late" in s["neural_note"] for s in said)  # nobody answers by will
    held = [
        low <= true["neural_Nm"] <= high
        for true in nerve.truth("sd", 62)["stretches"]
        for low, high in [nerve._matched(true, said)["neural_ci95"]]
    ]
    assert len(held) == 20
    assert sum(held) >= 18
