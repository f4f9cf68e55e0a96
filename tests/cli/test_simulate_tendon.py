import json

import numpy as np
import pytest

import surae

from .conftest import refused
from .test_simulate import PARTS, columns, simulate

STATES = (
    "muscle_length",
    "muscle_velocity",
    "tendon_length",
    "tendon_elongation",
    "tendon_velocity",
    "tendon_force",
    "tissue_force",
    "active_force",
)


@pytest.fixture
def truth(files):
    return json.loads((files / "true.json").read_text(encoding="utf-8"))["parameters"]


def test_muscle_tendon_models_add_muscles_and_tendons(run, files, truth) -> None:
    done = simulate(run, "--parameters", "true.json", "--model", "muscle-tendon")
    assert done == (0, "simulated: out.csv\n", "")
    table = columns(files / "out.csv")
    state = surae.simulate_tendon("muscle-tendon", truth, surae.read(files / "trial.csv"))
    assert [*table][-16:] == [*state.columns()]
    assert {name.rsplit("_tri_")[0] for name in table if "_tri_" in name} >= set(STATES)
    for name, values in state.columns().items():
        np.testing.assert_array_equal(table[name], values)
    np.testing.assert_allclose(
        sum(table[name] for name in PARTS), table["torque_Nm"], rtol=0, atol=1e-12
    )


def test_the_output_reads_back_and_simulates_the_same(run, files) -> None:
    given = ("--parameters", "true.json", "--model", "muscle-tendon")
    assert simulate(run, *given).code == 0
    recording = surae.read(files / "out.csv")
    assert {*recording.channels} == {
        "angle",
        "torque",
        "emg_ta",
        "emg_gl",
        "emg_sol",
        "emg_gm",
    }
    done = run("simulate", "out.csv", "--output", "again.csv", *given)
    assert done.code == 0
    first, again = columns(files / "out.csv"), columns(files / "again.csv")
    assert [*first] == [*again]
    for name, values in first.items():
        np.testing.assert_array_equal(again[name], values)


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
def test_an_overflow_names_its_first_sample(run, files, truth, model) -> None:
    (files / "p.json").write_text(json.dumps({"parameters": truth | {"m": 1e308}}))
    done = simulate(run, "--parameters", "p.json", "--model", model)
    recording = surae.read(files / "trial.csv")
    parts = surae.simulate_parts(model, truth | {"m": 1.0}, recording)
    both = np.abs([parts.inertial, parts.inertial + parts.gravitational]).max(axis=0)
    first = int(np.flatnonzero(both > np.finfo(float).max / 1e308)[0])
    at = f"first at sample {first + 1} ({recording.channels['angle'].time[first]:g} s)"
    refused(done, "p.json", "trial.csv", "overflows", at, "check their units", code=1)
    assert not (files / "out.csv").exists()
