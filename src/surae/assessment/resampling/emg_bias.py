"""What noise of the EMG does to the estimates: simulation and extrapolation (SIMEX).

The EMG drives the model as if it were exact. Noise in it biases the estimates, however long the
recording, and no standard error shows it. SIMEX (Cook and Stefanski 1994) adds ever more noise of
the same kind, watches the estimates move, and extrapolates back to where there is none.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.assessment.likelihood.profile import prior_noise
from surae.assessment.resampling.bootstrap import refit
from surae.assessment.residual import autocovariance
from surae.errors import InputError
from surae.estimation import FitResult
from surae.estimation.noise import NoiseModel, autoregressive
from surae.estimation.result import with_laboratory
from surae.filed import filed
from surae.frozen import read_only
from surae.model import adapted
from surae.progress import Progress
from surae.recording import MUSCLES
from surae.records import Saved
from surae.runner import in_threads
from surae.signals import ModelInputs
from surae.units import FloatArray
from surae.versions import versions

#: Variances of the noise that is added, as multiples of what is there.
ADDED = (0.5, 1.0, 1.5, 2.0)
#: Pairs of noise realisations unless told otherwise. The two of a pair have opposite signs, which
#: cancels what the noise does to first order: scatter, not bias.
PAIRS = 10
#: The quiet part of an EMG: of its half seconds, the tenth in which it is lowest.
_WINDOW_S, _QUIET = 0.5, 0.1
#: Windows that the quiet part needs at least, and the largest order of its noise model.
_FEWEST, _ORDER = 4, 10
#: Gain [noise variances] below which a minimum is not sought further.
_STALL = 1e-4


@filed("name")
@dataclass(frozen=True, slots=True)
class ParameterBias:
    """What EMG noise does to one parameter."""

    #: `name`, `unit`: the parameter.
    name: str
    unit: str
    value: float  #: Estimate of the fit.
    bias: float | None  #: By how much the noise shifted it; None where the fits failed.
    error: float | None  #: Standard error of `bias` from the few noise realisations.

    @property
    def corrected(self) -> float | None:
        """The estimate without the bias."""
        return None if self.bias is None else self.value - self.bias


@dataclass(frozen=True, slots=True)
class EmgBias(Saved):
    """Bias of the estimates by EMG noise.

    Attributes
    ----------
    parameters : mapping of str to ParameterBias
        The estimated ones.
    noise : tuple of mapping of str to float
        Standard deviation of the EMG noise of each recording, by muscle [V, or 1].
    source : str
        Where the noise level comes from, in words.
    pairs, missing : int
        Pairs of noise realisations asked for, and those that the user stopped.
    seed : int
        Of the random numbers.
    seconds : float
        Wall time.
    versions : mapping of str to str
        Versions of surae and of what its numbers depend on.
    """

    parameters: Mapping[str, ParameterBias]
    noise: tuple[Mapping[str, float], ...]
    source: str
    pairs: int
    missing: int
    seed: int
    seconds: float
    versions: Mapping[str, str]

    def as_dict(self) -> dict[str, Any]:
        """The bias as plain data, as it is saved."""
        method = {"method": "SIMEX, quadratic, antithetic pairs", "added": list(ADDED)}
        return method | Saved.as_dict(self)


def emg_bias(
    result: FitResult,
    *,
    level: float | None = None,
    pairs: int = PAIRS,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | None = None,
) -> EmgBias:
    """Estimate the bias of a fit's parameters by noise in its EMG.

    Noise of 0.5, 1, 1.5 and 2 times the variance that is there is added, all parameters are fitted
    again from the fit, and the parabola of each parameter against the added variance is followed
    back to −1, where there is no noise. The noise is taken as additive, independent of the EMG,
    stationary and Gaussian.

    `level` is the standard deviation of white noise as a part of each EMG's mean. By default the
    noise is that of the EMG's quiet part, correlation included (`quiet_noise`): a lower limit, as
    noise that grows with the muscle's activity is not in it. All else is as of `surae.emg_bias`.
    """
    begin = time.perf_counter()
    result = with_laboratory(result)
    problem = result.problem
    if level is not None and not 0 < level <= 1:
        raise InputError(f"EMG noise of {level:g} times the mean; give more than 0 and at most 1")
    if pairs < 1:
        raise InputError(f"pairs is {pairs}; give at least 1")
    if not np.isfinite(result.sse):
        raise InputError("the fit has no finite torque; fit again")
    models = [
        [_channel_noise(recording, channel, level) for channel in range(len(MUSCLES))]
        for recording in problem.inputs
    ]
    noise = prior_noise(result)
    known = np.clip([result.values[name] for name in problem.free], problem.lower, problem.upper)
    # Shifts are far smaller than standard errors, so minima are sought that closely too.
    origin = refit(problem, known, noise, stall=_STALL)
    x = known if origin is None else origin

    def pair(number: int) -> FloatArray | None:
        rng = np.random.default_rng([seed, number])
        drawn = [
            np.column_stack([model.draw(recording.n, rng) for model in channels])
            for recording, channels in zip(problem.inputs, models, strict=True)
        ]
        path = np.zeros((len(ADDED), len(x)))
        for row, added in enumerate(ADDED):
            for sign in (1.0, -1.0):
                noisier = replace(
                    problem,
                    inputs=tuple(
                        replace(recording, emg=read_only(recording.emg + sign * np.sqrt(added) * e))
                        for recording, e in zip(problem.inputs, drawn, strict=True)
                    ),
                )
                minimum = refit(noisier, x, noise, stall=_STALL)
                if minimum is None:
                    return None
                path[row] += minimum / 2
        return np.asarray(_extrapolation() @ (path - x))

    calls = {f"{number:09d}": {"number": number} for number in range(pairs)}

    def told(key: str, done: int, total: int) -> None:
        del key
        if progress is not None:
            progress(done, total)

    done = in_threads(pair, calls, workers, told)
    shifts = [-shift for _, shift in sorted(done.items()) if shift is not None]
    return EmgBias(
        parameters=_biases(result, shifts),
        noise=tuple(
            {
                muscle: float(np.sqrt(model.autocovariance[0]))
                for muscle, model in zip(MUSCLES, channels, strict=True)
                if muscle not in recording.missing_emg
            }
            for recording, channels in zip(problem.inputs, models, strict=True)
        ),
        source="quiet part of the EMG" if level is None else f"{100 * level:g} % of each mean",
        pairs=pairs,
        missing=pairs - len(done),
        seed=seed,
        seconds=time.perf_counter() - begin,
        versions=versions(),
    )


def quiet_noise(emg: FloatArray, rate_hz: float, where: str) -> NoiseModel:
    """Noise of one EMG envelope from where the muscle is quiet.

    Of all half seconds the tenth with the lowest means is taken; what varies about each of their
    means is the noise, modelled as an autoregressive process.

    `where` is what to call it in a message.
    """
    length = max(round(_WINDOW_S * rate_hz), 2)
    count = len(emg) // length
    if count < _FEWEST:
        raise InputError(
            f"{where}: shorter than {_FEWEST * _WINDOW_S:g} s, too short to find its quiet part; "
            "give the EMG noise"
        )
    windows = emg[: count * length].reshape(count, length)
    means = windows.mean(axis=1, keepdims=True)
    quiet = np.argsort(means[:, 0], kind="stable")[: max(int(_QUIET * count), _FEWEST)]
    counted = np.zeros((count, length), dtype=bool)
    counted[quiet] = True
    lags = min(_ORDER, length - 1)
    sums, pairs = autocovariance((windows - means).ravel(), counted.ravel(), lags)
    samples = float(pairs[0])
    # Each window's mean took one sample's worth of variance away.
    gamma = sums / np.maximum(pairs, 1.0) * (1 - np.arange(lags + 1) / samples)
    return autoregressive(gamma * length / (length - 1), samples)


def _channel_noise(recording: ModelInputs, channel: int, level: float | None) -> NoiseModel:
    if MUSCLES[channel] in recording.missing_emg:
        return NoiseModel(np.zeros(0), 0.0, np.zeros(1), 1.0)
    emg = recording.emg[:, channel]
    if level is None:
        return quiet_noise(emg, recording.rate_hz, recording.where)
    variance = float(level * emg.mean()) ** 2
    return NoiseModel(np.zeros(0), variance, np.array([variance]), float(len(emg)))


def _extrapolation() -> FloatArray:
    """Weights of the shifts at `ADDED` in the shift at −1, by a parabola through 0 at 0."""
    added = np.array(ADDED)
    return np.asarray(np.array([-1.0, 1.0]) @ np.linalg.pinv(np.column_stack([added, added**2])))


def _biases(result: FitResult, shifts: Sequence[FloatArray]) -> dict[str, ParameterBias]:
    problem = result.problem
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    biases = {}
    for j, name in enumerate(problem.free):
        ours = np.array([shift[j] for shift in shifts])
        biases[name] = ParameterBias(
            name,
            table[name].unit,
            result.values[name],
            float(ours.mean()) if len(ours) else None,
            float(ours.std(ddof=1) / np.sqrt(len(ours))) if len(ours) > 1 else None,
        )
    return biases
