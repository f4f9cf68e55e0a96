"""Activation dynamics: excitation through a second-order filter with delays, equation (14).

What excites a muscle group is the affair of `surae.model.excitation`; here it is filtered, and with
it each of its derivatives. The filter is exact for an input linear between samples.

An input that is delayed by part of a sample and interpolated anew would make a torque that has a
kink wherever the delay is a whole number of samples, and whose amplitude dips in between. The
filter is linear and knows no absolute time, so its output is shifted instead: it is exact at any
instant between samples, and has two continuous derivatives by time and therefore by the delay. Its
rate is among the states, so that ∂α/∂delay = −α' is free.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from surae.base.units import FloatArray
from surae.model.jit import inner, jit

IntArray = npt.NDArray[np.int64]

#: Terms of the series of φ2, and the norm below which it is summed: 14 terms at ½ leave 1e-19.
_TERMS = 14
_SMALL = 0.5
#: Where φ1 is summed, and the factors of its series: 12 terms at ¼ leave 1e-17.
NEAR = 0.25
#: Effort below which a power of it is taken for that of this part of the reference.
SMALLEST_EFFORT = 0.03
_FACTORS = tuple(1.0 / math.factorial(j + 1) for j in range(11, -1, -1))

# p·I + q·A with A = [[0, 1], [−1, −2β]], and the derivatives of p and q by h and by β. Every
# function of h·A has this form, because A² = −I − 2β·A.
_Element = tuple[float, float, float, float, float, float]


@inner
def _times(x: _Element, y: _Element, beta: float) -> _Element:
    """Product of two functions of A, with its derivatives."""
    p, q, p_h, q_h, p_b, q_b = x
    r, s, r_h, s_h, r_b, s_b = y
    b = 2.0 * beta
    return (
        p * r - q * s,
        p * s + q * r - b * q * s,
        p_h * r + p * r_h - q_h * s - q * s_h,
        p_h * s + p * s_h + q_h * r + q * r_h - b * (q_h * s + q * s_h),
        p_b * r + p * r_b - q_b * s - q * s_b,
        p_b * s + p * s_b + q_b * r + q * r_b - b * (q_b * s + q * s_b) - 2.0 * q * s,
    )


@inner
def _plus(x: _Element, constant: float) -> _Element:
    """Sum of x and constant·I."""
    return x[0] + constant, x[1], x[2], x[3], x[4], x[5]


@jit
def filter_step(f0: float, beta: float, dt: float) -> FloatArray:
    """One sample of the activation filter (14), exact for an EMG linear between samples.

    α'' + 2βω0·α' + ω0²·α = ω0²·E, ω0 = 2π·f0, with the state v = (α, α'/ω0):
    v[n] = Φ·v[n−1] + Γ0·E[n−1] + Γ1·E[n]. Exact at any cut-off below the Nyquist frequency and
    at any damping, the critical one included: φ-functions by series, scaling and doubling
    (φ2(2Z) = (φ1(Z)² + 2φ2(Z))/4), never by eigenvalues.

    Parameters
    ----------
    f0 : float
        Cut-off frequency [Hz].
    beta : float
        Relative damping [-].
    dt : float
        Sample time [s].

    Returns
    -------
    ndarray, shape (3, 2, 4)
        The step, its columns Φ (two), Γ0, Γ1; its derivatives by f0 [1/Hz] and by beta.
    """
    h = 2.0 * math.pi * f0 * dt
    norm = h * (1.0 + 2.0 * abs(beta))
    scale = 1.0
    doublings = 0
    while norm > _SMALL:
        norm *= 0.5
        scale *= 0.5
        doublings += 1
    z = (0.0, scale * h, 0.0, scale, 0.0, 0.0)

    # Horner on φ2(Z) = Σ Z^j/(j+2)!
    weight = 1.0
    for j in range(2, _TERMS + 2):
        weight /= j
    phi2 = (weight, 0.0, 0.0, 0.0, 0.0, 0.0)
    for j in range(_TERMS, 1, -1):
        weight *= j + 1
        phi2 = _plus(_times(phi2, z, beta), weight)
    phi1 = _plus(_times(phi2, z, beta), 1.0)
    free = _plus(_times(phi1, z, beta), 1.0)
    for _ in range(doublings):
        # at 2Z: φ2 ← (φ1² + 2φ2)/4, then φ1 ← I + 2Z·φ2
        square = _times(phi1, phi1, beta)
        phi2 = (
            0.25 * square[0] + 0.5 * phi2[0],
            0.25 * square[1] + 0.5 * phi2[1],
            0.25 * square[2] + 0.5 * phi2[2],
            0.25 * square[3] + 0.5 * phi2[3],
            0.25 * square[4] + 0.5 * phi2[4],
            0.25 * square[5] + 0.5 * phi2[5],
        )
        scale *= 2.0
        z = (0.0, scale * h, 0.0, scale, 0.0, 0.0)
        phi1 = _plus(_times(phi2, z, beta), 1.0)
        free = _times(free, free, beta)  # I + Z·φ1 cancels where little of a state is left

    steps = np.empty((3, 2, 4))  # the step, its derivatives by h and by beta
    for i in range(3):
        p = free[2 * i]
        q = free[2 * i + 1]
        steps[i, 0, 0], steps[i, 0, 1] = p, q
        steps[i, 1, 0], steps[i, 1, 1] = -q, p - 2.0 * beta * q
        # the input enters the second state with gain h: h times the second column of φ1 and φ2
        p1 = phi1[2 * i]
        q1 = phi1[2 * i + 1]
        p2 = phi2[2 * i]
        q2 = phi2[2 * i + 1]
        steps[i, 0, 2], steps[i, 0, 3] = h * (q1 - q2), h * q2
        steps[i, 1, 3] = h * (p2 - 2.0 * beta * q2)
        steps[i, 1, 2] = h * (p1 - 2.0 * beta * q1) - steps[i, 1, 3]
    # what h outside the functions and β inside A add
    for column in range(2, 4):
        for row in range(2):
            steps[1, row, column] += steps[0, row, column] / h
    for column in range(4):
        for row in range(2):
            steps[1, row, column] *= 2.0 * math.pi * dt
    steps[2, 1, 1] -= 2.0 * free[1]
    steps[2, 1, 2] -= 2.0 * steps[0, 0, 2]
    steps[2, 1, 3] -= 2.0 * steps[0, 0, 3]
    return steps


@dataclass(frozen=True, slots=True)
class Drive:
    """One input of a muscle group's filter, linear between samples; arrays of shape (n,)."""

    signal: FloatArray  #: The excitation [N].
    #: Its derivatives, each after the column of its parameter; only those that are wanted.
    slopes: Sequence[tuple[int, FloatArray]] = ()
    delay: float | None = None  #: How late it comes [s]; None where it has no delay to be moved by.
    delay_column: int = -1  #: Column of the delay; −1 where its derivative is not wanted.


