"""Families and seeds to legs, and legs to files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from ankle_legs import __version__, last, last_relaxed, look, paths, perturbed, relaxed, stretched
from ankle_legs.leg import FILM_RATE, FILM_START, Leg, generator
from ankle_legs.muscle import Array
from ankle_legs.subject import GROUPS, Geometry, draw

FAMILIES = {**look.FAMILIES, **last.FAMILIES}
RELAXED = {**relaxed.FAMILIES, **last_relaxed.RELAXED}
PATHS = {**paths.FAMILIES, **last_relaxed.PATHS}


def leg(family: str, seed: int) -> Leg:
    """Return the leg of a family and a seed; every third is a patient's."""
    if family not in {*FAMILIES, *RELAXED, *PATHS}:
        others = (*FAMILIES, *RELAXED, *PATHS, *perturbed.families(), *stretched.families())
        raise ValueError(f"no family {family!r}; there are {', '.join(others)}")
    if seed < 0:
        raise ValueError(f"seed {seed} is negative; give 0 or more")
    rng = generator(family, seed, 0)
    if family in RELAXED:
        kinds = relaxed.FAST if family in relaxed.STRETCHED else relaxed.KINDS
        return relaxed.leg(family, seed, RELAXED[family], kinds, rng)
    if family in PATHS:
        return paths.leg(family, seed, PATHS[family], rng)
    plain = family == "p"
    rigid = plain and bool(rng.random() < 0.5)
    population = "patient" if rng.random() < 1 / 3 else "healthy"
    subject = draw(rng, population, tendons=not rigid)
    return Leg(family, seed, subject, FAMILIES[family](rng, 1.0), not plain, rigid)


@lru_cache(maxsize=4096)
def truth_of(
    family: str,
    seed: int,
    trial: int,
    kinds: tuple[str, ...] = (),
    seconds: float | None = None,
) -> dict[str, Any]:
    """Return the truth of one trial of a leg, which needs no file.

    Of several kinds: of the visit of so many trials that begins with it, as one. Without a kind or
    seconds they are what is usual for the trial.
    """
    if trial < 1:
        raise ValueError(f"there is no trial {trial}; the first is 1")
    one = leg(family, seed)
    kinds = kinds or (one.usual(trial)[0],)
    each = [one.usual(trial + i)[1] if seconds is None else seconds for i in range(len(kinds))]
    moves = [(trial + i, length) for i, length in enumerate(each)]
    return one.truth(*one.condition(trial), trial, kinds, moves=moves)


def write_csv(path: Path, columns: dict[str, Array], comment: str = "") -> None:
    """Write columns, after lines of comment."""
    path.parent.mkdir(parents=True, exist_ok=True)
    table, header = np.column_stack(list(columns.values())), comment + ",".join(columns)
    np.savetxt(path, table, "%.8g", ",", header=header, comments="", encoding="utf-8")


def _mapping(name: str, columns: Sequence[str], film: Sequence[str], emg: str) -> str:
    """Return a description of a recording and its film, which has a clock of its own."""
    lines = [f'name = "{name}"', f'emg = "{emg}"']
    clock = f"start_s = {FILM_START}\nrate_hz = {FILM_RATE:.9g}\n"
    for column, file, timing in [
        *((c, "", "") for c in columns[1:]),
        *((c, "film/", clock) for c in film[1:]),
    ]:
        channel, unit = column.rsplit("_", 1)
        where = f'file = "{file}{name}.csv"\ncolumn = "{column}"\nunit = "{unit}"\n{timing}'
        lines.append(f"[channels.{channel}]\n{where}")
    return "\n".join(lines) + "\n"


def write_geometry(path: Path, geometry: Geometry) -> None:
    """Write moment arms, and lengths less the tendons' slack, whose slopes they are not."""
    degrees = np.arange(-60.0, 46.0, 5.0)
    angle = np.radians(degrees)
    lengths, arms = 1000 * geometry.path(angle), 1000 * geometry.arm(angle)
    columns = {"angle_deg": degrees}
    for i, group in enumerate(GROUPS):
        columns |= {f"length_{group}_mm": lengths[i], f"arm_{group}_mm": arms[i]}
    notes = ("tolerance_mm = 80", *(f"slack_{group}_mm = 0" for group in GROUPS))
    write_csv(path, columns, "".join(f"# {note}\n" for note in notes))


