"""The store: what is in it stays, whatever is asked of it, and only one run writes."""

import os
import re
import sqlite3
import subprocess
import sys
from contextlib import closing
from dataclasses import replace

import pytest

from surae.base.errors import ComputationError, InputError
from surae.base.records import to_plain
from surae.studies.store import Store, export_study, study_columns, study_table
from surae.studies.study import parse_study
from surae.studies.tasks import TaskEstimate, TaskOutcome

TEXT = 'name = "a"\nprotocol = "sine"\nnoise = [0.01, 0.05]\nsubjects = 2\n'
DONE = TaskOutcome(
    "converged", "all well", 99.9, 3.1, (TaskEstimate("m", 0.1 + 0.2, 1e-17, 2.0),), 0.5
)
LOST = TaskOutcome("failed", "its worker died")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "s.db"


def keep(store, outcomes) -> None:
    store.add([(key, to_plain(outcome)) for key, outcome in outcomes])


def fill(path, text=TEXT, outcome=DONE, most=99):
    with Store(path, write=True) as store:
        keys = list(store.plan(parse_study(text)))[:most]
        keep(store, [(key, outcome) for key in keys])
        store.end("finished")
    return keys


def test_what_is_kept_comes_back_to_the_last_bit(path) -> None:
    keys = fill(path)
    assert len(keys) == 4
    with Store(path) as store:
        rows = list(store.rows())
        status = store.status()
    assert [outcome for _, outcome in rows] == [DONE] * 4
    assert rows[0][0]["noise"] == 0.01
    assert (status.name, status.rows, status.calls, status.done) == ("a", 4, 4, 4)
    assert (status.running, status.last) == (None, "finished")


def test_a_changed_study_asks_only_for_what_is_new(path) -> None:
    fill(path)
    with Store(path, write=True) as store:
        assert store.plan(parse_study(TEXT)) == {}
        wider = store.plan(parse_study(TEXT.replace("0.01, 0.05", "0.05, 0.1")))
        assert {task.noise for task in wider.values()} == {0.1}
        assert len(wider) == 2
        assert (store.status().calls, store.status().done) == (4, 2)
        assert store.plan(parse_study(TEXT)) == {}  # and back again


def test_another_study_is_refused(path) -> None:
    fill(path)
    with (
        Store(path, write=True) as store,
        pytest.raises(InputError, match="holds the study 'a', not 'b'"),
    ):
        store.plan(parse_study(TEXT.replace('"a"', '"b"')))
    with Store(path) as store:
        assert store.text() == TEXT


def test_tasks_without_a_fit_can_be_forgotten(path) -> None:
    fill(path, outcome=LOST, most=1)
    fill(path, most=1)
    with Store(path, write=True) as store:
        assert store.status().reasons == {"its worker died": 1}
        assert store.forget_failed() == 1
        assert len(store.plan(parse_study(TEXT))) == 3


def test_several_outcomes_are_kept_together_or_not_at_all(path) -> None:
    keys = fill(path, most=1)
    with Store(path, write=True) as store:
        others = list(store.plan(parse_study(TEXT)))
        with pytest.raises(ComputationError, match="UNIQUE"):
            keep(store, [(others[0], DONE), (keys[0], DONE)])
        assert store.status().done == 1


def test_only_one_run_writes(path) -> None:
    fill(path)
    with Store(path, write=True) as store:
        store.plan(parse_study(TEXT))
        with pytest.raises(InputError, match=r"in use by another run \(process \d+ on "):
            Store(path, write=True)
        with Store(path) as reader:  # while others may look
            running = reader.status().running
        assert running is not None
        assert running.added == 0
    with Store(path, write=True):
        pass


def test_the_lock_goes_with_its_process(path) -> None:
    code = (
        "import os, signal, sys\nfrom surae.studies.store import Store\n"
        "from surae.studies.study import parse_study\n"
        "s = Store(sys.argv[1], write=True); s.plan(parse_study(sys.argv[2]))\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    done = subprocess.run([sys.executable, "-c", code, path, TEXT], check=False, timeout=60)
    assert done.returncode == -9
    with Store(path) as store:
        assert store.status().last.startswith("stopped without a word")
    fill(path)


def test_files_that_are_no_store(path, tmp_path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        Store(path)
    path.write_text("not a database, but long enough to be looked at\n" * 50)
    for write in (False, True):
        with pytest.raises(InputError, match="is not a store of surae"):
            Store(path, write=write)
    assert path.read_text().startswith("not a database")
    other = tmp_path / "other.db"
    with sqlite3.connect(other) as file:
        file.execute("CREATE TABLE t (a)")
    file.close()
    for write in (False, True):
        with pytest.raises(InputError, match="is not a store"):
            Store(other, write=write)
    (tmp_path / "empty.db").touch()
    with pytest.raises(InputError, match="is not a store"):
        Store(tmp_path / "empty.db")
    with pytest.raises(InputError, match="there is no folder"):
        Store(tmp_path / "no" / "s.db", write=True)


def test_a_store_of_a_newer_surae_is_refused(path) -> None:
    fill(path)
    file = sqlite3.connect(path)
    file.execute("PRAGMA user_version = 99")
    file.close()
    with pytest.raises(InputError, match="written by a newer surae"):
        Store(path)


def test_a_store_older_than_all_that_are_known_is_told_so(path) -> None:
    fill(path)
    with closing(sqlite3.connect(path)) as file:
        file.execute("PRAGMA user_version = 0")
    with pytest.raises(InputError, match=r"written by an older surae \(layout 0, this one reads 2"):
        Store(path)


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE TRIGGER t AFTER INSERT ON result BEGIN DELETE FROM result; END",
        "CREATE VIEW v AS SELECT 1",
        "CREATE TABLE more (a)",
        "ALTER TABLE plan ADD COLUMN more",
        "CREATE INDEX i ON plan (key)",
    ],
)
@pytest.mark.parametrize("write", [False, True])
def test_a_strangers_programs_are_refused(path, statement, write) -> None:
    fill(path)
    with closing(sqlite3.connect(path)) as file, file:
        file.execute(statement)
    with pytest.raises(InputError, match="holds tables or programs that are not surae's"):
        Store(path, write=write)


