"""The claims on subjects: fits made up so that each rule must say yes, and no."""

from dataclasses import replace

import numpy as np
import pytest

from surae.model import get_model
from surae_thesis.claims import INTEGRATOR, NotThereError, judge, judge_all, read_claims
from surae_thesis.cohort import beyond, drawings, rules, subjects
from surae_thesis.cohort.boxes import Box, snsem_figure, vaf_figure
from surae_thesis.cohort.drawings import spectra_figure
from surae_thesis.cohort.imperfections import CohortImperfections
from surae_thesis.cohort.members import COMPLETED, make_cohort
from surae_thesis.cohort.results import Fits, Ways, clearly_lower, paired
from surae_thesis.cohort.rules import COHORT, described, spectrum, thesis_means
from surae_thesis.cohort.work import MODELS
from surae_thesis.legs import STRAIN
from surae_thesis.section import Context

PASSIVE, HOLDS, FAST = COMPLETED
MEMBERS = make_cohort(1, 8)
#: A subject whose knee moved or whose ankle was misaligned.
NOTED = next(member.id for member in MEMBERS if member.remarks)
#: A subject with one recording of each kind that is as low as the thesis's lowest.
ODD = next(m.id for m in MEMBERS if len(m.completed) == 3 and m.id != NOTED)
LOWEST = {
    ("fit", "1.0", FAST): -8.0,
    ("fit", "2.0", HOLDS): -14.0,
    ("fit", "2.0", FAST): -6.0,
    ("validation", "1.0", HOLDS): -22.4,
    ("validation", "1.0", FAST): -33.1,
}
PAIRS = (
    ("l0_tri", "k_tri"),
    ("l0_tib", "x0_tib"),
    ("m", "g1"),
    ("g4", "k_tri"),
    ("l0_tri", "m"),
)
#: The thesis's own means: every level must then hold.
THESIS = thesis_means()
CLAIMS = read_claims("subjects", subjects.RULES)


@pytest.fixture(autouse=True)
def spectra(monkeypatch):
    """Spectra of repetitions that are 2 dB apart, instead of recordings."""
    at = np.linspace(0.0, 60.0, 100)
    several = [(at, np.full(100, 2.0 * r)) for r in range(3)]
    monkeypatch.setattr(rules, "spectra_of", lambda _: several)
    monkeypatch.setattr(drawings, "spectra_of", lambda _: several)


SIZES = {"neural": 80.0, "tissue": 10.0, "inertial": 1.0}


def made_up(
    shift=None,
    sem=2.0,
    bound=True,
    correlation=0.9,
    short=0.1,
    lowest=False,
    apart=0.04,
    errors=None,
    sizes=None,
):
    """Fits as the thesis describes them; `shift` moves VAFs by kind, model and protocol.

    Subjects are `apart` by model 2.0, `errors` has factors of standard errors by model and
    parameter, `sizes` those of the torque's parts.
    """
    moved = {key: mean + (shift or {}).get(key, 0.0) for key, mean in THESIS.items()}

    def vaf(kind, model, protocol, subject, r):
        own = (apart if model == "2.0" else 0.01) * int(subject[1:])  # subjects differ a little
        if lowest and (subject, r) == (ODD, 2):
            own += LOWEST.get((kind, model, protocol), 0.0)
        if (kind, model, protocol, subject) == ("fit", "1.0", HOLDS, NOTED):
            own -= 4.0
        return moved.get((kind, model, protocol), 90.0) + own

    single = {}
    for member in MEMBERS:
        of_member = single.setdefault(member.id, {})
        for protocol in member.completed:
            for model, name in MODELS.items():
                if model in ("1.0", "2.0") or protocol == HOLDS:
                    for r in (1, 2, 3):
                        fit = one(
                            model, name, protocol, r, member.id, vaf, sem, bound, correlation, short
                        )
                        fit["sizes"] |= sizes or {}
                        for n, factor in (errors or {}).get(model, {}).items():
                            fit["parameters"][n]["sem"] *= factor
                        of_member[f"{model} {protocol} {r}"] = fit
    baselines = {
        f"{model} {protocol}": dict.fromkeys(get_model(name).free, 1.0)
        for model, name in MODELS.items()
        for protocol in (HOLDS, FAST)
    }
    return Fits(MEMBERS, single, baselines)


