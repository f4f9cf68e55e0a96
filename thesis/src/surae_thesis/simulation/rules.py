"""How the claims of the simulation study are computed and decided (3.1, 4.1), by their names.

Every rule takes a view of the study and what its row gives, and returns a `Ruling`.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from surae.base.units import FloatArray
from surae_thesis.claims import Claim, NotThereError, Ruling
from surae_thesis.simulation import cells as grid
from surae_thesis.simulation.cells import Cells, GridCell, Study, ranked, scores, select, there

#: The thesis's limit of a good fit [%] (2.7, 4.1), and of a good estimate.
GOOD_VAF = 99.85
GOOD_ESTIMATE = 0.10
#: Factors up to and from which a SEM is slow's and fast's; "around" a factor of 0.5.
_SLOW = 0.1
_FAST = 0.5
_NEAR = (0.4, 0.6)
#: The largest amplitude of which the thesis keeps the muscle-tendon model's fits [rad] (4.1.3).
_KEPT = 0.2
#: Profiles that have results of both models: the tendon model's multi-sine was omitted (4.1.3).
BOTH = tuple(name for name in grid.PROFILES if name != "multi-sine")
#: What the choices are made of: both models with both chosen profiles.
_CHOSEN_FITS = tuple(itertools.product(grid.MODELS, grid.CHOSEN))
#: Ratio of SEM and difference of IPDE from which they are not the noise's (3.1.4).
SAME_SEM = 1.0375
SAME_IPDE = 0.02


def _profiles(model: str) -> tuple[str, ...]:
    return grid.PROFILES if model == "muscle" else BOTH


def listed(values: Mapping[str, float], names: Iterable[str] = ()) -> str:
    """Numbers by their names, the lowest first unless names are given."""
    return ", ".join(f"{name} {values[name]:.2f}" for name in names or ranked(values))


def by_amplitude(values: Iterable[float]) -> str:
    """Numbers by the chirp's amplitude."""
    return ", ".join(f"{a:g} rad {v:.2f}" for a, v in zip(grid.AMPLITUDES, values, strict=False))


def again(study: Study, claim: Claim) -> str:
    """Say for how many of the virtual subjects a claim holds."""
    subjects = sorted({cell.subject for cell in study.others})
    count = sum(
        claim.ours(replace(study, grid=select(study.others, subject=n))).holds for n in subjects
    )
    return f"It holds for {count} of {len(subjects)} virtual subjects."


# VAF and noise


def muscle_vaf(study: Study, expected: float, around: float) -> Ruling:
    """VAF of the muscle model over its cells."""
    values = np.array([cell.vaf for cell in there(study.grid, model="muscle")])
    middle = float(np.median(values))
    low = float(values.min())
    high = float(values.max())
    text = f"median {middle:.3f} %, {low:.3f} to {high:.3f} %"
    return Ruling(abs(middle - expected) <= around and low >= GOOD_VAF, text)


def tendon_vaf(study: Study, expected: float, around: float) -> Ruling:
    """VAF of the muscle-tendon model's cells that the thesis calls successful, whatever it is."""
    every = there(study.grid, model="muscle-tendon")
    kept = [cell.vaf for cell in _kept(study)]
    middle = float(np.median(kept))
    whole = float(np.median([cell.vaf for cell in every]))
    text = f"median {middle:.3f} % of {len(kept)} cells; {whole:.3f} % of all {len(every)}"
    return Ruling(abs(middle - expected) <= around, text)


def noise_alone(study: Study, claim: Claim) -> str:
    """How far VAF is from what the noise alone leaves."""
    model = "muscle-tendon" if claim.id.endswith("-tendon") else "muscle"
    apart = [abs(cell.vaf - cell.floor) for cell in select(study.grid, model=model)]
    near = f"within {np.percentile(apart, 95):.3f} % in 19 of 20 cells, {max(apart):.3f} % in all"
    return f"It is the VAF that the noise alone leaves, {near}."


def _wrong(cells: Iterable[GridCell]) -> int:
    """How many cells have a parameter that is more than 10 % off."""
    return sum(cell.worst[1] > GOOD_ESTIMATE for cell in cells)


