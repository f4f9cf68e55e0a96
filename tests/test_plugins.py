"""Models, readers and devices of other distributions, found where they are installed."""

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.model import MODELS, ModelOptions
from surae.recording.programs.foreign import optional

SOURCE = '''
from dataclasses import replace

import numpy as np

from surae.measures import Definition
from surae.model import MODELS
from surae.protocol import Device
from surae.quality import Check, Finding
from surae.recording.table import sample
from surae.recording.table import Column, Table

MODEL = replace(MODELS["muscle"], name="ours", title="a model of ours")
ROBOT = Device("slow-robot", max_velocity=0.2)
WRONG = Device("another")


class TwoColumns:
    """Lines `angle torque`, a hundred a second, behind a line of its own."""

    ENDINGS = (".two",)

    def recognises(self, source):
        return source.head()[:1] == ["two columns"]

    def open_table(self, source):
        rows = np.array([line.split() for line in list(source.lines())[1:]], dtype=float)
        time = np.arange(len(rows)) / 100.0
        names = ("angle_deg", "torque_Nm")

        def load(wanted):
            return {
                n: Column(n, time, rows[:, names.index(n)], "row", sample) for n in wanted
            }

        return Table(source.shown, "two columns", names, "row", load)


READER = TwoColumns()


def slack_span(leg, _):
    """Angle between the slack angles of both groups.

    Ours.
    """
    return leg.angle_of("tri", leg.values["x0_tri"]) - leg.angle_of("tib", leg.values["x0_tib"])


MEASURE = Definition("slack_span", "deg", slack_span, is_angle=True)


def long(trial):
    yield Finding("too-long", "info", None, 0.0, 9.0, None, "", "It is long.", "Cut it.")


CHECK = Check(("too-long",), long)
'''
#: Loaded with the parameters: it imports the records that it is made of, and nothing else of surae.
DRAG = """
from operator import attrgetter

from surae.model.parameter import Added, Parameter
from surae.model.source import Fill, Gaussian, Nuisance, UncertaintySource

DRAG = UncertaintySource(
    "drag", "drag of a cable", "what the cable of a load cell pulls", "lay the cable otherwise",
    Fill("ink", "|"),
    Nuisance("drag", ("cable_drag",), Gaussian(0.0, 0.5), "Nm·s/rad", "assumed", departs=True),
    adds=(Parameter("cable_drag", "Nm·s/rad", "drag of a cable", "measurement", 0.0, -5.0, 5.0,
                    False, True, "lay the cable otherwise", straight=True,
                    torque=Added("joint", attrgetter("velocity"))),),
)
"""
POINTS = """
[surae.models]
ours = ours_of_a_laboratory:MODEL
broken = no_such_module:MODEL

[surae.readers]
two = ours_of_a_laboratory:READER

[surae.measures]
slack_span = ours_of_a_laboratory:MEASURE

[surae.sources]
drag = drag_of_a_cable:DRAG

[surae.checks]
too-long = ours_of_a_laboratory:CHECK

[surae.devices]
slow-robot = ours_of_a_laboratory:ROBOT
mismatch = ours_of_a_laboratory:WRONG
wrong = ours_of_a_laboratory:MODEL
"""


@pytest.fixture
def laboratory(tmp_path, monkeypatch) -> Path:
    """A distribution as pip would leave it, in a folder on the path."""
    folder = tmp_path / "site"
    (folder / "ours-1.0.dist-info").mkdir(parents=True)
    (folder / "ours-1.0.dist-info" / "METADATA").write_text("Name: ours\nVersion: 1.0\n")
    (folder / "ours-1.0.dist-info" / "entry_points.txt").write_text(POINTS)
    (folder / "ours_of_a_laboratory.py").write_text(SOURCE)
    (folder / "drag_of_a_cable.py").write_text(DRAG)
    path = os.pathsep.join(filter(None, (str(folder), os.environ.get("PYTHONPATH"))))
    monkeypatch.setenv("PYTHONPATH", path)
    return folder


def python(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        cwd=folder,
    )


