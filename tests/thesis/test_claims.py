import re
from dataclasses import replace

import pytest

from surae_thesis import appendix, movements, simulation, tendons
from surae_thesis.claims import CAUSES, INTEGRATOR, Claim, NotThereError, Ruling, judge, read_claims
from surae_thesis.cohort import beyond, subjects
from surae_thesis.cohort.rules import COHORT
from surae_thesis.legs import EARLY, IN_TURN, LEAD, SLOW, STRAIN
from surae_thesis.section import SECTIONS
from surae_thesis.simulation.cells import MAGNITUDE, SIGNED


def above_one(value: float | None) -> Ruling:
    if value is None:
        raise NotThereError("it failed")
    return Ruling(value > 1.0, f"{value:g}")


CLAIM = Claim(
    id="c",
    source="3.1",
    statement="It rises.",
    number="2",
    says="It rose.",
    rule="It is above 1.",
    ours=above_one,
    why="So it is.",
    note=lambda value, claim: f"{claim.id} from {value}.",
)


@pytest.mark.parametrize(
    ("views", "verdict", "said"),
    [
        ({"": 2.0}, "holds", "holds"),
        ({"": 0.0}, "differs", "differs"),
        ({"a": 2.0, "b": 0.0, INTEGRATOR: 0.0}, "holds", "holds"),
        ({"a": 0.0, "b": 2.0, "c": 3.0}, "holds under a reading", "holds under b and c"),
        ({"a": 0.0, "b": 2.0, INTEGRATOR: 2.0}, "holds under a reading", "holds under b"),
        ({"a": 2.0, "b": None}, "holds", "holds"),
        ({"a": 0.0, INTEGRATOR: 2.0}, *["holds with the thesis's integrator"] * 2),
        ({"a": 0.0, INTEGRATOR: 0.0}, "differs", "differs"),
        ({"a": None, "b": 2.0}, *["cannot be checked"] * 2),
    ],
)
def test_the_first_view_decides_and_the_others_are_named(views, verdict, said) -> None:
    finding = judge(CLAIM, views)
    assert (finding.verdict, finding.said) == (verdict, said)
    assert set(finding.ours) == {name for name, value in views.items() if value is not None}


def test_a_reason_is_of_the_first_view_and_a_missing_fit_is_told() -> None:
    assert judge(CLAIM, {"a": 2.0, "b": 0.0}).reason == "c from 2.0. So it is."
    assert judge(CLAIM, {"": None}).reason == "it failed"


def test_a_note_that_cannot_be_made_is_left_out() -> None:
    def fails(value: float, claim: Claim) -> str:
        raise NotThereError

    assert judge(replace(CLAIM, note=fails), {"a": 2.0}).reason == "So it is."


def test_a_claim_is_judged_under_the_views_that_it_names_in_its_order() -> None:
    claim = replace(CLAIM, views=("b", "a"))
    finding = judge(claim, {"a": 2.0, "b": 3.0, "c": 0.0})
    assert list(finding.ours) == ["b", "a"]
    assert (finding.verdict, finding.reason) == ("holds", "c from 3.0. So it is.")


def test_a_verdict_that_there_is_not_is_refused() -> None:
    with pytest.raises(ValueError, match="maybe"):
        replace(judge(CLAIM, {"a": 2.0}), verdict="maybe")


RULES = {
    "protocols": [movements.__name__],
    "tendons": [tendons.__name__],
    "simulation": simulation.RULES,
    "subjects": [subjects.RULES],
    "beyond": [beyond.__name__],
    "appendix": [appendix.__name__],
}
#: The views that sections have, by section; of the others there is one.
VIEWS = {
    "simulation": {SIGNED, MAGNITUDE, STRAIN, IN_TURN, LEAD, EARLY, SLOW, INTEGRATOR},
    "subjects": {COHORT, STRAIN, INTEGRATOR},
}


