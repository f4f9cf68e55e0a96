"""The page of a cohort: groups, differences and changes in tables, every leg in figures."""

from datetime import datetime

from surae.base.files import natural_order
from surae.base.formatting import of_interval
from surae.cohorts.member import CohortMember, sessions_of
from surae.cohorts.result import Cohort
from surae.measures.table import LEADING
from surae.report import block
from surae.report.figures.cohort import forest_figure, sessions_figure
from surae.report.output import Report

#: Measures that are drawn, where the cohort has them.
_DRAWN = (*LEADING, "passive_torque", "passive_stiffness", "slow_stiffness", "optimal_angle_tri")

#: What figures show.
_FOREST = (
    "grey as found, dark as drawn to the group; bars are 95 % intervals, diamonds the groups’ means"
)
_LINES = "as found, a line for each leg; how sure each is stands in the tables"


def cohort_report(cohort: Cohort, *, created: datetime) -> Report:
    """The report of a cohort; it has the table's own names."""
    figures = []
    for p in cohort.pooled.values():
        if p.name.partition("@")[0] in _DRAWN and p.legs:
            label = f"{p.name} [{p.unit}]"
            figures.append((p.name, forest_figure(p), _FOREST))
            if over := _over_sessions(cohort, p.name):
                order = list(
                    dict.fromkeys(
                        m.session
                        for m in sorted(cohort.members, key=lambda m: natural_order(m.session))
                    )
                )
                title = f"{p.name} over sessions"
                figures.append((title, sessions_figure(label, order, over), _LINES))
    groups = cohort.as_table()
    contrasts = []
    for p in cohort.pooled.values():
        for kind, of in (("groups", p.differences), ("sessions", p.changes)):
            for key, c in of.items():
                text = of_interval(c.difference, c.ci95)
                row = (p.name, kind, key or "all", text.value, text.interval, f"{c.p:.2g}", c.k)
                contrasts.append((*row, p.unit))
    scales = [
        (p.name, scale, c.n, f"{c.rho:+.2f}", f"{c.p:.2g}")
        for p in cohort.pooled.values()
        for scale, c in p.scales.items()
    ]
    tables = (
        ("No fit", ("Leg", "Why"), [(m.row, m.missing) for m in cohort.members if m.missing]),
        (
            "Differences and changes",
            ("Of", "Between", "Which", "Difference", "95 % interval", "p", "Legs", "Unit"),
            contrasts,
        ),
        ("Clinical scales", ("Of", "Scale", "Legs", "Spearman’s ρ", "p"), scales),
        ("Groups", [head.capitalize() for head in groups.heads], groups.rows),
    )
    sections: list[block.Section | None] = []
    for title, heads, rows in tables:
        texts = block.rows(tuple(map(str, row)) for row in rows)
        table = block.Grid(title, block.columns(*heads), texts)
        sections.append(block.Section(title, (table,)) if rows else None)
    first = filter(None, sections[:2])
    later = filter(None, sections[2:])
    legs = f"Cohort of {len({m.leg for m in cohort.members})} legs"
    about = (
        "Every leg counts as much as its interval allows (random effects, REML; intervals of means "
        "after Hartung and Knapp). P-values are Holm’s over all rows of their kind."
    )
    if cohort.rounds:
        about += (
            f" Every leg was fitted again with its population, {cohort.rounds} round(s); means and "
            "differences are of fits without it."
        )
    note = (block.Text(f"{cohort.note}.", lead="Note:"),) if cohort.note else ()
    pictures = (
        block.Picture(title, title, f"{title}: {caption}.") for title, _, caption in figures
    )
    document = block.Document(
        kicker="Ankle muscle parameters",
        heading=legs,
        under=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        title=legs,
        blocks=(block.Text(about), *note, *first, *pictures, *later),
    )
    return Report(document, [(title, figure) for title, figure, _ in figures])


def _value(member: CohortMember, name: str) -> float | None:
    q = None if member.quantities is None else member.quantities.by_name.get(name)
    if q is None or q.at_bound or (q.missing and not q.is_comparable_between_legs):
        return None
    return q.value


def _over_sessions(cohort: Cohort, name: str) -> list[tuple[str, list[tuple[str, float]]]]:
    """Group and values of the legs that were measured more than once, by session."""
    over_sessions = []
    for each in sessions_of(cohort.members).values():
        values = [(m.session, value) for m in each if (value := _value(m, name)) is not None]
        if len(values) > 1:
            over_sessions.append((each[0].group, values))
    return over_sessions