def threshold(study: Study) -> Ruling:
    """Cells below the limit that have a wrong parameter; without others nothing is told apart."""
    low = [cell for cell in study.grid if cell.vaf < GOOD_VAF]
    text = f"{_wrong(low)} of {len(low)} cells below 99.85 %"
    none_above = "no cell is above it" if len(low) == len(study.grid) else ""
    none_below = "no cell is below it" if not low else ""
    return Ruling(_wrong(low) == len(low), text, untested=none_above or none_below)


def above_threshold(study: Study, _: Claim) -> str:
    """Cells above the limit that have one too."""
    high = [cell for cell in study.grid if cell.vaf >= GOOD_VAF]
    return f"Of the {len(high)} cells above it {_wrong(high)} have such a parameter too."


def failing(study: Study, least: float, succeed: float, **where: object) -> Ruling:
    """How many cells of the muscle-tendon model somewhere fail by the thesis's limit.

    Where fewer than the part `succeed` of the cells that the thesis keeps reach that limit, a
    failure here is none of this place.
    """
    some = there(study.grid, model="muscle-tendon", **where)
    low = sum(cell.vaf < GOOD_VAF for cell in some)
    kept = [c.vaf >= GOOD_VAF for c in _kept(study)]
    text = f"{low} of {len(some)} cells below 99.85 %; {kept.count(False)} of {len(kept)} elsewhere"
    fails = low >= least * len(some)
    alike = fails and sum(kept) < succeed * len(kept)
    return Ruling(fails, text, untested="cells elsewhere fail as well" if alike else "")


def _kept(study: Study) -> list[GridCell]:
    """The muscle-tendon model's cells that the thesis calls successful, whatever their VAF is."""
    every = there(study.grid, model="muscle-tendon")
    kept = [c for c in every if c.profile != "multi-sine" and c.amplitude <= _KEPT]
    if not kept:
        raise NotThereError("no such fit is there")
    return kept


#: What is looked at of a cell, by name.
_VALUES: Mapping[str, Callable[[GridCell], float | None]] = {
    "vaf": lambda cell: cell.vaf,
    "ipde": lambda cell: cell.ipde,
    "k_tri": lambda cell: cell.sem.get("k_tri"),
}


def spread(study: Study, of: str, most: float, unit: str, profiles: list[str]) -> Ruling:
    """Largest range over repeats of the noise, at any factor; a SEM's in percent of its mean."""
    groups: dict[tuple[str, float | None], list[float]] = {}
    for cell in study.noise:
        if (number := _VALUES[of](cell)) is not None:
            groups.setdefault((cell.profile, cell.factor), []).append(number)
    widths = [
        [(max(g) - min(g)) * (100.0 / float(np.mean(g)) if of == "k_tri" else 1.0) for g in several]
        for several in (
            [_whiskers(g) for (profile, _), g in groups.items() if profile in profiles],
            [g for (profile, _), g in groups.items() if profile in profiles],
            groups.values(),
        )
    ]
    if not widths[0]:
        raise NotThereError("none of the noise's repeats is there")
    shown, outliers, every = map(max, widths)
    text = f"at most {shown:.3g}{unit}; with outliers {outliers:.3g}{unit}, over all five profiles"
    return Ruling(shown <= most, f"{text} {every:.3g}{unit}")


def _whiskers(numbers: list[float]) -> list[float]:
    """Numbers that a box plot's whiskers reach, its outliers left out."""
    low, high = np.percentile(numbers, [25, 75])
    far = 1.5 * (high - low)
    return [number for number in numbers if low - far <= number <= high + far]


# Task


def _pairs(study: Study) -> dict[tuple[str, str], list[tuple[GridCell, GridCell]]]:
    """Cells that differ in the task alone, part-passive and active, by model and profile."""
    where = attrgetter("model", "profile", "amplitude", "factor")
    active = {where(cell): cell for cell in there(study.grid, task="active")}
    pairs: dict[tuple[str, str], list[tuple[GridCell, GridCell]]] = {}
    for cell in there(study.grid, task="part-passive"):
        if where(cell) in active:
            pairs.setdefault((cell.model, cell.profile), []).append((cell, active[where(cell)]))
    return pairs


def task_sem(study: Study) -> Ruling:
    """SEM of the part-passive task over that of the active one, by profile."""
    ratio: dict[str, list[float]] = {}
    for (model, _), pairs in _pairs(study).items():
        logs = [np.log(a.sem[n] / b.sem[n]) for a, b in pairs for n in a.sem.keys() & b.sem.keys()]
        ratio.setdefault(model, []).append(float(np.exp(np.mean(logs))))
    text = "; ".join(f"{model} {min(r):.2f} to {max(r):.2f}" for model, r in ratio.items())
    return Ruling(max(map(max, ratio.values())) < 1.0, f"ratio by profile: {text}")


def task_ipde(study: Study) -> Ruling:
    """IPDE of the part-passive task less that of the active one, by model and profile."""
    apart = [
        float(np.mean([a.ipde - b.ipde for a, b in pairs if a.ipde and b.ipde]))
        for pairs in _pairs(study).values()
    ]
    low = sum(value < 0.0 for value in apart)
    text = f"lower in {low} of {len(apart)}; difference {min(apart):+.2f} to {max(apart):+.2f}"
    return Ruling(low == len(apart), text)


# Chirp: factor and amplitude


def _fast_over_slow(study: Study, model: str) -> dict[str, float]:
    line = grid.along_factor(study.grid, model)
    at = np.array([cell.factor for cell in line], dtype=float)
    curves = grid.normalised(line).items()
    ratio = {n: np.nanmean(c[at >= _FAST]) / np.nanmean(c[at <= _SLOW]) for n, c in curves}
    return {name: float(value) for name, value in ratio.items() if not np.isnan(value)}


def factor_sem(study: Study) -> Ruling:
    """Muscle model: SEM of fast chirps over that of slow ones."""
    ratio = _fast_over_slow(study, "muscle")
    order = ranked(ratio)
    rest = [name for name in order if name not in grid.RELAXATION]
    falling = sum(ratio[name] < 1.0 for name in rest)
    text = f"fast over slow: {listed(ratio, order[:3])}; {falling} of {len(rest)} fall"
    return Ruling(falling == len(rest) and order[0] == "m", text)


def factor_sem_tendon(study: Study) -> Ruling:
    """Muscle-tendon model: the same, on the mean."""
    ratio = _fast_over_slow(study, "muscle-tendon")
    order = ranked(ratio)
    middle = float(np.mean(list(ratio.values())))
    text = f"fast over slow: mean {middle:.2f}, {listed(ratio, order[:3])}"
    return Ruling(middle < 1.0 and order[0] == "m", text)


def factor_relaxation(study: Study, start: float, flat: float) -> Ruling:
    """Width of the relaxation parameters' curves from a factor up [%]."""
    line = [c for c in grid.along_factor(study.grid, "muscle") if (c.factor or 0.0) >= start]
    curves = grid.normalised(line)
    width = {name: 100 * float(np.abs(curves[name] - 1.0).max()) for name in grid.RELAXATION}
    text = ", ".join(f"{name} ± {width[name]:.0f} %" for name in grid.RELAXATION)
    return Ruling(max(width.values()) <= flat, text)


def amplitude_sem(study: Study) -> Ruling:
    """Rise of the parameters' SEM from an amplitude to the next."""
    rises = {
        name: float((values[1:] / values[:-1]).max())
        for name, values in grid.normalised(grid.along_amplitude(study.grid, "muscle")).items()
        if name not in grid.RELAXATION
    }
    rising = [name for name in reversed(ranked(rises)) if rises[name] >= SAME_SEM]
    most = f", {rising[0]} rises by {100 * rises[rising[0]] - 100:.0f} %" if rising else ""
    return Ruling(not rising, f"{len(rises) - len(rising)} of {len(rises)} parameters fall{most}")


def amplitude_relaxation(study: Study) -> Ruling:
    """Best amplitude for the relaxation parameters, and what 0.1 rad has above it."""
    curves = grid.normalised(grid.along_amplitude(study.grid, "muscle"))
    known = [(name, curves[name]) for name in grid.RELAXATION if name in curves]
    above = [float(curve[1] / np.nanmin(curve)) for _, curve in known]
    text = ", ".join(
        f"{name} {grid.AMPLITUDES[int(np.nanargmin(curve))]:g} rad" for name, curve in known
    )
    text += f"; at 0.1 rad {100 * max(above) - 100:.1f} % above the lowest"
    return Ruling(max(above) < SAME_SEM, text)


def amplitude_tendon(study: Study) -> Ruling:
    """Muscle-tendon model: mean normalised SEM by amplitude."""
    score = scores(grid.along_amplitude(study.grid, "muscle-tendon", upto=0.2))
    return Ruling(_is_chosen(score), by_amplitude(score))


