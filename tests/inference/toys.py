"""Models small enough that their likelihood is known, fitted like any other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import read_only
from surae.inference import FitProblem, FitResult, fit_problem
from surae.model import ModelOptions
from surae.model.parameter import Parameter
from surae.model.registry import ModelSpec
from surae.signals import ModelInputs

#: By how many standard deviations a value may move where nothing is another.
STABLE = 0.05

#: From parameters to a curve and its Jacobian rows.
Curve = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass
class Toy:
    """A simulator of a curve."""

    curve: Curve

    def torque(self, values):
        return self.curve(values)[0]

    def torque_jacobian(self, values, columns: Sequence[int]):
        torque, rows = self.curve(values)
        return torque, rows[list(columns)]


@dataclass(frozen=True, slots=True, eq=False)
class ToySpec(ModelSpec):
    """A model that is a curve and needs no recording."""

    curve: Curve | None = None

    def simulator(self, *_):
        return Toy(self.curve)


def toy_problem(
    curve: Curve,
    data: np.ndarray,
    start: dict[str, float],
    bounds: dict[str, tuple[float, float]],
    free: Sequence[str] | None = None,
    **more: object,
) -> FitProblem:
    """The problem of fitting a curve to data."""
    n = len(data)
    zeros = read_only(np.zeros(n))
    inputs = ModelInputs(
        "toy",
        100.0,
        read_only(np.arange(n) / 100),
        zeros,
        zeros,
        zeros,
        read_only(np.zeros((n, 4))),
        "V",
        read_only(np.asarray(data, dtype=float)),
        prepared=True,
    )
    names = tuple(start)
    parameters = tuple(Parameter(k, "-", k, "limb", start[k], *bounds[k], False) for k in names)
    spec = ToySpec("toy", "toy", parameters, names, tie="", curve=curve)
    chosen = tuple(free or names)
    return FitProblem(
        spec=spec,
        options=ModelOptions(),
        inputs=(inputs,),
        free=chosen,
        base=np.array([start[k] for k in names]),
        lower=np.array([bounds[k][0] for k in chosen]),
        upper=np.array([bounds[k][1] for k in chosen]),
        **more,
    )


def toy_fit(*given, **more) -> FitResult:
    """The fit of a curve to data from its start."""
    return fit_problem(toy_problem(*given, **more), starts=1)


def linear(design: np.ndarray) -> Curve:
    """A curve that is linear in its parameters, design of shape (n, p)."""
    return lambda values: (design @ values, design.T.copy())


def moved(one: FitResult, other: FitResult) -> float:
    """How far values of two fits are apart, in standard deviations of the first."""
    sd = np.sqrt(np.diag(one.solution.covariance))
    away = [other.values[name] - one.values[name] for name in one.problem.free]
    return float(np.abs(away / sd).max())


def disturbed(inputs: ModelInputs, seed: int = 0) -> ModelInputs:
    """The inputs times 1 + 10⁻⁶ of noise."""
    rng = np.random.default_rng(seed)
    torque, emg = (
        read_only(signal * (1.0 + 1e-6 * rng.standard_normal(signal.shape)))
        for signal in (inputs.torque, inputs.emg)
    )
    return replace(inputs, torque=torque, emg=emg)
