"""A data set of EMG-BIDS: what it has to have, and signals that read back as they were."""

import json
from dataclasses import replace

import numpy as np
import pytest

from surae import InputError, example, fit, load, read
from surae.api import write_bids, write_parquet
from surae.recording import Channel

#: What a recording's JSON must say (BIDS 1.11, electromyography).
REQUIRED = (
    "TaskName",
    "EMGPlacementScheme",
    "EMGReference",
    "SamplingFrequency",
    "PowerLineFrequency",
    "SoftwareFilters",
)


@pytest.fixture(scope="module")
def recording():
    return example().crop(0.0, 6.0)


def test_a_set_has_what_the_standard_asks_for(recording, tmp_path) -> None:
    fitted = fit(recording, "muscle", starts=1)
    made = write_bids(tmp_path, [recording, recording], fitted, task="holds", mains_hz=50.0)
    assert set(made.paths) == {
        p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file()
    }
    described = json.loads((tmp_path / "dataset_description.json").read_text())
    assert described["BIDSVersion"].startswith("1.11")
    base = tmp_path / "sub-01" / "emg" / "sub-01_task-holds_run-01_"
    said = json.loads(base.with_name(base.name + "emg.json").read_text())
    assert set(REQUIRED) <= said.keys()
    assert said["PowerLineFrequency"] == 50.0
    table = base.with_name(base.name + "channels.tsv").read_text()
    rows = [line.split("\t") for line in table.splitlines()]
    assert rows[0][:3] == ["name", "type", "units"]
    assert {row[1] for row in rows[1:]} == {"EMG", "MISC"}
    assert (tmp_path / "participants.tsv").read_text() == "participant_id\nsub-01\n"
    derived = tmp_path / "derivatives" / "surae" / "sub-01" / "emg"
    again = load(derived / "sub-01_task-holds_desc-surae_fit.json")
    assert again.values == fitted.values
    table = (derived / "sub-01_task-holds_desc-surae_parameters.tsv").read_text()
    assert len(table.splitlines()) == 1 + len(fitted.parameters)


def test_an_edf_reads_back_to_the_same_signals(recording, tmp_path) -> None:
    made = write_bids(tmp_path, [recording])
    (edf,) = [path for path in made.paths if path.endswith(".edf")]
    again = read(tmp_path / edf)
    for role, channel in recording.channels.items():
        n = len(again[role].values)
        lost = made.cut["sub-01_task-ankle_run-01_emg.edf"]
        assert n == round(len(channel.values) - lost * channel.rate_hz)
        assert again[role].unit == channel.unit
        step = 1.01 * np.ptp(channel.values) / 65535
        np.testing.assert_allclose(again[role].values, channel.values[:n], rtol=0.0, atol=step)


def test_another_person_joins_the_set(recording, tmp_path) -> None:
    write_bids(tmp_path, [recording])
    (tmp_path / "README.md").write_text("ours")
    write_bids(tmp_path, [recording], subject="02", session="a")
    assert (tmp_path / "README.md").read_text() == "ours"
    assert (tmp_path / "participants.tsv").read_text().split() == [
        "participant_id",
        "sub-01",
        "sub-02",
    ]
    assert (tmp_path / "sub-02" / "ses-a" / "emg").is_dir()


def test_what_cannot_be_written_is_said(recording, tmp_path) -> None:
    with pytest.raises(InputError, match="letters and digits"):
        write_bids(tmp_path, [recording], subject="a_b")
    torque = recording["torque"]
    late = replace(torque, time=torque.time + 1.0)
    channels = {**recording.channels, "torque": late}
    assert isinstance(late, Channel)
    with pytest.raises(InputError, match="begin up to 1 s apart"):
        write_bids(tmp_path, [replace(recording, channels=channels)])


def test_parquet_reads_back_without_loss(recording, tmp_path) -> None:
    write_parquet(tmp_path / "trial.parquet", recording)
    again = read(tmp_path / "trial.parquet")
    for role, channel in recording.channels.items():
        np.testing.assert_array_equal(again[role].values, channel.values)
