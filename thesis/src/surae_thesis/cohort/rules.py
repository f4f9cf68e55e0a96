"""How the claims on the thesis's subjects are computed and decided (3.2, 4.2), by their names.

Every rule takes a view of the fits and what its row gives, and returns a `Ruling`.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from itertools import combinations
from statistics import fmean, median

import numpy as np

from surae.base.units import FloatArray
from surae_thesis.claims import NotThereError, Ruling, rows
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    FAST_PROTOCOL,
    PASSIVE_PROTOCOL,
    REPETITIONS,
    CohortSubject,
)
from surae_thesis.cohort.results import Fits, Points, clearly_lower, paired, values
from surae_thesis.cohort.trials import RECORDED_HZ, cohort_recording

#: The view that decides.
COHORT = "the cohort"
#: A difference has the thesis's size from this part of it, up to one over it; a standard error so
#: much lower than another is a lot lower, and so near to a printed one has its size.
SIZE = 0.5
MUCH = 0.5
NEAR = 3.0
#: The two groups whose dependency the thesis looks at (4.2.2), and the weights of the EMG.
PASSIVE = ("k_tri", "k_tib", "x0_tri", "x0_tib", "tau_rel", "k_rel")
ACTIVE = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
WEIGHTS = ("g1", "g2", "g3", "g4")
PROTOCOLS = {
    PASSIVE_PROTOCOL: "ramp and hold",
    ACTIVE_PROTOCOL: "multiple holds",
    FAST_PROTOCOL: "multi-sine with holds",
}
#: Cohorts that are drawn again from the subjects, and the part of them in which a rule may say the
#: opposite before chance decides it.
DRAWS = 200
OPPOSITE = 0.1
#: Length of the segments whose spectra are averaged [s].
_SEGMENT = 8.0


def described(points: Points) -> str:
    """Mean, median and lowest of numbers in percent, and how many."""
    if not points:
        raise NotThereError("No such fit is there.")
    v = values(points)
    return f"{v.mean():.1f} % (median {np.median(v):.1f}, lowest {v.min():.1f}, n = {len(v)})"


def by_chance(fits: Fits, ours: Callable[[Fits], Ruling]) -> str:
    """Why chance decides a rule: cohorts drawn again from these subjects say the opposite.

    Empty where more than nine of ten say the same, and where the rule asks one subject alone.
    """
    if getattr(ours, "func", ours) is spectra:
        return ""
    said = _same(ours(fits))
    rng = np.random.default_rng(0)
    opposite = 0
    drawn = 0
    for _ in range(DRAWS):
        with suppress(NotThereError):
            opposite += _same(ours(fits.drawn(rng))) != said
            drawn += 1
    part = opposite / max(drawn, 1)
    if part <= OPPOSITE:
        return ""
    return f"{100 * part:.0f} % of cohorts drawn again from these subjects say otherwise"


def _same(ruling: Ruling) -> tuple[bool, bool]:
    """What a ruling decides."""
    return bool(ruling.holds), bool(ruling.less)


# Means and orders


@cache
def thesis_means() -> dict[tuple[str, str, str], float]:
    """The thesis's mean VAF [%] of ``"fit"``, ``"validation"`` or ``"onto"``, model, protocol.

    The last is the ramp and hold, predicted from the multiple holds.
    """
    every = [row["given"] for row in rows("subjects") if row["ours"] == "vaf_level"]
    return {(given["kind"], given["model"], given["protocol"]): given["mean"] for given in every}


def points_of(fits: Fits, kind: str, model: str, protocol: str = ACTIVE_PROTOCOL) -> Points:
    """VAFs of a kind, see `thesis_means`."""
    every = {"fit": fits.vaf, "validation": fits.predicted, "onto": fits.onto_passive}
    return every[kind](model, protocol)


def vaf_level(
    fits: Fits, kind: str, model: str, protocol: str, mean: float, within: float
) -> Ruling:
    """How close the cohort's mean is to the thesis's."""
    points = points_of(fits, kind, model, protocol)
    text = described(points)
    return Ruling(abs(_mean(points) - mean) <= within, text)


def _mean(points: Points) -> float:
    return float(values(points).mean())


def lowest(fits: Fits, kind: str, model: str, protocol: str, least: float, within: float) -> Ruling:
    """The lowest VAF against the thesis's; at least that where nothing lies within it."""
    points = points_of(fits, kind, model, protocol)
    text = described(points)
    low = float(values(points).min())
    return Ruling(low >= least if within == 0.0 else abs(low - least) <= within, text)


