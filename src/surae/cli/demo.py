"""`surae demo`."""

from pathlib import Path

import click

from surae.api import fit
from surae.cli.screen import fit_progress, notice_compilation, show_fit
from surae.errors import InputError


@click.command("demo")
@click.option("--output", default="demo", show_default=True, metavar="DIR", help="Where to write.")
def command(output: str) -> int:
    """Fit an embedded virtual subject: protocol, noisy trial, fit, table and report.

    The subject's true parameters are known, and are written beside the fit.
    """
    from surae.protocol import Protocol, generate
    from surae.studies import virtual_subject, virtual_trial

    folder = Path(output)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {output}: {error.strerror}") from None
    notice_compilation()
    subject = virtual_subject(seed=1)
    protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5)
    trial = virtual_trial(subject, generate(protocol))
    with fit_progress() as progress:
        found = fit(trial, progress=progress)
    show_fit(found)
    inside = sum(
        p.ci95 is not None and p.ci95[0] <= subject.parameters[p.name] <= p.ci95[1]
        for p in found.parameters.values()
    )
    click.echo(f"{inside} of {len(found.parameters)} true values lie in their 95 % interval")
    found.save(folder / "fit.json")
    found.report(folder / "report.html")
    click.echo(f"report: {(folder / 'report.html').resolve()}")
    return 1 if found.status == "failed" else 0
