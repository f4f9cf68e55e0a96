"""How the claims of the simulation study are computed and decided (3.1, 4.1), by their names.

Every rule takes a view of the study and what its row gives, and returns a `Ruling`.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.units import FloatArray
from surae_thesis.claims import Claim, NotThereError, Ruling
from surae_thesis.simulation import cells as grid
from surae_thesis.simulation.cells import Cells, GridCell, Study, ranked, scores, select, there

#: The thesis's limit of a good fit [%] (2.7, 4.1), and of a good estimate.
GOOD_VAF, GOOD_ESTIMATE = 99.85, 0.10
#: Factors up to and from which a SEM is slow's and fast's; "around" a factor of 0.5.
_SLOW, _FAST, _NEAR = 0.1, 0.5, (0.4, 0.6)
#: Profiles that have results of both models: the tendon model's multi-sine was omitted (4.1.3).
BOTH = tuple(name for name in grid.PROFILES if name != "multi-sine")


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
    middle, low, high = float(np.median(values)), float(values.min()), float(values.max())
    text = f"median {middle:.3f} %, {low:.3f} to {high:.3f} %"
    return Ruling(abs(middle - expected) <= around and low >= GOOD_VAF, text)


def tendon_vaf(study: Study, expected: float, around: float) -> Ruling:
    """VAF of the muscle-tendon model's cells that reach the thesis's limit."""
    cells = there(study.grid, model="muscle-tendon")
    good = [cell.vaf for cell in cells if cell.vaf >= GOOD_VAF]
    if not good:
        return Ruling(False, f"none of {len(cells)} cells reaches 99.85 %")
    middle = float(np.median(good))
    text = f"median {middle:.3f} % of the {len(good)} of {len(cells)} cells from 99.85 % up"
    return Ruling(abs(middle - expected) <= around, text)


def noise_alone(study: Study, _: Claim) -> str:
    """How far VAF is from what the noise alone leaves."""
    apart = max(abs(cell.vaf - cell.floor) for cell in select(study.grid, model="muscle"))
    return f"The noise alone leaves, in every cell, the VAF that we find within {apart:.3f} %."


def _wrong(cells: Iterable[GridCell]) -> int:
    """How many cells have a parameter that is more than 10 % off."""
    return sum(cell.worst[1] > GOOD_ESTIMATE for cell in cells)


def threshold(study: Study) -> Ruling:
    """Cells below the limit that have a wrong parameter."""
    low = [cell for cell in study.grid if cell.vaf < GOOD_VAF]
    return Ruling(_wrong(low) == len(low), f"{_wrong(low)} of {len(low)} cells below 99.85 %")


def above_threshold(study: Study, _: Claim) -> str:
    """Cells above the limit that have one too."""
    high = [cell for cell in study.grid if cell.vaf >= GOOD_VAF]
    return f"Of the {len(high)} cells above it {_wrong(high)} have such a parameter too."


def failing(study: Study, least: float, **where: object) -> Ruling:
    """How many cells of the muscle-tendon model somewhere fail by the thesis's limit."""
    some = there(study.grid, model="muscle-tendon", **where)
    low = sum(cell.vaf < GOOD_VAF for cell in some)
    return Ruling(low >= least * len(some), f"{low} of {len(some)} cells below 99.85 %")


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
    every = {
        where: (max(g) - min(g)) * (100.0 / float(np.mean(g)) if of == "k_tri" else 1.0)
        for where, g in groups.items()
        if len(g) > 1
    }
    shown = [width for (profile, _), width in every.items() if profile in profiles]
    if not shown:
        raise NotThereError("none of the noise's repeats is there")
    text = f"at most {max(shown):.3g}{unit}; over all five profiles {max(every.values()):.3g}{unit}"
    return Ruling(max(shown) <= most, text)


# Task


