"""Appendix A: what a covariance matrix shows of linear and non-linear models, Figures 41 to 43.

`springs` fits mass-spring-dampers by the code that fits muscles.
"""

from dataclasses import dataclass

from surae.report.figures import INK, Figure, correlation_figure, new_figure
from surae_thesis.claims import Claim, Ruling, judge_all
from surae_thesis.section import Context, Drawing, Result, Table
from surae_thesis.springs import (
    TRUTH,
    FittedSpring,
    exponential,
    fit_linear,
    fit_offset,
    protocol_motion,
)


def run(context: Context) -> Result:
    """Fit both models to one noisy force and look at their covariance matrices."""
    context.progress("appendix", 0, 1)
    motion = protocol_motion()
    linear, offset = fit_linear(motion, context.seed), fit_offset(motion, context.seed)
    unfiltered = fit_linear(protocol_motion(filtered=False), context.seed)
    numbers = Numbers(linear, offset, unfiltered, exponential())
    return Result(
        findings=judge_all("appendix", {"": numbers}, __name__),
        figures=(
            Drawing(
                name="figure-41",
                title="Figure 41: the covariance matrix",
                caption="Of the parameters X1 … Xn, before it is normalised.",
                alt="A matrix with variances on its diagonal and covariances beside it.",
                figure=_matrix(),
            ),
            _drawing("figure-42", "Figure 42: linear mass-spring-damper", linear),
            _drawing("figure-43", "Figure 43: non-linear mass-spring-damper", offset),
        ),
        tables=(_table(linear, offset),),
        notes=(
            "F = k·x + b·x' + m·x'' and F = k·x + b·(x' − u) + m·x''. The thesis gives neither "
            "values nor the motion: x is its multi-sine with holds and chirp, as the "
            "manipulator follows it, about its mean; "
            f"{', '.join(f'{name} = {value:g}' for name, value in TRUTH.items())}, and the force "
            "has noise of 5 % of its mean magnitude. The sign in the bracket is lost in print; a "
            "product b·(x'·u) would leave b and u inseparable, while the thesis estimates both.",
        ),
    )


@dataclass(frozen=True, slots=True)
class Numbers:
    """The fits that the claims look at."""

    linear: FittedSpring
    offset: FittedSpring
    unfiltered: FittedSpring
    alike: FittedSpring


def linear(n: Numbers, small: float) -> Ruling:
    """The linear model's largest correlation."""
    pairs = n.linear.pairs()
    (first, second), worst = max(pairs.items(), key=lambda item: abs(item[1]))
    return Ruling(abs(worst) <= small, f"largest {worst:+.2f} ({first}, {second})")


def unfiltered(n: Numbers, _: Claim) -> str:
    """What the same movement gives before it is filtered."""
    return (
        "It depends on the movement, which the thesis does not give: not filtered for the "
        f"manipulator, the same one gives {n.unfiltered.pairs()['k', 'm']:+.2f} for k and m."
    )


def non_linear(n: Numbers, small: float, high: float) -> Ruling:
    """The correlation of b and u, and the largest of the others."""
    pairs = n.offset.pairs()
    own = pairs.pop(("b", "u"))
    worst = max(map(abs, pairs.values()))
    text = f"b–u {own:+.2f}, others at most {worst:.2f}"
    return Ruling(abs(own) >= high and worst <= small, text)


def accurate(n: Numbers) -> Ruling:
    """Errors of b and u."""
    fit = n.offset
    off = {name: (fit.values[name] - TRUTH[name]) / fit.sem[name] for name in ("b", "u")}
    part = {name: 100 * fit.sem[name] / abs(TRUTH[name]) for name in ("b", "u")}
    return Ruling(
        max(map(abs, off.values())) <= 3 and max(part.values()) < 5,
        ", ".join(f"{name} {off[name]:+.1f} SEM off, SEM {part[name]:.2g} %" for name in off),
    )


def alike(n: Numbers) -> Ruling:
    """What the covariance cannot tell apart along x = exp(t)."""
    groups = "; ".join(" ".join(group) for group in n.alike.inseparable) or "none"
    return Ruling(n.alike.inseparable == (("k", "b", "m"),), f"inseparable: {groups}")


def _drawing(name: str, title: str, fit: FittedSpring) -> Drawing:
    pairs = fit.pairs()
    (first, second), worst = max(pairs.items(), key=lambda item: abs(item[1]))
    return Drawing(
        name=name,
        title=title,
        caption="Normalised covariance matrix of the estimates.",
        alt=f"The largest correlation off the diagonal is {worst:.2f}, of {first} and {second}.",
        figure=correlation_figure(fit.names, fit.correlation),
    )


def _matrix() -> Figure:
    figure = new_figure(1.9)
    figure.set_figwidth(6.0)
    axes = figure.add_subplot()
    axes.axis("off")
    rows = ["1", "2", "⋯", "n"]
    for i, a in enumerate(rows):
        for j, b in enumerate(rows):
            dots = "⋯" in (a, b)
            text = ("⋱" if a == b else "⋯" if b == "⋯" else "⋮") if dots else (
                rf"$E[(X_{a}-\mu_{a})(X_{b}-\mu_{b})]$"
            )  # fmt: skip
            axes.text((j + 0.5) / 4, 1 - (i + 0.5) / 4, text, ha="center", va="center",
                      fontsize=9, color=INK)  # fmt: skip
    for x, inward in ((0.0, 0.02), (1.0, -0.02)):
        axes.plot([x + inward, x, x, x + inward], [1, 1, 0, 0], color=INK, linewidth=1.0)
    axes.set(xlim=(-0.01, 1.01), ylim=(-0.03, 1.03))
    return figure


def _table(linear: FittedSpring, offset: FittedSpring) -> Table:
    rows = [
        (title, name, TRUTH[name], float(f"{fit.values[name]:.6g}"), float(f"{fit.sem[name]:.3g}"))
        for title, fit in (("linear", linear), ("non-linear", offset))
        for name in fit.names
    ]
    return Table(
        name="springs",
        title="Mass-spring-dampers: truth, estimate, standard error",
        columns=("model", "parameter", "truth", "estimate", "standard error"),
        rows=tuple(rows),
    )
