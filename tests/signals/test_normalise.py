"""EMG over one number for each muscle and session."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api.recordings import as_in_fit
from surae.base.errors import InputError
from surae.signals import emg_reference, normalise, normalised, quiet_levels, steady_emg


@pytest.fixture(scope="module")
def session(clean):
    """Two trials of one session, the second half as strong."""
    weak = replace(clean, name="weak", emg=0.5 * clean.emg)
    return clean, weak


def averaged(signal, rate):
    width = round(0.25 * rate)
    return np.convolve(np.abs(signal), np.ones(width) / width, "valid").max()


def test_one_number_for_all_recordings(session):
    strong, weak = normalise(session)
    expected = [averaged(session[0].emg[:, c], session[0].rate_hz) for c in range(4)]
    for after, before in zip((strong, weak), session, strict=True):
        np.testing.assert_allclose(after.emg, before.emg / expected, rtol=1e-12)
        assert after.emg_unit == "1"
        assert not after.emg.flags.writeable
    assert strong.emg_reference == weak.emg_reference
    assert strong.emg_reference.values == pytest.approx(expected)
    assert "EMG normalised: divided by the session's largest envelope" in strong.steps[-1]
    assert max(averaged(strong.emg[:, c], strong.rate_hz) for c in range(4)) == pytest.approx(1.0)


def test_maximum_contractions_set_the_reference(session):
    strong, weak = session
    (normalised,) = normalise([weak], "mvc", mvc=[strong])
    assert normalised.emg_reference.kind == "mvc"
    assert averaged(normalised.emg[:, 0], normalised.rate_hz) == pytest.approx(0.5)


def test_a_spike_is_no_peak(session):
    spiky = session[0].emg.copy()
    spiky[100, 0] *= 1000.0
    plain = emg_reference(session[:1]).values[0]
    value = emg_reference([replace(session[0], emg=spiky)]).values[0]
    assert value < 1000.0 * plain / (0.2 * session[0].rate_hz)


def test_a_missing_muscle_stays_zero_and_has_no_reference(session):
    emg = session[0].emg.copy()
    emg[:, 2] = 0.0
    without = replace(session[0], emg=emg, missing_emg=("sol",))
    (alone,) = normalise([without])
    assert alone.emg_reference.values[2] is None
    assert not alone.emg[:, 2].any()
    with pytest.raises(InputError, match="emg_sol has no reference"):
        normalised(session[0], alone.emg_reference)


def test_refusals(session):
    strong, weak = session
    silent = replace(strong, emg=np.zeros_like(strong.emg))
    (done,) = normalise([strong])
    for arguments, says in (
        (([strong], "mvc"), "needs recordings of maximum contractions"),
        (([silent],), "emg_ta is zero throughout"),
        (([done, weak],), "normalised already"),
    ):
        with pytest.raises(InputError, match=says):
            normalise(*arguments)
    with pytest.raises(InputError, match="no effect on session"):
        normalise([strong], "session", mvc=[weak])
    with pytest.raises(InputError, match="normalised already, by another reference"):
        normalised(normalise([weak])[0], done.emg_reference)
    assert normalised(done, done.emg_reference) is done
    assert normalised(strong, None) is strong


def test_a_joint_fit_of_trials_normalised_each_by_itself_is_refused(session):
    apart = [normalise([recording])[0] for recording in session]
    with pytest.raises(InputError, match=r"divided by another reference.*never each by itself"):
        surae.fit(apart, "muscle", starts=1)


@pytest.mark.slow
def test_the_fit_is_the_same_but_for_the_unit_of_the_weights(noisy, tmp_path):
    half = replace(noisy, name="half", emg=noisy.emg, files=())
    volts = surae.fit([noisy, half], "muscle", starts=2)
    fit = surae.fit([noisy, half], "muscle", normalise="session", starts=2)
    reference = fit.result.problem.inputs[0].emg_reference
    assert fit.parameters["g1"].unit == "N"
    assert fit.vaf == pytest.approx(volts.vaf, abs=1e-4)
    for number, value in enumerate(reference.values, start=1):
        expected = value * volts.values[f"g{number}"]
        assert fit.values[f"g{number}"] == pytest.approx(expected, rel=1e-3)
    for name in ("l0_tri", "k_tri", "f0"):
        assert fit.values[name] == pytest.approx(volts.values[name], rel=1e-3)
    fit.save(tmp_path / "fit.json")
    again = surae.load(tmp_path / "fit.json")
    assert again.result.problem.inputs[0].emg_reference == reference

    # Another trial, of half the effort: with the fit's reference it is predicted as before.
    other = replace(noisy, name="other", emg=0.5 * noisy.emg)
    for each in (fit, again):
        predicted = each.predict(other)
        assert predicted.vaf == pytest.approx(volts.predict(other).vaf, abs=1e-2)
        (used,) = as_in_fit(each.result.problem, [other], None)
        np.testing.assert_allclose(used.emg, other.emg / np.array(reference.values), rtol=1e-12)
    own = normalise([other])[0]
    with pytest.raises(InputError, match="by another reference"):
        fit.predict(own)


def test_options_that_contradict(noisy):
    with pytest.raises(InputError, match="no effect without normalise='mvc'"):
        surae.fit(noisy, "muscle", mvc=[noisy])
    with pytest.raises(InputError, match="use one of: session, mvc"):
        surae.fit(noisy, "muscle", normalise="trial")


def test_an_electrode_at_rest_is_what_its_quietest_second_shows(clean):
    n = clean.n
    emg = np.full((n, 4), 0.5)
    quiet = slice(n // 2, n // 2 + round(2 * clean.rate_hz))
    emg[quiet] = [0.004, 0.002, 0.008, 0.5]
    emg[:, 1] *= -1.0  # noise of an envelope may be below zero
    levels = quiet_levels([replace(clean, emg=emg), clean])
    own = quiet_levels([clean])
    assert levels[0] == pytest.approx(min(0.004, own[0]))
    assert all(level >= 0.0 for level in levels)
    # a muscle that is never quiet does not tell: 2 % of its effort
    busy = np.tile(np.linspace(0.1, 0.5, n)[:, None], 4)
    assert quiet_levels([replace(clean, emg=busy)]) == pytest.approx([0.01] * 4, rel=0.02)
    assert quiet_levels([replace(clean, emg=np.zeros((n, 4)))]) == (0.0,) * 4


def test_steady_emg_may_be_all_rest(clean):
    """Of a leg whose EMG hardly changes nothing tells rest from effort."""
    steady = np.array(clean.emg)
    steady[:, 0] = 2e-6
    inputs = [replace(clean, emg=steady)]
    assert steady_emg(inputs) == (True, False, False, False)
    assert quiet_levels(inputs)[0] == pytest.approx(2e-6)
    assert quiet_levels(inputs)[1:] == quiet_levels([clean])[1:]
