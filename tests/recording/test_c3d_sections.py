"""C3D files whose parameters lie or are written as few programs do it, and ezc3d reads them."""

import struct
import time

import numpy as np
import pytest
from reader_seeds import integer_c3d

from surae.base.errors import InputError
from surae.recording.formats import open_table
from surae.recording.source import open_source

pytest.importorskip("ezc3d", reason="ezc3d is not installed: no C3D is read")
_BLOCK = 512
_PLAIN = integer_c3d()
_HEAD, _PARAMETERS, _SAMPLES = _PLAIN[:512], _PLAIN[512:1536], _PLAIN[1536:]


def group(number, name):
    return bytes([len(name), 256 - number]) + name.encode() + struct.pack("<h", 3) + b"\0"


def parameter(number, name, value):
    body = bytes([2, 0]) + struct.pack("<h", value) + b"\0"
    return bytes([len(name), number]) + name.encode() + struct.pack("<h", len(body) + 2) + body


def behind(parameters):
    """The file with its parameters behind the samples."""
    samples = _SAMPLES.ljust(-(-len(_SAMPLES) // _BLOCK) * _BLOCK, b"\0")
    head = bytearray(_HEAD)
    head[0] = 2 + len(samples) // _BLOCK
    struct.pack_into("<H", head, 16, 2)
    moved = bytearray(parameters)
    at = parameters.index(b"DATA_START") + len("DATA_START") + 4
    struct.pack_into("<h", moved, at, 2)
    return bytes(head) + samples + bytes(moved)


def with_more(more):
    """The parameters with something before their last group."""
    at = _PARAMETERS.index(group(3, "TRIAL"))
    return (_PARAMETERS[:at] + more + _PARAMETERS[at:])[: len(_PARAMETERS)]


MORE = {
    "nothing": b"",
    "a group without a name": group(4, ""),
    "a group without a name, with a parameter": group(4, "") + parameter(4, "X", 3),
    "a parameter of no group": parameter(9, "LOST", 3),
    "a parameter without a name": parameter(1, "", 3),
}


def values(path, data):
    path.write_bytes(data)
    table = open_table(open_source(path))
    loaded = table.load(table.names)
    return {name: column.values for name, column in loaded.items()}, table


@pytest.mark.parametrize("where", ["before", "behind"])
@pytest.mark.parametrize("more", MORE.values(), ids=MORE)
def test_unusual_parameters_are_read(tmp_path, more, where):
    plain, _ = values(tmp_path / "plain.c3d", _PLAIN)
    parameters = with_more(more)
    data = behind(parameters) if where == "behind" else _HEAD + parameters + _SAMPLES
    found, table = values(tmp_path / "x.c3d", data)
    assert found.keys() == plain.keys() == {"Angle", "EMG"}
    for name, expected in plain.items():
        np.testing.assert_array_equal(found[name], expected)
    assert table.units["Angle"] == "deg"


def test_parameters_behind_the_samples_may_end_before_their_block(tmp_path):
    data = behind(_PARAMETERS).rstrip(b"\0") + b"\0"
    found, table = values(tmp_path / "x.c3d", data)
    assert found.keys() == {"Angle", "EMG"}
    assert "cut short" in table.remarks["Angle"]


@pytest.mark.parametrize("part", [0.3, 0.6, 0.9])
def test_parameters_behind_the_samples_that_are_cut_are_refused_or_say_so(tmp_path, part):
    whole = behind(_PARAMETERS)
    begin = (whole[0] - 1) * _BLOCK
    used = len(_PARAMETERS.rstrip(b"\0"))
    try:
        _, table = values(tmp_path / "x.c3d", whole[: begin + round(part * used)])
    except InputError:
        return
    assert all("cut short" in table.remarks[name] for name in table.names)


#: What an idle machine takes at most to refuse a file [s].
SECONDS = 5.0


def test_parameters_without_an_end_are_refused_within_seconds(tmp_path):
    """Dimensions of units that no file holds: ezc3d works on them without an end."""
    before = b"UNITS\r\x00\xff\x02\x03"
    assert before in _PLAIN
    path = tmp_path / "x.c3d"
    path.write_bytes(_PLAIN.replace(before, b"UNITS\r\x00\xff\x7f\x03", 1))
    began = time.monotonic()
    with pytest.raises(InputError, match="damaged, or too large"):
        open_table(open_source(path))
    assert time.monotonic() - began < 4 * SECONDS  # other work may have the processor