@dataclass(frozen=True, slots=True)
class ActiveState:
    """Active state of one muscle group at L instants of each of n samples."""

    alpha: FloatArray  #: α [N], shape (L, n).
    slopes: FloatArray  #: Its derivatives by the wanted parameters that touch it, shape (q, L, n).
    #: Their columns; one may come more than once, and its derivatives then add up, shape (q,).
    columns: IntArray
    drives: tuple[FloatArray, ...]  #: What each drive contributes to α, shape (L, n).

    def alone(self) -> "ActiveState":
        """The same without derivatives."""
        return replace(self, slopes=self.slopes[:0], columns=self.columns[:0])


class ActivationFilter:
    """The filter (14) at one cut-off and damping, which starts at rest.

    The cut-off f0 is in Hz, the sample time dt in s. Active states are wanted `lags` [s] before
    each sample; `columns` are those of the two where their derivatives are wanted, else −1.
    """

    def __init__(
        self,
        *,
        f0: float,
        beta: float,
        dt: float,
        lags: tuple[float, ...],
        columns: tuple[int, int] = (-1, -1),
    ) -> None:
        self._f0, self._beta, self._dt, self._lags = float(f0), float(beta), dt, lags
        self._columns = columns
        self._steady: dict[int, FloatArray] = {}

    def active_state(self, drives: Sequence[Drive]) -> ActiveState:
        """Active state of a muscle group that these excite.

        Before the recording an input is held at its first sample. That part is a step which no
        delay moves, the rest begins at zero and is moved: hence smooth in the delay at the start
        too.
        """
        shape = len(self._lags), len(drives[0].signal)
        by_filter = [k for k, column in enumerate(self._columns) if column >= 0]
        count = sum(len(drive.slopes) + (drive.delay_column >= 0) for drive in drives)
        slopes = np.zeros((count + len(by_filter), *shape))
        columns: list[int] = []
        shares = []
        for drive in drives:
            rows = np.zeros((3 if by_filter else 1, *shape))
            shares.append(rows[0])
            self._respond(drive.signal[None], drive.delay, rows)
            for row, k in enumerate(by_filter, count):
                slopes[row] += rows[1 + k]
            if drive.delay_column >= 0:
                filled = slopes[len(columns) : len(columns) + 1]
                at = self.instants(drive.delay or 0.0)
                _respond(drive.signal[None], drive.signal[:1], *at, 1, np.zeros((0, 0)), filled)
                filled *= -2.0 * math.pi * self._f0  # −α'
                columns.append(drive.delay_column)
            if drive.slopes:
                filled = slopes[len(columns) : len(columns) + len(drive.slopes)]
                self._respond(np.stack([by for _, by in drive.slopes]), drive.delay, filled)
                columns += [column for column, _ in drive.slopes]
        of = np.array([*columns, *(self._columns[k] for k in by_filter)], dtype=np.int64)
        return ActiveState(sum(shares[1:], start=shares[0]), slopes, of, tuple(shares))

    def _respond(self, signals: FloatArray, delay: float | None, rows: FloatArray) -> None:
        """Responses to inputs, (q, n), or to one and its derivatives, into rows (q or 3, L, n)."""
        first = np.zeros(len(signals)) if delay is None else signals[:, 0].copy()
        steps, back = self.instants(delay or 0.0)
        if len(rows) == len(signals):
            held = self._step_response(1, rows.shape)[0] if first.any() else np.zeros((0, 0))
            _respond(signals, first, steps, back, 0, held, rows)
            return
        for lag in range(len(steps)):
            _respond_with_derivatives(signals[0], first[0], steps[lag], back[lag], *rows[:, lag])
        if first[0] != 0.0:
            rows += first[0] * self._step_response(len(rows), rows.shape)

    def _step_response(self, count: int, shape: tuple[int, ...]) -> FloatArray:
        """Response, and with a count of three its derivatives, to a step at the first sample."""
        if count not in self._steady:
            self._steady[count] = np.zeros((count, *shape[1:]))
            self._respond(np.ones((1, shape[-1])), None, self._steady[count])
        return self._steady[count]

    def instants(self, delay: float) -> tuple[FloatArray, IntArray]:
        """Steps to what is wanted of a sample, (L, 2, 3, 2, 4), and samples to go back, (L,)."""
        return _steps(self._f0, self._beta, self._dt, tuple(lag + delay for lag in self._lags))