def one(model, name, protocol, r, subject, vaf, sem, bound, correlation, short):
    names = list(get_model(name).free)
    matrix = np.eye(len(names))
    pairs = (
        ("l0_tri", "k_tri"),
        ("l0_tib", "x0_tib"),
        ("m", "g1"),
        ("g4", "k_tri"),
        ("l0_tri", "m"),
    )
    for a, b in pairs:
        i, j = names.index(a), names.index(b)
        matrix[i, j] = matrix[j, i] = correlation
    high = {"g1": 4.0, "g2": 4.0, "g3": 4.0, "g4": 4.0, "f0": 0.5, "beta": 0.5}
    if model == "2.0":
        high["l0_tri"] = 5.0
    if model in ("2.1", "2.2"):
        high["m"] = 9.0
    if model == "2.1":
        high |= dict.fromkeys(("g1", "g2", "g3", "g4"), 0.5)
    scale = {"1.0": sem, "2.0": 0.5 * sem, "2.1": 0.5 * sem, "2.2": 0.5 * sem}[model]
    targets = [(protocol, k) for k in (2, 3)] if r == 1 else []
    targets += [(PASSIVE, k) for k in (1, 2, 3)] if r == 1 and protocol == HOLDS else []
    return {
        "n": 9000,
        "first_start": True,
        "vaf": vaf("fit", model, protocol, subject, r),
        "parameters": {
            n: {
                "value": 1.2,
                "sem": scale * high.get(n, 1.0),
                "true": 1.0,
                "ci95": [0.5, 1.5],
                "at_bound": bound and n == "m",
            }
            for n in names
        },
        "correlation": {"names": names, "matrix": matrix.tolist()},
        "predicted": [
            {
                "protocol": target,
                "repetition": k,
                "vaf": vaf(
                    "onto" if (protocol, target) == (HOLDS, PASSIVE) else "validation",
                    model,
                    target,
                    subject,
                    k,
                ),
            }
            for target, k in targets
        ],
        "sizes": {**SIZES, "short_at_peaks": short},
    }


def judged(fits):
    findings = [judge(replace(claim, chance=None), {COHORT: fits}) for claim in CLAIMS]
    assert len({finding.id for finding in findings}) == len(findings)
    return {f.id: f for f in findings if not f.id.startswith("lowest-")}


def test_subjects_like_the_thesis_s_pass_every_rule():
    said = judged(made_up())
    others = {name: (f.said, f.ours) for name, f in said.items() if f.verdict != "holds"}
    assert {name: said for name, (said, _) in others.items()} == {
        "fit-1-0-multiple-holds": "calibrated",
        "fit-1-0-ramp-and-hold": "calibrated",
    }, others


def test_a_lowest_value_is_that_of_the_thesis_or_is_not():
    lows = [replace(c, chance=None) for c in CLAIMS if c.id.startswith("lowest-")]
    odd, even = (
        {claim.id: judge(claim, {COHORT: made_up(lowest=low)}).verdict for claim in lows}
        for low in (True, False)
    )
    assert set(odd.values()) == {"holds"}
    holding = {name for name, verdict in even.items() if verdict == "holds"}
    # The recording of the subject with a remark is low without it; all of the third are high.
    assert holding == {"lowest-fit-1-0-multiple-holds", "lowest-fit-2-0-ramp-and-hold"}


