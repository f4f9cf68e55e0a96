"""What small random perturbations say of one ankle: tissue and reflex, and what each is worth."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from surae.base.frozen import FrozenDict, freeze
from surae.base.words import N_, Message
from surae.nerve.cascade import muscle
from surae.nerve.channels import in_channels
from surae.nerve.fitting import Fitted, Problem, noise_of
from surae.nerve.identify import CHANGING, Cascade, identify
from surae.nerve.judged import INTRINSIC, Judged, Number
from surae.nerve.measures import MEASURES, NerveMeasure, number_of
from surae.nerve.other_structures import MISFIT, PLAIN
from surae.nerve.perturbed_records import Curves, Perturbed, ReflexPath, Stationarity
from surae.nerve.piece import Piece
from surae.nerve.presence import Weighed
from surae.nerve.reflex_claim import BEHIND, claimed, in_loop, judged
from surae.nerve.response import falls_short, lags, predicted, responses
from surae.nerve.samples import Samples, measured, usable
from surae.nerve.triggered import answering
from surae.nerve.turned import turned
from surae.nerve.yielding import loop_of
from surae.recording import Recording


def perturbed(recording: Recording, empty: NerveMeasure | None = None) -> Perturbed:
    """What one recording says of its leg; `empty` is the inertia of the device alone.

    Raises
    ------
    InputError
        It has no torque, is no perturbation, or too little of it can be used.
    """
    samples, pieces = turned(samples_of(recording))
    loop = loop_of(recording, samples, pieces)
    if loop.samples is not None:
        band, samples = samples.band, loop.samples
        pieces = samples.pieces(highest=band[0])
    else:
        band = samples.band
    halves = samples.halves(band[0])
    said: list[ReflexPath] = []

    def judge(
        direction: int, weighed: Weighed, share: Number, fitted: Fitted, unseen: tuple[float, float]
    ) -> bool:
        said.append(judged(weighed, share, fitted, direction, samples, unseen))
        return said[-1].verdict == "present"

    cascade = identify(pieces, halves, band[1], judge)
    behind = falls_short(pieces, [cascade.fitted.prediction(p) for p in pieces])
    claims = in_loop(claimed(cascade, said[-1], behind), loop, cascade)
    claims, limited = in_channels(claims, samples, Problem(pieces, cascade.noise), cascade, band[0])
    measures = {
        name: number_of(
            name,
            claims.numbers.get(name),
            "" if name in claims.numbers else claims.refused.get(name, claims.why),
            claims.hidden.get(name, (0.0, np.inf)),
        )
        for name in MEASURES
    }
    measures["inertia"] = _without(measures["inertia"], empty)
    stationarity = _stationarity(cascade)
    notes = [*samples.notes, *_notes(pieces, cascade, limited or behind > BEHIND)]
    if heard := answering(recording, samples, cascade.direction):
        notes.append(heard)
    if stationarity.verdict == "changes":
        notes.append(
            Message(N_("The stiffness changes during the recording: its value is a mean."))
        )
    path = 1 if cascade.direction > 0 else -1
    return Perturbed(
        recording.files[0].path if recording.files else recording.name,
        samples.seconds,
        float(np.mean([samples.torque[s].mean() for s in samples.spans])),
        float(np.rad2deg(np.mean([samples.angle[s].mean() for s in samples.spans]))),
        predicted(pieces, pieces, path),
        predicted(halves[1], halves[0], path),
        predicted(halves[1], halves[0], 0),
        predicted(halves[1], halves[0], -path),
        claims.reflex,
        FrozenDict(measures),
        FrozenDict({n: (k.value, k.low, k.high) for n, k in cascade.structures.items()}),
        stationarity,
        tuple(notes),
        _curves(pieces, cascade, path),
    )


def _notes(pieces: Sequence[Piece], cascade: Cascade, limited: bool) -> Iterator[Message]:
    """What makes numbers less sure, and what to do about it."""
    if limited:
        yield Message(
            N_(
                "The torque stays behind at its largest, as if its channel were at "
                "its limit: raise its range, and do not filter what was limited."
            )
        )
    if any(np.any(piece.jumps) for piece in pieces):
        yield Message(
            N_(
                "The torque jumps between samples, so that its time is known to half "
                "a sample and viscosity and inertia are less sure: filter it before "
                "it is sampled, or record faster."
            )
        )
    if cascade.misfit > MISFIT:
        yield Message(
            N_(
                "The equations miss something that the torque shows: intervals "
                "contain what other structures say, by their values."
            )
        )


def samples_of(recording: Recording) -> Samples:
    """Angle and torque of a recording on one clock."""
    return usable(recording.where, *measured(recording))


def inertia_of_empty(recording: Recording) -> NerveMeasure:
    """Inertia of a device that moves without a foot."""
    samples, pieces = turned(samples_of(recording))
    del samples
    noise = noise_of(pieces, [p.bins(p.torque) for p in pieces])
    for _ in range(3):
        problem = Problem(pieces, noise)
        fitted = problem.fit(PLAIN, {})
        noise = noise_of(pieces, [fitted.residual(p) for p in pieces])
    return number_of("inertia", Judged(problem, fitted).number("inertia", INTRINSIC["inertia"]))


def _without(whole: NerveMeasure, empty: NerveMeasure | None) -> NerveMeasure:
    """The foot's inertia, where the device's is known."""
    if whole.value is None:
        return whole
    if empty is None or empty.value is None:
        return replace(
            whole, note=Message(N_("of foot and device together: the empty device was not given"))
        )
    half = float(np.hypot(np.ptp(whole.ci95), np.ptp(empty.ci95))) / 2.0
    value = whole.value - empty.value
    note = Message(
        N_("of the foot alone: the empty device’s {inertia:.3g} kg·m² is taken off"),
        inertia=empty.value,
    )
    return number_of("inertia", Number(value, value - half, value + half), note)


def _stationarity(cascade: Cascade) -> Stationarity:
    a, b = cascade.halves
    apart = abs(a.value - b.value) > np.hypot(a.high - a.low, b.high - b.low)
    verdict: Literal["steady", "changes"] = (
        "changes" if cascade.scattered or abs(cascade.trend) > CHANGING or apart else "steady"
    )
    halves = tuple((each.value, each.low, each.high) for each in cascade.halves)
    return Stationarity(verdict, halves, tuple(map(tuple, cascade.parts.tolist())), cascade.trend)


def _curves(pieces: Sequence[Piece], cascade: Cascade, direction: int) -> Curves:
    """Frequency and impulse responses of the longest piece, with those of the equations."""
    from scipy.signal import csd, welch

    piece = max(pieces, key=lambda piece: piece.length)
    fitted = cascade.fitted
    intrinsic = replace(fitted.structure, direction=0, threshold=False)
    alone = Fitted(intrinsic, fitted.values, 0.0, ())
    spectra = (piece.angle, piece.torque, fitted.prediction(piece), alone.prediction(piece))
    angle, torque, model, tissue = (piece.signals(each) for each in spectra)
    size = int(min(2 * piece.rate, len(angle) // 8))
    f, power = welch(angle, piece.rate, nperseg=size)
    _, spread = welch(torque, piece.rate, nperseg=size)
    ratios = [
        csd(angle, each, piece.rate, nperseg=size)[1] / power for each in (torque, model, tissue)
    ]
    used = (f >= 0.5) & (f <= piece.f[-1])
    coherence = np.abs(ratios[0]) ** 2 * power / spread
    gain, model_gain, own_gain = (np.abs(each[used]) for each in ratios)
    phase, model_phase = (np.rad2deg(np.angle(each[used])) for each in ratios[:2])
    lag = lags(piece.rate, True)
    v = fitted.values
    free = responses(pieces, direction, v.get("threshold", 0.0))
    shape = np.zeros(len(lag))
    if fitted.structure.direction:
        h = v["gain"] * muscle(piece.s, v["omega"], v["zeta"]) * np.exp(-piece.s * v["delay"])
        h = (
            np.fft.irfft(h * np.exp(-((np.abs(piece.s) / (60.0 * np.pi)) ** 2)), piece.m)
            * piece.rate
        )
        shape = h[np.round(lag * piece.rate).astype(int)]
    arrays = (
        f[used],
        coherence[used],
        gain,
        phase,
        model_gain,
        model_phase,
        own_gain,
        lag,
        shape,
        free[1] * piece.rate,
        lags(piece.rate, False),
        free[0] * piece.rate,
    )
    return Curves(*(freeze(np.ascontiguousarray(each, dtype=np.float64)) for each in arrays))
