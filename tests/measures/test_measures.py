"""What measures of a fit claim, and where they must not claim it."""

import json
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.inference import Verdict
from surae.measures import measures_of_values
from surae.measures.spread import spread_of
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def still() -> surae.Fit:
    """A leg that holds still: a fit that is inadequate, whatever its VAF."""
    motion = generate(Protocol(profile="multiple-holds", duration=20.0, rate_hz=100.0))
    trial = virtual_trial(virtual_subject(2), motion)
    moved = {name: 0.02 * getattr(trial, name) for name in ("angle", "velocity", "acceleration")}
    return surae.fit(replace(trial, **moved), "muscle", starts=2, quality=())


@pytest.fixture(scope="module")
def told(fitted):
    """What a richer leg's fit says, at 45° too, which was not measured."""
    return fitted(1)[0].measures([0.0, 10.0, 45.0])


def test_a_richer_leg_is_known_by_its_measures(fitted, told) -> None:
    _, truth = fitted(1)
    true = measures_of_values(truth, "muscle-tendon")
    identified = [m for m in told.values() if m.verdict is Verdict.IDENTIFIED and m.name in true]
    comparable = [m for m in identified if not m.name.startswith("torque_per_emg")]
    assert len(comparable) >= 10
    held = [m.ci95[0] <= true[m.name] <= m.ci95[1] for m in comparable]
    assert held.count(False) <= len(held) // 5


def test_stiffness_is_far_better_known_than_what_it_is_made_of(fitted, told) -> None:
    fit, _ = fitted(1)
    stiffness = told["passive_stiffness_tri@10deg"]
    part = (stiffness.ci95[1] - stiffness.ci95[0]) / stiffness.value
    x0 = fit.parameters["x0_tri"]
    k = fit.parameters["k_tri"]
    made_of = np.hypot(k.value * (x0.ci95[1] - x0.ci95[0]), k.ci95[1] - k.ci95[0])
    assert part < 0.5 * made_of  # of exp(−k·x0), which is most of it


def test_a_saved_fit_has_the_same_measures(fitted, told, tmp_path) -> None:
    fitted(1)[0].save(tmp_path / "fit.json")
    assert surae.load(tmp_path / "fit.json").measures([0.0, 10.0, 45.0]) == told


def test_what_was_not_measured_is_not_identified(told) -> None:
    beyond = told["passive_torque@45deg"]
    assert beyond.verdict is not Verdict.IDENTIFIED
    assert "was not measured" in beyond.note


def test_an_inadequate_fit_identifies_no_measure(still) -> None:
    assert still.adequacy.grade == "inadequate"
    verdicts = {m.verdict for m in still.measures().values()}
    assert Verdict.IDENTIFIED not in verdicts


def test_what_a_model_lacks_is_none_with_the_reason(still) -> None:
    tendon = still.measures()["tendon_stiffness_tri@500N"]
    assert tendon.value is tendon.ci95 is None
    assert "rigid" in tendon.note


def test_a_measure_of_fixed_parameters_has_no_interval() -> None:
    motion = generate(Protocol(profile="multiple-holds", duration=20.0, rate_hz=100.0))
    trial = virtual_trial(virtual_subject(2), motion)
    fit = surae.fit(trial, "muscle", starts=2, fixed={"f0": 2.0, "beta": 1.0}, quality=())
    bandwidth = fit.measures()["bandwidth"]
    assert bandwidth.verdict is Verdict.FIXED
    assert bandwidth.ci95 is None


def test_a_measure_that_bends_has_the_interval_of_legs_that_the_data_allow(noisy) -> None:
    fit, name = surae.fit(noisy, "muscle", starts=1, quality=()), "passive_stiffness_tib@10deg"
    bent, spread = fit.measures()[name], spread_of(fit.result, fit.assessment)
    legs = (dict(zip(spread.names, leg, strict=True)) for leg in spread.draws(1000, seed=1))
    allowed = [measures_of_values(leg, "muscle", only=[name])[name] for leg in legs]
    low, high = np.percentile(allowed, [2.5, 97.5])
    assert bent.ci95 == pytest.approx((low, high), abs=0.15 * (high - low))
    assert bent.value - low > 1.5 * (high - bent.value)


def test_files(still, tmp_path) -> None:
    told = still.measures([10])
    told.save(tmp_path / "m.json")
    data = json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))
    stiffness = data["measures"]["passive_stiffness@10deg"]
    assert stiffness["unit"] == "Nm/deg"
    assert stiffness["value"] == told["passive_stiffness@10deg"].value
    told.save(tmp_path / "m.csv")
    lines = (tmp_path / "m.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + len(told)
    with pytest.raises(InputError, match="json"):
        told.save(tmp_path / "m.xlsx")


@pytest.mark.slow
def test_intervals_hold_the_truth_of_richer_legs(fitted) -> None:
    """Twelve legs; the count over many more is in the page on measures."""
    held, claimed = [], []
    for seed in range(12):
        fit, truth = fitted(seed, rate_hz=128.0)
        true = measures_of_values(truth, "muscle-tendon")
        for m in fit.measures().values():
            if m.name in true and m.ci95 and not m.name.startswith("torque_per_emg"):
                inside = m.ci95[0] <= true[m.name] <= m.ci95[1]
                held.append(inside)
                if m.verdict is Verdict.IDENTIFIED:
                    claimed.append(inside)
    assert np.mean(held) >= 0.85
    assert np.mean(claimed) >= 0.85
    assert len(claimed) > 0.4 * len(held)
