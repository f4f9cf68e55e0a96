"""Samples of a perturbed recording: what can be used, what is left out, and what is no use."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import welch

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.nerve.piece import TOP, Piece
from surae.nerve.steps import steps_of
from surae.recording import Recording

#: Least range of a movement [rad]: sensors' noise is below a tenth of a degree.
STILL = 0.002
#: Shortest piece without a gap, and least time in all [s].
SHORTEST = 5.0
LEAST = 20.0
#: Slowest sampling that shows inertia [Hz].
SLOWEST = 80.0
#: Frequency [Hz] below which 95 % of the velocity's power lies in what is no perturbation, and the
#: least ratio of that to the one below which 5 % lie: less is one frequency, a tremor or a tapping.
TOO_SLOW = 5.0
BROAD = 2.5
#: Range beyond which a slow movement is called one by will, not a perturbation.
BY_WILL = np.deg2rad(10.0)
#: A perturbation goes on: it is judged by its range in parts of so many seconds, without what is
#: gone in a mean of so many.
GOES_ON = 5.0
SEEN_OVER = 0.05
#: What of the position's power is movement, as a multiple of that at the highest frequencies.
MOVES = 4.0
#: Gap that a spline bridges [s]: single samples of 100 Hz.
BRIDGED = 0.012
#: How many times noise the position's power must be to be fitted.
EXCITED = 10.0
#: Part of its usual change below which torque is lost while the foot moves, and for how long [s];
#: changes are those of means over so many seconds, in which a plate's inertia no longer shows.
LOST = 0.1
LOST_FOR = 0.5
LOST_OVER = 0.1
#: Of a limited torque that is noisy: as many times more of it, while the foot moves, in the last
#: part of its range as in the next (of 120 legs of `legs` at most 8), and how large that part is.
PILED = 12.0
LAST_PART = (0.003, 0.01, 0.03)
#: So many times the samples of the next value below are at a limit; a smooth peak that is recorded
#: in coarse digits has 2.4 times as many at its top.
PEAK = 3.0
#: Samples around the begin of a limit in which the foot moves into it: else it rests there. Those
#: at a recording's ends have no speed.
CAME = 20
_EDGE = 5
#: Why samples are left out, and what to do about it.
MISSING = N_("without samples")
LIMITED = N_("in which the torque’s channel is at its limit")
UNANSWERED = N_("in which the torque does not answer: contact lost")
REMEDIES = {
    LIMITED: "raise the range of the torque’s channel",
    UNANSWERED: "strap the foot to the plate",
    MISSING: "look why samples are missing, or record 60 s",
}
#: Speed in the one direction as a part of that in the other, below which it does not count.
ONE_SIDED = 0.25


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
    step: float = 0.0  #: Of the position's sensor [rad], where it is coarse; NaN: unknown.

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

    def pieces(
        self, spans: Sequence[slice] | None = None, highest: float | None = None
    ) -> list[Piece]:
        """The pieces that are fitted, up to the highest frequency [Hz]: that of the band."""
        used = self.spans if spans is None else spans
        anchor = float(np.mean(np.concatenate([self.angle[s] for s in self.spans])))
        whole = (float(self.time[0]), float(self.time[-1]))
        band = self.band[0] if highest is None else highest
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

    def halves(self, highest: float | None = None) -> list[list[Piece]]:
        """The pieces of the first and of the second half of the time that is used."""
        middle = 0.5 * self.seconds * self.rate_hz
        parts: tuple[list[slice], list[slice]] = ([], [])
        done = 0.0
        for span in self.spans:
            cut = int(np.clip(span.start + middle - done, span.start, span.stop))
            done += span.stop - span.start
            for part, span_of in zip(
                parts, (slice(span.start, cut), slice(cut, span.stop)), strict=True
            ):
                if span_of.stop - span_of.start >= 0.5 * SHORTEST * self.rate_hz:
                    part.append(span_of)
        return [self.pieces(part, highest) for part in parts]


def in_gaps(known: FloatArray, clock: FloatArray, step: float) -> np.ndarray:
    """Times of a clock at which there is no sample, nor one on both sides within `BRIDGED`."""
    after = np.clip(np.searchsorted(known, clock), 1, len(known) - 1)
    gap = known[after] - known[after - 1] > max(1.6 * step, BRIDGED)
    gap |= (clock < known[0]) | (clock > known[-1])
    off = np.minimum(abs(clock - known[after]), abs(clock - known[after - 1])) > 0.4 * step
    return np.asarray(gap & off)


def measured(recording: Recording) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time, angle and torque of a recording at the angle's samples, NaN where there is none."""
    if "torque" not in recording.channels:
        raise InputError(f"{recording.where}: there is no torque; name its column torque_Nm")
    angle = recording.channels["angle"]
    torque = recording.channels["torque"]
    values = torque.values
    if not np.array_equal(angle.time, torque.time):
        step = float(np.median(np.diff(torque.time)))
        after = np.clip(np.searchsorted(torque.time, angle.time), 1, len(values) - 1)
        gap = np.diff(torque.time)[after - 1] > 1.6 * step
        inside = (angle.time >= torque.time[0]) & (angle.time <= torque.time[-1])
        values = np.where(gap | ~inside, np.nan, np.interp(angle.time, torque.time, values))
    return angle.time, angle.values, values


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
    known = time[good]
    columns = (CubicSpline(known, values[good])(clock) for values in (angle, torque))
    missing = in_gaps(known, clock, step)
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
    said, one_sided, step = _movement(
        where, angle[max(runs(known), key=lambda r: r.stop - r.start)], rate
    )
    left_out = dict[str, str]()
    left = np.zeros(len(time), bool)
    for bad, what in (
        (~known, MISSING),
        (limited(angle, torque), LIMITED),
        (_lost(angle, torque, rate), UNANSWERED),
    ):
        fresh = bad & ~left
        if fresh.any():
            left_out[what] = Message(
                N_("{seconds:.2g} s {what}"), seconds=fresh.sum() / rate, what=Message(what)
            )
            left |= bad
    spans = tuple(span for span in runs(~left) if span.stop - span.start >= SHORTEST * rate)
    notes = (*(Message(N_("Left out: {what}."), what=each) for each in left_out.values()), *said)
    samples = Samples(where, time, angle, torque, rate, spans, notes, one_sided, step)
    if samples.seconds < LEAST:
        why = f"left out: {', '.join(left_out.values())}" if left_out else "it is short"
        remedy = next((do for what, do in REMEDIES.items() if what in left_out), "record 60 s")
        raise InputError(
            f"{where}: {samples.seconds:.3g} s in pieces of {SHORTEST:g} s or more can be used, "
            f"{LEAST:g} s are needed ({why}); {remedy}"
        )
    return samples


