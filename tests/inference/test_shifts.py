"""What makes estimates unsure, against small matrices that are solved by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from surae.inference.evidence import LaplaceApproximation, Subset, inverse_of, root, subsets
from surae.inference.posterior.laplace import between_subsets, between_trials, dynamics

RNG = np.random.default_rng(5)
V = np.cov(RNG.standard_normal((3, 10)))


def laplace() -> LaplaceApproximation:
    """A quadratic of three parameters, looked at beside its mode."""
    rows = RNG.standard_normal((12, 3))
    residual = RNG.standard_normal(12)
    z, mean, weight = RNG.standard_normal((3, 3))
    return LaplaceApproximation(
        rows.T @ rows, rows.T @ residual, residual @ residual, z, mean, 0.5 + np.abs(weight)
    )


def alone(model: LaplaceApproximation, held: dict[int, float]):
    """Evidence, mode and covariance where some are held, from the quadratic of the others."""
    free = [j for j in range(3) if j not in held]
    z, covariance = model.z.copy(), np.zeros((3, 3))
    z[[*held]] = [*held.values()]
    shift = z - model.z
    gradient = model.gradient + model.information @ shift
    cost = model.cost + shift @ (model.gradient + gradient)
    own = np.ix_(free, free)
    quadratic = LaplaceApproximation(
        model.information[own], gradient[free], cost, z[free], model.mean[free], model.weight[free]
    )
    evidence, z[free], covariance[own] = quadratic.solved()
    return evidence, z, covariance


def test_evidence_against_a_nuisance_is_the_ratio_of_its_densities() -> None:
    """Savage and Dickey's: where it is off, of posterior over prior, all else free."""
    model = laplace()
    whole, mode, covariance = model.solved()
    information = model.information + np.diag(model.weight**2)
    np.testing.assert_allclose(covariance, np.linalg.inv(information))
    slope = model.gradient + model.information @ (mode - model.z)
    np.testing.assert_allclose(slope + model.weight**2 * (mode - model.mean), 0.0, atol=1e-10)
    held, *_ = alone(model, {1: 0.4})
    after = norm.logpdf(0.4, mode[1], np.sqrt(covariance[1, 1]))
    before = norm.logpdf(0.4, model.mean[1], 1.0 / model.weight[1])
    assert held - whole == pytest.approx(-2.0 * (after - before))
    (without, *_) = [s for s in subsets(model, {"b": [1]}, {1: 0.4}) if not s.groups]
    assert without.evidence == pytest.approx(held)
    assert (without.mode[1], without.variance[1]) == (0.4, 0.0)


def test_subsets_are_weighed_by_their_evidence_and_odds() -> None:
    model, off = laplace(), {0: 0.2, 2: 0.1}
    plain = {s.groups: s for s in subsets(model, {"a": [0], "b": [2]}, off)}
    assert set(plain) == {(), ("a",), ("b",), ("a", "b")}
    assert sum(s.weight for s in plain.values()) == pytest.approx(1.0)
    for s in plain.values():
        held = {j: off[j] for g, j in (("a", 0), ("b", 2)) if g not in s.groups}
        evidence, mode, covariance = alone(model, held)
        assert s.evidence == pytest.approx(evidence, rel=1e-12)
        np.testing.assert_allclose(s.mode, mode, rtol=1e-12)
        np.testing.assert_allclose(s.variance, np.diag(covariance), rtol=1e-12)
        ratio = np.exp(0.5 * (plain[()].evidence - s.evidence))
        assert s.weight / plain[()].weight == pytest.approx(ratio)
    likely = {s.groups: s for s in subsets(model, {"a": [0], "b": [2]}, off, {"a": 9.0})}
    before, after = (by[("a",)].weight / by[()].weight for by in (plain, likely))
    assert after == pytest.approx(9.0 * before)


def test_shifts_add_up_to_their_covariance() -> None:
    sd = np.sqrt(np.diag(V))
    np.testing.assert_allclose(root(V, sd).T @ root(V, sd), V)
    thin = np.outer(V[0], V[0])
    assert root(thin, sd).shape == (1, 3)
    np.testing.assert_allclose(root(thin, sd).T @ root(thin, sd), thin)


def test_shifts_lose_nothing_that_is_small_in_its_unit() -> None:
    """A level in volts beside a length in mm: no unit decides what is rounded away."""
    size = np.array([1e-9, 1.0, 1e6])
    of_volts = V * size * size[:, None]
    sd = np.sqrt(np.diag(of_volts))
    shifts = root(of_volts, sd)
    assert len(shifts) == 3
    np.testing.assert_allclose(shifts.T @ shifts, of_volts)
    np.testing.assert_allclose(inverse_of(np.linalg.inv(of_volts)), of_volts, rtol=1e-9)


def subset(weight: float, mode: list[float], variance: list[float]) -> Subset:
    return Subset((), weight, 0.0, np.array(mode), np.array(variance))


