"""Priors of a fit that what is known of leg and device gives."""

import math

from surae.model.knowledge import TRAVEL_SD, Knowledge

#: How well a leg's own lengths are known where its arms are told twice [m]; assumed.
_LENGTH = 0.0025
#: What a plate that was tared elsewhere leaves: inertia [kg·m²] and weight [Nm], a tenth of what an
#: untared one has; assumed.
_TARED = (0.003, 0.5)
#: What no tare of the plate tells: the foot's own weight, 1 Nm where it is level, at sin θ where a
#: seat is reclined by some 30° [Nm]; assumed.
_SEAT = 0.5


def groups_of(known: Knowledge) -> frozenset[str]:
    """Groups of nuisances of which something is known: these are in every fit."""
    stated = {
        "axis": known.axis_mm,
        "plate": known.plate,
        "crosstalk": known.crosstalk,
        "arm": known.size or "arms" in known.statements,
    }
    return frozenset(group for group, each in stated.items() if each)


def priors_of(known: Knowledge) -> dict[str, tuple[float, float]]:
    """Priors, mean and standard deviation, by parameter, in SI units."""
    from surae.model.parameters import OPTIONAL  # NumPy, which help does without

    priors = dict[str, tuple[float, float]]()
    made = known.statements
    if "axis" in made:
        ways = zip(OPTIONAL["axis"], made["axis"].numbers.values(), strict=True)
        priors |= {name: (value / 1e3, sd / 1e3) for name, (value, sd) in ways}
    if known.plate is not None:
        inertia, weight = known.plate.remaining_sd if known.plate.file else _TARED
        sizes = (inertia, weight, max(weight, _SEAT))
        priors |= {n: (0.0, sd) for n, sd in zip(OPTIONAL["plate"], sizes, strict=True)}
    priors |= {name: (stated.value, stated.sd) for name, stated in known.crosstalk.items()}
    if known.size:
        sds = {"arm_scale": known.size_sd, "path_scale": TRAVEL_SD}
        scales = [n for n in OPTIONAL["arm"] if n.startswith(tuple(sds))]
        priors |= {name: (math.log(known.size), sds[name[:-4]] / 100.0) for name in scales}
    if "arms" in made:
        priors |= _of_arms(known)
        if known.geometry and made["arms"].agrees:
            priors |= dict.fromkeys(OPTIONAL["length_zero"], (0.0, _LENGTH))
    return priors


def _of_arms(known: Knowledge) -> dict[str, tuple[float, float]]:
    """Priors of what arms and paths are over those of the geometry in use."""
    priors = dict[str, tuple[float, float]]()
    usual = known.usual
    arms = known.statements["arms"]
    for group, (arm, sd) in arms.numbers.items():
        scale = math.log(arm / usual[group]), sd / arm
        priors[f"arm_scale_{group}"] = scale
        if known.geometry_sd_percent is not None and not known.size:
            far = scale[0], TRAVEL_SD / 100.0  # whose it is is not known either
            priors[f"path_scale_{group}"] = far if arms.agrees is False else scale
    return priors
