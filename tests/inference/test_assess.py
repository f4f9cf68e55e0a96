"""A fit judged: intervals, notes, what has none and why."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.inference import Verdict, assess, fit_problem, make_problem
from surae.inference.judging.parameter import judge_interval
from surae.inference.judging.validation import predict_others
from surae.inference.judging.verdict import IDENTIFIED
from surae.inference.least_squares.residuals import Residuals
from surae.inference.uncertainty.covariance import half_width
from surae.recording import SourceFile
from surae.recording.recording import MUSCLES


def quick(inputs, **given):
    return fit_problem(make_problem(inputs, **given), starts=1)


def with_emg(inputs, **columns):
    emg = inputs.emg.copy()
    for muscle, values in columns.items():
        emg[:, MUSCLES.index(muscle)] = values
    return replace(inputs, emg=emg)


def test_every_parameter_of_an_ordinary_fit(fitted, monkeypatch):
    # what arms and paths add is tested apart
    monkeypatch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
    found = assess(fitted)
    assert found.uncertainty.geometry is None
    assert list(found.parameters) == list(fitted.problem.spec.names)
    for name, p in found.parameters.items():
        assert p.name == name
        assert p.value == fitted.values[name]
        assert p.free
        assert not p.at_bound
        half = half_width(p.sem, found.covariance.dof)
        assert p.ci95 == pytest.approx((p.value - half, p.value + half), rel=1e-12)
        assert p.lower < p.value < p.upper
        relative = half / p.value
        expected, words = (
            (Verdict.IDENTIFIED, "known to")
            if relative <= 0.1
            else (Verdict.WEAK, "known only to")
            if relative <= 1.0
            else (Verdict.UNDETERMINED, "not determined")
        )
        assert p.verdict is expected
        assert p.note.startswith(words)
        assert p.repeatable is (relative <= 0.1)
    assert found.ipde == pytest.approx(
        np.sqrt(np.sum(np.triu(found.covariance.correlation, 1) ** 2)), rel=1e-12
    )
    assert 0 < found.ipde < np.sqrt(105)
    assert found.ipde_note == ""


def test_covariance_equals_its_definition_on_the_whole_jacobian(fitted):
    problem = fitted.problem
    x = np.array([fitted.values[name] for name in problem.free])
    rows = Residuals(problem).rows(x)
    J, e = rows[:-1].T, rows[-1]
    scale = np.linalg.norm(J, axis=0)
    sigma2 = e @ e / (problem.n - 15)
    expected = sigma2 * np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
    found = assess(fitted)
    np.testing.assert_allclose(found.covariance.matrix, expected, rtol=1e-6)
    sem = [found.parameters[name].sem for name in problem.free]
    np.testing.assert_allclose(sem, np.sqrt(np.diag(expected)), rtol=1e-6)


def test_goodness_by_hand(fitted, noisy):
    found = assess(fitted)
    (residual,) = fitted.residuals
    assert found.vaf == pytest.approx(
        100 * (1 - np.sum(residual**2) / np.sum(noisy.torque**2)), rel=1e-14
    )
    assert found.rmse == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-14)
    (one,) = found.recordings
    assert (one.name, one.n, one.rate_hz) == (noisy.name, noisy.n, noisy.rate_hz)
    assert one.vaf == found.vaf
    assert one.bias == pytest.approx(residual.mean(), abs=1e-15)
    assert (one.path, one.sha256) == (None, None)


def test_several_recordings_are_judged_together_and_apart(noisy, clean):
    named = replace(clean, files=(SourceFile("a.csv", "0" * 64), SourceFile("b.csv", "1" * 64)))
    result = quick([noisy, named])
    found = assess(result)
    both = np.concatenate(result.residuals)
    power = np.sum(noisy.torque**2) + np.sum(clean.torque**2)
    assert found.vaf == pytest.approx(100 * (1 - both @ both / power), rel=1e-13)
    first, second = found.recordings
    assert first.vaf < found.vaf < second.vaf
    assert (second.path, second.sha256) == ("a.csv", "0" * 64)


def test_fixed_has_no_interval(noisy):
    found = assess(quick([noisy], fixed={"beta": 1.0, "f0": 2.0}))
    for name, value in (("beta", 1.0), ("f0", 2.0)):
        p = found.parameters[name]
        assert (p.value, p.sem, p.ci95, p.free) == (value, None, None, False)
        assert p.verdict is Verdict.FIXED
        assert p.note == "fixed, not estimated"
        assert name not in found.covariance.names
    assert len(found.covariance.names) == 13


def test_without_relaxation_its_time_constant_means_nothing(noisy):
    p = assess(quick([noisy], fixed={"k_rel": 0.0})).parameters["tau_rel"]
    assert p.sem is None
    assert p.verdict is Verdict.UNDETERMINED
    assert "does not depend on it" in p.note


def test_at_a_bound_there_is_no_interval_and_the_others_do_not_take_it_as_known(noisy):
    result = quick([noisy], bounds={"m": (2.9, 3.0), "beta": (0.2, 0.5)})
    found = assess(result)
    assert result.status == "at-bounds"
    for name, side in (("m", "lower"), ("beta", "upper")):
        p = found.parameters[name]
        assert p.at_bound
        assert p.free
        assert (p.sem, p.ci95) == (None, None)
        assert p.verdict is Verdict.AT_BOUND
        assert p.note.startswith(f"at its {side} bound")
    assert "m" not in found.covariance.names
    # The tighter a bound, the less the others lose to not knowing where in it the value lies.
    known = assess(quick([noisy], fixed={name: result.values[name] for name in ("m", "beta")}))
    for name in found.covariance.names:
        assert found.parameters[name].sem > 0.98 * known.parameters[name].sem
    assert found.parameters["f0"].sem > 1.1 * known.parameters["f0"].sem
    assert found.covariance.dof == noisy.n - len(found.covariance.names)
    assert "m" in found.ipde_note


@pytest.fixture(scope="module")
def silent(noisy):
    """Fit without any triceps EMG."""
    return quick([with_emg(noisy, gl=0.0, sol=0.0, gm=0.0)])


def test_silent_triceps(silent):
    found = assess(silent)
    for name in ("g2", "g3", "g4", "l0_tri"):
        p = found.parameters[name]
        assert (p.sem, p.ci95) == (None, None), name
        if not p.at_bound:
            assert p.verdict is Verdict.UNDETERMINED
            assert "does not depend on it" in p.note
    assert found.parameters["m"].sem is not None
    assert "g2" in found.ipde_note


@pytest.mark.parametrize(
    ("half", "verdict"),
    [(0.0, "identified"), (0.2, "identified"), (0.2 * (1 + 1e-9), "weak"), (5.0, "undetermined")],
)
def test_the_threshold_is_ten_percent(fitted, half, verdict):
    estimated = assess(fitted).covariance
    assert IDENTIFIED == 0.1
    for value in (2.0, -2.0):
        found, note = judge_interval("m", value, half, estimated)
        assert found == verdict
        assert ("%" in note) is (verdict != "undetermined")


def test_a_value_of_zero_is_never_identified(fitted):
    verdict, note = judge_interval("k_rel", 0.0, 1e-3, assess(fitted).covariance)
    assert verdict is Verdict.UNDETERMINED
    assert note.startswith("not distinguishable from 0")
    verdict, note = judge_interval("m", 0.0, 1e-3, assess(fitted).covariance)
    assert verdict is Verdict.UNDETERMINED
    assert note.startswith("not determined")


@pytest.mark.parametrize(
    ("name", "value", "half", "unit", "said"),
    [
        ("k_rel", 0.012, 0.345, "-", "−0.33 … 0.36"),
        ("k_rel", 0.0, 0.1, "-", "−0.1 … 0.1"),
        ("emd", 1.6e-3, 21.5e-3, "s", "−20 … 23 ms"),
        ("emd", 0.5, 2.0, "s", "−1.5 … 2.5 s"),
        ("reflex_tri", 12.3, 456.0, "N·s/m", "−440 … 470 N·s/m"),
        ("g2", 2e5, 2e5, "N/V", "0 … 400000 N/V"),
        ("F0", -3.0, 5.0, "N", "−8 … 2 N"),
    ],
)
def test_what_may_be_off_is_not_told_in_percent(fitted, name, value, half, unit, said):
    estimated = assess(fitted).covariance
    j = estimated.names.index("k_rel")
    alone = replace(  # a parameter of this name that trades off with no other
        estimated,
        names=tuple(name if i == j else f"p{i}" for i in range(len(estimated.names))),
        correlation=np.eye(len(estimated.names)),
    )
    verdict, note = judge_interval(name, value, half, alone)
    assert verdict is not Verdict.IDENTIFIED
    assert note == f"not distinguishable from 0 (95 %: {said})"
    # As soon as its interval leaves 0 out, a percentage means something.
    _, note = judge_interval(name, 1.01 * half, half, alone)
    assert note.startswith("known only to ±99 %")


def test_an_inadequate_fit_identifies_nothing(fitted):
    estimated = assess(fitted).covariance
    verdict, note = judge_interval("m", 2.0, 0.01, estimated, withheld=True)
    assert verdict is Verdict.WEAK
    assert "inadequate" in note


def test_a_partner_of_what_may_be_off_is_named(fitted):
    estimated = assess(fitted).covariance
    names = list(estimated.names)
    names[names.index("x0_tri")] = "emd"  # which trades off with k_tri
    _, note = judge_interval("emd", 1e-3, 1e-2, replace(estimated, names=tuple(names)))
    assert note.startswith("not distinguishable from 0 (95 %: −9 … 11 ms): trades off with k_tri")


def test_a_strong_partner_is_named(fitted):
    estimated = assess(fitted).covariance
    strongest = np.abs(np.triu(estimated.correlation, 1))
    i, j = np.unravel_index(np.argmax(strongest), strongest.shape)
    assert strongest[i, j] > 0.9  # stiffness and slack length
    _, note = judge_interval(estimated.names[i], 1.0, 1.0, estimated)
    assert f"trades off with {estimated.names[j]}" in note
    loose = int(np.argmin((np.abs(estimated.correlation) - np.eye(15)).max(axis=0)))
    _, note = judge_interval(estimated.names[loose], 1.0, 1.0, estimated)
    assert "little influence" in note


def test_predict_by_hand(fitted, noisy, clean):
    one, two = predict_others(fitted, [noisy, clean], None)
    np.testing.assert_allclose(one.torque, noisy.torque - fitted.residuals[0], atol=1e-9)
    assert one.vaf == pytest.approx(assess(fitted).vaf, abs=1e-9)
    e = clean.torque - two.torque
    assert two.rmse == pytest.approx(np.sqrt(np.mean(e**2)), rel=1e-12)
    assert two.bias == pytest.approx(e.mean(), rel=1e-9)
    assert two.vaf == pytest.approx(100 * (1 - e @ e / (clean.torque @ clean.torque)), rel=1e-12)
    assert two.vaf > 99.9


def test_predict_needs_a_torque(fitted, noisy):
    for torque in (None, np.zeros(noisy.n)):
        with pytest.raises(InputError, match="no torque to compare"):
            predict_others(fitted, [replace(noisy, torque=torque)], None)


def test_a_verdict_that_hangs_on_one_of_several_starts_is_none(fitted, monkeypatch):
    """Rounding decides then in which of two minima the search ends."""
    monkeypatch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
    sure = [n for n, p in assess(fitted).parameters.items() if p.verdict is Verdict.IDENTIFIED]
    assert sure
    starts = (*fitted.solution.starts, replace(fitted.solution.starts[0], sse=1e3))
    found = assess(replace(fitted, solution=replace(fitted.solution, starts=starts, agreeing=1)))
    for name in sure:
        assert found.parameters[name].verdict is Verdict.WEAK
        assert "its starts disagree" in found.parameters[name].note
    alone = replace(fitted.solution, starts=fitted.solution.starts[:1], agreeing=1)
    found = assess(replace(fitted, solution=alone))
    for name in sure:
        assert found.parameters[name].verdict is Verdict.WEAK
        assert "one start alone was made" in found.parameters[name].note