def test_one_cohort_decides_and_the_integrator_stands_beside_it():
    claim = replace(next(c for c in CLAIMS if c.id == "tendon-fits-worse"), chance=None)
    assert claim.views == (COHORT, STRAIN, INTEGRATOR)
    better = made_up(shift={("fit", "2.0", HOLDS): 8.0})
    finding = judge(claim, {COHORT: better, INTEGRATOR: made_up()})
    assert finding.verdict == "holds with the thesis's integrator"
    smaller = made_up(shift={("fit", "2.0", HOLDS): 3.0})
    assert judge(claim, {COHORT: smaller}).said == "same direction, smaller"


def test_what_each_calibration_gains_and_loses_is_listed():
    fits, moved = made_up(), made_up(shift={("fit", "1.0", PASSIVE): -9.0})
    table = subjects._turned(Ways(fits, fits, {"noise": moved}, fits, {}, fits))
    assert [(row[0], row[1], row[-1]) for row in table.rows] == [
        ("noise", "fit-1-0-ramp-and-hold", "gains"),
        ("noise", "passive-followed-best", "gains"),
    ]


@pytest.mark.parametrize(
    ("changes", "differ"),
    [
        ({"shift": {("fit", "1.0", PASSIVE): -9.0}}, {"passive-followed-best"}),
        (
            {"shift": {("fit", "2.0", HOLDS): 8.0}},
            {
                "fit-2-0-multiple-holds",
                "tendon-fits-worse",
                "free-strain-fits-better",
                "free-toe-force-fits-better",
            },
        ),
        (
            {"shift": {("validation", "2.0", HOLDS): 9.0}},
            {
                "validation-2-0-multiple-holds",
                "muscle-predicts-better",
                "free-strain-predicts-better",
                "free-toe-force-predicts-better",
            },
        ),
        (
            {"shift": {("onto", "2.0", PASSIVE): 6.0}},
            {"onto-2-0-ramp-and-hold", "muscle-predicts-passive-better"},
        ),
        ({"bound": False}, {"mass-at-bounds"}),
        ({"short": -0.1}, {"peaks-not-reached-1-0", "peaks-not-reached-2-0"}),
        (
            {"correlation": 0.1},
            {
                "passive-active-covariances",
                "optimal-lengths-depend",
                "mass-weight-depend",
                "weight-passive-depend",
                "length-mass-depend",
            },
        ),
        (
            {"sem": 0.2},
            {"snsem-muscle-one-to-ten", "snsem-tendon-about-one", "snsem-mass-highest-2-1"},
        ),
    ],
)
def test_each_rule_can_say_no(changes, differ):
    said = judged(made_up(**changes))
    said_no = {name: finding for name, finding in said.items() if finding.verdict == "differs"}
    assert said_no.keys() == differ
    assert all(finding.ours for finding in said_no.values())


