"""Perturbed and stretched legs obey mechanics, and are scored as written."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ankle_legs import nerve, perturbed, stretched
from ankle_legs.joint import FINE, Intrinsic, Reflex, Servo, move
from ankle_legs.main import main

STIFF = Servo(bandwidth=40, damping=0.8, inertia=1e7)  # a motor that nothing moves
OWN = Intrinsic(inertia=0.02, viscosity=0.9, stiffness=80)


def sine(hertz: float, size: float = 0.01, seconds: float = 4) -> np.ndarray:
    return size * np.sin(2 * np.pi * hertz * np.arange(round(seconds * FINE)) / FINE)


def phasor(signal: np.ndarray, hertz: float) -> complex:
    last = signal[-2 * FINE :]
    return complex(last @ np.exp(-2j * np.pi * hertz * np.arange(last.size) / FINE))


@pytest.mark.parametrize("hertz", [1.0, 8.0, 25.0])
def test_impedance_is_the_transfer_function(hertz: float) -> None:
    own = replace(OWN, branch=50, seconds=0.012)
    angle, _, torque, *_ = move(sine(hertz), STIFF, own)
    s = 2j * np.pi * hertz
    expected = (
        own.inertia * s**2
        + own.viscosity * s
        + own.stiffness
        + own.branch * s * own.seconds / (1 + s * own.seconds)
    )
    assert phasor(torque, hertz) / phasor(angle, hertz) == pytest.approx(expected, rel=2e-3)


def test_slow_movement_meets_the_relaxed_stiffness_and_the_slow_viscosity() -> None:
    own = replace(OWN, branch=60, seconds=0.015, branch_2=20, seconds_2=0.06)
    angle, _, torque, *_ = move(sine(0.5), STIFF, own)
    ratio = phasor(torque, 0.5) / phasor(angle, 0.5)
    assert ratio.real == pytest.approx(80, rel=0.02)
    assert ratio.imag / np.pi == pytest.approx(own.slow_viscosity(), rel=0.05)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_constant_velocity_calls_up_the_gain_times_it_after_the_delay(sign: float) -> None:
    reflex = Reflex(gain=5, delay=0.04, frequency=20, damping=0.8, threshold=0.1, sign=sign)
    times = np.arange(3 * FINE) / FINE
    _, _, _, _, neural = move(sign * 0.5 * np.maximum(times - 0.5, 0), STIFF, OWN, (reflex,))
    assert neural[0, -1] == pytest.approx(sign * 5 * (0.5 - 0.1), rel=1e-3)
    assert not neural[0, : round((0.5 + 0.04) * FINE)].any()
    other = move(-sign * 0.5 * np.maximum(times - 0.5, 0), STIFF, OWN, (reflex,))[4]
    assert not other.any()


def test_the_calf_and_the_tibialis_are_mirror_images() -> None:
    command = perturbed.perturbation(np.random.default_rng(1), "pralds", 4 * FINE, 0.04)
    one = Reflex(gain=4, delay=0.04, frequency=18, damping=0.9)
    servo = Servo(inertia=0.3)
    calf = move(command, servo, OWN, (one,))
    tibialis = move(-command, servo, OWN, (replace(one, sign=-1.0),))
    for here, there in zip(calf, tibialis, strict=True):
        np.testing.assert_allclose(here, -there, atol=1e-12)


def test_a_passive_ankle_gives_back_no_more_than_it_took() -> None:
    command = perturbed.perturbation(np.random.default_rng(2), "prbs", 6 * FINE, 0.04)
    own = replace(OWN, branch=40, hold=20, drag=0.5)
    angle, _, torque, *_ = move(command, Servo(inertia=0.3), own)
    work = np.cumsum(0.5 * (torque[1:] + torque[:-1]) * np.diff(angle))
    assert work.min() > -1e-6
    assert work[-1] > 0.01


def test_a_small_motor_yields_and_a_large_one_follows() -> None:
    command = perturbed.perturbation(np.random.default_rng(3), "prbs", 4 * FINE, 0.04)
    free = move(command, STIFF, Intrinsic(1e-9, 0, 0))[0]
    small, large = (
        np.std(move(command, replace(STIFF, inertia=inertia), OWN)[0] - free) / np.std(free)
        for inertia in (0.05, 50.0)
    )
    assert small > 0.02
    assert large < 1e-4


@pytest.mark.parametrize("family", perturbed.families())
def test_a_perturbed_record_is_what_its_truth_says(family: str) -> None:
    made = perturbed.record(family, 2, seconds=12.0)
    again = perturbed.record(family, 2, seconds=12.0)
    for name, column in made.columns.items():
        assert column.size == 12_000
        assert np.isfinite(column).all()
        assert np.array_equal(column, again.columns[name])
    assert 0.003 < np.std(made.columns["angle_rad"]) < 0.03
    measures = made.truth["measures"]
    assert made.truth["reflex"] == (measures["reflex_share"] > 0)
    asked = 100 * perturbed.ankle(family, 2).share
    assert measures["reflex_share"] == pytest.approx(asked, rel=0.25)
    inertia = measures["inertia"] - measures["foot_inertia"]
    angle, torque = made.empty["angle_rad"], made.empty["torque_Nm"]
    band = slice(60, 360)  # 5 to 30 Hz: an empty device is its inertia
    swing = np.fft.rfft(np.gradient(np.gradient(angle, 1e-3), 1e-3))[band]
    seen = np.fft.rfft(torque - torque.mean())[band]
    sluggish = abs((np.conj(swing) @ seen) / (np.conj(swing) @ swing))
    assert sluggish == pytest.approx(inertia, rel=0.15, abs=1e-3)


def test_a_third_of_the_legs_has_no_reflex() -> None:
    for family in perturbed.families():
        assert sum(not perturbed.ankle(family, seed).reflexes for seed in range(9)) == 3


def test_the_share_leaves_out_what_is_slow() -> None:
    times = np.arange(20_000) / 1000
    slow, fast = 9 * np.sin(2 * np.pi * 0.25 * times), np.sin(2 * np.pi * 3 * times)
    assert perturbed.variance(slow + fast + 5) == pytest.approx(0.5, rel=1e-6)


def quiet_leg() -> stretched.Stretches:
    leg = stretched.leg("sb", 1)
    tissue = replace(leg.tissue, relaxes=0.0)
    return replace(leg, tissue=tissue, noise=0, drift=0, zero=0, cutoff=1000.0, emg="none", files=1)


def test_without_a_nerve_the_torque_is_its_tissue() -> None:
    leg = quiet_leg()
    (made,), truth = stretched.simulate(leg, np.random.default_rng(1))
    angle, torque = made.columns["angle_rad"], made.columns["torque_Nm"]
    for one in truth["stretches"]:
        rest, end = round(one["start_s"] * 1000) - 100, round(one["stop_s"] * 1000) + 1500
        rise = torque[end] - torque[rest]
        weight = np.diff(np.cos(angle[[rest, end]] - leg.tissue.tilt))[0] * leg.tissue.weight
        assert rise - weight == pytest.approx(one["elastic_Nm"], abs=2e-3)
        assert one["neural_Nm"] == 0
        assert one["viscous_Nm"] == pytest.approx(
            leg.tissue.viscosity * np.radians(one["speed_deg_s"]), rel=1e-6
        )


@pytest.mark.slow
def test_onsets_over_velocity_meet_the_threshold_at_rest() -> None:
    leg = stretched.leg("sa", 4)
    leg = replace(leg, answer=replace(leg.answer, spread=0.0), emg="envelope", files=1)
    _, truth = stretched.simulate(leg, np.random.default_rng(1))
    for muscle in stretched.CALF:
        pairs = [
            (one["speed_deg_s"], one["emg_onset_deg"][muscle])
            for one in truth["stretches"]
            if one["emg_onset_deg"][muscle] is not None
        ]
        slope, start = np.polyfit(*np.array(pairs).T, 1)
        assert start == pytest.approx(truth["threshold"][muscle], abs=1.5)
        assert slope < 0


def test_emg_comes_before_its_torque_and_only_with_a_reflex() -> None:
    leg = replace(stretched.leg("sd", 2), emg="envelope", files=1)
    (made,), truth = stretched.simulate(leg, np.random.default_rng(1))
    fast = max(truth["stretches"], key=lambda one: one["speed_deg_s"])
    start, stop = (round(fast[name] * 1000) for name in ("start_s", "stop_s"))
    emg = made.columns["emg_sol_V"]
    assert emg[start : stop + 100].max() > 4 * emg[start - 1000 : start].mean()
    assert fast["neural_Nm"] > 1


FAMILIES = list(stretched.families())


@pytest.mark.parametrize(
    "family",
    [*FAMILIES[:3], *(pytest.param(f, marks=pytest.mark.slow) for f in FAMILIES[3:])],
)
def test_a_stretched_leg_goes_where_its_truth_says(family: str) -> None:
    recordings, truth = stretched.record(family, 3)
    assert {one["recording"] for one in truth["stretches"]} == {f"{r.name}.csv" for r in recordings}
    for made in recordings:
        assert ("emg_sol_V" in made.columns) == (truth["emg"] != "none")
        assert all(np.isfinite(column).all() for column in made.columns.values())
        for one in truth["stretches"]:
            if one["recording"] == f"{made.name}.csv":
                at = round(one["stop_s"] * 1000) + 500
                end = np.degrees(made.columns["angle_rad"][at])
                assert end == pytest.approx(one["to_deg"], abs=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "files"), [("qa", 2), ("sd", 1)])
def test_make_writes_recordings_and_truth(family: str, files: int, tmp_path: Path) -> None:
    assert main(["make", family, "3", "--output", str(tmp_path)]) == 0
    truth = json.loads((tmp_path / "truth" / f"{family}-3.json").read_text())
    assert truth["seed"] == 3
    paths = list((tmp_path / f"{family}-3").glob("*.csv"))
    assert len(paths) >= files
    for path in paths:
        first = path.read_text().partition("\n")[0]
        assert first in ("time_s,angle_rad,torque_Nm", f"# emg: {truth.get('emg')}")


def said(path: Path, answer: dict[str, object]) -> None:
    path.write_text(json.dumps(answer))


def test_perturbed_answers_are_counted_by_hand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seeds = [seed for seed in range(1, 4) if perturbed.ankle("qa", seed).share > 0.04]
    null = next(seed for seed in range(1, 4) if not perturbed.ankle("qa", seed).share)
    true = nerve.truth("qa", seeds[0])
    k, way = true["measures"]["intrinsic_stiffness"], true["direction"]
    right = {"value": 1.1 * k, "ci95": [0.9 * k, 1.2 * k], "verdict": "identified"}
    delay = {"value": true["measures"]["reflex_delay"] + 2, "ci95": [0, 1], "verdict": "weak"}
    said(
        tmp_path / f"qa-{seeds[0]}.json",
        {
            "reflex": {"verdict": "present", "direction": way},
            "measures": {"intrinsic_stiffness": right, "reflex_delay": delay, "other": {}},
        },
    )
    said(
        tmp_path / f"qa-{null}.json",
        {
            "reflex": {"verdict": "present", "direction": None},
            "measures": {"reflex_share": {"value": 1.0, "ci95": [0.5, 1.5], "verdict": "weak"}},
        },
    )
    assert main(["score", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split()[:8] == ["intrinsic_stiffness", "1", "10.0", "%", "10.0", "%", "1", "of"]
    assert lines[1].split()[-3:] == ["1", "of", "1"]
    assert "2.0 ms" in lines[5]
    assert "0 of 1" in lines[5]
    assert "2 to 100 % of the variance: 1, present 1, cannot tell 0, wrong way 0" in lines[11]
    assert (
        "no reflex: 1, present 1, cannot tell 0, upper bound of the share below 2 %: 1" in lines[12]
    )
    assert f"a reflex of qa-{null}, which has none" in lines[-1]


def test_stretched_answers_are_counted_by_hand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    true = nerve.truth("sd", 2)
    muscle = {"angle_deg": true["threshold"]["gm"] + 2, "ci95": [90, 91], "verdict": "identified"}
    stretches = [{**one, "neural_Nm": 1.1 * one["neural_Nm"]} for one in true["stretches"]]
    stretches[0]["neural_Nm"] *= 2
    stretches.append({**stretches[0], "start_s": 1e3})
    said(tmp_path / "sd-2.json", {"stretches": stretches, "threshold": {"gm": muscle}})
    assert main(["score", str(tmp_path)]) == 0
    words, n = capsys.readouterr().out, len(true["stretches"])
    assert f"EMG: {n} of {n} stretches found, 1 too many" in words
    assert f"neural torque of {n}: within 15 % {n - 1}, interval holds 0 of 0" in words
    assert "threshold of 3: told 1, within 3° 1, interval holds 0, one of both 1" in words


def test_a_folder_of_nothing_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["score", str(tmp_path)]) == 2
    assert "FAMILY-SEED.json" in capsys.readouterr().err
