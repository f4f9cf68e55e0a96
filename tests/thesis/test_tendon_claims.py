"""The tendons section: the schemes are compared by what they compute."""

from dataclasses import replace

import numpy as np
import pytest

from surae.model.contraction import force_velocity
from surae.model.euler import damped_speed
from surae_thesis import tendons
from surae_thesis.claims import judge, read_claims
from surae_thesis.tendons import EPS0, F_MAX, Numbers, errors, printed_force, reversals, toes

CLAIMS = read_claims("tendons", tendons.__name__)


def verdicts(numbers: Numbers) -> dict[str, str]:
    return {claim.id: judge(claim, {"": numbers}).verdict for claim in CLAIMS}


def test_reversals_are_counted_per_second() -> None:
    time = np.arange(0.0, 10.0, 1e-3)
    assert reversals(np.sin(2 * np.pi * 3.0 * time + 0.1), 1000.0) == pytest.approx(6.0, abs=0.1)
    assert reversals(np.ones(1000), 1000.0) == 0.0


@pytest.fixture(scope="module")
def measured() -> Numbers:
    return Numbers(errors(), ((60.0, 250.0),))


def test_the_implicit_scheme_is_accurate_where_the_explicit_one_is_not(measured: Numbers) -> None:
    assert measured.errors["implicit"] < 0.1
    assert measured.errors["explicit-euler"] > 1.0


def test_the_verdict_on_the_rate_follows_the_errors(measured: Numbers) -> None:
    (rate,) = [claim for claim in CLAIMS if claim.id == "muscle-model-rate"]
    exact = replace(measured, errors=dict.fromkeys(measured.errors, 0.01))
    assert judge(rate, {"": measured}).verdict == "holds"
    assert judge(rate, {"": exact}).verdict == "differs"


def test_the_lengths_with_the_arm_s_change_leave_room(measured: Numbers) -> None:
    said = verdicts(measured)
    assert said["printed-initial-lengths"] == "holds"
    assert said["passive-tendon-stiff"] == "same direction, smaller"
    assert said["explicit-oscillates"] == "holds"
    assert said["slack-length-irrelevant"] == "holds"
    assert said["toe-region"] == "differs"
    assert verdicts(replace(measured, toes=((75.0, 160.0),)))["toe-region"] == "holds"


@pytest.mark.slow
def test_forces_of_the_cohort_are_around_the_toe() -> None:
    """The strongest leg's triceps leaves its toe too: 112 % stand in the table of claims."""
    triceps, tibialis = zip(*toes(quick=True), strict=True)
    assert max(triceps) == pytest.approx(112.0, abs=1.0)
    assert min(triceps) < 100.0 < max(tibialis) < 200.0


def test_the_printed_law_knows_its_slack_length() -> None:
    assert printed_force(np.array([0.40, 0.415, 0.415 + EPS0])) == pytest.approx([0, 0, F_MAX])
    length = np.linspace(0.42, 0.45, 50)
    assert np.all(printed_force(length, 0.41) > printed_force(length, 0.415))


@pytest.mark.parametrize("speed", [-0.3, -0.01, 0.0, 0.05, 0.35])
def test_a_damped_speed_makes_the_force(speed) -> None:
    vmax, active, damping = 0.36, 400.0, 300.0
    force = active * force_velocity.py_func(speed, vmax)[0] + damping * speed
    assert damped_speed(force, active, vmax, damping) == pytest.approx(speed, abs=1e-9)
    assert damped_speed(1e6, 0.0, vmax, damping) == pytest.approx(vmax)


@pytest.mark.slow
def test_more_damping_ends_the_chatter_at_a_price() -> None:
    inputs = tendons.trial(tendons.FINE)
    often = {
        scheme: reversals(tendons.states(inputs, scheme).muscle_velocity[0], tendons.FINE)
        for scheme in ("implicit", "explicit-euler", "explicit-damped")
    }
    assert often["explicit-euler"] > 100.0
    assert often["explicit-damped"] == pytest.approx(often["implicit"], abs=1.0)
    exact, damped = (tendons.torque(inputs, s) for s in ("implicit", "explicit-damped"))
    assert 0.01 < np.std(damped - exact) / np.std(exact) < 0.1