class Choices(TypedDict, total=False):
    """See `Asked`."""

    seconds: float | None
    kind: str | None
    raw: bool
    film: bool
    geometry: bool


@dataclass(frozen=True)
class Asked:
    """What a leg's trials are to be."""

    seconds: float | None = None  #: Of each; what is usual for the trial, if None.
    kind: str | None = None  #: What the leg does; what is usual, if None.
    raw: bool = False  #: Whether EMG is raw, and no envelope.
    film: bool = False  #: Whether fascicles are filmed.
    geometry: bool = False  #: Whether moment arms and lengths are written.


def make(
    family: str,
    seed: int,
    output: Path,
    trials: Sequence[int] = (1,),
    **choices: Unpack[Choices],
) -> list[Path]:
    """Write a leg's trials to ``output/FAMILY-SEED`` and its truth to ``output/truth``.

    Perturbed and stretched legs have one trial each, and no other choices.
    """
    asked = Asked(**choices)
    if family in perturbed.families():
        return _make_perturbed(family, seed, output)
    if family in stretched.families():
        return _make_stretched(family, seed, output)
    if not trials:
        raise ValueError("no trial is asked for; give 1 or more")
    if asked.seconds is not None and not asked.seconds >= 20:
        raise ValueError(f"{asked.seconds:g} s are too short a trial; give 20 or more")
    one, folder = leg(family, seed), f"{family}-{seed}"
    emg = "raw" if asked.raw else "envelope"
    truths, paths = [], []
    if asked.geometry:
        geometry = one.lasting(one.subject).geometry
        write_geometry(output / folder / "geometry" / "geometry.csv", geometry)
    for trial in trials:
        usual, length = one.usual(trial)
        kind, seconds = asked.kind or usual, asked.seconds or length
        truths.append({"trial": trial, **truth_of(family, seed, trial, (kind,), seconds)})
        run, name = one.record(trial, seconds, kind), f"trial-{trial}"
        columns = one.columns(run, trial, raw=asked.raw)
        paths.append(output / folder / f"{name}.csv")
        write_csv(paths[-1], columns, f"# emg: {emg}\n")
        if asked.film:
            filmed = one.film(run, trial)
            write_csv(output / folder / "film" / f"{name}.csv", filmed)
            paths[-1] = output / folder / f"{name}.toml"
            paths[-1].write_text(_mapping(name, [*columns], [*filmed], emg), encoding="utf-8")
    truth = {
        "ankle_legs": __version__,
        "family": family,
        "seed": seed,
        "population": one.subject.population,
        "fascicles": one.seen_fascicles(),
        "trials": truths,
    }
    write_truth(output, folder, truth)
    return paths


def write_truth(output: Path, folder: str, truth: dict[str, Any]) -> None:
    """Write a leg's truth beside its recordings' folder."""
    path = output / "truth" / f"{folder}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


def _make_perturbed(family: str, seed: int, output: Path) -> list[Path]:
    """Write a record under small perturbations, and one of the empty device."""
    made, folder = perturbed.record(family, seed), f"{family}-{seed}"
    path = output / folder / "perturbed.csv"
    write_csv(path, made.columns)
    write_csv(path.with_name("empty.csv"), made.empty)
    write_truth(output, folder, {"family": family, "seed": seed, **made.truth})
    return [path]


def _make_stretched(family: str, seed: int, output: Path) -> list[Path]:
    """Write a leg's slow and fast stretches, in one file or in two."""
    (recordings, truth), folder = stretched.record(family, seed), f"{family}-{seed}"
    paths = [output / folder / f"{one.name}.csv" for one in recordings]
    for path, one in zip(paths, recordings, strict=True):
        write_csv(path, one.columns, "" if one.emg == "none" else f"# emg: {one.emg}\n")
    write_truth(output, folder, {"family": family, "seed": seed, **truth})
    return paths
