"""`surae protocol`: the file, the table, the figure, and one clear line for every wrong use."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from surae.planning.torque import requested_limits
from surae.protocol import Protocol, generate, named_device, read_protocol

from .conftest import refused
from .test_startup import imported

BARE = ("--device", "none", "--without-limits", "simulation only")
#: Within what the device has, whoever's leg it is.
GENTLE = ("--task", "passive", "--range", "-0.6:0.2")
HEADER = ["time_s", "angle_rad", "emg_ta", "emg_gl", "emg_sol", "emg_gm"]


def table(path: Path) -> np.ndarray:
    lines = path.read_text(encoding="utf-8").splitlines()
    header, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    assert header == HEADER
    return np.array(rows, dtype=float)


def test_all_settings_reach_the_protocol(run, tmp_path) -> None:
    done = run(
        "protocol",
        "multi-sine-holds",
        "--task",
        "active",
        "--chirp-amplitude",
        "0.1",
        "--chirp-rate",
        "0.3",
        "--range",
        "-0.7:0.4",
        "--duration",
        "20",
        "--rate",
        "128",
        "--device",
        "none",
        "--without-limits",
        "simulation",
        "--output",
        "p.csv",
    )
    assert (done.code, done.err) == (0, "")
    made = generate(
        Protocol(
            profile="multi-sine-holds",
            task="active",
            chirp_amplitude=0.1,
            chirp_rate=0.3,
            angle_range=(-0.7, 0.4),
            duration=20.0,
            rate_hz=128.0,
        )
    )
    expected = np.column_stack([made.time, made.angle, made.effort])
    np.testing.assert_allclose(table(tmp_path / "p.csv"), expected, rtol=1e-11, atol=1e-12)
    assert f"{len(made.time)} samples at 128 Hz" in done.out
    assert "-0.700 to 0.400 rad, 100 % of the range of motion" in done.out


def test_the_table_tells_what_was_adapted(run) -> None:
    done = run(
        "protocol",
        "multiple-holds",
        "--chirp-amplitude",
        "0.2",
        "--device",
        "achilles",
        "--output",
        "p.csv",
    )
    lines = done.out.splitlines()
    assert lines[0] == "multiple-holds, part-passive"
    said = {line[:19].strip(): line[19:] for line in lines[2:] if line}
    assert said["duration"] == "35 s, 8961 samples at 256 Hz"
    assert said["chirp"] == "0.1 rad, 0 to 5.57 Hz"
    assert said["peak velocity"] == "1.5 rad/s"
    assert said["adapted"] == "Chirp lowered from 0.2 to 0.1 rad for achilles."
    assert "the peak velocity falls from 7.41 to 1.5 rad/s." in done.out


def test_the_thesis_s_factor_is_a_rate_of_its_part_by_pi(run) -> None:
    amplitude = ("--chirp-amplitude", "0.2", *BARE)
    run("protocol", "sine", *amplitude, "--chirp-factor", "0.5", "--output", "factor.csv")
    run("protocol", "sine", *amplitude, "--chirp-rate", str(0.5 / np.pi), "--output", "rate.csv")
    assert Path("factor.csv").read_text() == Path("rate.csv").read_text()


def test_what_needs_no_adaptation_says_so(run) -> None:
    done = run("protocol", "sine", *GENTLE, "--output", "p.csv")
    assert "nothing: the device follows it as it is." in done.out
    assert "chirp              none" in done.out
    bare = run("protocol", "sine", *BARE, "--output", "p.csv")
    assert bare.code == 0
    assert "adapted" not in bare.out
    assert Path("p.csv").read_text().startswith("# without limits: simulation only\n")


def test_what_strong_legs_ask_of_the_device_is_given_up_and_said(run, tmp_path) -> None:
    device = named_device("achilles")
    for named in ((), ("--device", "achilles")):
        done = run("protocol", "sine", *named, "--output", "p.csv")
        assert (done.code, done.err) == (0, "")
        assert "rad/s, within the 1.5 rad/s of achilles" in done.out
        assert "Nm, within the 80 Nm of achilles" in done.out
        assert "beyond" not in done.out
        assert "The range ends at −0.90 and 0.54 rad instead of −0.90 and 0.60" in done.out
        assert "Efforts are lowered by 2." in done.out
        made = read_protocol(tmp_path / "p.csv")
        whole = generate(Protocol(profile="sine", device=device))
        judged = replace(made, settings=replace(made.settings, device=device))
        assert not any(limit.exceeded for limit in requested_limits(judged))
        assert made.angle.max() == pytest.approx(0.54, abs=0.01)
        assert 0.9 < made.effort.sum() / whole.effort.sum() < 0.99
        relaxed = ~whole.effort.any(axis=1)
        assert not made.effort[relaxed].any()


def test_what_goes_beyond_the_device_is_not_written(run, tmp_path) -> None:
    unwilling = run("protocol", "sine", "--no-adapt", "--output", "p.csv")
    refused(unwilling, "torque of virtual legs 98.5 Nm at 16.5 s", "80 Nm of achilles")
    weak = 'name = "weak"\nmax_velocity_rad_s = 1.5\nmax_torque_Nm = 8\n'
    (tmp_path / "weak.toml").write_text(weak)
    given = ("protocol", "sine", "--device", "weak.toml", "--output", "p.csv")
    refused(run(*given), "weak has 8 Nm", "even relaxed", "--range")
    assert not (tmp_path / "p.csv").exists()


def test_a_device_of_ones_own(run, tmp_path) -> None:
    (tmp_path / "mine.toml").write_text(
        'name = "mine"\nmax_velocity_rad_s = 0.5\nrange_rad = [-0.5, 0.3]\n'
    )
    done = run("protocol", "multiple-holds", "--device", "mine.toml", "--output", "p.csv")
    assert done.code == 0
    assert "Low-pass filtered" in done.out
    angle = table(tmp_path / "p.csv")[:, 1]
    assert (angle.min(), angle.max()) == pytest.approx((-0.5, 0.3), abs=1e-3)
    assert angle.min() >= -0.5
    assert angle.max() <= 0.3
    given = ("--device", "mine.toml", "--range", "-0.9:0.2", "--output", "q.csv")
    for name in ("multiple-holds", "everything-35"):
        refused(run("protocol", name, *given), "mine reaches -0.5 … 0.3 rad", "--range -0.5:0.2")
    assert not (tmp_path / "q.csv").exists()


def test_a_designed_protocol_is_drawn_and_takes_no_settings_of_profiles(run, tmp_path) -> None:
    done = run("protocol", "passive-20", "--rate", "64", "--output", "p.csv", "--figure", "p.SVG")
    assert done.code == 0
    assert done.out.endswith("protocol: p.csv\nfigure: p.SVG\n")
    assert (tmp_path / "p.SVG").read_bytes().startswith(b"<?xml")
    (tmp_path / "p.csv").unlink()
    for option in (
        ["--duration", "30"],
        ["--task", "active"],
        ["--chirp-amplitude", "0.1"],
        ["--no-adapt"],
    ):
        refused(run("protocol", "passive-20", *option, "--output", "p.csv"), option[0], "designed")
    assert not (tmp_path / "p.csv").exists()


def test_a_matlab_file(run, tmp_path) -> None:
    assert run("protocol", "sine", "--output", "p.mat").code == 0
    assert run("protocol", "sine", "--output", "p.csv").code == 0
    content = loadmat(tmp_path / "p.mat")
    columns = np.hstack([content[name] for name in HEADER])
    np.testing.assert_allclose(columns, table(tmp_path / "p.csv"), rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["zz"], "'zz' is not known; use one of: ramp-and-hold, sine"),
        (["sine", "--device", "zz"], "'zz' is not known; use one of: achilles"),
        (["sine", "--range", "0.6"], "--range 0.6: write LOW:HIGH, e.g. --range -0.9:0.6"),
        (["sine", "--chirp-rate", "0.1", "--chirp-factor", "0.5"], "say the same; give one"),
        (["sine", "--duration", "5"], "use a longer duration"),
        (["sine", "--rate", "0"], "three samples or more"),
        (
            ["sine", "--no-adapt", "--device", "none", "--without-limits", "simulation"],
            "--no-adapt has no effect without",
        ),
        (["sine", "--device", "none"], "nothing is written without the limits of a device"),
        (["sine", "--device", "none", "--without-limits", " "], "nothing is written without"),
        (["sine", "--without-limits", "haste"], "the limits of achilles are kept"),
        (["everything-35", "--task", "active"], "designed as a whole; leave --task out"),
        (["sine", "--output", "p.txt"], "p.txt must end in .csv or .mat"),
        (["sine", "--figure", "p.gif"], "--figure p.gif must end in .svg, .pdf or .png"),
    ],
)
def test_wrong_use(run, tmp_path, arguments, says) -> None:
    given = arguments if "--output" in arguments else [*arguments, "--output", "p.csv"]
    refused(run("protocol", *given), says)
    assert [*tmp_path.iterdir()] == []


@pytest.mark.slow
def test_without_a_figure_no_figure_library_is_imported(tmp_path) -> None:
    assert "matplotlib" not in imported(["protocol", "sine", "--output", "p.csv"], folder=tmp_path)


def test_what_to_measure_after_a_session(run, files) -> None:
    (files / "leg").mkdir()
    (files / "fit.json").rename(files / "leg" / "joint.json")
    given = ("design", "--duration", "12", "--rate", "32", "--evaluations", "5")
    done = run(*given, "--after", "leg", "--output", "next.csv")
    assert (done.code, done.err) == (0, "")
    assert (files / "next.csv").exists()
    refused(run(*given, "--after", "none", "--output", "other.csv"), "none")
