"""What each trial of a session is: decided from the data, said, and overruled where told."""

import shutil

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.recording import Recording
from surae.recording.corrections import Corrections

DYNAMOMETER = """\
side = "right"
fixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }
[channels.angle]
column = "Angle"
unit = "deg"
sign = -1
[channels.torque]
column = "Torque"
unit = "Nm"
sign = -1
[channels.emg_ta]
column = "EMG_TA"
unit = "V"
"""


@pytest.fixture(scope="module")
def measured(shared, tmp_path_factory):
    """The eleven measured trials of one leg in one folder, and their mapping."""
    folder = tmp_path_factory.mktemp("measured")
    for part in ("dynamometer", "repeats"):
        for file in (shared / part).glob("*.mat"):
            shutil.copy(file, folder)
    (folder / "map.toml").write_text(DYNAMOMETER)
    return folder


@pytest.fixture(scope="module")
def measured_session(measured):
    return surae.session(measured, mapping=measured / "map.toml")


def test_the_measured_trials_are_what_their_authors_say(measured_session):
    session = measured_session
    assert len(session.trials) == 11
    for trial in session.trials:
        passive = trial.name.startswith("Pas_")
        assert trial.effort == ("passive" if passive else "active"), trial.name
        moves = trial.name.startswith("PL_") or trial.name == "Pas_Sho2Long"
        assert trial.moves is moves, trial.name
        assert trial.use == ("fit" if moves else "hold"), trial.name
    assert session.side == "right"
    assert session["Pas_10"].hold.angle == pytest.approx(np.deg2rad(-8.1), abs=0.01)
    assert "static hold" in session["Ref_Long_01"].why


def test_a_hold_is_never_fitted(measured_session):
    with pytest.raises(InputError, match=r"Ref_Long_01 cannot be fitted.*static hold"):
        measured_session.fit("Ref_Long_01", "muscle")
    with pytest.raises(InputError, match="Pas_5 cannot be fitted"):
        measured_session.fit(["PL_0_01", "Pas_5"], "muscle")
    with pytest.raises(InputError, match="there is no trial 'PL_7'"):
        measured_session.fit("PL_7")


def test_an_effort_that_is_told_goes_before_the_data(measured):
    efforts = {"Ref_Long_01": "maximal", "PL_0_01": "maximal"}
    session = surae.session(measured, mapping=measured / "map.toml", efforts=efforts)
    assert session["Ref_Long_01"].use == "reference"
    assert session["PL_0_01"].use == "fit"  # it moves: it is both
    assert session.emg_reference().kind == "mvc"
    assert session.emg_reference().count == 2


def synthetic(name, angle=0.0, emg=0.0, seed=0):
    """Ten seconds at 500 Hz: angle [rad] and raw EMG of soleus, active in its second half."""
    time = np.arange(5000) / 500
    rng = np.random.default_rng(seed)
    raw = 1e-6 * rng.standard_normal((5000, 4))
    raw[2500:, 2] += emg * rng.standard_normal(2500)
    motion = angle * np.sin(time)
    return Recording.from_arrays(time, motion, 3 + 10 * motion, raw, name=name)


def test_a_hold_is_maximal_where_it_is_harder_than_any_movement():
    trials = [synthetic("a", 0.2, 1e-4), synthetic("strong", 0.0, 3e-4), synthetic("rest", 0.2)]
    session = surae.session(trials)
    assert [(t.effort, t.use) for t in session.trials] == [
        ("active", "fit"),
        ("maximal", "reference"),
        ("passive", "fit"),
    ]
    alike = surae.session([trials[0], synthetic("alike", 0.0, 1.1e-4)])
    assert (alike["alike"].effort, alike["alike"].use) == ("active", "hold")


@pytest.mark.parametrize("name", ["MVC_sol", "mvc2", "sol max", "Max3"])
def test_a_trial_may_be_maximal_by_its_name(name):
    session = surae.session([synthetic("a", 0.2, 1e-4), synthetic(name, 0.0, 0.5e-4)])
    assert session[name].effort == "maximal"
    assert session[name].why.endswith("maximal by its name")


@pytest.mark.parametrize("level", [1.0, 100.0])
def test_emg_that_never_changes_says_nothing_of_the_muscles(level):
    """Noise alone, and a muscle that is as active throughout: nobody can tell them apart."""
    time = np.arange(5000) / 500
    angle = 0.2 * np.sin(time)
    trials = [
        Recording.from_arrays(
            time,
            angle,
            10 * angle,
            level * 1e-6 * np.random.default_rng(seed).standard_normal((5000, 4)),
            name=name,
        )
        for seed, name in enumerate("ab")
    ]
    session = surae.session(trials)
    assert {trial.effort for trial in session.trials} == {"unknown"}
    assert "does not say" in session["a"].why


def test_without_emg_nobody_knows_the_effort():
    time = np.arange(500) / 100
    angle = 0.2 * np.sin(time)
    session = surae.session([Recording.from_arrays(time, angle, 10 * angle, name="a")])
    assert session["a"].effort == "unknown"


