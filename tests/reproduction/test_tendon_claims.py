"""The tendons section: the schemes are compared by what they compute."""

import numpy as np
import pytest

from surae.reproduction.tendons.claims import findings, reversals
from surae.reproduction.tendons.printed import EPS0, F_MAX, printed_force
from surae.reproduction.tendons.trials import Errors, chirped, errors, torque


def test_reversals_are_counted_per_second() -> None:
    time = np.arange(0.0, 10.0, 1e-3)
    assert reversals(np.sin(2 * np.pi * 3.0 * time + 0.1), 1000.0) == pytest.approx(6.0, abs=0.1)
    assert reversals(np.ones(1000), 1000.0) == 0.0


@pytest.fixture(scope="module")
def measured() -> Errors:
    return errors(quick=True)


def test_the_implicit_scheme_is_accurate_where_the_explicit_one_is_not(measured: Errors) -> None:
    assert measured.of["implicit", 125.0] < 0.1
    assert measured.of["explicit-euler", 125.0] > 1.0
    for rate in (125.0, 512.0, 2000.0):
        assert measured.of["implicit", rate] < 0.1 * measured.of["explicit-euler", rate]


def test_errors_are_relative_to_the_fine_torque(measured: Errors) -> None:
    fine, coarse = chirped(measured.reference_hz), chirped(512.0)
    reference = torque(fine, "implicit")
    off = torque(coarse, "explicit-euler") - np.interp(coarse.time, fine.time, reference)
    ours = 100 * np.sqrt(np.mean(off**2) / np.mean(reference**2))
    assert measured.of["explicit-euler", 512.0] == pytest.approx(ours, rel=1e-9)


def test_the_verdict_on_the_rate_follows_the_errors(measured: Errors) -> None:
    exact = Errors(measured.reference_hz, dict.fromkeys(measured.of, 0.01))
    for given, expected in ((measured, "holds"), (exact, "differs")):
        (found,) = [f for f in findings(given) if f.claim.name == "muscle-model-rate"]
        assert found.verdict == expected


def test_the_printed_lengths_leave_no_room(measured: Errors) -> None:
    verdicts = {f.claim.name: f.verdict for f in findings(measured)}
    assert verdicts["printed-initial-lengths"] == "differs"
    assert verdicts["explicit-oscillates"] == "holds"
    assert verdicts["slack-length-irrelevant"] == "holds"


def test_the_printed_law_knows_its_slack_length() -> None:
    assert printed_force(np.array([0.40, 0.415, 0.415 + EPS0])) == pytest.approx([0, 0, F_MAX])
    length = np.linspace(0.42, 0.45, 50)
    assert np.all(printed_force(length, 0.41) > printed_force(length, 0.415))
    # As a strain, half the length is twice as stiff: the same force at half the elongation.
    stretch = np.linspace(0.0, 0.01, 50)
    np.testing.assert_allclose(
        printed_force(0.2 + stretch, 0.2, strain=True),
        printed_force(0.4 + 2.0 * stretch, 0.4, strain=True),
        rtol=1e-9,
    )
