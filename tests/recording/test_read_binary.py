"""Poly5, C3D, EDF, BDF and XDF: what their numbers mean, and what is refused."""

import struct
import sys

import numpy as np
import pytest
from reader_seeds import (
    ANGLE,
    EMG,
    RATE,
    SEEDS,
    c3d_file,
    edf_file,
    integer_c3d,
    interrupted_edf,
    poly5_file,
    xdf_chunk,
    xdf_file,
)

from surae.base.errors import InputError
from surae.recording import read
from surae.recording.programs import c3d, edf, foreign, xdf
from surae.recording.table import sampling_of
from surae.signals import prepare


def loaded(table):
    return table.load(list(table.names))


def sampling(table, name):
    return sampling_of(table.load([name])[name].time)


@pytest.mark.parametrize("version", [203, 204])
def test_poly5_joins_pairs_scales_words_and_drops_the_last_blocks_rest(table, version):
    contents = table(poly5_file(n=50, per_block=20, version=version))
    assert contents.names == ("EMG", "Aux")
    assert dict(contents.units) == {"EMG": "uV", "Aux": "mV"}
    columns = loaded(contents)
    np.testing.assert_array_equal(columns["EMG"].values, np.arange(50) - 3.5)
    # Counts from -1000 to 1000 are -1 to 1 mV.
    np.testing.assert_allclose(columns["Aux"].values, np.arange(50) / 1000, atol=1e-15)
    np.testing.assert_array_equal(columns["Aux"].time, np.arange(50) / 2048)
    assert sampling(contents, "EMG").rate_hz == pytest.approx(2048)
    assert not contents.remarks


def test_poly5_says_where_header_and_blocks_disagree(table):
    columns = table(poly5_file(n=13, per_block=20) + bytes(86 + 120))
    assert sampling(columns, "EMG").n == 13
    data = bytearray(poly5_file(n=50, per_block=20))
    at = data.index(struct.pack("<i", 50))
    data[at : at + 4] = struct.pack("<i", 7)
    columns = table(bytes(data))
    assert sampling(columns, "EMG").n == 60
    assert columns.remarks["EMG"] == "the header counts 7 samples, the blocks hold 60"


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda d: d[:-1], "holds 2 of its 3 blocks"),
        (lambda d: d[:100], "cut short"),
        (lambda d: d.replace(b"(Hi) EMG", b"(Hi) XYZ"), "not followed by its high word"),
        (lambda d: d[:151] + b"\x01\0" + d[153:], "delta compressed"),
        (lambda d: d[:149] + b"\x01\0" + d[151:], "blocks of 1 bytes don't hold 20 samples"),
        (lambda d: d[:114] + b"\0\0" + d[116:], "not a sampling rate"),
    ],
)
def test_poly5_refuses(table, spoil, says):
    with pytest.raises(InputError, match=says):
        table(spoil(poly5_file()))


