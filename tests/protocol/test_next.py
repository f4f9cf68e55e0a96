"""What to measure next: what a fit knows counts, and nothing is promised that is not kept."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api import fit_inputs
from surae.base.errors import InputError
from surae.inference.judging.grade import Grade
from surae.inference.judging.reasons import against
from surae.planning.aimed import _along
from surae.planning.information import information, prior_precision, shared
from surae.planning.legs import fit_legs, population_legs
from surae.planning.next import _half_widths, known_from
from surae.planning.ready import ready_protocols
from surae.protocol import Protocol, generate, named_device
from surae.studies import virtual_subject, virtual_trial

DEVICE = named_device("achilles")


def noisy(trajectory, seed, noise=0.5):
    trial = virtual_trial(virtual_subject(seed), trajectory, noise=0.0)
    torque = trial.torque + noise * np.random.default_rng(seed).standard_normal(trial.n)
    return replace(trial, torque=torque)


@pytest.fixture(scope="module")
def weak():
    """A fit of a short trial that tells little of the tibialis' tissue."""
    settings = Protocol(
        profile="multiple-holds",
        duration=35.0,
        device=DEVICE,
        chirp_amplitude=0.1,
        rate_hz=64.0,
        angle_range=(-0.7, 0.5),
    )
    motion = generate(settings)
    return fit_inputs([noisy(motion, 4, 2.0)], surae.FitSettings.of("muscle", starts=2))


def test_the_answer_is_a_trial_that_helps(weak, tmp_path) -> None:
    answer = surae.measure_next(weak, angle_range=(-0.9, 0.6))
    # what only another arm or path would change, no trial tells
    known = weak.assessment.uncertainty.at_assumed
    halves = {n: known.half_width(known.along(n)) for n in known.names}
    unsure = [n for n, p in weak.parameters.items() if halves[n] > 0.1 * abs(p.value)]
    assert unsure
    assert len(unsure) < sum(p.verdict != "identified" for p in weak.parameters.values())
    assert set(answer.gains) == set(unsure)
    assert answer.protocol in ready_protocols()
    assert answer.protocol in answer.sentences[0]
    name, (before, after) = min(answer.gains.items(), key=lambda g: g[1][1] / g[1][0])
    assert after < 0.9 * before
    assert name in answer.sentences[0]
    answer.write(tmp_path / "next.csv")
    assert surae.expect(tmp_path / "next.csv", "muscle", legs=2).parameters


def test_the_information_of_a_fit_is_its_covariance(weak) -> None:
    legs = fit_legs(weak, 1)
    known = known_from(weak, legs)
    told = weak.assessment.uncertainty.at_assumed
    names = [name for name in told.names if name not in told.lost and name in legs.free]
    at = [legs.free.index(name) for name in names]
    found = np.linalg.inv(known[np.ix_(at, at)]) / told.covariance(*names)
    np.testing.assert_allclose(found, 1.0, rtol=1e-3)


def test_more_trials_never_make_it_worse_and_counts_are_kept(weak) -> None:
    answer = surae.measure_next(weak, angle_range=(-0.9, 0.6))
    for name, times in answer.repetitions.items():
        before, after = answer.gains[name]
        assert after <= before * (1 + 1e-9)
        assert times is None or 1 <= times <= 20
        assert (times == 1) == (after <= 0.085)


def test_what_trades_off_is_unknown_and_not_a_number() -> None:
    legs = population_legs("muscle", None, 2)
    known = np.diag(1e4 / legs.estimated[0] ** 2)
    i, j = legs.free.index("k_tri"), legs.free.index("x0_tri")
    known[i, j] = known[j, i] = np.sqrt(known[i, i] * known[j, j])  # only their sum is known
    halves = _half_widths(legs.free, known, legs)
    assert {n for n, half in halves.items() if not np.isfinite(half)} == {"k_tri", "x0_tri"}
    assert halves["m"] == pytest.approx(0.0196, rel=1e-3)
    slopes = np.zeros((2, len(known)))
    slopes[0, i] = 1.0
    slopes[1, [i, j]] = np.sqrt(known[i, i]), np.sqrt(known[j, j])
    alone, together = _along(known, slopes, legs.estimated[0])
    assert alone == np.inf
    assert together == pytest.approx(1.0)


