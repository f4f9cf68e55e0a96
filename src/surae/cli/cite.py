"""`surae cite`."""

import click

from surae import api
from surae.cli.screen import show_line


@click.command("cite")
@click.argument("fitted", metavar="[FIT.json]", required=False)
@click.option("--bibtex", is_flag=True, help="BibTeX entries instead of lines.")
def command(fitted: str | None, bibtex: bool) -> None:
    """Print the papers behind the methods that a fit used.

    Without a fit: what every use of surae stands on.
    """
    cited = api.always_cited()
    if fitted is not None:
        fit = api.load(fitted)
        cited = api.cited_by(fit.result, fit.assessment)
    if bibtex:
        for entry in cited:
            show_line(f"% {entry.reason}")
            show_line(entry.reference.bibtex)
        return
    for entry in cited:
        show_line(f"{entry.reason}: {entry.reference.text}")
