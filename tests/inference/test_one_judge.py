"""One function gives every verdict, and a doubt withholds only what it touches."""

import math
from dataclasses import replace

import pytest

import surae
from ankle_legs.make import make
from surae.inference import Grade, Verdict
from surae.inference.judging.reasons import Scope, against, scopes_of
from surae.inference.judging.verdict import (
    ANGLE,
    OF_REFLEX,
    PART,
    THRESHOLD,
    verdict_of,
)
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import quantities
from surae.nerve.identify import Number
from surae.nerve.measures import ONE_LAW, number_of

KNOWN, WEAK, NONE = Verdict.IDENTIFIED, Verdict.WEAK, Verdict.UNDETERMINED


@pytest.mark.parametrize(
    ("value", "half", "kind", "verdict"),
    [
        (2.0, 0.2, PART, KNOWN),
        (-2.0, 0.2, PART, KNOWN),
        (2.0, 0.2 * (1 + 1e-9), PART, WEAK),
        (2.0, 2.0, PART, WEAK),
        (2.0, 2.0 * (1 + 1e-9), PART, NONE),
        (2.0, math.nan, PART, NONE),
        (2.0, math.inf, PART, NONE),
        (0.0, 0.0, PART, NONE),
        (0.0, 2.0, ANGLE, KNOWN),
        (80.0, 2.1, ANGLE, WEAK),
        (80.0, 21.0, ANGLE, NONE),
        (2.0, 0.1, OF_REFLEX, WEAK),
        (2.0, 2.1, OF_REFLEX, NONE),
        (5.0, 0.5, THRESHOLD, WEAK),
        (5.0, 10.1, THRESHOLD, NONE),
    ],
)
def test_an_interval_has_the_verdict_of_its_width(value, half, kind, verdict):
    assert verdict_of(value, half, kind) is verdict


@pytest.mark.parametrize(
    ("asked", "verdict"),
    [
        ({"room": 0.4}, NONE),  # as wide as its bounds, whatever part of the value
        ({"room": 1.0}, KNOWN),
        ({"narrowed": 0.5}, KNOWN),
        ({"narrowed": 0.51}, WEAK),
        ({"doubted": True}, WEAK),
        ({"assumed": True}, WEAK),
    ],
)
def test_what_takes_a_claim_widens_nothing(asked, verdict):
    assert verdict_of(2.0, 0.2, **asked) is verdict
    for half in (0.5, 5.0):
        if "room" not in asked:
            assert verdict_of(2.0, half, **asked) is verdict_of(2.0, half)


def test_nerve_and_muscles_are_judged_alike():
    for half in (0.0625, 0.125, 0.5, 1.0, 1.5):
        number = Number(1.0, 1.0 - half, 1.0 + half)
        assert number_of("inertia", number).verdict is verdict_of(1.0, half)
        of_reflex = number_of("reflex_gain", number)
        assert of_reflex.verdict is verdict_of(1.0, half, OF_REFLEX)
        assert (of_reflex.note == ONE_LAW) is (half <= 0.1)


def test_a_prior_alone_identifies_nothing(noisy, monkeypatch):
    plain = surae.fit(noisy, "muscle", starts=1, quality=())
    value = plain["x0_tib"].value
    monkeypatch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
    told = surae.fit(noisy, "muscle", starts=1, quality=(), priors={"x0_tib": (value, 1e-4)})
    p = told["x0_tib"]
    assert (p.ci95[1] - p.ci95[0]) / 2.0 < 0.1 * p.value
    assert p.verdict is WEAK
    assert "before any measurement" in p.note


def test_bounds_say_nothing_that_the_data_say(noisy, monkeypatch):
    monkeypatch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
    plain = surae.fit(noisy, "muscle", starts=1, quality=())
    wide = max(
        (p for p in plain.parameters.values() if p.free and not p.at_bound and p.ci95),
        key=lambda p: (p.ci95[1] - p.ci95[0]) / p.value,
    )
    half = (wide.ci95[1] - wide.ci95[0]) / 2.0
    bounds = {wide.name: (wide.value - half, wide.value + half)}
    narrow = surae.fit(noisy, "muscle", starts=1, quality=(), bounds=bounds)[wide.name]
    assert narrow.at_bound or narrow.verdict is NONE


def test_a_doubt_touches_what_rests_on_its_scope():
    gains = against("emg-steady", scope=Scope.MUSCLES, muscles="TA")
    assert not gains.touches({Scope.RELAXED})
    assert gains.touches({Scope.MUSCLES, Scope.RELAXED})
    assert gains.touches(())  # of what nothing is known
    assert replace(gains, is_grave=True).touches({Scope.RELAXED})
    assert against("followed-roughly", r2=90.0).touches({Scope.RELAXED})


