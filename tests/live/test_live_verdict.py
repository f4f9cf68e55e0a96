"""What is said of a trial, and what must not be said."""

import shutil
import time
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from streaming import Quick, described, waited

import surae
from perturbed_ankle import Ankle
from relaxed_ankle import Ankle as RelaxedAnkle
from relaxed_ankle import measured as at_rest
from surae.api import words_in
from surae.base.errors import InputError
from surae.base.names import LANGUAGES
from surae.base.words import Message
from surae.planning.torque import load_of
from surae.processes import End
from surae.protocol import Protocol, generate, write_protocol_csv
from surae.quality import Finding, Quality
from surae.recording import write_csv, write_hdf5
from surae.studies import virtual_recording, virtual_subject
from surae_workbench.live.judge import decided, judge, tells
from surae_workbench.live.mapping import mapping_of
from surae_workbench.live.room import Room, _files
from surae_workbench.live.stream import Stream
from surae_workbench.live.trials import Trials
from surae_workbench.live.xdf import XdfLog


def finding(code: str, severity: str) -> Finding:
    return Finding(code, severity, "emg_sol", 0.0, 1.0, 1.0, "V", f"It is {code}.", "Mend it.")


def said(*findings: Finding, use: str = "fit", grade: str | None = "adequate", reasons=()) -> dict:
    told = {"use": use, "grade": grade, "reasons": list(reasons), "why": "it holds still"}
    advised = decided(Quality("trial", findings), told)
    return {"verdict": advised.verdict, "advice": advised.said(words_in("en"))}


def test_every_language_gives_the_reason_that_english_gives() -> None:
    why = "the torque is not finite"
    unusable = {"use": "none", "grade": None, "reasons": [], "why": why}
    advised = decided(Quality("trial", ()), unusable)
    for language in LANGUAGES:  # no catalogue has this one, which is better than another reason
        assert advised.said(words_in(language)) == why
    held = {**unusable, "use": "hold", "why": "it holds still"}
    texts = {
        language: decided(Quality("trial", ()), held).said(words_in(language))
        for language in LANGUAGES
    }
    assert all("it holds still" in text for text in texts.values())
    assert len(set(texts.values())) == len(LANGUAGES)


def test_a_verdict_is_worded_in_each_language_from_one_decision() -> None:
    reasons = [Message("plainly/emg-steady"), Message("plainly/implausible")]
    doubtful = {"use": "fit", "grade": "doubtful", "reasons": reasons, "why": ""}
    clash = decided(Quality("trial", ()), doubtful, wrong="It moved.")
    assert (clash.verdict, clash.message) == ("look", "It moved.")
    open_ = decided(Quality("trial", ()), doubtful)
    bad = decided(Quality("trial", ()), doubtful | {"grade": "inadequate"})
    for language in LANGUAGES:
        _ = words_in(language)
        for reason in reasons:
            assert _(reason) in open_.said(_)
        first = bad.said(_)
        assert first[0].isupper()
        assert first.endswith(".")
        assert _(reasons[1]) in first


def test_a_good_trial_is_kept_without_a_word() -> None:
    assert said() == {"verdict": "keep", "advice": ""}


def test_what_is_wrong_is_named_and_the_cause_comes_first() -> None:
    told = said(finding("mains-hum", "error"), finding("electrode-off", "error"))
    assert told == {"verdict": "repeat", "advice": "It is electrode-off. Mend it."}


@pytest.mark.parametrize("grade", ["adequate", "doubtful", None])
def test_nothing_with_an_error_is_kept(grade) -> None:
    assert said(finding("time-gap", "error"), grade=grade)["verdict"] == "repeat"


def test_a_warning_is_to_be_looked_at_and_a_remark_is_not() -> None:
    assert said(finding("overshoot", "warning"))["verdict"] == "look"
    assert said(finding("rom-not-covered", "info"))["verdict"] == "keep"


def test_an_inadequate_fit_is_repeated_and_a_doubtful_one_says_why() -> None:
    assert said(grade="inadequate", reasons=["nothing moves"])["verdict"] == "repeat"
    told = said(grade="doubtful", reasons=["the leg softened during the trial"])
    assert told["verdict"] == "keep"
    assert told["advice"] == "Alone it leaves open: the leg softened during the trial."


