"""Every rule of the simulation study on made-up grids that obey the thesis, and that do not."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from surae.studies import virtual_trial
from surae_thesis.claims import INTEGRATOR, NotThereError, judge, read_claims
from surae_thesis.legs import (
    EARLY,
    IN_TURN,
    LEAD,
    NOISE,
    STRAIN,
    fit_cell,
    fit_explicit,
    motion,
    thesis_leg,
    thesis_trial,
)
from surae_thesis.simulation import RULES
from surae_thesis.simulation.cells import (
    AMPLITUDES,
    MAGNITUDE,
    MODELS,
    PROFILES,
    SIGNED,
    TASKS,
    GridCell,
    Study,
    along_factor,
    cells,
    scores,
    select,
    with_magnitude,
)
from surae_thesis.simulation.grid import place, places

CLAIMS = read_claims("simulation", *RULES)
NAMES = ("m", "k_tri", "tau_rel", "k_rel", "g1")
GRID_FACTORS = (0.05, 0.1, 0.2, 0.35, 0.5, 0.6)
#: SEM by profile as the thesis's Figures 13 and 14 rank them.
RANKS = {
    "muscle": dict(zip(PROFILES, (5.0, 4.0, 1.0, 2.0, 3.0), strict=True)),
    "muscle-tendon": dict(zip(PROFILES, (5.0, 1.0, 4.0, 2.0, 3.0), strict=True)),
}
IPDE = {
    "muscle": dict(zip(PROFILES, (2.75, 2.60, 2.78, 2.64, 2.71), strict=True)),
    "muscle-tendon": dict(zip(PROFILES, (3.80, 3.45, 3.90, 3.44, 3.46), strict=True)),
}


def thesis_sem(place: dict, name: str) -> float:
    """As the thesis's figures have it."""
    amplitude, factor = place["amplitude"], place["factor"] or 0.0
    value = RANKS[place["model"]][place["profile"]]
    if name in ("tau_rel", "k_rel"):
        if place["model"] == "muscle":
            value *= 1.0 + abs(amplitude - 0.1) + (0.1 if 0.0 < factor < 0.2 else 0.0)
    else:
        value /= 1.0 + 3.0 * amplitude * (0.1 + factor) * (3.0 if name == "m" else 1.0)
    if place["model"] == "muscle-tendon" and amplitude == 0.3:
        value *= 3.0
    return value * (1.5 if place["task"] == "active" else 1.0)


def thesis_ipde(place: dict) -> float:
    away = abs((place["factor"] or 0.0) - 0.5) + 2.0 * (0.2 - place["amplitude"])
    task = 0.1 if place["task"] == "active" else 0.0
    return IPDE[place["model"]][place["profile"]] + away + task


def thesis_vaf(place: dict) -> float:
    if place["model"] == "muscle":
        return 99.91
    fails = place["amplitude"] == 0.3 or place["profile"] == "multi-sine"
    return 99.5 if fails else 99.89


def thesis_off(place: dict) -> float:
    return 0.2 if thesis_vaf(place) < 99.85 else 0.05


def grid(sem=thesis_sem, ipde=thesis_ipde, vaf=thesis_vaf, off=thesis_off, subjects=(1,)):
    made = []
    for model, profile, task, amplitude, factor, subject in product(
        MODELS, PROFILES, TASKS, AMPLITUDES, GRID_FACTORS, subjects
    ):
        if amplitude == 0.0 and factor != GRID_FACTORS[0]:
            continue
        place = {
            "model": model,
            "profile": profile,
            "task": task,
            "amplitude": amplitude,
            "factor": factor if amplitude else None,
            "subject": subject,
        }
        made.append(
            GridCell(
                **place,
                repeat=1,
                vaf=vaf(place),
                ipde=ipde(place),
                sem={name: sem(place, name) for name in NAMES},
                off={name: off(place) if name == "g1" else 0.0 for name in NAMES},
                torque=(10.0, 8.0, 12.0),
            )
        )
    return tuple(made)