def change(
    fits: Fits,
    first: str,
    second: str,
    size: float,
    kind: str = "fit",
    protocol: str = ACTIVE_PROTOCOL,
    similar: float = 0.0,
) -> Ruling:
    """The mean change from a model to another, of the same recordings, against the thesis's.

    Or, where they are `similar`, whether neither mean nor median goes beyond so many points.
    """
    several = paired(*(points_of(fits, kind, model, protocol) for model in (first, second)))
    if not len(several):
        raise NotThereError("No such fit is there.")
    middle = float(np.median(several))
    mean = float(several.mean())
    text = (
        f"{mean:+.2f} points (mean), {middle:+.2f} (median); negative in "
        f"{100 * float(np.mean(several < 0.0)):.0f} % of {len(several)}"
    )
    if similar:
        return Ruling(max(abs(mean), abs(middle)) <= similar, text)
    sign = bool(np.sign(size) == np.sign(mean) == np.sign(middle))
    part = abs(mean / size)
    return Ruling(sign and SIZE <= part <= 1.0 / SIZE, text, less=sign and part < SIZE)


def lower(fits: Fits, points: list[str], size: float, clearly: bool = False) -> Ruling:
    """Whether the last mean is the highest, clearly: by more than chance; and by how much.

    The size is that of the thesis [points], of the last over the highest other.
    """
    *groups, highest = (points_of(fits, *which.split()) for which in points)
    text = " against ".join(map(described, (*groups, highest)))
    apart = _mean(highest) - max(map(_mean, groups))
    sign = apart > 0.0 and (not clearly or all(clearly_lower(g, highest) for g in groups))
    return Ruling(sign and apart >= SIZE * size, text, less=sign and apart < SIZE * size)


def spreads(fits: Fits, first: str, second: str) -> Ruling:
    """Ranges of the ramp and hold as two models predict it: much wider by the second."""
    ranges = [float(np.ptp(values(fits.onto_passive(model)))) for model in (first, second)]
    text = f"{ranges[0]:.1f} points by {first}, {ranges[1]:.1f} by {second}"
    return Ruling(ranges[1] >= 2.0 * ranges[0], text, less=ranges[0] < ranges[1] < 2.0 * ranges[0])


def remarked(fits: Fits) -> Ruling:
    """Whether recordings below the whisker of Figure 17's box are of subjects with a remark."""
    noted = {member.id for member in fits.members if member.remarks}
    points = fits.vaf("1.0", ACTIVE_PROTOCOL)
    low, high = np.percentile(values(points), [25, 75])
    outliers = [who for (who, _), value in points.items() if value < low - 1.5 * (high - low)]
    of_noted = sum(who in noted for who in outliers)
    share = len(noted) / len(fits.members)
    text = (
        f"{of_noted} of {len(outliers)} outliers, of {len(points)} recordings; "
        f"{100 * share:.0f} % of the subjects are such"
    )
    return Ruling(of_noted == len(outliers) > 0, text)


# Standard errors


def _medians(fits: Fits, model: str) -> dict[str, float]:
    """Median snSEM over the recordings of the multiple holds, by parameter."""
    snsem = fits.snsem(model, ACTIVE_PROTOCOL)
    medians = {name: median(several) for name, several in snsem.items() if several}
    if not medians:
        raise NotThereError("No such fit is there.")
    return medians


def one_to_ten(fits: Fits) -> Ruling:
    """How many snSEM of model 1.0 lie between 1 and 10."""
    several = _medians(fits, "1.0")
    inside = sum(1.0 <= value <= 10.0 for value in several.values())
    ends = f"{min(several.values()):.2g} to {max(several.values()):.2g}"
    return Ruling(inside > len(several) / 2, f"{inside} of {len(several)}; from {ends}")