@pytest.mark.parametrize("end", [".lock", "-wal", "-shm"])
def test_links_beside_a_store_lead_nowhere(path, tmp_path, end) -> None:
    (tmp_path / "elsewhere").mkdir()
    other = tmp_path / "elsewhere" / "file"
    path.with_name(path.name + end).symlink_to(other)
    with pytest.raises(InputError, match=f"s.db{end} is a link"):
        Store(path, write=True)
    assert not other.exists()


def test_without_its_lock_s_file_the_later_run_takes_over(path) -> None:
    with Store(path, write=True) as first:
        tasks = list(first.plan(parse_study(TEXT)))
        keep(first, [(tasks[0], DONE)])
        path.with_name("s.db.lock").unlink()
        with Store(path, write=True) as second:
            rest = list(second.plan(parse_study(TEXT)))
            assert len(rest) == 3
            with pytest.raises(ComputationError, match="taken over by another run"):
                keep(first, [(tasks[1], DONE)])
            keep(second, [(key, DONE) for key in rest])
    with Store(path) as store:
        assert store.status().done == 4


def test_one_bad_row_is_one_bad_row(path) -> None:
    keys = fill(path)
    with closing(sqlite3.connect(path)) as file, file:
        for key, value in zip(keys, ("{", '{"status": 1}', '[{"é": []}]'), strict=False):
            file.execute("UPDATE result SET value = ? WHERE key = ?", (value, key))
        file.execute("UPDATE result SET finished = 'never' WHERE key = ?", (keys[3],))
    with Store(path) as store:
        assert [outcome for _, outcome in store.rows()] == [DONE]
        assert store.status().done == 4
    with Store(path, write=True) as store:  # what is damaged is computed again
        assert set(store.plan(parse_study(TEXT))) == set(keys[:3])


def test_a_damaged_store_is_told(path) -> None:
    text = TEXT.replace("subjects = 2", "subjects = 500")
    fill(path, text, most=10_000)
    data = bytearray(path.read_bytes())
    results = [place.start() // 4096 for place in re.finditer(b"all well", data)]
    for page in set(results[400:420]):
        data[page * 4096 : (page + 1) * 4096] = os.urandom(4096)
    path.write_bytes(data)
    with pytest.raises(ComputationError, match="restore it from a copy"), Store(path) as store:
        list(store.rows())


def test_a_store_without_a_study(path) -> None:
    Store(path, write=True).close()
    with Store(path) as store, pytest.raises(InputError, match="holds no study yet"):
        store.status()


def test_the_table_has_its_columns_in_order(path) -> None:
    study = parse_study(TEXT + 'model = ["muscle", "muscle-tendon-toe"]\ngeometry = "thesis"\n')
    names = study_columns(study)
    assert names[:3] == ["protocol", "chirp_amplitude", "chirp_rate"]
    start = names.index("status")
    assert names[start - 1] == "geometry"
    assert names[start : start + 6] == ["status", "vaf", "ipde", "m", "m_sem", "m_true"]
    assert names[-4:] == ["pt_tib", "pt_tib_sem", "pt_tib_true", "seconds"]
    assert len(names) == start + 3 + 3 * 17 + 1
    assert "pt_tri" not in study_columns(parse_study(TEXT))


def test_missing_numbers_are_empty_cells(path, tmp_path) -> None:
    fill(
        path,
        outcome=replace(DONE, ipde=None, estimates=(TaskEstimate("m", 0.3, None, 2.0),)),
        most=1,
    )
    fill(path, outcome=LOST, most=1)
    with Store(path) as store:
        assert export_study(store, tmp_path / "t.csv")[0] == 2
        names = list(next(study_table(store)))
    lines = (tmp_path / "t.csv").read_text().splitlines()
    assert lines[0].split(",") == names
    fitted, lost = (dict(zip(names, line.split(","), strict=True)) for line in lines[1:])
    assert (fitted["status"], fitted["vaf"], fitted["ipde"]) == ("converged", "99.9", "")
    assert (fitted["m"], fitted["m_sem"], fitted["m_true"]) == ("0.3", "", "2.0")
    assert (lost["status"], lost["vaf"], lost["m"], lost["m_true"]) == ("failed", "", "", "")