def test_a_hold_is_kept_but_what_cannot_be_used_is_not() -> None:
    assert said(use="hold", grade=None)["verdict"] == "keep"
    assert said(use="none", grade=None) == {"verdict": "repeat", "advice": "it holds still"}


def stream(labels: list[str], units: list[str], kind: str = "x", name: str = "device") -> Stream:
    return Stream(2, name, kind, "here", labels, units, 100.0, False, "")


def test_streams_that_name_their_channels_as_we_do_need_no_mapping() -> None:
    target = stream(["angle"], ["rad"], kind="Target", name="surae target")
    made, _ = mapping_of([target, stream(["angle", "torque", "other"], ["deg", "Nm", "V"])])
    assert made.count("[channels.") == 2
    assert '"device: angle"' in made
    assert 'unit = "deg"' in made


@pytest.mark.parametrize(
    "streams",
    [
        [stream(["ankle"], ["rad"])],
        [stream(["angle"], [""])],
        [stream(["angle"], ["rad"]), stream(["angle"], ["rad"], name="other")],
        [stream(["torque"], ["Nm"])],
    ],
)
def test_nothing_is_guessed(streams) -> None:
    assert mapping_of(streams)[0] == ""


def appeared(room, tmp_path, file) -> dict:
    """What is said of a file that is put into the watched folder."""
    try:
        time.sleep(0.1)
        shutil.copy(file, tmp_path / "in" / "new.h5")
        waited(lambda: 1 in room.trials.verdicts)
        told = room.trials.verdicts[1].result(100)
    finally:
        room.close()
    assert list(room.trials.trials) == [1]
    assert told["protocol"] == "new.h5"
    assert (tmp_path / "out" / "trial-01.json").exists()
    return told


@pytest.fixture
def watched(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "old.h5").write_bytes(b"is there already")
    return tmp_path


def test_a_file_that_appears_in_the_watched_folder_is_a_trial(lsl, watched, monkeypatch) -> None:
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    (watched / "made.h5").write_bytes(b"something")
    room = Room(watched / "out", watch=watched / "in", joint=False)
    told = appeared(room, watched, watched / "made.h5")
    assert told["file"] == str(watched / "in" / "new.h5")


def test_a_file_that_is_renamed_while_it_is_looked_at_ends_no_watch(tmp_path, monkeypatch) -> None:
    for name in ("gone.csv", "kept.csv", ".hidden.csv", "copying.csv.part"):
        (tmp_path / name).write_text("x")
    whole = Path.is_file

    def looked(path: Path) -> bool:
        held = whole(path)
        (tmp_path / "gone.csv").unlink(missing_ok=True)
        return held

    monkeypatch.setattr(Path, "is_file", looked)
    assert _files(tmp_path) == {tmp_path / "kept.csv": 1}
    assert _files(tmp_path / "none") == {}


@pytest.mark.slow
def test_a_file_that_appears_is_judged_as_a_stream_is(lsl, watched) -> None:
    asked = Protocol(profile="multiple-holds", task="active", duration=20.0, rate_hz=1024.0)
    write_hdf5(watched / "made.h5", virtual_recording(virtual_subject(3), generate(asked)))
    room = Room(watched / "out", watch=watched / "in", joint=False)
    told = appeared(room, watched, watched / "made.h5")
    assert told["vaf"] > 99.0
    assert (watched / "out" / "trial-01.h5").exists()


def test_efforts_that_were_asked_for_are_told_to_the_judge_and_to_the_joint_fit(
    lsl, tmp_path, monkeypatch
) -> None:
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    (tmp_path / "mapping.toml").write_text("[channels]\n")
    trials = Trials(tmp_path, limits={"device": "achilles", "span": None})
    try:
        for effort in ("maximal", "passive", None):
            number = trials.start(**({} if effort is None else {"effort": effort}))
            Path(trials.path(number, ".h5")).write_bytes(b"a recording")
            trials.stop().result(20)
        waited(lambda: trials.session.get("trials") == [1, 2, 3])
        told = trials._judge.arguments
    finally:
        trials.close()
    asked = {"trial-01": "maximal", "trial-02": "passive"}
    assert told["efforts"] == asked
    assert trials.session["efforts"] == asked
    assert trials.session["device"] == "achilles"
    again = Trials(tmp_path)  # what was fitted together is, at the next start, without a new trial
    try:
        waited(lambda: again.session.get("trials") == [1, 2, 3])
    finally:
        again.close()


