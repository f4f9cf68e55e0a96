"""How a fit came about: settings, what was fixed or changed, files and preparation."""

from dataclasses import dataclass

from surae.assessment import Assessment
from surae.estimation import FitResult
from surae.estimation.population import population_of
from surae.model import adapted
from surae.report.emphasis import loss_text
from surae.report.excluded import excluded_text
from surae.report.formatting import short, significant
from surae.report.priors import prior_text


@dataclass(frozen=True, slots=True)
class Setting:
    """A label and what it says."""

    label: str
    value: str


@dataclass(frozen=True, slots=True)
class Source:
    """A recording, its files (name, SHA-256), which samples count, and what was done to it."""

    recording: str
    files: tuple[tuple[str, str], ...]
    samples: str
    excluded: str
    steps: tuple[str, ...]


def _option(value: str | float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return " / ".join(short(level) for level in value)
    return value if isinstance(value, str) else short(value)


def settings(result: FitResult, assessment: Assessment) -> tuple[Setting, ...]:
    """Model, options, fixed parameters, changed bounds, starts, seed and time of a fit."""
    problem = result.problem
    options = ", ".join(
        f"{name} = {_option(value)}" for name, value in problem.options.as_dict().items()
    )
    chosen = "" if result.family is None else ", chosen by model auto"
    return (
        Setting("Model", f"{problem.spec.title} ({problem.spec.name}){chosen}"),
        Setting("Model options", options),
        Setting("Fixed parameters", _fixed(result, assessment)),
        Setting("Bounds", _bounds(result)),
        Setting("Priors", _priors(result, assessment)),
        Setting("Loss", loss_text(result)),
        Setting("Samples and estimated parameters", f"{problem.n} and {len(problem.free)}"),
        Setting("Starts", _starts(result)),
        Setting("Wall time of the fit", f"{significant(result.seconds, 2)} s"),
    )


def sources(result: FitResult) -> tuple[Source, ...]:
    """The recordings of a fit."""
    return tuple(
        Source(
            recording=recording.name,
            files=tuple((file.name, file.sha256) for file in recording.files),
            samples=f"{recording.n} at {short(recording.rate_hz)} Hz",
            excluded=excluded_text(recording.time, recording.weight),
            steps=recording.steps,
        )
        for recording in result.problem.inputs
    )


def _starts(result: FitResult) -> str:
    count = len(result.starts)
    if result.family is not None:
        return f"both valleys of the relaxation; {count} kept that the data do not reject"
    return "the default one" if count == 1 else f"{count}, random ones with seed {result.seed}"


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