def shell(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return python(
        f"import sys; sys.argv = {['surae', *words]!r}\nfrom surae.cli import main; main()", folder
    )


def test_a_model_is_simulated_and_a_broken_one_is_a_line(laboratory, tmp_path) -> None:
    (tmp_path / "in.csv").write_text(
        "time_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V\n"
        + "".join(f"{n / 100},{0.1 * n / 100},1,0,0,0,0\n" for n in range(300))
    )
    values = {p.name: p.start for p in MODELS["muscle"].parameters}
    (tmp_path / "p.json").write_text(json.dumps({"parameters": values}))
    done = shell(
        tmp_path,
        "simulate",
        "in.csv",
        "--model",
        "ours",
        "--parameters",
        "p.json",
        "--output",
        "out.csv",
    )
    assert done.returncode == 0, done.stderr
    assert [line for line in done.stderr.splitlines() if "left out" in line] == [
        "surae: broken is left out of surae.models: ModuleNotFoundError: No module named "
        "'no_such_module'"
    ]
    torque = surae.read(tmp_path / "out.csv").channels["torque"].values
    muscle = surae.simulate("muscle", values, tmp_path / "in.csv")
    np.testing.assert_allclose(torque, muscle, rtol=1e-12)


def test_a_measure_and_a_check_stand_beside_ours(laboratory, tmp_path) -> None:
    code = (
        "import surae; from surae.measures import measures_of_values\n"
        "leg = surae.virtual_subject(seed=1).parameters\n"
        "print('slack_span' in measures_of_values(leg, 'muscle'))\n"
        "print('too-long' in [f.code for f in surae.check(surae.example()).findings])"
    )
    done = python(code, tmp_path)
    assert done.stdout.split() == ["True", "True"], done.stderr


def test_a_source_of_uncertainty_brings_its_torque_and_its_prior(laboratory, tmp_path) -> None:
    code = (
        "import surae; from surae.model import laboratory\n"
        "print('drag' in laboratory.DEPARTURES)\n"
        "trial = surae.prepare(surae.example())\n"
        "leg = dict(surae.virtual_subject(seed=1).parameters)\n"
        "one, other = (surae.simulate('muscle-tendon', {**leg, **more}, trial)\n"
        "              for more in ({}, {'cable_drag': 2.0}))\n"
        "print(float(abs(other - one - 2.0 * trial.velocity).max()) < 1e-9)"
    )
    done = python(code, tmp_path)
    assert done.stdout.split() == ["True", "True"], done.stderr


def test_a_reader_reads_its_files_and_no_others(laboratory, tmp_path) -> None:
    (tmp_path / "leg.two").write_text("two columns\n" + "10 2.5\n20 3.5\n" * 100)
    (tmp_path / "leg.csv").write_text("time_s,angle_rad\n0,1\n0.01,2\n")
    code = (
        "from surae.cli import group; from surae.recording.formats import data_files\n"
        "print([p.name for p in data_files('.')])\n"
        "for file in ('leg.csv', 'leg.two'): group.main(['inspect', file], standalone_mode=False)"
    )
    done = python(code, tmp_path)
    assert done.returncode == 0, done.stderr
    files, said = done.stdout.split("\n", 1)
    assert files == "['leg.csv', 'leg.two']"
    of_csv, ours = said.split("two columns", 1)
    assert "CSV" in of_csv
    assert "torque_Nm" in ours


def test_a_device_limits_a_protocol_and_wrong_ones_are_left_out(laboratory, tmp_path) -> None:
    code = (
        "import sys, contextlib; from surae.cli import main\n"
        "for device in ('slow-robot', 'hercules'):\n"
        "    sys.argv = ['surae', 'protocol', 'sine', '--output', 'p.csv', '--device', device]\n"
        "    with contextlib.suppress(SystemExit): main()"
    )
    complaints = python(code, tmp_path).stderr.splitlines()
    time, angle = np.loadtxt(tmp_path / "p.csv", delimiter=",", skiprows=1, usecols=(0, 1)).T
    assert np.abs(np.diff(angle) / np.diff(time)).max() <= 0.2 * (1 + 1e-6)
    left_out = "surae: {} is left out of surae.devices: {}"
    assert left_out.format("mismatch", "ValueError: it calls itself 'another'") in complaints
    assert left_out.format("wrong", "TypeError: it is no Device") in complaints
    assert "use one of: achilles, slow-robot" in complaints[-1]


def test_help_loads_no_plugin(laboratory, tmp_path) -> None:
    (laboratory / "ours_of_a_laboratory.py").write_text("raise SystemExit(77)")
    assert shell(tmp_path, "fit", "--help").returncode == 0
    assert shell(tmp_path, "fit", "none.csv", "--model", "muscle").returncode == 2


FAULTY = """
import sys
from surae.measures import Definition
from surae.quality import Check, Finding


def raises(leg, _):
    raise TypeError("it does not know this leg")


def ends(trial):
    sys.exit(7)


MEASURE = Definition("slack_span", "deg", raises, is_angle=True)
CHECK = Check(("too-long",), ends)
"""
OF_ONE = "[surae.{}]\n{} = faulty:{}\n"


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Install a distribution by its entry points and the module that they name."""
    folder = tmp_path / "site"
    folder.mkdir()
    path = os.pathsep.join(filter(None, (str(folder), os.environ.get("PYTHONPATH"))))
    monkeypatch.setenv("PYTHONPATH", path)

    def install(name, points, source=FAULTY, module="faulty"):
        (folder / f"{name}-1.0.dist-info").mkdir()
        (folder / f"{name}-1.0.dist-info" / "METADATA").write_text(f"Name: {name}\nVersion: 1.0\n")
        (folder / f"{name}-1.0.dist-info" / "entry_points.txt").write_text(points)
        (folder / f"{module}.py").write_text(source)

    return install


@pytest.fixture
def trial(tmp_path):
    done = shell(tmp_path, "example", "trial.csv")
    assert done.returncode == 0, done.stderr
    return "trial.csv"


@pytest.mark.parametrize("ending", ["raise SystemExit(3)", "import sys; sys.exit()", "1 / 0"])
def test_a_plugin_that_ends_the_program_when_it_is_loaded_is_a_line(
    installed, tmp_path, trial, ending
):
    installed("ours", OF_ONE.format("checks", "too-long", "CHECK"), ending)
    done = shell(tmp_path, "check", trial)
    assert done.returncode == 0, done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith("surae: too-long is left out of surae.checks: ")
    assert done.stdout


def test_a_plugin_whose_function_ends_the_program_is_named(installed, tmp_path, trial):
    installed("ours", OF_ONE.format("checks", "too-long", "CHECK"))
    done = shell(tmp_path, "check", trial)
    (line,) = done.stderr.splitlines()
    assert line.startswith(
        "surae: the plugin too-long (surae.checks of ours) failed (SystemExit: 7)"
    )
    assert done.returncode == 1


def test_a_plugin_whose_function_fails_is_named(installed, tmp_path):
    installed("ours", OF_ONE.format("measures", "slack_span", "MEASURE"))
    code = (
        "import sys, surae.cli, surae\n"
        "from surae.measures import measures_of_values\n"
        "leg = surae.virtual_subject(seed=1).parameters\n"
        "def main(*a, **k): measures_of_values(leg, 'muscle')\n"
        "surae.cli.group.main = main\n"
        "surae.cli.main()"
    )
    done = python(code, tmp_path)
    (line,) = done.stderr.splitlines()
    assert line.startswith(
        "surae: the plugin slack_span (surae.measures of ours) failed (TypeError"
    )
    assert done.returncode == 1


def test_two_of_one_name_are_said(installed, tmp_path, trial):
    quiet = "from surae.quality import Check\nCHECK = Check(('too-long',), lambda _: iter(()))\n"
    installed("ours", OF_ONE.format("checks", "too-long", "CHECK"), quiet)
    points = "[surae.checks]\ntoo-long = other:CHECK\n[surae.commands]\nserve = other:command\n"
    installed("theirs", points, quiet, "other")
    done = shell(tmp_path, "check", trial)
    (line,) = done.stderr.splitlines()
    assert "is left out: there is another of its name" in line
    served = shell(tmp_path, "serve", "--help")
    assert "surae serve of theirs is left out" in served.stderr
    assert served.stdout.startswith("Usage: surae serve")


def test_what_numba_refuses_is_one_line(tmp_path, trial, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", "0")
    done = shell(tmp_path, "fit", trial)
    (line,) = done.stderr.splitlines()
    assert "NUMBA_NUM_THREADS=0" in line
    assert done.returncode == 2


def test_an_integrator_that_nobody_has_is_refused() -> None:
    with pytest.raises(InputError, match="runge"):
        ModelOptions(integrator="runge")


@pytest.mark.parametrize(
    "old", ["surae_cohort", "surae_exchange", "surae_formats", "surae_nerve", "surae_posterior"]
)
def test_an_import_of_what_is_part_of_surae_now_says_where(old) -> None:
    with pytest.raises(ImportError, match=rf"{old} is part of surae: use surae\.") as told:
        importlib.import_module(old)
    home = str(told.value).partition("modules are in ")[2].partition(" ")[0]
    assert importlib.import_module(home).__doc__


def test_a_format_whose_library_is_not_there_says_what_to_install() -> None:
    with pytest.raises(
        InputError, match=r'^trial.c3d: C3D needs .* pip install "surae\[formats\]"$'
    ):
        optional("no_such_library", "C3D", "trial.c3d")
