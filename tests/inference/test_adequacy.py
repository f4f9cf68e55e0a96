"""The gate: what must be withheld, what must be let through."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.inference import Grade, Verdict, assess, fit_problem, make_problem
from surae.inference.judging.adequacy import doubted, judge_adequacy
from surae.inference.judging.of_fit import _is_odd
from surae.inference.judging.reasons import OF_OTHER_TRIALS, against
from surae.inference.judging.structure import structure
from surae.model.source import Gaussian
from surae.quality.finding import Finding, Quality


def fitted_to(trial, **asked):
    return fit_problem(make_problem([trial], **asked), starts=2)


def test_a_leg_of_the_model_is_adequate(noisy):
    judged = judge_adequacy(fitted_to(noisy))
    assert judged.grade is Grade.ADEQUATE
    assert judged.reasons == ()
    assert judged.r2 > 95.0


def test_a_static_hold_is_inadequate_and_identifies_nothing(noisy):
    still = replace(
        noisy,
        angle=read_only(-0.4 + 0.002 * np.sin(noisy.time)),
        velocity=read_only(0.002 * np.cos(noisy.time)),
        acceleration=read_only(-0.002 * np.sin(noisy.time)),
        torque=read_only(20.0 + np.random.default_rng(0).normal(0.0, 0.1, noisy.n)),
    )
    worth = assess(fitted_to(still))
    assert worth.vaf > 99.0  # the VAF rewards the offset
    assert worth.adequacy.grade is Grade.INADEQUATE
    assert any("hardly moves" in reason for reason in worth.adequacy.reasons)
    assert not any(p.verdict is Verdict.IDENTIFIED for p in worth.parameters.values())
    assert not any(p.repeatable for p in worth.parameters.values())


@pytest.mark.parametrize(
    ("code", "severity", "grade"),
    [
        ("angle-units", "error", Grade.INADEQUATE),
        ("electrodes-swapped", "error", Grade.DOUBTFUL),
        ("torque-unit", "warning", Grade.ADEQUATE),
        ("position-steps", "warning", Grade.ADEQUATE),
        ("position-steps", "error", Grade.DOUBTFUL),
        ("time-gap", "error", Grade.ADEQUATE),  # a fit is of the parts between gaps
    ],
)
def test_a_recording_that_is_not_what_its_file_says_is_said_so(noisy, code, severity, grade):
    """However well the torque is followed: degrees from the sole were, by arms that grow."""
    result = fitted_to(noisy)
    found = Finding(code, severity, "angle", 0.0, 1.0, None, "", "found", "do")
    worth = assess(result, quality=[Quality("walk", (found,))])
    assert worth.adequacy.grade is grade
    named = any("walk is not what its file says" in reason for reason in worth.adequacy.reasons)
    assert named == (grade is not Grade.ADEQUATE and code != "position-steps")
    stands = any("walk has an error that stands: found" in r for r in worth.adequacy.reasons)
    assert stands == (code == "position-steps" and severity == "error")
    identified = any(p.verdict is Verdict.IDENTIFIED for p in worth.parameters.values())
    assert identified == (grade is not Grade.INADEQUATE)


def test_what_other_trials_say_takes_no_error_of_its_own_recordings_away(noisy) -> None:
    """Nor is it said twice; of a trial that is no longer in the folder it goes."""
    found = Finding("position-steps", "error", "angle", 0.0, 1.0, None, "", "found", "do")
    alone = judge_adequacy(fitted_to(noisy), [Quality("walk", (found,))])
    own, other = (against("error-stands", trial=n, what="found") for n in ("walk", "hold"))
    both = doubted(alone, (own, other), OF_OTHER_TRIALS, ["walk"])
    assert [r.values["trial"] for r in both.against] == ["walk", "hold"]
    assert doubted(both, (), OF_OTHER_TRIALS, ["walk"]) == alone
    assert alone.grade is Grade.DOUBTFUL


def test_turned_torque_is_inadequate(noisy):
    turned = replace(noisy, torque=read_only(-noisy.torque))
    assert judge_adequacy(fitted_to(turned)).grade is Grade.INADEQUATE


def test_what_follows_the_angle_is_no_noise(noisy):
    rng = np.random.default_rng(1)
    white = rng.standard_normal(noisy.n)
    assert structure([noisy], [white]) < 0.05
    slow = np.convolve(rng.standard_normal(noisy.n + 60), np.exp(-np.arange(61) / 10), "valid")
    assert structure([noisy], [slow]) < 0.15
    assert structure([noisy], [noisy.angle**2 + 0.1 * white]) > 0.6


def test_a_model_that_leaves_much_out_is_not_adequate(noisy):
    bent = 0.5 * noisy.torque.std() * np.sign(noisy.velocity)
    judged = judge_adequacy(fitted_to(replace(noisy, torque=read_only(noisy.torque + bent))))
    assert judged.grade is not Grade.ADEQUATE
    assert any("leaves something out" in reason for reason in judged.reasons)


@pytest.mark.parametrize("silent", [("sol",), ("gl", "sol", "gm")])
def test_a_silent_muscle_is_named(noisy, silent):
    emg = noisy.emg.copy()
    for muscle in silent:
        emg[:, ("ta", "gl", "sol", "gm").index(muscle)] = 1e-6
    reasons = judge_adequacy(fitted_to(replace(noisy, emg=read_only(emg)))).reasons
    assert any(
        "hardly changes" in reason and all(m.upper() in reason for m in silent)
        for reason in reasons
    )


def test_the_farthest_of_eight_trials_is_odd_where_that_of_one_is() -> None:
    belief = Gaussian(0.0, 1.0)
    assert _is_odd((2.91,), belief)
    assert not _is_odd((2.89,), belief)
    assert not _is_odd((2.91, *[0.0] * 7), belief)
    assert _is_odd((3.55, *[0.0] * 7), belief)
    rng = np.random.default_rng(4)  # 0.4 % of what is usual, whatever the number of trials
    odd = sum(_is_odd(tuple(rng.standard_normal(8)), belief) for _ in range(5000))
    assert odd == pytest.approx(0.0037 * 5000, abs=13)
