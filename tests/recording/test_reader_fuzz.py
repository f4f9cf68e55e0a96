"""Whatever a file holds, reading it gives a recording or one line of explanation."""

import random
import time

import numpy as np
import pytest
from reader_seeds import SEEDS, TEXT, csv_file, exercise, mutated, said, sto_file

from surae.base.errors import InputError
from surae.recording import Recording, read

TOML = b"""name = "x"
emg = "envelope"
fixed = { m = 0.0 }
[channels.angle]
file = "data.sto"
column = "ankle_angle_r"
unit = "deg"
sign = -1
[channels.torque]
file = "data.sto"
column = "ankle_moment"
unit = "Nm"
scale = 2.0
"""


@pytest.mark.parametrize(("name", "seed"), [("data.csv", 1), ("data.sto", 2), ("data.toml", 3)])
def test_only_our_errors_come_out(tmp_path, name, seed):
    rng = random.Random(seed)
    files = {"data.csv": csv_file(), "data.sto": sto_file(), "data.toml": TOML}
    for other, data in files.items():
        (tmp_path / other).write_bytes(data)
    path = tmp_path / name
    opened = path if name != "data.sto" else tmp_path / "data.toml"
    assert isinstance(read(opened), Recording)
    outcomes = {"read": 0, "refused": 0}
    for _ in range(200):
        path.write_bytes(mutated(files[name], rng, text=True))
        try:
            recording = read(opened)
        except InputError as error:
            outcomes["refused"] += 1
            said(error)
        else:
            outcomes["read"] += 1
            for channel in recording.channels.values():
                assert np.isfinite(channel.values).all()
                assert (np.diff(channel.time) > 0).all()
    assert min(outcomes.values()) > 10


#: Damage of these headers can keep their library busy for seconds.
LONG = {"acqknowledge"}


#: What reading one damaged file may take [s], a child's limit and its start included.
SECONDS = 30.0
MANY = [pytest.param(r, 400, marks=pytest.mark.slow) for r in SEEDS]
FEW = [pytest.param(r, 20, marks=[pytest.mark.slow] if r in LONG else []) for r in SEEDS]


@pytest.mark.parametrize(("reader", "files"), [*FEW, *MANY])
def test_every_reader_reads_or_refuses(tmp_path, reader, files):
    """Benchmarks/fuzz_readers.py does the same with 10,000 files each and limits on memory."""
    rng = random.Random(4)
    originals = [make() for make in SEEDS[reader]]
    path = tmp_path / "file"
    for original in originals:
        path.write_bytes(original)
        assert exercise(path) == "read"
    outcomes = {"read": 0, "refused": 0}
    for number in range(files):
        path.write_bytes(mutated(rng.choice(originals), rng, text=reader in TEXT))
        began = time.monotonic()
        outcomes[exercise(path)] += 1
        assert time.monotonic() - began < SECONDS, number
    assert min(outcomes.values()) > 2, outcomes