def apart_from_others(fits: Fits, names: list[str], side: str) -> Ruling:
    """Whether these snSEM of model 1.0 lie above or below the others."""
    several = _medians(fits, "1.0")
    some = [several[n] for n in names if n in several]
    others = [value for n, value in several.items() if n not in names]
    if not some or not others:
        raise NotThereError("No fit gives these standard errors.")
    a = median(some)
    b = median(others)
    return Ruling(a > b if side == "above" else a < b, f"{a:.2g} against {b:.2g}")


def about_one(fits: Fits) -> Ruling:
    """The median snSEM of model 2.0."""
    middle = median(_medians(fits, "2.0").values())
    return Ruling(0.5 <= middle <= 2.0, f"{middle:.2g}")


def below_muscle(fits: Fits) -> Ruling:
    """The median snSEM of model 2.0 against that of 1.0."""
    a, b = (median(_medians(fits, model).values()) for model in ("2.0", "1.0"))
    return Ruling(a <= MUCH * b, f"{a:.2g} against {b:.2g}", less=MUCH * b < a < b)


def over_tendon(fits: Fits, model: str, weights_lower: bool) -> Ruling:
    """The snSEM of a model over those of 2.0: similar, those of the weights lower where asked."""
    some, tendon = (_medians(fits, name) for name in (model, "2.0"))
    ratio = {name: some[name] / tendon[name] for name in tendon if name in some}
    rest = median([r for name, r in ratio.items() if not weights_lower or name not in WEIGHTS])
    text = f"median ratio {rest:.2g}"
    holds = 0.5 <= rest <= 2.0
    if not weights_lower:
        return Ruling(holds, text)
    weights = median([ratio[name] for name in WEIGHTS if name in ratio])
    text = f"{text}, of the weights {weights:.2g}"
    most = min(1.0, rest)
    return Ruling(
        holds and weights <= MUCH * most, text, less=holds and MUCH * most < weights < most
    )


def mass_highest(fits: Fits, model: str, size: float = 0.0) -> Ruling:
    """The snSEM of the mass against the next, and against the thesis's where it prints one."""
    several = _medians(fits, model)
    if "m" not in several:
        raise NotThereError("No fit tells the mass's standard error.")
    value, name = max((value, name) for name, value in several.items() if name != "m")
    sized = not size or size / NEAR <= several["m"] <= size * NEAR
    text = f"{several['m']:.1f}; next {name} with {value:.1f}"
    return Ruling(several["m"] > value and sized, text)


def among_highest(fits: Fits, model: str, name: str, most: int) -> Ruling:
    """The place of a parameter by its snSEM, the highest first."""
    several = _medians(fits, model)
    if name not in several:
        raise NotThereError("No fit tells its standard error.")
    place = 1 + sum(value > several[name] for value in several.values())
    return Ruling(place <= most, f"{several[name]:.1f}, place {place} of {len(several)}")


# Parts of the torque, the mass, dependencies, repetitions


def _sizes(fits: Fits, part: str, model: str = "1.0") -> list[float]:
    several = [fit["sizes"] for _, _, fit in fits.of(model, ACTIVE_PROTOCOL)]
    return [sizes[part] for sizes in several if sizes.get(part) is not None]


def largest(fits: Fits, part: str, low: float, high: float) -> Ruling:
    """The largest size of a part of model 1.0's torque."""
    most = max(_sizes(fits, part))
    return Ruling(low <= most <= high, f"{most:.1f} Nm")


def inertia(fits: Fits) -> Ruling:
    """The inertial torque over the active one."""
    pairs = zip(_sizes(fits, "inertial"), _sizes(fits, "neural"), strict=True)
    ratio = [a / b for a, b in pairs if b]
    return Ruling(
        max(ratio) < 0.1, f"{100 * max(ratio):.1f} % at most, {100 * median(ratio):.1f} % (median)"
    )


def peaks(fits: Fits, model: str) -> Ruling:
    """How far a model's torque falls short of the measured peaks."""
    short = _sizes(fits, "short_at_peaks", model)
    share = fmean(value > 0.0 for value in short)
    text = f"short in {100 * share:.0f} % of {len(short)}, by {100 * fmean(short):.1f} % (mean)"
    return Ruling(share > 0.5, text)


