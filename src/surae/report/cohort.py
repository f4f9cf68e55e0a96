"""The page of a cohort: groups, differences and changes in tables, every leg in figures."""

import base64
from datetime import datetime

from surae.measures.cohort import Cohort, Contrast
from surae.report.formatting import estimate, significant

#: Measures that are drawn, where the cohort has them.
_DRAWN = ("passive_torque", "passive_stiffness", "slow_stiffness", "optimal_angle_tri")


def cohort_html(cohort: Cohort, *, created: datetime) -> str:
    """The page as one HTML file that asks nothing of the outside; it has the table's own names."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from surae.report.figures import svg
    from surae.report.figures.cohort import forest_figure

    drawn = [
        (p.name, base64.b64encode(svg(forest_figure(p))).decode())
        for p in cohort.pooled.values()
        if p.name.partition("@")[0] in _DRAWN and p.legs
    ]
    groups = []
    for p in cohort.pooled.values():
        for group, effects in p.groups.items():
            text = estimate(effects.mean, effects.se, effects.ci95)
            left = "; ".join(f"{count}: {why}" for why, count in p.left_out.items())
            groups.append((
                p.name, group or "all", effects.k, text.value, text.interval,
                significant(effects.tau2**0.5, 2), p.unit, p.at_bound or "", left,
            ))  # fmt: skip
    contrasts = [
        (p.name, kind, key or "all", *_contrast(c), p.unit)
        for p in cohort.pooled.values()
        for kind, of in (("groups", p.differences), ("sessions", p.changes))
        for key, c in of.items()
    ]
    scales = [
        (p.name, scale, c.n, f"{c.rho:+.2f}", f"{c.p:.2g}")
        for p in cohort.pooled.values()
        for scale, c in p.scales.items()
    ]
    environment = Environment(
        loader=PackageLoader("surae.report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template("cohort.html.j2").render(
        legs=len({m.leg for m in cohort.members}),
        missing=[(m.row, m.missing) for m in cohort.members if m.missing],
        rounds=cohort.rounds,
        groups=groups,
        contrasts=contrasts,
        scales=scales,
        drawn=drawn,
        created=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
    )


def _contrast(c: Contrast) -> tuple[str, str, str, int]:
    text = estimate(c.difference, (c.ci95[1] - c.ci95[0]) / 3.92, c.ci95)
    return text.value, text.interval, f"{c.p:.2g}", c.k
