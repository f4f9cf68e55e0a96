"""What deceives a relaxed curve, on legs of another author: said, or in the interval."""

import json

import pytest

import surae
from surae.inference import Grade, Verdict

make = pytest.importorskip("ankle_legs.make")

ANGLES = (-10.0, 0.0, 10.0)
OF_ANGLES = ("passive_torque", "passive_stiffness", "slow_torque", "slow_stiffness")
#: Family and seed, what is said, and whether that makes the numbers doubtful. A zero that moves is
#: found and taken off, so that it does not.
SAID = {
    ("ri", 502): ("relaxed/step", False),  # the torque's zero steps in mid-trial
    ("rj", 501): ("relaxed/reflex", True),  # a reflex in fast stretches
    ("rn", 502): ("relaxed/plate", True),  # a plate that nobody took off
    ("rl-11", 502): ("relaxed/plate", True),  # such a plate, which gives way too
    ("rf", 502): ("relaxed/less", True),  # tissue that softens and holds after rest
    ("rk", 501): ("relaxed/tone_calf", False),  # a tone of which electrodes show a part
}
#: What is not told apart from tissue, and is in the intervals.
WITHIN = {
    ("rm", 501): "a seat that is tilted and not stated",
    ("rd", 502): "a capsule",
    ("rb", 502): "a toe",
    ("rj", 502): "a small reflex of which electrodes show a part",
    ("rh", 502): "a heel that lifts",
    ("rl-6", 501): "a person who lets go slowly",
    ("rl-1", 501): "a foot that creeps in its straps",
}


def relaxed(family, seed, tmp):
    """What its first visit says, and the truth."""
    make.make(family, seed, tmp, trials=[1, 2, 3])
    leg = f"{family}-{seed}"
    found = surae.relaxed([tmp / leg / f"trial-{k}.csv" for k in (1, 2, 3)], angles=ANGLES)
    truth = json.loads((tmp / "truth" / f"{leg}.json").read_text(encoding="utf-8"))
    return found, truth["trials"][0]["measures"]


def shares(measures, truth):
    """How many intervals at stated angles hold, of how many."""
    held = [
        m.ci95[0] <= truth[m.name] <= m.ci95[1]
        for m in measures.values()
        if m.name.startswith(OF_ANGLES) and m.ci95 is not None and truth.get(m.name) is not None
    ]
    return sum(held), len(held)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), SAID)
def test_what_can_be_seen_is_said(family, seed, tmp_path) -> None:
    code, doubted = SAID[family, seed]
    found, truth = relaxed(family, seed, tmp_path)
    assert code in [message.code for message in found.curve.findings]
    if doubted:
        assert found.curve.grade is Grade.DOUBTFUL
        assert not [m for m in found.measures.values() if m.verdict is Verdict.IDENTIFIED]
    else:
        held, of = shares(found.measures, truth)
        assert held >= 0.9 * of >= 9


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), [("ra", 501), ("rc", 502), ("rj", 501), ("rn", 502)])
def test_no_tone_and_no_softening_is_said_where_there_is_none(family, seed, tmp_path) -> None:
    found, _ = relaxed(family, seed, tmp_path)
    said = [message.code for message in found.curve.findings]
    assert not [code for code in said if code.startswith("relaxed/tone")]
    assert "relaxed/less" not in said


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), WITHIN)
def test_what_cannot_is_in_the_interval(family, seed, tmp_path) -> None:
    found, truth = relaxed(family, seed, tmp_path)
    held, of = shares(found.measures, truth)
    assert held >= 0.9 * of >= 7


@pytest.mark.slow
def test_eight_seconds_of_rest_claim_nothing(tmp_path) -> None:
    make.make("ra", 501, tmp_path, trials=[1])
    whole = surae.read(tmp_path / "ra-501" / "trial-1.csv")
    found = surae.relaxed(whole.crop(0.0, 8.0))
    assert "relaxed/short" in [message.code for message in found.findings]
    assert found.curve.grade is Grade.DOUBTFUL
    assert not [m for m in found.measures.values() if m.verdict is Verdict.IDENTIFIED]