def of_model(model, value):
    """The thesis's SEM, but for one model."""
    return lambda place, name: (
        value(place, name) if place["model"] == model else thesis_sem(place, name)
    )


def study(grid_, noise=(), patients=None) -> Study:
    sick = select(grid_, task="part-passive") if patients is None else patients
    others = select(grid_, task="part-passive")
    return Study(grid_, noise=tuple(noise), patients=sick, others=others)


def everything(grid_, noise=None, patients=None, only=None) -> dict[str, str]:
    """Verdicts of every claim, or of one, in one view."""
    numbers = study(grid_, noisy() if noise is None else noise, patients)
    findings = [judge(claim, {SIGNED: numbers}) for claim in CLAIMS if only in (None, claim.id)]
    assert len({finding.id for finding in findings}) == len(findings)
    return {finding.id: finding.verdict for finding in findings}


def test_a_grid_as_the_thesis_describes_it_makes_every_claim_hold() -> None:
    assert {name for name, verdict in everything(grid()).items() if verdict != "holds"} == set()


SPOILT = [
    ("vaf-muscle", {"vaf": lambda _: 99.80}),
    ("vaf-tendon", {"vaf": lambda _: 99.99}),
    ("vaf-tendon", {"vaf": lambda _: 99.0}),
    # Most of what the thesis kept lies below its limit: it is not left out.
    ("vaf-tendon", {"vaf": lambda place: 99.89 if place["amplitude"] == 0.2 else 99.6}),
    ("vaf-threshold", {"off": lambda _: 0.05}),
    ("vaf-threshold", {"off": lambda place: 0.05 if place["profile"] == "sine" else 0.2}),
    ("tendon-fails-at-large-chirp", {"vaf": lambda _: 99.9}),
    ("tendon-fails-at-multi-sine", {"vaf": lambda _: 99.9}),
    ("task-sem", {"sem": lambda _, __: 1.0}),
    ("task-ipde", {"ipde": lambda _: 3.0}),
    ("factor-sem", {"sem": of_model("muscle", lambda _, __: 1.0)}),
    ("factor-sem-tendon", {"sem": of_model("muscle-tendon", lambda _, __: 1.0)}),
    ("factor-relaxation", {"sem": lambda place, __: place["factor"] or 1.0}),
    ("amplitude-sem", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("amplitude-relaxation", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("amplitude-sem-tendon", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("profile-sem", {"sem": lambda place, __: 9.0 - RANKS[place["model"]][place["profile"]]}),
    (
        "profile-sem-tendon",
        {"sem": lambda place, __: 9.0 - RANKS[place["model"]][place["profile"]]},
    ),
    ("ipde-values", {"ipde": lambda _: 2.2}),
    ("ipde-ranking", {"ipde": lambda place: 6.0 - IPDE[place["model"]][place["profile"]]}),
    ("ipde-factor", {"ipde": lambda place: 3.0 - (place["factor"] or 0.0) * -1.0}),
    ("ipde-amplitude", {"ipde": lambda place: 3.0 + place["amplitude"]}),
    ("ipde-tendon", {"ipde": lambda _: 3.0}),
    ("ipde-tendon-values", {"ipde": lambda _: 3.0}),
    ("ipde-tendon-factor", {"ipde": lambda place: 3.0 + (place["factor"] or 0.0)}),
    ("ipde-tendon-amplitude", {"ipde": lambda place: 3.0 + place["amplitude"]}),
    ("chosen-profiles", {"ipde": lambda place: 6.0 - IPDE[place["model"]][place["profile"]]}),
    ("chosen-chirp", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("chosen-chirp", {"sem": of_model("muscle", lambda place, __: 1.0 + place["amplitude"])}),
    ("chosen-task", {"sem": lambda place, __: 2.0 - (place["task"] == "active")}),
]


@pytest.mark.parametrize(("name", "spoilt"), SPOILT)
def test_each_claim_differs_where_the_grid_does(name, spoilt) -> None:
    assert everything(grid(**spoilt), only=name) == {name: "differs"}


def test_every_rule_has_a_planted_opposite() -> None:
    others = {"noise-vaf", "noise-sem", "noise-ipde"}
    patients = {claim.id for claim in CLAIMS if claim.id.startswith("patient-")}
    assert {name for name, _ in SPOILT} | others | patients == {claim.id for claim in CLAIMS}


@pytest.mark.parametrize(
    ("name", "alike"),
    [
        ("vaf-threshold", lambda _: 99.0),
        ("vaf-threshold", lambda _: 99.9),
        ("tendon-fails-at-large-chirp", lambda _: 99.5),
        ("tendon-fails-at-multi-sine", lambda _: 99.5),
    ],
)
def test_where_every_cell_is_alike_a_limit_tests_nothing(name, alike) -> None:
    assert everything(grid(vaf=alike), only=name) == {name: "not tested by this"}


@pytest.mark.parametrize("name", ["ipde-factor", "ipde-tendon-factor", "patient-factor"])
def test_a_lowest_value_at_the_end_of_the_grid_is_none(name) -> None:
    def falls(place):
        return 4.0 - (place["factor"] or 0.0)

    (claim,) = [claim for claim in CLAIMS if claim.id == name]
    whole = grid(ipde=falls)
    beyond = tuple(
        replace(cell, factor=0.8, ipde=3.2)
        for cell in select(whole, task="part-passive", amplitude=0.2, factor=0.6)
    )
    sick = select(whole, task="part-passive") + beyond
    numbers = replace(study(whole, patients=sick), faster=beyond)
    assert judge(claim, {SIGNED: numbers}).verdict == "differs"


def noisy(vaf=0.0, sem=0.0, ipde=0.0, profile="multiple-holds"):
    """Five repeats that spread evenly by so much."""
    return [
        GridCell(
            model="muscle",
            profile=profile,
            task="part-passive",
            amplitude=0.1,
            factor=factor,
            subject=1,
            repeat=repeat,
            vaf=99.9 + vaf * repeat / 4,
            ipde=2.6 + ipde * repeat / 4,
            sem={"k_tri": 1.0 + sem * repeat / 4},
            off={"k_tri": 0.0},
            torque=(10.0, 8.0, 12.0),
        )
        for factor in (0.3, 0.6)
        for repeat in range(1, 6)
    ]


def test_noise_holds_below_the_thesis_spread_and_differs_above() -> None:
    for size, verdict in ((1.0, "holds"), (2.0, "differs")):
        said = everything(grid(), noisy(0.005 * size, 0.03 * size, 0.015 * size))
        assert {said[f"noise-{name}"] for name in ("vaf", "sem", "ipde")} == {verdict}


def test_noise_is_judged_with_the_profiles_of_the_figure() -> None:
    rest = noisy() + noisy(1.0, 1.0, 1.0, profile="sine")
    said = everything(grid(), rest)
    assert {said[f"noise-{name}"] for name in ("vaf", "sem", "ipde")} == {"holds"}
    holds = everything(grid(), noisy() + noisy(ipde=1.0, profile="multi-sine-holds"))
    assert (holds["noise-ipde"], holds["noise-sem"]) == ("differs", "holds")


def test_patients_follow_the_healthy_or_do_not() -> None:
    other = grid(
        sem=lambda place, __: 1.0 + place["amplitude"] + (place["factor"] or 0.0),
        ipde=lambda place: float(PROFILES.index(place["profile"])),
    )
    said = everything(grid(), patients=select(other, task="part-passive"))
    assert {v for name, v in said.items() if name.startswith("patient-")} == {"differs"}


def test_the_mean_magnitude_takes_the_noise_that_was_added_for_its_own() -> None:
    magnitude, mean, rms = 10.0, 4.0, 12.0
    added, other = NOISE * mean, NOISE * magnitude
    vaf = 100.0 * (1.0 - added**2 / (rms**2 + added**2))
    fitted = replace(grid()[0], torque=(magnitude, mean, rms), vaf=vaf)
    changed = with_magnitude(fitted)
    assert changed.vaf == pytest.approx(100.0 * (1.0 - other**2 / (rms**2 + other**2)))
    assert changed.sem["m"] == pytest.approx(fitted.sem["m"] * other / added)
    assert changed.ipde == fitted.ipde


def test_a_claim_that_holds_in_another_column_names_it() -> None:
    (claim,) = [claim for claim in CLAIMS if claim.id == "tendon-fails-at-multi-sine"]
    fine = study(grid(vaf=lambda _: 99.9))
    assert judge(claim, {SIGNED: fine, MAGNITUDE: study(grid())}).said == (
        "holds under the mean magnitude"
    )
    assert judge(claim, {SIGNED: fine, INTEGRATOR: study(grid())}).verdict == (
        "holds with the thesis's integrator"
    )


def test_a_claim_without_its_cells_says_so() -> None:
    with pytest.raises(NotThereError, match="muscle-tendon, multiple-holds"):
        along_factor(select(grid(), model="muscle"), "muscle-tendon")
    said = everything(select(grid(), task="active"), noise=())
    assert said["task-sem"] == said["noise-vaf"] == said["factor-sem"] == "cannot be checked"


def test_the_grid_is_that_of_the_thesis() -> None:
    every = places(quick=False)
    assert len(every["grid"]) == 1400  # 1,840 combinations: without a chirp its factor is nothing
    assert len(every["noise"]) == 5 * 13 * 5
    labels = [" ".join(map(str, at.values())) for at in every["grid"]]
    assert len(set(labels)) == len(labels)
    assert sum(map(len, places(quick=True).values())) < 1000


def test_the_other_reading_of_the_strain_has_every_cell_that_a_claim_looks_along() -> None:
    every = places(quick=False)
    strained = every[f"{STRAIN} grid"]
    assert {at["model"] for at in strained} == {"muscle-tendon"}
    assert {at["reading"] for at in strained} == {STRAIN}
    along = [at for at in every["grid"] if (at["task"], at["amplitude"]) == ("part-passive", 0.2)]
    tendon = [{**at, "reading": STRAIN} for at in along if at["model"] == "muscle-tendon"]
    assert all(at in strained for at in tendon)
    chosen = [at for at in strained if at["factor"] in (None, 0.5)]
    assert len(chosen) == 5 * 4 * 2


@pytest.mark.slow
def test_a_strain_is_stiffer_than_as_many_metres() -> None:
    at = place("muscle-tendon", "multiple-holds", 0.2, 0.5)
    metres, strain = (fit_cell(seed=1, **{**at, "reading": reading}) for reading in ("", STRAIN))
    assert strain["torque"][1] > 1.1 * metres["torque"][1]
    assert 99.8 < strain["vaf"] < 99.95


def test_failed_fits_are_no_cells() -> None:
    at = place("muscle", "sine", 0.0, 0.1)
    fit = {"vaf": 99.0, "ipde": None, "sem": {}, "off": {"m": -0.5}, "torque": [1.0, 1.0, 2.0]}
    (cell,) = cells([at, at], [fit, None])
    assert (cell.factor, cell.sem, cell.worst) == (None, {}, ("m", 0.5))
    assert cell.floor == pytest.approx(100.0 * (1.0 - 0.025**2))


def test_the_active_task_is_what_follows_the_passive_seconds() -> None:
    whole = motion("multiple-holds", "part-passive", 0.2, 0.5, 64.0)
    active = motion("multiple-holds", "active", 0.2, 0.5, 64.0)
    assert (whole.time[-1], active.time[-1]) == (35.0, 24.0)
    np.testing.assert_array_equal(active.angle, whole.angle[11 * 64 :])
    assert not whole.effort[: 11 * 64].any()
    assert active.effort[: 2 * 64].any()


def test_heads_that_take_turns_pull_alone_and_as_hard() -> None:
    together = motion("sine", "part-passive", 0.0, None, 64.0).effort
    alone = motion("sine", "part-passive", 0.0, None, 64.0, IN_TURN).effort
    assert ((alone[:, 1:] > 0.0).sum(axis=1) <= 1).all()
    assert ((together[:, 1:] > 0.0).sum(axis=1) > 1).any()
    np.testing.assert_array_equal(alone[:, 0], together[:, 0])
    kept = alone > 0.0
    np.testing.assert_array_equal(alone[kept], together[kept])
    assert all((alone[:, head] > 0.0).any() for head in (1, 2, 3))


def test_the_readings_that_were_found_afterwards() -> None:
    usual = motion("sine", "part-passive", 0.0, None, 64.0)
    lead = motion("sine", "part-passive", 0.0, None, 64.0, LEAD).effort
    heads = lead[(lead[:, 1:] > 0.3).any(axis=1), 1:]
    assert np.median(np.sort(heads, axis=1)[:, 1] / heads.max(axis=1)) < 0.6
    np.testing.assert_array_equal(lead[:, 0], usual.effort[:, 0])
    early = motion("sine", "active", 0.0, None, 64.0, EARLY)
    np.testing.assert_array_equal(early.angle, usual.angle[: len(early.time)])
    assert early.effort[:64].any()


def test_the_noise_is_of_the_signed_mean_and_another_in_every_cell() -> None:
    leg = thesis_leg(1)
    trajectory = motion("sine", "part-passive", 0.0, None, 64.0)
    clean = virtual_trial(leg, trajectory, noise=0.0).torque
    first, again, other = (
        thesis_trial(leg, t, "muscle", r)[0].torque
        for t, r in ((trajectory, 1), (trajectory, 1), (trajectory, 2))
    )
    np.testing.assert_array_equal(first, again)
    noise = first - clean
    assert noise.std() == pytest.approx(0.05 * abs(clean.mean()), rel=0.1)
    assert abs(np.corrcoef(noise, other - clean)[0, 1]) < 0.1


@pytest.mark.parametrize(("population", "low", "high"), [("healthy", 3, 5), ("patient", 6, 10)])
def test_the_tibialis_resists_as_the_figures_show(population, low, high) -> None:
    stiffness, slack = [], []
    for number in range(20):
        leg = thesis_leg(number, population).parameters
        length = 0.136 - 1.56 * (0.0393 - 0.0171 * 0.9)
        force = np.exp(leg["k_tib"] * (length - leg["x0_tib"]))
        assert low <= force * (0.0393 - 0.0171 * 0.9) <= high
        stiffness.append(leg["k_tib"])
        slack.append(leg["x0_tib"])
    if population == "patient":  # stiffer and shorter than in health (2.5.4)
        healthy = [thesis_leg(number).parameters for number in range(20)]
        assert np.mean(stiffness) > np.mean([leg["k_tib"] for leg in healthy])
        assert np.mean(slack) < np.mean([leg["x0_tib"] for leg in healthy])


@pytest.mark.slow
def test_the_thesis_s_optimiser_stops_in_the_chatter_and_a_wide_step_passes_it() -> None:
    trajectory = motion("sine", "part-passive", 0.0, None, 1000.0)
    scheme = {"integrator": "explicit-euler"}
    inputs, _ = thesis_trial(thesis_leg(1), trajectory, "muscle-tendon", 1, **scheme)
    usual, _ = fit_explicit(inputs, "muscle-tendon")
    wide, _ = fit_explicit(inputs, "muscle-tendon", step=0.01)
    assert usual["vaf"] < 97.0
    assert wide["vaf"] > 99.5


def test_a_cell_is_the_fit_beside_its_truth() -> None:
    at = place("muscle", "sine", 0.0, None)
    fit = fit_cell(seed=1, **at)
    assert fit is not None
    assert fit["vaf"] > 99.8
    assert max(map(abs, fit["off"].values())) < 0.2
    assert set(fit["sem"]) == set(fit["off"])


def test_scores_leave_out_what_no_cell_could_tell() -> None:
    some = list(select(grid(), model="muscle", task="active", amplitude=0.0))[:2]
    expected = scores(some)
    some[0] = replace(some[0], sem={k: v for k, v in some[0].sem.items() if k != "m"})
    assert scores(some)[0] == pytest.approx(expected[0], rel=0.3)
    assert scores([replace(cell, sem=dict(cell.sem)) for cell in some]).shape == (2,)
