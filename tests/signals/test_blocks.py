"""Long recordings in blocks: each sample counts once, each block is simulated from before it."""

from dataclasses import replace

import numpy as np
import pytest

from surae.signals import ModelInputs, blocks, inputs_as_given
from surae.signals.blocks import LEAD_S, LONGEST, SECONDS, cut, recordings_of, telling

RATE = 8.0


def trial(seconds: float) -> ModelInputs:
    time = np.arange(int(seconds * RATE)) / RATE
    motion = np.sin(time), np.cos(time), -np.sin(time)
    emg = np.repeat(time[:, None], 4, axis=1)
    return inputs_as_given("trial", RATE, time, motion, emg, torque=np.cos(time))


def test_every_sample_counts_once() -> None:
    whole = trial(400.0)
    parts = cut(whole, 0, 400.0)
    assert len(parts) == np.ceil(400.0 / SECONDS)
    counted = np.zeros(whole.n)
    for part in parts:
        counted[part.at] += part.inputs.weights
        assert part.inputs.counted / RATE <= SECONDS + 1.0
        for name in ("time", "angle", "velocity", "acceleration", "torque", "emg"):
            np.testing.assert_array_equal(getattr(part.inputs, name), getattr(whole, name)[part.at])
    np.testing.assert_array_equal(counted, 1.0)


def test_a_block_is_simulated_from_before_it() -> None:
    seconds = LONGEST + 10.0
    first, second, *_ = cut(trial(seconds), 0, seconds)
    assert first.inputs.counted == first.inputs.n
    assert np.count_nonzero(second.inputs.weights == 0.0) == LEAD_S * RATE
    assert np.all(np.diff(second.inputs.weights) >= 0.0)


def test_weights_of_the_whole_stay() -> None:
    whole = trial(400.0)
    weight = np.random.default_rng(1).uniform(0.0, 2.0, whole.n)
    counted = np.zeros(whole.n)
    for part in cut(replace(whole, weight=weight), 0, 400.0):
        counted[part.at] += part.inputs.weights
    np.testing.assert_array_equal(counted, weight)


@pytest.mark.parametrize("seconds", [35.0, LONGEST])
def test_a_short_recording_is_its_own_block(seconds: float) -> None:
    whole = trial(seconds)
    (part,) = cut(whole, 0, seconds)
    assert part.inputs is whole


def test_blocks_know_their_recording() -> None:
    inputs = [
        part.inputs
        for number, seconds in enumerate((400.0, 400.0, 35.0, 35.0))
        for part in cut(trial(seconds), number, seconds)
    ]
    assert recordings_of(inputs) == (*[0] * 7, *[1] * 7, 2, 3)


def test_a_search_begins_where_much_moves() -> None:
    whole = trial(600.0)
    moving = (whole.time > 300.0) & (whole.time < 480.0)
    parts = cut(replace(whole, angle=np.where(moving, whole.angle, 0.01)), 0, 600.0)
    chosen = telling(parts)
    assert len(chosen) == blocks.FEW
    assert {5, 6, 7} <= {parts.index(part) for part in chosen}
