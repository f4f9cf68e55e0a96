"""How claims on profiles, patients and choices are computed and decided (3.1.2 to 3.1.5, 4.1)."""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae.units import FloatArray
from surae_thesis.claims import Claim, NotThereError, Ruling
from surae_thesis.simulation.cells import (
    AMPLITUDES,
    CHOSEN,
    CHOSEN_AMPLITUDE,
    CHOSEN_FACTOR,
    MODELS,
    PROFILES,
    TASKS,
    Cells,
    Study,
    along_amplitude,
    along_factor,
    along_profile,
    cell_at,
    ranked,
    scores,
    select,
)
from surae_thesis.simulation.rules import best_amplitude, by_amplitude, told

#: "Around" a factor of 0.5.
_NEAR = (0.4, 0.6)


# Profiles


def _profile_scores(cells: Cells, model: str, names: Sequence[str]) -> dict[str, float]:
    return dict(zip(names, scores(along_profile(cells, model, names)).tolist(), strict=True))


def profile_sem(study: Study, model: str, names: list[str], best: list[str]) -> Ruling:
    """Mean normalised SEM by profile: the sine last, the best first."""
    score = _profile_scores(study.grid, model, names)
    order = ranked(score)
    return Ruling(order[-1] == "sine" and set(order[: len(best)]) == set(best), told(score))


def _ipdes(study: Study, model: str, names: Sequence[str] = PROFILES) -> dict[str, float]:
    some = along_profile(study.grid, model, names)
    told = {cell.profile: cell.ipde for cell in some if cell.ipde is not None}
    if len(told) < len(names):
        raise NotThereError("a fit has no IPDE: a parameter could not be told")
    return told


def ipde_values(study: Study, model: str, close: float, printed: dict[str, list[float]]) -> Ruling:
    """How close the IPDE of profiles is to the printed range."""
    ipde = _ipdes(study, model, tuple(printed))
    far = max(max(low - ipde[p], ipde[p] - high) for p, (low, high) in printed.items())
    return Ruling(far <= close, told(ipde))


def ipde_ranking(study: Study) -> Ruling:
    """Muscle model: whether the chosen profiles have the lowest IPDE."""
    order = ranked(_ipdes(study, "muscle"))
    return Ruling(set(order[:2]) == set(CHOSEN), f"lowest first: {', '.join(order)}")


def ipde_tendon(study: Study, names: list[str], same: float) -> Ruling:
    """Muscle-tendon model: these profiles alike, the sine above."""
    ipde = _ipdes(study, "muscle-tendon", [name for name in PROFILES if name in [*names, "sine"]])
    alike = [ipde[name] for name in names]
    return Ruling(max(alike) - min(alike) <= same and ipde["sine"] > max(alike), told(ipde))


def _ipde_lines(study: Study, claim: Mapping[str, Any]) -> dict[str, list[tuple[float, float]]]:
    """IPDE and factor of each profile."""
    return {
        profile: [
            (cell.ipde, cell.factor or 0.0)
            for cell in along_factor(study.grid, claim["model"], profile)
            if cell.ipde is not None
        ]
        for profile in claim["names"]
    }


def ipde_factor(study: Study, **given: Any) -> Ruling:
    """The factor of the lowest IPDE, by profile."""
    lowest = {profile: min(line)[1] for profile, line in _ipde_lines(study, given).items()}
    text = ", ".join(f"{profile} {factor:g}" for profile, factor in lowest.items())
    return Ruling(all(_NEAR[0] <= f <= _NEAR[1] for f in lowest.values()), text)


def ipde_at_chosen(study: Study, claim: Claim) -> str:
    """How flat it is there."""
    excess = max(
        min(line, key=lambda at: abs(at[1] - CHOSEN_FACTOR))[0] - min(line)[0]
        for line in _ipde_lines(study, claim.given).values()
    )
    return f"At 0.5 it is at most {excess:.2f} above the lowest."


def ipde_amplitude(study: Study, model: str) -> Ruling:
    """Mean IPDE by amplitude."""
    means = [
        float(np.mean([c.ipde for c in here if c.ipde is not None]))
        for a in AMPLITUDES
        if (here := select(study.grid, model=model, task="part-passive", amplitude=a))
    ]
    if len(means) < len(AMPLITUDES):
        raise NotThereError("not every amplitude was fitted")
    return Ruling(all(b < a for a, b in itertools.pairwise(means)), by_amplitude(means))


