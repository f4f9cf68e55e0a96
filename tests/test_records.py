"""Records as files: what a record declares is all that its file needs."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, make_dataclass
from enum import StrEnum
from typing import Annotated, Literal

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.records import (
    FileName,
    Listed,
    OrInfinite,
    OrNaN,
    from_plain,
    read_toml,
    to_plain,
)
from surae.base.units import FloatArray
from surae.model.joint import read_joint
from surae.protocol.device import read_device


class Grade(StrEnum):
    GOOD = "good"
    BAD = "bad"


@filed(angle="angle_rad", sparse=("sure",))
@dataclass(frozen=True, slots=True)
class Hold:
    angle: float
    sure: bool = True


@filed("recording", hold="held", size="n")
@dataclass(frozen=True, slots=True, eq=False)
class Trial(Comparable):
    path: FileName
    recording: object | None
    hold: Hold | None
    series: FloatArray
    table: Listed
    sse: OrInfinite
    spread: OrNaN
    grade: Grade
    kind: Literal["fit", "hold"] | None
    weights: str | Mapping[str, tuple[float, float]]
    levels: Annotated[tuple[float | None, ...], ("ta", "sol")]
    holds: FrozenDict[str, Hold] = field(default_factory=FrozenDict)
    rounds: int = 0

    @property
    def size(self) -> int:
        return len(self.series)


TRIAL = Trial(
    path="/home/Jane Doe/a.csv",
    recording=None,
    hold=Hold(0.1, sure=False),
    series=read_only([1.0, math.nan, math.inf]),
    table=read_only([[1.0, 2.0]]),
    sse=math.inf,
    spread=math.nan,
    grade=Grade.BAD,
    kind="hold",
    weights={"a": (0.0, 1.0)},
    levels=(0.5, None),
    holds=FrozenDict({"b": Hold(2.0)}),
)


def test_a_record_survives_its_file() -> None:
    plain = json.loads(json.dumps(to_plain(TRIAL), allow_nan=False))
    assert plain["path"] == "a.csv"
    assert plain["held"] == {"angle_rad": 0.1, "sure": False}
    assert plain["holds"] == {"b": {"angle_rad": 2.0}}
    assert plain["table"] == [[1.0, 2.0]]
    assert (plain["sse"], plain["spread"], plain["n"]) == (None, None, 3)
    assert plain["levels"] == {"ta": 0.5, "sol": None}
    assert "recording" not in plain
    again = from_plain(Trial, plain)
    assert again.path == "a.csv"
    assert again == from_plain(Trial, to_plain(again))
    assert {**to_plain(again), "path": ""} == {**to_plain(TRIAL), "path": ""}
    np.testing.assert_array_equal(again.series, TRIAL.series)
    assert not again.series.flags.writeable
    assert isinstance(again.grade, Grade)


def test_a_new_field_needs_nothing_but_itself() -> None:
    names = [("angle", float), ("bend", tuple[Hold, ...], field(default=(Hold(1.0),)))]
    newer = make_dataclass("Newer", names, frozen=True)
    record = newer(angle=0.5, bend=(Hold(3.0), Hold(4.0)))
    assert from_plain(newer, json.loads(json.dumps(to_plain(record)))) == record
    assert from_plain(newer, {"angle": 0.5}) == newer(angle=0.5)  # written before
    assert from_plain(Hold, {"angle_rad": 1.0, "colour": "blue"}) == Hold(1.0)  # or after


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"held": {"angle_rad": "x"}}, "held.angle_rad: 'x' is not a finite number"),
        ({"held": {}}, "held.angle_rad: it is missing"),
        ({"held": 3}, "held: 3 is no table of names and values"),
        ({"held": {"angle_rad": 1, "sure": 1}}, "held.sure: 1 is not true or false"),
        ({"series": {"shape": [3]}}, "series.encoding: it is missing"),
        ({"series": None}, "series: None is no list of numbers"),
        ({"table": [["1"]]}, "table: [['1']] is no list of numbers"),
        ({"sse": True}, "sse: True is not a finite number"),
        ({"grade": "fair"}, "grade: 'fair' is none of: good, bad"),
        ({"kind": "x"}, "kind: 'x' is none of: fit, hold"),
        ({"weights": {"a": [1.0]}}, "weights.a: [1.0] are 1 values, not 2"),
        ({"levels": {"ta": 1.0}}, "levels.sol: it is missing"),
        ({"levels": "ab"}, "levels: 'ab' is no list"),
        ({"holds": {"b": {"angle_rad": None}}}, "holds.b.angle_rad: None is not a finite number"),
        ({"rounds": 1.0}, "rounds: 1.0 is not a whole number"),
        ({"path": 3}, "path: 3 is not a text"),
    ],
)
def test_what_is_wrong_is_named_in_a_line(change, says) -> None:
    with pytest.raises(InputError) as caught:
        from_plain(Trial, to_plain(TRIAL) | change)
    assert str(caught.value) == says


@pytest.mark.parametrize("wrong", [None, 3, [], "x"])
def test_what_is_no_record_at_all(wrong) -> None:
    with pytest.raises(InputError, match="no table of names and values"):
        from_plain(Trial, wrong)


@pytest.mark.parametrize(
    "text",
    [
        "a=" + 5000 * "[" + 5000 * "]",
        "a=" + 200 * "[" + 200 * "]",
        "a=" + 5000 * "9",
        "a=" + 30 * "9",
        "a.=",
        ".".join(40 * "a") + "=1",
        "a='\x01'",
    ],
)
def test_toml_without_an_end_is_refused_in_a_line(text, tmp_path) -> None:
    (tmp_path / "a.toml").write_text(text)
    for read in (read_toml, read_joint, read_device):
        with pytest.raises(InputError) as error:
            read(tmp_path / "a.toml")
        assert "not valid TOML" in str(error.value)
    (tmp_path / "a.toml").write_bytes(b"a='\xff'")
    with pytest.raises(InputError, match=r"a\.toml: "):
        read_toml(tmp_path / "a.toml")
