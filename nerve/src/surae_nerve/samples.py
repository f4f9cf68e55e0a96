"""Samples of a perturbed recording: what can be used, what is left out, and what is no use."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import welch

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae_nerve.piece import TOP, Piece

#: Least range of a movement [rad]: sensors' noise is below a tenth of a degree.
STILL = 0.002
#: Shortest piece without a gap, and least time in all [s].
SHORTEST, LEAST = 5.0, 20.0
#: Slowest sampling that shows inertia [Hz].
SLOWEST = 80.0
#: Frequency [Hz] below which 95 % of the velocity's power lies in what is no perturbation.
TOO_SLOW = 5.0
#: Range beyond which a slow movement is called one by will, not a perturbation.
BY_WILL = np.deg2rad(10.0)
#: How many times noise the position's power must be to be fitted.
EXCITED = 10.0
#: Part of its usual change below which torque is lost while the foot moves, and for how long [s].
LOST, LOST_FOR = 0.1, 0.5
#: Speed in the one direction as a part of that in the other, below which it does not count.
ONE_SIDED = 0.25
#: Step of an encoder as a part of the position's standard deviation, from which it is named.
COARSE = 0.1


@dataclass(frozen=True, slots=True)
class Samples:
    """One recording on one uniform clock, with what of it can be used."""

    where: str  #: How messages call it.
    time: FloatArray  #: [s], shape (n,).
    angle: FloatArray  #: [rad], dorsiflexion positive, shape (n,).
    torque: FloatArray  #: [Nm], resisting the movement, shape (n,).
    rate_hz: float  #: Samples a second.
    spans: tuple[slice, ...]  #: Pieces that are used.
    notes: tuple[str, ...]  #: What was left out or is to be known, a sentence each.
    one_sided: bool = False  #: Whether it is fast in one direction only.

    @property
    def seconds(self) -> float:
        """Time that is used [s]."""
        return float(sum(span.stop - span.start for span in self.spans)) / self.rate_hz

    @property
    def band(self) -> tuple[float, float]:
        """Highest frequency that is excited [Hz], and the position's floor k of k/f² [rad²·Hz]."""
        longest = max(self.spans, key=lambda span: span.stop - span.start)
        angle = self.angle[longest]
        segment = int(min(len(angle) // 8, 2 * self.rate_hz))
        f, power = welch(angle - angle.mean(), self.rate_hz, nperseg=segment)
        high = (f > 0.2 * self.rate_hz) & (f < 0.4 * self.rate_hz)
        floor = float(np.exp(np.mean(np.log(power[high] * f[high] ** 2 + 1e-30))))
        half = max(1, int(1.5 / f[1]))
        smooth = np.exp(
            np.convolve(np.log(power + 1e-30), np.ones(2 * half + 1) / (2 * half + 1), "same")
        )
        dull = np.flatnonzero((f > 2.0) & (smooth <= EXCITED * floor / np.maximum(f, 0.1) ** 2))
        top = min(TOP, 0.36 * self.rate_hz)
        return float(np.clip(f[dull[0]] if len(dull) else top, 8.0, top)), floor

    def pieces(self, spans: Sequence[slice] | None = None) -> list[Piece]:
        """The pieces that are fitted."""
        used = self.spans if spans is None else spans
        anchor = float(np.mean(np.concatenate([self.angle[s] for s in self.spans])))
        whole, band = (float(self.time[0]), float(self.time[-1])), self.band[0]
        return [
            Piece(
                self.time[s],
                self.angle[s],
                self.torque[s],
                self.rate_hz,
                band,
                anchor=anchor,
                span=whole,
            )
            for s in used
        ]

    def halves(self) -> list[list[Piece]]:
        """The pieces of the first and of the second half of the time that is used."""
        middle = 0.5 * self.seconds * self.rate_hz
        parts: tuple[list[slice], list[slice]] = ([], [])
        done = 0.0
        for span in self.spans:
            cut = int(np.clip(span.start + middle - done, span.start, span.stop))
            done += span.stop - span.start
            for part, own in zip(
                parts, (slice(span.start, cut), slice(cut, span.stop)), strict=True
            ):
                if own.stop - own.start >= 0.5 * SHORTEST * self.rate_hz:
                    part.append(own)
        return [self.pieces(part) for part in parts]


def on_one_clock(
    where: str, time: FloatArray, angle: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Time, angle, torque on a uniform clock, NaN where there is a gap; and its rate [Hz]."""
    step = float(np.median(np.diff(time)))
    rate = 1.0 / step
    if rate < SLOWEST:
        raise InputError(
            f"{where}: {rate:.3g} samples a second are too few to see inertia and reflex; record "
            "angle and torque at 200 Hz or more"
        )
    clock = time[0] + step * np.arange(round((time[-1] - time[0]) / step) + 1)
    good = np.isfinite(angle) & np.isfinite(torque)
    if good.sum() < 2:
        raise InputError(f"{where}: angle and torque have no samples in common; look at the file")
    columns = [np.interp(clock, time[good], values[good]) for values in (angle, torque)]
    after = np.clip(np.searchsorted(time[good], clock), 1, good.sum() - 1)
    gap = time[good][after] - time[good][after - 1] > 1.6 * step
    off = (
        np.minimum(abs(clock - time[good][after]), abs(clock - time[good][after - 1])) > 0.4 * step
    )
    missing = gap & off
    return clock, *(np.where(missing, np.nan, values) for values in columns), rate


def usable(where: str, time: FloatArray, angle: FloatArray, torque: FloatArray) -> Samples:
    """Choose what can be used of a recording.

    Raises
    ------
    InputError
        It is no perturbation, or too little of it can be used; the message says what to do.
    """
    time, angle, torque, rate = on_one_clock(where, time, angle, torque)
    known = np.isfinite(angle)
    if float(np.ptp(angle[known])) < STILL:
        raise InputError(
            f"{where}: the angle does not move ({np.rad2deg(np.ptp(angle[known])):.2g}°); move the "
            "foot by small random perturbations, which `surae protocol prbs` makes"
        )
    left_out, left, limited = [], np.zeros(len(time), bool), _saturated(torque)
    for found, what in (
        (~known, "without samples"),
        (limited, "in which the torque's channel is at its limit"),
        (_lost(angle, torque, rate), "in which the torque does not answer: contact lost"),
    ):
        fresh = found & ~left
        if fresh.any():
            left_out.append(f"{fresh.sum() / rate:.2g} s {what}")
            left |= found
    spans = tuple(
        span for span in runs(~left) if span.stop - span.start >= SHORTEST * rate
    )  # fmt: skip
    notes = tuple(f"Left out: {each}." for each in left_out)
    samples = Samples(where, time, angle, torque, rate, spans, notes)
    if samples.seconds < LEAST:
        why = f"left out: {left_out[0]}" if left_out else "it is short"
        by_limit = known.all() and limited.any()
        remedy = "raise the range of the torque's channel" if by_limit else "record 60 s"
        raise InputError(
            f"{where}: {samples.seconds:.3g} s in pieces of {SHORTEST:g} s or more can be used, "
            f"{LEAST:g} s are needed ({why}); {remedy}"
        )
    return _moving(samples)


def _moving(samples: Samples) -> Samples:
    """Look at the movement: fast enough, by whom, in both directions, finely enough measured."""
    where, rate = samples.where, samples.rate_hz
    longest = max(samples.spans, key=lambda span: span.stop - span.start)
    angle = samples.angle[longest]
    f, power = welch(angle, rate, nperseg=int(min(len(angle), 8 * rate)))
    below = np.minimum(f, 60.0) == f
    speed = np.cumsum((power * f**2)[below])
    most = float(f[below][np.searchsorted(speed, 0.95 * speed[-1])])
    notes, moved = list(samples.notes), float(np.ptp(angle))
    if most < TOO_SLOW:
        span = np.rad2deg(moved)
        what = f"{where}: the angle moves by {span:.2g}°, hardly faster than {most:.2g} Hz"
        if moved > BY_WILL:
            raise InputError(
                f"{what}: a movement by will or by hand, not a perturbation; let the device move "
                "the foot at random by 2°, up to 10 Hz at least, or use `surae stretches`"
            )
        raise InputError(
            f"{what}: too little bandwidth to tell tissue, inertia and reflex apart; perturb up to "
            "10 Hz at least, as `surae protocol prbs` does"
        )
    smooth = np.convolve(
        angle, np.ones(max(round(0.01 * rate), 1)) / max(round(0.01 * rate), 1), "valid"
    )
    speeds = np.quantile(np.diff(smooth) * rate, (0.005, 0.995))
    one_sided = min(abs(speeds)) < ONE_SIDED * max(abs(speeds))
    if one_sided:
        way = "dorsiflexion" if speeds[1] > -speeds[0] else "plantarflexion"
        notes.append(
            f"The foot moves fast in {way} only: tissue and reflex look alike; perturb "
            "in both directions."
        )
    steps = np.abs(np.diff(angle))
    moving = steps[steps > 1e-9]
    step = float(np.quantile(moving, 0.05)) if len(moving) else 0.0
    if len(moving) < 0.9 * len(steps) and step > COARSE * float(np.std(angle)):
        notes.append(
            f"The position comes in steps of {np.rad2deg(step):.2g}°, coarse beside its movement: "
            "use a finer encoder or larger perturbations."
        )
    return replace(samples, notes=tuple(notes), one_sided=one_sided)


def runs(mask: np.ndarray) -> list[slice]:
    """Stretches of samples that are true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _wider(mask: np.ndarray, by: int) -> np.ndarray:
    wide = mask.copy()
    for run in runs(mask):
        wide[max(run.start - by, 0) : run.stop + by] = True
    return wide


def _saturated(torque: FloatArray) -> np.ndarray:
    """Samples at the ends of the torque's range for four samples or more, several times."""
    found = np.zeros(len(torque), bool)
    known = torque[np.isfinite(torque)]
    for end in (known.min(), known.max()):
        at = np.abs(torque - end) <= 1e-6 * max(abs(end), 1e-9)
        for run in runs(at):
            if run.stop - run.start >= 4:
                found[run] = True
    return found


def _lost(angle: FloatArray, torque: FloatArray, rate: float) -> np.ndarray:
    """Samples of windows in which the foot moves as ever and the torque hardly changes."""
    short, window = max(round(0.01 * rate), 1), max(round(LOST_FOR * rate), 2)
    changes = []
    for values in (angle, torque):
        filled = np.where(np.isfinite(values), values, np.nanmean(values))
        total = np.concatenate([[0.0], np.cumsum(filled - filled.mean())])
        mean = (total[short:] - total[:-short]) / short
        change = np.zeros(len(values))
        change[short : short + len(mean) - short] = (mean[short:] - mean[:-short]) ** 2
        total = np.concatenate([[0.0], np.cumsum(change)])
        middle = np.clip(np.arange(len(values)) - window // 2, 0, len(values) - window)
        changes.append(np.sqrt((total[middle + window] - total[middle]) / window))
    moves, answers = changes
    lost = (moves > 0.5 * np.median(moves)) & (answers < LOST * np.median(answers))
    found = np.zeros(len(angle), bool)
    for run in runs(lost):
        found[run] = True
    return _wider(found, window // 2) if found.any() else found
