"""A laboratory measures the leg that it has, knows about as much as it says, and may be wrong."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ankle_legs import laboratory
from ankle_legs.laboratory import Axis, Device
from ankle_legs.main import main
from ankle_legs.make import leg


def test_a_session_is_written_as_it_says(tmp_path: Path) -> None:
    assert main(["laboratory", "p", "2", "--output", str(tmp_path), "--active", "1"]) == 0
    folder = tmp_path / "p-2"
    told = tomllib.loads((folder / "session.toml").read_text())
    names = {path.name for path in folder.glob("*.csv")}
    assert set(told["trials"]) == names
    assert told["knowledge"]["plate"] in names
    assert (folder / told["knowledge"]["geometry"]).exists()
    truth = json.loads((tmp_path / "truth" / "p-2.json").read_text())
    assert truth["minutes"] <= 10
    assert abs(truth["zero_deg"]) < 4
    assert truth["measures"]["end_torque"] > 0


def test_steps_that_are_left_out_are_not_known(tmp_path: Path) -> None:
    made = laboratory.measure("p", 2, ("slow",))
    assert set(made.files) == {"slow"}
    assert tomllib.loads(laboratory.session_toml(made))["knowledge"] == {}
    assert made.minutes < laboratory.measure("p", 2, ("slow", "geometry")).minutes
    with pytest.raises(ValueError, match="no step 'nap'"):
        laboratory.measure("p", 2, ("nap",))
    with pytest.raises(ValueError, match="no step has the leg"):
        laboratory.measure("p", 2, ("tare",))
    assert main(["laboratory", "p", "2", "--output", str(tmp_path), "--wrong", "all"]) == 2


def test_the_empty_device_shows_what_the_leg_carries_too() -> None:
    made = laboratory.measure("p", 3, ("tare", "slow"))
    empty, step = made.files["empty"], 1 / 128
    shown = made.device.torque(empty["angle_rad"], step)
    zero = made.leg.mounting(0).zero
    assert np.std(empty["torque_Nm"] - zero - shown) < 0.15
    wrong = laboratory.measure("p", 3, ("tare", "slow"), wrong="tare").files["empty"]
    assert np.std(wrong["torque_Nm"] - zero - shown) > 0.3


def test_an_axis_beside_the_device_does_no_work_of_its_own() -> None:
    one = leg("p", 2)
    off = replace(one, departures=(Axis(0.012, -0.008),))
    run, plain = off.record(1, 20.0, "passive"), one.record(1, 20.0, "passive")
    turned = np.gradient(run.ankle) / np.where(
        np.gradient(run.plate) == 0, np.nan, np.gradient(run.plate)
    )
    at = np.abs(np.gradient(run.plate, run.step)) > 0.05
    along = 1 + (0.012 * np.cos(run.plate) - 0.008 * np.sin(run.plate)) / laboratory.STRAP
    np.testing.assert_allclose(turned[at], along[at], rtol=1e-4)
    assert np.ptp(run.ankle - run.plate) > 1e-3
    assert 0.01 < np.std(run.torque - plain.torque) < 3
    with_none = replace(one, departures=(Axis(0.0, 0.0),)).record(1, 20.0, "passive")
    np.testing.assert_array_equal(with_none.torque, plain.torque)


def test_tables_are_as_near_as_is_said_and_another_legs_is_not() -> None:
    angle = np.radians([-30.0, 0.0, 20.0])
    own = leg("a", 1).subject.geometry
    misses = [
        laboratory.measured_geometry(np.random.default_rng(seed), own).arm(angle) / own.arm(angle)
        - 1
        for seed in range(200)
    ]
    assert 0.02 < np.sqrt(np.mean(np.square(misses))) < 0.04
    made = laboratory.measure("a", 1, ("geometry", "slow"), wrong="geometry")
    true = made.leg.lasting(made.leg.subject).geometry.arm(angle)
    assert np.abs(made.table.arm(angle) / true - 1).min() > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [None, "geometry", "zero", "axis"])
def test_second_statements_are_of_the_leg_whatever_is_wrong_with_the_first(wrong) -> None:
    steps, far = ("zero", "axis", "geometry", "excursion", "again", "slow"), []
    for seed in range(4):
        made = laboratory.measure("a", seed, steps, wrong=wrong)
        own = 1000 * made.leg.lasting(made.leg.subject).geometry.arm(np.zeros(1))[:, 0]
        far += list((np.array(made.arms) - own) / laboratory.ARM_SD)
        far.append((made.zero_again + made.truth["zero_deg"]) / laboratory.ZERO_SD)
        far += list(np.subtract(made.axis_again, made.truth["axis_mm"]) / laboratory.AXIS_SD)
    assert np.sqrt(np.mean(np.square(far))) < 1.5
    told = tomllib.loads(laboratory.session_toml(made))["knowledge"]
    assert told["angle_zero_deg"]["again"] == pytest.approx(made.zero_again, abs=0.05)
    assert told["arm_tib_mm"]["value"] == pytest.approx(made.arms[1], abs=0.05)
    once = laboratory.session_toml(laboratory.measure("a", 0, ("zero", "axis", "slow")))
    assert "again" not in once


@pytest.mark.slow
@pytest.mark.parametrize("wrong", laboratory.WRONG)
def test_what_is_wrong_is_wrong_and_the_rest_is_not(wrong: str) -> None:
    steps = ("tare", "geometry", "alone", "slow")
    right, off = (laboratory.measure("p", 4, steps, wrong=w) for w in (None, wrong))
    changed = {
        name
        for name in right.files
        if not np.allclose(right.files[name]["torque_Nm"], off.files[name]["torque_Nm"], atol=0.2)
        or not np.allclose(right.files[name]["emg_sol_V"], off.files[name]["emg_sol_V"], atol=1e-6)
    }
    expected = {
        "tare": {"empty"},
        "alone": {"alone"},
        "passive": {"slow"},
        "geometry": set(),
        "zero": {"slow", "alone"},
        "axis": {"slow", "alone"},
    }[wrong]
    assert changed <= expected
    assert changed or wrong == "geometry"
    assert laboratory.session_toml(right) == laboratory.session_toml(off)


def test_the_device_is_felt_as_inertia_weight_drag_and_friction() -> None:
    device = Device(inertia=0.03, weight=4.0, angle=0.3, drag=0.1, friction=0.2)
    times = np.arange(4000) / 1000
    steady = device.torque(0.5 * times, 1e-3)
    expected = 4 * np.cos(0.5 * times - 0.3) + 0.1 * 0.5 + 0.2
    np.testing.assert_allclose(steady[5:-5], expected[5:-5], atol=1e-6)