@lru_cache(maxsize=64)  # torque, derivatives and drives of one point ask alike
def _steps(
    f0: float, beta: float, dt: float, late: tuple[float, ...]
) -> tuple[FloatArray, IntArray]:
    """Steps that lead to instants `late` [s] before each sample, and whole samples to go back.

    They are a step of one sample and one of the part of it that lies before the instant, with their
    derivatives by f0 and beta.
    """
    steps = []
    whole = []
    for by in late:
        back = math.floor(max(by, 0.0) / dt)
        after = (back + 1) * dt - by  # the instant lies in (0, dt] after sample i − back − 1
        if after <= 0.0:  # rounding
            back = back + 1
            after = after + dt
        share = after / dt
        pair = np.stack([filter_step(f0, beta, dt), filter_step(f0, beta, after)])
        # from the inputs at both ends of the sample to those at both ends of its part
        pair[1, :, :, 2] += (1.0 - share) * pair[1, :, :, 3]
        pair[1, :, :, 3] *= share
        steps.append(pair)
        whole.append(back)
    return np.stack(steps), np.array(whole)


@inner
def _four(row: FloatArray) -> tuple[float, float, float, float]:
    return row[0], row[1], row[2], row[3]


@jit
def _respond(
    inputs: FloatArray,
    first: FloatArray,
    steps: FloatArray,
    back: IntArray,
    state: int,
    held: FloatArray,
    out: FloatArray,
) -> None:
    """α (`state` 0) or α'/ω0 (1) of inputs, (q, n), at all instants, into (q, L, n).

    Less their first samples, of which `held`, (L, n), is added where there is any.
    """
    n = inputs.shape[1]
    s00, s01, s02, s03 = _four(steps[0, 0, 0, 0])
    s10, s11, s12, s13 = _four(steps[0, 0, 0, 1])
    for j in range(len(inputs)):
        x = inputs[j]
        x0 = first[j]
        v = w = 0.0  # α and α'/ω0
        for i in range(n - 1):
            before = x[i] - x0
            now = x[i + 1] - x0
            for lag in range(len(back)):
                at = i + back[lag] + 1
                if at < n:
                    p0, p1, p2, p3 = _four(steps[lag, 1, 0, state])
                    out[j, lag, at] = p0 * v + p1 * w + (p2 * before + p3 * now)
            v, w = (
                s00 * v + s01 * w + (s02 * before + s03 * now),
                s10 * v + s11 * w + (s12 * before + s13 * now),
            )
        for lag in range(len(held)):
            for i in range(n):
                out[j, lag, i] += x0 * held[lag, i]


