"""`surae bootstrap`."""

from typing import TYPE_CHECKING

import click

from surae.cli.options import MOST_FITS, SEED, WORKERS, Number, Whole
from surae.cli.paths import check_outputs
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import Bootstrap


@click.command("bootstrap")
@click.argument("fitted", metavar="FIT.json")
@click.option("--replicates", type=Whole(1, MOST_FITS), default=1000, show_default=True,
              metavar="N", help="Fits to make.")  # fmt: skip
@SEED
@click.option("--block", type=Number(), metavar="SECONDS",
              help="Length of the blocks.  [default: from the residual]")  # fmt: skip
@click.option(
    "--workers", type=WORKERS, metavar="N", help="Fits at a time.  [default: all processors]"
)
@click.option("--output", metavar="B.json", help="Write the intervals; makes it resumable.")
def command(
    fitted: str,
    replicates: int,
    seed: int,
    block: float | None,
    workers: int | None,
    output: str | None,
) -> int:
    """Find intervals by fitting again and again with blocks of the residual as the noise.

    With --output B.json, every replicate is added to B.json.replicates as it is done: the same
    command goes on where it was stopped, and a larger --replicates adds to what is there.
    """
    store = None if output is None else f"{output}.replicates"
    check_outputs({"--output": output, "replicates": store}, [fitted])

    from surae.api import bootstrap, load  # numba: only when the command is in order
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    with work() as progress, compilation_notice():

        def told(done: int, total: int) -> None:
            progress.describe(f"bootstrap: {done} of {total}")

        drawn = bootstrap(
            fit,
            replicates=replicates,
            seed=seed,
            block_s=block,
            workers=workers,
            store=store,
            progress=told,
        )

    from surae.cli.screen import show_line, show_table

    if output is not None:
        drawn.save(output)
    show_table(*_table(drawn))
    blocks = ", ".join(f"{length:.3g}" for length in drawn.block_s)
    again = f", {drawn.resumed} of them made before" if drawn.resumed else ""
    failed = f", {drawn.failed} without a fit" if drawn.failed else ""
    show_line(
        f"{len(drawn.values)} replicates{again}{failed}; blocks of {blocks} s; "
        f"{drawn.seconds:.1f} s"
    )
    if output is not None:
        show_line(f"bootstrap: {shown(output)}")
    if drawn.missing:
        kept = f"; the same command goes on from {shown(str(store))}" if store else ""
        click.echo(f"surae: stopped, {drawn.missing} replicates missing{kept}", err=True)
        return 130
    return 0


def _table(drawn: "Bootstrap") -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    from surae.api import estimate

    rows: list[tuple[str, ...]] = []
    for p in drawn.parameters.values():
        text = estimate(p.value, p.sem, p.ci95)
        rows.append((p.name, text.value, text.interval, text.sem, p.unit))
    return ("parameter", "value", "95 % interval", "SEM", "unit"), rows
