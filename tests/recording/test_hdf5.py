"""Our own recordings in HDF5: what is written is what is read, and it says what it is."""

import h5py
import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import Channel, Recording, SourceFile, read, write_hdf5
from surae.recording.formats import open_table
from surae.recording.hdf5 import write_text
from surae.recording.source import open_source
from surae.recording.table import sampling_of


def channel(role, time, values, unit):
    return Channel(role, np.asarray(time), np.asarray(values), unit, f"trial.mat: {role} [x]")


def recording(**more):
    rng = np.random.default_rng(1)
    jittered = np.cumsum(rng.uniform(0.5e-3, 1.5e-3, 200))
    return Recording(
        name="Trial 1, ääni",
        channels={
            "angle": channel("angle", 0.25 + np.arange(50) / 100, rng.normal(size=50), "rad"),
            "torque": channel("torque", jittered, rng.normal(size=200), "Nm"),
            "emg_ta": channel("emg_ta", 0.1 + 0.0005 * np.arange(99), rng.normal(size=99), "V"),
            "emg_sol": channel("emg_sol", jittered.copy(), -0.0 * np.ones(200), "V"),
        },
        **more,
    )


def same(first, other):
    assert list(first.channels) == list(other.channels)
    for role, channel in first.channels.items():
        read_back = other.channels[role]
        assert (read_back.unit, read_back.source) == (channel.unit, channel.source)
        assert read_back.time.tobytes() == channel.time.tobytes()
        assert read_back.values.tobytes() == channel.values.tobytes()
        assert not read_back.values.flags.writeable
        assert not read_back.time.flags.writeable
    for name in ("name", "emg", "fixed", "prepare", "side", "device"):
        assert getattr(first, name) == getattr(other, name)


def test_every_bit_and_setting_comes_back(tmp_path):
    files = (SourceFile("a folder/a name/trial.toml", "a" * 64), SourceFile("x.mat", "0" * 64))
    written = recording(
        fixed={"m": 0.1, "g2": 0.0},
        prepare={"bessel_hz": False, "rate_hz": 128, "list": (1, 2.5)},
        side="left",
        device={"name": "Ächilles", "nested": ("a", 1)},
        files=files,
    )
    path = tmp_path / "trial.h5"
    write_hdf5(path, written)
    measured = read(path)
    same(written, measured)
    # Provenance: the file itself first, then where it came from, without the folders.
    assert measured.files[0] == open_source(path).file
    assert [(f.path, f.sha256) for f in measured.files[1:]] == [
        ("trial.toml", "a" * 64),
        ("x.mat", "0" * 64),
    ]
    assert b"a folder" not in path.read_bytes()
    # The channels with the same times share them in the file and in memory.
    assert measured.channels["torque"].time is measured.channels["emg_sol"].time
    assert path.read_bytes().count(written.channels["torque"].time.tobytes()) == 1
    # Written again, it is the same but for one file more in its history.
    write_hdf5(tmp_path / "again.h5", measured)
    same(written, read(tmp_path / "again.h5"))


def test_the_same_recording_gives_the_same_bytes_and_replaces_a_file_whole(tmp_path):
    first, other = tmp_path / "one.h5", tmp_path / "other.h5"
    other.write_bytes(b"before")
    write_hdf5(first, recording())
    write_hdf5(other, recording())
    assert first.read_bytes() == other.read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["one.h5", "other.h5"]
    with pytest.raises(InputError, match="no such file or directory"):
        write_hdf5(tmp_path / "nowhere" / "x.h5", recording())
    with pytest.raises(InputError, match="cannot write"):
        write_hdf5(first, recording(device={"serial": 3 + 4j}))
    assert first.read_bytes() == other.read_bytes()


