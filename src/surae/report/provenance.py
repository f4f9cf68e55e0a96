"""How a fit came about: settings, weights, priors, what was left out, files and preparation."""

import math
from collections.abc import Mapping
from typing import Any

from surae.base.formatting import percentage, short, significant
from surae.base.names import GEOMETRY_OF
from surae.base.setting import default_of, settings_of
from surae.base.units import FloatArray
from surae.inference import AssessedFit, FitResult, Prior
from surae.model.knowledge import Knowledge
from surae.model.knowledge_words import summary_of
from surae.quality.numeric import runs
from surae.report import block
from surae.settings import FitSettings
from surae.signals import ModelInputs

#: Share of samples that count less than half from which they are no stray artefacts; Gaussian noise
#: has 0.7 % of them under Huber's loss.
_MANY_OUTLIERS = 0.05


def emphasis_text(fit: AssessedFit) -> str:
    """A paragraph of the summary; empty where every sample counts as any other."""
    texts = []
    if any(recording.emphasised for recording in fit.result.problem.inputs):
        texts.append("Some samples count more than others in this fit.")
    if (outliers := fit.result.solution.outliers) is not None:
        share = 100 * outliers.share
        texts.append(
            f"Outliers count less ({outliers.loss} loss): {significant(share, 2)} "
            "% of the samples count less than half. The plain VAF and error "
            "include them."
        )
        if outliers.share > _MANY_OUTLIERS:
            texts.append(
                "So many are no stray artefacts: the model leaves something out, and a loss that "
                "spares outliers hides it."
            )
    if texts and fit.assessment.vaf_weighted is not None:
        texts.append(
            f"With the samples counted as in the fit, the VAF is "
            f"{percentage(fit.assessment.vaf_weighted)} %."
        )
    return " ".join(texts)


#: Spans that are written out at most.
_SPANS = 6


def excluded_spans(weight: FloatArray | None) -> tuple[tuple[int, int], ...]:
    """First and last sample of every stretch of weight zero."""
    if weight is None:
        return ()
    return tuple((first, past - 1) for first, past in runs(weight == 0))


def excluded_text(time: FloatArray, weight: FloatArray | None) -> str:
    """How many samples were left out, and when; empty where all count."""
    spans = excluded_spans(weight)
    if not spans:
        return ""
    count = sum(last - first + 1 for first, last in spans)
    texts = [
        f"{_second(time[first])} s"
        if first == last
        else f"{_second(time[first])} … {_second(time[last])} s"
        for first, last in spans[:_SPANS]
    ]
    if len(spans) > _SPANS:
        texts.append(f"and {len(spans) - _SPANS} spans more")
    return f"{count} of {len(time)} samples, weight 0: {', '.join(texts)}"


def _second(time: float) -> str:
    return short(round(float(time), 3))


#: Spread up to which a logarithm's standard deviation reads as a percentage of the value.
_SMALL = 0.3
#: Part of the prior's spread from which the data are said to add little.
_LITTLE = 0.7


def prior_text(prior: Prior, unit: str = "") -> str:
    """A prior's median and spread, ``"0.04 m ± 20 %"``."""
    median = f"{short(prior.median)} {unit}".rstrip()
    if prior.spread <= _SMALL:
        return f"{median} ± {short(float(f'{100 * prior.spread:.3g}'))} %"
    return f"{median}, times or divided by {significant(math.exp(min(prior.spread, 700.0)), 3)}"


def prior_note(prior: Prior, value: float, sem: float | None) -> str:
    """The prior at its parameter, and whether the data say much beside it."""
    text = f"with prior {prior_text(prior)}"
    if sem is not None and sem > _LITTLE * prior.spread * value:
        text += ", to which the data add little"
    return text


def prior_span(prior: Prior) -> tuple[float, float, float]:
    """Lower end, median and upper end of a prior, one standard deviation to either side."""
    factor = math.exp(min(prior.spread, 700.0))
    return prior.median / factor, prior.median, prior.median * factor


#: What the stages of the search of `auto` are called.
_STAGES = {
    "starts": "from each start, without departures",
    "departures": "with the departures that the data ask for",
    "again": "again, from the simplest member",
}


def fit_settings(result: FitResult) -> list[tuple[str, str]]:
    """What was fitted and how long it took, then every setting that is not its default."""
    problem = result.problem
    solution = result.solution
    chosen = ", chosen by model auto" if result.posterior is not None else ""
    facts = [
        ("Model", f"{problem.spec.title} ({problem.spec.name}){chosen}"),
        ("Samples and estimated parameters", f"{problem.n} and {len(problem.free)}"),
        ("Wall time of the fit", f"{significant(result.seconds, 2)} s"),
    ]
    count = len(solution.starts)
    text = f"{solution.agreeing} of {count} reach the best minimum; seed {result.seed}"
    one = "only one: whether its minimum is the best one was not looked into"
    facts.append(("Starts", text if count > 1 else one))
    for stage in solution.stages:
        name = _STAGES.get(stage.name, stage.name)
        capped = f"; {stage.capped} of its descents ended at a cap" if stage.capped else ""
        facts.append((f"Search {name}", f"{stage.evaluations} evaluations{capped}"))
    if says := whose_geometry(problem.settings):
        facts.append(("Moment arms and priors", problem.options.anatomy.worded(says)))
    return facts + requested(result)


def requested(result: FitResult) -> list[tuple[str, str]]:
    """Every setting that was asked for and is not its default: label and value."""
    problem = result.problem
    facts = []
    for request in (problem.settings, problem.settings.estimator, problem.options):
        for each, record in settings_of(type(request)):
            value = getattr(request, each.name)
            if each.name not in _ELSEWHERE and value != default_of(each):
                name = record.label or each.name.replace("_", " ").capitalize()
                label = problem.options.anatomy.worded(name)
                facts.append((label, _written(value)))
    return facts


def whose_geometry(settings: FitSettings) -> str:
    """Whose arms and priors are assumed, where nothing of the person's size is stated."""
    known = settings.knowledge
    if settings.geometry_of == GEOMETRY_OF[1] or (known is not None and known.size):
        return ""
    return (
        "an adult’s of 175 cm: of a child or a small person state height, foot or age in "
        "session.toml"
    )


#: Settings that have a place of their own in the report.
_ELSEWHERE = ("model", "options", "weights", "starts", "seed")


def _written(value: Any) -> str:
    """A setting's value; a table, or a joint, by its name."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {_written(each)}" for name, each in value.items())
    if isinstance(value, Knowledge):
        return summary_of(value)
    if isinstance(value, list | tuple):
        return " / ".join(map(_written, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return short(value)
    return value if isinstance(value, str) else str(value.name)


def provenance_section(result: FitResult, versions: Mapping[str, str]) -> block.Section:
    """How the fit came about: its settings, the files, what was done to them, and the versions."""
    return block.Section(
        "Settings and provenance",
        (
            block.facts(fit_settings(result), "settings"),
            *map(_source, result.problem.inputs),
            block.Section("Versions", (block.facts(versions.items()),)),
        ),
        "provenance",
        "provenance",
    )


def _source(recording: ModelInputs) -> block.Section:
    """A recording's files, and what was done to it."""
    files = tuple(f"{file.name}, SHA-256 {file.sha256}" for file in recording.files)
    facts = (
        ("Files", files or ("none: the recording was made in memory",)),
        ("Preparation", recording.steps or ("none recorded",)),
    )
    return block.Section(recording.name, (block.Facts(facts, "settings"),), look="source")
