"""A fit's torque while a stream comes in: as of a file, and in time."""

import multiprocessing
import time

import numpy as np
import pytest

from surae import InputError, fit
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial
from surae_workbench.live.predicting import predict_stream

RATE = 250.0
ROLES = ("angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm")


def send(name: str, rows: np.ndarray, there, go) -> None:
    """Send a trial in real time once somebody listens."""
    from surae_workbench.live.lsl import outlet

    units = ["rad", "Nm", "V", "V", "V", "V"]
    sender = outlet(name, "leg", list(ROLES), units, RATE, name)
    there.set()
    go.wait(60.0)
    begun = time.perf_counter()
    for i, row in enumerate(rows):
        left = begun + i / RATE - time.perf_counter()
        if left > 0.0:
            time.sleep(left)
        sender.push_sample(row.tolist())
    time.sleep(2.0)


@pytest.fixture(scope="module")
def trial():
    protocol = Protocol(profile="multiple-holds", rate_hz=RATE)
    return virtual_trial(virtual_subject(1), generate(protocol), seed=1)


def test_torques_come_in_time_and_are_those_of_the_file(lsl, trial) -> None:
    """The promise is 5 ms at the 99th percentile; on a busy computer the median is held to it."""
    p = fit(trial, "muscle", starts=1).predictor(RATE)
    rows = np.column_stack([trial.angle, trial.torque, trial.emg])[: int(4 * RATE)]
    spawn = multiprocessing.get_context("spawn")
    there, go = spawn.Event(), spawn.Event()
    sender = spawn.Process(target=send, args=("a leg", rows, there, go), daemon=True)
    sender.start()
    assert there.wait(120.0)
    seen = predict_stream(p, "a leg", 7.0, ready=go.set)
    sender.join(30.0)
    first = int(np.argmin(np.abs(rows[:, 1] - seen.measured[0])))
    assert len(seen.torque) == len(rows) - first
    p.reset()
    again = [p.step(row[0], row[2:]) for row in rows[first:]]
    np.testing.assert_allclose(seen.torque, again, rtol=0.0, atol=1e-9)
    assert seen.vaf > 95.0
    assert np.median(seen.latency) < 5e-3
    assert "latency" in repr(seen)


def test_a_stream_that_does_not_fit_is_refused(lsl, trial, monkeypatch) -> None:
    from surae_workbench.live import predicting
    from surae_workbench.live.lsl import outlet

    p = fit(trial, "muscle", starts=1).predictor(RATE)
    monkeypatch.setattr(predicting, "_PATIENCE_S", 3.0)
    with pytest.raises(InputError, match="no stream"):
        predict_stream(p, "nobody", 1.0)
    slow = outlet("slow leg", "leg", list(ROLES), [""] * 6, 100.0, "slow leg")
    with pytest.raises(InputError, match=r"fit\.predictor\(100\)"):
        predict_stream(p, "slow leg", 1.0)
    bare = outlet("bare leg", "leg", ["torque"], ["Nm"], RATE, "bare leg")
    with pytest.raises(InputError, match="no channel angle"):
        predict_stream(p, "bare leg", 1.0)
    del slow, bare
