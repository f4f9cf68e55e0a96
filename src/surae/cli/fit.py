"""`surae fit`."""

from typing import TYPE_CHECKING, Any

import click

from surae.cli.fitting import fit_options, taken
from surae.cli.options import (
    MODEL_NAMES,
    assignments,
    given,
    model_options,
    names,
    pairs,
    refuse_fixed,
    whole_number,
)
from surae.cli.paths import check_outputs, refuse_repeated
from surae.errors import InputError
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import Fit
    from surae.quality import Quality

#: More starts than this are a slip of the keyboard.
_MOST_STARTS = 10_000


@click.command("fit")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--model", default="muscle", show_default=True, metavar="M", help=f"{MODEL_NAMES}.")
@click.option("--prepared", is_flag=True, help="Use the signals as they are, without filters.")
@click.option("--fixed", multiple=True, metavar="NAME=VALUE", help="Do not estimate a parameter.")
@click.option("--free", multiple=True, metavar="NAME",
              help="Estimate one that is fixed; emd: a delay of the EMG; reflex: all of a stretch "
              "reflex.")  # fmt: skip
@click.option("--start", multiple=True, metavar="NAME=VALUE", help="Start somewhere else.")
@click.option("--bound", multiple=True, metavar="NAME=LOW:HIGH", help="Other bounds.")
@click.option("--prior", multiple=True, metavar="NAME=MEDIAN:SPREAD",
              help="Known beforehand: SPREAD is the relative standard deviation.")  # fmt: skip
@click.option("--baseline", metavar="B.json", help="Compare SEM with simulations (snSEM).")
@click.option("--starts", metavar="N", help="Number of starts.  [default: 8]")
@click.option("--seed", metavar="N", help="Of the random starts.  [default: 0]")
@click.option(
    "--strict", is_flag=True, help="Refuse recordings in which `surae check` finds errors."
)
@click.option("--output", metavar="FIT.json", help="Write the fit.")
@click.option("--report", metavar="REPORT.html", help="Write the report; .pdf makes a PDF.")
@fit_options
@model_options
def command(
    recordings: tuple[str, ...],
    model: str,
    prepared: bool,
    fixed: tuple[str, ...],
    free: tuple[str, ...],
    start: tuple[str, ...],
    bound: tuple[str, ...],
    prior: tuple[str, ...],
    starts: str | None,
    seed: str | None,
    baseline: str | None,
    strict: bool,
    output: str | None,
    report: str | None,
    **options: Any,
) -> int:
    """Estimate a model's parameters from one recording, or jointly from several.

    REC is a CSV with named channels, or a TOML that maps the channels of other files.
    Ctrl-C stops the search: the best fit so far is shown and written.
    """
    held = assignments("--fixed", fixed)
    begin = assignments("--start", start)
    limits = pairs("--bound", bound, form="lower:upper", example="m=1:4")
    known = pairs("--prior", prior, form="median:spread", example="tau_rel=3:0.3")
    refuse_fixed("--start", tuple(begin), tuple(held))
    refuse_fixed("--bound", tuple(limits), tuple(held))
    settings = taken(options, tuple(held))
    freed, chosen = names("--free", free), given(options)
    count = whole_number("--starts", starts, least=1, most=_MOST_STARTS)
    number = whole_number("--seed", seed, least=0) or 0
    refuse_repeated(recordings)

    from surae.cli.progress import compilation_notice, work
    from surae.quality import check_recording
    from surae.recording import read
    from surae.report import check_report
    from surae.signals import prepare

    with work() as progress:
        inputs, quality = [], []
        for path in recordings:
            progress.describe(f"reading {path}")
            measured = read(path)
            progress.describe(f"preparing {path}")
            inputs.append(prepare(measured, prepared=prepared))
            progress.describe(f"checking {path}")
            quality.append(check_recording(measured))
            if strict:
                refuse_errors(path, quality[-1])
        check_outputs(
            {"--output": output, "--report": report},
            [*([] if baseline is None else [baseline]), *settings.mvc,
             *(file.path for one in inputs for file in one.files)],
        )  # fmt: skip
        check_report(report)
        prescribed = settings.prescribed(inputs, prepared)
        from surae.api import fit  # numba: only when the input is in order
        from surae.estimation import STARTS

        with compilation_notice():
            found = fit(
                prescribed,
                model,
                fixed=held,
                free=freed,
                start=begin,
                bounds=limits,
                priors=settings.priors(known),
                weights=settings.weighting,
                loss=settings.loss,
                baseline=baseline,
                starts=count or STARTS,
                seed=number,
                quality=quality,
                progress=progress.starts,
                **chosen,
            )
    return finish(found, output, report)


def refuse_errors(path: str, quality: "Quality") -> None:
    """Raise InputError where a recording has a finding that is an error."""
    wrong = [finding for finding in quality.findings if finding.severity == "error"]
    if wrong:
        rest = len(wrong) - 1
        more = f" (and {rest} more error{'s' if rest > 1 else ''})" if rest else ""
        raise InputError(
            f"{shown(path)}: {wrong[0].code}: {wrong[0].message} {wrong[0].advice}{more}"
        )


def finish(found: "Fit", output: str | None, report: str | None) -> int:
    """Write a fit, then show it: a closed pipe must not cost a result. Returns the exit code."""
    from surae.cli.findings import show_short
    from surae.cli.screen import show_fit, show_line

    if output is not None:
        found.save(output)
    show_fit(found)
    for one in found.quality:
        show_short(one)
    if output is not None:
        show_line(f"fit: {shown(output)}")
    if report is not None:
        found.report(report)
        show_line(f"report: {shown(report)}")
    if found.result.starts[-1].outcome == "interrupted":
        click.echo(
            "surae: stopped by the user; the best fit so far is shown"
            + (" and written" if output is not None else ""),
            err=True,
        )
        return 130
    if found.status == "failed":
        click.echo(f"surae: the fit failed: {found.message}", err=True)
        return 1
    return 0
