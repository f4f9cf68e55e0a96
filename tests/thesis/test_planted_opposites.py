"""Rules of movements, tendons and covariances: a planted opposite turns each."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from surae_thesis import appendix, movements, tendons
from surae_thesis.claims import read_claims


def _turned(monkeypatch, module, name, planted, rule, *given):
    """What a rule says before and after something that it looks at is another."""
    before = rule(*given).holds
    monkeypatch.setattr(module, name, planted)
    return before, rule(*given).holds


def _half(done):
    return replace(done, angle=0.5 * done.angle)


def _path(velocity, share=1.0):
    return SimpleNamespace(
        velocity=np.array([-velocity, velocity]), coverage=SimpleNamespace(share=share)
    )


MOVEMENTS = {
    "whole-range": (movements.span, "basic", lambda name: _half(movements.chirped(name))),
    "highest-chirp-factor": (
        lambda _: movements.highest_factor(None, 0.9),
        "_peak",
        lambda *_: 3.0,
    ),
    "richer-plane": (movements.plane_visited, "triceps_path", lambda _: _path(1.0)),
    "within-axes": (movements.within_axes, "triceps_path", lambda _: _path(6.0)),
    "below-overshoot": (
        movements.overshoot,
        "adaptation",
        lambda _: SimpleNamespace(peak_velocity=(1.4, 1.2)),
    ),
    "chirp-fades": (
        movements.fades,
        "adaptation",
        lambda _: SimpleNamespace(chirp_amplitude=(0.2, 0.2), chirp_end_amplitude=0.19),
    ),
}


@pytest.mark.parametrize("claim", MOVEMENTS)
def test_movements(monkeypatch, claim) -> None:
    rule, name, planted = MOVEMENTS[claim]
    assert _turned(monkeypatch, movements, name, planted, rule, None) == (True, False)


@pytest.fixture(scope="module")
def numbers():
    return tendons.Numbers({"implicit": 0.02, "explicit-euler": 14.0}, ((75.0, 160.0),))


TENDONS = {
    "slack-length-irrelevant": (tendons.slack_length, "printed_force", lambda e, s: e * s),
    "printed-initial-lengths": (
        tendons.printed_lengths,
        "SLACK_TRI",
        tendons.SLACK_TRI + 0.05,
    ),
    "explicit-oscillates": (tendons.oscillates, "reversals", lambda *_: 5.0),
}


@pytest.mark.parametrize("claim", TENDONS)
def test_tendons(monkeypatch, numbers, claim) -> None:
    rule, name, planted = TENDONS[claim]
    assert _turned(monkeypatch, tendons, name, planted, rule, numbers) == (True, False)


def test_tendons_that_take_little_or_most(monkeypatch, numbers) -> None:
    for shares, said in (([5.0, 4.0], (True, False)), ([60.0, 4.0], (False, False))):
        monkeypatch.setattr(tendons, "_passive", lambda *_, s=shares: s)
        ruling = tendons.stiff(numbers, 10.0, 50.0)
        assert (ruling.holds, ruling.less) == said


def test_errors_and_forces_by_their_numbers(numbers) -> None:
    exact = replace(
        numbers, errors={"implicit": 0.02, "explicit-euler": 0.1}, toes=((75.0, 260.0),)
    )
    assert tendons.coarse_rate(numbers, 0.5).holds
    assert not tendons.coarse_rate(exact, 0.5).holds
    assert tendons.toe(numbers, 2.0).holds
    assert not tendons.toe(exact, 2.0).holds


def test_covariances() -> None:
    made = appendix.fitted(1)
    swapped = replace(made, linear=made.offset, offset=made.linear, alike=made.linear)
    assert appendix.linear(made, 0.2).holds
    assert not appendix.linear(swapped, 0.2).holds
    assert appendix.non_linear(made, 0.2, 0.5).holds
    assert not appendix.non_linear(made, 0.2, 0.99).holds
    assert appendix.accurate(made).holds
    off = replace(made.offset, values={**made.offset.values, "b": 4.0})
    assert not appendix.accurate(replace(made, offset=off)).holds
    assert appendix.alike(made).holds
    assert not appendix.alike(swapped).holds


def test_none_is_left_out() -> None:
    rest = {"passive-tendon-stiff", "muscle-model-rate", "toe-region"}
    assert set(MOVEMENTS) == {c.id for c in read_claims("protocols", movements.__name__)}
    assert {*TENDONS, *rest} == {c.id for c in read_claims("tendons", tendons.__name__)}
    assert {c.id for c in read_claims("appendix", appendix.__name__)} == {
        "linear-independent",
        "non-linear-dependent",
        "still-accurate",
        "exponential-motion",
    }