#: What turns each of the claims that the test above leaves: numbers, and the claim.
OPPOSITES = [
    ({"shift": {("fit", "1.0", FAST): -9.0}}, "fit-1-0-multi-sine-holds"),
    ({"shift": {("fit", "2.0", PASSIVE): -2.0}}, "fit-2-0-ramp-and-hold"),
    ({"shift": {("fit", "2.0", FAST): -9.0}}, "fit-2-0-multi-sine-holds"),
    ({"shift": {("fit", "2.1", HOLDS): 5.0}}, "fit-2-1-multiple-holds"),
    ({"shift": {("fit", "2.2", HOLDS): 5.0}}, "fit-2-2-multiple-holds"),
    ({"shift": {("validation", "1.0", HOLDS): 9.0}}, "validation-1-0-multiple-holds"),
    ({"shift": {("validation", "1.0", FAST): 9.0}}, "validation-1-0-multi-sine-holds"),
    ({"shift": {("validation", "2.0", FAST): 9.0}}, "validation-2-0-multi-sine-holds"),
    ({"shift": {("validation", "2.1", HOLDS): 9.0}}, "validation-2-1-multiple-holds"),
    ({"shift": {("validation", "2.2", HOLDS): 9.0}}, "validation-2-2-multiple-holds"),
    ({"shift": {("onto", "1.0", PASSIVE): -9.0}}, "onto-1-0-ramp-and-hold"),
    ({"shift": {("fit", "2.0", FAST): 5.0}}, "tendon-same-on-multi-sine"),
    ({"shift": {("fit", "2.2", HOLDS): 6.0}}, "strain-over-toe"),
    ({"shift": {("fit", "2.1", HOLDS): -5.0}}, "strain-equals-muscle"),
    ({"shift": {("validation", "1.0", HOLDS): 9.0}}, "prediction-below-fit"),
    ({"shift": {("validation", "1.0", FAST): 9.0}}, "multi-sine-predicted-worse"),
    ({"shift": {("fit", "1.0", FAST): 5.0}}, "multi-sine-followed-worse"),
    ({"apart": 0.005}, "passive-predictions-spread"),
    ({"errors": {"1.0": dict.fromkeys(rules.WEIGHTS, 0.1)}}, "snsem-muscle-weights-high"),
    ({"errors": {"1.0": {"f0": 20.0, "beta": 20.0}}}, "snsem-muscle-filter-low"),
    (
        {"errors": {"2.0": dict.fromkeys(get_model("muscle-tendon").free, 3.0)}},
        "snsem-tendon-below-muscle",
    ),
    ({"errors": {"2.0": {"l0_tri": 0.1}}}, "snsem-tendon-length-high"),
    (
        {"errors": {"2.1": dict.fromkeys(get_model("muscle-tendon").free, 9.0)}},
        "snsem-strain-similar",
    ),
    (
        {"errors": {"2.2": dict.fromkeys(get_model("muscle-tendon").free, 9.0)}},
        "snsem-toe-similar",
    ),
    ({"errors": {"2.2": {"m": 0.1}}}, "snsem-mass-highest-2-2"),
    ({"sizes": {"neural": 40.0}}, "active-up-to-80"),
    ({"sizes": {"tissue": 30.0}}, "passive-up-to-10"),
    ({"sizes": {"inertial": 20.0}}, "inertia-small"),
]


@pytest.mark.parametrize(("changes", "claim"), OPPOSITES)
def test_a_planted_opposite_turns_a_rule(changes, claim):
    (rule,) = [replace(each, chance=None) for each in CLAIMS if each.id == claim]
    assert judge(rule, {COHORT: made_up()}).verdict in ("holds", "calibrated")
    assert judge(rule, {COHORT: made_up(**changes)}).verdict == "differs"


def test_every_rule_has_a_planted_opposite():
    (first,) = [mark for mark in test_each_rule_can_say_no.pytestmark if mark.name == "parametrize"]
    turned = set().union(*(differ for _, differ in first.args[1])) | {name for _, name in OPPOSITES}
    turned |= {claim.id for claim in CLAIMS if claim.id.startswith("lowest-") or claim.calibrated}
    turned |= {"spectra-of-repetitions-differ", "outliers-are-misaligned-or-twisted"}
    assert turned == {claim.id for claim in CLAIMS}


def test_what_other_subjects_would_turn_is_decided_by_chance():
    change = next(c for c in CLAIMS if c.id == "muscle-predicts-passive-better")
    clear = made_up()
    assert judge(change, {COHORT: clear}).verdict == "holds"
    # Half of the thesis's size to within a tenth of a point, and subjects that differ by more.
    edge = made_up(shift={("onto", "2.0", PASSIVE): 0.65}, apart=0.3)
    finding = judge(change, {COHORT: edge})
    assert finding.verdict == "not tested by this"
    assert "of cohorts drawn again from these subjects say otherwise" in finding.ours[COHORT][1]
    assert rules.by_chance(edge, change.ours) == rules.by_chance(edge, change.ours)
    assert not rules.by_chance(edge, rules.spectra)  # of one subject's repetitions


