"""A batch of many: a plan that grows with its recordings, tables by piece, places, a cluster."""

import time
from functools import partial
from pathlib import Path

import pytest

from surae import FitSettings, InputError
from surae_thesis.batch.files import NamedTrial
from surae_thesis.batch.pieces import write_pieces
from surae_thesis.batch.places import check_place, keep, keep_folder
from surae_thesis.batch.plan import Batch, Calls
from surae_thesis.batch.table import RELAXED, fit_columns, fit_rows, relaxed_rows

SETTINGS = {("1.0", ""): FitSettings(model="muscle"), ("auto", ""): FitSettings()}
READ = {"mapping": None, "corrections": "{}"}


def planned(subjects: int, **more: object) -> Batch:
    """A plan of five recordings of each subject."""
    trials = tuple(
        NamedTrial(f"S{s}", "holds", r, f"S{s}/holds_{r}.csv")
        for s in range(subjects)
        for r in range(1, 6)
    )
    return Batch(trials, SETTINGS, READ, **more)


def seconds(subjects: int) -> float:
    """Of the planning of so many, every call made once."""
    begin = time.process_time()
    batch = planned(subjects)
    for label in batch.labels():
        batch.call(label)
    return time.process_time() - begin


def test_a_plan_takes_as_long_as_it_is() -> None:
    few = min(seconds(100) for _ in range(3))
    many = min(seconds(1600) for _ in range(2))
    assert many < 16 * few * 2.5  # 256 times as long where every recording asks all others


def test_a_call_is_of_the_subject_alone() -> None:
    batch = planned(3, place="fits")
    labels = list(batch.labels())
    assert [label["kind"] for label in labels].count("fit") == 30
    label = next(each for each in labels if each["kind"] == "fit" and each["model"] == "auto")
    made = Calls(batch, {"key": label})["key"]
    assert made["function"] == "fit_job"
    assert set(made["keywords"]["others"]) == {f"S0 holds {r}" for r in range(2, 6)}
    assert made["keywords"]["kept"] == ["fits", "S0/holds-1.auto.fit.json"]
    assert "kept" not in batch.call(label)[1]  # what is known stays known in another folder


def test_sessions_are_calls_of_all_recordings_of_a_subject() -> None:
    batch = planned(2, sessions=True)
    labels = list(batch.labels())
    assert [(each["kind"], each["subject"], each["model"]) for each in labels] == [
        ("session", subject, model) for subject in ("S0", "S1") for model in ("1.0", "auto")
    ]
    function, keywords = batch.call(labels[0])
    assert function == "session_job"
    assert batch.paths(keywords) == [f"S0/holds_{r}.csv" for r in range(1, 6)]


def outcomes(count: int) -> list[tuple[dict[str, object], dict[str, object]]]:
    """Fits of so many recordings, the odd ones with a measure more."""
    made = []
    for i in range(count):
        about = {"subject": f"S{i}", "protocol": "holds", "repetition": 1, "path": f"{i}"}
        p = {"value": 2.0 + i, "sem": 0.1, "ci95": [1.0, 3.0], "verdict": "weak"}
        measures = {"torque_rise": [1.0 * i, 0.5, None, "weak"]} if i % 2 else {}
        fit = {"status": "converged", "parameters": {"m": p}, "measures": measures, "file": "f"}
        curve = [[-5.0, 1.0, 0.1, 0.2, 0.01], [0.0, 2.0, 0.1, 0.2, 0.01]]
        made.append(({"kind": "trial", **about}, {"relaxed": curve}))
        made.append(({"kind": "fit", **about, "model": "auto", "fixed": ""}, fit))
    return made


def test_a_table_is_written_by_piece_and_a_piece_once(tmp_path, monkeypatch) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("surae_thesis.batch.pieces.ROWS", 4)
    some = outcomes(6)
    columns = fit_columns(some)

    def write(rows: int) -> set[Path]:
        every = partial(fit_rows, some[: 2 * rows], columns)
        assert write_pieces(tmp_path, "table", columns, every) == rows
        return set((tmp_path / "table.parquet").iterdir())

    first = write(5)
    second = write(6)
    assert len(first) == len(second) == 2
    assert len(first & second) == 1  # the piece that was whole is the same file
    table = parquet.read_table(tmp_path / "table.parquet").to_pydict()
    assert table["m"] == [2.0 + i for i in range(6)]
    assert table["torque_rise"] == [None, 1.0, None, 3.0, None, 5.0]
    lines = (tmp_path / "table.csv").read_text().splitlines()
    assert len(lines) == 7
    write_pieces(tmp_path, "relaxed", RELAXED, partial(relaxed_rows, some))
    curves = parquet.read_table(tmp_path / "relaxed.parquet").to_pydict()
    assert curves["angle_deg"] == [-5.0, 0.0] * 6


@pytest.mark.parametrize("remote", [False, True])
def test_files_and_folders_are_kept_whole(tmp_path, remote) -> None:
    if remote:
        pytest.importorskip("fsspec")
    place = check_place(f"{'file://' if remote else ''}{tmp_path}/kept")
    at = keep([place, "S1/a.json"], lambda path: path.write_text("1") and None)
    assert at == f"{place}/S1/a.json"
    assert (tmp_path / "kept/S1/a.json").read_text() == "1"

    def fill(folder: Path) -> None:
        (folder / "deep").mkdir(exist_ok=True)
        (folder / "deep" / "b.json").write_text("2")

    keep_folder([place, "S1/auto"], fill)
    assert (tmp_path / "kept/S1/auto/deep/b.json").read_text() == "2"


def test_a_place_that_cannot_be_opened_is_refused() -> None:
    pytest.importorskip("fsspec")
    with pytest.raises(InputError, match="cannot open nowhere://there"):
        check_place("nowhere://there")
