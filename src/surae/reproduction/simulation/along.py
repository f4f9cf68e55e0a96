"""Cells of the grid along one factor, at the chosen chirp otherwise: rate, amplitude, profile."""

from collections.abc import Sequence

from surae.reproduction.simulation.cells import (
    Cell,
    NoFitError,
    at_chirp,
    ranked,
    scores,
    select,
)
from surae.reproduction.simulation.designs import (
    AMPLITUDES,
    CHOSEN_AMPLITUDE,
    CHOSEN_RATE,
    PROFILES,
)


def along_rate(found: Sequence[Cell], model: str, profile: str = "multiple-holds") -> list[Cell]:
    """Cells at 0.2 rad against the chirp's rate, part-passive.

    Raises
    ------
    NoFitError
        There is none.
    """
    some = select(
        found, model=model, profile=profile, task="part-passive", amplitude=CHOSEN_AMPLITUDE
    )
    if not some:
        raise NoFitError(f"no fit of the {model} model with {profile} at 0.2 rad")
    return sorted(some, key=lambda cell: cell.rate or 0.0)


def along_amplitude(
    found: Sequence[Cell], model: str, profile: str = "multiple-holds"
) -> list[Cell]:
    """Cells at 0.5 against the chirp's amplitude, part-passive; errors as of `cell_at`."""
    return [cell_at(found, model, profile, amplitude) for amplitude in AMPLITUDES]


def along_profile(found: Sequence[Cell], model: str, names: Sequence[str] = PROFILES) -> list[Cell]:
    """Cells at the chosen chirp, part-passive, of these profiles; errors as of `cell_at`."""
    return [cell_at(found, model, name, CHOSEN_AMPLITUDE) for name in names]


def cell_at(found: Sequence[Cell], model: str, profile: str, amplitude: float) -> Cell:
    """The cell at 0.5 and this amplitude, part-passive; of several subjects the first.

    Raises
    ------
    NoFitError
        Its fit failed.
    """
    some = at_chirp(
        found, amplitude, CHOSEN_RATE, model=model, profile=profile, task="part-passive"
    )
    if not some:
        raise NoFitError(f"no fit of the {model} model with {profile} at {amplitude:g} rad")
    return some[0]


def profile_order(
    found: Sequence[Cell], model: str, names: Sequence[str]
) -> tuple[list[str], dict[str, float]]:
    """Profiles by mean normalised SEM at the chosen chirp, the lowest first, and these means."""
    some = along_profile(found, model, names)
    score = {cell.profile: float(value) for cell, value in zip(some, scores(some), strict=True)}
    return ranked(list(score), list(score.values())), score
