"""Certified non-linear regressions of NIST: values and standard errors to six digits."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from surae.inference.least_squares.minimise import Ends, Outcome, minimise
from surae.inference.uncertainty.covariance import covariance

FOLDER = Path(__file__).parent / "nist"


def _danwood(b, x):
    return b[0] * x ** b[1]


def _boxbod(b, x):
    return b[0] * (1 - np.exp(-b[1] * x))


def _misra1c(b, x):
    return b[0] * (1 - (1 + 2 * b[1] * x) ** -0.5)


def _chwirut2(b, x):
    return np.exp(-b[0] * x) / (b[1] + b[2] * x)


def _lanczos3(b, x):
    return sum(b[i] * np.exp(-b[i + 1] * x) for i in (0, 2, 4))


def _roszman1(b, x):
    return b[0] - b[1] * x - np.arctan(b[2] / (x - b[3])) / np.pi


def _mgh17(b, x):
    return b[0] + b[1] * np.exp(-x * b[3]) + b[2] * np.exp(-x * b[4])


def _thurber(b, x):
    above = b[0] + b[1] * x + b[2] * x**2 + b[3] * x**3
    return above / (1 + b[4] * x + b[5] * x**2 + b[6] * x**3)


def _mgh09(b, x):
    return b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3])


def _mgh10(b, x):
    return b[0] * np.exp(b[1] / (x + b[2]))


def _rat42(b, x):
    return b[0] / (1 + np.exp(b[1] - b[2] * x))


def _rat43(b, x):
    return b[0] / (1 + np.exp(b[1] - b[2] * x)) ** (1 / b[3])


def _eckerle4(b, x):
    return b[0] / b[1] * np.exp(-0.5 * ((x - b[2]) / b[1]) ** 2)


def _bennett5(b, x):
    return b[0] * (b[1] + x) ** (-1 / b[2])


MODELS: dict[str, Callable] = {
    "Misra1a": _boxbod,
    "Misra1c": _misra1c,
    "DanWood": _danwood,
    "Chwirut2": _chwirut2,
    "Lanczos3": _lanczos3,
    "Roszman1": _roszman1,
    "MGH17": _mgh17,
    "Thurber": _thurber,
    "MGH09": _mgh09,
    "MGH10": _mgh10,
    "BoxBOD": _boxbod,
    "Rat42": _rat42,
    "Rat43": _rat43,
    "Eckerle4": _eckerle4,
    "Bennett5": _bennett5,
}

#: Far starts from which no Levenberg–Marquardt is sure to arrive: from (1, 1) the second step of
#: BoxBOD lands where the exponential has vanished, and the valley of MGH10 is e⁵⁰ times too narrow.
FAR = {("BoxBOD", 1), ("MGH10", 1)}
STARTS = [(name, start) for name in MODELS for start in (1, 2)]


class Regression:
    """One set of the collection with its residual and complex-step Jacobian."""

    def __init__(self, name):
        head, body = (FOLDER / f"{name}.dat").read_text().split("data\n")
        lines = [line.split()[1:] for line in head.splitlines()]
        self.name = name
        self.table = np.array(lines[:-1], dtype=float)
        self.rss = float(lines[-1][0])
        self.y, self.x = np.array([line.split() for line in body.splitlines()], dtype=float).T
        self.certified, self.deviation = self.table[:, 2], self.table[:, 3]
        self.p, self.n = len(self.table), len(self.y)
        self.infinite = np.full(self.p, np.inf)

    def rows(self, b):
        out = np.empty((self.p + 1, self.n))
        with np.errstate(all="ignore"):
            for j in range(self.p):
                step = 1e-30 * max(abs(b[j]), 1e-10)
                moved = b.astype(complex)
                moved[j] += 1j * step
                out[j] = MODELS[self.name](moved, self.x).imag / step
            out[-1] = MODELS[self.name](b, self.x) - self.y
        return out

    def deviations(self, minimum):
        names = [f"b{j + 1}" for j in range(self.p)]
        found = covariance(minimum.R, names, minimum.sse, self.n)
        assert found.names == tuple(names)
        assert found.dof == self.n - self.p
        return np.sqrt(np.diag(found.matrix))


def test_the_sets_are_copied_right():
    # The certified values give the certified sum of squares: a wrong digit would not.
    for name in MODELS:
        one = Regression(name)
        residual = one.rows(one.certified)[-1]
        assert residual @ residual == pytest.approx(one.rss, rel=2e-9 if one.rss > 1e-6 else 1e-6)


@pytest.mark.parametrize(("name", "start"), [s for s in STARTS if s not in FAR])
def test_certified_values_and_deviations(name, start):
    one = Regression(name)
    found = minimise(
        one.rows,
        one.table[:, start - 1],
        -one.infinite,
        one.infinite,
        ends=Ends(ftol=1e-14, max_iterations=700),
    )
    assert found.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(found.x, one.certified, rtol=1e-6)
    np.testing.assert_allclose(one.deviations(found), one.deviation, rtol=1e-6)
    assert found.sse == pytest.approx(one.rss, rel=1e-9)


def test_a_far_start_comes_within_reach_once_the_linear_parameter_is_solved():
    # As the product starts its own fits.
    one = Regression("BoxBOD")
    first = one.table[:, 0].copy()
    shape, residual = one.rows(first)[[0, -1]]
    first[0] -= shape @ residual / (shape @ shape)
    found = minimise(one.rows, first, -one.infinite, one.infinite, ends=Ends(ftol=1e-14))
    np.testing.assert_allclose(found.x, one.certified, rtol=1e-6)


@pytest.mark.parametrize("name", MODELS)
def test_default_tolerance_is_far_below_the_standard_error(name):
    one = Regression(name)
    found = minimise(
        one.rows, one.table[:, 1], -one.infinite, one.infinite, ends=Ends(max_iterations=400)
    )
    assert found.outcome is Outcome.CONVERGED
    assert np.all(np.abs(found.x - one.certified) < 1e-3 * one.deviation)


@pytest.mark.parametrize("name", ["MGH17", "Thurber", "Bennett5"])
def test_as_low_as_scipy(name):
    one = Regression(name)
    first = one.table[:, 1]
    ours = minimise(
        one.rows, first, -one.infinite, one.infinite, ends=Ends(ftol=1e-14, max_iterations=400)
    )
    theirs = least_squares(
        lambda b: one.rows(b)[-1],
        first,
        jac=lambda b: one.rows(b)[:-1].T,
        method="lm",
        x_scale="jac",
        ftol=1e-15,
        xtol=1e-15,
        gtol=1e-15,
    )
    assert ours.sse <= 2 * theirs.cost * (1 + 1e-10)


def test_a_far_start_is_never_called_a_minimum_too_early():
    # In MGH10's valley every step is small and lowers the sum: that is not convergence.
    one = Regression("MGH10")
    found = minimise(one.rows, one.table[:, 0], -one.infinite, one.infinite, ends=Ends(ftol=1e-14))
    assert found.outcome is Outcome.ITERATIONS
    assert found.sse < 1e-6 * np.sum(one.rows(one.table[:, 0])[-1] ** 2)
