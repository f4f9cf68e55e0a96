"""`surae reproduce`."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from surae.cli.options import whole_number
from surae.errors import InputError
from surae.files import shown, write_atomic

if TYPE_CHECKING:
    from surae.reproduction.kept import Chapter

#: More workers than this on one computer are a slip of the keyboard.
_MOST_WORKERS = 1000


@click.command("reproduce")
@click.option(
    "--output", default="reproduction", show_default=True, metavar="DIR", help="Where to write."
)
@click.option("--only", multiple=True, metavar="NAME", help="A section; may be given repeatedly.")
@click.option("--quick", is_flag=True, help="Fewer fits of everything: minutes.")
@click.option(
    "--seed", default="1", show_default=True, metavar="N", help="Of everything that is random."
)
@click.option("--workers", metavar="N", help="Processes at a time.  [default: one for each core]")
@click.option("--markdown", metavar="FILE.md", help="Write the verdicts there too.")
def command(
    output: str,
    only: tuple[str, ...],
    quick: bool,
    seed: str,
    workers: str | None,
    markdown: str | None,
) -> int:
    """Compute the thesis's results again: each claim beside ours, with a verdict.

    The folder holds a page with every claim, figure and table, a PDF where typst is installed, and
    the verdicts as CSV and Markdown. A stopped run goes on where it was.
    """
    number = whole_number("--seed", seed, least=0, most=999_999_999)
    count = whole_number("--workers", workers, least=1, most=_MOST_WORKERS)
    if not output:
        raise InputError("--output is empty; give the name of a folder")
    if markdown is not None:
        from surae.cli.paths import check_outputs

        check_outputs({"--markdown": markdown}, ())
    from surae.reproduction.registry import sections

    chosen = sections(only)

    from surae.reproduction.chapter import Context, cores
    from surae.reproduction.run import make_folder

    folder = Path(output)
    make_folder(folder)

    from surae.cli.progress import compilation_notice, work
    from surae.cli.screen import show_line
    from surae.reproduction.kept import chapters
    from surae.reproduction.output import markdown as verdicts
    from surae.reproduction.run import reproduce

    begin = time.perf_counter()
    try:
        with work() as progress, compilation_notice():
            context = Context(
                folder=folder,
                seed=number or 0,
                quick=quick,
                workers=count or cores(),
                progress=progress.parts,
            )
            written = reproduce(
                context, chosen, lambda section: progress.describe(f"section {section.name}")
            )
    except KeyboardInterrupt:
        click.echo(
            f"surae: stopped by the user; what is computed is kept in {shown(folder)}: run the "
            "same command to go on",
            err=True,
        )
        return 130
    found = chapters(context)
    _show(found)
    if markdown is not None:
        write_atomic(markdown, verdicts(found))
    show_line(f"{', '.join(one.name for one in chosen)}: {time.perf_counter() - begin:.0f} s")
    show_line(f"page: {shown(written[0])}")
    for path in written[1:]:
        show_line(f"      {shown(path)}")
    return 0


def _show(found: "Sequence[Chapter]") -> None:
    """A table of verdicts for each section, and how many there are."""
    from surae.cli.screen import show_line, show_verdicts
    from surae.reproduction.kept import counts

    for chapter in found:
        show_line(f"{chapter.title} ({chapter.source})")
        show_verdicts(
            ("claim", "thesis", "ours", "verdict"),
            [
                (one.claim.name, one.claim.number, one.ours or "–", one.verdict)
                for one in chapter.findings
            ],
        )
    total = counts(found)
    show_line(", ".join(f"{number} {verdict}" for verdict, number in total.items()))
