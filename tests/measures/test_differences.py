"""What is claimed of differences, on quantities that are made up: no fit is needed for that."""

import math
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.inference import Adequacy, Grade
from surae.inference.judging.reasons import against
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import Quantities, Quantity
from surae.measures.difference import ChangeVerdict

LEADING = "end_torque"


def side(values: dict[str, float], session: float = 1.0, total: float = 1.0) -> Quantities:
    """A fit that brings these, each as sure as another."""
    rows = FrozenDict(
        (name, Quantity(name, "Nm", "…", "measure", value, total, session, 0.0))
        for name, value in values.items()
    )
    return Quantities("muscle", FrozenDict(), Adequacy(Grade.ADEQUATE, (), 99.0), ("a",), rows)


def many(rng=None, count: int = 40) -> dict[str, float]:
    names = [LEADING, *(f"m{i}" for i in range(count))]
    noise = np.zeros(len(names)) if rng is None else rng.standard_normal(len(names))
    return dict(zip(names, (10.0 + noise).tolist(), strict=True))


@pytest.mark.slow
def test_where_nothing_changed_few_comparisons_claim_something() -> None:
    rng = np.random.default_rng(1)
    claims = [bool(compare_sessions(side(many(rng)), side(many(rng))).changed) for _ in range(300)]
    assert np.mean(claims) <= 0.05


def test_what_is_asked_beforehand_has_the_full_level() -> None:
    before, after = side(many()), side({**many(), LEADING: 14.4, "m3": 14.4})
    # p = 0.0096 each: enough for what was asked, not among 41 that were looked at
    assert compare_sessions(before, after).changed == ()
    told = compare_sessions(before, after, question=[LEADING])
    assert [d.name for d in told.changed] == [LEADING]
    assert [d.name for d in told.measures.values() if d.asked] == [LEADING]
    assert told.measures[LEADING].smallest < 0.75 * told.measures["m3"].smallest
    assert told.sentence.startswith("Torque at the end of the range is more than before, by 4.4 Nm")
    assert "judged at the full level (Holm’s p-values): 1. Exploratory: 40" in told.multiplicity
    two = compare_sessions(before, after, question=[LEADING, "m3", "m4", "m5", "m6", "m7"])
    assert two.changed == ()  # six questions share the level
    assert two.as_dict()["measures"]["m3"]["asked"] is True
    with pytest.raises(InputError, match="did you mean 'end_torque'"):
        compare_sessions(before, after, question=["end_torqe"])
    with pytest.raises(InputError, match="one of the visits has none of it"):
        compare_sessions(before, after, question=["curve_size"])


def test_the_sentence_says_what_would_have_been_shown() -> None:
    told = compare_sessions(side(many()), side({**many(), LEADING: 11.0}), question=[LEADING])
    assert told.changed == ()
    assert "no change shown; the difference is 1 Nm (10 %)" in told.sentence
    assert "would have been shown" in told.sentence
    assert told.as_dict()["sentence"] == told.sentence
    assert told.sentence in told.as_table().text()


def test_what_many_have_is_found_and_is_exploratory() -> None:
    """The false discovery rate finds ten moderate changes of 41 that Holm would not."""
    moved = dict.fromkeys([LEADING, *(f"m{i}" for i in range(9))], 14.6)
    told = compare_sessions(side(many()), side({**many(), **moved}))
    assert {d.name for d in told.changed} == {*moved}
    assert "false discovery rate" in told.multiplicity
    assert "confirm it" in told.sentence


@pytest.mark.slow
def test_the_smallest_change_is_found_in_four_of_five() -> None:
    rng = np.random.default_rng(2)
    smallest = compare_sessions(side(many()), side(many())).measures[LEADING].smallest
    sd = 1.2 * math.sqrt(2.0)
    found = []
    for noise in sd * rng.standard_normal(300):
        told = compare_sessions(side(many()), side({**many(), LEADING: 10 + smallest + noise}))
        found.append(told.measures[LEADING].verdict is ChangeVerdict.CHANGED)
    assert 0.74 <= np.mean(found) <= 0.86


def test_stiffness_over_ranges_that_hardly_overlap_is_not_compared() -> None:
    def over(low: float):
        given = side(many())
        q = replace(given.by_name[LEADING], from_deg=low, to_deg=low + 10.0)
        return replace(given, by_name=FrozenDict({**given.by_name, LEADING: q}))

    told = compare_sessions(over(5.0), over(5.5)).measures[LEADING]
    assert told.verdict is ChangeVerdict.NONE_SHOWN
    assert (told.from_deg, told.to_deg) == (5.0, 15.0)
    told = compare_sessions(over(5.0), over(12.0)).measures[LEADING]
    assert told.verdict is ChangeVerdict.NOT_COMPARABLE
    assert "overlap" in told.note


def test_the_tibialis_tendon_is_held_to_more() -> None:
    """By chance it differs more between trials of one leg than any other value."""
    names = ("tendon_strain_tib@100N", "dlt_tib", "tendon_strain_tri@500N")
    told = compare_sessions(side(dict.fromkeys(names, 10.0)), side(dict.fromkeys(names, 15.0)))
    own, also, calf = (told.measures[name] for name in names)
    wide = [d.ci95[1] - d.ci95[0] for d in (own, also, calf)]
    assert wide[0] == wide[1] == pytest.approx(wide[2] * 2.0 / 1.2)


def test_between_two_legs_nothing_cancels() -> None:
    one, other = side(many(), total=5.0), side({**many(), LEADING: 16.0}, total=5.0)
    assert compare_sessions(one, other).measures[LEADING].verdict is ChangeVerdict.CHANGED
    told = compare_sessions(one, other, legs=True)
    assert told.changed == ()
    assert told.as_dict()["of"] == "legs"
    assert told.measures[LEADING].note.startswith("no difference shown")
    with pytest.raises(InputError, match="baselines"):
        compare_sessions(one, other, [one], legs=True)


def test_a_doubtful_fit_gets_no_verdict() -> None:
    """The difference and its interval are shown; nothing is claimed of it, however large."""
    sure, moved = side(many()), side({**many(), LEADING: 1000.0})
    assert compare_sessions(sure, moved).changed
    doubt = replace(
        moved, adequacy=Adequacy(Grade.DOUBTFUL, (against("at-bound", names="m"),), 99.0)
    )
    for pair in ((sure, doubt), (doubt, sure), (doubt, doubt)):
        told = compare_sessions(*pair)
        d = told.measures[LEADING]
        assert told.changed == ()
        assert told.is_withheld
        assert (d.verdict, d.p, d.smallest) == (ChangeVerdict.NOT_COMPARABLE, None, None)
        assert d.ci95[0] < d.difference < d.ci95[1]
        assert "is doubtful (at a bound: m)" in d.note
        assert "Holm" not in told.multiplicity


def test_few_baselines_are_known_badly() -> None:
    """The same spread, seen in two sessions and in twelve."""
    after = side({**many(), LEADING: 35.0})
    apart = [3.0 * (-1) ** i for i in range(12)]
    wide = []
    for shifts in (apart[:1], apart[:11]):
        again = [side({**many(), LEADING: 10.0 + 2 * shift}) for shift in shifts]
        d = compare_sessions(side(many()), after, again).measures[LEADING]
        wide.append((d.ci95[1] - d.ci95[0]) / 2.0)
    assert wide[0] > 2.0 * wide[1]


def test_a_fit_is_not_compared_with_itself(tmp_path) -> None:
    path = tmp_path / "fit.json"
    path.write_text("{}")
    with pytest.raises(InputError, match="same fit"):
        surae.change(path, tmp_path / "." / "fit.json")
