"""Files that Hypothesis makes of a leg's trial: what changes nothing, and what somebody spoils.

What says the same otherwise (units, order, names of columns that nobody asks for, another time of
day) is answered the same by `check`, `inspect` and `relaxed`. What is damaged is refused in one
line or answered; nothing of it is lost, and nothing false is identified.
"""

import json
import re
from dataclasses import dataclass

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import surae
from surae.base.errors import InputError
from surae.cli import group
from surae.protocol import Protocol, generate
from surae.studies import virtual_recording, virtual_subject

RATE = 1024.0
#: Units of a signal: its name in a heading, and how many of it one of SI's is.
UNITS = {
    "time": {"s": 1.0, "ms": 1e3},
    "angle": {"rad": 1.0, "deg": np.degrees(1.0)},
    "torque": {"Nm": 1.0, "mNm": 1e3},
    "emg": {"V": 1.0, "mV": 1e3, "uV": 1e6},
}


@pytest.fixture(scope="module")
def legs():
    """A relaxed trial and one with effort, each as columns in SI."""
    made = {}
    for task in ("passive", "active"):
        protocol = Protocol(
            profile="multiple-holds",
            task=task.replace("passive", "part-passive"),
            duration=12.0,
            rate_hz=2048.0,
        )
        path = generate(protocol)
        recording = virtual_recording(virtual_subject(7), path, seed=3)
        one = recording.channels["angle"]
        keep = slice(None, None, max(round(one.rate_hz / RATE), 1))
        made[task] = {
            "time": np.round(one.time[keep], 6),
            **{role: channel.values[keep] for role, channel in recording.channels.items()},
        }
    return made


@dataclass(frozen=True)
class Written:
    """How a trial is written down, which tells nothing of the leg."""

    order: tuple[int, ...]
    units: tuple[str, str, str, str]
    later: float
    unused: tuple[str, ...]
    comment: str
    end: str


WRITTEN = st.builds(
    Written,
    st.permutations(range(7)).map(tuple),
    st.tuples(*(st.sampled_from(sorted(known)) for known in UNITS.values())),
    st.sampled_from([0.0, 5.0, 3600.0]),
    st.lists(
        st.sampled_from(["sample", "trigger_V", "room_C", "note"]), max_size=2, unique=True
    ).map(tuple),
    st.sampled_from(["", "# written by a laboratory\n"]),
    st.sampled_from(["\n", "\r\n"]),
)
PLAIN = Written(tuple(range(7)), ("s", "rad", "Nm", "V"), 0.0, (), "", "\n")


def as_csv(columns, how: Written) -> str:
    """A trial as the text of a file."""
    names = list(columns)
    units = dict(zip(UNITS, how.units, strict=True))
    heads, values = [], []
    for at in how.order:
        kind = names[at].partition("_")[0]
        heads.append(f"{names[at]}_{units[kind]}")
        shifted = columns[names[at]] + (how.later if kind == "time" else 0.0)
        values.append(shifted * UNITS[kind][units[kind]])
    for k, name in enumerate(how.unused):
        heads.insert(k, name)
        values.insert(k, np.arange(len(columns["time"])) % 7)
    rows = [",".join(f"{v:.10g}" for v in row) for row in zip(*values, strict=True)]
    return how.comment + how.end.join([",".join(heads), *rows]) + how.end


def answers(path) -> tuple[list, list, dict]:
    """What three cheap doors say of a file."""
    found = surae.check(path).findings
    codes = sorted((f.code, f.severity, f.channel or "") for f in found)
    roles = sorted(surae.read(path).channels)
    try:
        measures = surae.relaxed(path).measures
    except InputError as error:
        said = re.sub(r"\S*trial\S*", "", str(error))
        return codes, roles, {"refused": (said.partition(":")[0], 0.0, "")}
    told = {
        name: (m.value, m.ci95[1] - m.ci95[0] if m.ci95 else None, str(m.verdict))
        for name, m in measures.items()
    }
    return codes, roles, told


#: The same examples every time, and none made smaller: the suite has an end that is known.
QUIET = {
    "deadline": None,
    "suppress_health_check": list(HealthCheck),
    "derandomize": True,
    "database": None,
    "phases": (Phase.explicit, Phase.generate),
}


