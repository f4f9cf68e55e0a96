"""The rows of a cohort: read from a table, their fits measured, and fitted again with a population.

Empirical Bayes: the population's distribution is learned from the fits (REML on logarithms), every
leg is fitted again with it as a prior, and so on until it rests. What a leg's recordings tell well
stays; what they tell badly borrows from the other legs.
"""

import csv
import io
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from surae.base.errors import InputError, SuraeError
from surae.base.files import PathLike, read_bytes, shown
from surae.base.frozen import FrozenDict
from surae.base.progress import Progress
from surae.base.records import from_plain, to_plain
from surae.base.units import FloatArray
from surae.cohorts.effects import FEWEST, random_effects
from surae.cohorts.member import CohortMember, sessions_of
from surae.inference import AssessedFit, make_problem, solve
from surae.inference.judging.assessment import assess
from surae.inference.saved.fit_json import load_saved
from surae.measures.compared import Quantities, quantities
from surae.processes.runner import Died, Engine, results
from surae.settings import FitSettings
from surae.trials.folder import fit_in, require_own

_LABELS = ("subject", "side", "group", "session")
#: Rounds of a refit, at most; it ends where no median moves by more than this part of its spread.
_ROUNDS = 3
_RESTS = 0.1
#: Least spread of a prior, and legs from which a group is a population of its own.
_NARROWEST = 0.02
_POPULATION = 5

PriorTable = dict[str, tuple[float, float]]


def read_table(path: PathLike) -> list[tuple[Path, CohortMember]]:
    """The rows of a COHORT.csv with the paths of their fits, which are not read yet.

    Columns ``fit`` and ``subject``, further ``side``, ``group`` and ``session``; every other one is
    a clinical scale, a number or empty.
    """
    try:
        text = read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{shown(path)}: not a text file, expected a table") from None
    first = text.partition("\n")[0]
    european = ";" in first and "," not in first  # as spreadsheets write it where 1,5 is a number
    table = csv.DictReader(
        io.StringIO(text, newline=""), delimiter=";" if european else ",", restkey="", restval=""
    )
    heads = list(table.fieldnames or ())
    rows = list(table)
    if twice := [head for head in heads if heads.count(head) > 1]:
        raise InputError(f"{shown(path)}: two columns are called {twice[0]!r}; rename one")
    for needed in ("fit", "subject"):
        if needed not in heads:
            raise InputError(f"{shown(path)}: no column {needed!r}; give fit and subject")
    folder = Path(path).parent
    members = []
    for line, row in enumerate(rows, 2):
        if row.get("") and "" not in heads:
            raise InputError(f"{shown(path)}, row {line}: more cells than columns")
        scales = {}
        for head in heads:
            cell = (row[head] or "").strip()
            if head in ("fit", *_LABELS) or not cell:
                continue
            scale = _number(cell.replace(",", ".") if european else cell)
            if scale is None:
                where = f"{shown(path)}, row {line}, column {head}"
                raise InputError(f"{where}: {cell!r:.40} is not a number; write 1+ as 1.5")
            scales[head] = scale
        subject, side, group, session = ((row.get(name) or "").strip() for name in _LABELS)
        if not (row["fit"] or "").strip() or not subject:
            raise InputError(f"{shown(path)}, row {line}: fit or subject is empty")
        member = CohortMember(subject, side, group, session, FrozenDict(scales), None)
        members.append((folder / row["fit"].strip(), member))
    if not members:
        raise InputError(f"{shown(path)}: no rows")
    return members