def _is_chosen(score: FloatArray) -> bool:
    """Whether the lowest of several amplitudes is that which the thesis chose."""
    return grid.AMPLITUDES[int(np.argmin(score))] == grid.CHOSEN_AMPLITUDE


# Profiles


def _profile_scores(cells: Cells, model: str, names: Sequence[str]) -> dict[str, float]:
    return dict(zip(names, scores(grid.along_profile(cells, model, names)).tolist(), strict=True))


def profile_sem(study: Study, model: str, best: list[str]) -> Ruling:
    """Mean normalised SEM by profile: the sine last, the best first."""
    score = _profile_scores(study.grid, model, _profiles(model))
    order = ranked(score)
    return Ruling(order[-1] == "sine" and set(order[: len(best)]) == set(best), listed(score))


def _ipdes(cells: Cells, model: str, names: Sequence[str]) -> dict[str, float]:
    some = grid.along_profile(cells, model, names)
    known = {cell.profile: cell.ipde for cell in some if cell.ipde is not None}
    if len(known) < len(names):
        raise NotThereError("a fit has no IPDE: a parameter was not determined")
    return known


def ipde_values(study: Study, model: str, close: float, printed: dict[str, list[float]]) -> Ruling:
    """How close the IPDE of profiles is to the printed range."""
    ipde = _ipdes(study.grid, model, tuple(printed))
    far = max(max(low - ipde[p], ipde[p] - high) for p, (low, high) in printed.items())
    return Ruling(far <= close, listed(ipde))


def ipde_ranking(study: Study) -> Ruling:
    """Muscle model: whether the chosen profiles have the lowest IPDE."""
    ipde = _ipdes(study.grid, "muscle", grid.PROFILES)
    others = min(value for name, value in ipde.items() if name not in grid.CHOSEN)
    return Ruling(max(ipde[name] for name in grid.CHOSEN) < others + SAME_IPDE, listed(ipde))


def ipde_tendon(study: Study, names: list[str], same: float) -> Ruling:
    """Muscle-tendon model: these profiles alike, the sine above."""
    ipde = _ipdes(study.grid, "muscle-tendon", BOTH)
    alike = [ipde[name] for name in names]
    return Ruling(max(alike) - min(alike) <= same and ipde["sine"] > max(alike), listed(ipde))


def ipde_factor(study: Study, model: str) -> Ruling:
    """The factor of the lowest IPDE, by profile, and how far it lies below those around 0.5."""
    lowest = {}
    below = []
    for profile in _profiles(model):
        line = grid.along_factor(study.grid + study.faster, model, profile)
        ipde = {c.factor or 0.0: c.ipde for c in line if c.ipde is not None}
        lowest[profile] = min(ipde, key=lambda factor: ipde[factor])
        below.append(_below_near(ipde))
    text = ", ".join(f"{profile} {factor:g}" for profile, factor in lowest.items())
    return Ruling(max(below) < SAME_IPDE, f"{text}; at most {max(below):.3f} below around 0.5")


def _below_near(ipde: Mapping[float, float]) -> float:
    """How far the lowest IPDE over the factors lies below the lowest around 0.5."""
    near = [value for factor, value in ipde.items() if _NEAR[0] <= factor <= _NEAR[1]]
    if not near:
        raise NotThereError("no fit is around 0.5")
    return min(near) - min(ipde.values())


def ipde_amplitude(study: Study, model: str) -> Ruling:
    """Mean IPDE by amplitude."""
    means = [
        float(np.mean([c.ipde for c in here if c.ipde is not None]))
        for a in grid.AMPLITUDES
        for here in [there(study.grid, model=model, task="part-passive", amplitude=a)]
    ]
    return Ruling(all(b < a for a, b in itertools.pairwise(means)), by_amplitude(means))


# Patients and choices: means over both models, and for the chirp over the chosen profiles


def mean_ranks(cells: Cells) -> dict[str, float]:
    """Mean rank, 1 the best, over SEM and IPDE of both models, of profiles that have both."""
    places: dict[str, list[int]] = {profile: [] for profile in BOTH}
    for model in grid.MODELS:
        for values in (_profile_scores(cells, model, BOTH), _ipdes(cells, model, BOTH)):
            for place, name in enumerate(ranked(values), 1):
                places[name].append(place)
    return {name: float(np.mean(some)) for name, some in places.items()}


def _mean_scores(lines: Iterable[Cells]) -> FloatArray:
    return np.asarray(np.mean([scores(line) for line in lines], axis=0))


