"""What a batch computes, the file that keeps every outcome at once, and its table."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from surae import FitSettings
from surae.base.errors import InputError
from surae.base.records import to_plain
from surae.processes.ledger import Ledger
from surae.processes.runner import Died, Engine, results
from surae.studies import fingerprint
from surae_thesis.batch.files import NamedTrial, content_of
from surae_thesis.batch.work import Plain, Where
from surae_thesis.cohort.work import MODELS
from surae_thesis.section import Cell

#: What a batch may compute alone: how repetitions' spectra differ, without a fit; fits and the
#: simulations that their standard errors are compared with, without predictions.
ONLY = ("spectra", "snsem")
#: Virtual legs whose simulations a standard error is compared with, as many trials as there are.
LEGS = 6
_WORK = "surae_thesis.batch.work"


@dataclass(frozen=True, slots=True)
class Batch:
    """Which recordings are fitted, by what; `read` says how they are read (mapping, corrections).

    Settings are by the model's name as it was given, then by what was fixed, in words. `only` is
    one of `ONLY`, or empty.
    """

    trials: tuple[NamedTrial, ...]
    settings: Mapping[tuple[str, str], FitSettings]
    read: Mapping[str, Any]
    only: str = ""

    def where(self, trial: NamedTrial) -> Where:
        """How a recording is read."""
        return {"path": trial.path, **self.read}

    def calls(self) -> Iterator[tuple[Plain, str, Plain]]:
        """Label, function and keywords of everything that is computed, subject by subject."""
        first: dict[str, list[NamedTrial]] = {}
        for trial in self.trials:
            if trial.repetition == min(t.repetition for t in self._of(trial) if _same(t, trial)):
                first.setdefault(trial.protocol, []).append(trial)
            if self.only != "snsem":
                label = {"kind": "trial", **asdict(trial)}
                yield label, "trial_job", {"where": self.where(trial)}
            if self.only != "spectra":
                yield from self._fits(trial)
        if self.only != "spectra":
            yield from self._simulations(first)

    def _fits(self, trial: NamedTrial) -> Iterator[tuple[Plain, str, Plain]]:
        """Every fit of a recording; it predicts the subject's others unless `only` says less."""
        several = [] if self.only else self._of(trial)
        others = {t.name: self.where(t) for t in several if t != trial}
        for (model, fixed), settings in self.settings.items():
            label = {"kind": "fit", **asdict(trial), "model": model, "fixed": fixed}
            given = {"settings": to_plain(settings), "others": others}
            yield label, "fit_job", {"where": self.where(trial), **given}

    def _simulations(
        self, first: Mapping[str, Sequence[NamedTrial]]
    ) -> Iterator[tuple[Plain, str, Plain]]:
        """Simulations as some recordings move, by protocol: each subject's first."""
        for protocol, several in first.items():
            for model, settings in {m: s for (m, _), s in self.settings.items()}.items():
                if settings.model not in MODELS.values():
                    continue
                for leg, trial in enumerate(several[:LEGS]):
                    label = {"kind": "simulation", "protocol": protocol, "model": model, "leg": leg}
                    given = {"settings": {"model": settings.model}, "leg": leg}
                    yield label, "simulation_job", {"where": self.where(trial), **given}

    def _of(self, trial: NamedTrial) -> list[NamedTrial]:
        return [each for each in self.trials if each.subject == trial.subject]


def _same(one: NamedTrial, other: NamedTrial) -> bool:
    return one.protocol == other.protocol


class BatchStore(Ledger):
    """A batch's file, open; see `surae.processes.ledger.Ledger`."""

    _NOTHING = "no batch yet"

    def _reason(self, value: Any) -> str | None:
        return None if value.get("failed") is None else str(value["failed"])

    def outcomes(self) -> list[tuple[Plain, Plain]]:
        """Label and outcome of all that is there; of a call whose worker died, why it failed."""
        return [
            (label, {"failed": value.message} if isinstance(value, Died) else value)
            for label, value in self.results()
        ]


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
    calls = {}
    for label, function, keywords in batch.calls():
        paths = [
            keywords["where"]["path"],
            *(o["path"] for o in keywords.get("others", {}).values()),
        ]
        text = json.dumps([program, function, keywords, *(content[path] for path in paths)])
        key = hashlib.sha256(text.encode()).hexdigest()
        labels.append((key, label))
        calls[key] = (function, keywords)
    done = store.begin("batch", "batch", "", labels)
    rest = {k: {"function": f, "keywords": w} for k, (f, w) in calls.items() if k not in done}
    return store.keep(results(f"{_WORK}:call", rest, engine), progress)


#: Columns of the table of fits before the parameters'.
_ABOUT = ("subject", "protocol", "repetition", "model", "fixed")
_FIT = ("status", "grade", "vaf", "r2", "ipde", "validation_vaf")


def table(
    outcomes: Sequence[tuple[Plain, Plain]],
) -> tuple[tuple[str, ...], list[tuple[Cell, ...]]]:
    """A row for each fit: whose it is, how good, every parameter with its standard error.

    ``validation_vaf`` is the mean VAF [%] of the other repetitions of the protocol.
    """
    fits = [(label, fit) for label, fit in outcomes if label["kind"] == "fit"]
    names = list(dict.fromkeys(n for _, fit in fits for n in fit.get("parameters", {})))
    ends = ("", "_sem", "_low", "_high", "_verdict")
    columns = (*_ABOUT, *_FIT, *(n + end for n in names for end in ends), "message", "seconds")
    rows = []
    for label, fit in fits:
        values: dict[str, Cell] = {c: fit.get(c) for c in (*_FIT, "seconds")}
        values |= {c: label[c] for c in _ABOUT}
        repeated = [vaf for _, vaf in predictions(label, fit, label["protocol"])]
        values["validation_vaf"] = sum(repeated) / len(repeated) if repeated else None
        values["status"], values["message"] = fit.get("status", "failed"), fit.get("failed")
        for name, p in fit.get("parameters", {}).items():
            low, high = p["ci95"] or (None, None)
            values |= dict(
                zip(
                    (name + end for end in ends),
                    (p["value"], p["sem"], low, high, p["verdict"]),
                    strict=True,
                )
            )
        rows.append(tuple(values.get(column) for column in columns))
    return columns, rows


def predictions(label: Plain, fit: Plain, protocol: str) -> Iterator[tuple[int, float]]:
    """Repetition and VAF [%] of the subject's recordings of a protocol that a fit predicts."""
    for name, vaf in fit.get("predicted", {}).items():
        of, repetition = name[len(label["subject"]) + 1 :].rsplit(" ", 1)
        if of == protocol and vaf is not None:
            yield int(repetition), vaf
