"""The muscle and its tendon against solutions that somebody else computed."""

import json
from pathlib import Path

import numpy as np
import pytest

from ankle_legs.muscle import Muscle, integrate, relaxed_force
from ankle_legs.subject import GRAVITY, LEVER, Geometry

REFERENCE = Path(__file__).parents[2] / "tests" / "data" / "reference"
SUBSTEPS = 16


def solve(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return our torque and theirs."""
    case = json.loads((REFERENCE / f"{name}.json").read_text())
    p, data = (
        case["parameters"],
        np.genfromtxt(REFERENCE / f"{name}.csv", delimiter=",", names=True),
    )
    n, step = data.size, float(data["time_s"][1])
    fine = np.arange((n - 1) * SUBSTEPS + 1) / SUBSTEPS
    angle = np.interp(fine, np.arange(n), data["angle_rad"])
    triceps = sum(p[g] * data[f"emg_{m}_V"] for g, m in (("g2", "gl"), ("g3", "sol"), ("g4", "gm")))
    slack = case["options"].get("tendon_strain") == "slack-length"
    arms, paths = Geometry().arm(angle), Geometry().path(angle)
    torque = np.zeros(n)
    for i, (group, emg, f_max, lt0, sign) in enumerate(
        (("tri", triceps, 8000, 0.415, 1), ("tib", p["g1"] * data["emg_ta_V"], 1400, 0.216, -1))
    ):
        stretch = p.get(f"dlt_{group}", 0.0) * (lt0 if slack else 1)
        muscle = Muscle(
            *(p[f"k_{group}"], p[f"x0_{group}"], p["tau_rel"], p["k_rel"], p[f"l0_{group}"]),
            *(p["f0"], p["beta"], stretch, f_max, p.get(f"pt_{group}", 0.3)),
        )
        drive, one = np.interp(fine, np.arange(n), emg), np.ones(fine.size)
        _, force, _ = integrate(step / SUBSTEPS, paths[i], drive, one, 0 * one, muscle.constants())
        torque += sign * (force * arms[i])[::SUBSTEPS]
    angle = data["angle_rad"]
    torque += p["m"] * LEVER**2 * np.gradient(np.gradient(angle, step), step)
    return torque + p["m"] * GRAVITY * LEVER * np.cos(angle), data["torque_Nm"]


@pytest.mark.parametrize(
    "name", ["muscle_healthy", "muscle_patient", "tendon_thesis", "tendon_slack_length"]
)
def test_torque_agrees_with_the_reference_solution(name: str) -> None:
    ours, theirs = solve(name)
    # The references' README: 0.5 % of the RMS is what interpolation between samples leaves open.
    assert np.sqrt(np.mean((ours - theirs) ** 2)) < 0.005 * np.sqrt(np.mean(theirs**2))


def muscle(**changed: float) -> Muscle:
    own = {"k": 200, "x0": 0.016, "tau_rel": 2, "k_rel": 0.4, "l0": 0.045, "f0": 2, "beta": 1}
    return Muscle(**{**own, "dlt": 0.02, **changed})


def step(m: Muscle, path: np.ndarray, drive: float) -> tuple[np.ndarray, np.ndarray]:
    one = np.ones(path.size)
    length, force, _ = integrate(1e-3, path, drive * one, one, 0 * one, m.constants())
    return length, force


def test_a_still_passive_muscle_keeps_its_relaxed_force() -> None:
    path = np.full(3000, 0.045)
    _, force = step(muscle(), path, 0.0)
    assert force == pytest.approx(relaxed_force(muscle(), 0.045)[0], rel=1e-9)


def test_a_hold_ends_in_the_static_balance() -> None:
    """Half the optimal length's force is where exp(-(x - l0)²/w) says."""
    length, force = step(muscle(k=1.0, x0=1.0), np.full(9000, 0.045), 800.0)
    width = 0.1 * 0.045**2
    active = 800 * np.exp(-((length[-1] - 0.045) ** 2) / width)
    assert force[-1] == pytest.approx(active + np.exp(length[-1] - 1) / 1.4, rel=1e-6)


def test_short_range_stiffness_adds_until_it_yields() -> None:
    path = 0.042 + 0.002 * np.clip(np.arange(6000) / 1000 - 3, 0, 1)
    plain, stiff = (step(muscle(dlt=0.0, srs=s), path, 500.0)[1] for s in (0.0, 23.0))
    assert stiff[:3000] == pytest.approx(plain[:3000])
    fl = np.exp(-((path[4000] - 0.045) ** 2) / (0.1 * 0.045**2))
    assert stiff[4000] - plain[4000] == pytest.approx(500 * fl * 23 * 0.01, rel=0.05)
