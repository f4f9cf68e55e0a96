"""Sessions of a batch on a real scheduler with two workers, one of which is killed."""

import json
from collections import Counter
from pathlib import Path

import pytest

import surae
from clusters import PATIENCE, started_cluster
from surae import FitSettings
from surae.processes.runner import Engine
from surae.studies import virtual_subject, virtual_trial
from surae_thesis.batch.files import find_trials
from surae_thesis.batch.plan import Batch
from surae_thesis.batch.table import BatchStore, run_batch

COLUMNS = "time_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V"


def write_legs(folder: Path, count: int) -> None:
    """Two recordings of each of so many virtual legs."""
    motion = surae.generate(surae.Protocol(profile="sine", duration=20.0, rate_hz=125.0))
    for subject in range(count):
        leg = virtual_subject(seed=subject)
        own = folder / f"S{subject}"
        own.mkdir()
        for repetition in (1, 2):
            t = virtual_trial(leg, motion, seed=repetition)
            rows = zip(t.time, t.angle, t.torque, *t.emg.T, strict=True)
            lines = [COLUMNS, *(",".join(map(repr, map(float, row))) for row in rows)]
            (own / f"sine_{repetition}.csv").write_text("\n".join(lines))


def run_with_a_death(folder: Path, count: int) -> Counter[str]:
    """How often each subject's session is in the store, one worker killed after a few."""
    cohort = folder / "cohort"
    cohort.mkdir()
    write_legs(cohort, count)
    settings = {("1.0", ""): FitSettings.of("muscle", prepared=True, starts=1)}
    read = {"mapping": None, "corrections": json.dumps({})}
    place = folder / "kept"
    place.mkdir()
    batch = Batch(find_trials([cohort]), settings, read, str(place), sessions=True)
    with started_cluster(folder, {}) as (address, workers):

        def killed(done: int, _: int) -> None:
            if done >= 2:
                workers[0].kill()

        with BatchStore(folder / "b.db", write=True) as store:
            run_batch(batch, store, Engine("dask", address=address), killed)
            assert run_batch(batch, store, Engine("dask", address=address)) == 0
            outcomes = list(store.outcomes())
    # both trials of each are fitted; their checks keep them from the joint fit
    for _, outcome in outcomes:
        assert len(list(Path(outcome["file"]).rglob("sine_*.json"))) >= 2
    return Counter(label["subject"] for label, _ in outcomes)


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_loses_no_session(tmp_path, monkeypatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("surae.processes.runner._PATIENCE", PATIENCE)
    assert run_with_a_death(tmp_path, 5) == {f"S{s}": 1 for s in range(5)}
