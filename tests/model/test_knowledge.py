"""What is known beforehand: what files may say, what steps show, what a fit makes of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.records import from_plain
from surae.model.geometry import moment_arm
from surae.model.geometry_file import read_geometry
from surae.model.joint import ANKLE
from surae.model.knowledge import Knowledge, Plate
from surae.model.knowledge_file import known_from, read_knowledge, read_session_toml
from surae.model.knowledge_priors import priors_of
from surae.model.knowledge_words import lines_of
from surae.model.source_table import SOURCES, advice
from surae.model.statements import StatedArm, StatedAxis, StatedZero
from surae.model.tare import tared, without
from surae.report.provenance import whose_geometry
from surae.settings import FitSettings
from surae.signals import ModelInputs, inputs_as_given
from surae.signals.selective import crosstalk, one_at_a_time

TABLE = Path(__file__).parents[1] / "data" / "geometry.csv"
RATE = 64.0


def moved(torque_of=None, seconds: float = 30.0, emg=None) -> ModelInputs:
    """A device that swings through 60° at growing speed; `torque_of` is of its motion."""
    time = np.arange(0.0, seconds, 1.0 / RATE)
    phase = 2.0 * np.pi * (0.1 * time + 0.02 * time**2)
    rate = 2.0 * np.pi * (0.1 + 0.04 * time)
    angle, velocity = 0.5 * np.sin(phase), 0.5 * rate * np.cos(phase)
    acceleration = -0.5 * rate**2 * np.sin(phase) + 0.5 * 0.04 * 2.0 * np.pi * np.cos(phase)
    torque = None if torque_of is None else torque_of(angle, velocity, acceleration)
    emg = np.zeros((len(time), 4)) if emg is None else emg
    motion = (angle, velocity, acceleration)
    return inputs_as_given("empty", RATE, time, motion, emg, torque=torque)


def device(angle, velocity, acceleration):
    rubbed = 0.2 * np.tanh(velocity / 0.02)
    return 0.03 * acceleration + 3.0 * np.cos(angle - 0.4) + 0.1 * velocity + rubbed - 4.0


def test_an_empty_device_is_told_within_its_interval() -> None:
    noise = np.random.default_rng(3).normal(0.0, 0.1, round(30 * RATE))
    plate = tared(moved(lambda *motion: device(*motion) + noise))
    true = (0.03, 3.0 * np.cos(0.4), 3.0 * np.sin(0.4), 0.1, 0.2, -4.0)
    apart = (np.array(plate.values) - true) / plate.sds
    assert np.all(np.abs(apart) < 3.0)
    assert plate.sds[0] < 0.003
    assert plate.sds[2] < 0.1


def test_a_recording_without_the_device_is_that_of_the_leg() -> None:
    plate = tared(moved(device))
    leg = moved(lambda a, v, acc: device(a, v, acc) + 5.0 * np.exp(3.0 * a))
    left = without(replace(plate, file="empty.csv"), leg)
    assert left.torque == pytest.approx(5.0 * np.exp(3.0 * leg.angle), abs=0.05)
    assert "empty.csv" in left.steps[-1]


def test_a_leg_is_no_empty_device() -> None:
    pulls = np.repeat(np.random.default_rng(1).uniform(0.0, 20.0, 30), round(RATE))
    with pytest.raises(InputError, match="no empty device"):
        tared(moved(lambda *motion: device(*motion) + pulls))


def test_a_device_that_stands_still_tells_nothing() -> None:
    still = replace(moved(device), angle=np.zeros(round(30 * RATE)))
    with pytest.raises(InputError, match="move it"):
        tared(still)


def alone(heard: np.ndarray, seed: int, seconds: float = 48.0) -> ModelInputs:
    """Three contractions of each muscle, the others helping by up to 20 %."""
    rng, n = np.random.default_rng(seed), round(seconds * RATE)
    own, each = np.zeros((4, n)), n // 12
    for k in range(12):
        burst = slice(k * each, k * each + round(0.7 * each))
        own[:, burst] = rng.uniform(0.0, 0.2, 4)[:, None]
        own[k // 3, burst] = rng.uniform(0.85, 1.0)
    emg = heard @ (np.array([2e-4, 1e-4, 3e-4, 1.5e-4])[:, None] * own)
    return moved(seconds=seconds, emg=(emg + 1e-6 * rng.random((4, n))).T)


def test_crosstalk_holds_within_its_interval() -> None:
    apart = []
    for seed in range(12):
        rng = np.random.default_rng(100 + seed)
        heard = np.eye(4) + rng.uniform(0.0, 0.08, (4, 4)) * (1.0 - np.eye(4))
        known = crosstalk(alone(heard, seed), (0.04, 0.03))
        assert len(known) == 12
        apart += [(value - heard[pair]) / sd for pair, (value, sd) in known.items()]
    assert np.mean(np.abs(apart) < 1.96) > 0.92
    assert np.sqrt(np.mean(np.square(apart))) < 1.2


def test_muscles_that_work_together_are_not_one_at_a_time() -> None:
    one = alone(np.eye(4), 1)
    muscles = ("ta", "gl", "sol", "gm")
    envelopes = {m: one.emg[:, i] for i, m in enumerate(muscles)}
    assert one_at_a_time(envelopes, RATE)
    together = dict.fromkeys(muscles, envelopes["ta"] + envelopes["sol"])
    assert not one_at_a_time(together, RATE)
    assert not one_at_a_time({}, RATE)


def said(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "session.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("[knowlege]\nplate = 'tared'", "did you mean 'knowledge'"),
        ("[knowledge]\nangle_zero = {value = 0, sd = 1}", "did you mean 'angle_zero_deg'"),
        ("[knowledge]\naxis_mm = {value = 0, sdd = 1}", "sdd"),
        ("[knowledge]\naxis_mm = {value = 0.0}", "sd"),
        ("[knowledge]\nangle_zero_deg = {value = 0.0, sd = 0.0}", "at least 0.001"),
        ("[knowledge]\nangle_zero_deg = {value = 90.0, sd = 1.0}", "at most 30"),
        ("[knowledge]\naxis_mm = {value = 'near', sd = 1.0}", "axis_mm"),
        ("[knowledge]\ngeometry_sd_percent = 3", "no effect without geometry"),
        ("[knowledge]\nheight_cm = 1.82", "at least 80"),
        ("[knowledge]\nfoot_mm = 250\ngeometry = 'g.csv'", "not both"),
        ("[knowledge]\narm_tri_mm = 45", "arm_tri_mm"),
        ("[knowledge]\narm_tri_mm = {value = 4.5, sd = 0.2}", "at least 12"),
        ("[knowledge]\nfoot_mm = 250\ngeometry_of = 'person'", "no effect without geometry"),
        ("[knowledge]\ngeometry = 'g.csv'\ngeometry_of = 'persn'", "did you mean 'person'"),
        ("[trials]\n'a.csv' = 'pasive'", "did you mean 'passive'"),
        ("trials = 3", "table of files"),
        ("[knowledge", "TOML"),
    ],
)
def test_what_is_misspelt_is_refused_in_a_line(tmp_path, text, match) -> None:
    with pytest.raises(InputError, match=match) as caught:
        read_session_toml(said(tmp_path, text))
    assert "session.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_plate_that_is_no_file_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="did you mean 'tared'"):
        known_from(read_session_toml(said(tmp_path, "[knowledge]\nplate = 'tarred'")))


def test_knowledge_becomes_priors_with_their_own_uncertainty(tmp_path) -> None:
    (tmp_path / "g.csv").write_bytes(TABLE.read_bytes())
    path = said(
        tmp_path,
        "[knowledge]\nangle_zero_deg = {value = 2.0, sd = 1.0}\n"
        "axis_mm = {value = [5.0, -2.0], sd = 3.0}\nplate = 'tared'\ngeometry = 'g.csv'\n"
        "geometry_of = 'person'\n",
    )
    settings = FitSettings.of(knowledge=path)
    assert settings.zero_sd == pytest.approx(np.hypot(1.0, 2.3))  # readers differ by 2.3°
    assert settings.fixed["angle_zero"] == pytest.approx(np.radians(2.0))
    beliefs = settings.beliefs
    assert beliefs["axis_forward"] == pytest.approx((0.005, np.hypot(0.003, 0.009)))
    assert beliefs["axis_up"] == pytest.approx((-0.002, np.hypot(0.003, 0.009)))
    tri, tib = read_geometry(TABLE).arms_mm
    assert beliefs["arm_scale_tri"] == pytest.approx((0.0, np.hypot(0.03, 4.0 / tri)))
    assert beliefs["path_scale_tib"] == pytest.approx((0.0, np.hypot(0.03, 4.0 / tib)))
    # as of a table that is said to be the person's own without any session.toml
    told = SOURCES["arms"].nuisance.measured["arm_scale_tri"].sd
    assert told == pytest.approx(np.hypot(0.03, 4.0 / 44.0), abs=2e-3)
    assert not settings.is_own
    assert {*settings.knowledge.statements} == {"angle_zero", "axis", "arms"}
    assert "second way" in advice("arms", settings.knowledge)
    assert advice("plate", settings.knowledge) == SOURCES["plate"].advice
    assert 0.0 < beliefs["plate_sin"][1] < 1.0
    assert settings.options.geometry.name == "g.csv"
    assert settings.geometry_of == "person"
    assert settings.known >= {"axis", "plate", "arm", "length"}
    assert from_plain(FitSettings, settings.as_dict()) == settings


def test_arms_and_paths_go_with_the_foot_and_the_foot_with_the_height() -> None:
    usual = priors_of(Knowledge(height_cm=175.0))
    assert [usual[f"arm_scale_{g}"][0] for g in ("tri", "tib")] == [0.0, 0.0]
    tall = Knowledge(height_cm=190.0)
    by_foot = priors_of(Knowledge(height_cm=160.0, foot_mm=10 * 0.152 * 190.0))
    for name, (mean, sd) in priors_of(tall).items():
        assert np.exp(mean) == pytest.approx(190.0 / 175.0)
        assert by_foot[name] == (pytest.approx(mean), sd)
        # size tells an arm less well than an image does, and hardly what a path travels
        assert sd == (0.08 if name.startswith("arm") else 0.3)
    assert "arm" in FitSettings.of(knowledge=tall).known
    assert "length" not in FitSettings.of(knowledge=tall).known
    with pytest.raises(InputError, match="not both"):
        Knowledge(geometry="g.csv", height_cm=190.0)
    assert FitSettings.of(knowledge={"height_cm": 190.0}).knowledge == tall


def test_a_childs_arms_go_with_its_height_or_its_age_and_its_foot_with_its_mass() -> None:
    small = priors_of(Knowledge(height_cm=80.0))
    assert np.exp(small["arm_scale_tri"][0]) == pytest.approx(80.0 / 175.0)
    for age, height in ((2.0, 87.0), (6.0, 115.5), (11.0, 144.0)):
        by_age = priors_of(Knowledge(age_years=age))["arm_scale_tib"]
        assert np.exp(by_age[0]) == pytest.approx(height / 175.0)
        assert by_age[1] == pytest.approx(np.hypot(0.08, 0.05))
        both = priors_of(Knowledge(age_years=age, height_cm=100.0))["arm_scale_tib"]
        assert both == (pytest.approx(np.log(100.0 / 175.0)), 0.08)
    assert Knowledge(age_years=40.0).size == 0.0
    assert Knowledge(mass_kg=20.0).mass == (pytest.approx(1.29), 0.3)
    assert ("moment arms", "0.66 times the assumed, ± 9.4 %", "age") in lines_of(
        Knowledge(age_years=6.0)
    )
    with pytest.raises(InputError, match="at least 80"):
        Knowledge(height_cm=79.0)


def test_without_a_size_arms_and_priors_are_said_to_be_an_adults() -> None:
    assert "child" in whose_geometry(FitSettings())
    assert "child" in whose_geometry(FitSettings(knowledge=Knowledge(mass_kg=20.0)))
    assert whose_geometry(FitSettings(knowledge=Knowledge(age_years=6.0))) == ""


def test_an_arm_by_excursion_is_that_of_the_model_at_neutral(tmp_path) -> None:
    path = said(tmp_path, "[knowledge]\narm_tri_mm = {value = 42.0, sd = 1.5}\nheight_cm = 190\n")
    settings = FitSettings.of(knowledge=path)
    mean, sd = settings.beliefs["arm_scale_tri"]
    assert moment_arm(np.zeros(1), 0)[0] * np.exp(mean) == pytest.approx(0.042)
    assert sd == pytest.approx(np.hypot(1.5, 4.0) / 42.0)
    assert settings.beliefs["arm_scale_tib"] == (pytest.approx(np.log(190.0 / 175.0)), 0.08)
    what, how, stated = lines_of(settings.knowledge)[0]
    assert what == "moment arms"
    assert how == "42 ± 1.5 mm"
    assert "once" in stated
    assert from_plain(FitSettings, settings.as_dict()) == settings
    (name,) = priors_of(Knowledge(arm_tib_mm=StatedArm(38.0, 2.0)))  # the other as of any leg
    assert name == "arm_scale_tib"


def told_twice(tmp_path, tri: float, tib: float) -> FitSettings:
    """Arms of the table, 48.2 and 40.9 mm at neutral, and by the tendon's excursion."""
    (tmp_path / "g.csv").write_bytes(TABLE.read_bytes())
    text = "[knowledge]\ngeometry = 'g.csv'\ngeometry_of = 'person'\n"
    text += f"arm_tri_mm = {{value = {tri}, sd = 1.5}}\narm_tib_mm = {{value = {tib}, sd = 1.5}}\n"
    return FitSettings.of(knowledge=said(tmp_path, text))


