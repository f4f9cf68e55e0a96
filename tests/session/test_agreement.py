"""A leg's page says Yes only where the trials of its folder agree with the fit of all together."""

import html
import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api.session_run.checked import CheckedTrials
from surae.base.names import LANGUAGES
from surae.inference import Verdict
from surae.inference.judging.adequacy import doubted
from surae.inference.judging.reasons import OF_OTHER_TRIALS, OF_STIFFNESS, against
from surae.measures.by_model import measures_by_model
from surae.measures.points import points
from surae.quality import Finding
from surae.report.language import words_in
from surae.report.leg_cards import share_words
from undrawn import blank_figures, few_legs

pytestmark = pytest.mark.usefixtures("few")
QUICK = {"model": "muscle", "prepared": True, "starts": 1}
SLOPE = against(
    "other-slope", trial="walk 2", low=5.0, high=15.0, measured=0.2, expected=0.6, allowed=0.1
)


def codes(fit):
    return [r.code for r in fit.adequacy.against if r.code in OF_OTHER_TRIALS]


def folder_with(leg, tmp_path, write):
    """The leg's active trials and its hold, with another relaxed trial."""
    shutil.copytree(leg, tmp_path / "leg")
    write(tmp_path / "leg" / "passive.csv")
    with blank_figures(made=False), few_legs():
        return surae.session(tmp_path / "leg").run(tmp_path / "out", **QUICK)


def test_trials_of_one_leg_agree(done):
    _, result = done
    assert codes(result.joint) == []


@pytest.mark.parametrize(
    ("subject", "turned"), [(8, 0.0), pytest.param(3, np.radians(8.0), marks=pytest.mark.slow)]
)
def test_another_leg_or_a_moved_foot_is_never_a_yes(leg, relaxed_trial, tmp_path, subject, turned):
    result = folder_with(leg, tmp_path, lambda path: relaxed_trial(path, subject, turned))
    assert result.joint.adequacy.grade != "adequate"
    assert not result.answers()["Can I trust it?"].startswith("Yes")


def test_a_trial_that_was_left_out_is_asked(leg, relaxed_trial, tmp_path, monkeypatch):
    """Of another leg, and left out for an error: the fit of the others must predict it."""
    shutil.copytree(leg, tmp_path / "leg")
    relaxed_trial(tmp_path / "leg" / "passive.csv", 8)
    found = CheckedTrials.wrong

    error = Finding("emg-flat", "error", "emg_sol", 0.0, 1.0, 1.0, "-", "It is flat.", "Look.")

    def wrong(self, name):
        return error if name == "passive" else found(self, name)

    monkeypatch.setattr(CheckedTrials, "wrong", wrong)
    with blank_figures(made=False), few_legs():
        result = surae.session(tmp_path / "leg").run(tmp_path / "out", **QUICK)
    assert result.joined == ("walk 1", "walk 2")
    assert "passive" in " ".join(result.joint.adequacy.reasons)
    assert set(codes(result.joint)) & {"other-slope", "misses-trial", "other-stiffness"}
    saved = json.loads((tmp_path / "out" / "session.json").read_text(encoding="utf-8"))
    assert saved["joint_predictions"]["passive"]["torque_ci95_covers"] < 90.0
    assert surae.load(tmp_path / "out" / "joint.json").adequacy == result.joint.adequacy


@pytest.fixture(scope="module")
def disputed(done):
    """The leg's result, whose stiffness a trial contradicts."""
    _, result = done
    joint = result.joint
    judged = doubted(joint.adequacy, (SLOPE,), OF_OTHER_TRIALS)
    doubtful = replace(joint, assessment=replace(joint.assessment, adequacy=judged))
    return replace(result, joint=doubtful)


def test_what_a_trial_contradicts_is_given_by_no_door(disputed):
    before = disputed.fits["walk 1"].measures()
    # what rest tells is not the fit's, and stays
    assert disputed.joint.measures()["end_stiffness"].basis == "rest"
    told = {m.name: m for _, m in measures_by_model(disputed.joint, points([0.0, 10.0]))}
    for name in ("end_stiffness", "end_torque", "passive_stiffness@10deg", "slow_torque@0deg"):
        assert told[name].verdict is Verdict.UNDETERMINED
        assert "walk 2" in told[name].note
        assert "walk 2" not in before[name].note
    assert "walk 2" not in told["active_torque_max_tri@0deg"].note.partition("doubtful")[0]
    stiff = f"{told['end_stiffness'].value:.2g}"
    assert not disputed.answers()["How stiff is it?"].startswith(f"{stiff} Nm/°")


@pytest.mark.usefixtures("words_alone")
@pytest.mark.parametrize("language", LANGUAGES)
def test_the_page_names_trial_figures_and_what_to_do(disputed, tmp_path, language):
    disputed.report(tmp_path / "x.html", language=language)
    page = html.unescape((tmp_path / "x.html").read_text(encoding="utf-8"))
    trust = page[page.index('id="trust"') :]
    comma = "," if language != "en" else "."
    for part in ("walk 2", f"0{comma}2", f"0{comma}6", f"0{comma}1"):
        assert part in trust
    assert words_in(language)("nothing speaks against these numbers") not in page
    assert "{" not in trust.partition("<script")[0]


def test_a_fit_that_was_judged_is_judged_by_its_trials_anew(disputed):
    kept = doubted(disputed.joint.adequacy, (), OF_OTHER_TRIALS)
    assert not [r for r in kept.against if r.code in OF_STIFFNESS]
    inadequate = doubted(kept, (against("failed", grave=True),), ())
    assert doubted(inadequate, (SLOPE,), OF_OTHER_TRIALS).grade == "inadequate"


@pytest.mark.parametrize(
    ("tissue", "muscle", "said"),
    [
        ((49.0, (43.0, 56.0)), (45.0, (40.0, 50.0)), "Both tissue and muscle"),
        ((50.5, (46.0, 55.0)), (45.0, (40.0, 50.0)), "Both tissue and muscle"),
        ((60.0, (52.0, 68.0)), (35.0, (30.0, 40.0)), "Mostly tissue"),
        ((30.0, (25.0, 35.0)), (65.0, (55.0, 75.0)), "Mostly active muscle"),
        ((55.0, (30.0, 80.0)), (20.0, (-5.0, 45.0)), "Not clear which resists more"),
    ],
)
def test_which_resists_is_said_by_intervals(tissue, muscle, said):
    parts = [("tissue", *tissue), ("muscle", *muscle)]
    assert share_words(parts, words_in("en")) == said


def test_an_interval_holds_what_it_promises_and_not_another_leg(done, other_leg):
    _, result = done
    own = result.predictions["walk 1"]["walk 2"]
    assert 85.0 <= own.covers <= 100.0
    other = result.fits["walk 1"].predict(other_leg)
    assert other.covers < 70.0
    assert result.predictions["walk 1"]["walk 1"].covers is None  # it was in the fit
