"""Recordings of one leg tell the same of it; another leg's among them do not."""

import numpy as np

from surae.inference.judging.random_effects import farthest_apart
from surae.inference.posterior.conflict import SAID
from surae.inference.result import OfRecording

NAMES = tuple(f"p{i}" for i in range(16))


def trials(rng: np.random.Generator, other: float = 0.0) -> list[OfRecording]:
    """Four trials, each with errors of its own; two of a leg that is so far off in one number."""
    made = []
    for trial in range(4):
        sem = rng.uniform(0.5, 2.0, len(NAMES))
        values = 20.0 + sem * rng.standard_normal(len(NAMES))
        values[3] += other * (trial > 1)
        named = [dict(zip(NAMES, each.tolist(), strict=True)) for each in (values, sem)]
        made.append(OfRecording(*named))
    return made


def test_trials_of_one_leg_are_as_rarely_apart_as_is_said() -> None:
    rng = np.random.default_rng(4)
    rare = [farthest_apart(trials(rng))[1] for _ in range(400)]
    assert 0.02 < np.mean(np.array(rare) < SAID) < 0.08
    assert 0.4 < np.median(rare) < 0.6


def test_trials_of_another_leg_are_named_by_what_they_tell_otherwise() -> None:
    rng = np.random.default_rng(5)
    found = [farthest_apart(trials(rng, other=8.0)) for _ in range(20)]
    assert {name for name, _ in found} == {"p3"}
    assert np.median([rare for _, rare in found]) < 1e-4


def test_what_no_trial_tells_is_not_compared() -> None:
    held = [OfRecording({"a": 1.0, "b": float(i)}, {"a": 0.1, "b": 0.0}) for i in range(3)]
    assert farthest_apart(held) == ("a", 1.0)
