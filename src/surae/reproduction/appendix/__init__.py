"""Appendix A: what a covariance matrix shows of linear and non-linear models, Figures 41 to 43.

`springs` fits mass-spring-dampers by the code that fits muscles.
"""

from matplotlib.figure import Figure

from surae.report.figures.correlation import correlation_figure
from surae.report.figures.style import INK, new_figure
from surae.reproduction.appendix.springs import (
    TRUTH,
    Fitted,
    exponential,
    fit_linear,
    fit_offset,
    protocol_motion,
)
from surae.reproduction.chapter import Context, Drawing, Result, Section, Table
from surae.reproduction.claims import Claim, Finding, judged

#: Correlations below this count as close to zero, above that as high.
_SMALL, _HIGH = 0.2, 0.5


def run(context: Context) -> Result:
    """Fit both models to one noisy force and look at their covariance matrices."""
    context.progress("appendix", 0, 1)
    motion = protocol_motion()
    linear, offset = fit_linear(motion, context.seed), fit_offset(motion, context.seed)
    result = Result(
        findings=(_linear(linear, context.seed), _non_linear(offset), _accurate(offset), _alike()),
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
    context.progress("appendix", 1, 1)
    return result


def _linear(fit: Fitted, seed: int) -> Finding:
    claim = Claim(
        name="linear-independent",
        source="A.2, Figure 42",
        text="The linear model's cross-covariances are close to zero.",
        number="about 0",
        rule=f"no correlation is larger than {_SMALL:g}",
    )
    pairs = fit.pairs()
    (first, second), worst = max(pairs.items(), key=lambda item: abs(item[1]))
    unfiltered = fit_linear(protocol_motion(filtered=False), seed).pairs()
    return judged(
        claim,
        abs(worst) <= _SMALL,
        f"largest {worst:+.2f} ({first}, {second})",
        why="x and x'' oppose each other: over a whole movement their product averages to minus "
        "the mean of x'², so k and m always share something. How much depends on the movement, "
        "which the thesis does not give.",
        remark="It depends on the movement, which the thesis does not give: not filtered for the "
        f"manipulator, the same one gives {unfiltered['k', 'm']:+.2f} for k and m.",
        figure="figure-42",
    )


def _non_linear(fit: Fitted) -> Finding:
    claim = Claim(
        name="non-linear-dependent",
        source="A.2, Figure 43",
        text="In the non-linear model b and u depend on each other strongly, the others hardly.",
        number="b–u high, others about 0",
        rule=f"|r| of b and u is at least {_HIGH:g}, of all other pairs at most {_SMALL:g}",
    )
    pairs = fit.pairs()
    own = pairs.pop(("b", "u"))
    worst = max(map(abs, pairs.values()))
    return judged(
        claim,
        abs(own) >= _HIGH and worst <= _SMALL,
        f"b–u {own:+.2f}, others at most {worst:.2f}",
        why="That of b and u follows from u, our choice, against the speed, "
        "r = u/√(u² + mean of x'²); that of k and m is the linear model's.",
        remark="It follows from our choice of u against the speed: r = u/√(u² + mean of x'²).",
        figure="figure-43",
    )


def _accurate(fit: Fitted) -> Finding:
    claim = Claim(
        name="still-accurate",
        source="A.2",
        text="Although they depend on each other, b and u are estimated accurately.",
        number="no number",
        rule="both are within 3 standard errors of the truth, and these below 5 % of it",
    )
    off = {name: (fit.values[name] - TRUTH[name]) / fit.sem[name] for name in ("b", "u")}
    part = {name: 100 * fit.sem[name] / abs(TRUTH[name]) for name in ("b", "u")}
    return judged(
        claim,
        max(map(abs, off.values())) <= 3 and max(part.values()) < 5,
        ", ".join(f"{name} {off[name]:+.1f} SEM off, SEM {part[name]:.2g} %" for name in off),
        why="Noise of 5 % on this motion determines them less well.",
    )


def _alike() -> Finding:
    claim = Claim(
        name="exponential-motion",
        source="A.3",
        text="With x = exp(t), equal to its derivatives, the parameters cannot be distinguished.",
        number="no number",
        rule="the covariance names k, b and m as one inseparable direction",
    )
    fit = exponential()
    return judged(
        claim,
        fit.inseparable == (("k", "b", "m"),),
        "inseparable: " + ("; ".join(" ".join(group) for group in fit.inseparable) or "none"),
        why="The numerical rank of the problem is not 1.",
    )


def _drawing(name: str, title: str, fit: Fitted) -> Drawing:
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


def _table(linear: Fitted, offset: Fitted) -> Table:
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


SECTION = Section(
    name="appendix",
    title="What a covariance matrix shows",
    source="Appendix A; Figures 41 to 43",
    run=run,
)
