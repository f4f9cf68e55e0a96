"""What changed of a relaxed leg: an ankle of known curve at two visits."""

import json
from dataclasses import replace

import numpy as np
import pytest

import surae
from relaxed_ankle import Ankle, measured, movement, with_emg
from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.base.words import Message
from surae.cli import main
from surae.inference import Adequacy, Grade
from surae.inference.relaxed.context import GAMMA
from surae.inference.relaxed.pair import coupled, paired_legs
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import Quantities
from surae.measures.difference import ChangeVerdict
from surae.measures.relaxed_change import SHIFT, rest_change
from surae.report.language import words_in
from surae.report.leg_cards import change_card

BEFORE = Ankle(zero=4.0)
SAME = Ankle(zero=-2.0, weight=3.1)
SOFTER = Ankle(zero=1.0, stiff=0.7 * BEFORE.stiff)
ANGLES = (0.0, 10.0)


@pytest.fixture(scope="module")
def curves():
    made = {"before": BEFORE, "same": SAME, "softer": SOFTER}
    return {
        name: surae.relaxed(measured(ankle, seed)).curve
        for seed, (name, ankle) in enumerate(made.items())
    }


def test_a_softer_leg_is_found_and_an_unchanged_one_is_not() -> None:
    question = ["torque_rise"]
    same = surae.change(measured(BEFORE, 0), measured(SAME, 1), question=question)
    assert same.changed == ()
    assert "no change shown" in same.sentence
    told = surae.change(measured(BEFORE, 0), measured(SOFTER, 2), question=question)
    d = told.measures["torque_rise"]
    assert (d.verdict, d.asked, d.basis) == (ChangeVerdict.CHANGED, True, "rest")
    wanted = [a.torque(20.0) - a.torque(-40.0) for a in (BEFORE, SOFTER)]
    assert d.ci95[0] < wanted[1] - wanted[0] < d.ci95[1]
    assert told.sentence.startswith("Rise of the torque over the range is less than before, by")


def test_differences_hold_what_is_true(curves) -> None:
    told = rest_change(curves["before"], curves["softer"], ANGLES).differences
    for angle in ANGLES:
        d = told[f"passive_stiffness@{angle:g}deg"]
        truth = SOFTER.stiffness(angle) - BEFORE.stiffness(angle)
        assert d.ci95[0] < truth < d.ci95[1]
        assert d.ci95_device[0] < truth < d.ci95_device[1]
        assert d.ci95_device[1] - d.ci95_device[0] < d.ci95[1] - d.ci95[0]
        assert d.difference == pytest.approx(d.after - d.before)


def test_what_both_visits_share_is_not_counted_twice(curves) -> None:
    """One estimate knows the difference better than two that are subtracted, as of two legs."""
    one, two = (
        rest_change(curves["before"], curves["same"], ANGLES, legs=legs) for legs in (False, True)
    )
    for name in ("torque_rise", "end_stiffness"):
        wide = [c.differences[name].ci95[1] - c.differences[name].ci95[0] for c in (one, two)]
        assert wide[0] < 0.9 * wide[1]
    assert one.alike > 0.8
    assert two.alike == 0.0


def test_pairs_are_the_same_again_and_keep_each_visits_own_curve(curves) -> None:
    pairs = paired_legs(curves["before"], curves["same"])
    again = paired_legs(curves["before"], curves["same"])
    assert np.array_equal(pairs.before.weights, again.before.weights)
    for legs, curve in ((pairs.before, curves["before"]), (pairs.after, curves["same"])):
        rows = curve.basis.features([20.0]) - curve.basis.features([-40.0])
        rise = legs.weights @ rows.T
        alone = curve.draws()
        assert rise.mean() == pytest.approx(
            float(np.average(alone.weights @ rows.T, weights=alone.share, axis=0)[0]), rel=0.05
        )


