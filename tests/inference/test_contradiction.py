"""A named model is held against what it does not know of, and only contradicted where data do."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from richer_legs import richer_leg
from surae.inference import Verdict, assess, make_problem, solve
from surae.inference.least_squares.contradiction import contradiction
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES, read
from surae.signals import prepare
from surae.studies import virtual_subject, virtual_trial
from surae.studies.virtual import virtual_recording


def as_of_two_starts(result):
    """The result as if a second start had come to it: of one alone nothing is claimed."""
    twice = replace(result.solution, starts=2 * result.solution.starts, agreeing=2)
    return replace(result, solution=twice)


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    """Fits of richer legs, from files, by models that know of no laboratory."""
    folder, made = tmp_path_factory.mktemp("legs"), []
    for seed in (310, 311):
        leg = richer_leg(seed)
        leg.write(folder / f"{seed}.csv")
        inputs = prepare(read(folder / f"{seed}.csv"))
        made += [
            (leg, as_of_two_starts(solve(make_problem([inputs], model, starts=1))))
            for model in ("muscle", "muscle-tendon-strain")
        ]
    return made


def test_what_a_named_model_leaves_out_is_not_identified(legs) -> None:
    before = false_before = after = false_after = 0
    for leg, result in legs:
        against = contradiction(result)
        assert against is not None
        assert {"zero", "delay", "crosstalk"} <= set(against.missing)
        plain, held = assess(result), assess(result, alternatives=True)
        for name, p in held.parameters.items():
            old = plain.parameters[name]
            assert p.value == old.value
            assert p.sem == old.sem
            if p.verdict is Verdict.IDENTIFIED:
                after += 1
                false_after += not p.ci95[0] <= leg.parameters[name] <= p.ci95[1]
            if old.verdict is Verdict.IDENTIFIED:
                before += 1
                false_before += not old.ci95[0] <= leg.parameters[name] <= old.ci95[1]
                assert p.ci95[0] <= old.ci95[0] < old.ci95[1] <= p.ci95[1]
                assert p.repeatable
                assert p.ci95_repeat == old.ci95
                assert sum(p.budget.values()) == pytest.approx(1.0)
                if p.verdict is not Verdict.IDENTIFIED:
                    assert "the data contradict this model" in p.note
    assert false_before > 0.5 * before
    assert after < before
    assert false_after < 0.5 * false_before


def test_a_model_that_holds_is_not_contradicted(noisy) -> None:
    result = solve(make_problem([noisy], "muscle", starts=2))
    assert contradiction(result) is None
    assert assess(result, alternatives=True) == assess(result)


def filed(trial, path):
    """What becomes of a trial as a CSV file through the ordinary filters."""
    columns = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque}
    columns |= {f"emg_{m}_V": trial.emg[:, i].clip(0.0) for i, m in enumerate(MUSCLES)}
    surae.write_csv(path, columns, ["emg: envelope"])
    return prepare(read(path))


@pytest.mark.parametrize("chirp", [(0.2, 0.5), pytest.param((0.1, 0.2), marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "seed", [53, *(pytest.param(s, marks=pytest.mark.slow) for s in (50, 51, 52, 54, 55, 56, 58))]
)
def test_a_leg_of_the_model_is_not_contradicted(seed, chirp, tmp_path) -> None:
    """Nor where a chirp of 17 Hz was filtered at 20 Hz: what filters do is no part of a leg."""
    amplitude, rate = chirp
    motion = generate(
        Protocol(
            profile="multiple-holds", chirp_amplitude=amplitude, chirp_rate=rate, rate_hz=125.0
        )
    )
    trial = virtual_trial(virtual_subject(seed), motion)
    for inputs in (trial, filed(trial, tmp_path / "leg.csv")):
        assert contradiction(solve(make_problem([inputs], "muscle", starts=1))) is None


@pytest.mark.slow
@pytest.mark.parametrize("seed", [70, 73, 74])
def test_noise_of_the_emg_contradicts_no_model(seed) -> None:
    """Much noise on the envelopes, and raw EMG, which fluctuates by as much as itself."""
    subject, asked = (
        virtual_subject(seed),
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.16, rate_hz=1024.0),
    )
    raw = prepare(virtual_recording(subject, generate(asked)))
    loud = virtual_trial(subject, generate(replace(asked, rate_hz=128.0)), noise=0.15)
    for inputs in (raw, loud):
        assert contradiction(solve(make_problem([inputs], "muscle", starts=1))) is None


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(312, 316))
def test_richer_legs_are_contradicted(seed) -> None:
    leg = richer_leg(seed)
    assert contradiction(solve(make_problem([leg.inputs], "muscle", starts=1))) is not None


def test_a_zero_that_recordings_share_is_one_zero() -> None:
    """Where the zero is a parameter of a named model it is no nuisance of each recording."""
    trials = [richer_leg(310, trial=trial).inputs for trial in (0, 1)]
    told = solve(make_problem(trials, "muscle", starts=1, free=["torque_zero"]))
    against = contradiction(told)
    assert against is not None
    assert "zero" not in against.missing
    assert "torque_zero" in against.shift


def test_what_is_known_is_no_alternative(legs) -> None:
    _, result = legs[0]
    inputs = result.problem.inputs
    told = solve(make_problem(inputs, "muscle", starts=1, free=("torque_zero", "emd")))
    against = contradiction(told)
    assert against is not None
    assert "zero" not in against.missing
    assert "delay" not in against.missing


def test_a_family_and_its_answer_are_held_against_themselves_already(noisy) -> None:
    result = solve(make_problem([noisy], "auto", nuisances="none"))
    assert contradiction(result) is None


def test_a_fit_as_people_make_it_is_held_against_the_rest(legs, tmp_path) -> None:
    leg, _ = legs[0]
    leg.write(tmp_path / "leg.csv")
    fit = surae.fit(tmp_path / "leg.csv", model="muscle", starts=1, quality=())
    assert "what models with zero, delay, crosstalk, tendons give" in fit.assessment.interval_note
    fit.save(tmp_path / "fit.json")
    again = surae.load(tmp_path / "fit.json")
    assert again == fit
    assert np.isfinite([p.ci95 for p in again.parameters.values() if p.ci95]).all()
