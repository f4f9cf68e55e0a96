"""How the claims on VAF, noise, task and chirp are computed and decided (3.1), by their names.

Every rule takes a view of the study and what its row gives, and returns a `Ruling`; what explains
one takes the view and the claim.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.units import FloatArray
from surae_thesis.claims import Claim, NotThereError, Ruling
from surae_thesis.simulation.cells import (
    AMPLITUDES,
    CHOSEN_AMPLITUDE,
    MODELS,
    PROFILES,
    RELAXATION,
    GridCell,
    Study,
    along_amplitude,
    along_factor,
    mean,
    normalised,
    ranked,
    scores,
    select,
    there,
)

#: The thesis's limit of a good fit [%] (2.7, 4.1), and of a good estimate.
GOOD_VAF, GOOD_ESTIMATE = 99.85, 0.10
#: Factors up to and from which a SEM is slow's and fast's.
_SLOW, _FAST = 0.1, 0.5


def told(values: Mapping[str, float], names: Iterable[str] = ()) -> str:
    """Numbers by their names, the lowest first unless names are given."""
    return ", ".join(f"{name} {values[name]:.2f}" for name in names or ranked(values))


def by_amplitude(values: Iterable[float]) -> str:
    """Numbers by the chirp's amplitude."""
    return ", ".join(f"{a:g} rad {v:.2f}" for a, v in zip(AMPLITUDES, values, strict=False))


def best_amplitude(values: FloatArray) -> bool:
    """Whether the chosen amplitude has the lowest value."""
    return AMPLITUDES[int(np.argmin(values))] == CHOSEN_AMPLITUDE


def again(study: Study, claim: Claim) -> str:
    """Say for how many of the other subjects a claim holds."""
    subjects = sorted({cell.subject for cell in study.others})
    grids = [replace(study, grid=select(study.others, subject=n)) for n in subjects]
    count = sum(claim.ours(grid).holds for grid in grids)
    return f"It holds for {count} of {len(subjects)} virtual subjects."


# VAF and noise


def muscle_vaf(study: Study, expected: float, around: float) -> Ruling:
    """VAF of the muscle model over its cells."""
    values = np.array([cell.vaf for cell in there(study.grid, "muscle")])
    middle, low, high = float(np.median(values)), float(values.min()), float(values.max())
    text = f"median {middle:.3f} %, {low:.3f} to {high:.3f} %"
    return Ruling(abs(middle - expected) <= around and low >= GOOD_VAF, text)


def noise_alone(study: Study, _: Claim) -> str:
    """How far VAF is from what the noise alone leaves."""
    cells = [cell for cell in select(study.grid, model="muscle") if cell.torque]
    apart = max(abs(cell.vaf - cell.floor) for cell in cells)
    return (
        f"The noise alone leaves, in every cell, the VAF that we find within {apart:.3f} %: what "
        "is called goodness of fit is the torque's ratio of mean magnitude to root mean square, "
        "which the motion and the effort make."
    )


def tendon_vaf(study: Study, expected: float, around: float) -> Ruling:
    """VAF of the muscle-tendon model's cells that reach the thesis's limit."""
    cells = there(study.grid, "muscle-tendon")
    good = [cell.vaf for cell in cells if cell.vaf >= GOOD_VAF]
    if not good:
        return Ruling(False, f"none of {len(cells)} cells reaches 99.85 %")
    middle = float(np.median(good))
    text = f"median {middle:.3f} % of the {len(good)} of {len(cells)} cells from 99.85 % up"
    return Ruling(abs(middle - expected) <= around, text)


def floor_by_subject(study: Study, _: Claim) -> str:
    """What the noise alone leaves to other subjects."""
    cells = there(study.others, "muscle-tendon", task="part-passive")
    subjects = sorted({cell.subject for cell in cells})
    floors = [
        float(np.median([cell.floor for cell in select(cells, subject=number)]))
        for number in subjects
    ]
    return (
        f"The noise alone leaves {min(floors):.2f} to {max(floors):.2f} % to {len(floors)} virtual "
        "subjects (medians over profiles and amplitudes): the number tells how the torque is "
        "shaped, by subject and effort, not how a model follows it."
    )


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
    return (
        f"The threshold tells nothing: of the {len(high)} cells above it {_wrong(high)} have such "
        "a parameter too."
    )