def test_a_recording_says_what_it_is_without_us(tmp_path):
    path = tmp_path / "trial"
    write_hdf5(path, recording(emg="envelope"))
    assert path.read_bytes().startswith(b"surae recording 1")
    with h5py.File(path) as file:
        values = file["channels/angle/values"]
        assert dict(values.attrs) == {"unit": b"rad", "start_s": 0.25, "rate_hz": 100.0}
        assert file.attrs["emg"] == b"envelope"
        assert list(file["channels"]) == ["angle", "torque", "emg_ta", "emg_sol"]
        assert file["channels/torque/time"].attrs["unit"] == b"s"


def test_its_table_has_our_names(tmp_path):
    path = tmp_path / "trial.h5"
    write_hdf5(path, recording())
    table = open_table(open_source(path))
    assert table.names == ("angle_rad", "torque_Nm", "emg_ta_V", "emg_sol_V")
    samplings = {name: sampling_of(column.time) for name, column in table.load(table.names).items()}
    assert samplings["angle_rad"].rate_hz == pytest.approx(100)
    assert samplings["angle_rad"].start_s == 0.25
    assert samplings["torque_Nm"].rate_hz is None
    assert (table.units["torque_Nm"], samplings["torque_Nm"].n) == ("Nm", 200)
    mapping = tmp_path / "map.toml"
    mapping.write_text('[channels.angle]\nfile = "trial.h5"\ncolumn = "angle_rad"\n')
    assert read(mapping).channels["angle"].values.tobytes() == (
        recording().channels["angle"].values.tobytes()
    )


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda f: write_text(f, "emg", "boiled"), "emg: 'boiled' is none of: raw, envelope"),
        (lambda f: write_text(f, "fixed", '{"m": "x"}'), "fixed.m: 'x' is not a finite number"),
        (lambda f: write_text(f, "files", '[{"name": "x"}]'), r"files\[0\].sha256: it is missing"),
        (lambda f: write_text(f, "device", "{"), "'device' is no JSON"),
        (lambda f: f.attrs.__setitem__("device", "{}"), "'device' is missing or no text"),
        (lambda f: f.attrs.__delitem__("name"), "'name' is missing"),
        (lambda f: f.__delitem__("channels/angle"), "no channel 'angle'"),
        (
            lambda f: f["channels/angle/values"].attrs.__setitem__("unit", np.bytes_("deg")),
            "SI unit",
        ),
        (lambda f: f["channels/angle/values"].attrs.__setitem__("rate_hz", 0.0), "not a time axis"),
        (lambda f: f["channels/angle/values"].attrs.__delitem__("start_s"), "no times"),
        (lambda f: f["channels/angle/values"].__setitem__(3, np.nan), "sample 4: nan"),
        (lambda f: f["channels/torque/time"].__setitem__(3, 0.0), "time doesn't increase"),
    ],
)
def test_what_a_recording_cannot_hold_is_refused(tmp_path, spoil, says):
    path = tmp_path / "trial.h5"
    write_hdf5(path, recording())
    with h5py.File(path, "r+") as file:
        spoil(file)
    with pytest.raises(InputError, match=says):
        read(path)


def test_a_claim_that_the_file_cannot_hold_is_not_unpacked(tmp_path):
    path = tmp_path / "trial.h5"
    write_hdf5(path, recording())
    with h5py.File(path, "r+") as file:
        group = file["channels/angle"]
        del group["values"]
        values = group.create_dataset("values", shape=(2**40,), chunks=(2**16,), dtype="f8")
        write_text(values, "unit", "rad")
    with pytest.raises(InputError, match="it claims 8388608 MiB"):
        read(path)


def test_compressed_by_others_it_still_reads(tmp_path):
    path = tmp_path / "trial.h5"
    write_hdf5(path, recording())
    expected = recording().channels["angle"].values
    with h5py.File(path, "r+") as file:
        group = file["channels/angle"]
        attributes = dict(group["values"].attrs)
        attributes["unit"] = np.bytes_(attributes["unit"])
        del group["values"]
        values = group.create_dataset("values", data=expected, compression="gzip")
        values.attrs.update(attributes)
    np.testing.assert_array_equal(read(path).channels["angle"].values, expected)
