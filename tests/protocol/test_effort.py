"""The EMG tasks."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surae.base.errors import InputError
from surae.protocol.effort import TASKS, effort, named_task, task_bursts

T = np.arange(0.0, 35.0, 1 / 256)
TASK = pytest.mark.parametrize("name", ["part-passive", "active"])


@given(duration=st.floats(1.0, 120.0), name=st.sampled_from(sorted(TASKS)))
def test_effort_is_a_fraction_whatever_the_duration(duration, name):
    target = effort(np.linspace(0.0, duration, 2000), TASKS[name])
    assert target.shape == (2000, 4)
    assert target.min() >= 0.0
    assert target.max() <= 1.0
    assert not target[-1].any()


def test_passive_part_is_passive_and_the_rest_is_not():
    target = effort(T, TASKS["part-passive"])
    assert not target[T <= 11.0].any()
    active = target[T > 11.0]
    assert np.mean(active.any(axis=1)) > 0.8
    assert not effort(T, TASKS["passive"]).any()


@TASK
def test_flexors_and_extensors_alternate(name):
    target = effort(T, TASKS[name])
    assert np.max(target[:, 0] * target[:, 1:].sum(axis=1)) < 0.01
    dorsiflexing = target[:, 0] > 0.1
    plantarflexing = target[:, 1:].max(axis=1) > 0.1
    turns = np.sign(plantarflexing.astype(int) - dorsiflexing.astype(int))
    turns = turns[turns != 0]
    assert np.sum(np.diff(turns) != 0) >= 15


@TASK
def test_bursts_last_about_a_second(name):
    active = (effort(T, TASKS[name])[:, 0] > 0).astype(int)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], active, [0]])))
    lengths = (edges[1::2] - edges[::2]) / 256
    assert lengths.min() > 0.85
    assert lengths.max() < 1.25


@TASK
def test_heads_are_similar_but_not_proportional(name):
    heads = effort(T, TASKS[name])[:, 1:]
    correlation = np.corrcoef(heads.T)[np.triu_indices(3, 1)]
    assert correlation.min() > 0.85
    assert correlation.max() < 0.98
    for i in range(3):
        others = np.delete(heads, i, axis=1)
        weights = np.linalg.lstsq(others, heads[:, i], rcond=None)[0]
        rest = heads[:, i] - others @ weights
        assert np.linalg.norm(rest) > 0.1 * np.linalg.norm(heads[:, i])


@TASK
def test_envelopes_are_smooth(name):
    target = effort(np.arange(0.0, 35.0, 1e-3), TASKS[name])
    speed = np.diff(target, axis=0) / 1e-3
    assert np.abs(speed).max() < 5.0
    assert np.abs(np.diff(speed, axis=0) / 1e-3).max() < 40.0


def test_steps_hold_many_levels_in_either_direction():
    target = effort(np.arange(0.0, 120.0, 0.01), TASKS["steps"])
    for column in (0, 2):
        flat = (np.abs(np.gradient(target[:, column])) < 1e-9) & (target[:, column] > 0.1)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], flat.astype(int), [0]])))
        assert min(edges[1::2] - edges[::2]) > 190
        assert np.ptp(target[edges[::2] + 1, column]) > 0.3
    assert not np.any((target[:, 0] > 0.1) & (target[:, 2] > 0.1))


def test_a_prbs_is_on_and_off_for_every_number_of_clocks_up_to_its_register():
    task = TASKS["prbs"]
    runs = [round((b.length - task.rise) / 0.5) for b in task_bursts(task, 64.0)]
    assert sum(runs[:32]) == pytest.approx(64, abs=3)  # of 127
    assert set(runs[:32]) >= {1, 2, 3, 4, 5}


def test_unknown_task_is_named_with_what_there_is():
    with pytest.raises(InputError, match="'random' is not known; use one of: part-passive, active"):
        named_task("random")


def test_a_passive_part_and_turns_of_ones_own():
    own = TASKS["part-passive"].with_own(7.0, ("ta", "sol", "gm", "gl"))
    target = effort(T, own)
    assert not target[T <= 7.0].any()
    order = np.argmax(target[target.any(axis=1)], axis=1)
    order = order[np.flatnonzero(np.diff(order, prepend=-1))]
    assert order[:8].tolist() == [0, 2, 3, 1] * 2  # TA, SOL, GM, GL among TA, GL, SOL, GM
    assert np.max(np.sum(target > 0.0, axis=1)) == 1
    same = effort(T, TASKS["part-passive"].with_own(11.0, ("gl+sol+gm", "ta")))
    assert np.array_equal(same, effort(T, TASKS["part-passive"]))


@pytest.mark.parametrize(
    ("task", "passive", "turns", "message"),
    [
        ("active", 3.0, (), "does not begin relaxed"),
        ("passive", None, ("ta",), "has no bursts"),
        ("part-passive", -1.0, (), "use 0 or more"),
        ("part-passive", None, ("ta+sol",), r"turn 'ta\+sol': name muscles that pull together"),
        ("part-passive", None, ("tibialis",), "name muscles that pull together"),
    ],
)
def test_what_a_task_cannot_be_is_refused(task, passive, turns, message):
    with pytest.raises(InputError, match=message):
        TASKS[task].with_own(passive, turns)
