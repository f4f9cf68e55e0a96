from dataclasses import replace

import pytest

from surae_thesis.claims import INTEGRATOR, Claim, NotThereError, Ruling, judge


def above_one(value: float | None) -> Ruling:
    if value is None:
        raise NotThereError("it failed")
    return Ruling(value > 1.0, f"{value:g}")


CLAIM: Claim[float | None] = Claim(
    "c", "3.1", "It rises.", "2", "It is above 1.", above_one, lambda value: f"From {value}."
)


@pytest.mark.parametrize(
    ("views", "verdict", "said"),
    [
        ({"": 2.0}, "holds", "holds"),
        ({"": 0.0}, "differs", "differs"),
        ({"a": 2.0, "b": 3.0, INTEGRATOR: 0.0}, "holds", "holds"),
        ({"a": 2.0, "b": 0.0}, "holds under a reading", "holds under a"),
        ({"a": 0.0, "b": 2.0, "c": 3.0}, "holds under a reading", "holds under b and c"),
        ({"a": 2.0, "b": None}, "holds under a reading", "holds under a"),
        ({"a": 0.0, INTEGRATOR: 2.0}, *["holds with the thesis's integrator"] * 2),
        ({"a": 0.0, INTEGRATOR: 0.0}, "differs", "differs"),
        ({"a": None, INTEGRATOR: 2.0}, *["cannot be checked"] * 2),
    ],
)
def test_the_verdict_counts_every_view(views, verdict, said) -> None:
    finding = judge(CLAIM, views)
    assert (finding.verdict, finding.said) == (verdict, said)
    assert set(finding.ours) == {name for name, value in views.items() if value is not None}


def test_a_reason_is_of_the_first_view_and_a_missing_fit_is_told() -> None:
    assert judge(CLAIM, {"a": 2.0, "b": 0.0}).reason == "From 2.0."
    assert judge(CLAIM, {"": None}).reason == "it failed"


def test_a_claim_is_judged_under_the_views_that_it_names_in_its_order() -> None:
    claim = replace(CLAIM, views=("b", "a"))
    finding = judge(claim, {"a": 2.0, "b": 3.0, "c": 0.0})
    assert list(finding.ours) == ["b", "a"]
    assert (finding.verdict, finding.reason) == ("holds", "From 3.0.")


def test_a_verdict_that_there_is_not_is_refused() -> None:
    with pytest.raises(ValueError, match="maybe"):
        replace(judge(CLAIM, {"a": 2.0}), verdict="maybe")
