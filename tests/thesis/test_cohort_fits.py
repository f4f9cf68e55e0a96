"""Which fits of the cohort are asked for, and what one of them gives."""

import json

import numpy as np
import pytest

from surae_thesis.cohort import joint, plan, work
from surae_thesis.cohort.members import make_cohort
from surae_thesis.cohort.trials import REMOVABLE
from surae_thesis.section import Context

TINY = plan.Size(1, 3, 2, 64.0, 1, 1)


@pytest.fixture(scope="module")
def settings():
    return plan.fit_settings(
        TINY, 3, [("ramp-and-hold", 1), ("multiple-holds", 1)], "2.0",
        free=("dlt_tri",), predicted=[("ramp-and-hold", 2)],
    )  # fmt: skip


@pytest.fixture(scope="module")
def outcome(settings):
    return work.fit_job(**settings)


def test_the_full_plan_is_that_of_the_thesis(tmp_path):
    size = plan.Size.of(Context(folder=tmp_path))
    jobs = plan.single_fits(size)
    assert len(jobs) == (14 + 14 + 7) * 3 * 4
    holds = jobs["2.1 S01 multiple-holds 1"]
    assert holds["model"] == "muscle-tendon-strain"
    assert holds["rate_hz"] == 256.0
    assert holds["predicted"] == [["multiple-holds", 2], ["multiple-holds", 3]] + [
        ["ramp-and-hold", r] for r in (1, 2, 3)
    ]
    assert jobs["2.1 S01 multiple-holds 2"]["predicted"] == []
    assert len(plan.baselines(size)) == 4 * 2


def test_the_quick_plan_passes_through_the_same_with_less(tmp_path):
    size = plan.Size.of(Context(folder=tmp_path, quick=True))
    assert (size.subjects, size.repetitions) == (5, 2)
    assert size.members == make_cohort(1, 5)
    jobs = plan.single_fits(size)
    assert {label.split()[0] for label in jobs} == set(plan.MODELS)
    assert len(jobs) < 100


def test_every_imperfection_is_spared_in_turn():
    jobs = plan.spared_fits(TINY)
    without = {tuple(job["without"]) for job in jobs.values()}
    assert without == {(name,) for name in REMOVABLE} | {tuple(REMOVABLE)}
    assert {job["model"] for job in jobs.values()} == {"muscle", "muscle-tendon"}


def test_some_subjects_are_looked_at_closer():
    size = plan.Size(1, 5, 2, 64.0, 1, 1, 2)
    for jobs in (plan.explicit_fits(size), plan.spared_fits(size)):
        assert {job["member"] for job in jobs.values()} == {0, 1}
    assert {job["member"] for job in plan.strain_fits(size).values()} == set(range(5))


def test_the_explicit_integrator_runs_at_the_rate_of_the_thesis():
    jobs = plan.explicit_fits(TINY)
    assert {job["rate_hz"] for job in jobs.values()} == {1000.0}
    assert {job["options"]["integrator"] for job in jobs.values()} == {"explicit-euler"}
    assert "1.0 S01 multiple-holds 1" not in jobs
    strains = plan.strain_fits(TINY)
    assert strains.keys() == jobs.keys()
    assert {job["options"]["tendon_strain"] for job in strains.values()} == {"slack-length"}


def test_joint_fits_leave_the_last_repetition_out():
    for job in joint.joint_jobs(TINY).values():
        assert job["starts"] == 2  # of one start the best is always the first
        assert {r for _, r in job["trials"]} == {1}
        assert {r for _, r in job["predicted"]} == {2}


def test_a_fit_gives_plain_data_with_the_truth_beside_it(outcome):
    assert json.loads(json.dumps(outcome, allow_nan=False)) == outcome
    who = make_cohort(1)[3].subject
    parameters = outcome["parameters"]
    assert parameters["l0_tri"]["true"] == who.parameters["l0_tri"]
    assert parameters["dlt_tri"]["true"] == who.tendons["dlt_tri"]
    assert parameters["dlt_tri"]["free"]
    assert parameters["g1"]["true"] is None
    assert not parameters["pt_tri"]["free"]
    assert outcome["vaf"] > 80.0
    (predicted,) = outcome["predicted"]
    assert predicted["repetition"] == 2
    assert predicted["vaf"] > 50.0


def test_correlation_and_sizes_are_those_of_the_fit(outcome, settings):
    names, matrix = outcome["correlation"]["names"], np.array(outcome["correlation"]["matrix"])
    free = {n for n, p in outcome["parameters"].items() if p["free"] and not p["at_bound"]}
    assert set(names) <= free
    np.testing.assert_allclose(np.diag(matrix), 1.0)
    fit = work.fitted(**settings)
    assert fit.values["m"] == pytest.approx(outcome["parameters"]["m"]["value"])
    highest = max(np.abs(inputs.torque).max() for inputs in fit.result.problem.inputs)
    assert outcome["sizes"]["measured"] == pytest.approx(highest)


def test_a_fit_that_is_spared_its_imperfections_is_better(settings, outcome):
    spared = work.fit_job(**settings | {"without": list(REMOVABLE), "predicted": []})
    assert spared["vaf"] > outcome["vaf"]
    assert spared["vaf"] > 99.0
    assert spared["parameters"]["dlt_tri"]["true"] is None  # Table 2's, not the subject's


def test_only_a_strain_of_the_slack_length_reaches_the_torques_of_the_thesis():
    strengths = [
        work.strength_job(seed=1, member=number, protocol="multiple-holds", rate_hz=64.0)
        for number in (0, 3)
    ]
    for strength in strengths:
        assert strength["measured"] > 1.4 * strength["printed"]
    assert max(strength["measured"] for strength in strengths) > 55.0


@pytest.mark.slow
def test_a_fair_optimiser_is_no_worse_than_where_it_begins(monkeypatch):
    monkeypatch.setattr(work, "_EVALUATIONS", 3)
    who = make_cohort(1)[3].subject
    vafs = work.explicit_job(
        seed=1, member=3, protocol="multiple-holds", rate_hz=1000.0, implicit=who.parameters
    )
    assert vafs["warm"] >= vafs["replayed"] - 1e-6
    assert vafs["default"] is not None


def test_a_baseline_is_the_mean_of_simulations():
    errors = work.baseline_job(
        seed=1, protocol="multiple-holds", model="muscle", subjects=1, rate_hz=64.0
    )
    assert set(errors) >= {"m", "k_tri", "g1", "l0_tri", "f0"}
    assert all(value > 0.0 for value in errors.values())