@pytest.mark.parametrize(
    ("parts", "scopes"),
    [
        ([("k_tri", "passive", 1.0), ("g2", "active", 0.01)], {Scope.RELAXED}),
        ([("k_tri", "passive", 1.0), ("dlt_tri", "tendon", 0.4)], {Scope.RELAXED}),
        ([("k_tri", "passive", 0.2), ("dlt_tri", "tendon", 0.9)], {Scope.RELAXED, Scope.MUSCLES}),
        ([("dlt_tri", "tendon", 1.0)], {Scope.MUSCLES}),
        ([("g2", "active", 1.0), ("m", "limb", 0.5)], {Scope.RELAXED, Scope.MUSCLES}),
        ([("xt_ta_sol", "measurement", 1.0)], {Scope.MUSCLES}),
        ([("axis_up", "measurement", 1.0)], set()),
    ],
)
def test_a_value_rests_on_the_parameters_that_matter_to_it(parts, scopes):
    assert scopes_of(parts) == scopes


def with_doubts(fit, *doubts):
    """The fit, with these doubts alone."""
    grave = any(doubt.is_grave for doubt in doubts)
    grade = Grade.INADEQUATE if grave else Grade.DOUBTFUL
    adequacy = replace(fit.adequacy, grade=grade, against=doubts)
    return replace(fit, assessment=replace(fit.assessment, adequacy=adequacy))


GAINS = against("emg-steady", scope=Scope.MUSCLES, muscles="TA")
GRAVE = against("still", grave=True, moved=1.0)
#: Of one trial, those that both a doubt of the gains must leave and must take are looked at.
PASSIVE, ACTIVE = (
    ("passive_stiffness@0deg", "end_stiffness"),
    ("torque_per_emg_tri", "damping@20Nm"),
)


@pytest.fixture(scope="module")
def active(tmp_path_factory):
    """A leg that shares no code with surae, moved with efforts."""
    (path,) = make("a", 21, tmp_path_factory.mktemp("leg"), (1,))
    return surae.fit(path, quality=())


@pytest.mark.slow
def test_a_doubt_of_the_gains_leaves_the_relaxed_curve(active):
    sure = with_doubts(active).measures()
    doubted = with_doubts(active, GAINS).measures()
    for name in PASSIVE:
        assert doubted[name].verdict == sure[name].verdict
        assert "weight" not in doubted[name].note
    for name in ACTIVE:
        if sure[name].verdict is not NONE:
            assert doubted[name].verdict is WEAK
            assert "weight" in doubted[name].note


@pytest.mark.slow
def test_an_inadequate_fit_claims_nothing(active):
    """What trials at rest tell by themselves has no part in the fit, and says nothing of it."""
    told = with_doubts(active, GRAVE, GAINS).measures()
    assert not any(m.verdict is KNOWN for m in told.values())
    grave = with_doubts(active, replace(GAINS, is_grave=True)).measures()
    assert {grave[name].basis for name in PASSIVE} == {"model", "rest"}
    for m in grave.values():
        assert m.verdict is not KNOWN
        if m.verdict is WEAK:
            assert ("inadequate" in m.note) == (m.basis != "rest")


@pytest.mark.slow
def test_a_change_is_withheld_only_where_a_doubt_touches_it(active):
    one, other = quantities(with_doubts(active, GAINS)), quantities(active)
    told = compare_sessions(one, other)
    judged = {n for n, d in told.measures.items() if d.p is not None}
    assert {"passive_stiffness@0deg", "slow_stiffness@0deg"} <= judged
    for name in ACTIVE:
        assert name not in judged
    assert not told.is_withheld
    everything = against("followed-roughly", r2=90.0)
    told = compare_sessions(quantities(with_doubts(active, everything)), other)
    assert told.is_withheld
    assert all(d.p is None for d in told.measures.values())


@pytest.mark.slow
def test_a_relaxed_trial_is_doubted_of_its_muscles_alone(tmp_path):
    (path,) = make("a", 901, tmp_path, (1,), kind="passive")
    fit = surae.fit(path, quality=())
    assert [(r.code, r.scope) for r in fit.adequacy.against] == [("emg-steady", Scope.MUSCLES)]
    told = fit.measures()
    tissue = [m for n, m in told.items() if n.startswith(("slow_torque@", "passive_stiffness@"))]
    assert len(tissue) > 3
    assert not any("weight" in m.note for m in tissue)
    of_muscles = told["activation_half_time"]
    assert "weight" in of_muscles.note or of_muscles.verdict is NONE
    fit.save(tmp_path / "fit.json")
    assert surae.load(tmp_path / "fit.json").adequacy == fit.adequacy


@pytest.mark.slow
def test_a_measured_relaxed_trial_is_not_doubted_of_tissue_by_gains(shared, tmp_path):
    told = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    path = shared / "dynamometer" / "Pas_Sho2Long.mat"
    (tmp_path / "leg.toml").write_text(told.replace("PL_50_01.mat", str(path)), encoding="utf-8")
    fit = surae.fit(tmp_path / "leg.toml", quality=())
    codes = {reason.code: reason.scope for reason in fit.adequacy.against}
    assert codes["emg-steady"] is Scope.MUSCLES
    alone = tuple(r for r in fit.adequacy.against if r.scope is Scope.MUSCLES)
    measures = with_doubts(fit, *alone).measures()
    assert not any("weight" in m.note for n, m in measures.items() if n.startswith("passive_"))
    assert any("weight" in m.note for m in measures.values())
    assert not any(m.verdict is KNOWN for m in with_doubts(fit, GRAVE).measures().values())
