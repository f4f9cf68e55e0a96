"""Extremes of floating point end at the border in one line: a wrong unit, or no measurement."""

import subprocess
import sys

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.recording import Channel

COLUMNS = ["time", "angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm"]


def written(path, column=None, factor=1.0, offset=0.0):
    time = np.arange(2000) / 200.0
    rng = np.random.default_rng(1)
    rows = np.column_stack(
        [time, 0.3 * np.sin(time), 5 + np.cos(time), *(1e-4 * rng.standard_normal((4, 2000)))]
    )
    if column is not None:
        place = COLUMNS.index(column)
        with np.errstate(over="ignore"):
            rows[:, place] = rows[:, place] * factor + offset
    units = ["s", "rad", "Nm", "V", "V", "V", "V"]
    head = ",".join(f"{c}_{u}" for c, u in zip(COLUMNS, units, strict=True))
    lines = [",".join(map(repr, map(float, row))) for row in rows]
    path.write_text("\n".join([head, *lines]) + "\n")
    return path


EXTREMES = [
    ("torque", 1e307, "torque is about"),
    ("angle", 1e307, "angle is about"),
    ("emg_sol", 1e308, "emg_sol is about"),
    ("emg_ta", 1e-300, "emg_ta is about"),
    ("torque", 1e-300, "torque is about"),
    ("time", 1e-300, "apart"),
    ("time", 1e-14, "apart"),
    ("time", 1e300, "apart"),
    ("torque", 1e200, "wrong unit"),
]


@pytest.mark.parametrize(("column", "factor", "says"), EXTREMES)
def test_an_extreme_is_refused_in_a_line_that_asks_for_the_unit(
    tmp_path, column, factor, says
) -> None:
    file = written(tmp_path / "a.csv", column, factor)
    with pytest.raises(InputError, match=says) as error:
        surae.check(surae.read(file))
    assert "\n" not in str(error.value)
    assert "a.csv" in str(error.value)


@pytest.mark.slow
def test_no_warning_of_a_library_reaches_the_screen(tmp_path) -> None:
    for number, (column, factor, _) in enumerate(EXTREMES[:6:2]):
        file = written(tmp_path / f"{number}.csv", column, factor)
        for command in ("inspect", "check"):
            made = subprocess.run(
                [sys.executable, "-m", "surae", command, str(file)],
                capture_output=True,
                text=True,
                check=False,
            )
            assert made.returncode in (0, 2), made.stderr
            assert "Warning" not in made.stderr
            assert "Traceback" not in made.stderr
            assert made.stderr.count("\n") <= 1


def test_what_a_laboratory_may_measure_is_taken(tmp_path) -> None:
    for column, factor in (("emg_ta", 1e-2), ("emg_ta", 1e6), ("torque", 0.0), ("emg_sol", 0.0)):
        surae.read(written(tmp_path / "a.csv", column, factor))
    time = np.arange(10) / 10.0
    Channel("fascicle_tib", time, np.full(10, np.nan), "m", "made")
