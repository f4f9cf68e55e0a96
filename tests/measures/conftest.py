"""Legs and fits that the tests of measures share."""

import numpy as np
import pytest

import surae
from richer_legs import richer_leg
from surae.recording import MUSCLES


@pytest.fixture(scope="session")
def fitted(tmp_path_factory):
    """Makes the fit of a leg that is richer than every model, through a file; with its truth."""
    folder, done = tmp_path_factory.mktemp("legs"), {}

    def make(seed: int, trial: int = 0, rate_hz: float = 64.0, duration: float = 35.0):
        key = seed, trial, rate_hz, duration
        if key not in done:
            leg = richer_leg(seed, trial=trial, rate_hz=rate_hz, duration=duration)
            one = leg.inputs
            columns = {"time_s": one.time, "angle_rad": one.angle, "torque_Nm": one.torque}
            columns |= {f"emg_{m}_V": np.maximum(one.emg[:, i], 0) for i, m in enumerate(MUSCLES)}
            path = folder / f"{seed}-{trial}.csv"
            surae.write_csv(path, columns, ["emg: envelope"])
            done[key] = surae.fit(path, quality=()), {**leg.parameters, "emd": leg.delay}
        return done[key]

    return make
