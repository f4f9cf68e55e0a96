"""How a fit came about: settings, weights, priors, what was left out, files and preparation."""

import math
from collections.abc import Mapping
from typing import Any

from surae.assessment import Assessment
from surae.estimation import FitResult, Prior
from surae.estimation.population import population_of
from surae.formatting import percentage, short, significant
from surae.model import adapted
from surae.quality.numeric import runs
from surae.report.document import FactsBlock, SectionBlock, facts_of
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Share of samples that count less than half from which they are no stray artefacts; Gaussian noise
#: has 0.7 % of them under Huber's loss.
_MANY_OUTLIERS = 0.05


def emphasis_text(result: FitResult, assessment: Assessment) -> str:
    """A paragraph of the summary; empty where every sample counts as any other."""
    texts = []
    if any(recording.emphasised for recording in result.problem.inputs):
        texts.append("Some samples count more than others in this fit.")
    if result.outliers is not None:
        share = 100 * result.outliers.share
        texts.append(
            f"Outliers count less ({result.outliers.loss} loss): {significant(share, 2)} "
            "% of the samples count less than half. The plain VAF and error "
            "include them."
        )
        if result.outliers.share > _MANY_OUTLIERS:
            texts.append(
                "So many are no stray artefacts: the model leaves something out, and a loss that "
                "spares outliers hides it."
            )
    if texts and assessment.vaf_weighted is not None:
        texts.append(
            f"With the samples counted as in the fit, the VAF is "
            f"{percentage(assessment.vaf_weighted)} %."
        )
    return " ".join(texts)


def loss_text(result: FitResult) -> str:
    """The loss, its tuning and scale, and how many samples it spares."""
    outliers = result.outliers
    if outliers is None:
        return "squares"
    return (
        f"{outliers.loss}, from {short(outliers.tuning)} standard deviations of "
        f"{significant(outliers.scale, 3)} Nm; {significant(100 * outliers.share, 2)} % of the "
        f"samples count less than half; weights at rest after {outliers.rounds} rounds"
    )


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


def _option(value: Any) -> str:
    if isinstance(value, list | tuple):
        return " / ".join(short(level) for level in value)
    if isinstance(value, Mapping):  # a table, known by its file
        return str(value["name"])
    return value if isinstance(value, str) else short(value)


def fit_settings(result: FitResult, assessment: Assessment) -> tuple[tuple[str, str], ...]:
    """Model, options, fixed parameters, changed bounds, starts, seed and time of a fit."""
    problem = result.problem
    options = ", ".join(
        f"{name} = {_option(value)}" for name, value in problem.options.as_dict().items()
    )
    chosen = "" if result.family is None else ", chosen by model auto"
    return (
        ("Model", f"{problem.spec.title} ({problem.spec.name}){chosen}"),
        ("Model options", options),
        ("Fixed parameters", _fixed(result, assessment)),
        ("Bounds", _bounds(result)),
        ("Priors", _priors(result, assessment)),
        ("Loss", loss_text(result)),
        ("Samples and estimated parameters", f"{problem.n} and {len(problem.free)}"),
        ("Starts", _starts(result)),
        ("Wall time of the fit", f"{significant(result.seconds, 2)} s"),
    )


def provenance_section(
    result: FitResult, assessment: Assessment, versions: Mapping[str, str]
) -> SectionBlock:
    """How the fit came about: its settings, the files, what was done to them, and the versions."""
    return SectionBlock(
        "Settings and provenance",
        (
            facts_of(fit_settings(result, assessment), "settings"),
            *map(_source, result.problem.inputs),
            SectionBlock("Versions", (facts_of(versions.items()),)),
        ),
        "provenance",
        "provenance",
    )


def _source(recording: ModelInputs) -> SectionBlock:
    """A recording's files, and what was done to it."""
    files = tuple(f"{file.name}, SHA-256 {file.sha256}" for file in recording.files)
    facts = (
        ("Files", files or ("none: the recording was made in memory",)),
        ("Preparation", recording.steps or ("none recorded",)),
    )
    return SectionBlock(recording.name, (FactsBlock(facts, "settings"),), look="source")


def _starts(result: FitResult) -> str:
    count = len(result.starts)
    if result.family is not None:
        return f"both valleys of the relaxation; {count} kept that the data do not reject"
    spared = result.outliers is not None
    first = "the solution with the weights of the outliers" if spared else "the default start"
    if count == 1:
        return f"only {first}: whether its minimum is the best one was not looked into"
    return (
        f"{result.agreeing} of {count} reach the best minimum; the first is {first}, the others "
        f"are random, with seed {result.seed}"
    )


def _fixed(result: FitResult, assessment: Assessment) -> str:
    problem = result.problem
    prescribed = {name for recording in problem.inputs for name in recording.fixed}
    texts = []
    for p in assessment.parameters.values():
        if p.free:
            continue
        if p.name in prescribed:
            why = " (prescribed by the recording)"
        else:
            why = "" if p.name in problem.spec.free else " (not freed in this model)"
        unit = "" if p.unit == "-" else f" {p.unit}"
        texts.append(f"{p.name} = {short(p.value)}{unit}{why}")
    return ", ".join(texts) or "none"


def _priors(result: FitResult, assessment: Assessment) -> str:
    texts = [
        f"{name} = {prior_text(prior, unit if unit != '-' else '')}"
        for name, prior in result.problem.priors.items()
        for unit in [assessment.parameters[name].unit]
    ]
    pairs = {name: (prior.median, prior.spread) for name, prior in result.problem.priors.items()}
    defaults = population_of(pairs, result.problem.options)
    if defaults:
        texts[-1] += f" (defaults of the {next(iter(defaults.values()))} population"
        texts[-1] += ")" if len(defaults) == len(pairs) else f": {', '.join(defaults)})"
    return ", ".join(texts) or "none"


def _bounds(result: FitResult) -> str:
    problem = result.problem
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    changed = [
        f"{name}: {short(low)} … {short(high)} instead of "
        f"{short(table[name].lower)} … {short(table[name].upper)}"
        for name, low, high in zip(
            problem.free, problem.lower.tolist(), problem.upper.tolist(), strict=True
        )
        if (low, high) != (table[name].lower, table[name].upper)
    ]
    return "; ".join(changed) or "those of the model"
