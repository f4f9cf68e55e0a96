"""A device that yields: the torque of the leg moves it too, and angle and torque make a loop.

In a loop the torque that a person makes by the way moves the foot, and least squares take the
device's own impedance for a part of the leg's. Where what the device was told to do is recorded,
the part of the angle that follows it is free of that (the two-stage method of Van den Hof and
Schrama, *Automatica* 29 (1993) 1523). Without it, the loop shows where torque is followed by
movement that no tissue and no reflex makes: by an angle that comes after it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import firwin, resample_poly, upfirdn

from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.nerve.fitting import Problem, solved
from surae.nerve.judged import Number
from surae.nerve.piece import TOP, Piece
from surae.nerve.response import WIDTH, free_noise, lagged
from surae.nerve.samples import Samples
from surae.recording import Recording

#: Channel of the angle that the device was told to take.
COMMAND = "commanded_angle"
#: Times by which the angle may come after a torque that moved it [s]: beyond both sides of what
#: tissue's response takes, and as long as a servo of 3 Hz goes on.
AFTER = (0.04, 0.4)
#: The z of such movement from which the device yields: of 38 legs in stiff devices (`legs`, qa to
#: qj, movements that do not come again) at most 3.3, of three measured records at most 0.6.
YIELDS = 3.5
#: Time constant with which a small motor gives way [s].
GIVES = 0.05
#: Correlation of the velocity with itself a period later from which a movement comes again, and
#: the part that does not from which the leg moves the device; of stiff ones it is below 1e-4.
PERIODIC = 0.6
APERIODIC = 0.005
#: Part of the velocity's variance that does not follow a recorded command, from which it yields,
#: and from which the command says nothing of it.
FREE = 0.01
NOT_ITS_OWN = 0.5
#: The same from which it is not told whether there is a reflex, which answers all of the velocity.
#: Its gain and share come out too small by up to the half (20 virtual ankles, seeds 201 to 220) and
#: are not told at all; so a greatest share may be twice as large.
TOO_FREE = 0.05
BLURRED = 2.0
#: What the command's response may be wrong by, a part of every number beside what it leaves.
UNSURE = 0.03
#: Rate at which a device's response to its command is estimated [Hz], and its first and last lag
#: [s]: a recorder's clock may be ahead.
_RATE = 250.0
_LAGS = (-0.02, 0.6)
#: What keeps the response from what the command does not excite.
_RIDGE = 1e-6
#: Why nothing is told, and what was done.
DEVICE_YIELDS = N_(
    "the device yields: the leg’s torque moves it, so that its angle and torque tell both; record "
    "its command (commanded_angle), or use a stiffer one"
)
LEG_DRIVES = N_(
    "the device yields, or the leg drives it: a movement by will, or an angle and a torque that do "
    "not belong together; record the device's command (commanded_angle), and perturb a "
    "leg that holds still"
)
TOO_MUCH = N_(
    "the device yields: {part:.0f} % of the velocity does not follow its command, and a reflex "
    "answers that too"
)
BY_COMMAND = N_(
    "The device yields: all numbers are of the movement that follows its recorded command, "
    "{part:.0f} % of the velocity’s variance left out."
)


@dataclass(frozen=True, slots=True)
class Loop:
    """Whether the leg moves its device, and the movement that it does not."""

    yields: bool  #: Whether it does.
    samples: Samples | None = None  #: With the angle that follows the command, where that is known.
    free: float = 0.0  #: Part of the velocity's variance that does not follow it.

    @property
    def told(self) -> bool:
        """Whether numbers of the leg can be told."""
        return not self.yields or self.samples is not None

    def widened(self, number: Number) -> Number:
        """A number of tissue with what the device's own movement may do in its interval."""
        return number.allowing(self.free + UNSURE)


def loop_of(recording: Recording, samples: Samples, pieces: Sequence[Piece]) -> Loop:
    """Whether the device yields; by its command where that is recorded."""
    yields = _moves_alone(samples, pieces)
    if COMMAND not in recording.channels:
        return Loop(yields)
    channel = recording.channels[COMMAND]
    command = np.interp(samples.time, channel.time, channel.values)
    known = np.concatenate([np.arange(len(samples.time))[span] for span in samples.spans])
    angle = np.interp(np.arange(len(samples.time)), known, samples.angle[known])
    followed = following(command, angle, samples.rate_hz)
    free = _unexplained(angle, followed, samples.rate_hz)
    if free > NOT_ITS_OWN or not (yields or free > FREE):
        return Loop(yields or free > NOT_ITS_OWN)
    note = Message(BY_COMMAND, part=100.0 * free)
    driven = replace(samples, angle=followed, notes=(*samples.notes, note))
    return Loop(True, driven, free)


def _moves_alone(samples: Samples, pieces: Sequence[Piece]) -> bool:
    """Whether the angle moves with the leg's torque, as far as it tells that by itself.

    A movement that comes again is one that was commanded: what does not come again is none. Tissue
    that bends makes a torque there that any other time of the same movement predicts.
    """
    span = max(samples.spans, key=lambda span: span.stop - span.start)
    again = comes_again(samples.angle[span], samples.rate_hz)
    if again > PERIODIC:
        return 1.0 - again > APERIODIC
    return moved_after(pieces) > YIELDS


