"""The fits that the simulation section asks for, the grid of the thesis first."""

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

from surae_thesis.claims import INTEGRATOR
from surae_thesis.legs import EARLY, IN_TURN, LEAD, SLOW, STRAIN, fit_cell
from surae_thesis.section import Context
from surae_thesis.simulation import cells as c
from surae_thesis.simulation.cells import Study, cells, select, with_magnitude

#: Virtual subjects on whom the grid's conclusions are tried again.
SUBJECTS = 10
_QUICK_SUBJECTS = 3
_QUICK_FACTORS = (0.05, 0.2, 0.35, 0.5, 0.6)
#: Factors of the other reading of ε0 away from the chosen amplitude and task.
_STRAIN_FACTORS = c.FACTORS[2::4]

Place = dict[str, Any]


def place(model: str, profile: str, amplitude: float, factor: float | None, **others: Any) -> Place:
    """Where a fit is: `fit_cell`'s keywords but for the seed."""
    return {
        "model": model,
        "profile": profile,
        "task": "part-passive",
        "amplitude": amplitude,
        "factor": factor if amplitude else None,
        "population": "healthy",
        "subject": 1,
        "repeat": 1,
        "explicit": False,
        "reading": "",
        **others,
    }


def _around(model: str, profiles: tuple[str, ...], factors: tuple[float, ...]) -> Iterator[Place]:
    """Cells through the chosen chirp: over amplitudes, and over factors with these profiles."""
    for profile, amplitude in product(c.PROFILES, c.AMPLITUDES):
        yield place(model, profile, amplitude, c.CHOSEN_FACTOR)
    for profile, factor in product(profiles, factors):
        if factor != c.CHOSEN_FACTOR:
            yield place(model, profile, c.CHOSEN_AMPLITUDE, factor)


def places(quick: bool) -> dict[str, list[Place]]:
    """What is fitted, by name; in the grid's order motions change slowest."""
    factors = _QUICK_FACTORS if quick else c.FACTORS
    subjects = range(1, 1 + (_QUICK_SUBJECTS if quick else SUBJECTS))
    faster = c.FASTER[1::2] if quick else c.FASTER
    chirps = [(0.0, None), *product(c.AMPLITUDES[1:], factors)]
    usual = {
        "grid": [
            place(m, p, a, s, task=t)
            for p, (a, s), t, m in product(c.PROFILES, chirps, c.TASKS, c.MODELS)
        ],
        "noise": [
            place("muscle", p, c.NOISE_AMPLITUDE, s, repeat=r)
            for p in c.PROFILES
            for s in (c.NOISE_FACTORS[::4] if quick else c.NOISE_FACTORS)
            for r in range(1, c.REPEATS + 1)
        ],
        "patients": [
            {**at, "population": "patient"}
            for m in c.MODELS
            for at in _around(m, c.CHOSEN, (*(factors if quick else c.FACTORS[::2]), *faster))
        ],
        "faster": [
            place(m, p, c.CHOSEN_AMPLITUDE, s) for p, s, m in product(c.PROFILES, faster, c.MODELS)
        ],
        "others": [
            {**at, "subject": n}
            for n in subjects
            for m in c.MODELS
            for at in [
                *(
                    place(m, p, c.CHOSEN_AMPLITUDE, c.CHOSEN_FACTOR, task=t)
                    for p, t in product(c.PROFILES, c.TASKS)
                ),
                *(
                    place(m, c.CHOSEN[0], a, c.CHOSEN_FACTOR)
                    for a in c.AMPLITUDES
                    if a != c.CHOSEN_AMPLITUDE
                ),
            ]
        ],
    }
    return {
        **usual,
        **{f"{STRAIN} {name}": _strained(some) for name, some in usual.items() if name != "noise"},
        IN_TURN: [
            place(m, p, c.CHOSEN_AMPLITUDE, c.CHOSEN_FACTOR, subject=n, reading=IN_TURN)
            for n, p, m in product(subjects, c.PROFILES, c.MODELS)
        ],
        LEAD: [
            place("muscle", p, c.CHOSEN_AMPLITUDE, c.CHOSEN_FACTOR, subject=n, reading=LEAD)
            for n, p in product(subjects, c.PROFILES)
        ],
        EARLY: [
            {
                **place(m, p, c.CHOSEN_AMPLITUDE, c.CHOSEN_FACTOR, subject=n, reading=EARLY),
                "task": "active",
            }
            for n, p, m in product(subjects[:3], c.PROFILES, c.MODELS)
        ],
        SLOW: [
            place("muscle", c.CHOSEN[0], a, c.CHOSEN_FACTOR, subject=n, reading=SLOW)
            for n, a in product(subjects, c.AMPLITUDES)
        ],
        "explicit": [
            place("muscle-tendon", p, a, c.CHOSEN_FACTOR, explicit=True)
            for p, a in product(c.CHOSEN[:1] if quick else c.PROFILES, c.AMPLITUDES)
        ],
    }


def _strained(some: list[Place]) -> list[Place]:
    """The tendon model's cells with ε0 as a strain: all through the chosen chirp, few elsewhere."""
    return [
        {**at, "reading": STRAIN}
        for at in some
        if at["model"] == "muscle-tendon"
        and at["subject"] <= _QUICK_SUBJECTS
        and (
            at["factor"] in (None, *_STRAIN_FACTORS)
            or (at["task"] == "part-passive" and at["amplitude"] == c.CHOSEN_AMPLITUDE)
        )
    ]


def studies(context: Context) -> dict[str, Study]:
    """The cells under each reading, and as the thesis integrated."""
    made = {}
    failed = {}
    for number, (name, some) in enumerate(places(context.quick).items()):
        jobs = {_label(at): {"seed": context.seed, **at} for at in some}
        fits = context.calls(f"simulation-{number}", fit_cell, jobs)
        made[name] = cells(some, [fits[_label(at)] for at in some])
        failed[name] = len(some) - len(made[name])
    usual = {name: made[name] for name in ("grid", "faster", "noise", "patients", "others")}
    # Beside the early active task stands the part-passive one as it is.
    again = {cell.subject for cell in made[EARLY]}
    beside = [cell for cell in select(made["others"], task="part-passive") if cell.subject in again]
    made[EARLY] += tuple(cell for cell in beside if cell.amplitude == c.CHOSEN_AMPLITUDE)
    strain = {
        name: select(some, model="muscle") + made.get(f"{STRAIN} {name}", ())
        for name, some in usual.items()
    }
    return {
        c.SIGNED: Study(**usual, failed=failed["grid"]),
        STRAIN: Study(**strain, failed=failed[f"{STRAIN} grid"]),
        c.MAGNITUDE: Study(
            **{name: tuple(map(with_magnitude, some)) for name, some in usual.items()},
            failed=failed["grid"],
        ),
        **{
            name: Study(grid=select(made[name], subject=1), others=made[name])
            for name in (IN_TURN, LEAD, EARLY, SLOW)
        },
        INTEGRATOR: Study(grid=made["explicit"]),
    }


def _label(at: Mapping[str, Any]) -> str:
    return " ".join(map(str, at.values()))