def test_c3d_of_ezc3d_has_channels_and_coordinates(table):
    contents = table(c3d_file())
    assert contents.names == ("Angle", "TA", "heel.X", "heel.Y", "heel.Z")
    assert dict(contents.units) == {"Angle": "deg", "TA": "V"}
    columns = loaded(contents)
    np.testing.assert_allclose(columns["Angle"].values, ANGLE, rtol=1e-6)
    np.testing.assert_allclose(columns["TA"].values, EMG[:, 0], rtol=1e-6)
    np.testing.assert_array_equal(columns["TA"].time, np.arange(len(ANGLE)) / RATE)
    assert sampling(contents, "TA").rate_hz == pytest.approx(RATE)
    # Points have a rate of their own.
    np.testing.assert_array_equal(columns["heel.Y"].time, np.arange(len(ANGLE) // 2) / (RATE / 2))
    np.testing.assert_array_equal(columns["heel.Y"].values, 1.0)


@pytest.mark.parametrize("processor", [84, 85])
@pytest.mark.parametrize("floats", [False, True])
def test_c3d_of_every_processor_and_its_scales(table, processor, floats):
    counts = np.arange(80).reshape(40, 2) - 20
    columns = loaded(table(integer_c3d(processor, counts, floats=floats)))
    np.testing.assert_allclose(columns["Angle"].values, (counts[:, 0] - 10) * 0.5 * 0.25)
    # Its offset is -10, of which ezc3d makes 10.
    np.testing.assert_allclose(columns["EMG"].values, (counts[:, 1] + 10) * 2.0 * 0.25)


def test_c3d_counts_without_sign_and_beyond_16_bits(table):
    counts = np.full((8, 2), 60000, dtype=np.int64)
    unsigned = ((2, "FORMAT", -1, [8], b"UNSIGNED"),)
    columns = loaded(table(integer_c3d(84, counts.astype("u2").astype("i2"), more=unsigned)))
    # An offset of -10 without its sign is 65526.
    np.testing.assert_allclose(columns["EMG"].values, (60000 - 65526) * 2.0 * 0.25)
    # Four frames, of which the trial's newer count knows.
    ends = struct.pack("<2h", 3, 1), struct.pack("<2h", 6, 1)
    more = ((3, "ACTUAL_START_FIELD", 2, [2], ends[0]), (3, "ACTUAL_END_FIELD", 2, [2], ends[1]))
    right = table(integer_c3d(84, counts.astype("i2") * 0, more=more))
    assert sampling(right, "EMG").n == 8
    assert not right.remarks
    # A newer count that is wrong: the header's fits the file's size.
    wrong = ((3, "ACTUAL_END_FIELD", 2, [2], ends[1]),)
    contents = table(integer_c3d(84, counts.astype("i2") * 0, more=wrong))
    assert sampling(contents, "EMG").n == 8
    assert contents.remarks["EMG"] == "65542 frames are announced, but the file holds 4"


def test_c3d_says_that_a_trial_was_cropped(table):
    assert table(integer_c3d(first=101)).remarks["Angle"] == "time 0 is frame 101 of the trial"


def test_a_c3d_cut_short_is_read_as_far_as_it_goes(table):
    whole, cut = loaded(table(integer_c3d())), table(integer_c3d()[:-4])
    assert cut.remarks["EMG"] == "the file is cut short: it holds 31 of its 32 frames"
    np.testing.assert_array_equal(loaded(cut)["EMG"].values, whole["EMG"].values[:-2])


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda d: d[:1024], "cut short"),
        (lambda d: d[:515] + b"\x56" + d[516:], "which ezc3d does not read; save it again"),
        # ezc3d crashes where there are no scales.
        pytest.param(
            lambda d: d.replace(b"\x05\x02SCALE", b"\x05\x02SCHAL"),
            "C3D that cannot be read",
            marks=pytest.mark.long,
        ),
    ],
)
def test_c3d_refuses(table, spoil, says):
    with pytest.raises(InputError, match=says):
        table(spoil(integer_c3d()))


def test_a_c3d_whose_header_and_parameters_differ_is_settled_by_its_size_or_refused(table):
    data = integer_c3d()
    # Three channels in the parameters, two in the header, which fits the file.
    at = data.index(b"\x04\x02USED") + len(b"\x04\x02USED") + 4
    wrong = data[:at] + b"\x03\0" + data[at + 2 :]
    columns = table(wrong)
    assert columns.names == ("Angle", "EMG")
    assert "the parameters say 0 points and 3 channels" in columns.remarks["EMG"]
    np.testing.assert_array_equal(loaded(columns)["EMG"].values, loaded(table(data))["EMG"].values)
    with pytest.raises(InputError, match=r"contradicts itself: .* its size fits neither"):
        table(wrong + bytes(range(256)) * 4)


@pytest.mark.parametrize("binary", [False, True])
def test_edf_and_bdf(table, binary):
    contents = table(edf_file(binary=binary))
    assert (contents.names, contents.format) == (("Angle", "TA"), "BDF" if binary else "EDF")
    assert dict(contents.units) == {"Angle": "deg", "TA": "uV"}
    columns = loaded(contents)
    step = 20 / 2 ** (24 if binary else 16)
    np.testing.assert_allclose(columns["Angle"].values, 100 * ANGLE[:60], atol=2 * step)
    np.testing.assert_allclose(columns["TA"].values, 1e6 * EMG[:30, 0], rtol=0, atol=0.01)
    np.testing.assert_allclose(columns["TA"].time, np.arange(30) / 10)
    assert [sampling(contents, name).rate_hz for name in contents.names] == pytest.approx([20, 10])


def test_edf_in_several_parts_is_the_same(table, monkeypatch):
    whole = loaded(table(edf_file(binary=True)))
    monkeypatch.setattr("surae.recording.programs.edf._PART", 1)
    parts = loaded(table(edf_file(binary=True)))
    for name, column in whole.items():
        np.testing.assert_array_equal(column.values, parts[name].values)


def test_an_interrupted_edf_keeps_its_gap_and_is_refused_with_its_time(table, tmp_path):
    columns = table(interrupted_edf())
    assert "interrupted" in columns.remarks["Angle"]
    time = columns.load(["TA"])["TA"].time
    np.testing.assert_allclose(time, [*np.arange(20) / 10, *(7 + np.arange(10) / 10)])
    path = tmp_path / "map.toml"
    path.write_text('[channels.angle]\nfile = "data"\ncolumn = "Angle"\n')
    with pytest.raises(InputError, match=r"no samples from 1\.95 to 7 s"):
        prepare(read(path))


