"""The block bootstrap: known standard errors, the same numbers every time, and going on."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import surae
from surae.assessment import assess
from surae.assessment.resampling.bootstrap import block_length, bootstrap, draw_blocks
from surae.errors import InputError
from surae.estimation import fit_problem, make_problem
from surae.frozen import read_only

LINEAR = ("m", "g1", "g2", "g3", "g4")


def correlated(rng, n, rho):
    drive = np.sqrt(1 - rho**2) * rng.standard_normal(n + 1000)
    return lfilter([1], [1, -rho], drive)[1000:]


def fitted_to(clean, subject, noise, weight=None, **more):
    fixed = {name: value for name, value in subject.parameters.items() if name not in LINEAR}
    trial = replace(clean, torque=read_only(clean.torque + noise), weight=weight)
    return fit_problem(make_problem([trial], fixed=fixed, **more), starts=1)


@pytest.fixture(scope="module")
def slow_noise(clean, subject):
    return fitted_to(clean, subject, correlated(np.random.default_rng(1), clean.n, 0.8))


def test_blocks_of_white_noise_are_single_samples():
    rng = np.random.default_rng(0)
    assert np.median([block_length(rng.standard_normal(4000)) for _ in range(20)]) <= 2


def test_blocks_grow_with_the_correlation():
    lengths = [
        block_length(correlated(np.random.default_rng(2), 20_000, rho)) for rho in (0.5, 0.9, 0.97)
    ]
    # The closed form of the method for a first-order process.
    for rho, length in zip((0.5, 0.9, 0.97), lengths, strict=True):
        optimum = (6 * (rho / (1 - rho**2)) ** 2) ** (1 / 3) * 20_000 ** (1 / 3)
        assert length == pytest.approx(optimum, rel=0.5)


def test_blocks_of_what_never_changes():
    assert block_length(np.zeros(100)) == 1
    assert block_length(np.full(100, 3.0)) == 1


def test_drawn_blocks_are_whole_and_go_round():
    drawn = draw_blocks(np.arange(10.0), 4, np.random.default_rng(0))
    assert len(drawn) == 10
    for begin in (0, 4, 8):
        block = drawn[begin : begin + 4]
        np.testing.assert_array_equal(np.diff(block) % 10, 1)


def test_white_noise_gives_the_standard_errors_of_the_thesis(clean, subject):
    result = fitted_to(clean, subject, np.random.default_rng(3).standard_normal(clean.n))
    found, known = bootstrap(result, replicates=300), assess(result).parameters
    for name in LINEAR:
        p = found.parameters[name]
        assert p.sem == pytest.approx(known[name].sem, rel=0.2)
        assert p.ci95 == pytest.approx(known[name].ci95, abs=0.6 * known[name].sem)
    assert found.failed == found.missing == found.resumed == 0
    assert found.values.shape == (300, 5)


def test_correlated_noise_widens_them(slow_noise):
    found, known = bootstrap(slow_noise, replicates=300), assess(slow_noise).parameters
    for name in LINEAR[1:]:
        assert found.parameters[name].sem == pytest.approx(known[name].sem_robust, rel=0.3)
        assert found.parameters[name].sem > 1.5 * known[name].sem


def test_weighted_samples_keep_their_precision(clean, subject):
    weight = np.where(np.arange(clean.n) % 2, 4.0, 1.0)
    weight[1000:1200] = 0.0
    noise = np.random.default_rng(4).standard_normal(clean.n) / np.sqrt(np.maximum(weight, 1e-2))
    result = fitted_to(clean, subject, noise, read_only(weight))
    found, known = bootstrap(result, replicates=300), assess(result).parameters
    for name in LINEAR:
        assert found.parameters[name].sem == pytest.approx(known[name].sem, rel=0.2)


def test_a_prior_is_drawn_too(clean, subject):
    noise = np.random.default_rng(5).standard_normal(clean.n)
    prior = {"g2": (subject.parameters["g2"], 1e-3)}
    result = fitted_to(clean, subject, noise, priors=prior)
    p = bootstrap(result, replicates=150).parameters["g2"]
    assert p.sem == pytest.approx(assess(result).parameters["g2"].sem, rel=0.25)


def test_the_same_numbers_for_any_number_of_workers(slow_noise):
    one = bootstrap(slow_noise, replicates=24, seed=7, workers=1)
    four = bootstrap(slow_noise, replicates=24, seed=7, workers=4)
    other = bootstrap(slow_noise, replicates=24, seed=8)
    np.testing.assert_array_equal(one.values, four.values)
    assert not np.array_equal(one.values, other.values)


def test_a_stopped_bootstrap_goes_on(slow_noise, tmp_path):
    store = tmp_path / "b.replicates"
    whole = bootstrap(slow_noise, replicates=50, seed=1)

    def stop(done, total):
        if done >= 10:
            raise KeyboardInterrupt

    part = bootstrap(slow_noise, replicates=50, seed=1, workers=1, store=store, progress=stop)
    assert 0 < part.missing <= 40
    rest = bootstrap(slow_noise, replicates=50, seed=1, store=store)
    assert (rest.resumed, rest.missing) == (50 - part.missing, 0)
    np.testing.assert_array_equal(rest.values, whole.values)
    assert rest.parameters == whole.parameters
    again = bootstrap(slow_noise, replicates=20, seed=1, store=store)
    assert (again.resumed, again.missing, len(again.values)) == (20, 0, 20)
    more = bootstrap(slow_noise, replicates=52, seed=1, store=store)
    assert (more.resumed, len(more.values)) == (50, 52)
    np.testing.assert_array_equal(more.values[:50], whole.values)


def test_replicates_of_another_bootstrap_are_refused(slow_noise, tmp_path):
    store = tmp_path / "b.replicates"
    bootstrap(slow_noise, replicates=2, seed=1, store=store)
    for changes in ({"seed": 2}, {"seed": 1, "block_s": 0.5}):
        with pytest.raises(InputError, match="bootstrap of another fit or other settings"):
            bootstrap(slow_noise, replicates=2, store=store, **changes)


@pytest.mark.parametrize("content", ["something else\n", "no line at all" * 100, "[1]\n"])
def test_another_file_is_left_alone(slow_noise, tmp_path, content):
    store = tmp_path / "notes.txt"
    store.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=r"notes\.txt is not a store of surae"):
        bootstrap(slow_noise, replicates=2, store=store)
    assert store.read_text(encoding="utf-8") == content


def test_replicates_of_an_older_surae_are_named_as_such(slow_noise, tmp_path):
    store = tmp_path / "b.replicates"
    store.write_text('{"bootstrap": 1, "seed": 0}\n{"replicate": 0, "values": [1]}\n')
    with pytest.raises(InputError, match="as an older surae kept them; remove it or choose"):
        bootstrap(slow_noise, replicates=2, store=store)


def test_few_replicates_give_no_interval(slow_noise):
    p = bootstrap(slow_noise, replicates=5).parameters["m"]
    assert (p.sem, p.ci95) == (None, None)
    assert p.value == slow_noise.values["m"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"replicates": 0}, "replicates is 0"),
        ({"seed": -1}, "seed is -1"),
        ({"workers": 0}, "workers is 0"),
        ({"block_s": 0.0}, "blocks of 0 s"),
        ({"block_s": 30.0}, "at most half"),
        ({"block_s": float("nan")}, "blocks of nan s"),
    ],
)
def test_what_makes_no_sense_is_refused(slow_noise, changes, message):
    with pytest.raises(InputError, match=message):
        bootstrap(slow_noise, **({"replicates": 2} | changes))


def test_the_public_function_and_its_file(slow_noise, tmp_path):
    fit = surae.Fit(slow_noise, assess(slow_noise))
    found = surae.bootstrap(fit, replicates=45, block_s=0.4)
    assert found.block_s == (0.4,)
    found.save(tmp_path / "b.json")
    data = json.loads((tmp_path / "b.json").read_text(encoding="utf-8"))
    assert list(data["parameters"]) == list(LINEAR)
    assert data["parameters"]["m"]["ci95"] == list(found.parameters["m"].ci95)
    assert data["block_s"] == [0.4]