class Held(Quick):
    """A judge that says of a trial, and of all together, when it is let go."""

    def __init__(self, **how: object) -> None:
        super().__init__(**how)
        self.fitted: list[int] = []
        self.fit, self.judge = Event(), Event()
        self.judge.set()
        self.verdict = "keep"

    def call(self, function: str, arguments: dict) -> End:
        if function.endswith(":together"):
            self.fitted.append(len(arguments["recordings"]))
            self.fit.wait(20.0)
        else:
            self.judge.wait(20.0)
        end = super().call(function, arguments)
        return replace(end, value={**end.value, "verdict": self.verdict})


@pytest.fixture
def held(lsl, tmp_path, monkeypatch):
    """Trials of which two were made, and the first is being fitted while the second waits."""
    monkeypatch.setattr("surae_workbench.live.trials.Child", Held)
    (tmp_path / "mapping.toml").write_text("[channels]\n")
    trials = Trials(tmp_path)
    made(trials).result(20)
    waited(lambda: trials._refine.fitted == [1])
    made(trials).result(20)
    yield trials
    trials._judge.judge.set()
    trials._refine.fit.set()
    trials.close()


def made(trials: Trials) -> Future:
    """A trial; the future of its verdict."""
    number = trials.start()
    Path(trials.path(number, ".h5")).write_bytes(b"a recording")
    return trials.stop()


@pytest.mark.parametrize(("third", "counts"), [("keep", 3), ("repeat", 2)])
def test_a_joint_fit_that_waits_is_dropped_when_a_newer_trial_ends(held, third, counts) -> None:
    held._judge.judge.clear()
    told = made(held)  # it has ended, and is not judged yet
    held._refine.fit.set()
    held._later.submit(int).result(20)  # all that could begin has begun
    assert held._refine.fitted == [1]
    held._judge.verdict = third
    held._judge.judge.set()
    assert told.result(20)["verdict"] == third
    waited(lambda: held.session.get("trials") == [1, 2, 3][:counts])
    assert held._refine.fitted == [1, counts]


def test_a_joint_fit_that_fails_leaves_the_one_before(held, monkeypatch) -> None:
    held._refine.fit.set()
    waited(lambda: held.session.get("trials") == [1, 2])
    good = held.session
    monkeypatch.setattr(held._refine, "call", lambda *_: End("failed", message="it broke"))
    made(held).result(20)
    waited(lambda: held.session["state"] == "failed")
    assert held.session == {**good, "state": "failed", "why": "it broke", "fitting": [1, 2, 3]}


class Gone(Quick):
    """A judge that ends before it has said anything."""

    def call(self, function: str, arguments: dict) -> End:
        return super().call(function, arguments) if "warm" in function else self.end()

    def end(self) -> End:
        GOING.set()
        CLOSED.wait(20.0)
        return End("killed", message="its process was killed")

    def close(self) -> None:
        CLOSED.set()


GOING, CLOSED = Event(), Event()


@pytest.mark.parametrize("file", [False, True])
def test_a_trial_that_is_judged_when_all_ends_is_judged_at_the_next_start(
    lsl, tmp_path, monkeypatch, file
) -> None:
    GOING.clear()
    CLOSED.clear()
    monkeypatch.setattr("surae_workbench.live.trials.Child", Gone)
    (tmp_path / "mapping.toml").write_text("[channels]\n")
    (tmp_path / "other.h5").write_bytes(b"a recording")
    trials = Trials(tmp_path, joint=False)
    if file:
        trials.take(tmp_path / "other.h5")
    else:
        made(trials)
    assert GOING.wait(20.0)
    trials.close()
    assert trials.trials[1].verdict is None
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    again = Trials(tmp_path, joint=False)
    try:
        told = again.verdicts[1].result(20)
    finally:
        again.close()
    assert told["verdict"] == "keep"
    assert told.get("protocol") == ("other.h5" if file else None)