def test_outliers_are_of_noted_subjects_or_the_claim_differs():
    fits = made_up()
    healthy = tuple(replace(m, imperfections=CohortImperfections()) for m in MEMBERS)
    assert rules.remarked(fits).holds
    assert not rules.remarked(replace(fits, members=healthy)).holds
    several = {k: v for k, v in fits.single.items() if k != NOTED}
    assert "0 of 0 outliers" in rules.remarked(replace(fits, single=several)).ours


def test_what_was_not_fitted_cannot_be_checked():
    fits = made_up()
    fewer = {
        who: {k: v for k, v in of.items() if k.split()[0] in ("1.0", "2.0")}
        for who, of in fits.single.items()
    }
    said = judged(replace(fits, single=fewer))
    assert said["fit-2-1-multiple-holds"].verdict == "cannot be checked"
    assert said["snsem-strain-similar"].verdict == "cannot be checked"
    assert said["snsem-mass-highest-2-1"].verdict == "cannot be checked"
    assert said["fit-2-0-multiple-holds"].verdict == "holds"


def test_paired_changes_are_of_the_same_recordings():
    first = {("S01", 1): 90.0, ("S02", 1): 80.0}
    second = {("S02", 1): 85.0, ("S03", 1): 70.0}
    np.testing.assert_array_equal(paired(first, second), [5.0])
    assert described(first) == "85.0 % (median 85.0, lowest 80.0, n = 2)"


def test_lower_is_clear_only_beyond_what_subjects_differ_by():
    def of(*means):
        return {(f"S{n}", r): m for n, m in enumerate(means) for r in (1, 2)}

    assert clearly_lower(of(90.0, 91.0), of(95.0, 96.0))
    assert not clearly_lower(of(90.0, 98.0), of(95.0, 96.0))
    assert not clearly_lower(of(95.0, 96.0), of(90.0, 91.0))
    assert not clearly_lower(of(90.0), of(95.0))  # one subject's repetitions tell no spread


def test_spectra_that_are_alike_do_not_differ(monkeypatch):
    at = np.linspace(0.0, 60.0, 100)
    monkeypatch.setattr(rules, "spectra_of", lambda _: [(at, np.zeros(100))] * 3)
    assert judged(made_up())["spectra-of-repetitions-differ"].verdict == "differs"


def test_a_spectrum_keeps_the_power():
    rate = 256.0
    time = np.arange(0.0, 40.0, 1.0 / rate)
    frequency, power = spectrum(3.0 * np.sin(2 * np.pi * 5.0 * time), rate)
    total = np.sum(10.0 ** (power / 10.0)) * frequency[1]
    assert total == pytest.approx(4.5, rel=0.01)
    assert frequency[np.argmax(power)] == pytest.approx(5.0, abs=0.15)


def test_figures_tell_what_lies_outside_and_what_is_missing():
    points = {("S01", 1): 95.0, ("S02", 1): 30.0, ("S02", 2): 96.0}
    figure = vaf_figure([Box("holds", points, 90.0)], 50.0, ["S02"])
    axes = figure.axes[0]
    assert axes.get_ylabel() == "VAF [%]"
    assert "1 lower" in {text.get_text() for text in axes.texts}
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "thesis's mean" in names
    assert "knee moves or ankle misaligned" in names
    bars = snsem_figure({"m": [1.0, 2.0], "k_tri": []}, {"m": 0, "k_tri": 2}).axes[0]
    assert [t.get_text() for t in bars.get_xticklabels()] == ["m", "k_tri (2)"]
    assert len(spectra_figure([spectrum(np.ones(4096), 256.0)] * 3).axes) == 2


def test_every_figure_and_table_of_made_up_fits_is_there():
    fits = made_up()
    names = [drawing.name for drawing in drawings.vaf_drawings(fits)]
    assert names == ["figure-17", "figure-23", "figure-29", "figure-30", "figure-32", "figure-35"]
    assert [drawing.name for drawing in drawings.snsem_drawings(fits)] == [
        f"figure-{n}" for n in (21, 22, 26, 27, 33, 34)
    ]
    ways = Ways(fits, fits, {}, fits, {("S01", 1): 97.0}, fits)
    assert drawings.integrator_drawing(ways).name == "figure-23-integrator"
    assert not rules.example(fits.members)[1].remarks