def test_arms_that_are_told_twice_alike_make_the_geometry_the_legs_own(tmp_path) -> None:
    tri, tib = read_geometry(TABLE).arms_mm
    settings = told_twice(tmp_path, 1.02 * tri, tib)
    mean, sd = settings.beliefs["arm_scale_tri"]
    assert 0.0 < mean < np.log(1.02)
    assert sd < 0.03
    assert settings.beliefs["path_scale_tri"] == (mean, sd)
    assert settings.beliefs["length_zero_tib"] == (0.0, 0.0025)
    assert settings.is_own
    assert advice("lengths", settings.knowledge) == SOURCES["lengths"].advice
    assert from_plain(FitSettings, settings.as_dict()) == settings  # without the table


def test_arms_that_are_told_twice_otherwise_are_of_nobody(tmp_path) -> None:
    tri, tib = read_geometry(TABLE).arms_mm
    settings = told_twice(tmp_path, 1.16 * tri, 0.86 * tib)
    assert not settings.is_own
    assert settings.beliefs["arm_scale_tri"][1] > 0.08
    assert settings.beliefs["path_scale_tri"][1] == 0.3
    assert "length_zero_tri" not in settings.beliefs
    arms = settings.knowledge.statements["arms"]
    assert arms.agrees is False
    assert arms.texts[1].startswith(f"{1.16 * tri:.3g} ± 1.5 mm and ")