def test_the_bayes_factor_of_relaxing_alike() -> None:
    middle, sd = GAMMA
    knows_nothing = coupled(np.full(6, middle), sd**2 * np.eye(6))
    assert knows_nothing[0] == pytest.approx(0.0, abs=1e-9)
    assert knows_nothing[2][0, 0] == pytest.approx(sd**2)
    # by hand in one dimension: N(x₁ − x₂; 0, …) with flat data of small variance
    variance = 0.01
    agreeing, apart = (
        coupled(np.array([middle, middle + by]), variance * np.eye(2))[0] for by in (0.0, 1.0)
    )
    random = np.random.default_rng(5)
    g = np.array([middle, middle]) + 0.1 * random.standard_normal((400_000, 2))
    common = sd**2 - 0.5 * 0.15**2
    prior = np.array([[sd**2, common], [common, sd**2]])
    away = g - middle
    log = -0.5 * np.einsum("ij,jk,ik->i", away, np.linalg.inv(prior), away)
    log -= 0.5 * np.log(np.linalg.det(prior)) - 0.5 * (away**2).sum(axis=1) / sd**2
    log += np.log(sd**2)
    assert agreeing == pytest.approx(np.log(np.exp(log).mean()), abs=0.02)
    assert apart < -5.0


def test_a_shift_is_told_where_a_toe_tells_it(curves) -> None:
    """On the device it is known; at the ankle the zeros of both mountings are in it."""
    toe = Ankle(toe=-5.0, stiff=0.6, noise=0.05)
    later = replace(toe, toe=-1.0)
    first, second = (surae.relaxed(measured(a, k)).curve for k, a in enumerate((toe, later)))
    d = rest_change(first, second, ANGLES).differences[SHIFT]
    assert d.ci95_device[0] < 4.0 < d.ci95_device[1]
    assert d.ci95[0] < 0.0 < d.ci95[1]


def test_a_doubt_of_one_visit_withholds_and_one_of_both_does_not(curves) -> None:
    heavy = Message("relaxed/heavy", inertia=90.0)
    short = Message("relaxed/short", seconds=8.0)

    def doubtful(name: str, finding: Message):
        return replace(curves[name], grade=Grade.DOUBTFUL, findings=(finding,))

    before, after = curves["before"], curves["softer"]
    assert rest_change(before, after, ANGLES).doubt == ""
    # a plate that one visit has, and the other clearly not, does not cancel; a guess at one does
    guessed = rest_change(doubtful("before", heavy), after, ANGLES)
    assert guessed.doubt == ""
    certain = replace(doubtful("before", heavy), parts=((True, False),) * len(before.share))
    bare = replace(after, parts=((False, False),) * len(after.share))
    told = rest_change(certain, bare, ANGLES)
    assert "before is doubtful" in told.doubt
    both = rest_change(doubtful("before", heavy), doubtful("softer", heavy), ANGLES)
    assert both.doubt == ""
    both = rest_change(doubtful("before", short), doubtful("softer", short), ANGLES)
    assert "The leg rests for 8 s only" in both.doubt


