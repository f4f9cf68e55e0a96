"""Measured trials of one leg: what is said of it holds, and no trial denies another."""

from itertools import combinations

import numpy as np
import pytest

import surae
from surae.inference import assess

TRIALS = {
    "PL_50_01": "dynamometer",
    "PL_50_02": "repeats",
    "PL_0_01": "repeats",
    "PL_100_01": "repeats",
}
INVARIANT = ("passive_exponent", "active_width", "tendon_rotational", "torque_gain", "maximal")
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
            codes = [reason.code for reason in fits[trial].adequacy.against]
            assert codes in (["implausible"], ["no-model"])
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


@pytest.fixture(scope="module")
def by_work(shared, tmp_path_factory):
    """A trial fitted along paths that conserve work, which travel 2.8 and 1.5 times as far."""
    told = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    path = shared / "repeats" / "PL_50_02.mat"
    mapping = tmp_path_factory.mktemp("by_work") / "trial.toml"
    mapping.write_text(told.replace("PL_50_01.mat", str(path)), encoding="utf-8")
    return surae.fit(mapping, geometry="virtual-work")


@pytest.mark.slow
def test_both_geometries_agree_in_what_no_path_changes_and_overlap_in_all_else(
    fits, by_work
) -> None:
    one = fits["PL_50_02"]
    told = one.measures(), by_work.measures()
    for name in told[0].keys() & told[1].keys():
        p, q = told[0][name], told[1][name]
        if p.ci95 is None or q.ci95 is None:
            continue
        assert max(p.ci95[0], q.ci95[0]) <= min(p.ci95[1], q.ci95[1]), name
        if name.startswith(INVARIANT):
            both = np.hypot(np.ptp(p.ci95), np.ptp(q.ci95)) / 2.0
            assert abs(p.value - q.value) <= both, name
    for name in one.parameters.keys() & by_work.parameters.keys():
        p, q = one.parameters[name], by_work.parameters[name]
        if p.ci95 is not None and q.ci95 is not None:
            assert max(p.ci95[0], q.ci95[0]) <= min(p.ci95[1], q.ci95[1]), name


@pytest.mark.slow
def test_no_measured_trial_is_said_to_soften(fits) -> None:
    for fit in fits.values():
        assert not any("softened" in reason for reason in fit.adequacy.reasons)


@pytest.mark.slow
@pytest.mark.xfail(
    strict=True,
    reason="of PL_50_01 it is said since its laboratory is no longer called implausible: either "
    "makes the fit doubtful, and which is true nobody knows",
)
def test_no_measured_trial_is_said_to_differ_from_all_models(fits) -> None:
    for fit in fits.values():
        assert "no-model" not in [reason.code for reason in fit.adequacy.against]


@pytest.mark.slow
def test_measured_trials_of_one_leg_are_not_said_to_be_of_several(fits) -> None:
    recordings = [fits[trial].result.problem.inputs[0] for trial in TRIALS]
    together = surae.fit(recordings, fits["PL_50_02"].settings)
    assert "not-one-leg" not in [reason.code for reason in together.adequacy.against]


@pytest.mark.slow
def test_repeats_of_a_leg_do_not_deny_each_other(fits) -> None:
    """A tendon had two modes, 0.6 to 0.9 or 9 to 20 mm, and each interval but one of them."""
    apart = pairs = 0
    for one, other in combinations([fits[trial] for trial in TRIALS], 2):
        for name in one.parameters.keys() & other.parameters.keys():
            p, q = one.parameters[name].ci95, other.parameters[name].ci95
            if p is not None and q is not None and one.parameters[name].free:
                pairs += 1
                apart += max(p[0], q[0]) > min(p[1], q[1])
    assert pairs > 60
    assert apart <= 0.05 * pairs