def test_a_zero_of_the_plate_is_off_at_an_ankle_above_its_axis() -> None:
    zero, axis = StatedZero(2.0, 1.0, again=2.4), StatedAxis((4.0, -6.0), 2.0, again=(4.5, -5.0))
    alone = FitSettings.of(knowledge=Knowledge(angle_zero_deg=zero))
    both = FitSettings.of(knowledge=Knowledge(angle_zero_deg=zero, axis_mm=axis))
    ((_, known),) = both.knowledge.statements["angle_zero"].numbers.values()
    up, sd = both.knowledge.statements["axis"].numbers["up"]
    tilt = np.degrees(np.hypot(up, sd) / 1e3 / ANKLE.distance)
    assert alone.zero_sd == known
    assert both.zero_sd == pytest.approx(np.hypot(known, tilt))
    assert both.zero_sd > 2.0 * known
    # to state an axis makes no zero less sure than one that nobody stated
    far = StatedAxis((0.0, 20.0), 5.0)
    assert FitSettings.of(knowledge=Knowledge(angle_zero_deg=zero, axis_mm=far)).zero_sd == 2.5
    once = Knowledge(angle_zero_deg=StatedZero(2.0, 1.5), axis_mm=far)
    assert FitSettings.of(knowledge=once).zero_sd == pytest.approx(np.hypot(1.5, 2.3))