def _movement(where: str, angle: FloatArray, rate: float) -> tuple[list[str], bool, float]:
    """Look at the movement: fast enough, by whom, in both directions, finely enough measured.

    What to know of it, a sentence each, whether it is fast in one direction only, and its step
    [rad] where it is coarse, NaN where its size does not show.
    """
    smooth = _mean(angle, max(round(SEEN_OVER * rate), 1))
    size = min(round(GOES_ON * rate), len(smooth))
    ranges = np.ptp(smooth[: len(smooth) // size * size].reshape(-1, size), axis=1)
    if (usual := float(np.median(ranges))) < STILL:
        raise InputError(
            f"{where}: the angle does not move, or not all the time (by {np.rad2deg(usual):.2g}° "
            f"in most parts of {GOES_ON:g} s); move the foot by small random perturbations, which "
            "`surae protocol prbs` makes"
        )
    f, power = welch(angle, rate, nperseg=int(min(len(angle), 8 * rate)))
    noise = float(np.mean(power[(f > 0.2 * rate) & (f < 0.4 * rate)]))
    speed = np.cumsum(power * f**2 * ((f <= 60.0) & (power > MOVES * noise)))
    slow, most = (float(f[np.searchsorted(speed, part * speed[-1])]) for part in (0.05, 0.95))
    moved = float(np.ptp(np.quantile(smooth, (0.005, 0.995))))
    if most < TOO_SLOW or most < BROAD * slow:
        fast = f"at {slow:.2g} to {most:.2g} Hz alone"
        if most < TOO_SLOW:
            fast = f"hardly faster than {most:.2g} Hz"
        what = f"{where}: the angle moves by {np.rad2deg(moved):.2g}°, {fast}"
        if moved > BY_WILL:
            raise InputError(
                f"{what}: a movement by will or by hand, not a perturbation; let the device move "
                "the foot at random by 2°, up to 10 Hz at least, or use `surae stretches`"
            )
        raise InputError(
            f"{what}: too little bandwidth to tell tissue, inertia and reflex apart, or a movement "
            "by will; let the device move a foot that holds still, up to 10 Hz at least, as "
            "`surae protocol prbs` does"
        )
    notes = list[str]()
    speeds = np.quantile(np.diff(_mean(angle, max(round(0.01 * rate), 1))) * rate, (0.005, 0.995))
    one_sided = bool(min(abs(speeds)) < ONE_SIDED * max(abs(speeds)))
    if one_sided:
        way = "dorsiflexion" if speeds[1] > -speeds[0] else "plantarflexion"
        notes.append(
            Message(
                N_(
                    "The foot moves fast in {way} only: tissue and reflex look alike; "
                    "perturb in both directions."
                ),
                way=Message(way),
            )
        )
    step, note = steps_of(angle, rate)
    if note is not None:
        notes.append(note)
    return notes, one_sided, step


def _mean(values: FloatArray, n: int) -> FloatArray:
    """Mean of every n samples in a row, shape (len − n + 1,)."""
    total = np.concatenate([[0.0], np.cumsum(values - values.mean())])
    return np.asarray((total[n:] - total[:-n]) / n + values.mean())


def runs(mask: np.ndarray) -> list[slice]:
    """Stretches of samples that are true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _wider(mask: np.ndarray, by: int) -> np.ndarray:
    wide = mask.copy()
    for run in runs(mask):
        wide[max(run.start - by, 0) : run.stop + by] = True
    return wide


def limited(angle: FloatArray, torque: FloatArray) -> np.ndarray:
    """Samples at an end of the torque's range for four samples or more.

    They are at one value, or, of a channel that is noisy behind what limits it, as near to the end
    as is much more of the torque while the foot moves than is a little farther from it. Nothing
    goes beyond a limit; and where the foot rests at that value, or a recorder's digits give the
    next one nearly as many samples, it is none.
    """
    at_limit = np.zeros(len(torque), bool)
    speed = np.abs(np.gradient(np.convolve(filled(angle), np.ones(5) / 5, "same")))
    moving = np.isfinite(torque) & (speed > 0.2 * np.quantile(speed, 0.99))
    for sign in (1.0, -1.0):
        signed = sign * torque
        top = float(np.nanmax(signed))
        near = [1e-6 * max(abs(top), 1e-9)]
        equal = signed >= top - near[0]
        below = float(np.nanmax(np.where(equal, -np.inf, signed)))
        ends = int(np.count_nonzero(equal))
        digits = np.count_nonzero(signed >= below - near[0]) - ends > ends / PEAK
        low, high = np.quantile(signed[moving], (0.0005, 0.9995))
        for part in LAST_PART:
            width = part * float(high - low)
            last = np.sum(signed[moving] > high - width)
            distance = (high - signed[moving]) / width
            farther = np.sum((distance >= 1.5) & (distance < 2.5))
            beyond = top - high > width
            if last > PILED * (farther + 0.001 * moving.sum() + 5.0) and not beyond:
                near.append(top - high + width)
        rest = signed[np.isfinite(signed) & ~moving]
        rests = rest.size and float(np.median(rest)) >= top - max(near)
        if rests or (digits and len(near) == 1):
            continue
        at = signed >= top - max(near)
        for run in runs(at):
            came = moving[max(run.start - CAME, _EDGE) : run.start + CAME].any()
            if run.stop - run.start >= 4 and came:
                at_limit[run] = True
    return at_limit


def filled(values: FloatArray) -> FloatArray:
    """Values with lines through gaps."""
    known = np.isfinite(values)
    at = np.arange(len(values))
    return np.interp(at, at[known], values[known])


def _lost(angle: FloatArray, torque: FloatArray, rate: float) -> np.ndarray:
    """Samples of windows in which the foot moves as ever and the torque hardly changes."""
    short = max(round(LOST_OVER * rate), 1)
    window = max(round(LOST_FOR * rate), 2)
    changes = []
    for values in (angle, torque):
        mean = _mean(filled(values), short)
        change = np.zeros(len(values))
        change[short : short + len(mean) - short] = (mean[short:] - mean[:-short]) ** 2
        total = np.concatenate([[0.0], np.cumsum(change)])
        middle = np.clip(np.arange(len(values)) - window // 2, 0, len(values) - window)
        changes.append(np.sqrt((total[middle + window] - total[middle]) / window))
    moves, answers = changes
    lost = (moves > 0.5 * np.median(moves)) & (answers < LOST * np.median(answers))
    lost &= np.isfinite(torque)
    for run in runs(lost):
        lost[run] = run.stop - run.start >= short
    return _wider(lost, window)
