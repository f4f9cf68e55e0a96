"""`surae change`."""

from collections.abc import Sequence
from datetime import date
from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.base.requests import ChangeSettings
from surae.cli.days import day_of
from surae.cli.options import LANGUAGE, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files, show_line


@click.command("change")
@click.argument("visits", metavar="BEFORE… AFTER", nargs=-1, required=True)
@click.option(
    "--baseline",
    "baselines",
    multiple=True,
    metavar="FIT.json|DIR",
    help="A further session before anything changed; may be repeated.",
)
@settings_options(ChangeSettings)
@click.option(
    "--day",
    "days",
    multiple=True,
    type=day_of,
    metavar="DAY",
    help="When each of three visits or more was, in their order: 2026-03-04, or 4 March 2026.  "
    "[default: equally far apart]",
)
@click.option("--output", metavar="C.json", help="Write the comparison.")
@click.option("--report", metavar="C.html", help="Write a page of it: HTML or PDF.")
@LANGUAGE
def command(
    visits: tuple[str, ...],
    days: tuple[date, ...],
    baselines: tuple[str, ...],
    output: str | None,
    report: str | None,
    language: str,
    options: dict[str, Any],
) -> None:
    """Compare a leg between its visits, or the two legs of a person.

    BEFORE and AFTER are two visits; of three or more, in their order, the course is judged: a
    straight line through each measure. They are files of fits or folders of sessions; recordings
    or folders of them, whose rest and maximal efforts are compared; or files of surae impedance or
    surae stretches. Errors that two sessions of a leg have in common cancel; of two legs (--legs)
    none do. What is asked beforehand (--question) is judged at the full level; all else is
    exploratory, and to be confirmed.
    """
    outputs = {"--output": output, "--report": report}
    check_outputs(outputs, [*visits, *baselines], spare_fits=True)
    if len(visits) < 2:
        raise InputError("one visit has nothing to be compared with; give two or more")
    if len(visits) > 2:
        _course(visits, days, baselines, output, report, language, options)
        return
    if days:
        raise InputError("--day is of three visits or more; leave it out of two")
    before, after = visits

    other = api.other_change(before, after)
    if other is not None:
        if report is not None or baselines or options:
            raise InputError("files of tissue and nerve are compared as they are: --output alone")
        if output is not None:
            other.save(output)
        show_answer(other.as_table())
        show_files({"change": output})
        return
    api.check_report(report)
    with compilation_notice():
        change = api.change(before, after, baselines=baselines, **options)

    if output is not None:
        change.save(output)
    show_answer(change.as_table())
    if report is not None:
        angles = options.get("angles", ())
        api.write_change_page(
            report,
            change,
            api.fits_of(before, after),
            curves=api.curves_of(before, after),
            language=language,
            angle=angles[0] if len(angles) == 1 else None,
        )
    show_files({"change": output, "report": report})


def _course(
    visits: Sequence[str],
    days: Sequence[date],
    baselines: Sequence[str],
    output: str | None,
    report: str | None,
    language: str,
    options: dict[str, Any],
) -> None:
    """Three visits or more."""
    if baselines:
        raise InputError("baselines are of two visits; name every visit in its order instead")
    if days and len(days) != len(visits):
        raise InputError(f"{len(visits)} visits have {len(days)} days; give --day for each")
    api.check_report(report)
    since = [float((day - days[0]).days) for day in days] or None
    with compilation_notice():
        change = api.course(visits, days=since, **options)
    if output is not None:
        change.save(output)
    show_answer(change.as_table())
    if not days:
        show_line("On which days were these visits? They count as equally far apart; give --day.")
    if report is not None:
        api.write_change_page(report, change, [], language=language)
    show_files({"change": output, "report": report})
