"""Several profiles at a time: the same numbers, kept when stopped, and written."""

import json
import os
import signal
import sys
import threading
import time

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.sampling.one_profile import profile
from surae.sampling.profiles import profiles

NAMES = ("m", "f0", "l0_tib", "g1")


def same(one, other):
    assert one.interval == other.interval
    assert one.message == other.message
    for field in ("values", "sse", "chi2"):
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field))
    np.testing.assert_equal(one.along, other.along)


@pytest.mark.slow
def test_the_numbers_do_not_depend_on_the_workers(fitted):
    told = []
    found = [profiles(fitted, NAMES, workers=k) for k in (1, 3)]
    found.append(profiles(fitted, NAMES[::-1], workers=2, progress=lambda *a: told.append(a)))
    for name in NAMES:
        alone = profile(fitted, name)
        for some in found:
            same(some[name], alone)
    assert [list(some.profiles) for some in found] == [list(NAMES)] * 2 + [list(NAMES[::-1])]
    assert found[0].missing == ()
    assert sorted(name for name, _, _ in told) == sorted(NAMES)
    assert [(done, total) for _, done, total in told] == [(k, 4) for k in (1, 2, 3, 4)]


@pytest.mark.parametrize("workers", [1, 2])
def test_what_is_complete_is_kept_when_the_caller_is_interrupted(fitted, workers):
    def progress(name, done, total):
        raise KeyboardInterrupt

    found = profiles(fitted, NAMES, workers=workers, progress=progress)
    assert len(found.profiles) >= 1
    assert set(found.profiles) | set(found.missing) == set(NAMES)
    assert len(found.missing) >= 1
    for name, one in found.profiles.items():
        same(one, profile(fitted, name))


@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_ends_it_soon(fitted, workers, monkeypatch):
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT))
    first = threading.Lock()

    def begun(*arguments, **options):  # the time runs from the first profile, however late that is
        if first.acquire(blocking=False):
            timer.start()
        return profile(*arguments, **options)

    monkeypatch.setattr(sys.modules[profiles.__module__], "profile", begun)
    begin = time.process_time()  # its own, whatever else the computer does
    try:
        found = profiles(fitted, workers=workers)
    finally:
        timer.cancel()
    assert time.process_time() - begin < 2.0
    assert set(found.profiles) | set(found.missing) == set(fitted.problem.free)
    assert len(found.missing) >= 8


def test_all_by_default(decided):
    assert tuple(decided.profiles) == ("a", "b")
    assert decided.model == "toy"


@pytest.fixture(scope="module")
def decided():
    from toys import linear, toy_fit

    x = np.linspace(0, 1, 50)
    noise = 0.1 * np.random.default_rng(1).standard_normal(50)
    bounds = {"a": (-9.0, 9.0), "b": (-9.0, 1.05)}
    fit = toy_fit(linear(np.column_stack([np.ones(50), x])), x + noise, {"a": 0, "b": 1.0}, bounds)
    return profiles(fit, workers=2)


def test_the_file_holds_everything(decided, tmp_path):
    decided.save(tmp_path / "p.json")
    data = json.loads((tmp_path / "p.json").read_text(encoding="utf-8"))
    assert data["model"] == "toy"
    assert data["missing"] == []
    for name, one in decided.profiles.items():
        kept = data["profiles"][name]
        assert kept["grid"] == one.values.tolist()
        assert kept["delta_chi2"] == one.chi2.tolist()
        assert kept["interval"] == list(one.interval)
        assert kept["open"] == list(one.reasons)
        assert kept["others"] == {n: path.tolist() for n, path in one.along.items()}
    assert data["profiles"]["b"]["interval"][1] is None
    assert "upper bound" in data["profiles"]["b"]["open"][1]


def test_an_inflation_of_its_own_for_each(fitted):
    plain = profiles(fitted, ["m", "g1"])
    wide = profiles(fitted, ["m", "g1"], variance_inflation={"m": 4.0})
    assert wide["m"].sem == pytest.approx(2 * plain["m"].sem)
    same(wide["g1"], plain["g1"])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"names": ["m", "m"]}, "m is given twice"),
        ({"names": ["nonsense"]}, "no parameter 'nonsense'"),
        ({"names": []}, "nothing to profile; choose from: m, k_tri"),
        ({"names": ["m"], "workers": 0}, "workers is 0"),
        ({"names": ["m"], "variance_inflation": -1.0}, "variance inflation is -1.0"),
        ({"names": ["m"], "variance_inflation": {"x": 1.0}}, "no parameter 'x'"),
    ],
)
def test_what_is_refused(fitted, given, message):
    with pytest.raises(InputError, match=message):
        profiles(fitted, **given)
