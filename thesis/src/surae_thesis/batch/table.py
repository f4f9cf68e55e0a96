"""The file that keeps every outcome of a batch at once, its run, and its tables."""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from surae import FitSettings
from surae.base.errors import InputError
from surae.processes.ledger import Ledger
from surae.processes.runner import Died, Engine, results
from surae.studies import fingerprint
from surae_thesis.batch.files import content_of
from surae_thesis.batch.plan import Batch, Calls, text_of
from surae_thesis.batch.work import Plain
from surae_thesis.cohort.work import MODELS
from surae_thesis.section import Cell

_WORK = "surae_thesis.batch.work"


class BatchStore(Ledger):
    """A batch's file, open; see `surae.processes.ledger.Ledger`."""

    _NOTHING = "no batch yet"

    def _reason(self, value: Any) -> str | None:
        return None if value.get("failed") is None else str(value["failed"])

    def outcomes(self) -> Iterator[tuple[Plain, Plain]]:
        """Label and outcome of all that is there; of a call whose worker died, why it failed."""
        for label, value in self.results():
            yield label, {"failed": value.message} if isinstance(value, Died) else value


def settings_of(
    models: Sequence[str], fixed: Sequence[str], options: Mapping[str, Any]
) -> dict[tuple[str, str], FitSettings]:
    """The settings of every fit of a recording: models, by name or the thesis's number, and sets.

    Raises
    ------
    InputError
        A model or parameter is not known, or a set is not as ``beta=1,m=2``.
    """
    made = {}
    for model in models:
        for words in ("", *fixed):
            held = dict(options.get("fixed", {}))
            for entry in filter(None, words.split(",")):
                name, _, value = entry.partition("=")
                try:
                    held[name.strip()] = float(value)
                except ValueError:
                    raise InputError(f"--fixed-set {words!r}: write it as beta=1,m=2") from None
            given = {**options, **({"fixed": held} if held else {})}
            made[model, words] = FitSettings.of(MODELS.get(model, model), **given)
    return made


def run_batch(
    batch: Batch,
    store: BatchStore,
    engine: Engine,
    progress: Callable[[int, int], None] | None = None,
) -> int:
    """Compute what a store lacks of a batch; how many calls were made now.

    Raises
    ------
    InputError, ComputationError
        A file, the store or the engine cannot be used; what is finished is kept.
    """
    mapping = batch.read["mapping"]
    program = fingerprint()
    content = {t.path: content_of(t.path, mapping) for t in batch.trials}
    labels = []
    for label in batch.labels():
        text = text_of(batch, label, content, program)
        labels.append((hashlib.sha256(text.encode()).hexdigest(), label))
    done = store.begin("batch", "batch", "", labels)
    rest = Calls(batch, {key: label for key, label in labels if key not in done})
    return store.keep(results(f"{_WORK}:call", rest, engine), progress)


#: Columns of the table of fits before the parameters'.
_ABOUT = ("subject", "protocol", "repetition", "model", "fixed")
_FIT = ("status", "grade", "vaf", "r2", "ipde", "validation_vaf")
#: What there is of a parameter and of a measure, after their names.
_PARAMETER = ("", "_sem", "_low", "_high", "_verdict")
_MEASURE = ("", "_low", "_high", "_verdict")
#: Columns of the relaxed curves.
RELAXED = (
    "subject",
    "protocol",
    "repetition",
    "angle_deg",
    "torque_Nm",
    "torque_sd_Nm",
    "stiffness_Nm_per_deg",
    "stiffness_sd_Nm_per_deg",
)
Outcome = tuple[Plain, Plain]
_FITS = ("fit", "session")


def table(outcomes: Sequence[Outcome]) -> tuple[tuple[str, ...], list[tuple[Cell, ...]]]:
    """A row for each fit, and the columns; see `fit_rows`."""
    columns = fit_columns(outcomes)
    return columns, list(fit_rows(outcomes, columns))


def fit_columns(outcomes: Iterable[Outcome]) -> tuple[str, ...]:
    """Columns of the table of fits: those of every parameter and measure that one of them has."""
    names: dict[str, None] = {}
    measured: dict[str, None] = {}
    for label, fit in outcomes:
        if label["kind"] in _FITS:
            names |= dict.fromkeys(fit.get("parameters", {}))
            measured |= dict.fromkeys(fit.get("measures", {}))
    parameters = [n + end for n in names for end in _PARAMETER]
    measures = [n + end for n in measured for end in _MEASURE]
    return (*_ABOUT, *_FIT, *parameters, *measures, "file", "message", "seconds")


def fit_rows(outcomes: Iterable[Outcome], columns: Sequence[str]) -> Iterator[tuple[Cell, ...]]:
    """A row for each fit: whose it is, how good, parameters with standard errors, measures.

    ``validation_vaf`` is the mean VAF [%] of the other repetitions of the protocol.
    """
    for label, fit in outcomes:
        if label["kind"] not in _FITS:
            continue
        values: dict[str, Cell] = {c: fit.get(c) for c in (*_FIT, "seconds", "file")}
        values |= {c: label[c] for c in _ABOUT}
        repeated = [vaf for _, vaf in predictions(label, fit, label["protocol"])]
        values["validation_vaf"] = sum(repeated) / len(repeated) if repeated else None
        values["status"] = fit.get("status", "failed")
        values["message"] = fit.get("failed")
        for name, p in fit.get("parameters", {}).items():
            low, high = p["ci95"] or (None, None)
            cells = (p["value"], p["sem"], low, high, p["verdict"])
            values |= dict(zip((name + end for end in _PARAMETER), cells, strict=True))
        for name, m in fit.get("measures", {}).items():
            values |= dict(zip((name + end for end in _MEASURE), m, strict=True))
        yield tuple(values.get(column) for column in columns)


def relaxed_rows(outcomes: Iterable[Outcome]) -> Iterator[tuple[Cell, ...]]:
    """The relaxed curve of every recording that has one, a row for each angle (`RELAXED`)."""
    for label, seen in outcomes:
        if label["kind"] == "trial":
            about = (label["subject"], label["protocol"], label["repetition"])
            yield from ((*about, *row) for row in seen.get("relaxed", ()))


def predictions(label: Plain, fit: Plain, protocol: str) -> Iterator[tuple[int, float]]:
    """Repetition and VAF [%] of the subject's recordings of a protocol that a fit predicts."""
    for name, vaf in fit.get("predicted", {}).items():
        of, repetition = name[len(label["subject"]) + 1 :].rsplit(" ", 1)
        if of == protocol and vaf is not None:
            yield int(repetition), vaf