def test_the_command_compares_folders_of_recordings(tmp_path, monkeypatch, capsys) -> None:
    for name, ankle, seed in (("before", BEFORE, 0), ("after", SOFTER, 2)):
        (tmp_path / name).mkdir()
        frame = measured(ankle, seed).to_dataframe()
        text = "# emg: envelope\n" + frame.to_csv(index=False)
        (tmp_path / name / "trial.csv").write_text(text, encoding="utf-8")
    output, page = tmp_path / "c.json", tmp_path / "c.html"
    given = [tmp_path / "before", tmp_path / "after", "--question", "torque_rise"]
    given += ["--output", output, "--report", page]
    monkeypatch.setattr("sys.argv", ["surae", "change", *map(str, given)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    done = capsys.readouterr().out
    data = json.loads(output.read_text(encoding="utf-8"))
    assert data["measures"]["torque_rise"]["asked"] is True
    assert data["measures"]["torque_rise"]["verdict"] == "changed"
    assert data["measures"]["end_stiffness"]["asked"] is False
    assert data["sentence"] in done
    assert data["sentence"] in page.read_text(encoding="utf-8")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="neither a session nor recordings"):
        surae.change(tmp_path / "empty", tmp_path / "after")


def test_a_folder_of_recordings_says_what_is_known_of_its_visit(tmp_path) -> None:
    """A zero that was measured makes what is read at an angle surer; other files are no trials."""
    for name, ankle, seed in (("before", BEFORE, 0), ("after", SAME, 1)):
        (tmp_path / name).mkdir()
        text = "# emg: envelope\n" + measured(ankle, seed).to_dataframe().to_csv(index=False)
        (tmp_path / name / "trial.csv").write_text(text, encoding="utf-8")
    places = [tmp_path / "before", tmp_path / "after"]
    alone = surae.change(*places).measures["torque_rise"]
    for place in places:
        (place / "session.toml").write_text(
            "[knowledge]\nangle_zero_deg = {value = 0.0, sd = 0.5}\n"
            '[trials]\n"empty.csv" = "empty device"\n',
            encoding="utf-8",
        )
        empty = measured(Ankle(stiff=0.0, weight=0.0, inertia=0.0), 5).to_dataframe()
        text = "# emg: envelope\n" + empty.to_csv(index=False)
        (place / "empty.csv").write_text(text, encoding="utf-8")
    known = surae.change(*places).measures["torque_rise"]
    assert np.ptp(known.ci95) < np.ptp(alone.ci95)
    (places[0] / "trial.csv").unlink()
    with pytest.raises(InputError, match=r"session\.toml: no recording of the leg is beside it"):
        surae.change(*places)


def quiet(level, seed=0, beside=0.0):
    """A trial without an effort, in which the soleus shows a steady EMG."""
    time = np.zeros((len(movement()[0]), 4))
    time[:, 2] = level
    return measured(BEFORE, seed, emg=time, beside=beside)


def test_a_tone_that_comes_without_an_effort_is_no_change() -> None:
    """It looks like rest at each visit; that its electrode is louder withholds the change."""
    change = surae.change(quiet(0.0), quiet(8e-6, 1, TONE), question=["torque_rise"])
    assert change.measures["torque_rise"].verdict is ChangeVerdict.NOT_COMPARABLE
    assert change.changed == ()
    assert "the electrode of SOL shows 5.0 times as much" in str(change.multiplicity)
    # whatever the unit of the EMG
    scaled = [with_emg(each, 1e-3) for each in (quiet(0.0), quiet(8e-6, 1, TONE))]
    assert surae.change(*scaled).changed == ()


def test_a_steady_electrode_at_both_visits_withholds_nothing() -> None:
    same = surae.change(quiet(8e-6), quiet(8e-6, 1), question=["torque_rise"])
    assert same.measures["torque_rise"].verdict is ChangeVerdict.NONE_SHOWN


#: Torque of a calf that never lets go, stronger where it is stretched [Nm].
TONE = 6.0 * np.exp((movement()[1] - 20.0) / 15.0)


@pytest.mark.parametrize("question", [(), ("curve_size",), ("torque_rise", "end_stiffness")])
@pytest.mark.parametrize("after", ["same", "softer"])
def test_card_table_and_file_say_one_sentence(curves, question, after) -> None:
    nothing = Quantities(
        "", FrozenDict(), Adequacy(Grade.ADEQUATE, (), np.nan), ("trial",), FrozenDict()
    )
    rest = rest_change(curves["before"], curves[after], ANGLES)
    change = compare_sessions(nothing, nothing, rest=rest, question=question)
    card = change_card(change, words_in("en"))
    assert card[0].text == change.sentence
    assert str(change.sentence) in change.as_table().above
    assert change.as_dict()["sentence"] == change.sentence
    claimed = [d.name for d in change.changed if d.asked or not question]
    assert bool(claimed) == (after == "softer")
    assert (card[0].lead == "Not shown") == (not claimed)
    for language in ("de", "fr", "nl"):
        there = change_card(change, words_in(language))[0].text
        assert there == words_in(language)(change.sentence) != change.sentence