def _number(text: str) -> float | None:
    """A finite number; None where a text is none."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def measured(
    rows: Sequence[tuple[Path, CohortMember]],
    angles: Sequence[float],
    engine: Engine,
    priors: Mapping[str, PriorTable] | None = None,
    progress: Progress | None = None,
    end: float = math.inf,
) -> list[CohortMember]:
    """The rows with what their fits bring; with priors by group, of fits made anew with them.

    Measures of the range are of that up to `end` [deg], without it of each leg's own.
    """
    calls = {
        str(i): {
            "path": str(path),
            "angles": list(angles),
            "end": end if math.isfinite(end) else None,
            "priors": None if priors is None else priors.get(member.group, priors.get("", {})),
        }
        for i, (path, member) in enumerate(rows)
    }
    name = f"{__name__}:{quantities_of.__name__}"
    done: dict[str, Any] = {}
    work = quantities_of if engine.kind == "threads" else name
    with closing(results(work, calls, engine)) as batches:
        for batch in batches:
            done |= batch
            if progress is not None:
                progress(len(done), len(calls))
    members = []
    for i, (_, member) in enumerate(rows):
        outcome = done[str(i)]
        if isinstance(outcome, Died):
            outcome = {"error": outcome.message}
        if "error" in outcome:
            members.append(replace(member, missing=str(outcome["error"])))
        else:
            members.append(replace(member, quantities=from_plain(Quantities, outcome)))
    return members


def quantities_of(
    *,
    path: str,
    angles: list[float],
    priors: dict[str, list[float]] | None,
    end: float | None = None,
) -> dict[str, Any]:
    """What one fit brings, as plain data; the reason where there is none.

    `path` is a FIT.json's, or the folder's of a session; `angles` [deg] are where measures are
    evaluated; `priors`, median and spread by parameter, are to fit the recordings again with.
    """
    place = Path(path)
    try:
        fit = load_saved(fit_in(place) if place.is_dir() else place)
        if place.is_dir():
            require_own(place, fit.result.problem.inputs)
        if priors is not None:
            known = {
                name: (float(pair[0]), float(pair[1]))
                for name, pair in priors.items()
                if name in fit.result.problem.free
            }
            problem = fit.result.problem
            settings = FitSettings.of(problem.settings, priors={**problem.settings.priors, **known})
            result = solve(make_problem(problem.inputs, settings))
            fit = AssessedFit(result, assess(result, alternatives=True))
        brought = quantities(fit, angles, math.inf if end is None else end)
    except SuraeError as error:
        return {"error": str(error)}
    return dict(to_plain(brought))


def populations(
    members: Sequence[CohortMember], known: Mapping[str, PriorTable] | None = None
) -> dict[str, PriorTable]:
    """Median and spread of every positive parameter of the leg, by group; of all under ``""``.

    Of fits that knew a population it is the step of expectation and maximisation.
    """
    named = Counter(each[0].group for each in sessions_of(members).values())
    groups = known or ["", *(g for g, legs in named.items() if g and legs >= _POPULATION)]
    priors: dict[str, PriorTable] = {}
    for group in groups:
        priors[group] = dict(known[group]) if known else {}
        for name, (values, sds) in _positive(members, group).items():
            y = np.log(values)
            sd = sds / values
            if known is None:
                effects = random_effects(y, sd**2)
                mean = effects.mean
                spread = math.sqrt(effects.tau2 + effects.se**2)
            elif name in known[group]:
                mean = float(y.mean())
                spread = math.sqrt(float(np.var(y) + (sd**2).mean()))
            else:
                continue
            priors[group][name] = (math.exp(mean), max(spread, _NARROWEST))
    return priors


def _positive(
    members: Sequence[CohortMember], group: str
) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Values and standard deviations of parameters that enough legs of a group have, above zero.

    Of a leg with several sessions the first counts: it is no leg more.
    """
    values: dict[str, list[tuple[float, float]]] = {}
    for first, *_ in sessions_of(members).values():
        if first.quantities is None or group not in ("", first.group):
            continue
        for q in first.quantities.by_name.values():
            usable = q.kind == "parameter" and not q.missing and q.value and q.value > 0.0
            if usable and q.value and 0.0 < q.total < math.inf:
                values.setdefault(q.name, []).append((q.value, q.total))
    many = {name: np.array(pairs) for name, pairs in values.items() if len(pairs) >= FEWEST}
    return {name: (pairs[:, 0], pairs[:, 1]) for name, pairs in many.items()}


def refitted(
    rows: Sequence[tuple[Path, CohortMember]],
    members: Sequence[CohortMember],
    angles: Sequence[float],
    engine: Engine,
    progress: Progress | None = None,
    end: float = math.inf,
) -> tuple[list[CohortMember], int]:
    """Every leg fitted again with its population, until that rests; and the rounds it took."""
    known = populations(members)
    latest = list(members)
    for number in range(1, _ROUNDS + 1):
        latest = measured(rows, angles, engine, known, progress, end)
        renewed = populations(latest, known)
        moved = [
            abs(math.log(renewed[g][n][0] / median)) / spread
            for g, priors in known.items()
            for n, (median, spread) in priors.items()
        ]
        known = renewed
        if max(moved, default=0.0) < _RESTS:
            return latest, number
    return latest, _ROUNDS