def failing(study: Study, least: float, **where: object) -> Ruling:
    """How many cells of the muscle-tendon model somewhere fail by the thesis's limit."""
    some = there(study.grid, "muscle-tendon", **where)
    low = sum(cell.vaf < GOOD_VAF for cell in some)
    return Ruling(low >= least * len(some), f"{low} of {len(some)} cells below 99.85 %")


def failing_by_noise(study: Study, claim: Claim) -> str:
    """How many of them fail by the noise alone."""
    where = {key: value for key, value in claim.given.items() if key != "least"}
    some = there(study.grid, "muscle-tendon", **where)
    low = [cell for cell in some if cell.vaf < GOOD_VAF]
    return (
        f"In {sum(cell.floor < GOOD_VAF for cell in low)} of the {len(low)} the noise alone "
        "leaves less than 99.85 %: the threshold tells how the torque is shaped, not that a "
        "fit failed."
    )


#: What is looked at of a cell, by name.
_VALUES: Mapping[str, Callable[[GridCell], float | None]] = {
    "vaf": lambda cell: cell.vaf,
    "ipde": lambda cell: cell.ipde,
    "k_tri": lambda cell: cell.sem.get("k_tri"),
}


def _ranges(study: Study, of: str, profiles: Sequence[str]) -> list[tuple[float, str]]:
    """Range over repeats of the noise, by profile and factor; a SEM's in percent of its mean."""
    groups: dict[tuple[str, float | None], list[float]] = {}
    for cell in study.noise:
        if cell.profile in profiles and (number := _VALUES[of](cell)) is not None:
            groups.setdefault((cell.profile, cell.factor), []).append(number)
    ranges = [
        ((max(g) - min(g)) * (100.0 / float(np.mean(g)) if of == "k_tri" else 1.0), profile)
        for (profile, _), g in groups.items()
        if len(g) > 1
    ]
    if not ranges:
        raise NotThereError("none of the noise's repeats is there")
    return ranges


def spread(study: Study, of: str, most: float, unit: str, profiles: list[str]) -> Ruling:
    """Largest range over repeats of the noise with the profiles of the thesis's figure."""
    width, place = max(_ranges(study, of, profiles))
    return Ruling(width <= most, f"at most {width:.3g}{unit} ({place})")


def spread_of_all(study: Study, claim: Claim) -> str:
    """The same over all profiles, and the range that is usual."""
    given = claim.given
    ranges = _ranges(study, given["of"], PROFILES)
    (width, place), middle = max(ranges), float(np.median([width for width, _ in ranges]))
    return (
        f"Over all profiles {middle:.2g}{given['unit']} in the median, at most "
        f"{width:.2g}{given['unit']} ({place})."
    )


# Task


def _pairs(study: Study) -> list[tuple[GridCell, GridCell]]:
    """Cells that differ in the task alone: part-passive, active."""

    def place(cell: GridCell) -> tuple[object, ...]:
        return cell.model, cell.profile, cell.amplitude, cell.factor

    passive = {place(cell): cell for cell in select(study.grid, task="part-passive")}
    active = select(study.grid, task="active")
    pairs = [(passive[place(cell)], cell) for cell in active if place(cell) in passive]
    if not pairs:
        raise NotThereError("no pair of tasks is there")
    return pairs


def _ratios(study: Study, key: Callable[[GridCell, str], str]) -> dict[str, float]:
    """Geometric mean of SEM part-passive over active, by what `key` says of cell and parameter."""
    logs: dict[str, list[float]] = {}
    for passive, active in _pairs(study):
        for name in passive.sem.keys() & active.sem.keys():
            ratio = float(np.log(passive.sem[name] / active.sem[name]))
            logs.setdefault(key(active, name), []).append(ratio)
    return {where: float(np.exp(np.mean(values))) for where, values in logs.items()}