@pytest.mark.parametrize("section", [section.name for section in SECTIONS])
def test_every_row_is_a_whole_claim_under_views_that_there_are(section) -> None:
    claims = read_claims(section, *RULES[section])
    assert len({claim.id for claim in claims}) == len(claims) > 0
    for claim in claims:
        assert re.fullmatch(r"[a-z0-9-]+", claim.id)
        texts = (claim.source, claim.statement, claim.number, claim.says, claim.rule)
        assert all(texts)
        assert "{" not in "".join((*texts, claim.why))
        assert set(claim.views) <= VIEWS.get(section, set())
        assert claim.cause in {"", *CAUSES}


def test_there_are_114_claims() -> None:
    assert sum(len(read_claims(name, *RULES[name])) for name in RULES) == 114


def test_numbers_that_calibrated_the_cohort_cannot_hold() -> None:
    every = [claim for name in RULES for claim in read_claims(name, *RULES[name])]
    assert {claim.id for claim in every if claim.calibrated} == {
        "fit-1-0-multiple-holds",
        "fit-1-0-ramp-and-hold",
    }
    assert judge(replace(CLAIM, calibrated=True), {"": 2.0}).said == "calibrated"


def test_an_order_without_its_size_is_a_verdict_of_its_own() -> None:
    def smaller(value: float) -> Ruling:
        return Ruling(value > 2.0, f"{value:g}", less=0.0 < value <= 2.0)

    claim = replace(CLAIM, ours=smaller)
    for value, said in ((3.0, "holds"), (1.0, "same direction, smaller"), (-1.0, "differs")):
        assert judge(claim, {"": value}).said == said
    assert judge(claim, {"a": 1.0, "b": 3.0}).said == "holds under b"
    assert judge(claim, {"a": -1.0, "b": 1.0}).verdict == "differs"  # the first view decides


def blind(value: float) -> Ruling:
    return Ruling(value > 1.0, f"{value:g}", untested="all are" if value > 2.0 else "")


@pytest.mark.parametrize(
    ("views", "said"),
    [
        ({"a": 3.0}, "not tested by this"),
        ({"a": 1.5}, "holds"),
        ({"a": 3.0, "b": 1.5}, "not tested by this"),  # the first view decides
        ({"a": 0.0, "b": 3.0}, "not tested by this"),
        ({"a": 0.0, "b": 3.0, "c": 1.5}, "holds under c"),
        ({"a": 0.0, "b": 0.5}, "differs"),
    ],
)
def test_what_could_not_have_come_out_otherwise_tests_nothing(views, said) -> None:
    finding = judge(replace(CLAIM, ours=blind), views)
    assert finding.said == said
    untested = {name for name, value in views.items() if value > 2.0}
    assert {name for name, (_, text) in finding.ours.items() if "not tested: all are" in text} == (
        untested
    )
    assert not any(finding.ours[name][0] for name in untested)


def test_what_chance_decides_is_not_tested_by_this() -> None:
    claim = replace(CLAIM, chance=lambda view, ours: "a coin" if ours(view).holds else "")
    assert judge(claim, {"": 2.0}).said == "not tested by this"
    assert judge(claim, {"": 0.0}).said == "differs"


def _asks_noise(function, seen=()) -> bool:
    """Whether a rule's code, or what it calls in its module, asks what noise does."""
    code = function.__code__
    names = {name for c in (code, *code.co_consts) if hasattr(c, "co_names") for name in c.co_names}
    others = [function.__globals__.get(name) for name in names - set(seen)]
    return bool(names & {"SAME_IPDE", "SAME_SEM"}) or any(
        _asks_noise(other, {*seen, *names})
        for other in others
        if hasattr(other, "__code__") and other.__module__ == function.__module__
    )


def test_a_rule_that_forgives_what_noise_does_says_so() -> None:
    claims = read_claims("simulation", *simulation.RULES)
    asking = {claim.id for claim in claims if _asks_noise(claim.ours.func)}
    said = {claim.id for claim in claims if re.search(r"noise(?: does)?, [0-9.]+", claim.rule)}
    assert said == asking
    assert {"patient-factor", "chosen-chirp", "ipde-ranking"} <= said


def test_a_rule_in_words_says_the_numbers_that_it_is_given() -> None:
    (claim,) = [c for c in read_claims("simulation", *simulation.RULES) if c.id == "noise-sem"]
    assert claim.ours.keywords["most"] == 3.75
    assert "3.75 %" in claim.rule
    assert "3.75 %" in claim.number