def _ratios(study: Study) -> dict[str, float]:
    """Geometric mean of SEM part-passive over active, by model and profile."""
    logs: dict[str, list[float]] = {}
    for a, b in _pairs(study):
        for name in a.sem.keys() & b.sem.keys():
            key = f"{a.model} {a.profile}"
            logs.setdefault(key, []).append(float(np.log(a.sem[name] / b.sem[name])))
    return {where: float(np.exp(np.mean(values))) for where, values in logs.items()}


def _pairs(study: Study) -> list[tuple[GridCell, GridCell]]:
    """Cells that differ in the task alone: part-passive, active."""
    keys = ("model", "profile", "amplitude", "factor")
    active = {tuple(getattr(c, k) for k in keys): c for c in there(study.grid, task="active")}
    passive = there(study.grid, task="part-passive")
    pairs = [(c, active.get(tuple(getattr(c, k) for k in keys))) for c in passive]
    return [(a, b) for a, b in pairs if b is not None]


def task_sem(study: Study) -> Ruling:
    """SEM of the part-passive task over that of the active one."""
    ratio = _ratios(study)
    several = {m: [r for k, r in ratio.items() if k.split()[0] == m] for m in grid.MODELS}
    text = "; ".join(f"{m} {min(r):.2f} to {max(r):.2f}" for m, r in several.items() if r)
    return Ruling(max(ratio.values()) < 1.0, f"ratio by profile: {text}")


def task_ipde(study: Study) -> Ruling:
    """IPDE of the part-passive task less that of the active one."""
    several: dict[tuple[str, str], list[float]] = {}
    for a, b in _pairs(study):
        if a.ipde is not None and b.ipde is not None:
            several.setdefault((b.model, b.profile), []).append(a.ipde - b.ipde)
    apart = [float(np.mean(values)) for values in several.values()]
    lower = sum(value < 0.0 for value in apart)
    text = f"lower in {lower} of {len(apart)}; difference {min(apart):+.2f} to {max(apart):+.2f}"
    return Ruling(lower == len(apart), text)


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
    order, middle = ranked(ratio), float(np.mean(list(ratio.values())))
    text = f"fast over slow: mean {middle:.2f}, {listed(ratio, order[:3])}"
    return Ruling(middle < 1.0 and order[0] == "m", text)


def factor_relaxation(study: Study, start: float, flat: float) -> Ruling:
    """Width of the relaxation parameters' curves from a factor up [%]."""
    line = [c for c in grid.along_factor(study.grid, "muscle") if (c.factor or 0.0) >= start]
    curves = grid.normalised(line)
    width = {name: 100 * float(np.abs(curves[name] - 1.0).max()) for name in grid.RELAXATION}
    text = ", ".join(f"{name} ± {width[name]:.0f} %" for name in grid.RELAXATION)
    return Ruling(max(width.values()) <= flat, text)


def amplitude_sem(study: Study, rise: float) -> Ruling:
    """Rise of the parameters' SEM from an amplitude to the next [%]."""
    rises = {
        name: 100 * float((values[1:] / values[:-1]).max() - 1.0)
        for name, values in grid.normalised(grid.along_amplitude(study.grid, "muscle")).items()
        if name not in grid.RELAXATION
    }
    rising = [name for name in reversed(ranked(rises)) if not rises[name] < rise]
    most = f", {rising[0]} rises by {rises[rising[0]]:.0f} %" if rising else ""
    return Ruling(not rising, f"{len(rises) - len(rising)} of {len(rises)} parameters fall{most}")


def amplitude_relaxation(study: Study) -> Ruling:
    """Best amplitude for the relaxation parameters."""
    curves = grid.normalised(grid.along_amplitude(study.grid, "muscle"))
    lowest = {
        name: grid.AMPLITUDES[int(np.nanargmin(curves[name]))]
        for name in grid.RELAXATION
        if name in curves
    }
    text = ", ".join(f"{name} {value:g} rad" for name, value in lowest.items())
    return Ruling(bool(lowest) and set(lowest.values()) == {0.1}, text)