@pytest.mark.parametrize(
    "task",
    [
        pytest.param("passive", marks=pytest.mark.slow),
        pytest.param("active", marks=pytest.mark.slow),
    ],
)
def test_what_says_the_same_otherwise_is_answered_the_same(legs, task, tmp_path) -> None:
    path = tmp_path / "trial.csv"
    path.write_text(as_csv(legs[task], PLAIN), newline="")
    codes, roles, told = answers(path)

    @given(how=WRITTEN)
    @settings(max_examples=6, **QUIET)
    def same(how) -> None:
        path.write_text(as_csv(legs[task], how), newline="")
        other_codes, other_roles, other = answers(path)
        assert (other_codes, other_roles) == (codes, roles)
        assert other.keys() == told.keys()
        for name, (value, width, verdict) in told.items():
            assert other[name][2] == verdict, name
            if isinstance(value, float) and width:
                assert abs(other[name][0] - value) < 1e-3 * width, name

    same()


LINE = st.integers(0, 400)
TEXT = st.sampled_from(
    [
        "",
        "nan",
        "1e999",
        "-",
        "x",
        "1,5",
        '"',
        "\0",
        "é",
        "=cmd|' /C calc'!A0",
        "9" * 400,
        "A" * 2**20,
    ]
)
EDIT = st.one_of(
    st.tuples(st.just("cell"), LINE, st.integers(0, 6), TEXT),
    st.tuples(st.just("drop"), LINE, st.integers(1, 200), st.just("")),
    st.tuples(st.just("twice"), LINE, st.just(0), st.just("")),
    st.tuples(st.just("cut"), st.integers(0, 4000), st.just(0), st.just("")),
    st.tuples(st.just("head"), st.integers(0, 6), st.integers(0, 6), TEXT),
    st.tuples(st.just("scale"), st.integers(0, 6), st.sampled_from([-1, 0, 1000, 57]), st.just("")),
)


def spoilt(text: str, edit) -> str:
    """A file that somebody changed."""
    kind, at, other, to = edit
    lines = text.splitlines()
    if kind == "cut":
        return text[:at]
    cells = [line.split(",") for line in lines]
    row = min(at, len(lines) - 1)
    if kind == "cell":
        cells[row][other] = to
    elif kind == "drop":
        del cells[max(row, 1) : row + other]
    elif kind == "twice":
        cells.insert(row, cells[row])
    elif kind == "head":
        cells[0][at], cells[0][other] = cells[0][other], cells[0][at] if at != other else to
    else:
        for each in cells[1:]:
            each[at] = f"{float(each[at]) * other:.8g}"
    return "\n".join(map(",".join, cells)) + "\n"


@pytest.mark.parametrize(
    "examples", [pytest.param(6, id="few"), pytest.param(20, marks=pytest.mark.slow, id="many")]
)
def test_what_is_spoilt_is_one_line_or_an_answer(legs, examples, tmp_path) -> None:
    path = tmp_path / "trial.csv"
    text = as_csv(legs["passive"], PLAIN)

    @given(edits=st.lists(EDIT, min_size=1, max_size=3))
    @settings(max_examples=examples, **QUIET)
    def holds(edits) -> None:
        made = text
        for edit in edits:
            if made.count("\n") > 3 and all(line.count(",") >= 6 for line in made.splitlines()):
                try:
                    made = spoilt(made, edit)
                except ValueError:  # it is no number any more
                    continue
        path.write_text(made, newline="")
        before = path.read_bytes()
        for words in (["check", str(path), "--json"], ["inspect", str(path)]):
            done = CliRunner().invoke(group, words, standalone_mode=False)
            if done.exception is not None:
                assert isinstance(done.exception, InputError), (words[0], done.exception)
                assert "\n" not in str(done.exception)
                assert len(str(done.exception)) < 2100
            elif words[0] == "check":
                json.loads(done.stdout)
        assert path.read_bytes() == before
        assert [each.name for each in tmp_path.iterdir()] == ["trial.csv"]

    holds()


@pytest.mark.slow
def test_of_a_spoilt_file_nothing_false_is_identified(legs, tmp_path) -> None:
    """Identified is what the whole file says too, within both intervals; or a check stops it."""
    path = tmp_path / "trial.csv"
    text = as_csv(legs["passive"], PLAIN)
    path.write_text(text, newline="")
    whole = surae.relaxed(path).measures

    @given(edits=st.lists(EDIT.filter(lambda e: e[0] != "cut"), min_size=1, max_size=2))
    @settings(max_examples=5, **QUIET)
    def holds(edits) -> None:
        made = text
        for edit in edits:
            try:
                made = spoilt(made, edit)
            except (ValueError, IndexError):
                continue
        path.write_text(made, newline="")
        try:
            stops = [f.code for f in surae.check(path).findings if f.severity != "info"]
            measures = surae.relaxed(path).measures
        except InputError:
            return
        for name, m in measures.items():
            if str(m.verdict) != "identified" or name not in whole or stops:
                continue
            low, high = m.ci95
            other = whole[name].ci95
            assert other is None or (low <= other[1] and other[0] <= high), (name, edits)

    holds()
