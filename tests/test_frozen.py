"""Frozen data compare, hash, copy and pickle, arrays and undefined numbers included."""

import copy
import math
import pickle
from dataclasses import dataclass

import numpy as np
import pytest

import surae
from surae.base.frozen import Comparable, FrozenDict
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


@dataclass(frozen=True, slots=True, eq=False)
class Thing(Comparable):
    """Something with everything that equality stumbles over."""

    values: object
    number: float = math.nan
    parts: tuple[object, ...] = ()


def test_arrays_compare_by_value():
    thing = Thing(np.array([1.0, math.nan]), parts=(np.zeros(2), {"a": np.ones(1)}))
    same = Thing(np.array([1.0, math.nan]), parts=(np.zeros(2), {"a": np.ones(1)}))
    assert thing == same
    assert hash(thing) == hash(same)
    for other in (
        Thing(np.array([1.0, 2.0]), parts=thing.parts),
        Thing(np.array([[1.0, math.nan]]), parts=thing.parts),
        Thing(thing.values, 3.0, thing.parts),
        Thing(thing.values, parts=(np.zeros(2), {"a": np.zeros(1)})),
        Thing(thing.values, parts=(np.zeros(2),)),
    ):
        assert thing != other
    assert thing != "thing"


def test_equal_things_have_equal_hashes():
    assert Thing(np.array([0.0])) == Thing(np.array([-0.0]))
    assert hash(Thing(np.array([0.0]))) == hash(Thing(np.array([-0.0])))


@dataclass(frozen=True)
class Plain:
    """A dataclass that knows nothing of arrays."""

    table: dict[str, float]


def test_plain_dataclasses_within_are_looked_into():
    thing, same = (Thing(0, parts=(Plain({"a": math.nan}),)) for _ in range(2))
    assert thing == same
    assert hash(thing) == hash(same)
    assert thing != Thing(0, parts=(Plain({"a": 1.0}),))


def test_a_frozen_mapping_is_a_mapping():
    table = FrozenDict({"a": 1.0, "b": 2.0})
    assert table == {"a": 1.0, "b": 2.0} == {**table}
    assert list(table) == ["a", "b"]
    assert repr(table) == "{'a': 1.0, 'b': 2.0}"
    assert hash(table) == hash(FrozenDict({"b": 2.0, "a": 1.0}))
    with pytest.raises(TypeError):
        table["a"] = 2.0  # type: ignore[index]


@pytest.fixture(scope="module")
def fit():
    motion = generate(Protocol(profile="multiple-holds", rate_hz=32.0))
    return surae.fit(virtual_trial(virtual_subject(1), motion), "muscle", starts=1)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_a_fit_and_what_follows_from_it_can_be_copied(fit, copied):
    prediction = fit.predict(fit.result.problem.inputs[0])
    for thing in (fit, fit.parts(), prediction, fit.result.problem.inputs[0], fit.settings):
        again = copied(thing)
        assert again is not thing
        assert again == thing
        assert hash(again) == hash(thing)
    again = copied(fit)
    assert not again.result.residuals[0].flags.writeable
    assert not again.result.problem.inputs[0].torque.flags.writeable
    assert again.predict(fit.result.problem.inputs[0]) == prediction


def test_a_fit_that_was_saved_is_the_same_and_another_is_not(fit, tmp_path):
    fit.save(tmp_path / "fit.json")
    assert surae.load(tmp_path / "fit.json") == fit
    other = surae.fit(fit.result.problem.inputs[0], fit.settings, fixed={"beta": 1.0})
    assert other != fit


def test_recordings_can_be_copied(tmp_path):
    path = tmp_path / "trial.csv"
    time = np.arange(64) / 32
    surae.write_csv(path, {"time_s": time, "angle_rad": np.sin(time), "torque_Nm": time})
    recording = surae.read(path)
    for again in (copy.deepcopy(recording), pickle.loads(pickle.dumps(recording))):
        assert again == recording
        assert hash(again) == hash(recording)