def comes_again(angle: FloatArray, rate_hz: float) -> float:
    """Largest correlation of the velocity with itself a second or more later, up to a half."""
    n = len(angle)
    edge = max(round(0.05 * rate_hz), 1)
    level = angle - np.linspace(angle[:edge].mean(), angle[-edge:].mean(), n)
    f = np.fft.rfftfreq(n, 1.0 / rate_hz)
    highest = min(0.5 * TOP, 0.2 * rate_hz)
    passed = np.clip((f - 0.3) / 0.3, 0.0, 1.0) * np.clip(0.5 * (highest - f), 0.0, 1.0)
    velocity = np.fft.irfft(np.fft.rfft(level) * f * passed, n)[n // 15 : n - n // 15]
    size = len(velocity)
    spectrum = np.fft.rfft(velocity, 2 * size)
    products = np.fft.irfft(np.abs(spectrum) ** 2)[:size]
    squares = np.concatenate([[0.0], np.cumsum(velocity**2)])
    lags = np.arange(round(rate_hz), size // 2)
    if not len(lags):
        return 0.0
    whole = np.sqrt(squares[size - lags] * (squares[-1] - squares[lags]))
    return float(np.max(products[lags] / (whole + 1e-300)))


def moved_after(pieces: Sequence[Piece]) -> float:
    """The z of an angle that comes after a torque, beside responses of tissue and reflex.

    A leg's torque follows its angle, by less than half a second; torque that an angle follows is
    one that moves the device. Effort at any time is noise to a device that does not yield. Every
    lag is asked, and a device that gives way softly and at once, which few numbers describe; the
    larger z is told.
    """
    free = Problem(pieces, free_noise(pieces))
    rate = pieces[0].rate
    first = AFTER[0] + 0.5 / float(pieces[0].f[-1])
    ahead = np.arange(np.ceil(first * rate), np.floor(AFTER[1] * rate) + 1) / rate
    behind = np.arange(np.floor(WIDTH * rate) + 1, np.floor(AFTER[1] * rate) + 1) / rate
    least = np.inf
    rows = free.y[None]
    for direction in (1, -1):
        regressors = [
            np.concatenate(
                [
                    lagged(p, direction, rate),
                    p.angle * np.exp(-np.outer(behind, p.s)),
                    p.squared[None],
                ]
            )
            for p in pieces
        ]
        x = free.whitened(regressors)
        left = free.y - solved(x, free.y) @ x
        if float(left @ left) < least:
            least = float(left @ left)
            rows = x
    any_lag = [p.angle * np.exp(np.outer(ahead, p.s)) for p in pieces]
    soft = [
        np.stack([p.angle * np.exp(first * p.s) / (1.0 - GIVES * p.s) ** k for k in (1, 2, 3)])
        for p in pieces
    ]
    return max(_gained(free, rows, least, free.whitened(more)) for more in (any_lag, soft))


def _gained(free: Problem, rows: FloatArray, least: float, more: FloatArray) -> float:
    """The z of what more rows leave of what some rows leave."""
    every = np.concatenate([rows, more])
    left = free.y - solved(every, free.y) @ every
    rest = float(left @ left)
    freedom = max(len(free.y) - len(every), 1)
    gained = (least - rest) / (rest / freedom + 1e-300) - len(more)
    return gained / float(np.sqrt(2.0 * len(more)))


def following(command: FloatArray, angle: FloatArray, rate_hz: float) -> FloatArray:
    """The part of an angle [rad] that follows a command by a linear response, shape (n,).

    The response is estimated at a coarse rate, by least squares of the differences.
    """
    step = max(1, round(rate_hz / _RATE))
    commanded = command - command[0]
    coarse = [
        resample_poly(of, 1, step) if step > 1 else of for of in (commanded, angle - angle[0])
    ]
    rate = rate_hz / step
    lags = np.arange(round(_LAGS[0] * rate), round(_LAGS[1] * rate) + 1)
    changes = [np.diff(of) for of in coarse]
    rows = np.stack([_shifted(changes[0], int(lag)) for lag in lags])
    response = solved(rows, changes[1], _RIDGE)
    if step > 1:
        smooth = firwin(4 * step + 1, 1.0 / step) * step
        response = upfirdn(smooth, response, step)[2 * step : 2 * step + (len(lags) - 1) * step + 1]
        response = response / step
    first = lags[0] * step
    pad = len(response)
    whole = np.pad(commanded, pad, mode="edge")
    followed = np.convolve(whole, response)[pad - first :][: len(commanded)]
    return np.asarray(followed + np.mean(angle - followed))


def _shifted(values: FloatArray, lag: int) -> FloatArray:
    """Values that come later by so many samples, none before their begin."""
    moved = np.zeros_like(values)
    if lag >= 0:
        moved[lag:] = values[: len(values) - lag]
    else:
        moved[:lag] = values[-lag:]
    return moved


def _unexplained(angle: FloatArray, followed: FloatArray, rate_hz: float) -> float:
    """Part of the velocity's variance, up to the highest frequency that is fitted, in the rest."""
    f = np.fft.rfftfreq(len(angle), 1.0 / rate_hz)
    used = (f > 0.5) & (f < min(0.5 * TOP, 0.2 * rate_hz))

    def power(of: FloatArray) -> float:
        spectrum = np.fft.rfft((of - of.mean()) * np.hanning(len(of)))
        return float(np.sum(np.abs(spectrum[used] * f[used]) ** 2))

    return power(angle - followed) / max(power(angle), 1e-300)
