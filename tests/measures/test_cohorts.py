"""Cohorts: what groups have in common, what a leg borrows, and who is not in it."""

import json
import math
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.cohorts.effects import random_effects
from surae.cohorts.member import CohortMember
from surae.cohorts.members import populations, read_table
from surae.cohorts.pooled import borrowed, ends_of, pool
from surae.inference import Adequacy, Grade
from surae.measures.compared import Quantities, Quantity
from surae.protocol import Protocol, generate
from surae.report.cohort import cohort_report
from surae.studies import virtual_subject, virtual_trial


def leg(
    name: str, value: float, sd: float, group: str = "", session: str = "", **how
) -> CohortMember:
    """A leg of which one parameter is known."""
    scales = FrozenDict(how.pop("scales", {}))
    q = Quantity("k_tri", "1/m", "…", "parameter", value, sd, sd, 0.0, bounds=(20.0, 600.0), **how)
    fine = Adequacy(Grade.ADEQUATE, (), 99.0)
    own = Quantities("muscle", FrozenDict(), fine, (name,), FrozenDict({"k_tri": q}))
    return CohortMember(name, "", group, session, scales, own)


def test_mean_and_spread_are_found_again_and_their_interval_holds() -> None:
    """200 cohorts of 12 legs, each leg as uncertain as another: coverage of 95 % intervals."""
    rng = np.random.default_rng(1)
    held, tau = [], []
    for _ in range(200):
        sd = rng.uniform(2.0, 25.0, 12)
        y = 200.0 + 15.0 * rng.standard_normal(12) + sd * rng.standard_normal(12)
        effects = random_effects(y, sd**2)
        low, high = effects.ci95
        held.append(low <= 200.0 <= high)
        tau.append(effects.tau2)
    assert 0.92 <= np.mean(held) <= 0.98
    assert np.mean(tau) == pytest.approx(15.0**2, rel=0.15)


def test_legs_that_do_not_differ_have_no_spread() -> None:
    assert random_effects(np.full(5, 3.0), np.full(5, 0.1)).tau2 == pytest.approx(0.0, abs=1e-6)


def test_weak_legs_borrow_and_strong_ones_stay() -> None:
    """Errors of weak values become smaller by 40 % and more; strong values do not move."""
    rng = np.random.default_rng(2)
    truth = 200.0 + 10.0 * rng.standard_normal(40)
    sd = np.where(np.arange(40) % 2, 60.0, 1.0)
    found = truth + sd * rng.standard_normal(40)
    told = pool([leg(f"L{i:02d}", y, s) for i, (y, s) in enumerate(zip(found, sd, strict=True))])
    drawn = np.array([each.shrunken for each in told.pooled["k_tri"].legs])
    weak = sd > 10
    before, after = (np.sqrt(np.mean((v - truth)[weak] ** 2)) for v in (found, drawn))
    assert after < 0.6 * before
    assert np.abs(drawn - found)[~weak].max() < 1.0


def test_groups_that_do_not_differ_are_not_said_to() -> None:
    rng = np.random.default_rng(3)
    claimed = 0
    for _ in range(100):
        rows = [leg(f"L{i}", 200 + 15 * rng.standard_normal(), 5.0, "ab"[i % 2]) for i in range(16)]
        claimed += pool(rows).pooled["k_tri"].differences["a → b"].p < 0.05
    assert claimed <= 11  # of 100 at 5 %


def test_a_difference_between_groups_is_found_and_its_interval_holds() -> None:
    rng = np.random.default_rng(4)
    held = found = 0
    for _ in range(100):
        rows = [
            leg(f"L{i}", 200 + 40 * (i % 2) + 10 * rng.standard_normal(), 5.0, "ab"[i % 2])
            for i in range(20)
        ]
        contrast = pool(rows).pooled["k_tri"].differences["a → b"]
        found += contrast.p < 0.05
        held += contrast.ci95[0] <= 40.0 <= contrast.ci95[1]
    assert found >= 98
    assert 88 <= held <= 100


