"""Claims about standard errors (3.1.1 to 3.1.3): task, chirp rate, chirp amplitude, profile."""

from collections.abc import Sequence

import numpy as np

from surae.reproduction.claims import Claim, Finding
from surae.reproduction.simulation.along import along_amplitude, along_rate, profile_order
from surae.reproduction.simulation.cells import (
    RELAXATION,
    Cell,
    NoFitError,
    mean,
    normalised,
    scores,
    select,
)
from surae.reproduction.simulation.designs import (
    AMPLITUDES,
    CHOSEN,
    CHOSEN_AMPLITUDE,
    MODELS,
    PROFILES,
)
from surae.reproduction.simulation.goodness import NOISE_SEM
from surae.reproduction.simulation.ruling import Ruling, under_both
from surae.reproduction.simulation.torques import at_equal_noise, at_signed_noise

#: From here up the relaxation parameters are said to be flat [-], and what counts as flat.
_FLAT_FROM, _FLAT = 0.2, 0.15
#: Above and below these rates [-] a SEM is fast's and slow's.
_SLOW, _FAST = 0.1, 0.5

TASK = Claim(
    name="task-sem",
    source="3.1.1, 4.1.1",
    text="SEM is lower for the part-passive task than for the active one, in every profile.",
    number="lower in all",
    rule="Geometric mean over cells and parameters of SEM part-passive over active below 1 in "
    "every profile of both models.",
)
RATE = Claim(
    name="rate-sem",
    source="3.1.2, Figure 11a",
    text="Muscle model: SEM falls with the chirp's rate, most for m.",
    number="falls; m most",
    rule=f"Mean SEM from {_FAST} up below that to {_SLOW} for every parameter but "
    "tau_rel and k_rel, with the smallest ratio for m (multiple holds, 0.2 rad).",
)
RATE_TENDON = Claim(
    name="rate-sem-tendon",
    source="3.1.3, Figure 11b",
    text="Muscle-tendon model: SEM tends to fall with the chirp's rate, most for m.",
    number="tends to fall; m most",
    rule=f"Mean over the parameters of the ratio of mean SEM from {_FAST} up to that to "
    f"{_SLOW} below 1, with the smallest ratio for m (multiple holds, 0.2 rad).",
)
RATE_RELAXATION = Claim(
    name="rate-relaxation",
    source="3.1.2, 4.1.2, Figure 11a",
    text="Muscle model: SEM of tau_rel and k_rel stays flat above a rate of about 0.2.",
    number="flat",
    rule=f"Both within ± {100 * _FLAT:g} % of their mean from {_FLAT_FROM} up (multiple "
    "holds, 0.2 rad).",
)
AMPLITUDE = Claim(
    name="amplitude-sem",
    source="3.1.2, Figure 12a",
    text="Muscle model: SEM falls with the chirp's amplitude, but for tau_rel and k_rel.",
    number="falls",
    rule="Every other parameter's SEM falls from each amplitude to the next, or rises by less than "
    "the thesis's 3.75 % of noise (multiple holds, 0.5).",
)
AMPLITUDE_RELAXATION = Claim(
    name="amplitude-relaxation",
    source="3.1.2, Figure 12a",
    text="Muscle model: SEM of tau_rel and k_rel is lowest at 0.1 rad.",
    number="0.1 rad",
    rule="Lowest at 0.1 rad for both (multiple holds, 0.5).",
)
AMPLITUDE_TENDON = Claim(
    name="amplitude-sem-tendon",
    source="3.1.3, Figure 12b",
    text="Muscle-tendon model: SEM is lowest at 0.2 rad of 0, 0.1 and 0.2 rad.",
    number="0.2 rad",
    rule="Mean of the normalised SEMs lowest at 0.2 rad of the three (multiple holds, 0.5).",
)
PROFILE = Claim(
    name="profile-sem",
    source="3.1.2, Figure 13",
    text="Muscle model: SEM is highest for the sine and lowest for multi-sine, multi-sine-holds "
    "and scaled chirp.",
    number="sine highest; these three lowest",
    rule="Mean of the normalised SEMs: the sine last, the three first (0.2 rad, 0.5).",
)
PROFILE_TENDON = Claim(
    name="profile-sem-tendon",
    source="3.1.3, 4.1.3, Figure 14",
    text="Muscle-tendon model: SEM is highest for the sine and lowest for multiple holds and "
    "multi-sine-holds.",
    number="sine highest; these two lowest",
    rule="Mean of the normalised SEMs over the four profiles of Figure 14: the sine last, the two "
    "first (0.2 rad, 0.5).",
)
BY_RATE = (RATE, RATE_TENDON, RATE_RELAXATION)
BY_AMPLITUDE = (AMPLITUDE, AMPLITUDE_RELAXATION, AMPLITUDE_TENDON)
BY_PROFILE = (PROFILE, PROFILE_TENDON)


