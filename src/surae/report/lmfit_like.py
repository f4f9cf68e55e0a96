"""A fit in the layout of lmfit's reports, for readers and scripts that know that one."""

from surae.inference import AssessedFit
from surae.inference.judging.criteria import criteria_of
from surae.inference.judging.parameter import ParameterEstimate


def fit_report(fit: AssessedFit, min_correlation: float) -> str:
    """Statistics, variables, and correlations of at least this size, the largest first."""
    lines = [*_statistics(fit), "[[Variables]]", *_variables(fit)]
    if correlations := _correlations(fit, min_correlation):
        lines += [f"[[Correlations]] (unreported correlations are < {min_correlation:.3f})"]
        lines += correlations
    return "\n".join(lines)


def _number(value: float | None, digits: int) -> str:
    """Digits that a script reads too."""
    return "nan" if value is None else f"{value:.{digits}g}"


def _statistics(fit: AssessedFit) -> list[str]:
    result = fit.result
    known = criteria_of(result)
    rows = (
        ("model", result.problem.spec.name),
        ("# function evals", str(result.solution.evaluations)),
        ("# data points", str(known.n)),
        ("# variables", str(known.free)),
        ("chi-square [Nm²]", _number(known.sse, 6)),
        ("reduced chi-square", _number(known.sse / max(known.n - known.free, 1), 6)),
        ("Akaike info crit", _number(known.aic, 6)),
        ("Bayesian info crit", _number(known.bic, 6)),
        ("R-squared", _number(fit.assessment.adequacy.r2 / 100.0, 6)),
        ("adequacy", str(fit.assessment.adequacy.grade)),
    )
    width = max(len(name) for name, _ in rows)
    return ["[[Fit Statistics]]", *(f"    {name:<{width}} = {text}" for name, text in rows)]


def _variables(fit: AssessedFit) -> list[str]:
    every = {**fit.assessment.parameters, **fit.assessment.nuisances}
    width = max(map(len, every)) + 1
    return [f"    {f'{name}:':<{width}} {_value(each)}" for name, each in every.items()]


def _value(each: ParameterEstimate) -> str:
    value = f"{_number(each.value, 6)} {each.unit}"
    if not each.free:
        return f"{value} (fixed)"
    sem = each.trusted_sem
    if sem is None:
        return f"{value} +/- nan ({each.verdict})"
    part = f"{abs(100.0 * sem / each.value):.2f}%, " if each.value else ""
    return f"{value} +/- {_number(sem, 4)} ({part}{each.verdict})"


def _correlations(fit: AssessedFit, least: float) -> list[str]:
    known = fit.assessment.covariance
    names = known.names
    pairs = [
        (names[i], names[j], float(known.correlation[i, j]))
        for i in range(len(names))
        for j in range(i)
        if abs(known.correlation[i, j]) >= least
    ]
    pairs.sort(key=lambda pair: -abs(pair[2]))
    return [f"    C({first}, {second}) = {size:+.4f}" for first, second, size in pairs]