DEVICE = """\
name = "short"
range_rad = [-0.5, -0.1]
max_velocity_rad_s = 5.0
max_acceleration_rad_s2 = 100.0
"""


@pytest.fixture
def short(lsl, tmp_path, monkeypatch):
    """A room whose device reaches from -0.5 to -0.1 rad."""
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    (tmp_path / "short.toml").write_text(DEVICE)
    room = Room(tmp_path / "out", device=str(tmp_path / "short.toml"))
    yield room
    room.close()


@pytest.mark.parametrize("profile", ["multiple-holds", "sine", "maximum"])
def test_what_is_loaded_stays_within_the_device_that_is_there(short, profile) -> None:
    short.load(profile=profile, task="active", duration=20.0)
    angle = short.trajectory.angle
    assert (angle.min() > -0.51, angle.max() < -0.09) == (True, True)


@pytest.mark.parametrize("profile", ["prbs", "stretches"])
def test_movements_that_tell_tissue_from_reflex_run_relaxed(short, profile) -> None:
    short.load(profile=profile, task="active", duration=20.0)  # both have their own
    angle = short.trajectory.angle
    assert (angle.min() > -0.51, angle.max() < -0.09) == (True, True)
    assert short.planned["protocol"] == profile
    assert short.planned["effort"] == "passive"
    assert short.planned["seconds"] > 50.0


def test_what_stretches_will_tell_is_what_expect_says(short) -> None:
    short.load(profile="stretches")
    told = short.tells()
    assert any("reflex of 10 % would be seen" in line for line in told)
    assert told == tells(str(short._file))


def passive(tmp_path, leg, **changes) -> dict:
    """What is said of a relaxed trial."""
    write_hdf5(tmp_path / "made.h5", at_rest(leg, 1, **changes))
    return judge(str(tmp_path / "made.h5"), str(tmp_path / "trial.h5"), instructed="passive")


def test_a_relaxed_trial_is_judged_by_its_curve_and_says_how_stiff_the_leg_is(tmp_path) -> None:
    """A tissue with a steep toe is none of a model's, and no reason to measure it again."""
    said_ = passive(tmp_path, RelaxedAnkle(toe=0.0, stiff=0.8))
    assert said_["verdict"] != "repeat"
    assert (said_["grade"], said_["reasons"]) == ("adequate", [])
    assert "Nm/°" in said_["leg"][0]
    for language in LANGUAGES[1:]:
        assert said_["translated"][language]["leg"][0] != said_["leg"][0]


def test_a_relaxed_trial_with_a_torque_that_no_electrode_shows_is_looked_at(tmp_path) -> None:
    time_ = at_rest().channels["angle"].time
    beside = 6.0 * (np.sin(0.7 * time_) ** 8)
    said_ = passive(tmp_path, RelaxedAnkle(), beside=beside)
    assert said_["verdict"] == "look"
    assert said_["grade"] == "doubtful"
    assert said_["reasons"][0].startswith("The torque changes by")
    met = Message("relaxed/noisy", noise=1.2)
    told = {"use": "fit", "grade": "doubtful", "reasons": [met], "why": "", "against_rest": met}
    advised = decided(Quality("trial", ()), told)
    assert advised.verdict == "look"
    assert len({advised.said(words_in(language)) for language in LANGUAGES}) == len(LANGUAGES)


def test_a_perturbed_trial_is_kept_for_what_it_is(tmp_path) -> None:
    moved = Ankle(seconds=30.0).moved()
    columns = {"time_s": moved["time"], "angle_rad": moved["angle"], "torque_Nm": moved["torque"]}
    write_csv(tmp_path / "small.csv", columns)
    said = judge(str(tmp_path / "small.csv"), str(tmp_path / "small.h5"), instructed="passive")
    assert (said["use"], said["verdict"]) == ("nerve", "keep")
    assert "small random perturbations" in said["advice"]