# Patients and choices: means over both models, and for the chirp over the chosen profiles


def mean_ranks(cells: Cells) -> dict[str, float]:
    """Mean rank of each profile, 1 the best, over SEM and IPDE of both models."""
    places: dict[str, list[int]] = {profile: [] for profile in PROFILES}
    for model in MODELS:
        ipde = {c.profile: c.ipde for c in along_profile(cells, model) if c.ipde is not None}
        for values in (_profile_scores(cells, model, PROFILES), ipde):
            for place, name in enumerate(ranked(values), 1):
                places[name].append(place)
    return {name: float(np.mean(some)) for name, some in places.items() if some}


def _amplitude_scores(cells: Cells) -> FloatArray:
    lines = [along_amplitude(cells, model, profile) for model in MODELS for profile in CHOSEN]
    return np.asarray(np.mean([scores(line) for line in lines], axis=0))


def _factor_curves(cells: Cells) -> tuple[FloatArray, FloatArray, float]:
    """Normalised SEM against the factor, the factors, and that of the lowest IPDE."""
    lines = [along_factor(cells, model, profile) for model in MODELS for profile in CHOSEN]
    ipde = np.nanmean([[c.ipde or np.nan for c in line] for line in lines], axis=0)
    at = np.array([cell.factor for cell in lines[0]], dtype=float)
    return np.mean([scores(line) for line in lines], axis=0), at, float(at[int(np.argmin(ipde))])


def patient_profiles(study: Study, best: list[str]) -> Ruling:
    """Whether the same profiles rank first in the patient and in health."""
    sick, healthy = mean_ranks(study.patients), mean_ranks(study.grid)
    both = all(set(ranked(ranks)[: len(best)]) == set(best) for ranks in (sick, healthy))
    return Ruling(both, f"mean ranks {told(sick)}")


def healthy_ranks(study: Study, _: Claim) -> str:
    """The ranks in health."""
    return f"Healthy: mean ranks {told(mean_ranks(study.grid))}."


def patient_amplitude(study: Study) -> Ruling:
    """The patient's SEM by amplitude."""
    score = _amplitude_scores(study.patients)
    return Ruling(best_amplitude(score), f"SEM {by_amplitude(score)}")


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
    for model in MODELS:
        some = along_profile(study.patients, model, (*CHOSEN, "scaled-chirp"))
        ipde = {cell.profile: cell.ipde or np.nan for cell in some}
        apart = max(apart, *(abs(ipde["scaled-chirp"] - ipde[name]) for name in CHOSEN))
    return Ruling(apart < same, f"at most {apart:.2f}")


def chosen_profiles(study: Study) -> Ruling:
    """Whether the chosen profiles rank first."""
    ranks = mean_ranks(study.grid)
    return Ruling(set(ranked(ranks)[:2]) == set(CHOSEN), f"mean ranks {told(ranks)}")


def chosen_chirp(study: Study) -> Ruling:
    """SEM by amplitude, and the factor of the lowest IPDE."""
    score = _amplitude_scores(study.grid)
    _, _, least = _factor_curves(study.grid)
    text = f"SEM {by_amplitude(score)}; IPDE lowest at {least:g}"
    return Ruling(best_amplitude(score) and _NEAR[0] <= least <= _NEAR[1], text)


def chosen_task(study: Study) -> Ruling:
    """SEM and IPDE of both tasks at the chosen chirp."""
    sem, ipde = [], []
    for model, profile in itertools.product(MODELS, CHOSEN):
        pair = [cell_at(study.grid, model, profile, CHOSEN_AMPLITUDE, task) for task in TASKS]
        sem.append(scores(pair))
        ipde.append([np.nan if cell.ipde is None else cell.ipde for cell in pair])
    s, d = np.mean(sem, axis=0), np.mean(ipde, axis=0)
    return Ruling(
        bool(s[0] < s[1] and d[0] < d[1]),
        f"part-passive SEM {s[0]:.2f}, IPDE {d[0]:.2f}; active SEM {s[1]:.2f}, IPDE {d[1]:.2f}",
    )
