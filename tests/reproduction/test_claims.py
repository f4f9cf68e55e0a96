import pytest

from surae.reproduction.claims import Claim, Finding, judged, unchecked

CLAIM = Claim(name="c", source="3.1", text="It rises.", number="2", rule="It is above 1.")


def test_a_verdict_follows_what_the_rule_says() -> None:
    assert judged(CLAIM, True, "3", why="never shown").verdict == "holds"
    assert judged(CLAIM, True, "3", why="never shown").reason == ""
    assert judged(CLAIM, False, "0", why="It is small.").verdict == "differs"
    assert judged(CLAIM, False, "0", why="It is small.").reason == "It is small."
    assert unchecked(CLAIM, "No data.").verdict == "cannot be checked"


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        ({"ours": "0", "verdict": "differs"}, "without a reason"),
        ({"ours": "", "verdict": "cannot be checked", "reason": " "}, "without a reason"),
        ({"ours": " ", "verdict": "holds"}, "without a number"),
        ({"ours": "1", "verdict": "maybe", "reason": "x"}, "unknown verdict"),
    ],
)
def test_a_finding_that_nobody_could_follow_is_refused(values, complaint) -> None:
    with pytest.raises(ValueError, match=complaint):
        Finding(claim=CLAIM, **values)


def test_a_finding_survives_a_file() -> None:
    finding = judged(CLAIM, False, "0", why="It is small.", figure="figure-1")
    assert Finding.of(finding.plain()) == finding
