"""Strength by maximal efforts: what was put into a trial, and what differs between two of them."""

import math

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.measures.strength import strength_change, strength_of
from surae.trials.strength import Effort, efforts_of

RATE = 128.0


def maximal(
    sizes: tuple[float, ...] = (40.0, 44.0, 38.0),
    *,
    group: str = "tri",
    degrees: float = 0.0,
    swings: float = 0.0,
    torque_at_rest: float = 7.0,
    seed: int = 0,
) -> surae.ModelInputs:
    """A trial with efforts of so many Nm, three seconds each, rests of three between."""
    rng = np.random.default_rng(seed)
    seconds = 3.0 + 6.0 * len(sizes)
    time = np.arange(0.0, seconds, 1.0 / RATE)
    level = np.zeros_like(time)
    for k, size in enumerate(sizes):
        inside = (time > 3.0 + 6.0 * k) & (time < 6.0 + 6.0 * k)
        level[inside] = size
    sign = 1.0 if group == "tri" else -1.0
    emg = np.full((len(time), 4), 2e-6)
    emg[:, slice(1, 4) if group == "tri" else slice(0, 1)] += 1e-5 * level[:, None]
    angle = np.radians(degrees + swings * np.sin(time))
    return surae.ModelInputs(
        name="max-1",
        rate_hz=RATE,
        time=read_only(time),
        angle=read_only(angle),
        velocity=read_only(np.gradient(angle, 1.0 / RATE)),
        acceleration=read_only(np.zeros_like(time)),
        emg=read_only(emg * rng.uniform(0.98, 1.02, emg.shape)),
        emg_unit="V",
        torque=read_only(torque_at_rest + sign * level + 0.1 * rng.standard_normal(len(time))),
        prepared=True,
    )


@pytest.mark.parametrize("group", ["tri", "tib"])
def test_efforts_are_what_was_pulled_whatever_the_sensor_shows_at_rest(group: str) -> None:
    for zero in (-30.0, 0.0, 25.0):
        told = efforts_of([maximal(group=group, torque_at_rest=zero)])
        assert [each.group for each in told] == [group] * 3
        assert [each.torque for each in told] == pytest.approx([40.0, 44.0, 38.0], abs=0.2)


def test_a_trial_that_moves_or_in_which_nobody_pulls_has_no_effort() -> None:
    assert efforts_of([maximal(swings=15.0)]) == ()
    assert efforts_of([maximal(sizes=(0.5, 0.4))]) == ()


def test_the_best_effort_is_the_strength_and_repeats_say_how_sure() -> None:
    def of(*torques: float) -> list[Effort]:
        return [Effort("max", "tri", each, 0.0, 0.0) for each in torques]

    alike = strength_of(of(40.0, 41.0, 40.5), "tri")
    apart = strength_of(of(41.0, 30.0, 25.0), "tri")
    single = strength_of(of(41.0), "tri")
    assert alike is not None
    assert apart is not None
    assert single is not None
    assert alike.torque == apart.torque == single.torque == 41.0
    assert alike.sd < single.sd < apart.sd
    assert strength_of(of(40.0), "tib") is None


def test_a_third_less_is_a_change_and_efforts_alike_are_none() -> None:
    before = efforts_of([maximal()])
    for after, lost in (
        (maximal((41.0, 39.0, 42.0), seed=1), False),
        (maximal((29.0, 31.0, 28.0)), True),
    ):
        told = strength_change(before, efforts_of([after]))["voluntary_torque_tri"]
        assert told.difference is not None
        assert told.sd is not None
        assert (abs(told.difference) > 1.96 * told.sd) is lost


def test_efforts_at_another_angle_are_not_compared() -> None:
    sides = [efforts_of([maximal(degrees=degrees)]) for degrees in (0.0, 15.0)]
    told = strength_change(*sides)["voluntary_torque_tri"]
    assert told.difference is None
    assert "15°" in told.missing
    assert math.isclose(told.before or 0.0, 44.0, abs_tol=0.2)
    assert strength_change((), ()) == {}


def test_strength_is_asked_by_its_word(tmp_path: object) -> None:
    calm = maximal(sizes=(0.0, 0.0, 0.0))
    said = surae.change([maximal()], [maximal((30.0, 29.0, 28.0), seed=2)], question=["strength"])
    assert said.measures["voluntary_torque_tri"].verdict == "changed"
    assert said.measures["voluntary_torque_tri"].asked
    assert "Strength of the calf" in said.sentence
    named = surae.ModelInputs(**{**{f: getattr(calm, f) for f in _FIELDS}, "name": "slow"})
    with pytest.raises(InputError, match="maximal effort"):
        surae.change([named], [calm], question=["strength"])


_FIELDS = (
    "name",
    "rate_hz",
    "time",
    "angle",
    "velocity",
    "acceleration",
    "emg",
    "emg_unit",
    "torque",
    "prepared",
)