def mass_at_bound(fits: Fits) -> Ruling:
    """Share of the multiple holds in which the mass ends at its bound, by model."""
    bound = {
        model: [f["parameters"]["m"]["at_bound"] for _, _, f in fits.of(model, ACTIVE_PROTOCOL)]
        for model in ("1.0", "2.0", "2.1")
    }
    if not bound["1.0"]:
        raise NotThereError("No such fit is there.")
    share = {model: fmean(each) for model, each in bound.items() if each}
    text = ", ".join(f"{100 * part:.0f} % by {model}" for model, part in share.items())
    return Ruling(share.get("1.0", 0.0) > 0.5, text)


def _correlations(fits: Fits) -> Iterator[tuple[list[str], FloatArray]]:
    for _, _, fit in fits.of("2.0", ACTIVE_PROTOCOL):
        yield fit["correlation"]["names"], np.abs(np.array(fit["correlation"]["matrix"]))


def block(fits: Fits) -> Ruling:
    """The largest correlation of passive with active parameters."""
    most = []
    for names, matrix in _correlations(fits):
        lines, columns = ([names.index(n) for n in g if n in names] for g in (PASSIVE, ACTIVE))
        if lines and columns:
            most.append(float(matrix[np.ix_(lines, columns)].max()))
    if not most:
        raise NotThereError("No fit has both kinds of parameters off their bounds.")
    return Ruling(
        fmean(value > 0.5 for value in most) > 0.5,
        f"{median(most):.2f} (median), {min(most):.2f} to {max(most):.2f}",
    )


def lengths(fits: Fits, pairs: list[list[str]]) -> Ruling:
    """The correlation of pairs of parameters."""
    by_pair: dict[str, list[float]] = {}
    for names, matrix in _correlations(fits):
        for a, b in pairs:
            if a in names and b in names:
                by_pair.setdefault(f"{a}–{b}", []).append(matrix[names.index(a), names.index(b)])
    if not by_pair:
        raise NotThereError("No fit has both parameters off their bounds.")
    middle = {pair: median(several) for pair, several in by_pair.items()}
    text = ", ".join(f"{pair} {value:.2f}" for pair, value in middle.items())
    return Ruling(max(middle.values()) > 0.5, text)


def spectra(fits: Fits) -> Ruling:
    """Mean absolute difference of the torque's spectra of two repetitions, 0.25 to 5 Hz."""
    several = spectra_of(example(fits.members)[1])
    inside = (several[0][0] >= 0.25) & (several[0][0] <= 5.0)
    apart = fmean(
        float(np.mean(np.abs(a[1][inside] - b[1][inside]))) for a, b in combinations(several, 2)
    )
    return Ruling(apart > 1.0, f"{apart:.1f} dB (mean of {len(several)} pairs)")


def example(members: Sequence[CohortSubject]) -> tuple[int, CohortSubject]:
    """Number and data of the subject of the example figures: the first of whom nothing was noted.

    Of those who completed all three protocols, if there is one.
    """
    return min(enumerate(members), key=lambda who: (-len(who[1].completed), bool(who[1].remarks)))


def spectra_of(who: CohortSubject) -> list[tuple[FloatArray, FloatArray]]:
    """`spectrum` of the torque of a subject's multiple holds, by repetition."""
    each = (cohort_recording(who, ACTIVE_PROTOCOL, r) for r in range(1, REPETITIONS + 1))
    return [spectrum(np.asarray(one.channels["torque"].values), RECORDED_HZ) for one in each]


def spectrum(signal: FloatArray, rate_hz: float) -> tuple[FloatArray, FloatArray]:
    """Frequency [Hz] and power density (Welch, Hann windows of 8 s) of a signal, in dB."""
    from scipy.signal import welch

    n = min(int(_SEGMENT * rate_hz), len(signal))
    frequency, power = welch(signal - signal.mean(), rate_hz, nperseg=n)
    return frequency, 10.0 * np.log10(np.maximum(power, 1e-300))
