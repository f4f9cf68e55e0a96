"""Whatever a file holds, reading it gives a recording or one line of explanation."""

import random

import numpy as np
import pytest

from surae.errors import SuraeError
from surae.recording import Recording, read

CSV = b"# emg: raw\n# name: x\ntime_s,angle_rad,torque_Nm,emg_ta_V,note\n" + b"".join(
    b"%d.5,0.%d,%d,%de-6,%d\n" % (i, i, i, i, i) for i in range(5)
)
STO = (
    b"ID\nversion=1\nnRows=3\ninDegrees=yes\nendheader\ntime\tankle_angle_r\tankle_moment\n"
    b"0.0\t1\t2\n0.1\t-3\t4e1\n0.2\t5\t-6\n"
)
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
PIECES = (
    *(b"", b",", b";", b"\t", b"\n", b"\r", b'"', b"#", b"=", b"[", b"]", b"{", b".", b"-", b"_"),
    *(b"nan", b"inf", b"1e999", b"\0", b"\xff", b"\xc2\xb5", b"\xef\xbb\xbf", b"endheader\n"),
    *(b"time", b"angle_", b"channels.", b"9" * 400, b"0x", b"'''", b"\\u0000", b"\xe2\x80\xa8"),
)


def mutated(data: bytes, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 1, 2, 5))):
        start = rng.randrange(len(data) + 1)
        stop = min(len(data), start + rng.choice((0, 1, 1, 3, 20)))
        match rng.randrange(4):
            case 0:
                data = data[:start] + rng.choice(PIECES) + data[stop:]
            case 1:
                data = data[:start] + data[stop:]
            case 2:
                data = data[:start] + data[start:stop] * 2 + data[stop:]
            case _:
                data = data[:start] + bytes([rng.randrange(256)]) + data[start + 1 :]
    return data


@pytest.mark.parametrize(("name", "seed"), [("data.csv", 1), ("data.sto", 2), ("data.toml", 3)])
def test_only_our_errors_come_out(tmp_path, name, seed):
    rng = random.Random(seed)
    files = {"data.csv": CSV, "data.sto": STO, "data.toml": TOML}
    for other, data in files.items():
        (tmp_path / other).write_bytes(data)
    path = tmp_path / name
    opened = path if name != "data.sto" else tmp_path / "data.toml"
    assert isinstance(read(opened), Recording)
    outcomes = {"read": 0, "refused": 0}
    for _ in range(400):
        path.write_bytes(mutated(files[name], rng))
        try:
            recording = read(opened)
        except SuraeError as error:
            outcomes["refused"] += 1
            text = str(error)
            assert text.isprintable(), repr(text)
            assert len(text) < 1000
        else:
            outcomes["read"] += 1
            for channel in recording.channels.values():
                assert np.isfinite(channel.values).all()
                assert (np.diff(channel.time) > 0).all()
    assert min(outcomes.values()) > 20