def test_files_of_one_name_in_two_folders_are_described_apart(measured, tmp_path):
    for folder in ("before", "after"):
        (tmp_path / folder).mkdir()
        shutil.copy(measured / "PL_0_01.mat", tmp_path / folder)
    (tmp_path / "m.toml").write_text(
        DYNAMOMETER + "[trials]\nbefore-PL_0_01.torque.sign = 1\nafter-PL_0_01.name = 'x'\n"
    )
    files = [tmp_path / folder / "PL_0_01.mat" for folder in ("before", "after")]
    session = surae.session(files, mapping=tmp_path / "m.toml")
    before, after = (
        session[f"{folder}-PL_0_01"].recording.channels["torque"].values
        for folder in ("before", "after")
    )
    np.testing.assert_array_equal(before, -after)


def test_what_cannot_be_a_session(leg, tmp_path):
    for given, says in (
        (tmp_path / "none", "no such file"),
        ([leg / "walk 1.csv", leg / "walk 1.csv"], "both trial 'walk 1'|both trial"),
        ([leg / "broken.csv"], "no trial can be read: .*row 3"),
        ([], "there is no recording"),
    ):
        with pytest.raises(InputError, match=says):
            surae.session(given)
    with pytest.raises(InputError, match="effort of trial 'x' is not known"):
        surae.session(leg, efforts={"x": "passive"})
    with pytest.raises(InputError, match="use one of: passive, active, isometric, maximal"):
        surae.session(leg, efforts={"hold": "lazy"})


def test_a_slip_in_the_mapping_is_told(measured, tmp_path):
    (tmp_path / "m.toml").write_text(DYNAMOMETER + "[trials]\nPL_9.torque.sign = 1\n")
    with pytest.raises(InputError, match=r"trials\.PL_9: there is no such trial; trials: PL_0_01"):
        surae.session(measured, mapping=tmp_path / "m.toml")


def test_a_stream_and_what_was_made_of_it_are_one_trial(leg, tmp_path):
    surae.recording.write_hdf5(tmp_path / "trial-01.h5", surae.read(leg / "walk 1.csv"))
    (tmp_path / "trial-01.xdf").write_bytes(b"XDF:")
    (tmp_path / "trial-01.json").write_text("{}")
    assert [trial.name for trial in surae.session(tmp_path).trials] == ["trial-01"]


def test_mappings_of_one_recording_are_trials_and_their_files_are_not(shared):
    session = surae.session(shared / "gait")
    assert [trial.name for trial in session.trials] == ["run81", "walk36"]
    assert session.fitted == ("run81", "walk36")


def test_repr_is_one_screen(measured_session):
    assert len(repr(measured_session).splitlines()) == 12
    assert "PL_0_01: fit: active" in repr(measured_session)


def test_holds_with_effort_at_several_angles_are_one_isometric_set():
    def held(k, angle):
        recording = synthetic(f"h{k}", emg=1e-4, seed=k)
        return Corrections(offset={"angle": angle})(recording)

    rest = synthetic("rest")
    trials = surae.session([*(held(k, 0.15 * k) for k in range(4)), rest]).trials
    assert [(t.effort, t.use) for t in trials[:4]] == [("isometric", "fit")] * 4
    assert trials[4].use == "hold"
    checked = surae.api.check_together([held(k, 0.15 * k) for k in range(4)])
    assert {f.severity for q in checked for f in q.findings if f.code == "angle-still"} == {"info"}
    alone = surae.api.check_together([held(k, 0.01 * k) for k in range(4)])
    assert {"angle-still"} <= {f.code for f in alone[0].findings if f.severity == "error"}
    alike = surae.session([*(held(k, 0.01 * k) for k in range(4)), rest]).trials
    assert {t.effort for t in alike[:4]} == {"active"}  # at one angle they tell no more than one


def test_two_files_of_one_name_are_two_trials(leg, tmp_path):
    for name in ("a.csv", "a.txt", "b.csv"):
        shutil.copy(leg / "walk 1.csv", tmp_path / name)
    assert [trial.name for trial in surae.session(tmp_path).trials] == ["a.csv", "a.txt", "b"]


def bids(folder, leg, *parts):
    """A data set of BIDS: a table of persons, and a recording in each of these subfolders."""
    for k, part in enumerate(parts):
        place = folder / part / "emg"
        place.mkdir(parents=True)
        entities = part.replace("/", "_")
        shutil.copy(leg / "walk 1.csv", place / f"{entities}_task-ankle_run-{k + 1}_emg.csv")
    (folder / "participants.tsv").write_text("participant_id\tsex\nsub-01\tF\n")
    return folder


def test_a_data_set_in_subfolders_is_read_where_it_is_of_one_leg(leg, tmp_path):
    one = bids(tmp_path / "sub-lab", leg, "sub-01/ses-1")
    assert [t.name for t in surae.session(one).trials] == ["sub-01_ses-1_task-ankle_run-1_emg"]


@pytest.mark.parametrize(
    ("second", "what"), [("sub-02/ses-1", "2 persons"), ("sub-01/ses-2", "2 visits")]
)
def test_persons_and_visits_of_a_data_set_are_not_one_leg(leg, tmp_path, second, what):
    both = bids(tmp_path / "bids", leg, "sub-01/ses-1", second)
    with pytest.raises(InputError, match=f"recordings of {what}.*one leg in one visit"):
        surae.session(both)