def amplitude_tendon(study: Study) -> Ruling:
    """Muscle-tendon model: mean normalised SEM by amplitude."""
    score = scores(grid.along_amplitude(study.grid, "muscle-tendon", upto=0.2))
    return Ruling(
        grid.AMPLITUDES[int(np.argmin(score))] == grid.CHOSEN_AMPLITUDE, by_amplitude(score)
    )


# Profiles


def _profile_scores(cells: Cells, model: str, names: Sequence[str]) -> dict[str, float]:
    return dict(zip(names, scores(grid.along_profile(cells, model, names)).tolist(), strict=True))


def profile_sem(study: Study, model: str, best: list[str]) -> Ruling:
    """Mean normalised SEM by profile: the sine last, the best first."""
    names = grid.PROFILES if model == "muscle" else BOTH
    score = _profile_scores(study.grid, model, names)
    order = ranked(score)
    return Ruling(order[-1] == "sine" and set(order[: len(best)]) == set(best), listed(score))


def _ipdes(cells: Cells, model: str, names: Sequence[str]) -> dict[str, float]:
    some = grid.along_profile(cells, model, names)
    known = {cell.profile: cell.ipde for cell in some if cell.ipde is not None}
    if len(known) < len(names):
        raise NotThereError("a fit has no IPDE: a parameter could not be told")
    return known


def ipde_values(study: Study, model: str, close: float, printed: dict[str, list[float]]) -> Ruling:
    """How close the IPDE of profiles is to the printed range."""
    ipde = _ipdes(study.grid, model, tuple(printed))
    far = max(max(low - ipde[p], ipde[p] - high) for p, (low, high) in printed.items())
    return Ruling(far <= close, listed(ipde))


def ipde_ranking(study: Study) -> Ruling:
    """Muscle model: whether the chosen profiles have the lowest IPDE."""
    order = ranked(_ipdes(study.grid, "muscle", grid.PROFILES))
    return Ruling(set(order[:2]) == set(grid.CHOSEN), f"lowest first: {', '.join(order)}")


def ipde_tendon(study: Study, names: list[str], same: float) -> Ruling:
    """Muscle-tendon model: these profiles alike, the sine above."""
    ipde = _ipdes(study.grid, "muscle-tendon", BOTH)
    alike = [ipde[name] for name in names]
    return Ruling(max(alike) - min(alike) <= same and ipde["sine"] > max(alike), listed(ipde))


def ipde_factor(study: Study, model: str) -> Ruling:
    """The factor of the lowest IPDE, by profile."""
    lowest = {}
    for profile in grid.PROFILES if model == "muscle" else BOTH:
        line = [c for c in grid.along_factor(study.grid, model, profile) if c.ipde is not None]
        lowest[profile] = min(line, key=lambda cell: cell.ipde or np.inf).factor or 0.0
    text = ", ".join(f"{profile} {factor:g}" for profile, factor in lowest.items())
    return Ruling(all(_NEAR[0] <= f <= _NEAR[1] for f in lowest.values()), text)


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


def _amplitude_scores(cells: Cells) -> FloatArray:
    lines = [
        grid.along_amplitude(cells, model, profile)
        for model in grid.MODELS
        for profile in grid.CHOSEN
    ]
    return np.asarray(np.mean([scores(line) for line in lines], axis=0))


def _factor_curves(cells: Cells) -> tuple[FloatArray, FloatArray, float]:
    """Normalised SEM against the factor, the factors, and that of the lowest IPDE."""
    lines = [
        grid.along_factor(cells, model, profile) for model in grid.MODELS for profile in grid.CHOSEN
    ]
    ipde = np.nanmean([[c.ipde or np.nan for c in line] for line in lines], axis=0)
    at = np.array([cell.factor for cell in lines[0]], dtype=float)
    return np.mean([scores(line) for line in lines], axis=0), at, float(at[int(np.argmin(ipde))])


