"""The search of `auto` never ends where its own simplest member would be better, and says so."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_limits
from toys import STABLE, disturbed, moved

import surae
from ankle_legs.make import make, truth_of
from marks import slow
from promises import HOLD, keeps_the_promise, with_known_arms
from richer_legs import richer_leg
from surae.base.frozen import read_only
from surae.inference import Verdict, assess, make_problem, solve
from surae.inference.posterior import search
from surae.inference.posterior.look_back import explained

#: By how much less of the torque's changes `auto` may follow than model 1.0 [% of R²].
LESS = 0.5
#: Evaluations of a search where it was 62, and 220 before kinks were round and descents rested.
MOST = 80
#: Part of what is called identified that is true: that all of it is would be decided by chance.
TRUE = 0.95


def raw_leg(folder: Path, family: str, seed: int, every: int = 1, *, seconds: float = 20.0) -> Path:
    """A recording with raw EMG of which one sample in `every` at 1024 Hz is kept."""
    path = make(family, seed, folder, (1,), raw=True, seconds=seconds)[0]
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join([*lines[:2], *lines[2::every]]), encoding="utf-8")
    return path


def test_slow_raw_emg_is_followed_as_by_the_simplest_model(tmp_path) -> None:
    path = raw_leg(tmp_path, "a", 46, 4)
    plain, whole = (surae.fit(path, model=m, quality=()) for m in ("muscle", "auto"))
    assert whole.adequacy.r2 >= plain.adequacy.r2 - LESS
    assert whole.status == "converged"


def test_a_search_that_lost_its_way_says_so_and_claims_nothing(monkeypatch) -> None:
    choose = search.choose

    def lost(family, values, noise):
        chosen = choose(family, values, noise)
        z = chosen.mode.z.copy()
        z[chosen.posterior.names.index("k_tri")] += np.log(2.0)
        return replace(chosen, mode=replace(chosen.mode, z=z))

    monkeypatch.setattr(search, "choose", lost)
    result = solve(make_problem([richer_leg(0, rate_hz=64.0, duration=12.0).inputs], "auto"))
    assert result.status == "failed"
    assert "lost its way" in result.message
    worth = assess(result)
    assert worth.adequacy.reasons == ("the fit failed",)
    assert not any(p.verdict is Verdict.IDENTIFIED for p in worth.parameters.values())


@pytest.mark.parametrize(
    ("part", "held"),
    [(0.02, True), slow(0.0, True), slow(0.0, False), slow(0.02, False)],
)
def test_what_carries_no_signal_brings_nothing_in(part: float, held: bool) -> None:
    """A dead electrode, its weight fixed at 0 as `check` advises or not, is as good as none."""
    one = richer_leg(0, rate_hz=64.0, duration=12.0).inputs
    emg = one.emg.copy()
    emg[:, 3] = 0.0
    none = replace(one, emg=read_only(emg.copy()), missing_emg=("gm",))
    noise = np.abs(np.random.default_rng(0).normal(1.0, 0.1, one.n))
    emg[:, 3] = part * emg.mean(axis=0).max() * noise
    dead = replace(one, emg=read_only(emg))
    without = solve(make_problem([none], "auto", fixed={"g4": 0.0}))
    beside = solve(make_problem([dead], "auto", fixed={"g4": 0.0} if held else {}))
    assert beside.solution.beliefs.keys() == without.solution.beliefs.keys()
    sd = dict(zip(without.problem.free, np.sqrt(np.diag(without.solution.covariance)), strict=True))
    for name in without.problem.free:
        assert abs(beside.values[name] - without.values[name]) < 0.1 * sd[name], name
    assert beside.problem.inputs == (dead,)


@pytest.mark.parametrize(("family", "seed"), [("g", 41), ("c", 2001)])
def test_a_search_takes_few_evaluations(family, seed, tmp_path) -> None:
    """Counts are the same on every machine but for rounding; seconds are not.

    Of c every other step was tried whole, and rose, where the one before had had to be shortened.
    """
    inputs = surae.prepare(surae.read(make(family, seed, tmp_path, (1,))[0]))
    fit = solve(make_problem([inputs], "auto"))
    assert fit.status == "converged"
    assert fit.solution.evaluations <= MOST
    assert "come to rest" not in fit.message


def two_ends(*case: object):
    """A leg whose search has two ends, 0.1 apart in −2 ln p: a tendon just taut, or crosstalk.

    Of j and n only the point moves at which the tibialis's tendon is taut, by 0.13 and 0.15
    standard deviations.
    """
    return pytest.param(*case, marks=pytest.mark.xfail(reason="two ends", strict=True))


#: Legs, and of raw EMG how many samples at 1024 Hz there are to one that is kept.
LEGS = [
    ("a", 931, 0),
    ("b", 50, 0),
    ("c", 40, 0),
    ("e", 3721, 0),
    ("f", 3701, 0),
    ("g", 41, 0),
    ("h", 46, 0),
    two_ends("j", 3721, 0),
    ("o", 3721, 0),
    ("r", 3721, 0),
    ("t", 3721, 0),
    ("u", 3721, 0),
    ("a", 3721, 1),
    ("b", 3721, 1),
    ("m", 3721, 1),
    two_ends("n", 3721, 2),
    ("v", 3721, 3),
    ("h", 4503, 4),
    ("w", 3721, 4),
    two_ends("a", 3714, 5),
]


@pytest.mark.parametrize(("family", "least", "most"), [("j", 0.1, 0.2), slow("a", 0.0, 0.05)])
def test_errors_of_drives_are_as_great_as_they_are(family, least, most, tmp_path) -> None:
    """Weights do not run away with them (one was 3.3 times too large), nor are they made up."""
    (path,) = make(family, 2402, tmp_path, (1,))
    result = solve(make_problem([surae.prepare(surae.read(path))], "auto"))
    assert least <= result.solution.sizes["drive"] <= most
    g1 = truth_of(family, 2402, 1)["parameters"]["g1"]
    assert result.values["g1"] == pytest.approx(g1, rel=0.3)


@pytest.mark.long
@pytest.mark.parametrize(("family", "there"), [("t", "damper"), slow("e", "bridges")])
def test_noise_of_raw_emg_is_no_error_of_the_drives(family, there, tmp_path) -> None:
    """Such errors of next to no size let drift and softening run away, and hid short ranges."""
    (path,) = make(family, 4951, tmp_path, (1,), raw=True)
    result = solve(make_problem([surae.prepare(surae.read(path))], "auto"))
    assert result.solution.sizes["drive"] == 0.0
    assert result.solution.sizes["softening"] < 0.1
    assert there in result.solution.candidates[0].groups


@pytest.mark.slow
def test_raw_emg_identifies_as_much_as_envelopes(tmp_path) -> None:
    """Of the same legs: twenty of the last count (of ten of 4951 it was 12 to 14).

    As if arms and paths were known: what they take of the claims they take of both. They are not
    known of these legs, so that truth is asked of what is said by default.
    """
    claimed, held, true = {False: 0, True: 0}, [], []
    for family in "abcdefghijkmnoprtuvw":
        truth = truth_of(family, 4974, 1)["parameters"]
        for raw in claimed:
            (path,) = make(family, 4974, tmp_path / str(raw), (1,), raw=raw)
            fit = surae.fit(path, quality=())
            for name, own in with_known_arms(fit).parameters.items():
                claimed[raw] += own.verdict == "identified" and truth.get(name) is not None
            for name, own in fit.parameters.items() if raw else ():
                if own.ci95 and truth.get(name) is not None:
                    held.append(own.ci95[0] <= truth[name] <= own.ci95[1])
                    true += [held[-1]] if own.verdict == "identified" else []
    assert claimed[True] >= 0.9 * claimed[False] > 0
    assert keeps_the_promise(sum(held), len(held), HOLD)
    assert keeps_the_promise(sum(true), len(true), TRUE)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed", "every"), LEGS)
def test_values_are_of_the_data_and_not_of_the_path(
    family: str, seed: int, every: int, tmp_path
) -> None:
    """The seventh digit moves nothing, nor does the number of threads."""
    if every:
        path = raw_leg(tmp_path, family, seed, every, seconds=35.0)
    else:
        path = make(family, seed, tmp_path, (1,))[0]
    inputs = surae.prepare(surae.read(path))
    one = solve(make_problem([inputs], "auto"))
    assert moved(one, solve(make_problem([disturbed(inputs)], "auto"))) < STABLE
    with threadpool_limits(2):
        assert solve(make_problem([inputs], "auto")).values == one.values


@pytest.mark.slow
def test_the_order_of_columns_and_of_trials_moves_nothing(tmp_path) -> None:
    paths = make("a", 46, tmp_path, (1, 2), seconds=20.0)
    trials = [surae.prepare(surae.read(path)) for path in paths]
    table = paths[0].with_suffix(".csv")
    comment, header = table.read_text(encoding="utf-8").splitlines()[:2]
    columns = np.loadtxt(table, delimiter=",", skiprows=2)
    turned = f"{comment}\n{','.join(header.split(',')[::-1])}"
    np.savetxt(table, columns[:, ::-1], "%.8g", ",", header=turned, comments="", encoding="utf-8")
    again = surae.prepare(surae.read(paths[0]))
    for signal in ("angle", "torque", "emg"):
        np.testing.assert_array_equal(getattr(again, signal), getattr(trials[0], signal))
    one, other = (solve(make_problem(order, "auto")) for order in (trials, trials[::-1]))
    assert moved(one, other) < STABLE


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["joint", "film", "population"])
def test_every_search_looks_back(kind: str, tmp_path) -> None:
    """Several trials, a film, and what is known of a population: it is the same search."""
    trials = (1, 2) if kind == "joint" else (1,)
    paths = make("a", 46, tmp_path, trials, raw=True, film=kind == "film", seconds=20.0)
    for path in paths:  # at 256 Hz, where latents took the torque over
        table = path.with_suffix(".csv")
        lines = table.read_text(encoding="utf-8").splitlines(keepends=True)
        table.write_text("".join([*lines[:2], *lines[2::4]]), encoding="utf-8")
    known = {"population": "healthy"} if kind == "population" else {}
    whole = surae.fit(paths, quality=(), **known)
    plain = surae.fit(paths, model="muscle", quality=(), **known)
    assert whole.status == "converged"
    assert whole.adequacy.r2 >= plain.adequacy.r2 - LESS


def test_samples_that_do_not_count_are_not_explained() -> None:
    inputs = richer_leg(0, rate_hz=64.0, duration=12.0).inputs
    half = np.arange(inputs.n) < inputs.n // 2
    torque = inputs.torque
    residual = np.where(half, 0.0, torque)
    weighted = replace(inputs, weight=half.astype(float))
    assert explained([weighted], [residual]) == 1.0
    assert explained([inputs], [torque - torque.mean()]) == pytest.approx(0.0)
    assert explained([inputs], [np.full(inputs.n, np.nan)]) == -np.inf
