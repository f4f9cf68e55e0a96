"""Designs keep every limit, tell more than what they began with, and say what cannot be done."""

import csv
import inspect

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.requests import DesignSettings
from surae.planning.genes import REST, SHORTEST, Genes, effort_budget
from surae.planning.legs import population_legs
from surae.planning.plan import limits_of
from surae.planning.torque import load_of, torques, within_torque
from surae.protocol import (
    DEVICES,
    TASKS,
    Device,
    Given,
    Trajectory,
    read_device,
    read_protocol,
    write_protocol_target,
)
from surae.protocol.effort import effort
from surae.settings import FitSettings

QUICK = {"evaluations": 20, "rate_hz": 64.0, "model": "muscle"}


def random_design(seed):
    """Genes of anything, for a device of anything: device, range, plan and its trajectory."""
    rng = np.random.default_rng(seed)
    low, high = -rng.uniform(0.2, 0.9), rng.uniform(0.1, 0.6)
    device = Device(
        "any",
        max_velocity=float(np.exp(rng.uniform(np.log(0.2), np.log(6.0)))),
        max_acceleration=float(np.exp(rng.uniform(np.log(3.0), np.log(300.0)))),
        max_torque=float(rng.uniform(40.0, 150.0)),
        bandwidth=float(rng.uniform(1.5, 12.0)),
    )
    seconds = float(rng.uniform(12.0, 70.0))
    limits = limits_of(device, (low, high))
    genes = Genes("random", seconds, limits, min(device.bandwidth, 6.0), bool(seed % 4))
    plan = genes.plan(genes.start() + rng.uniform(0.1, 4.0) * rng.standard_normal(genes.size))
    return device, (low, high), limits, plan, seconds, rng


def check_limits(seed, legs):
    device, (low, high), limits, plan, seconds, rng = random_design(seed)
    try:
        plan, limits, _ = within_torque(plan, limits, legs, device)
    except InputError as refusal:
        assert "give up" in str(refusal)  # noqa: PT017
        return False
    trial = plan.trajectory(limits, float(rng.uniform(50.0, 1000.0)), device=device)
    assert low <= trial.angle.min()
    assert trial.angle.max() <= high
    assert np.abs(trial.velocity).max() <= device.max_velocity
    assert np.abs(trial.acceleration).max() <= device.acceleration_limit
    assert np.abs(torques(plan, limits, legs)).max() <= device.max_torque
    ends = (trial.time < REST - 1e-9) | (trial.time > seconds - REST + 0.01)
    assert not trial.velocity[ends].any()
    assert not trial.effort[ends].any()
    assert trial.effort.min() >= 0.0
    assert trial.effort.max() <= 1.0
    assert not np.any((trial.effort[:, 0] > 0) & (trial.effort[:, 1:].max(axis=1) > 0))
    assert all(burst.length >= SHORTEST - 1e-12 for burst in plan.bursts)
    spent = trial.effort.mean(axis=0) * seconds
    allowed = effort_budget(seconds)
    assert spent[0] <= 1.03 * allowed[1]
    assert spent[1:].mean() <= 1.03 * allowed[0]
    # the derivatives are those of the angle
    if trial.settings.rate_hz > 400.0:
        slope = np.gradient(trial.angle, trial.time)[2:-2]
        assert np.abs(slope - trial.velocity[2:-2]).max() < 0.05 * device.max_velocity + 1e-3
    return True


@pytest.fixture(scope="module")
def legs():
    return population_legs("muscle", None, 3)


@pytest.mark.parametrize("seed", range(3))
def test_limits_hold_at_every_sample(seed, legs) -> None:
    check_limits(seed, legs)


@pytest.mark.slow
def test_limits_hold_at_every_sample_of_two_hundred_designs(legs) -> None:
    assert sum(check_limits(seed, legs) for seed in range(1000, 1200)) > 120


def test_the_budget_is_that_of_the_thesis_task() -> None:
    time = np.arange(35 * 256 + 1) / 256.0
    spent = effort(time, TASKS["part-passive"]).mean(axis=0) * 35.0
    assert effort_budget(35.0) == pytest.approx((spent[1:].mean(), spent[0]), rel=0.01)


