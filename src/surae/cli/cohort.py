"""`surae cohort`."""

from functools import partial
from typing import Any

import click

from surae import api
from surae.cli.options import DASK, engine_of, settings_options, workers_option
from surae.cli.paths import check_outputs, spare_fits
from surae.cli.progress import compilation_notice, work
from surae.cli.screen import Columns, show_files, show_line, show_verdicts
from surae.requests import CohortSettings


@click.command("cohort")
@click.argument("table", metavar="COHORT.csv")
@settings_options(CohortSettings)
@workers_option("Legs")
@DASK
@click.option("--output", metavar="C.json", help="Write the cohort.")
@click.option("--report", metavar="C.html", help="Write a page with its tables and figures.")
def command(
    table: str,
    workers: int | None,
    dask: str | None,
    output: str | None,
    report: str | None,
    options: dict[str, Any],
) -> None:
    """Compare groups of legs, sessions of each leg, and every leg with its group.

    COHORT.csv has the columns fit (a FIT.json or the folder of a session) and subject, and as far
    as there are side, group and session; other columns are clinical scales. Every leg counts as
    much as its interval allows; legs left out, and why, are listed.
    """
    engine = engine_of(dask, workers)
    outputs = {"--output": output, "--report": report}
    check_outputs(outputs, [table])
    spare_fits(outputs)

    api.check_report(report)
    with work() as progress, compilation_notice():
        cohort = api.cohort(
            table, **options, engine=engine, progress=partial(progress.parts, "legs"),
        )  # fmt: skip

    if output is not None:
        cohort.save(output)
    show_verdicts(*_table(cohort), numbers=("legs", "mean", "95 % interval", "spread"))
    for line in _notes(cohort):
        show_line(line)
    if report is not None:
        api.write_cohort_page(report, cohort)
    show_files({"cohort": output, "report": report})


def _table(cohort: "api.Cohort") -> Columns:
    rows: list[tuple[str, ...]] = []
    for p in cohort.pooled.values():
        for group, effects in p.groups.items():
            text = api.estimate(effects.mean, effects.se, effects.ci95)
            spread = api.significant(effects.tau2**0.5, 2)
            rows.append(
                (p.name, group or "all", str(effects.k), text.value, text.interval, spread, p.unit)
            )
    heads = ("of", "group", "legs", "mean", "95 % interval", "spread", "unit")
    return heads, rows


def _notes(cohort: "api.Cohort") -> list[str]:
    """Differences and changes that are shown, and who is not in them."""
    notes = []
    for p in cohort.pooled.values():
        for kind, contrasts in (("differs", p.differences), ("changed", p.changes)):
            notes += [
                f"{p.name} {kind}, {key or 'all'}: {c.difference:.3g} {p.unit} "
                f"({c.ci95[0]:.3g} … {c.ci95[1]:.3g}), p = {c.p:.2g}"
                for key, c in contrasts.items()
                if c.p < 0.05
            ]
    notes += [cohort.note] if cohort.note else []
    notes += [f"{m.row}: no fit ({m.missing})" for m in cohort.members if m.missing]
    bound = [f"{p.name} {p.at_bound}" for p in cohort.pooled.values() if p.at_bound]
    if bound:
        notes.append(f"at a bound, so that they may lie anywhere between: {', '.join(bound)}")
    if cohort.rounds:
        notes.append(f"every leg was fitted again with its population, {cohort.rounds} rounds")
    return notes