@pytest.mark.parametrize(("count", "noted"), [(20, False), (150, True)])
def test_intervals_of_very_many_legs_come_with_a_warning(count, noted) -> None:
    rng = np.random.default_rng(0)
    legs = [leg(f"S{i}", 200.0 + 10.0 * rng.standard_normal(), 4.0) for i in range(count)]
    assert ("narrower than what all fits are wrong in" in pool(legs).note) == noted


def test_what_is_missing_or_at_a_bound_is_told_and_kept_apart() -> None:
    rows = [leg(f"L{i}", 200.0 + i, 5.0) for i in range(6)]
    bound = leg("B", 600.0, 5.0, at_bound=True, missing="it lies at its bound")
    none = replace(leg("N", 0.0, 1.0), quantities=None, missing="no such file")
    bad = leg("I", 20.0, 1.0, missing="the fit is inadequate: it hardly moves")
    told = pool([*rows, bound, none, bad]).pooled["k_tri"]
    assert told.at_bound == 1
    assert dict(told.left_out) == {
        "no such file": 1,
        "the fit is inadequate: it hardly moves": 1,
    }
    assert told.groups[""].k == 7
    assert told.groups[""].mean == pytest.approx(202.5, abs=1.0)  # the bound draws it nowhere
    assert {each.leg for each in told.legs} == {f"L{i}" for i in range(6)}


def test_sessions_of_a_leg_tell_its_change_and_count_once() -> None:
    rng = np.random.default_rng(5)
    rows = []
    for i in range(8):
        own = 200 + 20 * rng.standard_normal()
        rows += [
            leg(f"L{i}", own + 3 * rng.standard_normal(), 3.0, "a", "1"),
            leg(f"L{i}", own - 30 + 3 * rng.standard_normal(), 3.0, "a", "2"),
        ]
    told = pool(rows).pooled["k_tri"]
    assert told.groups["a"].k == 8
    assert told.changes["a"].difference == pytest.approx(-30.0, abs=5.0)
    assert told.changes["a"].p < 0.01


def test_a_clinical_scale_is_correlated_by_rank() -> None:
    rows = [leg(f"L{i}", 200.0 + i, 1.0, scales={"ashworth": float(i)}) for i in range(8)]
    assert pool(rows).pooled["k_tri"].scales["ashworth"].rho == pytest.approx(1.0)


def test_correlations_of_many_are_held_against_each_other() -> None:
    rng = np.random.default_rng(7)
    claimed = 0
    for _ in range(60):
        scales = [
            {f"s{k}": float(x) for k, x in enumerate(rng.standard_normal(10))} for _ in range(12)
        ]
        rows = [
            leg(f"L{i}", 200 + rng.standard_normal(), 1.0, scales=s) for i, s in enumerate(scales)
        ]
        claimed += min(c.p for c in pool(rows).pooled["k_tri"].scales.values()) < 0.05
    assert claimed <= 8  # without that 24 of 60


def test_session_10_comes_after_session_2() -> None:
    rows = [
        leg(f"L{i}", 200.0 + by + i, 1.0, "a", name)
        for i in range(4)
        for name, by in (("week 10", 30.0), ("week 2", 0.0))
    ]
    assert pool(rows).pooled["k_tri"].changes["a"].difference == pytest.approx(30.0)


def test_what_a_first_session_borrows_is_of_the_first_session() -> None:
    rows = [leg(f"L{i}", 200.0 + i, 1.0, "a", "1") for i in range(4)]
    rows += [leg(f"L{i}", 300.0 + i, 1.0, "a", "2") for i in range(4)]
    told = borrowed(pool(rows), rows, 1)
    assert all(each.shrunken < 210.0 for each in told.pooled["k_tri"].legs)


def test_sessions_of_a_leg_are_no_legs_more_for_a_population() -> None:
    rows = [leg(f"L{i}", 200.0, 1.0, "", str(n)) for i in range(2) for n in range(5)]
    assert populations(rows)[""] == {}  # two legs, ten sessions