def task_sem(study: Study) -> Ruling:
    """SEM of the part-passive task over that of the active one."""
    ratio = _ratios(study, lambda cell, _: f"{cell.model} {cell.profile}")
    several = {m: [r for k, r in ratio.items() if k.split()[0] == m] for m in MODELS}
    text = "; ".join(f"{m} {min(r):.2f} to {max(r):.2f}" for m, r in several.items() if r)
    return Ruling(max(ratio.values()) < 1.0, f"ratio by profile: {text}")


def task_by_parameter(study: Study, _: Claim) -> str:
    """The same by parameter."""
    return (
        f"Ratio by parameter: {told(_ratios(study, lambda _, name: name))}. The passive seconds "
        "tell the passive parameters and are lost to the active ones."
    )


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
    line = along_factor(study.grid, model)
    at = np.array([cell.factor for cell in line], dtype=float)
    ratio = {
        name: mean(curve[at >= _FAST]) / mean(curve[at <= _SLOW])
        for name, curve in normalised(line).items()
    }
    return {name: value for name, value in ratio.items() if not np.isnan(value)}


def factor_sem(study: Study) -> Ruling:
    """Muscle model: SEM of fast chirps over that of slow ones."""
    ratio = _fast_over_slow(study, "muscle")
    order = ranked(ratio)
    rest = [name for name in order if name not in RELAXATION]
    rising = [name for name in rest if not ratio[name] < 1.0]
    return Ruling(
        not rising and order[0] == "m",
        f"fast over slow: {told(ratio, [*order[:3], *rising[-1:]])}; {len(rest) - len(rising)} of "
        f"{len(rest)} fall",
    )


def factor_sem_tendon(study: Study) -> Ruling:
    """Muscle-tendon model: the same, on the mean."""
    ratio = _fast_over_slow(study, "muscle-tendon")
    order, middle = ranked(ratio), mean(np.array(list(ratio.values())))
    text = f"fast over slow: mean {middle:.2f}, {told(ratio, order[:3])}"
    return Ruling(middle < 1.0 and order[0] == "m", text)


def factor_relaxation(study: Study, start: float, flat: float) -> Ruling:
    """Width of the relaxation parameters' curves from a factor up [%]."""
    line = [c for c in along_factor(study.grid, "muscle") if (c.factor or 0.0) >= start]
    curves = normalised(line)
    width = {name: 100 * float(np.abs(curves[name] - 1.0).max()) for name in RELAXATION}
    text = ", ".join(f"{name} ± {width[name]:.0f} %" for name in RELAXATION)
    return Ruling(max(width.values()) <= flat, text)


def amplitude_sem(study: Study, rise: float) -> Ruling:
    """Rise of the parameters' SEM from an amplitude to the next [%]."""
    curves = normalised(along_amplitude(study.grid, "muscle"))
    rises = {
        name: 100 * float((values[1:] / values[:-1]).max() - 1.0)
        for name, values in curves.items()
        if name not in RELAXATION
    }
    rising = [name for name in reversed(ranked(rises)) if not rises[name] < rise]
    most = f", {rising[0]} rises by {rises[rising[0]]:.0f} %" if rising else ""
    return Ruling(not rising, f"{len(rises) - len(rising)} of {len(rises)} parameters fall{most}")


def amplitude_relaxation(study: Study) -> Ruling:
    """Best amplitude for the relaxation parameters."""
    curves = normalised(along_amplitude(study.grid, "muscle"))
    lowest = {
        name: AMPLITUDES[int(np.nanargmin(curves[name]))] for name in RELAXATION if name in curves
    }
    text = ", ".join(f"{name} {value:g} rad" for name, value in lowest.items())
    return Ruling(bool(lowest) and set(lowest.values()) == {0.1}, text)


def amplitude_tendon(study: Study) -> Ruling:
    """Muscle-tendon model: mean normalised SEM by amplitude."""
    score = scores(along_amplitude(study.grid, "muscle-tendon", upto=0.2))
    return Ruling(best_amplitude(score), by_amplitude(score))
