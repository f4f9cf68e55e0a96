"""`surae reproduce`."""

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from surae.base.errors import InputError
from surae.base.files import read_bytes, shown, write_atomic
from surae.cli.options import workers_option
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_line, show_table

if TYPE_CHECKING:
    from surae_thesis.section import Chapters


@click.command("reproduce")
@click.option(
    "--output", default="reproduction", show_default=True, metavar="DIR", help="Where to write."
)
@click.option("--only", multiple=True, metavar="NAME", help="A section; may be given repeatedly.")
@click.option("--quick", is_flag=True, help="Fewer fits of everything: minutes.")
@click.option(
    "--seed",
    type=click.IntRange(0, 999_999_999),
    default=1,
    show_default=True,
    metavar="N",
    help="Of everything that is random.",
)
@workers_option("Processes", many="one for each core")
@click.option("--markdown", metavar="FILE.md", help="Write the verdicts there too.")
def command(
    output: str,
    only: tuple[str, ...],
    quick: bool,
    seed: int,
    workers: int | None,
    markdown: str | None,
) -> None:
    """Compute the thesis's results again: each claim beside ours, with a verdict.

    The folder holds a page with every claim, figure and table, a PDF where typst is installed, and
    the verdicts as Markdown. A stopped run goes on where it was. With --only, the page and FILE.md
    keep their other sections; each says when and by which version it was computed.
    """
    if not output:
        raise InputError("--output is empty; give the name of a folder")
    if markdown is not None:
        from surae.cli.paths import check_outputs

        check_outputs({"--markdown": markdown}, ())
    from surae.base.threads import cores
    from surae_thesis.section import Context, chapters, make_folder, sections

    chosen = sections(only)

    folder = Path(output)
    make_folder(folder)

    from surae_thesis.reproduction import reproduce
    from surae_thesis.verdicts import markdown as verdicts

    begin = time.perf_counter()
    try:
        with work() as progress, compilation_notice():
            context = Context(
                folder=folder,
                seed=seed,
                quick=quick,
                workers=workers or cores(),
                progress=progress.parts,
            )
            written = reproduce(
                context, chosen, lambda section: progress.describe(f"section {section.name}")
            )
    except KeyboardInterrupt:
        raise StoppedError(
            f"stopped by the user; what is computed is kept in {shown(folder)}: run the same "
            "command to go on"
        ) from None
    there = chapters(context)
    _show(there)
    if markdown is not None:
        earlier = read_bytes(markdown).decode() if Path(markdown).is_file() else ""
        write_atomic(markdown, verdicts(there, earlier))
    show_line(
        f"{', '.join(section.name for section in chosen)}: {time.perf_counter() - begin:.0f} s"
    )
    show_line(f"page: {shown(written[0])}")
    for path in written[1:]:
        show_line(f"      {shown(path)}")


def _show(there: "Chapters") -> None:
    """A table of verdicts for each section, and how many there are."""
    from surae_thesis.section import counts

    for section, result in there:
        show_line(f"{section.title} ({section.source})")
        show_table(
            ("claim", "thesis", "ours", "verdict"),
            [
                (f.id, f.number, next(iter(f.ours.values()), (False, "–"))[1], f.verdict)
                for f in result.findings
            ],
        )
    total = counts(there)
    show_line(", ".join(f"{number} {verdict}" for verdict, number in total.items()))
