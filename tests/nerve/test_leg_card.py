"""*How much is nerve?* on the leg's page: what it says, and what it must not say."""

from dataclasses import replace

import pytest

import surae
from perturbed_ankle import Ankle, ramps
from surae.base.records import from_plain, to_plain
from surae.nerve.leg import IntervalEstimate, Nerve, StretchTorque, of_session
from surae.recording import Recording
from surae.report.language import words_in
from surae.report.nerve_card import nerve_card
from surae.trials.nerve import nerve_of

FAST = StretchTorque("dorsiflexion", 200.0, 14.0, 5.0, 1.0, 6.0, (5.0, 7.0))
PRESENT = Nerve(
    reflex="present",
    direction="plantarflexion",
    share=IntervalEstimate(8.86, (8.0, 9.8)),
    stiffness=IntervalEstimate(57.3, (55.0, 60.0)),
)


def said(nerve, language="en"):
    blocks, figures = nerve_card(nerve, words_in(language))
    texts = [f"{b.lead} {b.text}" for b in blocks if b.kind == "paragraph"]
    return texts, figures


def test_the_fastest_stretches_lead_and_perturbations_follow() -> None:
    slow = replace(FAST, speed=20.0, neural=1.0, ci95=(0.5, 1.5))
    other = replace(FAST, neural=7.0, ci95=(6.0, 8.0))
    texts, figures = said(replace(PRESENT, stretches=(slow, FAST, other)))
    assert texts[0].startswith("6.5 Nm of reflex in stretches at 200 °/s, of 14 Nm")
    assert texts[0].endswith("95 %: 5.5 to 7.5")  # a wrong tissue is wrong in all repeats
    assert texts[1].startswith("8.9 % of the torque’s changes")
    assert "reflex to plantarflexion" in texts[1]
    assert "1.0 Nm/° (0.96 to 1.0)" in texts[2]
    assert not any("viscous" in text for text in texts)  # beside a reflex it is not known
    assert set(figures) == {"nerve-stretches"}
    silent = replace(FAST, heard=False)
    assert said(Nerve((FAST, silent)))[0][0].endswith("probably: no EMG was recorded")
    assert said(PRESENT, "nl")[0][0].startswith("8,9 %")
    assert said(PRESENT, "nl")[0][0].count("willekeurig") == 0  # by will, to a physiologist
    unsure = replace(PRESENT, stretches=(FAST,), reflex="cannot tell", direction=None)
    assert said(unsure)[0][1].startswith("Cannot tell – small random movements do not show")
    assert not any("reflex" in text for text in said(unsure)[0][2:])  # none that is taken off


@pytest.mark.parametrize(
    ("nerve", "headline"),
    [
        (
            Nerve((replace(FAST, neural=None, ci95=(0.0, 14.0), heard=False),)),
            "Cannot tell without EMG",
        ),
        (Nerve((replace(FAST, neural=None, ci95=(2.0, 9.0)),)), "Cannot tell 2.0 to 9.0 Nm"),
        (
            Nerve((FAST, replace(FAST, neural=None, ci95=(0.0, 14.0), heard=False))),
            "Cannot tell without EMG",
        ),
        (Nerve((replace(FAST, neural=0.0, ci95=(0.0, 1.2)),)), "No reflex seen at most 1.2"),
        (Nerve((replace(FAST, neural=1.0, ci95=(0.0, 2.0)),)), "Cannot tell 0 to 2.0 Nm"),
        (Nerve((replace(FAST, direction="plantarflexion"),)), "Cannot tell these recordings"),
        (replace(PRESENT, reflex="cannot tell", direction=None), "Cannot tell small random"),
        (
            replace(PRESENT, reflex="none seen", share=IntervalEstimate(None, (0.0, 1.1))),
            "No reflex seen in small random movements: at most 1.1 %",
        ),
        (Nerve(problems=("a.csv: too short",)), "Cannot tell these recordings"),
    ],
)
def test_nothing_is_claimed_that_was_not_told(nerve, headline) -> None:
    texts, _ = said(nerve)
    assert texts[0].startswith(headline)
    assert not any("of reflex in stretches at 200" in text and "95 %" in text for text in texts)


def test_of_recordings_it_says_what_the_commands_say() -> None:
    small, fast = Ankle(seconds=30.0).recording(), ramps((10.0, 10.0, 120.0, 120.0), neural=6.0)
    nerve = of_session([small, Recording.from_arrays(*[[0.0, 0.1, 0.2]] * 3, name="x")], [fast])
    impedance, stretches = surae.impedance(small), surae.stretches(fast)
    assert nerve.reflex == impedance.reflex.verdict == "present"
    assert nerve.share.ci95 == impedance.measures["reflex_share"].ci95
    assert [s.neural for s in nerve.stretches] == [s.neural_Nm for s in stretches.stretches]
    assert len(nerve.problems) == 1
    assert from_plain(Nerve, to_plain(nerve)) == nerve  # as a session's index keeps it


def test_a_session_fits_no_muscles_to_perturbations_and_finds_series_of_stretches() -> None:
    small, slow, fast = (
        replace(each, name=name)
        for name, each in (
            ("small", Ankle(seconds=30.0).recording()),
            ("slow", ramps((10.0, 10.0))),
            ("fast", ramps((120.0, 120.0), neural=6.0)),
        )
    )
    leg = surae.session([small, slow, fast])
    assert (leg["small"].use, leg.fitted) == ("nerve", ("slow", "fast"))
    told = nerve_of(leg.trials)
    assert told is not None
    assert told.reflex == "present"
    assert {round(s.speed, -1) for s in told.stretches if s.direction == "dorsiflexion"} == {
        10,
        120,
    }
    assert nerve_of([leg["slow"]]) is None  # of one speed
