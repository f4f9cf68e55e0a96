"""Covariance of the estimates when the residual is correlated over time.

Equation (33) takes the torque's noise for white. Here it is a stationary process of its own in each
recording: an autoregressive model Σ is fitted to the residual, and

    Cov = (JᵀJ)⁻¹·Jᵀ Σ J·(JᵀJ)⁻¹.

The parameters have already fitted part of the noise, most of it at the low frequencies where noise
is strongest. The residual is therefore (1 − H)·noise, H the projection on the columns of J, and the
model is that of the noise whose residual would have the autocovariance that was found (the idea is
Worsley's, for autoregressive noise in brain images: NeuroImage 15, 2002).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surae.base.frozen import Comparable
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.inference import FitResult, LeastSquares, Outliers
from surae.inference.evidence import root as root_of
from surae.inference.judging.goodness import Whiteness, autocovariance, most_lags, whiteness
from surae.inference.least_squares.residuals import Residuals
from surae.inference.noise import NoiseModel, autoregressive
from surae.inference.uncertainty.covariance import Covariance, InverseRoot, inverse_root
from surae.signals import ModelInputs

#: Rounds of the noise model and what the fit took of it; ends when the variance rests.
_ROUNDS = 6
_RESTS = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class RobustCovariance(Comparable):
    """Covariance of the estimates under correlated noise."""

    names: tuple[str, ...]  #: Parameters, those of `Covariance.names`.
    matrix: FloatArray  #: Covariance in the products of their units, shape (k, k).
    #: Degrees of freedom of each variance, for Student's t: 2/Var(ln v̂), as Satterthwaite's, from
    #: the uncertainty of the noise model, shape (k,).
    dof: FloatArray
    noise: tuple[NoiseModel, ...]  #: Of each recording.
    #: Shifts of all free parameters, what lies at a bound included, whose outer products add up to
    #: their covariance, shape (r, p).
    rows: FloatArray


def robust_covariance(
    result: FitResult, estimated: Covariance
) -> tuple[RobustCovariance | None, tuple[Whiteness, ...]]:
    """Covariance under correlated noise, and the whiteness of each recording's residual.

    The Jacobian is evaluated once, at the solution. Sample weights are those of noise whose
    variance is their inverse, unless they are there for emphasis (`ModelInputs.emphasised`): then
    the noise is what the residual is without them. A loss for outliers enters as its ψ in place of
    the residual, with the mean of ψ′ as its curvature (Huber and Ronchetti 2009, 7.6). Left-out
    samples are gaps across which the noise goes on. A prior, and what is known of a parameter at
    its bound, is an observation of its own, with white noise. There is no covariance where no
    estimate has a variance, or none that is finite, and of a fit with a family, whose estimate has
    the noise's correlation in it.
    """
    problem = result.problem
    if not estimated.names or not isinstance(result.solution, LeastSquares):
        return None, tuple(
            whiteness(residual, inputs.rate_hz, inputs.counts)
            for inputs, residual in zip(problem.inputs, result.residuals, strict=True)
        )
    # The parameters of an edited file may be absurd: then numbers overflow.
    with one_blas_thread(), np.errstate(over="ignore", invalid="ignore"):
        root = inverse_root(result.R, problem.free, estimated.sigma2, result.bounded)
        x = np.array([result.values[name] for name in problem.free])
        rows = Residuals(problem).data_rows(x)
        ends = np.cumsum([inputs.n for inputs in problem.inputs])[:-1]
        outliers = result.solution.outliers
        losses = outliers.weights if outliers else [None] * len(problem.inputs)
        parts = zip(problem.inputs, np.split(rows, ends, axis=1), losses, strict=True)
        seen = [
            _Seen(
                -part[-1],
                inputs.counts,
                root.matrix.T @ part[list(root.positions)],
                _gain(inputs, loss),
            )
            for inputs, part, loss in parts
        ]
        white = tuple(
            whiteness(part.residual, inputs.rate_hz, part.counted, part.absorbed)
            for part, inputs in zip(seen, problem.inputs, strict=True)
        )
        models = _noise_models(seen)
        robust = _covariance(root, problem.free, seen, models, estimated, outliers)
        return robust if np.isfinite(robust.matrix).all() else None, white


def _gain(inputs: ModelInputs, loss: FloatArray | None) -> FloatArray | None:
    """What turns the weighted residual √W·e into the noise that is stationary, and J along.

    The noise is √W·e/gain and acts on the estimates through √W·J·gain, so that their product, the
    gradient, stays. None where the weighted residual itself is that noise.
    """
    if inputs.weight is None or (loss is None and not inputs.emphasised):
        return None
    of_loss = np.ones(inputs.n) if loss is None else loss
    weight = inputs.weight / of_loss if inputs.emphasised else np.ones(inputs.n)
    return np.where(inputs.weight > 0, np.sqrt(weight / of_loss), 1.0)


class _Seen:
    """One recording: weighted residual, which samples count, and the basis Q = J·C, (r, n).

    Noise acts on the estimates through `transformed`, and what they fit of it follows `fitted`; the
    two are one, Q, unless there is a gain.
    """

    def __init__(
        self,
        residual: FloatArray,
        counted: npt.NDArray[np.bool_],
        basis: FloatArray,
        gain: FloatArray | None,
    ) -> None:
        from scipy.fft import next_fast_len

        n = len(residual)
        self.counted = counted
        self.residual = residual if gain is None else residual / gain
        self.gram = basis @ basis.T
        self.size = next_fast_len(2 * n, real=True)
        self.lags = most_lags(n)
        acting = basis if gain is None else basis * gain
        self.information = acting @ acting.T
        self.transformed = np.fft.rfft(acting, self.size)
        self.fitted = self.transformed if gain is None else np.fft.rfft(basis / gain, self.size)
        # What each frequency of a real FFT counts in a sum over the whole circle.
        self.twice = np.full(self.transformed.shape[1], 2.0)
        self.twice[0] = 1.0
        if self.size % 2 == 0:
            self.twice[-1] = 1.0
        power = np.sum((self.transformed * self.fitted.conj()).real, axis=0)
        self.absorbed = np.fft.irfft(power, self.size)[: self.lags + 1]
        self.sums, pairs = autocovariance(self.residual, counted, self.lags)
        self.samples = float(pairs[0])
        # Divided by n where nothing is left out, so that it is an autocovariance.
        self.count = np.maximum(pairs, 1.0) * n / np.arange(n, n - self.lags - 1, -1.0)

    def meat(self, model: NoiseModel) -> FloatArray:
        """QᵀΣQ, shape (r, r)."""
        if not model.order:
            return model.variance * self.information
        density = self.twice * model.spectrum(self.size) / self.size
        return np.asarray((self.transformed * density @ self.transformed.conj().T).real)

    def lost(self, model: NoiseModel, meat: FloatArray) -> FloatArray:
        """What the fit takes out of the autocovariance sums of noise of this model.

        From E êêᵀ = (1 − H)Σ(1 − H), with H = QQᵀ and QᵀΣQ = `meat` over all recordings.
        """
        white = model.variance * np.eye(len(meat))
        if not model.order and self.fitted is self.transformed and np.allclose(meat, white):
            return model.variance * self.absorbed  # QᵀΣQ = σ²: what is lost of white noise is H
        spread = model.variance * self.transformed
        if model.order:
            full = np.fft.irfft(self.transformed * model.spectrum(self.size), self.size)
            spread = np.fft.rfft(full[:, : len(self.residual)] * self.counted, self.size)
        cross = 2.0 * spread - meat @ self.fitted
        both = np.sum((cross * self.fitted.conj()).real, axis=0)
        return np.asarray(np.fft.irfft(both, self.size)[: self.lags + 1])


def _noise_models(seen: Sequence[_Seen]) -> tuple[NoiseModel, ...]:
    """The noise of every recording, with what the parameters took of it given back."""
    models = [
        autoregressive(recording.sums / recording.count, recording.samples) for recording in seen
    ]
    for _ in range(_ROUNDS):
        pairs = list(zip(seen, models, strict=True))
        meat = sum((recording.meat(model) for recording, model in pairs), start=np.zeros(()))
        before = [model.autocovariance[0] for model in models]
        models = [
            autoregressive(
                (recording.sums + recording.lost(model, meat)) / recording.count, recording.samples
            )
            for recording, model in pairs
        ]
        after = [model.autocovariance[0] for model in models]
        if np.allclose(before, after, rtol=_RESTS, atol=0.0):
            break
    return tuple(models)


def _covariance(
    root: InverseRoot,
    free: Sequence[str],
    seen: Sequence[_Seen],
    models: Sequence[NoiseModel],
    estimated: Covariance,
    outliers: Outliers | None,
) -> RobustCovariance:
    observed = sum((recording.gram for recording in seen), start=np.zeros(()))
    # Without priors the information is the unit matrix: what is missing of it comes from them.
    prior = np.eye(len(observed)) - observed
    C = root.matrix
    sigma2 = estimated.sigma2
    if outliers is not None:
        C = np.asarray(np.linalg.solve(observed / outliers.widening + prior, C.T).T)
        sigma2 = outliers.scale**2
    inner = sigma2 * prior
    for recording, model in zip(seen, models, strict=True):
        inner += recording.meat(model)
    # a root of what is between them, which is of the size of the noise
    between = root_of(inner)
    rows = np.zeros((len(between), len(free)))
    rows[:, list(root.positions)] = between @ C.T
    known = [j for j in root.known if free[root.positions[j]] in estimated.names]
    C = C[known]
    matrix = C @ inner @ C.T
    matrix = (matrix + matrix.T) / 2
    parts = [
        _variance_and_doubt(C @ recording.transformed, recording, model)
        for recording, model in zip(seen, models, strict=True)
    ]
    total = np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0)
    doubt = sum(((v / total) ** 2 * u for v, u in parts), start=np.zeros(len(total)))
    dof = np.minimum(2.0 / np.maximum(doubt, 1e-300), estimated.dof)
    return RobustCovariance(estimated.names, matrix, dof, tuple(models), rows)


def _variance_and_doubt(
    rows: npt.NDArray[np.complex128], recording: _Seen, model: NoiseModel
) -> tuple[FloatArray, FloatArray]:
    """Variance of each parameter from one recording's noise, and the variance of its logarithm."""
    transfer = model.transfer(recording.size)
    power = np.abs(rows) ** 2 * model.spectrum(recording.size)
    variance = (power @ recording.twice) / recording.size
    doubt = np.full(len(variance), 2.0 / recording.samples)
    if model.order:
        # ∂ ln S/∂φ[k] = 2 Re(exp(−iωk)/A), averaged over what each frequency adds.
        slope = 2.0 * np.fft.irfft(power / transfer.conj(), recording.size)[:, 1 : model.order + 1]
        slope /= np.where(variance > 0, variance, 1.0)[:, None]
        doubt += np.einsum("ij,jk,ik->i", slope, model.uncertainty(), slope)
    return variance, doubt
