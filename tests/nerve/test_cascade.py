"""Equations of the cascade: limits, and derivatives against finite differences."""

import numpy as np
import pytest

from surae.nerve import cascade
from surae.nerve.cascade import Structure
from surae.nerve.fitting import Problem, noise_of
from surae.nerve.piece import Piece

S = 2j * np.pi * np.array([0.0, 0.1, 3.0, 20.0])


def test_a_branch_is_nothing_at_rest_and_a_spring_when_fast() -> None:
    assert cascade.relaxing(S, 0.02)[0] == 0.0
    assert cascade.relaxing(np.array([1e9j]), 0.02) == pytest.approx(1.0, abs=1e-6)


def test_the_reflex_follows_slow_stretch_and_has_its_resonance() -> None:
    assert cascade.muscle(S, 18.0, 0.8)[0] == 1.0
    at = cascade.muscle(np.array([18.0j]), 18.0, 0.8)[0]
    assert at == pytest.approx(1.0 / 1.6j)


def test_only_one_direction_is_answered_beyond_the_threshold() -> None:
    v = np.array([-1.0, -0.1, 0.1, 1.0])
    assert cascade.stretched(v, 1, 0.2) == pytest.approx([0.0, 0.0, 0.0, 0.8])
    assert cascade.stretched(v, -1, 0.2) == pytest.approx([-0.8, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("order", [1, 2])
def test_a_filter_of_the_channel_lets_slow_torque_through_and_halves_its_power(order) -> None:
    passed, _ = cascade.channel(2j * np.pi * np.array([0.0, 30.0, 3e5]), 30.0, order)
    assert np.abs(passed) == pytest.approx([1.0, 0.5**0.5, 0.0], abs=2e-4)


@pytest.mark.parametrize(("direction", "order"), [(1, 1), (-1, 2)])
def test_derivatives_are_those_of_finite_differences(ankle, direction, order) -> None:
    moved = ankle(seconds=12.0).moved()
    piece = Piece(
        moved["time"], moved["angle"], moved["torque"], 500.0, 40.0, anchor=0.1, span=(0.0, 12.0)
    )
    problem = Problem([piece], noise_of([piece], [piece.bins(piece.torque)]))
    structure = Structure(
        "",
        2,
        True,
        direction,
        threshold=True,
        trend=True,
        length=3.0,
        lead=0.01,
        third=True,
        order=order,
    )
    q = dict(
        zip(
            structure.names,
            [
                1e-3,
                30.0,
                0.02,
                0.2,
                0.045,
                18.0,
                0.8,
                70.0,
                0.05,
                60.0,
                0.8,
                0.015,
                20.0,
                5.0,
                1.0,
                0.3,
                6.0,
            ],
            strict=True,
        )
    )
    _, j = problem.jacobian(structure, q)
    for k, name in enumerate(structure.names):
        h = 1e-5 * max(abs(q[name]), 1e-3)
        low, high = (problem.jacobian(structure, {**q, name: q[name] + d})[0] for d in (-h, h))
        numeric = (low - high) / (2.0 * h)
        close = 3e-2 if name == "threshold" else 1e-5  # samples pass the threshold one by one
        assert np.linalg.norm(j[:, k] - numeric) < close * np.linalg.norm(numeric), name


def test_bins_keep_the_power_of_what_is_white(ankle) -> None:
    """Sums over time and over bins are the same, whatever the taper."""
    moved = ankle(seconds=12.0).moved()
    piece = Piece(
        moved["time"], moved["angle"], moved["torque"], 500.0, 40.0, anchor=0.1, span=(0.0, 12.0)
    )
    bins = piece.bins(piece.torque)
    assert np.sum(piece.in_time(bins) ** 2) == pytest.approx(np.sum(np.abs(bins) ** 2), rel=1e-9)
