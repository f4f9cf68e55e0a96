"""What is on disk while streams arrive: read by others, whole after any end, at most the last
chunk lost."""

import errno
import os

import numpy as np
import pytest
import pyxdf
from streaming import described

from surae.recording import read
from surae_workbench.live.xdf import XdfLog, mended_xdf


def written(path, *, chunks: int = 20, offset: float = 0.5) -> np.ndarray:
    """A stream of 100 Hz in pieces of 10 samples, and words; returns the values."""
    values = np.random.default_rng(1).standard_normal((chunks * 10, 2))
    log = XdfLog(path)
    log.stream(1, described("robot", {"angle": "rad", "torque": "Nm"}, 100.0))
    log.stream(2, described("words", {"w": ""}, 0.0, "string"))
    for i in range(chunks):
        stamps = 7.0 + (np.arange(10) + 10 * i) / 100.0
        log.samples(1, stamps, values[10 * i : 10 * i + 10])
        log.clock(1, stamps[-1] + offset, offset)
    log.words(2, [7.5], [["é ok"]])
    log.mark()
    log.sync()
    log.close()
    return values


def test_pyxdf_reads_what_was_written(tmp_path) -> None:
    values = written(tmp_path / "a.xdf")
    streams, _ = pyxdf.load_xdf(tmp_path / "a.xdf", dejitter_timestamps=False)
    robot, words = streams
    np.testing.assert_array_equal(robot["time_series"], values)
    np.testing.assert_allclose(robot["time_stamps"], 7.5 + np.arange(200) / 100.0, atol=1e-9)
    assert words["time_series"] == [["é ok"]]


def test_a_file_that_broke_off_anywhere_is_mended_to_its_last_whole_chunk(tmp_path) -> None:
    values = written(tmp_path / "a.xdf")
    whole = (tmp_path / "a.xdf").read_bytes()
    assert mended_xdf(tmp_path / "a.xdf") == 0
    torn = tmp_path / "torn.xdf"
    for end in np.random.default_rng(2).integers(900, len(whole) - 60, 8):
        torn.write_bytes(whole[:end])
        cut = mended_xdf(torn)
        assert 0 <= cut < 300  # less than a chunk of 10 samples
        streams, _ = pyxdf.load_xdf(torn, dejitter_timestamps=False)
        kept = streams[0]["time_series"]
        np.testing.assert_array_equal(kept, values[: len(kept)])


@pytest.mark.parametrize("content", [b"", b"XD", b"time_s,angle_rad\n0,0\n", b"\0" * 500])
def test_what_is_no_xdf_is_left_as_it_is(tmp_path, content) -> None:
    (tmp_path / "trial-01.xdf").write_bytes(content)
    assert mended_xdf(tmp_path / "trial-01.xdf") == 0
    assert (tmp_path / "trial-01.xdf").read_bytes() == content


def test_damage_before_the_end_costs_nothing_behind_it(tmp_path) -> None:
    written(tmp_path / "a.xdf")
    whole = bytearray((tmp_path / "a.xdf").read_bytes())
    whole[1500:1510] = b"\xff" * 10
    (tmp_path / "a.xdf").write_bytes(whole)
    assert mended_xdf(tmp_path / "a.xdf") == 0
    assert (tmp_path / "a.xdf").read_bytes() == whole


def test_a_full_disk_leaves_whole_chunks_and_goes_on_where_there_is_room(tmp_path, monkeypatch):
    log = XdfLog(tmp_path / "a.xdf")
    log.stream(1, described("robot", {"angle": "rad"}, 100.0))
    room = [40]
    write = os.write

    def full(file: int, data: bytes) -> int:
        if room[0] <= 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        done = write(file, data[: room[0]])
        room[0] -= done
        return done

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(OSError, match="No space"):
        log.samples(1, np.arange(10) / 100.0, np.ones((10, 1)))
    room[0] = 10**6
    log.samples(1, np.arange(10, 20) / 100.0, np.ones((10, 1)))
    log.close()
    assert mended_xdf(tmp_path / "a.xdf") == 0
    streams, _ = pyxdf.load_xdf(tmp_path / "a.xdf", dejitter_timestamps=False)
    np.testing.assert_allclose(streams[0]["time_stamps"], np.arange(10, 20) / 100.0)


def two_clocks(path, *, drift: float, jitter: float, seconds: float = 60.0) -> None:
    """One pulse train on two streams, the second's clock drifting and its stamps jittering."""
    rng = np.random.default_rng(3)
    log = XdfLog(path)
    log.stream(1, described("device", {"angle": "rad"}, 1000.0))
    log.stream(2, described("amplifier", {"torque": "Nm"}, 2000.0))
    for i in range(round(seconds * 50)):
        for number, rate in ((1, 1000.0), (2, 2000.0)):
            t = 5000.0 + i / 50 + np.arange(round(rate / 50)) / rate
            signal = np.sin(2 * np.pi * 0.5 * t)[:, None]
            stamps = t
            if number == 2:  # its clock was 40 s behind at 5000, and loses `drift`
                stamps = (t - 5000.0) * (1.0 - drift) + 4960.0 + jitter * rng.uniform()
            log.samples(number, stamps, signal)
        if i % 250 == 0:
            now = 5000.0 + i / 50
            theirs = (now - 5000.0) * (1.0 - drift) + 4960.0
            log.clock(2, now, now - theirs + 1e-4 * rng.standard_normal())
            log.clock(1, now, 1e-5 * rng.standard_normal())
    log.close()


def test_drifting_and_jittering_clocks_are_aligned(tmp_path) -> None:
    two_clocks(tmp_path / "a.xdf", drift=100e-6, jitter=0.02)
    (tmp_path / "map.toml").write_text(
        '[channels.angle]\ncolumn = "device: angle"\n[channels.torque]\n'
        'column = "amplifier: torque"\nunit = "Nm"\n',
        encoding="utf-8",
    )
    recording = read(tmp_path / "a.xdf", mapping=tmp_path / "map.toml")
    angle, torque = recording.channels["angle"], recording.channels["torque"]
    inside = (torque.time > 1) & (torque.time < 59)
    # Where each sample of the one lies on the other: the phase of the sine they share.
    shift = torque.values - np.interp(torque.time, angle.time, angle.values)
    slope = np.gradient(np.interp(torque.time, angle.time, angle.values), torque.time)
    steep = inside & (np.abs(slope) > 2.0)
    late = -shift[steep] / slope[steep]
    late -= 0.01  # stamps of which each comes up to 20 ms late are 10 ms late on average
    assert np.abs(late).max() < 1.5e-3
    assert abs(np.median(late[: len(late) // 4]) - np.median(late[-len(late) // 4 :])) < 1e-3
