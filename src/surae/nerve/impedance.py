"""What small random perturbations say of one ankle: tissue and reflex, and what each is worth."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import Comparable, FrozenDict, freeze
from surae.base.records import FileName
from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.inference.judging.verdict import OF_REFLEX, PART, Verdict, verdict_of
from surae.nerve.cascade import BOUNDS, muscle
from surae.nerve.fitting import Fitted, Problem, noise_of
from surae.nerve.identify import CHANGING, Cascade, identify
from surae.nerve.judged import INTRINSIC, Judged, Number
from surae.nerve.other_structures import MISFIT, PLAIN
from surae.nerve.piece import Piece
from surae.nerve.presence import LEAST_SHARE, NATS, NONE_SEEN, OVER_NONE, OVER_OTHER, Weighed
from surae.nerve.response import falls_short, lags, predicted, responses
from surae.nerve.samples import Samples, measured, usable
from surae.nerve.triggered import answering
from surae.recording import Recording

ReflexVerdict = Literal["present", "none seen", "cannot tell"]
#: Of directions of movement, by their sign.
DIRECTIONS = {1: "dorsiflexion", -1: "plantarflexion"}
#: By how many of its deviations torque may stay behind at its ends: of 24 legs (qa to qj) at most
#: 0.08; 0.3 to 0.9 where a fifth of it or more was limited, and then filtered.
BEHIND = 0.15
#: Latenesses of the torque [s] that are tried beyond those that are estimated (± 8 ms), where it
#: would else be of the other sign.
LATER = (0.016, 0.03)
#: Why no number of a reflex is identified, however narrow its interval.
ONE_LAW = Message(
    N_("of a reflex to velocity, to velocity and length or to force; another law may give another")
)

#: Unit and meaning of every measure.
MEASURES = {
    "intrinsic_stiffness": ("Nm/rad", "stiffness of the joint's tissue at low frequency"),
    "intrinsic_viscosity": ("Nm·s/rad", "viscosity of the joint's tissue at low frequency"),
    "inertia": ("kg·m²", "inertia of the foot and of what moves with it beyond the sensor"),
    "reflex_gain": ("Nm·s/rad", "reflex's steady torque for a velocity of stretch"),
    "reflex_delay": ("ms", "time from stretch to the reflex's torque"),
    "reflex_share": ("%", "share of the torque's variance above 0.5 Hz that the reflex makes"),
    "reflex_frequency": ("Hz", "natural frequency of the reflex's torque"),
    "reflex_damping": ("1", "damping ratio of the reflex's torque"),
    "reflex_threshold": ("deg/s", "velocity from which the reflex answers"),
}


@dataclass(frozen=True, slots=True)
class NerveMeasure:
    """One number and what it is worth."""

    value: float | None  #: None where there is none, and `note` says why.
    unit: str  #: Of the value.
    ci95: tuple[float, float]  #: 95 % interval, the structure's uncertainty included.
    verdict: Verdict  #: identified, weak or undetermined.
    note: str = ""  #: What to know of it.


@dataclass(frozen=True, slots=True)
class ReflexPath:
    """Whether a reflex is there, which stretch it answers, and why this is said."""

    verdict: ReflexVerdict
    direction: Literal["dorsiflexion", "plantarflexion"] | None  #: None unless present.
    reason: str  #: In a sentence.


@dataclass(frozen=True, slots=True, eq=False)
class Curves(Comparable):
    """What figures of one recording show."""

    f: FloatArray  #: Frequencies [Hz], shape (n,).
    coherence: FloatArray  #: Of angle and torque, linear, shape (n,).
    gain: FloatArray  #: Measured torque over angle [Nm/rad], shape (n,).
    phase: FloatArray  #: [deg], shape (n,).
    model_gain: (
        FloatArray  #: Of the intrinsic part and of what of the reflex is linear, shape (n,).
    )
    model_phase: FloatArray  #: [deg], shape (n,).
    intrinsic_gain: FloatArray  #: Of the intrinsic part alone, shape (n,).
    lag: FloatArray  #: Lags of the reflex's response [s], shape (m,).
    reflex: FloatArray  #: Reflex's impulse response of its equations [Nm/rad], shape (m,).
    free_reflex: FloatArray  #: The same without equations, shape (m,).
    intrinsic_lag: FloatArray  #: Lags of the intrinsic response [s], shape (k,).
    free_intrinsic: FloatArray  #: Intrinsic response without equations [Nm/rad/s], shape (k,).


@dataclass(frozen=True, slots=True)
class Stationarity:
    """Whether the stiffness stays the same during a recording."""

    verdict: Literal["steady", "changes"]
    halves: tuple[tuple[float, float, float], ...]  #: Stiffness of both halves: value, interval.
    parts: tuple[
        tuple[float, float, float], ...
    ]  #: Of every 10 s: time [s], value, standard error.
    trend: float  #: z of a change in proportion to time.


@dataclass(frozen=True, slots=True, eq=False)
class Perturbed(Comparable):
    """One recording and what it says."""

    path: FileName  #: Of its file, or its name.
    seconds: float  #: Time that was used [s].
    mean_torque: float  #: [Nm], positive when the triceps pulls, as far as the zero is known.
    mean_angle: float  #: [deg], dorsiflexion positive.
    #: Torque that impulse responses of both paths explain [%]: of the torque they were fitted to,
    #: and of the second half by the first.
    vaf: float
    vaf_held_out: float
    vaf_held_out_intrinsic: float  #: The same with the intrinsic path alone.
    vaf_held_out_other: float  #: The same with a reflex the other way round.
    reflex: ReflexPath  #: Whether there is one.
    measures: FrozenDict[str, NerveMeasure]  #: By the names of `MEASURES`.
    structures: FrozenDict[str, tuple[float, float, float]]  #: Stiffness of each: value, interval.
    stationarity: Stationarity  #: Of the stiffness.
    notes: tuple[str, ...]  #: What was left out, and what else to know, a sentence each.
    curves: Curves  #: What its figures show.


def number_of(
    name: str, number: Number | None, note: str = "", ends: tuple[float, float] = (0.0, np.inf)
) -> NerveMeasure:
    """A measure of an estimate; of none the ends that it may lie between."""
    unit, _ = MEASURES[name]
    if number is None:
        return NerveMeasure(None, unit, ends, Verdict.UNDETERMINED, note)
    half = 0.5 * (number.high - number.low)
    verdict = verdict_of(number.value, half, OF_REFLEX if name.startswith("reflex_") else PART)
    if verdict is Verdict.WEAK and verdict_of(number.value, half) is Verdict.IDENTIFIED:
        note = note or ONE_LAW
    return NerveMeasure(number.value, unit, (number.low, number.high), verdict, note)


def judged(
    found: Weighed,
    share: Number,
    fitted: Fitted,
    direction: int,
    samples: Samples,
    unseen: tuple[float, float],
) -> ReflexPath:
    """The verdict on a reflex, by what it predicts: never by its size alone."""
    word = DIRECTIONS[direction]
    if samples.one_sided:
        return ReflexPath(
            "cannot tell", None, Message(N_("the foot moved fast in one direction only"))
        )
    bounds = {"delay", "threshold"} & set(fitted.at_bound)
    at_bound = {n for n in bounds if n == "delay" or fitted.values["threshold"] > 0.5}
    better = found.over_none > OVER_NONE and found.over_other > OVER_OTHER and found.nats > NATS
    if better and share.value >= LEAST_SHARE and not at_bound:
        why = Message(
            N_(
                "a reflex to {way} predicts torque that was not fitted better than "
                "none (z = {none:.1f}) and than the other direction (z = {other:.1f})"
            ),
            way=Message(word),
            none=found.over_none,
            other=found.over_other,
        )
        return ReflexPath("present", word, why)  # type: ignore[arg-type]
    if unseen[0] < NONE_SEEN and not better:
        return ReflexPath(
            "none seen",
            None,
            Message(
                N_("a reflex makes at most {most:.2g} % of the torque’s variance"), most=unseen[0]
            ),
        )
    if better:
        if share.value < LEAST_SHARE:
            but = N_("something answers stretch to {way}, but its share is below half a percent")
        elif "delay" in at_bound:
            but = N_(
                "something answers stretch to {way}, but its delay lies at the end of its range"
            )
        else:
            but = N_(
                "something answers stretch to {way}, but its threshold lies at the end of its range"
            )
        return ReflexPath("cannot tell", None, Message(but, way=Message(word)))
    return ReflexPath(
        "cannot tell",
        None,
        Message(
            N_(
                "neither direction predicts torque that was not fitted better (z = "
                "{none:.1f} over none, {other:.1f} over the other), and up to "
                "{most:.2g} % of the variance may be a reflex’s"
            ),
            none=found.over_none,
            other=found.over_other,
            most=unseen[0],
        ),
    )


def perturbed(recording: Recording, empty: NerveMeasure | None = None) -> Perturbed:
    """What one recording says of its leg; `empty` is the inertia of the device alone.

    Raises
    ------
    InputError
        It has no torque, is no perturbation, or too little of it can be used.
    """
    samples, pieces = turned(samples_of(recording))
    halves = samples.halves()
    said: list[ReflexPath] = []

    def judge(
        direction: int, weighed: Weighed, share: Number, fitted: Fitted, unseen: tuple[float, float]
    ) -> bool:
        said.append(judged(weighed, share, fitted, direction, samples, unseen))
        return said[-1].verdict == "present"

    found = identify(pieces, halves, samples.band[1], judge)
    if found.numbers["intrinsic_viscosity"].high < 0.0:
        raise InputError(
            f"{recording.where}: the leg drives the movement, not the device: a voluntary one, "
            "or an angle and a torque that do not belong together; perturb a leg that holds still"
        )
    behind = falls_short(pieces, [found.fitted.prediction(p) for p in pieces])
    claimed = _claimed(found, said[-1], behind)
    measures = {
        name: number_of(
            name,
            claimed.numbers.get(name),
            "" if name in claimed.numbers else claimed.why,
            claimed.hidden.get(name, (0.0, np.inf)),
        )
        for name in MEASURES
    }
    measures["inertia"] = _without(measures["inertia"], empty)
    stationarity = _stationarity(found)
    notes = [*samples.notes, *_notes(pieces, found, behind)]
    if heard := answering(recording, samples, found.direction):
        notes.append(heard)
    if stationarity.verdict == "changes":
        notes.append(
            Message(N_("The stiffness changes during the recording: its value is a mean."))
        )
    path = 1 if found.direction > 0 else -1
    return Perturbed(
        recording.files[0].path if recording.files else recording.name,
        samples.seconds,
        float(np.mean([samples.torque[s].mean() for s in samples.spans])),
        float(np.rad2deg(np.mean([samples.angle[s].mean() for s in samples.spans]))),
        predicted(pieces, pieces, path),
        predicted(halves[1], halves[0], path),
        predicted(halves[1], halves[0], 0),
        predicted(halves[1], halves[0], -path),
        claimed.reflex,
        FrozenDict(measures),
        FrozenDict({n: (k.value, k.low, k.high) for n, k in found.structures.items()}),
        stationarity,
        tuple(notes),
        _curves(pieces, found, path),
    )


@dataclass(frozen=True, slots=True)
class _Claimed:
    """What is claimed of a leg."""

    reflex: ReflexPath
    numbers: Mapping[str, Number]  #: Of measures; those of a reflex only where one is present.
    hidden: Mapping[str, tuple[float, float]]  #: What a reflex may have that is not seen.
    why: Message  #: Why what has no number has none.


def _claimed(found: Cascade, reflex: ReflexPath, behind: float) -> _Claimed:
    """What is claimed, where the torque stays `behind` by a part of its largest."""
    numbers = found.numbers
    below = [n for n in ("intrinsic_stiffness", "inertia") if numbers[n].value <= 0.0]
    if below:  # the search lost its way, or the torque's sign is wrong: nothing is claimed
        ended = N_(
            "the fit ended at inertia below zero, which no leg has: look at the torque’s sign"
        )
        if below[0] != "inertia":
            ended = N_(
                "the fit ended at stiffness below zero, which no leg has: look at the torque’s sign"
            )
        why = Message(ended)
        return _Claimed(ReflexPath("cannot tell", None, why), {}, {}, why)
    if behind > BEHIND:
        numbers = {name: number.allowing(behind) for name, number in numbers.items()}
    if reflex.verdict != "present" and (behind > BEHIND or found.misfit > MISFIT):
        doubt = N_(
            "the equations miss something that the torque shows, maybe a reflex of another kind"
        )
        if behind > BEHIND:
            doubt = N_("the torque stays behind at its largest")
        reflex = ReflexPath("cannot tell", None, Message(doubt))
        none = N_("no reflex is claimed ({verdict})")
        return _Claimed(reflex, numbers, {}, Message(none, verdict=Message(reflex.verdict)))
    hidden = {
        "reflex_share": (0.0, found.unseen[0]),
        "reflex_gain": (0.0, found.unseen[1]),
        "reflex_delay": (1e3 * BOUNDS["delay"][0], 1e3 * BOUNDS["delay"][1]),
    }
    none = N_("no reflex is claimed ({verdict}); the interval is what one may have unseen")
    return _Claimed(reflex, numbers, hidden, Message(none, verdict=Message(reflex.verdict)))


def _notes(pieces: Sequence[Piece], found: Cascade, behind: float) -> Iterator[Message]:
    """What makes numbers less sure, and what to do about it."""
    if behind > BEHIND:
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
    if found.misfit > MISFIT:
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
    if empty is None or empty.value is None or whole.value is None:
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


def _stationarity(found: Cascade) -> Stationarity:
    a, b = found.halves
    apart = abs(a.value - b.value) > np.hypot(a.high - a.low, b.high - b.low)
    verdict: Literal["steady", "changes"] = (
        "changes" if found.scattered or abs(found.trend) > CHANGING or apart else "steady"
    )
    halves = tuple((each.value, each.low, each.high) for each in found.halves)
    return Stationarity(verdict, halves, tuple(map(tuple, found.parts.tolist())), found.trend)


def _curves(pieces: Sequence[Piece], found: Cascade, direction: int) -> Curves:
    """Frequency and impulse responses of the longest piece, with those of the equations."""
    from scipy.signal import csd, welch

    piece = max(pieces, key=lambda piece: piece.length)
    fitted = found.fitted
    intrinsic = replace(fitted.structure, direction=0, threshold=False)
    alone = Fitted(intrinsic, fitted.values, 0.0, ())
    spectra = (piece.angle, piece.torque, fitted.prediction(piece), alone.prediction(piece))
    angle, torque, model, own = (piece.signals(each) for each in spectra)
    size = int(min(2 * piece.rate, len(angle) // 8))
    f, power = welch(angle, piece.rate, nperseg=size)
    _, spread = welch(torque, piece.rate, nperseg=size)
    ratios = [
        csd(angle, each, piece.rate, nperseg=size)[1] / power for each in (torque, model, own)
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


def turned(samples: Samples) -> tuple[Samples, list[Piece]]:
    """Turn a torque by which stiffness and inertia would both be negative, or one and none seen."""
    pieces = samples.pieces()
    problem = Problem(pieces, noise_of(pieces, [p.bins(p.torque) for p in pieces]))
    judged = Judged(problem, problem.fit(PLAIN, {}))
    both = [judged.number(name, INTRINSIC[name]) for name in ("intrinsic_stiffness", "inertia")]
    below = [n.high < 0.0 for n in (*both, judged.number("", INTRINSIC["intrinsic_viscosity"]))]
    if any(below) and (moved := _moved_back(samples, problem)) is not None:
        return moved, moved.pieces()
    if all(n.low < 0.0 for n in both) and any(n.high < 0.0 for n in both):
        note = Message(
            N_(
                "The torque’s sign was turned: as it stands, stiffness or inertia "
                "would be negative. Where the leg moved the device, and not the "
                "device the leg, the numbers are the device’s."
            )
        )
        turned = replace(samples, torque=-samples.torque, notes=(*samples.notes, note))
        return turned, turned.pieces()
    return samples, pieces


def _moved_back(samples: Samples, as_it_is: Problem) -> Samples | None:
    """The torque moved back where it comes later than the search of its lateness reaches.

    Late by 20 ms, inertia at 25 Hz bends the torque as if its sign were wrong. It is moved only
    where that leaves less than half of what any reflex beside tissue leaves of it as it is.
    """

    def best(problem: Problem) -> Fitted:
        fits = (problem.fit(replace(PLAIN, direction=d), {}) for d in (0, 1, -1))
        return min(fits, key=lambda fitted: fitted.loss)

    least = 0.5 * best(as_it_is).loss
    found = None
    for late in LATER:
        n = round(late * samples.rate_hz)
        torque = np.concatenate([samples.torque[n:], np.full(n, samples.torque[-1])])
        moved = replace(samples, torque=torque)
        fitted = best(Problem(moved.pieces(), as_it_is.noise))
        if fitted.loss < least and min(fitted.values[n] for n in ("stiffness", "inertia")) > 0.0:
            least = fitted.loss
            found = (late + fitted.values["late"], moved)
    if found is None:
        return None
    late, moved = found
    note = Message(
        N_(
            "The torque comes {late:.0f} ms later than the angle: it was moved "
            "back. Look at its filter and its clock; delays count from the torque "
            "of tissue."
        ),
        late=1e3 * late,
    )
    return replace(moved, notes=(*samples.notes, note))