def test_tables_of_european_spreadsheets_are_read(tmp_path) -> None:
    path = tmp_path / "legs.csv"
    path.write_text("fit;subject;spasm\n1.json;S1;1,5\n2.json;S2;\n", encoding="utf-8")
    assert [dict(member.scales) for _, member in read_table(path)] == [{"spasm": 1.5}, {}]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("fit,subject\n1.json,S1,3\n", "more cells"),
        ("fit,subject,mas,mas\n1.json,S1,1,2\n", "two columns"),
        ("fit,subject,mas\n1.json,S1,1+\n", "1.5"),
        ("fit,subject,mas\n1.json,S1,nan\n", "not a number"),
        ("fit,subject\n", "no rows"),
    ],
)
def test_tables_that_are_wrong_are_refused(tmp_path, text, told) -> None:
    path = tmp_path / "legs.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=told):
        read_table(path)


def test_the_page_draws_legs_over_sessions() -> None:
    rows = [
        leg(f"L{i}", 200.0 + i, 1.0, "ab"[i % 2], n, scales={"mas": float(i)})
        for i in range(6)
        for n in ("1", "2")
    ]
    named = [
        replace(
            row,
            quantities=replace(
                row.quantities,
                by_name=FrozenDict(
                    {
                        "passive_torque@10deg": replace(
                            row.quantities.by_name["k_tri"], name="passive_torque@10deg"
                        )
                    }
                ),
            ),
        )
        for row in rows
    ]
    page = cohort_report(pool(named), created=datetime(2026, 11, 22)).page()
    assert page.count("data:image/svg") == 2
    assert "passive_torque@10deg over sessions" in page
    assert "passive_torque@10deg and mas" not in page


def test_a_leg_twice_in_a_session_is_refused() -> None:
    with pytest.raises(InputError, match="twice"):
        pool([leg("A", 1.0, 1.0), leg("A", 2.0, 1.0)])


def test_a_population_has_median_and_spread() -> None:
    rng = np.random.default_rng(6)
    rows = [leg(f"L{i}", 200 * math.exp(0.1 * rng.standard_normal()), 2.0) for i in range(40)]
    median, spread = populations(rows)[""]["k_tri"]
    assert median == pytest.approx(200.0, rel=0.05)
    assert spread == pytest.approx(0.1, rel=0.3)


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """A table of three fits and one file that is not there."""
    folder = tmp_path_factory.mktemp("cohort")
    motion = generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=60.0)
    )
    lines = ["fit,subject,side,group,ashworth"]
    for seed in range(3):
        trial = virtual_trial(virtual_subject(seed), motion)
        surae.fit(trial, "muscle", starts=1, quality=()).save(folder / f"{seed}.json")
        lines.append(f"{seed}.json,S{seed},left,stroke,{seed % 3}")
    lines.append("gone.json,S9,left,stroke,")
    (folder / "cohort.csv").write_text("\n".join(lines), encoding="utf-8")
    return folder / "cohort.csv"


@pytest.mark.slow
def test_a_refit_narrows_what_is_weak_and_leaves_the_group_as_it_is(table) -> None:
    alone, together = surae.cohort(table), surae.cohort(table, refit=True)
    assert together.rounds >= 1
    a, b = alone.pooled["tau_rel"], together.pooled["tau_rel"]
    assert a.groups == b.groups
    widths = [np.mean([leg.ci95[1] - leg.ci95[0] for leg in p.legs]) for p in (a, b)]
    own = np.mean([2 * 1.96 * leg.sd for leg in a.legs])
    assert widths[1] < own


@pytest.mark.usefixtures("few")
def test_a_table_of_fits_is_a_cohort_with_its_file_and_page(table, tmp_path) -> None:
    from click.testing import CliRunner

    from surae.cli import group

    with pytest.raises(InputError, match="is a fit"):  # the table's own fits are the user's
        CliRunner().invoke(
            group,
            ["cohort", str(table), "--output", str(table.parent / "0.json")],
            catch_exceptions=False,
            standalone_mode=False,
        )
    out, page = tmp_path / "c.json", tmp_path / "c.html"
    made = CliRunner().invoke(
        group, ["cohort", str(table), "--workers", "1", "--output", str(out), "--report", str(page)]
    )
    assert made.exit_code == 0, made.output
    assert "S9 left: no fit" in made.output
    assert "Cohort of 4 legs" in page.read_text(encoding="utf-8")
    data = json.loads(out.read_text(encoding="utf-8"))
    assert data["legs"] == 4
    assert "gone.json" in data["missing"]["S9 left"]
    assert data["quantities"]["passive_stiffness@10deg"]["groups"]["stroke"]["n"] == 3