def _factor_curves(cells: Cells) -> tuple[FloatArray, FloatArray, float, float]:
    """Normalised SEM by factor, the factors, that of the lowest IPDE, and its lead near 0.5."""
    lines = [grid.along_factor(cells, model, profile) for model, profile in _CHOSEN_FITS]
    ipde = np.nanmean([[c.ipde or np.nan for c in line] for line in lines], axis=0)
    at = np.array([cell.factor for cell in lines[0]], dtype=float)
    below = _below_near(dict(zip(at.tolist(), ipde.tolist(), strict=True)))
    return _mean_scores(lines), at, float(at[int(np.argmin(ipde))]), below


def patient_profiles(study: Study, best: list[str]) -> Ruling:
    """Whether the same profiles rank first in the patient and in health."""
    sick = mean_ranks(study.patients)
    healthy = mean_ranks(study.grid)
    both = all(set(ranked(ranks)[: len(best)]) == set(best) for ranks in (sick, healthy))
    return Ruling(both, f"mean ranks {listed(sick)}; in health {listed(healthy)}")


def patient_amplitude(study: Study) -> Ruling:
    """The patient's SEM by amplitude."""
    score = _mean_scores(grid.along_amplitude(study.patients, m, p) for m, p in _CHOSEN_FITS)
    return Ruling(_is_chosen(score), f"SEM {by_amplitude(score)}")


def patient_factor(study: Study) -> Ruling:
    """The patient's SEM and IPDE against the factor."""
    sem, at, least, below = _factor_curves(study.patients)
    return Ruling(
        bool(sem[-1] < sem[0]) and below < SAME_IPDE,
        f"SEM {sem[0]:.2f} at {at[0]:g}, {sem[-1]:.2f} at {at[-1]:g}; IPDE lowest at {least:g}, "
        f"{below:.3f} below around 0.5",
    )


def patient_ipde(study: Study, same: float) -> Ruling:
    """The patient's IPDE of the scaled chirp against that of the chosen profiles."""
    apart = []
    for model in grid.MODELS:
        ipde = _ipdes(study.patients, model, (*grid.CHOSEN, "scaled-chirp"))
        apart += [abs(ipde["scaled-chirp"] - ipde[name]) for name in grid.CHOSEN]
    return Ruling(max(apart) < same, f"at most {max(apart):.2f}")


def chosen_profiles(study: Study) -> Ruling:
    """Whether the chosen profiles rank first."""
    ranks = mean_ranks(study.grid)
    others = min(rank for name, rank in ranks.items() if name not in grid.CHOSEN)
    first = max(ranks[name] for name in grid.CHOSEN) < others
    return Ruling(first, f"mean ranks {listed(ranks)}")


def chosen_chirp(study: Study) -> Ruling:
    """SEM by amplitude, without 0.3 rad where that failed, and the factor of the lowest IPDE."""
    muscle, tendon = (
        _mean_scores(grid.along_amplitude(study.grid, model, p, upto) for p in grid.CHOSEN)
        for model, upto in (("muscle", 0.3), ("muscle-tendon", grid.CHOSEN_AMPLITUDE))
    )
    _, _, least, below = _factor_curves(study.grid + study.faster)
    higher = muscle[2:].max() < muscle[:2].min() and tendon[2] < tendon[:2].min()
    text = (
        f"SEM, muscle: {by_amplitude(muscle)}; muscle-tendon: {by_amplitude(tendon)}; IPDE lowest "
        f"at {least:g}, {below:.3f} below around 0.5"
    )
    return Ruling(bool(higher) and below < SAME_IPDE, text)


def chosen_task(study: Study) -> Ruling:
    """SEM and IPDE of both tasks at the chosen chirp."""
    pairs = [
        tuple(grid.cell_at(study.grid, *fit, grid.CHOSEN_AMPLITUDE, task) for task in grid.TASKS)
        for fit in _CHOSEN_FITS
    ]
    s = _mean_scores(pairs)
    d = np.mean([[cell.ipde or np.nan for cell in pair] for pair in pairs], axis=0)
    return Ruling(
        bool(s[0] < s[1] and d[0] < d[1]),
        f"part-passive SEM {s[0]:.2f}, IPDE {d[0]:.2f}; active SEM {s[1]:.2f}, IPDE {d[1]:.2f}",
    )