def task(found: Sequence[Cell]) -> Finding:
    """Part-passive against active, pairs of cells that differ in nothing else."""
    _, by_name, share = _task_ratios(found)
    better = sorted((n for n in by_name if by_name[n] < 1.0), key=lambda n: by_name[n])
    worse = sorted((n for n in by_name if by_name[n] >= 1.0), key=lambda n: -by_name[n])
    about = (
        f"Of all pairs of SEMs {100 * share:.0f} % are lower. Lower on average: "
        f"{_ratios(better, by_name)}; not lower: {_ratios(worse, by_name)}: the passive seconds "
        "tell the passive parameters and are lost to the active ones."
    )

    def rule(some: Sequence[Cell]) -> Ruling:
        means, _, _ = _task_ratios(some)
        ours = "; ".join(
            f"{model} {min(m):.2f} to {max(m):.2f}"
            for model in MODELS
            if (m := [value for (one, _), value in means.items() if one == model])
        )
        return all(value < 1.0 for value in means.values()), f"ratio by profile: {ours}"

    return under_both(TASK, rule, found, about=about)


def _task_ratios(
    found: Sequence[Cell],
) -> tuple[dict[tuple[str, str], float], dict[str, float], float]:
    """SEM part-passive over active: by model and profile, by parameter; share of lower ones."""
    passive = {_place(cell): cell for cell in select(found, task="part-passive")}
    by_profile: dict[tuple[str, str], list[float]] = {}
    by_name: dict[str, list[float]] = {}
    for cell in select(found, task="active"):
        if (other := passive.get(_place(cell))) is None:
            continue
        for name in cell.sem.keys() & other.sem.keys():
            log = float(np.log(other.sem[name] / cell.sem[name]))
            by_profile.setdefault((cell.model, cell.profile), []).append(log)
            by_name.setdefault(name, []).append(log)
    if not by_profile:
        raise NoFitError("no pair of tasks is there")
    every = np.concatenate([np.array(logs) for logs in by_profile.values()])
    return (
        {key: float(np.exp(np.mean(logs))) for key, logs in by_profile.items()},
        {key: float(np.exp(np.mean(logs))) for key, logs in by_name.items()},
        float(np.mean(every < 0.0)),
    )


def rates(found: Sequence[Cell]) -> list[Finding]:
    """SEM against the chirp's rate, multiple holds at 0.2 rad, part-passive."""

    def fast_over_slow(some: Sequence[Cell], model: str) -> dict[str, float]:
        line = along_rate(some, model)
        at = np.array([cell.rate for cell in line], dtype=float)
        return {
            name: mean(curve[at >= _FAST]) / mean(curve[at <= _SLOW])
            for name, curve in normalised(line).items()
        }

    def falls(some: Sequence[Cell]) -> Ruling:
        ratio = fast_over_slow(some, "muscle")
        order = sorted(ratio, key=lambda name: ratio[name])
        rising = [name for name in order if name not in RELAXATION and not ratio[name] < 1.0]
        ours = (
            f"fast over slow: {_ratios(order[:3], ratio)}; {len(ratio) - 2 - len(rising)} of "
            f"{len(ratio) - 2} fall"
        )
        return not rising and order[0] == "m", ours

    def tends(some: Sequence[Cell]) -> Ruling:
        ratio = fast_over_slow(some, "muscle-tendon")
        there = {name: value for name, value in ratio.items() if not np.isnan(value)}
        order = sorted(there, key=lambda name: there[name])
        middle = mean(np.array(list(there.values())))
        ours = f"fast over slow: mean {middle:.2f}, {_ratios(order[:3], there)}"
        return middle < 1.0 and order[0] == "m", ours

    def flat(some: Sequence[Cell]) -> Ruling:
        line = [c for c in along_rate(some, "muscle") if (c.rate or 0.0) >= _FLAT_FROM]
        curves = normalised(line)
        width = {name: float(np.abs(curves[name] - 1.0).max()) for name in RELAXATION}
        ours = ", ".join(f"{name} ± {100 * width[name]:.0f} %" for name in RELAXATION)
        return max(width.values()) <= _FLAT, ours

    return [
        under_both(claim, rule, found, figure="figure-11")
        for claim, rule in ((RATE, falls), (RATE_TENDON, tends), (RATE_RELAXATION, flat))
    ]


