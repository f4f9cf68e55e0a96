"""The store: what is in it stays, whatever is asked of it, and only one run writes."""

import sqlite3
import subprocess
import sys
from dataclasses import replace

import pytest

from surae.errors import ComputationError, InputError
from surae.studies.store import Store
from surae.studies.study import parse_study
from surae.studies.table import columns, export, table
from surae.studies.tasks import Estimate, Outcome

TEXT = 'name = "a"\nprotocol = "sine"\nnoise = [0.01, 0.05]\nsubjects = 2\n'
DONE = Outcome("converged", "all well", 99.9, 3.1, (Estimate("m", 0.1 + 0.2, 1e-17, 2.0),), 0.5)
LOST = Outcome("failed", "its worker died")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "s.db"


def fill(path, text=TEXT, outcome=DONE, most=99):
    with Store(path, write=True) as store:
        keys = list(store.plan(parse_study(text)))[:most]
        store.begin()
        store.add([(key, outcome) for key in keys])
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
    assert (status.name, status.rows, status.fits, status.done) == ("a", 4, 4, 4)
    assert (status.running, status.last) == (None, "finished")


def test_a_changed_study_asks_only_for_what_is_new(path) -> None:
    fill(path)
    with Store(path, write=True) as store:
        assert store.plan(parse_study(TEXT)) == {}
        wider = store.plan(parse_study(TEXT.replace("0.01, 0.05", "0.05, 0.1")))
        assert {task.noise for task in wider.values()} == {0.1}
        assert len(wider) == 2
        assert (store.status().fits, store.status().done) == (4, 2)
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
            store.add([(others[0], DONE), (keys[0], DONE)])
        assert store.status().done == 1


def test_only_one_run_writes(path) -> None:
    fill(path)
    with Store(path, write=True) as store:
        store.begin()
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
        "s = Store(sys.argv[1], write=True); s.plan(parse_study(sys.argv[2])); s.begin()\n"
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
        with pytest.raises(InputError, match="is not a store of surae's studies"):
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


def test_a_store_without_a_study(path) -> None:
    Store(path, write=True).close()
    with Store(path) as store, pytest.raises(InputError, match="holds no study yet"):
        store.status()


def test_the_table_has_its_columns_in_order(path) -> None:
    study = parse_study(TEXT + 'model = ["muscle", "muscle-tendon-toe"]\ngeometry = "thesis"\n')
    names = columns(study)
    assert names[:3] == ["protocol", "chirp_amplitude", "chirp_rate"]
    start = names.index("status")
    assert names[start - 1] == "geometry"
    assert names[start : start + 6] == ["status", "vaf", "ipde", "m", "m_sem", "m_true"]
    assert names[-3:] == ["pt_tib", "pt_tib_sem", "pt_tib_true"]
    assert len(names) == start + 3 + 3 * 17
    assert "pt_tri" not in columns(parse_study(TEXT))


def test_missing_numbers_are_empty_cells(path, tmp_path) -> None:
    fill(path, outcome=replace(DONE, ipde=None, estimates=(Estimate("m", 0.3, None, 2.0),)), most=1)
    fill(path, outcome=LOST, most=1)
    with Store(path) as store:
        assert export(store, tmp_path / "t.csv") == 2
        names = list(next(table(store)))
    lines = (tmp_path / "t.csv").read_text().splitlines()
    assert lines[0].split(",") == names
    fitted, lost = (dict(zip(names, line.split(","), strict=True)) for line in lines[1:])
    assert (fitted["status"], fitted["vaf"], fitted["ipde"]) == ("converged", "99.9", "")
    assert (fitted["m"], fitted["m_sem"], fitted["m_true"]) == ("0.3", "", "2.0")
    assert (lost["status"], lost["vaf"], lost["m"], lost["m_true"]) == ("failed", "", "", "")


def test_parquet_holds_the_same(path, tmp_path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    fill(path, outcome=replace(DONE, ipde=None))
    with Store(path) as store:
        assert export(store, tmp_path / "t.parquet") == 4
        rows = list(table(store))
    assert parquet.read_table(tmp_path / "t.parquet").to_pylist() == rows


def test_without_pyarrow_parquet_is_refused_kindly(path, tmp_path, monkeypatch) -> None:
    fill(path)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with Store(path) as store, pytest.raises(InputError, match=r"pip install 'surae\[formats\]'"):
        export(store, tmp_path / "t.parquet")
    assert not (tmp_path / "t.parquet").exists()