@pytest.fixture(scope="module")
def designed():
    return surae.design(20.0, model="muscle", seed=3, evaluations=200, rate_hz=64.0, aim="mean")


def test_a_design_tells_more_than_its_beginning(designed) -> None:
    assert designed.curve[-1][2] < designed.curve[0][2] - 0.02
    assert not designed.stopped
    # the legs it is judged by are those of an expectation, which the search did not see
    told = surae.expect(designed.trajectory, "muscle", legs=40)
    assert told.worst == pytest.approx(designed.expectation.worst)


def test_what_plans_what_expects_and_what_fits_have_one_default() -> None:
    expected = inspect.signature(surae.expect).parameters["model"].default
    assert DesignSettings(duration=20.0).model == expected == FitSettings().model == "auto"


def test_a_design_is_the_same_again() -> None:
    first, again = (surae.design(12.0, seed=3, **QUICK) for _ in range(2))
    assert again.plan == first.plan
    assert np.array_equal(again.trajectory.angle, first.trajectory.angle)


def test_a_design_is_written_and_read(designed, tmp_path) -> None:
    designed.write(tmp_path / "p.csv")
    read = read_protocol(tmp_path / "p.csv")
    np.testing.assert_allclose(read.angle, designed.trajectory.angle, atol=1e-10)
    np.testing.assert_allclose(read.effort, designed.trajectory.effort, atol=1e-10)
    designed.write(tmp_path / "p.mat")
    assert (tmp_path / "p.mat").read_bytes().startswith(b"MATLAB 5.0")
    write_protocol_target(designed.trajectory, tmp_path / "t.csv")
    with (tmp_path / "t.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["time_s", "plantarflexion", "dorsiflexion"]
    assert len(rows) == len(read.time) + 1


def test_nothing_is_written_without_limits_or_a_reason(tmp_path) -> None:
    bare = surae.design(10.0, device=None, **{**QUICK, "evaluations": 2})
    with pytest.raises(InputError, match="no device"):
        bare.write(tmp_path / "p.csv")
    with pytest.raises(InputError, match="no device"):
        bare.write(tmp_path / "p.csv", without_limits="  ")
    assert list(tmp_path.iterdir()) == []
    bare.write(tmp_path / "p.csv", without_limits="simulation only")
    assert (tmp_path / "p.csv").read_text().startswith("# without limits: simulation only\n")
    read_protocol(tmp_path / "p.csv")


@pytest.mark.slow
def test_what_a_device_cannot_do_is_said_with_what_to_give_up() -> None:
    weak = Device("weak", max_velocity=1.0, max_torque=8.0)
    with pytest.raises(InputError, match=r"weak has 8 Nm.*even relaxed; give up.*--range"):
        surae.design(20.0, device=weak, **QUICK)
    with pytest.raises(InputError, match="choose a stronger device"):
        surae.design(20.0, device=Device("toy", max_torque=1.0), **QUICK)
    short = Device("short", max_velocity=1.0, angle_range=(-0.5, 0.3))
    with pytest.raises(InputError, match=r"short reaches -0.5 … 0.3 rad.*--range -0.5:0.3"):
        surae.design(20.0, device=short, angle_range=(-0.9, 0.6), **QUICK)
    slow = Device("slow", max_velocity=0.01)
    made = surae.design(20.0, device=slow, **QUICK)
    assert any("% of the range is used" in note for note in made.notes)


@pytest.mark.slow
def test_a_search_goes_on_from_a_ready_protocol() -> None:
    made = surae.design(35.0, **{**QUICK, "evaluations": 45})
    fresh = surae.design(31.0, **{**QUICK, "evaluations": 1})  # no ready one is so short
    assert made.expectation.worst < 0.8 * fresh.expectation.worst
    # a longer trial repeats what is good in a shorter one
    longer = surae.design(50.0, **{**QUICK, "evaluations": 1})
    assert longer.expectation.geometric_mean < made.expectation.geometric_mean


def test_effort_is_lowered_to_the_torque_of_the_device() -> None:
    mild = Device("mild", max_velocity=1.5, max_torque=30.0)
    made = surae.design(20.0, device=mild, angle_range=(-0.7, 0.2), **QUICK)
    assert max(map(abs, made.expectation.torque)) <= 30.0
    assert made.expectation.load == load_of(made.trajectory)  # one number, whoever asks
    assert any("Efforts are lowered" in note for note in made.notes)


@pytest.mark.slow
def test_a_design_without_effort_asks_for_none() -> None:
    made = surae.design(
        12.0, effort="none", aim="passive_stiffness@10deg", evaluations=1, rate_hz=20.0
    )
    assert not made.trajectory.effort.any()
    assert set(made.aimed) == {"passive_stiffness@10deg"}
    assert made.expectation.parameters["g1"].verdict == "undetermined"


def test_a_range_nobody_gave_is_the_device_s_and_patients_are_asked_for_it() -> None:
    short = Device("short", max_velocity=1.0, angle_range=(-0.5, 0.8))
    made = surae.design(15.0, device=short, **{**QUICK, "evaluations": 1})
    assert made.trajectory.settings.angle_range == pytest.approx((-0.5, 0.6))
    with pytest.raises(InputError, match="a patient's range"):
        surae.design(15.0, population="patient", **QUICK)


def test_patients_have_a_range_of_their_own() -> None:
    made = surae.design(20.0, angle_range=(-0.5, 0.1), population="patient", **QUICK)
    assert made.trajectory.angle.min() >= -0.5
    assert made.trajectory.angle.max() <= 0.1


@pytest.mark.parametrize(
    "change",
    [
        {"duration": 1.0},
        {"duration": 5000.0},
        {"angle_range": (0.5, 0.4)},
        {"angle_range": (-0.02, 0.02)},
        {"effort": "much"},
        {"aim": "nothing"},
        {"aim": "passive_stiffness@xdeg"},
        {"device": "other"},
        {"device": "missing.toml"},
        {"rate_hz": 1.0},
        {"evaluations": 0},
    ],
)
def test_impossible_wishes_are_refused(change) -> None:
    with pytest.raises(InputError):
        surae.design(**{"duration": 20.0, **QUICK, **change})


def test_devices_are_data(tmp_path) -> None:
    assert DEVICES["achilles"].max_velocity == 1.5
    assert DEVICES["achilles"].sources
    (tmp_path / "d.toml").write_text(
        'name = "mine"\nmax_velocity_rad_s = 2\nmax_torque_Nm = 50.0\nrange_rad = [-0.7, 0.4]\n'
    )
    mine = read_device(tmp_path / "d.toml")
    assert (mine.name, mine.max_velocity, mine.max_torque) == ("mine", 2.0, 50.0)
    assert mine.angle_range == (-0.7, 0.4)
    made = surae.design(15.0, device=tmp_path / "d.toml", angle_range=(-0.7, 0.4), **QUICK)
    assert made.device == mine


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("max_velocity_rad_s = 1", "give the device a name"),
        ('name = "a"\nspeed = 1', "'speed' is not known"),
        ('name = "a"\nmax_torque_Nm = "big"', "max_torque_Nm: 'big' is not a finite number"),
        ('name = "a"\nmax_torque_Nm = -1', "use more than 0"),
        ('name = "a"\nrange_rad = [1]', "range_rad"),
        ('name = "a"\nrange_rad = [1, 0]', "low must be below"),
        ("name = ", "not valid TOML"),
    ],
)
def test_a_device_that_is_none_is_refused(tmp_path, text, complaint) -> None:
    (tmp_path / "d.toml").write_text(text)
    with pytest.raises(InputError, match=complaint):
        read_device(tmp_path / "d.toml")


def test_a_trajectory_of_no_device_is_not_exported_either(tmp_path) -> None:
    from surae.protocol import write_protocol

    still = np.zeros(20)
    settings = Given(profile="x", task="passive", angle_range=(-0.1, 0.1), rate_hz=10.0)
    trial = Trajectory(settings, np.arange(20) / 10.0, still, still, still, np.zeros((20, 4)))
    with pytest.raises(InputError, match="no device"):
        write_protocol(trial, tmp_path / "p.csv")


@pytest.mark.parametrize("rate_hz", [1e-320, 0.001, 0.0, -1.0, float("nan")])
def test_a_rate_that_samples_nothing_is_refused(rate_hz):
    _, _, limits, plan, *_ = random_design(1)
    with pytest.raises(InputError, match="three samples or more"):
        plan.trajectory(limits, rate_hz)
