import pytest

from surae.base.database import lock
from surae.base.errors import InputError
from surae_thesis.section import Context

CALLS = []


def plain(x):
    return [x, abs(x)]


def square(x):
    CALLS.append(x)
    return {"square": x * x}


def fails_at_two(x):
    if x == 2:
        raise KeyboardInterrupt
    CALLS.append(x)
    return x


@pytest.fixture
def context(tmp_path) -> Context:
    CALLS.clear()
    return Context(folder=tmp_path)


def test_what_is_kept_is_not_computed_again(context) -> None:
    jobs = {"a": {"x": 1}, "b": {"x": 2}}
    assert context.calls("s", square, jobs) == {"a": {"square": 1}, "b": {"square": 4}}
    again = context.calls("s", square, {"b": {"x": 2}, "c": {"x": 3}})
    assert again == {"b": {"square": 4}, "c": {"square": 9}}
    assert CALLS == [1, 2, 3]


def test_a_stopped_run_keeps_what_was_finished(context) -> None:
    jobs = {str(x): {"x": x} for x in (0, 1, 2)}
    with pytest.raises(KeyboardInterrupt):
        context.calls("s", fails_at_two, jobs)
    context.calls("s", fails_at_two, {"0": {"x": 0}, "1": {"x": 1}})
    assert CALLS == [0, 1]


def test_progress_starts_where_the_last_run_ended(tmp_path) -> None:
    told = []
    context = Context(folder=tmp_path, progress=lambda *what: told.append(what))
    context.calls("s", square, {"a": {"x": 1}})
    context.calls("s", square, {"a": {"x": 1}, "b": {"x": 2}})
    assert told == [("s", 0, 1), ("s", 1, 1), ("s", 1, 2), ("s", 2, 2)]


def test_two_runs_do_not_write_one_store(context) -> None:
    held = lock(context.store("s"))
    try:
        with pytest.raises(InputError, match="in use by another run"):
            context.calls("s", square, {"a": {"x": 1}})
    finally:
        held.close()


def test_processes_give_the_same(tmp_path) -> None:
    jobs = {"-1": {"x": -1}, "2": {"x": 2}, "3": {"x": 3}}
    context = Context(folder=tmp_path, workers=2)
    assert context.calls("s", plain, jobs) == {"-1": [-1, 1], "2": [2, 2], "3": [3, 3]}