@pytest.fixture(scope="module")
def relaxed():
    """A fit of a relaxed trial: nothing is known of what muscles do."""
    settings = Protocol(
        profile="multiple-holds", task="passive", device=DEVICE, chirp_amplitude=0.1, rate_hz=64.0
    )
    return fit_inputs([noisy(generate(settings), 4)], surae.FitSettings.of("muscle", starts=2))


def test_what_is_unknown_is_said_so_and_how_often_to_measure(relaxed) -> None:
    unknown = [n for n, p in relaxed.parameters.items() if p.ci95 is None]
    assert unknown
    answer = surae.measure_next(relaxed)
    assert " from unknown to ±" in answer.sentences[0]
    told = " ".join(answer.sentences)
    assert "times is" not in told
    for times in {k for k in answer.repetitions.values() if k is not None}:
        assert f"Measured {'once' if times == 1 else f'{times} times'}, it is expected" in told
    assert all(answer.gains[n][0] is None for n in unknown if n in answer.gains)
    # an active trial is worth more than a passive one to whoever knows nothing of the muscles
    assert answer.protocol in ("everything-35", "compliant-35")


def test_promised_identification_holds(relaxed) -> None:
    answer = surae.measure_next(relaxed, wanted=["f0", "l0_tri", "k_tri"])
    promised = [n for n, k in answer.repetitions.items() if k == 1]
    assert promised
    first = relaxed.result.problem.inputs[0]
    second = noisy(answer.trajectory, 4)
    both = fit_inputs([first, second], surae.FitSettings.of("muscle", starts=2))
    assert [str(both.parameters[n].verdict) for n in promised] == ["identified"] * len(promised)


def test_no_trial_mends_an_inadequate_fit(weak) -> None:
    gate = replace(
        weak.adequacy, grade=Grade.INADEQUATE, against=(against("not-followed", r2=12.0),)
    )
    bad = replace(weak, assessment=replace(weak.assessment, adequacy=gate))
    answer = surae.measure_next(bad)
    assert answer.protocol is None
    assert "inadequate" in answer.sentences[0]


def test_nothing_is_asked_for_where_all_is_known() -> None:
    motion = generate(
        Protocol(profile="multiple-holds", device=DEVICE, chirp_amplitude=0.1, rate_hz=64.0)
    )
    fit = fit_inputs([noisy(motion, 4, 0.02)], surae.FitSettings.of("muscle", starts=2))
    answer = surae.measure_next(fit)
    assert answer.protocol is None
    assert "identified" in answer.sentences[0]
    with pytest.raises(InputError, match="no trial"):
        answer.write("next.csv")


def test_who_cannot_be_measured_so_long_is_told(weak) -> None:
    answer = surae.measure_next(weak, duration=5.0)
    assert answer.protocol is None
    assert "5 s" in answer.sentences[0]
    with pytest.raises(InputError, match="not estimated"):
        surae.measure_next(weak, wanted=["nothing"])


@pytest.mark.slow
def test_ready_protocols_keep_the_limits_of_other_devices() -> None:
    from surae.api.requested import ready_trajectory
    from surae.protocol import Device

    robot = Device("robot", max_velocity=1.2, max_acceleration=40.0, max_torque=60.0)
    for name in ready_protocols():
        trial = ready_trajectory(name, robot, (-0.6, 0.3), 64.0)
        assert np.abs(trial.velocity).max() <= 1.2
        assert np.abs(trial.acceleration).max() <= 40.0
        assert trial.angle.min() >= -0.6
        assert trial.angle.max() <= 0.3


def test_what_differs_from_trial_to_trial_is_not_shared() -> None:
    """Twice the same trial tells less than twice as much where each has a zero of its own."""
    legs = population_legs("muscle", None, 2, nuisances="all")
    settings = Protocol(profile="multiple-holds", rate_hz=32.0, chirp_amplitude=0.1)
    motion = generate(settings)
    told = shared(information(motion, legs, 0.5), legs)
    assert "torque_zero" not in told.names
    at = [legs.free.index(n) for n in told.names]
    known = prior_precision(legs.free, legs)
    alone = np.linalg.inv(information(motion, legs, 0.5).matrices[0] + known)
    apart = np.linalg.inv(told.matrices[0] + known[np.ix_(at, at)])
    np.testing.assert_allclose(np.diag(apart), np.diag(alone)[at], rtol=1e-6)
