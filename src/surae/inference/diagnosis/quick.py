"""Model 1.0 fitted quickly to what a recording might be.

A quick fit is model 1.0 on some 500 samples with the zero of the torque free, a few milliseconds;
R² is about the mean.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import FrozenDict, read_only
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import FitProblem, make_problem
from surae.inference.least_squares.minimise import Ends, minimise
from surae.inference.least_squares.residuals import Residuals, curved_move
from surae.inference.least_squares.separable import scan_lengths, solve_linear
from surae.model.jit import compile_all
from surae.quality.numeric import quantiles, shifted, smooth
from surae.quality.trial import Signals
from surae.recording import MUSCLES, Recording
from surae.signals import ModelInputs

#: Samples of a quick fit, and the rate [Hz] that it keeps at least.
_SAMPLES = 500
_RATE = 15.0
#: An EMG whose highest level is not so many times its level at rest is at rest throughout.
_ACTIVE = 2.5
#: A muscle does nothing whose weight is below this part of the largest.
_WEIGHTS = ("g1", "g2", "g3", "g4")
_IDLE = 0.01
#: The muscles whose gain may change together: heads of the triceps are hard to tell apart.
_GROUPS = {"emg_ta": ("g1",), "emg_triceps": _WEIGHTS[1:], "emg": _WEIGHTS}
#: Largest level [V] to which the EMG is brought, whatever its unit: weights then suit their bounds.
_FULL = 6e-4


@dataclass(frozen=True, slots=True)
class QuickFit:
    """How well model 1.0 can explain a recording's torque."""

    r2: float  #: R² about the mean, the torque's zero being free.
    zero: float  #: That zero [Nm].
    idle: int = 0  #: How many muscles would do nothing while their EMG shows effort.
    #: What grows through the trial, by signal: by how much (torque [Nm], an EMG's effect as a part
    #: of it), and the part of what the fit leaves that it explains.
    slow: Mapping[str, tuple[float, float]] = field(default_factory=FrozenDict)
    at: tuple[float, ...] = ()  #: The free parameters.
    samples: float = 1.0  #: How many independent samples its residual is worth.

    @property
    def unexplained(self) -> float:
        """Part of the torque's variance that is not explained."""
        return max(1.0 - self.r2, 1e-4)