@jit
def _respond_with_derivatives(
    x: FloatArray,
    first: float,
    steps: FloatArray,
    back: int,
    out: FloatArray,
    by_f0: FloatArray,
    by_beta: FloatArray,
) -> None:
    """The response α, and its derivatives by f0 and beta."""
    s00, s01, s02, s03 = _four(steps[0, 0, 0])
    s10, s11, s12, s13 = _four(steps[0, 0, 1])
    f00, f01, f02, f03 = _four(steps[0, 1, 0])
    f10, f11, f12, f13 = _four(steps[0, 1, 1])
    b00, b01, b02, b03 = _four(steps[0, 2, 0])
    b10, b11, b12, b13 = _four(steps[0, 2, 1])
    p0, p1, p2, p3 = _four(steps[1, 0, 0])
    q0, q1, q2, q3 = _four(steps[1, 1, 0])
    r0, r1, r2, r3 = _four(steps[1, 2, 0])
    v = w = v_f = w_f = v_b = w_b = 0.0  # α and α'/ω0, their derivatives by f0 and by beta
    for i in range(len(x) - back - 1):
        before = x[i] - first
        now = x[i + 1] - first
        j = i + back + 1
        out[j] = p0 * v + p1 * w + (p2 * before + p3 * now)
        by_f0[j] = p0 * v_f + p1 * w_f + (q0 * v + q1 * w + (q2 * before + q3 * now))
        by_beta[j] = p0 * v_b + p1 * w_b + (r0 * v + r1 * w + (r2 * before + r3 * now))
        v_f, w_f = (
            s00 * v_f + s01 * w_f + (f00 * v + f01 * w + (f02 * before + f03 * now)),
            s10 * v_f + s11 * w_f + (f10 * v + f11 * w + (f12 * before + f13 * now)),
        )
        v_b, w_b = (
            s00 * v_b + s01 * w_b + (b00 * v + b01 * w + (b02 * before + b03 * now)),
            s10 * v_b + s11 * w_b + (b10 * v + b11 * w + (b12 * before + b13 * now)),
        )
        v, w = (
            s00 * v + s01 * w + (s02 * before + s03 * now),
            s10 * v + s11 * w + (s12 * before + s13 * now),
        )


@inner
def _phi1(z: float) -> tuple[float, float]:
    """φ1(z) = (e^z − 1)/z and its derivative, without the cancellation near zero, and fast."""
    if abs(z) > NEAR:
        grown = math.expm1(z)
        value = grown / z
        return value, (grown - value + 1.0) / z
    value = slope = 0.0
    for factor in _FACTORS:  # Horner on Σ z^j/(j+1)!
        slope = slope * z + value
        value = value * z + factor
    return value, slope


@inner
def curved_over_effort(
    envelope: float, smooth: float, reference: float, shape: float, power: float
) -> float:
    """One muscle's envelope of one sample, as `shaped` has it."""
    u = smooth / reference
    level = u * u + SMALLEST_EFFORT**2
    grown = 0.5 * math.log(level / (1.0 + SMALLEST_EFFORT**2))
    curved: float = envelope * _phi1(shape * u)[0] / _phi1(shape)[0] * math.exp(power * grown)
    return curved


@jit
def shaped(
    envelopes: FloatArray, smooth: FloatArray, reference: FloatArray, shape: float, power: float
) -> FloatArray:
    """Envelopes curved over effort so that 0 and the reference level stay what they are.

    ê = e·φ1(A·s/e_ref)/φ1(A)·((s²/e_ref² + ε²)/(1 + ε²))^(P/2), which is
    e_ref·(exp(A·e/e_ref) − 1)/(exp(A) − 1) at P = 0, and e_ref·(e/e_ref)^(1 + P) at A = 0, where e
    is as smooth as s and above ε = 0.03 of the reference.

    Parameters
    ----------
    envelopes, smooth : ndarray, shape (k, n)
        e and s.
    reference : ndarray, shape (k,)
        e_ref, in their unit.
    shape, power : float
        A and P.

    Returns
    -------
    ndarray, shape (5, k, n)
        ê and its derivatives by e, by s, by A and by P.
    """
    out = np.empty((5, *envelopes.shape))
    whole, d_whole = _phi1(shape)
    for c in range(envelopes.shape[0]):
        for i in range(envelopes.shape[1]):
            e = envelopes[c, i]
            u = smooth[c, i] / reference[c]
            part, d_part = _phi1(shape * u)
            level = u * u + SMALLEST_EFFORT**2
            grown = 0.5 * math.log(level / (1.0 + SMALLEST_EFFORT**2))
            raised = math.exp(power * grown)
            steeper = power * u / level
            out[0, c, i] = e * part / whole * raised
            out[1, c, i] = part / whole * raised
            out[2, c, i] = e * (shape * d_part + part * steeper) / (whole * reference[c]) * raised
            out[3, c, i] = e * (u * d_part - part * d_whole / whole) / whole * raised
            out[4, c, i] = out[0, c, i] * grown
    return out
