"""R-hat and effective draws where they are known."""

import numpy as np
import pytest

from surae.assessment.posterior.chains import Convergence, convergence, verdict

pytestmark = pytest.mark.usefixtures("sampler")


def independent(chains=4, draws=2000, seed=0):
    return np.random.default_rng(seed).standard_normal((chains, draws))


def autoregressive(rho, chains=4, draws=20_000):
    noise, x = independent(chains, draws), np.empty((chains, draws))
    x[:, 0] = noise[:, 0]
    for i in range(1, draws):
        x[:, i] = rho * x[:, i - 1] + np.sqrt(1 - rho**2) * noise[:, i]
    return x


def test_independent_draws():
    found = convergence(independent())
    assert found.rhat == pytest.approx(1.0, abs=0.003)
    assert found.ess_bulk == pytest.approx(8000, rel=0.1)
    assert found.ess_tail == pytest.approx(8000, rel=0.15)


@pytest.mark.parametrize("rho", [0.5, 0.9, -0.5])
def test_correlated_draws_are_worth_their_share(rho):
    found = convergence(autoregressive(rho))
    assert found.ess_bulk == pytest.approx(80_000 * (1 - rho) / (1 + rho), rel=0.15)


def test_chains_that_disagree():
    apart = independent() + np.array([[0.0], [0.0], [0.0], [2.0]])
    found = convergence(apart)
    assert found.rhat is not None
    assert found.rhat > 1.2
    assert found.ess_bulk is not None
    assert found.ess_bulk < 30
    # Chains of unlike widths about one mean: what ranks and folding are for.
    folded = convergence(independent() * np.array([[1.0], [1.0], [1.0], [4.0]]))
    assert folded.rhat is not None
    assert folded.rhat > 1.05


def test_a_drift_within_each_chain_is_found():
    drifting = independent() + np.linspace(0, 2, 2000)
    rhat = convergence(drifting).rhat
    assert rhat is not None
    assert rhat > 1.1


def test_no_number_where_the_chains_never_moved():
    assert convergence(np.ones((4, 100))) == Convergence(None, None, None)


def test_the_verdict():
    good = Convergence(1.002, 900.0, 700.0)
    believed, text = verdict({"m": good, "f0": good}, 0, (4, 500))
    assert believed
    assert "R-hat at most 1.002" in text
    assert "700 effective" in text
    believed, text = verdict({"m": good, "f0": Convergence(1.08, 900.0, 900.0)}, 0, (4, 500))
    assert not believed
    assert "disagree in f0 (R-hat up to 1.080" in text
    believed, text = verdict({"m": good, "f0": Convergence(1.0, 900.0, 100.0)}, 0, (4, 500))
    assert not believed
    assert "100 effective draws of f0, 400 wanted: draw at least 4 times as many" in text
    assert verdict({"m": good}, 10, (4, 500))[0]
    believed, text = verdict({"m": good}, 11, (4, 500))
    assert not believed
    assert "11 of 2000 draws diverge" in text
    believed, text = verdict({"m": Convergence(None, None, None)}, 0, (4, 500))
    assert not believed
    assert "∞" in text