def quick_problem(
    recording: Recording, signals: Signals, later: dict[str, float] | None = None
) -> FitProblem | None:
    """What a quick fit minimises: few samples of the signals, the EMG's levels above rest.

    `later` is by how much the EMG of a muscle is late [s], which is taken away. None where model
    1.0 cannot be fitted.
    """
    assert signals.torque is not None
    compile_all()
    rate = signals.rate_hz
    step = max(1, min(int(rate / _RATE), len(signals.time) // _SAMPLES))
    thin = slice(step // 2, None, step)
    moved = smooth(signals.angle, round(0.05 * rate))
    velocity = np.gradient(moved, 1.0 / rate)
    emg = np.zeros((len(signals.time), len(MUSCLES)))
    for muscle, envelope in signals.fast.items():
        rest, top = quantiles(envelope, 0.05, 0.98)
        if top > _ACTIVE * max(rest, 0.0):
            level = np.maximum(envelope - rest, 0.0) * (_FULL / (top - rest))
            if later and muscle in later:
                level = shifted(level, -round(later[muscle] * rate))
            emg[:, MUSCLES.index(muscle)] = smooth(level, step)
    silent = [f"g{k + 1}" for k in range(len(MUSCLES)) if not emg[:, k].any()]
    inputs = ModelInputs(
        recording.name,
        rate / step,
        time=read_only(signals.time[thin]),
        angle=read_only(moved[thin]),
        velocity=read_only(velocity[thin]),
        acceleration=read_only(np.gradient(velocity, 1.0 / rate)[thin]),
        emg=read_only(emg[thin]),
        emg_unit="V",
        torque=read_only(signals.torque[thin]),
    )
    mass = {name: value for name, value in recording.fixed.items() if name == "m"}
    try:
        return make_problem([inputs], fixed=dict.fromkeys(silent, 0.0) | mass)
    except InputError:
        return None


def quick_fit(
    recording: Recording,
    signals: Signals,
    *,
    later: dict[str, float] | None = None,
    zero: bool = True,
    near: QuickFit | None = None,
) -> QuickFit | None:
    """Fit model 1.0 quickly to what a recording might be.

    `signals` are those of what it might be; `later` is by how much the EMG of a muscle is
    late [s], which is taken away; `zero` says whether the torque's zero is free. Lengths begin
    where a fit `near` has them, whose muscles are the same, or are looked for. None where the model
    cannot be fitted to it.
    """
    problem = quick_problem(recording, signals, later)
    if problem is None:
        return None
    measured = problem.inputs[0].torque
    assert measured is not None
    residuals = Residuals(problem)

    def rows(x: FloatArray, wanted: Sequence[int] | None = None) -> FloatArray:
        """Rows without their means, where the torque's zero is to be solved for."""
        every = residuals.data_rows(x, wanted)
        if zero:
            every -= every.mean(axis=1, keepdims=True)
        return every

    power = float(((measured - measured.mean()) ** 2).sum())
    if power <= 0.0:
        return None
    with one_blas_thread(), np.errstate(over="ignore", invalid="ignore"):
        if near is None or len(near.at) != len(problem.free):
            begin = scan_lengths(problem, rows, problem.start)
        else:
            begin, _ = solve_linear(problem, rows, np.array(near.at))
        best = minimise(
            rows,
            begin,
            problem.lower,
            problem.upper,
            move=curved_move(problem),
            ends=Ends(40, ftol=1e-3, stall=1e-3),
        )
        offset = float(np.mean(residuals.of(best.x)[0])) if zero else 0.0
    if not np.isfinite(best.sse):
        return None
    weights = [x for name, x in zip(problem.free, best.x, strict=True) if name in _WEIGHTS]
    idle = sum(weight < _IDLE * max(weights) for weight in weights)
    table = rows(best.x)
    slow = _slow(table, dict(zip(problem.free, best.x, strict=True)))
    r2 = 1.0 - best.sse / power
    return QuickFit(r2, offset, idle, slow, tuple(best.x.tolist()), independent(table[-1]))


def independent(residual: FloatArray) -> float:
    """How many independent samples a residual is worth: n over its integrated autocorrelation.

    The sum ends where the autocorrelation first is not positive (Geyer, Statistical Science 7,
    1992): what a model leaves out is slow, and the samples of one swing of it say one thing.
    """
    e = residual - residual.mean()
    size = 1 << (2 * len(e) - 1).bit_length()
    power = np.fft.irfft(np.abs(np.fft.rfft(e, size)) ** 2, size)[: len(e)]
    if power[0] <= 0.0:
        return float(len(e))
    rho = power / power[0]
    end = int(np.argmax(rho <= 0.0)) or len(rho)
    return float(len(e) / (1.0 + 2.0 * rho[1:end].sum()))


def growing(derivatives: FloatArray, values: Mapping[str, float]) -> dict[str, FloatArray]:
    """What the torque would be of something that grows evenly through a trial, by signal.

    A torque's zero, in Nm, and the effect of an EMG, as a part of it.
    """
    u = np.linspace(-0.5, 0.5, derivatives.shape[1])
    names = list(values)
    grows = {"torque": u}
    for group, weights in _GROUPS.items():
        known = [weight for weight in weights if weight in values]
        # More torque for the same EMG, as where its gain falls.
        pulls = [values[weight] * derivatives[names.index(weight)] for weight in known]
        if known:
            grows[group] = u * np.sum(pulls, axis=0)
    return grows


def _slow(rows: FloatArray, values: Mapping[str, float]) -> FrozenDict[str, tuple[float, float]]:
    """What grows evenly through a trial, by what it explains of the residual, to first order."""
    e = -rows[-1]
    derivatives = rows[:-1]
    u = np.linspace(-0.5, 0.5, len(e))
    grows = growing(derivatives, values)
    others = np.column_stack([np.ones_like(u), *derivatives])
    others /= np.maximum(np.linalg.norm(others, axis=0), 1e-300)
    basis = np.linalg.qr(others)[0]
    left = e - basis @ (basis.T @ e)
    grown = {}
    for role, column in grows.items():
        across = column - basis @ (basis.T @ column)
        power = float(across @ across)
        if power > 1e-6 * float(column @ column):
            size = float(across @ left) / power
            grown[role] = (size, size**2 * power / max(float(left @ left), 1e-300))
    return FrozenDict(grown)


def percent(r2: float) -> Message:
    """R² in percent, with the digits that matter near 100."""
    return Message("{r2:.1f} %" if r2 > 0.9 else "{r2:.0f} %", r2=100.0 * r2)