def test_what_is_asked_goes_before_what_is_known() -> None:
    known = Knowledge(
        angle_zero_deg=StatedZero(2.0, 1.0), axis_mm=StatedAxis(5.0, 3.0), plate=Plate()
    )
    asked = {"axis": (0.0, 0.001)}
    settings = FitSettings.of(
        knowledge=known, angle_zero_sd=0.5, nuisances=asked, fixed={"angle_zero": 0.0}
    )
    assert settings.zero_sd == 0.5
    assert settings.fixed["angle_zero"] == 0.0
    assert settings.beliefs["axis"] == (0.0, 0.001)
    assert FitSettings.of(knowledge=known, nuisances="none").beliefs == "none"


def test_what_steps_show_fills_what_was_not_said() -> None:
    said = Knowledge(axis_mm=StatedAxis(5.0, 3.0))
    shown = Knowledge(axis_mm=StatedAxis(0.0, 9.0), plate=Plate(), geometry_of="person")
    both = said.filled(shown)
    assert both == Knowledge(axis_mm=StatedAxis(5.0, 3.0), plate=Plate(), geometry_of="person")


def test_nothing_known_changes_nothing() -> None:
    assert FitSettings().known == frozenset()
    assert FitSettings().beliefs == "all"
    assert priors_of(read_knowledge(TABLE.with_name("session.toml"))) == {}