def reached(name: str, end: float, begin: float | None = None) -> CohortMember:
    """A leg that was moved up to an angle [deg]."""
    one = leg(name, 200.0, 5.0)
    q = replace(
        one.quantities.by_name["k_tri"],
        name="end_stiffness",
        kind="measure",
        value=0.3,
        total=0.02,
        from_deg=end - 10.0 if begin is None else begin,
        to_deg=end,
    )
    return replace(
        one, quantities=replace(one.quantities, by_name=FrozenDict({"end_stiffness": q}))
    )


def test_legs_that_were_moved_to_other_angles_are_told_apart() -> None:
    alike = [reached(f"L{i}", 19.5 + 0.1 * i) for i in range(4)]
    assert ends_of(alike) is None
    assert pool(alike).pooled["end_stiffness"].over == "9.5° to 19.5°"
    assert pool(alike).note == ""
    mixed = [*alike, reached("far", 34.4)]
    assert ends_of(mixed) == (19.5, 34.4)
    told = pool(mixed)  # not measured again over what all reached, the far one is not compared
    assert told.pooled["end_stiffness"].over == "9.5° to 19.5°"
    assert sum(told.pooled["end_stiffness"].left_out.values()) == 1
    near = pool([*alike, reached("short", 19.5, 11.5)])
    assert near.pooled["end_stiffness"].is_mixed
    assert "each leg over a range of its own" in near.note


def ranged(name: str, value: float, begin: float, group: str) -> CohortMember:
    """A leg of which stiffness at the end of its range is known."""
    q = Quantity("end_stiffness", "Nm/deg", "…", "measure", value, 0.01, 0.01, 0.0, from_deg=begin)
    fine = Adequacy(Grade.ADEQUATE, (), 99.0)
    own = Quantities("muscle", FrozenDict(), fine, (name,), FrozenDict({q.name: q}))
    return CohortMember(name, "", group, "", FrozenDict(), own)


def test_legs_moved_over_other_ranges_are_not_compared_in_stiffness_at_the_end() -> None:
    """The same legs, moved to 10° and to 24°."""
    values = (0.10, 0.11, 0.12, 0.11)
    far = [ranged(f"A{i}", v, 14.0, "far") for i, v in enumerate(values)]
    near = [ranged(f"B{i}", 0.6 * v, 0.0, "near") for i, v in enumerate(values)]
    told = pool([*far, *near]).pooled["end_stiffness"]
    assert told.differences == {}
    assert sum(told.left_out.values()) >= 4
    alike = [ranged(f"B{i}", 0.6 * v, 14.5, "near") for i, v in enumerate(values)]
    assert pool([*far, *alike]).pooled["end_stiffness"].differences


def test_a_question_of_a_cohort_has_the_full_level() -> None:
    def both(name: str, k: float, other: float, group: str) -> CohortMember:
        member = leg(name, k, 1.0, group)
        q = member.quantities.by_name["k_tri"]
        rows = {"k_tri": q, **{f"m{i}": replace(q, name=f"m{i}", value=other) for i in range(30)}}
        return replace(member, quantities=replace(member.quantities, by_name=FrozenDict(rows)))

    rng = np.random.default_rng(4)
    members = [
        both(f"{g}{i}", 200.0 + by + 10.0 * rng.standard_normal(), rng.normal(200.0, 10.0), g)
        for g, by in (("a", 0.0), ("b", 20.0))
        for i in range(6)
    ]
    asked, explored = (pool(members, q).pooled["k_tri"] for q in (["k_tri"], []))
    (p,), (wide,) = (list(each.differences.values()) for each in (asked, explored))
    assert asked.asked
    assert p.p < 0.05 < wide.p
    with pytest.raises(InputError, match="k_try"):
        pool(members, ["k_try"])