def patient_profiles(study: Study, best: list[str]) -> Ruling:
    """Whether the same profiles rank first in the patient and in health."""
    sick, healthy = mean_ranks(study.patients), mean_ranks(study.grid)
    both = all(set(ranked(ranks)[: len(best)]) == set(best) for ranks in (sick, healthy))
    return Ruling(both, f"mean ranks {listed(sick)}; in health {listed(healthy)}")


def patient_amplitude(study: Study) -> Ruling:
    """The patient's SEM by amplitude."""
    score = _amplitude_scores(study.patients)
    return Ruling(
        grid.AMPLITUDES[int(np.argmin(score))] == grid.CHOSEN_AMPLITUDE,
        f"SEM {by_amplitude(score)}",
    )


def patient_factor(study: Study) -> Ruling:
    """The patient's SEM and IPDE against the factor."""
    sem, at, least = _factor_curves(study.patients)
    return Ruling(
        bool(sem[-1] < sem[0]) and _NEAR[0] <= least <= _NEAR[1],
        f"SEM {sem[0]:.2f} at {at[0]:g}, {sem[-1]:.2f} at {at[-1]:g}; IPDE lowest at {least:g}",
    )


def patient_ipde(study: Study, same: float) -> Ruling:
    """The patient's IPDE of the scaled chirp against that of the chosen profiles."""
    apart = 0.0
    for model in grid.MODELS:
        ipde = _ipdes(study.patients, model, (*grid.CHOSEN, "scaled-chirp"))
        apart = max(apart, *(abs(ipde["scaled-chirp"] - ipde[name]) for name in grid.CHOSEN))
    return Ruling(apart < same, f"at most {apart:.2f}")


def chosen_profiles(study: Study) -> Ruling:
    """Whether the chosen profiles rank first."""
    ranks = mean_ranks(study.grid)
    others = min(rank for name, rank in ranks.items() if name not in grid.CHOSEN)
    first = max(ranks[name] for name in grid.CHOSEN) < others
    return Ruling(first, f"mean ranks {listed(ranks)}")


def chosen_chirp(study: Study) -> Ruling:
    """SEM by amplitude, without 0.3 rad where that failed, and the factor of the lowest IPDE."""
    muscle, tendon = (
        np.mean([scores(grid.along_amplitude(study.grid, m, p, upto)) for p in grid.CHOSEN], axis=0)
        for m, upto in (("muscle", 0.3), ("muscle-tendon", grid.CHOSEN_AMPLITUDE))
    )
    least = _factor_curves(study.grid)[2]
    higher = muscle[2:].max() < muscle[:2].min() and tendon[2] < tendon[:2].min()
    text = (
        f"SEM, muscle: {by_amplitude(muscle)}; muscle-tendon: {by_amplitude(tendon)}; IPDE lowest "
        f"at {least:g}"
    )
    return Ruling(bool(higher) and _NEAR[0] <= least <= _NEAR[1], text)


def chosen_task(study: Study) -> Ruling:
    """SEM and IPDE of both tasks at the chosen chirp."""
    sem, ipde = [], []
    for model, profile in itertools.product(grid.MODELS, grid.CHOSEN):
        pair = [
            grid.cell_at(study.grid, model, profile, grid.CHOSEN_AMPLITUDE, task)
            for task in grid.TASKS
        ]
        sem.append(scores(pair))
        ipde.append([np.nan if cell.ipde is None else cell.ipde for cell in pair])
    s, d = np.mean(sem, axis=0), np.mean(ipde, axis=0)
    return Ruling(
        bool(s[0] < s[1] and d[0] < d[1]),
        f"part-passive SEM {s[0]:.2f}, IPDE {d[0]:.2f}; active SEM {s[1]:.2f}, IPDE {d[1]:.2f}",
    )
