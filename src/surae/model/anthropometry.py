"""The mass of the foot from that of the body, so that a fit need not find it.

The thesis found the mass at its bounds in most subjects and proposes to take it out of the free
parameters (4.5): slow motion tells little about it. Fast motion, such as the chirp of its
protocols, tells it better than any table does, and a wrong mass then spoils the others.
"""

from collections.abc import Sequence
from dataclasses import replace

from surae.errors import InputError
from surae.signals import ModelInputs

#: Mass of one foot as a part of the body's, by the tables it comes from.
FOOT_SHARE = {
    # Winter, Biomechanics and Motor Control of Human Movement (2009), Table 4.1, after Dempster.
    "winter": 0.0145,
    # de Leva, J. Biomech. 29 (1996), after Zatsiorsky and Seluyanov: young women and men.
    "de-leva-female": 0.0129,
    "de-leva-male": 0.0137,
}
_CITED = {
    "winter": "Winter 2009",
    "de-leva-female": "de Leva 1996, women",
    "de-leva-male": "de Leva 1996, men",
}
#: Bodies of another mass [kg] are a slip: grams, pounds of a giant, a missing digit.
_LIGHTEST, _HEAVIEST = 5.0, 400.0
#: So are footplates heavier than this [kg].
_PLATE = 20.0
#: Between these lies the mass of any foot and plate [kg].
MASSES = (0.0, max(FOOT_SHARE.values()) * _HEAVIEST + _PLATE)


def foot_mass(body_mass: float, footplate: float = 0.0, *, table: str = "winter") -> float:
    """Parameter m [kg]: the mass of one foot and of the footplate it is strapped to.

    Parameters
    ----------
    body_mass : float
        Of the whole body [kg].
    footplate : float
        Mass that moves with the foot [kg]: plate, strap, shoe. The model has all mass at la =
        0.15 m from the ankle (6); a plate whose centre is elsewhere counts by its inertia, as
        I/la².
    table : {"winter", "de-leva-female", "de-leva-male"}
        Where the foot's share comes from: 1.45, 1.29 and 1.37 %.

    Returns
    -------
    float
        The mass m [kg].

    Raises
    ------
    InputError
        A mass is no body's or no footplate's, or the table is unknown.
    """
    if table not in FOOT_SHARE:
        raise InputError(f"unknown table {table!r}; known tables: {', '.join(FOOT_SHARE)}")
    if not _LIGHTEST <= body_mass <= _HEAVIEST:
        raise InputError(
            f"body mass {body_mass:g} kg; give the mass of the whole body, {_LIGHTEST:g} to "
            f"{_HEAVIEST:g} kg"
        )
    if not 0 <= footplate <= _PLATE:
        raise InputError(f"footplate mass {footplate:g} kg; give 0 to {_PLATE:g} kg")
    return FOOT_SHARE[table] * body_mass + footplate


def with_foot_mass(
    inputs: Sequence[ModelInputs],
    body_mass: float,
    footplate: float = 0.0,
    *,
    table: str = "winter",
) -> tuple[ModelInputs, ...]:
    """Recordings that prescribe m, and say in their steps where it comes from; see `foot_mass`."""
    m = foot_mass(body_mass, footplate, table=table)
    for recording in inputs:
        if "m" in recording.fixed:
            raise InputError(
                f"{recording.where}: prescribes m = {recording.fixed['m']:g} kg itself; leave the "
                "body mass out"
            )
    step = (
        f"Mass m fixed at {m:.4g} kg: {100 * FOOT_SHARE[table]:.3g} % of {body_mass:g} kg body "
        f"mass ({_CITED[table]})" + (f" and {footplate:g} kg footplate." if footplate else ".")
    )
    return tuple(
        replace(recording, fixed={**recording.fixed, "m": m}, steps=(*recording.steps, step))
        for recording in inputs
    )