def test_what_other_sets_of_departures_say_is_weighed() -> None:
    posterior = SimpleNamespace(names=("b", "c", "a"))
    scored = (
        subset(0.7, [1.0, 2.0], [1.0, 1.0]),
        subset(0.297, [1.3, 1.8], [1.5, 0.5]),
        subset(0.003, [9.0, 9.0], [9.0, 9.0]),
    )
    rows = between_subsets(scored, ("a", "b"), posterior, V)
    # The last is not looked at; of b the other set is surer, which takes nothing away.
    expected = 0.297 * np.array([0.2**2, 0.0, 0.3**2 + 0.5])
    np.testing.assert_allclose(np.sum(rows**2, axis=0), expected, atol=1e-15)
    assert (rows.T @ rows)[0, 2] == pytest.approx(0.297 * 0.3 * -0.2)


def test_trials_differ_by_what_their_pulls_exceed() -> None:
    blocks = [
        SimpleNamespace(g=np.array(g), H=np.diag(h))
        for g, h in (([2.0, 0.1], [1.0, 1.0]), ([-2.0, -0.1], [3.0, 1.0]))
    ]
    assert between_trials(blocks[:1], np.eye(2)).shape == (0, 2)
    rows = between_trials(blocks, np.eye(2))
    # n/(n − 1)·Σ(V·g)² − Σ(V·H·V)ᵢᵢ: 2·8 − 4, and of what agrees nothing.
    np.testing.assert_allclose(np.sum(rows**2, axis=0), [12.0, 0.0])


def bandwidth(values: dict[str, float]) -> float:
    f0, b = values["f0"], 1.0 - 2.0 * values["beta"] ** 2
    return float(f0 * np.sqrt(b + np.sqrt(b**2 + 1.0)))


def test_another_activation_filter_takes_the_other_values_along() -> None:
    def shifts(*, unheard=False, names=("f0", "k_tri", "beta"), has_unheard=False):
        problem = SimpleNamespace(has_unheard=has_unheard)
        return dynamics(SimpleNamespace(names=names, problem=problem), V, 1.1, unheard=unheard)

    order = shifts()
    np.testing.assert_allclose(order[0] / order[0, 0], V[0] / V[0, 0])
    np.testing.assert_allclose(order[1] / order[1, 2], V[2] / V[2, 2])
    assert order[0, 0] == order[1, 2] > 0.0
    released = shifts(names=("f0", "release", "beta"))[0, 0]
    assert order[0, 0] < released <= shifts(unheard=True)[0, 0]
    # of the bandwidth's logarithm as much, whatever f0 and β do together
    moved, h = order[2], 1e-6
    told = [
        np.log(bandwidth({"f0": 2.0 * np.exp(s * moved[0]), "beta": 1.1 * np.exp(s * moved[2])}))
        for s in (-h, h)
    ]
    assert (told[1] - told[0]) / (2.0 * h) == pytest.approx(order[0, 0], rel=1e-6)
    again = shifts(names=("f0", "release", "beta"), has_unheard=True)
    assert again[0, 0] == order[0, 0]  # what no electrode hears is not counted twice
    assert shifts(names=("m", "k_tri", "l0_tri")).shape == (0, 3)


def test_neither_of_a_filters_two_goes_farther_than_it_may_by_itself() -> None:
    """β's 5 % would take f0 along by 9.5 %, of which no filter is known to be capable."""
    sd = np.array([0.02, 0.3, 0.01])
    tied = np.outer(sd, sd) * np.array([[1.0, 0.0, 0.95], [0.0, 1.0, 0.0], [0.95, 0.0, 1.0]])
    names = ("f0", "k_tri", "beta")
    post = SimpleNamespace(names=names, problem=SimpleNamespace(has_unheard=False))
    assert np.abs(dynamics(post, tied, 1.1, unheard=False)[:, [0, 2]]).max() == 0.05
    wide = dynamics(post, 100.0 * tied, 1.1, unheard=False)  # what is unsure anyway goes as far
    assert np.abs(wide[:, 0]).max() > 0.05
    assert np.all(np.abs(wide) <= np.maximum(0.05, 10.0 * sd))
    late = SimpleNamespace(names=("f0", "release", "beta"), problem=post.problem)
    assert np.abs(dynamics(late, tied, 1.1, unheard=False)[:, 0]).max() > 0.1  # f0 is 37 % off then


def test_what_is_known_well_follows_another_filter_no_farther_than_it_is_unsure() -> None:
    """f0 known to a thousandth has a correlation with a stiffness that is chance.

    It follows two standard deviations of f0, by its own times the correlation, and by its own.
    """
    sharp, names = 1e-6 * V, ("f0", "k_tri", "beta")
    post = SimpleNamespace(names=names, problem=SimpleNamespace(has_unheard=False))
    moved = dynamics(post, sharp, 1.1, unheard=False)
    follows = 2.0 * sharp[1, 0] / np.sqrt(sharp[0, 0])
    assert abs(moved[0, 1]) == pytest.approx(min(abs(follows), np.sqrt(sharp[1, 1])))
    assert np.all(np.abs(moved[:, 1]) <= np.sqrt(sharp[1, 1]))
    assert moved[0, 0] == pytest.approx(0.05)
    unheard = dynamics(post, sharp, 1.1, unheard=True)
    assert np.abs(unheard[:, 1]).max() > 10.0 * np.sqrt(sharp[1, 1])
