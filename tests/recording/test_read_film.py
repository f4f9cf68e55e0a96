"""A film of fascicles beside the robot's signals: its columns, its clock, lost frames."""

from pathlib import Path

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.recording import inspect
from surae.signals.prepare import prepare

SHARED = Path(__file__).parents[3] / "shared" / "data" / "ultrasound"


def _csv(path: Path, header: str, rows: list[str]) -> Path:
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def _robot(folder: Path, more: str = "", cells: tuple[str, ...] = ()) -> Path:
    time = np.arange(0.0, 4.0, 0.01)
    rows = [f"{t:.2f},{0.3 * np.sin(t):.6f},{5 * np.cos(t):.6f}" for t in time]
    if more:
        rows = [f"{row},{cells[i % len(cells)]}" for i, row in enumerate(rows)]
    return _csv(folder / "robot.csv", "time_s,angle_rad,torque_Nm" + more, rows)


def _mapped(folder: Path, film: str) -> surae.Recording:
    _robot(folder)
    channels = "".join(
        f'[channels.{role}]\nfile = "robot.csv"\ncolumn = "{role}_{unit}"\nunit = "{unit}"\n'
        for role, unit in (("angle", "rad"), ("torque", "Nm"))
    )
    mapping = folder / "map.toml"
    mapping.write_text(
        f'{channels}[channels.fascicle_gm]\nfile = "film.csv"\ncolumn = "FL"\nunit = "mm"\n{film}\n'
    )
    return surae.read(mapping)


@pytest.mark.parametrize("name", ["fascicle_tib_mm", "fascicle_ta_mm"])
def test_a_column_of_our_csv_is_read_without_its_lost_frames(tmp_path: Path, name: str) -> None:
    recording = surae.read(_robot(tmp_path, f",{name}", ("62.5", "", "nan", "0")))
    film = recording.channels["fascicle_tib"]
    assert film.unit == "m"
    np.testing.assert_allclose(film.time, np.arange(0.0, 4.0, 0.04))
    np.testing.assert_allclose(film.values, 0.0625)


def test_a_blank_cell_of_another_signal_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the cell is blank"):
        surae.read(_robot(tmp_path, ",emg_ta_V", ("1e-3", "")))


@pytest.mark.parametrize(
    ("header", "clock"),
    [
        ("time_s,FL", ""),
        ("frame,stamp,FL", 'time = "stamp"'),
        ("frame,stamp (ms),FL", 'time = "stamp (ms)"'),
        ("frame,FL", "start_s = 0.52\nrate_hz = 30.0"),
        ("t,FL", "start_s = 0.52"),
    ],
)
def test_a_film_has_a_clock_of_its_own(tmp_path: Path, header: str, clock: str) -> None:
    frames = np.arange(90)
    time = 0.52 + frames / 30.0
    stamps = {
        "time_s": time,
        "stamp": time,
        "stamp (ms)": 1e3 * time,
        "t": time + 7.0,
        "frame": frames,
        "FL": 50 + 0.1 * frames,
    }
    columns = [stamps[name] for name in header.split(",")]
    rows = [",".join(map(str, row)) for row in zip(*columns, strict=True)]
    _csv(tmp_path / "film.csv", header, rows)
    recording = _mapped(tmp_path, clock)
    film = recording.channels["fascicle_gm"]
    np.testing.assert_allclose(film.time, time, atol=1e-9)
    np.testing.assert_allclose(film.values, 1e-3 * (50 + 0.1 * frames))
    inputs = prepare(recording)
    assert inputs.rate_hz == 100.0  # the film's rate is not that of the model
    assert inputs.time[0] == 0.0
    np.testing.assert_array_equal(inputs.films[0].time, film.time)


@pytest.mark.parametrize(
    ("clock", "message"),
    [
        ('time = "t"\nrate_hz = 30.0', "both say when"),
        ('time = "stamps"', "has no column 'stamps'"),
        ("rate_hz = 0.0", "rate_hz is 0; it must be above 0"),
        ("start_s = 1.0", "give start_s, .* and rate_hz"),
    ],
)
def test_a_clock_that_says_nothing_is_refused(tmp_path: Path, clock: str, message: str) -> None:
    _csv(tmp_path / "film.csv", "frame,FL", ["1,50", "2,51"])
    with pytest.raises(InputError, match=message):
        _mapped(tmp_path, clock)


def test_a_film_survives_our_own_file(tmp_path: Path) -> None:
    _csv(tmp_path / "film.csv", "frame,FL", [f"{i},{50 + 0.1 * i}" for i in range(90)])
    recording = _mapped(tmp_path, "start_s = 0.5\nrate_hz = 30.0")
    surae.recording.write_hdf5(tmp_path / "own.h5", recording)
    assert surae.read(tmp_path / "own.h5").channels == recording.channels


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared measured data are not here")
def test_a_trackers_file_offers_its_lengths_and_pennation() -> None:
    inspection = inspect(SHARED / "PL_50_01_tracked.mat")
    assert {c.column for c in inspection.open["fascicle_tib"]} == {
        "Fdat.Region(1).FL",
        "Fdat.Region(2).FL",
        "TrackingData.Region(1).fas_length",  # without times
        "TrackingData.Region(2).fas_length",
    }
    assert {c.column for c in inspection.open["pennation_gm"]} == {
        "Fdat.Region(1).PEN",
        "Fdat.Region(2).PEN",
        "TrackingData.Region(1).fas_pen",
        "TrackingData.Region(2).fas_pen",
    }


def test_a_trackers_file_without_times_is_inspected_and_needs_a_clock(tmp_path: Path) -> None:
    film = _csv(tmp_path / "film.csv", "frame,FL", [f"{i},{62 + 0.1 * i}" for i in range(60)])
    inspected = inspect([_robot(tmp_path), film])
    (length,) = (channel for channel in inspected.channels if channel.column == "FL")
    assert (length.n, length.rate_hz, length.start_s) == (60, None, None)
    assert "give start_s and rate_hz" in length.remark
    recording = _mapped(tmp_path, "start_s = 1.0\nrate_hz = 30.0")
    time = recording.channels["fascicle_gm"].time
    np.testing.assert_allclose(time, 1.0 + np.arange(60) / 30.0)
    other = _csv(tmp_path / "other.csv", "frame,force", ["1,2.0", "2,3.0"])
    with pytest.raises(InputError, match="missing column time_s"):
        inspect([other])