def way(name, error=0.05, sem=0.01, vaf=98.0, first=True):
    names = (*beyond.SHARED, "dlt_tri", "pt_tri")
    parameters = {
        n: {"value": 1.0 + error, "sem": sem, "true": 1.0, "ci95": [0.5, 1.5]} for n in names
    }
    return beyond.Way([{"vaf": vaf, "first_start": first, "n": 9000, "parameters": parameters}])


def made_up_ways(**of_best):
    names = ("1.0 alone", "2.0 alone", "2.1 alone", "joint 1.0", "joint 2.0", "joint + ε0")
    return {n: way(n, 0.2) for n in names} | {beyond.BEST: way(beyond.BEST, **of_best)}


@pytest.mark.parametrize(
    ("of_best", "verdict"),
    [
        ({"vaf": 99.0, "first": False}, "holds"),
        ({"vaf": 97.0, "first": False}, "differs"),
        ({"vaf": 99.0, "first": True}, "differs"),
    ],
)
def test_several_tendon_parameters_fit_better_at_the_risk_of_local_minima(of_best, verdict):
    numbers = beyond.Numbers(made_up(), made_up_ways(**of_best))
    said = {f.id: f.verdict for f in judge_all("beyond", {"": numbers}, beyond.__name__)}
    assert said["several-tendon-parameters"] == verdict
    assert said["low-sem-is-not-right"] == "holds"
    assert said["below-ideal-one-is-wrong"] == "not tested by this"


def test_limits_of_vaf_and_error_are_tested_where_fits_lie_on_both_sides():
    numbers = beyond.Numbers(made_up(), made_up_ways(vaf=99.0, first=False))
    everywhere = made_up(shift={("fit", m, p): 9.9 for m in ("1.0", "2.0") for p in (HOLDS, FAST)})
    some = made_up(shift={("fit", m, HOLDS): 9.9 for m in ("1.0", "2.0")})
    assert not beyond.below_ideal(replace(numbers, fits=some)).untested
    assert beyond.below_ideal(numbers).untested == "no fit is above it"
    with pytest.raises(NotThereError):
        beyond.below_ideal(replace(numbers, fits=everywhere))
    for fits in some.single.values():
        for fit in fits.values():
            for p in fit["parameters"].values():
                p["value"] = 1.0
    assert not beyond.below_ideal(replace(numbers, fits=some)).holds
    sure = {n: way(n, 0.01) for n in numbers.ways}
    assert not beyond.low_sem(replace(numbers, ways=sure)).holds
    apart = {**numbers.ways, beyond.RIGID: way(beyond.RIGID, 0.5)}
    assert beyond.equally_good(numbers).holds
    assert not beyond.equally_good(replace(numbers, ways=apart)).holds


def test_tables_and_figures_beyond():
    several = made_up_ways()
    table = beyond._ways_table(several)
    assert all(len(row) == len(table.columns) for row in table.rows)
    assert several[beyond.BEST].covered(ours=True) == (1.0, 13)
    assert several["1.0 alone"].covered(ours=False)[0] == 0.0


@pytest.mark.slow
def test_the_quick_run_goes_through_and_a_second_one_computes_nothing(tmp_path):
    told = []
    context = Context(
        folder=tmp_path, quick=True, workers=2, progress=lambda *state: told.append(state)
    )
    first = subjects.run(context)
    assert {f.verdict for f in first.findings} >= {"holds", "differs"}
    told.clear()
    again = subjects.run(context)
    assert all(done == total for _, done, total in told)
    assert again.findings == first.findings
    best = beyond.run(context)
    assert {table.name for table in best.tables} == {"beyond-ways"}