def test_a_designed_protocol_keeps_to_the_device_and_too_much_is_not_loaded(
    lsl, tmp_path, monkeypatch
) -> None:
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    room = Room(tmp_path / "out", device="achilles")
    try:
        room.load(profile="passive-20")
        assert room.planned["effort"] == "passive"
        assert all("beyond" not in limit["text"] for limit in room.limits)
        most = max(map(abs, load_of(room.trajectory).torque))
        assert f"torque of virtual legs {most:.3g} Nm" in " ".join(e["text"] for e in room.limits)
        hard = Protocol(profile="multiple-holds", task="active", chirp_amplitude=0.1, rate_hz=256.0)
        write_protocol_csv(generate(hard), tmp_path / "hard.csv")
        with pytest.raises(InputError, match=r"hard is not loaded: .*torque.* beyond the 80 Nm"):
            room.load(tmp_path / "hard.csv")
        assert room.planned["protocol"] == "passive-20"
        room.load(tmp_path / "hard.csv", beyond=True)
        assert room.planned["protocol"] == "hard"
        command = surae.expect(room._file, legs=2)
        monkeypatch.setattr("surae.api.expect", lambda *_, **__: command)
        told = tells(str(room._file))
        assert command.load is not None
        assert told[0].endswith(f"; {command.load.text}.")
        assert "stiffness coefficient, triceps surae ±" in " ".join(told)
    finally:
        room.close()


def test_a_proposal_of_another_day_is_not_loaded(short) -> None:
    short.load(profile="sine", task="active", duration=20.0)
    shutil.copy(short._file, short.trials.folder / "measure-next.csv")
    with pytest.raises(InputError, match="nothing says yet"):
        short.load_next()
    short.trials.session["proposed"] = "passive-20"
    short.load_next()
    assert short.planned["protocol"] == "next: passive-20"


def test_a_range_is_the_subjects_and_the_device_must_reach_it(lsl, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    room = Room(tmp_path / "out", span=(-0.2, 0.1))
    try:
        room.load(profile="sine", task="active", duration=20.0)
        assert abs(room.trajectory.angle).max() < 0.21
    finally:
        room.close()
    (tmp_path / "short.toml").write_text(DEVICE)
    with pytest.raises(InputError, match="short"):
        Room(tmp_path / "out", device=str(tmp_path / "short.toml"), span=(-0.5, 0.1))
    with pytest.raises(InputError, match="not known"):
        Room(tmp_path / "out", device="nobody's")


def test_a_trackers_stream_is_recorded_as_a_film_on_its_own_clock(tmp_path) -> None:
    motion = generate(Protocol(profile="multiple-holds", duration=12.0, rate_hz=1024.0))
    robot = virtual_recording(virtual_subject(1), motion).channels
    still = replace(robot["angle"], values=0.0 * robot["angle"].values)
    robot = {**robot, "angle": still}  # so that nothing is fitted
    frames = 1.0 + np.arange(300) / 30.0
    lengths = 60.0 + np.sin(frames)
    lengths[50:60] = np.nan  # the tracker lost it
    log = XdfLog(tmp_path / "trial.xdf")
    told = []
    for number, (name, labels, at, values) in enumerate(
        (
            (
                "robot",
                {r: c.unit for r, c in robot.items()},
                robot["angle"].time,
                np.column_stack([c.values for c in robot.values()]),
            ),
            ("tracker", {"fascicle_tib": "mm"}, frames, lengths[:, None]),
        ),
        1,
    ):
        log.stream(number, described(name, labels, 1.0 / float(at[1] - at[0])))
        log.clock(number, float(at[0]), 0.0)
        log.samples(number, at, values)
        told.append(stream(list(labels), list(labels.values()), name=name))
    log.close()
    (tmp_path / "map.toml").write_text(mapping_of(told)[0], encoding="utf-8")
    judge(str(log.path), str(tmp_path / "trial.h5"), mapping=str(tmp_path / "map.toml"), begin=0.5)
    film = surae.read(tmp_path / "trial.h5").films["fascicle_tib"]
    found = np.isfinite(lengths)
    np.testing.assert_allclose(film.values, 1e-3 * lengths[found])
    np.testing.assert_allclose(np.diff(film.time), np.diff(frames[found]), atol=1e-3)
