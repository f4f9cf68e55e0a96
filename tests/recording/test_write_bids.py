"""BIDS folders: samples to the resolution of 24 bits, sidecars, nobody's name, all or nothing."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from surae.errors import InputError
from surae.recording import Recording, read, write_bids

edfio = pytest.importorskip("edfio", reason="BDF needs the extra formats")

quick = settings(max_examples=15)


def recording(n=500, rate=256.0, **kind):
    time = 0.25 + np.arange(n) / rate
    emg = np.abs(np.outer(np.sin(9 * time), [1e-4, 2e-4, 3e-4, 4e-4]))
    return Recording.from_arrays(time, np.cos(time), 9 * time, emg, name="Jane Doe", **kind)


def data(folder):
    return folder / "sub-01" / "emg"


def read_back(path):
    """Samples by label, and the resolution of each."""
    signals = {}
    for signal in edfio.read_bdf(path).signals:
        step = (signal.physical_max - signal.physical_min) / (
            signal.digital_max - signal.digital_min
        )
        signals[signal.label] = (signal.data, step, signal.sampling_frequency)
    return signals


@quick
@given(
    st.data(),
    st.integers(40, 150),
    st.sampled_from([10.0, 16.0, 25.6, 12.59259259, 33.3]),
)
def test_round_trip_to_the_resolution(tmp_path_factory, data_, n, rate):
    small = st.floats(-1e3, 1e3, allow_subnormal=False).map(lambda x: round(x, 9))
    angle, torque = (data_.draw(arrays(np.float64, n, elements=small)) for _ in range(2))
    emg = data_.draw(arrays(np.float64, (n, 4), elements=small.map(lambda x: 1e-6 * x)))
    recording = Recording.from_arrays(np.arange(n) / rate, angle, torque, emg)
    folder = tmp_path_factory.mktemp("b") / "out"
    write_bids(folder, recording)
    again = read_back(data(folder) / "sub-01_task-ankle_emg.bdf")
    labels = ["angle_rad", "torque_Nm", "emg_ta_uV", "emg_gl_uV", "emg_sol_uV", "emg_gm_uV"]
    assert list(again) == labels
    for label, channel in zip(labels, recording.channels.values(), strict=True):
        values, step, frequency = again[label]
        expected = channel.values * (1e6 if label.startswith("emg") else 1.0)
        assert len(values) == n
        np.testing.assert_allclose(values, expected, rtol=1e-12, atol=0.51 * step + 1e-9)
        assert frequency == pytest.approx(rate, rel=1e-6)


def test_what_is_written(tmp_path):
    write_bids(tmp_path / "out", replace(recording(), side="left"), subject="A7", task="ramp")
    names = {str(p.relative_to(tmp_path / "out")) for p in (tmp_path / "out").rglob("*.*")}
    stem = "sub-A7/emg/sub-A7_task-ramp"
    assert names == {
        *("dataset_description.json", "participants.tsv", "participants.json", "README.md"),
        *(f"{stem}_emg.bdf", f"{stem}_emg.json", f"{stem}_channels.tsv"),
    }
    table = (tmp_path / "out" / f"{stem}_channels.tsv").read_text(encoding="utf-8").splitlines()
    assert table[0].split("\t")[:3] == ["name", "type", "units"]
    rows = [line.split("\t") for line in table[1:]]
    assert [row[:3] for row in rows[1:3]] == [
        ["torque_Nm", "MISC", "Nm"],
        ["emg_ta_uV", "EMG", "uV"],
    ]
    assert rows[2][-1] == "tibialis anterior"
    sidecar = json.loads((tmp_path / "out" / f"{stem}_emg.json").read_text(encoding="utf-8"))
    required = {"EMGPlacementScheme", "EMGReference", "PowerLineFrequency", "SoftwareFilters"}
    assert required | {"TaskName", "SamplingFrequency", "RecordingType"} <= sidecar.keys()
    assert (sidecar["SamplingFrequency"], sidecar["StartTime"]) == (256.0, 0.25)
    assert sidecar["EMGChannelCount"] == 4
    people = (tmp_path / "out" / "participants.tsv").read_text(encoding="utf-8")
    assert people == "participant_id\tleg\nsub-A7\tleft\n"
    description = json.loads(
        (tmp_path / "out" / "dataset_description.json").read_text(encoding="utf-8")
    )
    assert description["BIDSVersion"]
    assert description["DatasetType"] == "raw"


def test_nobodys_name(tmp_path):
    write_bids(tmp_path / "out", recording())
    for path in (tmp_path / "out").rglob("*"):
        assert "Jane" not in str(path.relative_to(tmp_path))
        if path.is_file():
            assert b"Jane" not in path.read_bytes()


def test_an_envelope_says_so(tmp_path):
    write_bids(tmp_path / "out", recording(emg_kind="envelope"))
    (sidecar,) = data(tmp_path / "out").glob("*_emg.json")
    assert "envelope" in json.loads(sidecar.read_text(encoding="utf-8"))["SoftwareFilters"]


def test_channels_with_times_of_their_own_get_files_of_their_own(tmp_path):
    measured = recording()
    late = replace(measured.channels["torque"], time=measured.channels["torque"].time + 1e-4)
    write_bids(tmp_path / "out", replace(measured, channels={**measured.channels, "torque": late}))
    sidecars = sorted(data(tmp_path / "out").glob("*_emg.json"))
    starts = [json.loads(p.read_text(encoding="utf-8"))["StartTime"] for p in sidecars]
    assert [p.name.split("_")[2] for p in sidecars] == ["acq-1", "acq-2"]
    assert starts == [0.25, pytest.approx(0.2501)]


def test_a_rate_that_no_header_holds_is_still_in_the_sidecar(tmp_path):
    measured = recording(n=4099, rate=1259.259259)  # 4099 is a prime
    write_bids(tmp_path / "out", measured)
    again = read_back(data(tmp_path / "out") / "sub-01_task-ankle_emg.bdf")
    assert len(again["angle_rad"][0]) == 4099
    (sidecar,) = data(tmp_path / "out").glob("*_emg.json")
    rate = json.loads(sidecar.read_text(encoding="utf-8"))["SamplingFrequency"]
    assert rate == pytest.approx(1259.259259, rel=1e-9)


@pytest.mark.parametrize(
    ("settings_", "says"),
    [({"subject": "Jane Doe"}, "letters and digits"), ({"task": "a_b"}, "letters and digits")],
)
def test_labels(tmp_path, settings_, says):
    with pytest.raises(InputError, match=says):
        write_bids(tmp_path / "out", recording(), **settings_)


def test_a_folder_that_exists_and_uneven_times_are_refused(tmp_path):
    (tmp_path / "out").mkdir()
    with pytest.raises(InputError, match="exists already"):
        write_bids(tmp_path / "out", recording())
    uneven = Recording.from_arrays([0.0, 1.0, 2.5], [0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="not sampled uniformly"):
        write_bids(tmp_path / "new", uneven)
    with pytest.raises(InputError, match="cannot write"):
        write_bids(tmp_path / "no" / "new" / "\0", recording())
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_a_failure_leaves_nothing(tmp_path):
    with pytest.raises(InputError, match="2 samples at 256 Hz are too short for the BDF header"):
        write_bids(tmp_path / "new", recording(n=2))
    huge = Recording.from_arrays([0.0, 1.0, 2.0], [0.0, 1e30, -1e30])
    with pytest.raises(InputError, match="cannot write"):
        write_bids(tmp_path / "new", huge)
    assert list(tmp_path.iterdir()) == []


def test_times_and_kind_of_emg_come_back_from_the_sidecar(tmp_path):
    measured = recording(emg_kind="envelope")
    late = replace(measured.channels["torque"], time=measured.channels["torque"].time + 2.0)
    write_bids(tmp_path / "out", replace(measured, channels={**measured.channels, "torque": late}))
    first, second = sorted(data(tmp_path / "out").glob("*.bdf"))
    assert read(first).emg == "envelope"
    np.testing.assert_allclose(read(first).channels["angle"].time, measured.channels["angle"].time)
    (tmp_path / "m.toml").write_text(
        f'[channels.angle]\nfile = "{first.as_posix()}"\ncolumn = "angle_rad"\n'
        f'[channels.torque]\nfile = "{second.as_posix()}"\ncolumn = "torque_Nm"\n'
    )
    np.testing.assert_allclose(read(tmp_path / "m.toml").channels["torque"].time, late.time)


@pytest.mark.parametrize("text", ["[]", "{", '"x"'])
def test_a_sidecar_that_is_none_is_refused(tmp_path, text):
    write_bids(tmp_path / "out", recording())
    (path,) = data(tmp_path / "out").glob("*.bdf")
    path.with_suffix(".json").write_text(text)
    with pytest.raises(InputError, match=r"_emg\.json: no JSON object"):
        read(path)


def test_a_sidecar_without_a_start_and_none_at_all_mean_zero(tmp_path):
    write_bids(tmp_path / "out", recording())
    (path,) = data(tmp_path / "out").glob("*.bdf")
    path.with_suffix(".json").write_text('{"StartTime": "n/a", "SoftwareFilters": "n/a"}')
    assert (read(path).emg, read(path).channels["angle"].time[0]) == ("raw", 0.0)
    path.with_suffix(".json").unlink()
    assert read(path).channels["angle"].time[0] == 0.0
