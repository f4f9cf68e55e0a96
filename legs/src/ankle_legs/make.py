"""Families and seeds to legs, and legs to files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ankle_legs import __version__, last, look
from ankle_legs.leg import Leg, generator
from ankle_legs.muscle import Array
from ankle_legs.subject import draw

FAMILIES = {**look.FAMILIES, **last.FAMILIES}


def leg(family: str, seed: int) -> Leg:
    """Return the leg of a family and a seed; every third is a patient's."""
    if family not in FAMILIES:
        raise ValueError(f"no family {family!r}; there are {', '.join(FAMILIES)}")
    if seed < 0:
        raise ValueError(f"seed {seed} is negative; give 0 or more")
    rng = generator(family, seed, 0)
    plain = family == "p"
    rigid = plain and bool(rng.random() < 0.5)
    population = "patient" if rng.random() < 1 / 3 else "healthy"
    subject = draw(rng, population, tendons=not rigid)
    return Leg(family, seed, subject, FAMILIES[family](rng, 1.0), not plain, rigid)


@lru_cache(maxsize=4096)
def truth_of(family: str, seed: int, trial: int) -> dict[str, Any]:
    """Return the truth of one trial of a leg, which needs no file."""
    if trial < 1:
        raise ValueError(f"there is no trial {trial}; the first is 1")
    one = leg(family, seed)
    return one.truth(*one.condition(trial))


def write_csv(path: Path, columns: dict[str, Array]) -> None:
    """Write one recording."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8") as file:
        file.write("# emg: envelope\n")
        np.savetxt(
            file,
            np.column_stack(list(columns.values())),
            fmt="%.8g",
            delimiter=",",
            header=",".join(columns),
            comments="",
        )


def make(
    family: str,
    seed: int,
    output: Path,
    trials: Sequence[int] = (1,),
    seconds: float = 35.0,
    kind: str = "active",
) -> dict[str, Any]:
    """Write a leg's trials to ``output/FAMILY-SEED`` and its truth to ``output/truth``."""
    one = leg(family, seed)
    name = f"{family}-{seed}"
    if not seconds >= 20:
        raise ValueError(f"{seconds:g} s are too short a trial; give 20 or more")
    truths = []
    for trial in trials:
        columns = one.record(*one.condition(trial), trial, seconds, kind)
        path = output / name / f"trial-{trial}.csv"
        write_csv(path, columns)
        truths.append(
            {"trial": trial, "file": f"{name}/{path.name}", **truth_of(family, seed, trial)}
        )
    truth = {
        "ankle_legs": __version__,
        "family": family,
        "seed": seed,
        "population": one.subject.population,
        "trials": truths,
    }
    path = output / "truth" / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth
