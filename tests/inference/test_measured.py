"""Measured trials of one leg: what is said of it holds, and no trial denies another."""

from itertools import combinations

import pytest

import surae
from surae.inference import assess

TRIALS = {
    "PL_50_01": "dynamometer",
    "PL_50_02": "repeats",
    "PL_0_01": "repeats",
    "PL_100_01": "repeats",
}
PASSIVE = {"Pas_Sho2Long": "dynamometer"}


@pytest.fixture(scope="module")
def fits(shared, tmp_path_factory):
    told = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    folder = tmp_path_factory.mktemp("trials")
    made = {}
    for trial, where in (TRIALS | PASSIVE).items():
        path = shared / where / f"{trial}.mat"
        mapping = folder / f"{trial}.toml"
        mapping.write_text(told.replace("PL_50_01.mat", str(path)), encoding="utf-8")
        made[trial] = surae.fit(mapping)
    return made


@pytest.mark.slow
def test_the_interval_of_a_measured_optimal_length_holds_what_ultrasound_shows(fits, monkeypatch):
    """63.5 to 63.8 mm in all four trials; noise of the raw EMG once made it many times as wide.

    One trial is followed best by a plate that gives way by 7° where the three others show none:
    that trial is doubted by name, and its interval holds all the same. What arms and paths may be
    is put aside for the width: with it the interval is twice the value wide, and says so.
    """
    doubted = [trial for trial in TRIALS if fits[trial].adequacy.grade != "adequate"]
    assert len(doubted) <= 1
    for trial in TRIALS:
        assert fits[trial].adequacy.grade != "inadequate"
        if trial in doubted:
            assert [reason.code for reason in fits[trial].adequacy.against] == ["implausible"]
        told = fits[trial].parameters["l0_tib"]
        assert told.ci95[0] < 0.0635
        assert told.ci95[1] > 0.0638
        assert told.verdict != "identified"
        with monkeypatch.context() as patch:
            patch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
            low, high = assess(fits[trial].result).parameters["l0_tib"].ci95
        assert low < 0.0635
        assert high > 0.0638
        assert high - low < 0.5 * told.value


@pytest.mark.slow
def test_what_is_identified_of_a_measured_leg_does_not_differ_between_its_trials(fits):
    for one, other in combinations(fits.values(), 2):
        for name in one.parameters.keys() & other.parameters.keys():
            p, q = one.parameters[name], other.parameters[name]
            if p.verdict == q.verdict == "identified":
                assert max(p.ci95[0], q.ci95[0]) <= min(p.ci95[1], q.ci95[1]), name


@pytest.mark.slow
def test_a_relaxed_trial_claims_no_optimal_length_that_ultrasound_denies(fits):
    """It once rested at 40 mm, at a bound, and its interval ended below what every film shows."""
    passive = fits["Pas_Sho2Long"].parameters["l0_tib"]
    assert passive.verdict != "identified"
    if passive.verdict == "at-bound":
        assert passive.ci95 is None
    else:
        assert passive.ci95[0] < 0.0635
        assert passive.ci95[1] > 0.0638


@pytest.mark.slow
def test_no_measured_trial_is_said_to_soften(fits):
    for fit in fits.values():
        assert not any("softened" in reason for reason in fit.adequacy.reasons)
        assert not any("no model" in reason for reason in fit.adequacy.reasons)


@pytest.mark.slow
def test_measured_trials_of_one_leg_are_not_said_to_be_of_several(fits) -> None:
    recordings = [fits[trial].result.problem.inputs[0] for trial in TRIALS]
    together = surae.fit(recordings, fits["PL_50_02"].settings)
    assert "not-one-leg" not in [reason.code for reason in together.adequacy.against]