def amplitudes(found: Sequence[Cell], others: Sequence[Cell]) -> list[Finding]:
    """SEM against the chirp's amplitude, multiple holds at 0.5; `others` are more subjects."""

    def falls(some: Sequence[Cell]) -> Ruling:
        curves = normalised(along_amplitude(some, "muscle"))
        rise = {
            name: float((values[1:] / values[:-1]).max() - 1.0)
            for name, values in curves.items()
            if name not in RELAXATION
        }
        rising = sorted((n for n in rise if not rise[n] < NOISE_SEM), key=lambda n: -rise[n])
        most = f", {rising[0]} rises by {100 * rise[rising[0]]:.0f} %" if rising else ""
        return not rising, f"{len(rise) - len(rising)} of {len(rise)} parameters fall{most}"

    def relaxation(some: Sequence[Cell]) -> Ruling:
        curves = normalised(along_amplitude(some, "muscle"))
        lowest = {name: AMPLITUDES[int(np.nanargmin(curves[name]))] for name in RELAXATION}
        ours = ", ".join(f"{name} {value:g} rad" for name, value in lowest.items())
        return all(value == 0.1 for value in lowest.values()), ours

    def tendon(some: Sequence[Cell]) -> Ruling:
        score = scores(along_amplitude(some, "muscle-tendon")[:3])
        ours = ", ".join(f"{a:g} rad {s:.2f}" for a, s in zip(AMPLITUDES, score, strict=False))
        return AMPLITUDES[int(np.argmin(score))] == CHOSEN_AMPLITUDE, ours

    many = "; ".join(f"{name} {_counts(_lowest_by_subject(others, name))}" for name in RELAXATION)
    return [
        under_both(AMPLITUDE, falls, found, figure="figure-12"),
        under_both(
            AMPLITUDE_RELAXATION,
            relaxation,
            found,
            about=f"Over the virtual subjects, lowest at: {many}.",
            figure="figure-12",
        ),
        under_both(AMPLITUDE_TENDON, tendon, found, figure="figure-12"),
    ]


def profiles(found: Sequence[Cell], others: Sequence[Cell]) -> list[Finding]:
    """SEM of the profiles at the chosen chirp; `others` are more subjects."""
    return [
        _profiles(
            found, others, "muscle", PROFILE, PROFILES,
            {"multi-sine", "multi-sine-holds", "scaled-chirp"}, "figure-13",
        ),
        _profiles(
            found, others, "muscle-tendon", PROFILE_TENDON,
            tuple(name for name in PROFILES if name != "multi-sine"), set(CHOSEN), "figure-14",
        ),
    ]  # fmt: skip


def _profiles(
    found: Sequence[Cell], others: Sequence[Cell], model: str, claim: Claim,
    names: tuple[str, ...], best: set[str], figure: str,
) -> Finding:  # fmt: skip
    def rule(some: Sequence[Cell]) -> Ruling:
        order, score = profile_order(some, model, names)
        ours = ", ".join(f"{name} {score[name]:.2f}" for name in order)
        return order[-1] == "sine" and set(order[: len(best)]) == best, ours

    subjects = sorted({cell.subject for cell in others})
    held = [
        sum(rule(select(cells, subject=subject))[0] for subject in subjects)
        for cells in (others, at_equal_noise(others), at_signed_noise(others))
    ]
    about = (
        f"It holds for {held[0]} of {len(subjects)} virtual subjects, at equal noise for "
        f"{held[1]}, at that of the signed mean for {held[2]}. "
        "The exact shapes of the thesis's profiles are not published."
    )
    return under_both(claim, rule, found, about=about, figure=figure)


def _place(cell: Cell) -> tuple[object, ...]:
    """Where in the grid a cell is, but for its task."""
    return cell.model, cell.profile, cell.amplitude, cell.rate


def _lowest_by_subject(others: Sequence[Cell], name: str) -> list[float]:
    """The amplitude of the lowest SEM of a parameter of the muscle model, for each subject."""
    found = []
    for subject in sorted({cell.subject for cell in others}):
        some = along_amplitude(select(others, subject=subject), "muscle")
        values = [cell.sem.get(name, np.inf) for cell in some]
        found.append(some[int(np.argmin(values))].amplitude)
    return found


def _counts(values: Sequence[float]) -> str:
    return ", ".join(
        f"{value:g} rad in {values.count(value)} of {len(values)}" for value in sorted(set(values))
    )


def _ratios(names: Sequence[str], values: dict[str, float]) -> str:
    return ", ".join(f"{name} {values[name]:.2f}" for name in names) or "none"
