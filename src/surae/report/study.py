"""The table of a study as curves against one of its factors, plain data for a figure."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.studies.store import StudyValue
from surae.studies.study import Value
from surae.units import FloatArray

StudyRow = Mapping[str, StudyValue]
#: What numbers but measures nothing: never chosen as an axis by itself.
_LABELS = ("subject", "repeat", "seed")
#: Goodness that has curves of its own, and between which numbers it lies.
_RANGES = {"ipde": (0.0, math.inf), "vaf": (-math.inf, 100.0)}


@dataclass(frozen=True, slots=True)
class Curve:
    """Means at values of the factor, and from where to where they spread; NaN where none is."""

    label: str  #: Parameter or protocol.
    #: `mean`, `low`, `high`: over the other factors; low and high are one standard deviation away,
    #: shape (n,).
    mean: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True, slots=True)
class ModelCurves:
    """What became of one model: standard errors by parameter, goodness by protocol."""

    model: str
    sem: tuple[Curve, ...]
    ipde: tuple[Curve, ...]
    vaf: tuple[Curve, ...]


@dataclass(frozen=True, slots=True)
class StudyCurves:
    """A study against one factor."""

    x: str  #: The factor.
    values: tuple[Value, ...]  #: Its values, in order: numbers, or texts where it has no numbers.
    models: tuple[ModelCurves, ...]  #: One for each model.
    notes: tuple[str, ...]  #: What is left out and what the numbers are, in sentences.

    @property
    def numeric(self) -> bool:
        """Whether the factor is a number."""
        return not any(isinstance(value, str) for value in self.values)


def study_curves(
    rows: Iterable[StudyRow], factors: Sequence[str], x: str | None = None
) -> StudyCurves:
    """Means of a study's table against one factor.

    Parameters
    ----------
    rows : iterable of mapping
        Of the table, by column; see `surae.studies.store`.
    factors : sequence of str
        Names of the factors.
    x : str, optional
        The factor; by default the numeric one of most values, or the protocol where none varies.

    Raises
    ------
    InputError
        There is no row with a fit, or `x` is no factor that varies.
    """
    everything = list(rows)
    fits = [row for row in everything if row["status"] != "failed" and row["vaf"] is not None]
    if not fits:
        raise InputError(
            f"there is nothing to draw: {len(everything):,} rows are done and none has a fit"
        )
    varying = {
        name: values
        for name in factors
        if len(values := _ordered(row[name] for row in fits if row[name] is not None)) > 1
    }
    x = _factor(varying, x)
    failed, unmoved = len(everything) - len(fits), 0
    if x in ("chirp_rate", "chirp_factor") and any(row["chirp_amplitude"] for row in fits):
        moved = [row for row in fits if row["chirp_amplitude"]]
        fits, unmoved = moved, len(fits) - len(moved)
    values = _ordered(row[x] for row in fits)
    models = _ordered(row["model"] for row in fits)
    alone = x == "protocol"
    same = "the model's fits" if alone else "the fits of its model and protocol"
    notes = [
        f"{len(fits):,} rows; means over what else varies, ± 1 standard deviation.",
        f"SEM of each parameter relative to its mean over {same}.",
    ]
    if failed:
        notes.append(f"Rows of failed fits, left out: {failed:,}.")
    if unmoved:
        notes.append(f"Rows without chirp, left out: {unmoved:,}.")
    curves = tuple(
        _model_curves(str(model), [row for row in fits if row["model"] == model], x, values)
        for model in models
    )
    return StudyCurves(x, values, curves, tuple(notes))


def _factor(varying: Mapping[str, tuple[Value, ...]], wanted: str | None) -> str:
    """The factor asked for, or the one that varies most."""
    if wanted is None:
        numeric = {
            name: len(values)
            for name, values in varying.items()
            if name not in _LABELS and not any(isinstance(value, str) for value in values)
        }
        return max(numeric, key=lambda name: numeric[name]) if numeric else "protocol"
    if wanted != "protocol" and wanted not in varying:
        known = ", ".join(dict.fromkeys([*varying, "protocol"]))
        raise InputError(f"{wanted!r} is no factor that varies in this study; use one of: {known}")
    return wanted


def _ordered(cells: Iterable[StudyValue]) -> tuple[Value, ...]:
    """The values there are: numbers by size, texts as they come."""
    cells_given = [cell for cell in dict.fromkeys(cells) if cell is not None]
    if any(isinstance(cell, str) for cell in cells_given):
        return tuple(cells_given)
    return tuple(sorted(cells_given, key=float))


def _model_curves(
    model: str, rows: Sequence[StudyRow], x: str, values: tuple[Value, ...]
) -> ModelCurves:
    """The curves of one model's rows."""
    protocols = _ordered(row["protocol"] for row in rows)
    if x == "protocol":
        groups = {"": rows}
    else:
        groups = {str(p): [row for row in rows if row["protocol"] == p] for p in protocols}
    goodness = {
        column: tuple(
            _curve(label, [(row[x], row[column]) for row in group], values, _RANGES[column])
            for label, group in groups.items()
        )
        for column in _RANGES
    }
    names = [name.removesuffix("_sem") for name in rows[0] if name.endswith("_sem")]
    sem = []
    for name in names:
        relative = [
            pair for group in groups.values() for pair in _relative(group, x, f"{name}_sem")
        ]
        if relative:
            sem.append(_curve(name, relative, values, (0.0, math.inf)))
    return ModelCurves(model, tuple(sem), goodness["ipde"], goodness["vaf"])


def _relative(rows: Iterable[StudyRow], x: str, column: str) -> list[tuple[StudyValue, StudyValue]]:
    """A column over its mean, by the factor; nothing where it has no number."""
    pairs = [(row[x], number) for row in rows if (number := _number(row[column])) is not None]
    mean = float(np.mean([number for _, number in pairs])) if pairs else 0.0
    return [(value, number / mean) for value, number in pairs] if mean > 0.0 else []


def _curve(
    label: str,
    pairs: Iterable[tuple[StudyValue, StudyValue]],
    values: tuple[Value, ...],
    within: tuple[float, float],
) -> Curve:
    by_value: dict[StudyValue, list[float]] = {value: [] for value in values}
    for value, cell in pairs:
        if (number := _number(cell)) is not None:
            by_value[value].append(number)
    mean = np.array([np.mean(numbers) if numbers else np.nan for numbers in by_value.values()])
    spread = np.array(
        [np.std(numbers, ddof=1) if len(numbers) > 1 else 0.0 for numbers in by_value.values()]
    )
    low, high = np.maximum(mean - spread, within[0]), np.minimum(mean + spread, within[1])
    return Curve(label, mean, low, high)


def _number(cell: StudyValue) -> float | None:
    """A cell's finite number, if it has one."""
    return float(cell) if isinstance(cell, int | float) and math.isfinite(cell) else None
