"""`surae bootstrap`."""

from typing import TYPE_CHECKING

import click

from surae.cli.options import number, whole_number
from surae.cli.paths import check_outputs
from surae.files import shown

if TYPE_CHECKING:
    from surae.assessment.resampling.bootstrap import Bootstrap

#: More replicates and threads than these are slips of the keyboard.
_MOST, _MOST_WORKERS = 1_000_000, 1000


@click.command("bootstrap")
@click.argument("fitted", metavar="FIT.json")
@click.option("--replicates", metavar="N", help="Fits to make.  [default: 1000]")
@click.option("--seed", metavar="N", help="Of the random blocks.  [default: 0]")
@click.option("--block", metavar="SECONDS",
              help="Length of the blocks.  [default: from the residual]")  # fmt: skip
@click.option("--workers", metavar="N", help="Fits at a time.  [default: all processors]")
@click.option("--output", metavar="B.json", help="Write the intervals; makes it resumable.")
def command(
    fitted: str,
    replicates: str | None,
    seed: str | None,
    block: str | None,
    workers: str | None,
    output: str | None,
) -> int:
    """Find intervals by fitting again and again with blocks of the residual as the noise.

    With --output B.json, every replicate is added to B.json.replicates as it is done: the same
    command goes on where it was stopped, and a larger --replicates adds to what is there.
    """
    count = whole_number("--replicates", replicates, least=1, most=_MOST)
    begin = whole_number("--seed", seed, least=0) or 0
    threads = whole_number("--workers", workers, least=1, most=_MOST_WORKERS)
    length = None if block is None else number(f"--block {block}", block)
    store = None if output is None else f"{output}.replicates"
    check_outputs({"--output": output, "replicates": store}, [fitted])

    from surae.api import bootstrap, load  # numba: only when the command is in order
    from surae.assessment.resampling.bootstrap import REPLICATES
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    with work() as progress, compilation_notice():

        def told(done: int, total: int) -> None:
            progress.describe(f"bootstrap: {done} of {total}")

        found = bootstrap(
            fit,
            replicates=count or REPLICATES,
            seed=begin,
            block_s=length,
            workers=threads,
            store=store,
            progress=told,
        )

    from surae.cli.screen import show_line, show_table

    if output is not None:
        found.save(output)
    show_table(*_table(found))
    blocks = ", ".join(f"{one:.3g}" for one in found.block_s)
    again = f", {found.resumed} of them made before" if found.resumed else ""
    failed = f", {found.failed} without a fit" if found.failed else ""
    show_line(
        f"{len(found.values)} replicates{again}{failed}; blocks of {blocks} s; "
        f"{found.seconds:.1f} s"
    )
    if output is not None:
        show_line(f"bootstrap: {shown(output)}")
    if found.missing:
        kept = f"; the same command goes on from {shown(str(store))}" if store else ""
        click.echo(f"surae: stopped, {found.missing} replicates missing{kept}", err=True)
        return 130
    return 0


def _table(found: "Bootstrap") -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    from surae.report.digits import estimate

    rows: list[tuple[str, ...]] = []
    for p in found.parameters.values():
        text = estimate(p.value, p.sem, p.ci95)
        rows.append((p.name, text.value, text.interval, text.sem, p.unit))
    return ("parameter", "value", "95 % interval", "SEM", "unit"), rows