def test_an_edf_that_was_never_closed_is_read_to_its_end(table):
    data = edf_file()
    open_ended = data[:236] + b"-1      " + data[244:]
    assert sampling(table(open_ended), "Angle").n == 60


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda d: d[:-1], "holds 2 of its 3 records"),
        (lambda d: d[:200], "cut short"),
        (lambda d: d[:244] + b"0       " + d[252:], "no sampling rate"),
        (lambda d: d[:252] + b"9999" + d[256:], "the file is damaged"),
        (lambda d: d[:252] + b"zwei" + d[256:], "the file is damaged"),
    ],
)
def test_edf_refuses(table, spoil, says):
    with pytest.raises(InputError, match=says):
        table(spoil(edf_file()))


def test_an_edf_signal_without_calibration_is_refused(table):
    data = edf_file()
    # The physical ranges of three signals stand behind their labels, transducers and dimensions.
    at = 256 + 3 * (16 + 80 + 8)
    data = data[:at] + data[at + 24 : at + 32] + data[at + 8 :]
    with pytest.raises(InputError, match=r"'Angle': its range .* is no calibration"):
        table(data)


def test_xdf_streams_share_one_clock_and_lose_their_jitter(table):
    contents = table(xdf_file(offset=3.0))
    assert contents.names == ("EMG: c0", "EMG: c1", "Robot: c0")
    assert contents.units["EMG: c0"] == "microvolts"
    columns = loaded(contents)
    np.testing.assert_array_equal(columns["EMG: c1"].values, -np.arange(64))
    np.testing.assert_array_equal(columns["Robot: c0"].values, np.arange(32))
    fast, slow = columns["EMG: c0"].time, columns["Robot: c0"].time
    np.testing.assert_allclose(np.diff(fast), np.diff(fast)[0], rtol=1e-9)
    assert sampling(contents, "EMG: c0").rate_hz == pytest.approx(100, rel=0.01)
    # Robot's clock is 3 s behind; put right, both begin together.
    assert fast[0] == pytest.approx(slow[0], abs=2e-3)
    np.testing.assert_allclose(np.diff(slow), 0.02, rtol=1e-6)


def test_an_irregular_stream_keeps_its_stamps(table):
    columns = table(xdf_file(irregular=True))
    time = loaded(columns)["EMG: c0"].time
    assert np.diff(time).std() > 1e-4
    assert sampling(columns, columns.names[0]).n == 64


def test_xdf_with_samples_missing_has_a_gap_there(table):
    column = loaded(table(xdf_file(lost=30)))["EMG: c0"]
    steps = np.diff(column.time)
    assert steps[31] == pytest.approx(0.31, abs=3e-3)
    np.testing.assert_allclose(np.delete(steps, 31), 0.01, rtol=0.02)
    assert "with 1 gap " in table(xdf_file(lost=30)).remarks["EMG: c0"]


def test_xdf_whose_clock_goes_back_is_refused(table):
    with pytest.raises(InputError, match="time stamps don't increase"):
        loaded(table(xdf_file(lost=-10)))


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (xdf_file()[:-3], "cut short or damaged"),
        (b"XDF:", "no stream of numbers"),
        (b"XDF:" + xdf_chunk(3, struct.pack("<I", 9)), "samples are unreadable"),
        (b"XDF:" + xdf_chunk(2, b"\1\0\0\0<!DOCTYPE x><info/>"), "damaged"),
        (xdf_file().replace(b"\x01\x10\x08", b"\x01\xff\x08", 1), "samples are unreadable"),
        (xdf_file().replace(b"<channel_count>2", b"<channel_count>3", 1), "damaged"),
    ],
)
def test_xdf_refuses(table, data, says):
    with pytest.raises(InputError, match=says):
        table(data)


@pytest.mark.parametrize(
    ("parse", "package"), [(c3d.parse, "ezc3d"), (edf.parse, "edfio"), (xdf.parse, "pyxdf")]
)
def test_a_missing_library_names_the_extra(monkeypatch, parse, package):
    data = SEEDS[parse.__module__.rpartition(".")[2]][0]()
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf'package {package}; .*"surae\[formats\]"'):
        parse(data, "x")


def test_a_reader_that_hangs_or_eats_memory_is_ended_and_the_next_file_is_read(table, monkeypatch):
    hangs, guarded = "signal:pause", foreign.guarded
    monkeypatch.setattr(
        foreign,
        "guarded",
        lambda _, __, **limits: guarded(hangs, {}, **(limits | {"seconds": 0.2})),
    )
    with pytest.raises(InputError, match=r"XDF that cannot be read: .*\(it took too long\)"):
        table(xdf_file())
    monkeypatch.undo()
    assert table(xdf_file()).names
