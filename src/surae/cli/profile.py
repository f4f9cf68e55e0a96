"""`surae profile`."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from surae.cli.options import factor, whole_number
from surae.cli.paths import check_outputs
from surae.errors import InputError
from surae.files import shown, write_atomic

if TYPE_CHECKING:
    from surae.assessment.likelihood.profiles import Profiles

#: More threads than this are a slip of the keyboard.
_MOST_WORKERS = 1000


@click.command("profile")
@click.argument("fitted", metavar="FIT.json")
@click.argument("names", metavar="[NAME…]", nargs=-1)
@click.option("--workers", metavar="N", help="Profiles at a time.  [default: all processors]")
@click.option("--variance-inflation", metavar="F",
              help="Factor on the variance of the noise.  [default: each parameter's own, what the "
              "residual's correlation asks for]")  # fmt: skip
@click.option("--output", metavar="PROFILE.json", help="Write the profiles; makes it resumable.")
@click.option("--figure", metavar="PROFILE.png|svg", help="Draw them.")
def command(
    fitted: str,
    names: tuple[str, ...],
    workers: str | None,
    variance_inflation: str | None,
    output: str | None,
    figure: str | None,
) -> int:
    """Find how far each parameter can move before the fit gets worse.

    The profile holds a parameter at value after value and fits all others again: its 95 % interval
    need not be symmetric, and may be open where the recordings set no limit. Without names, every
    parameter that was estimated. Ctrl-C keeps the profiles that are complete; with --output P.json
    they are also in P.json.profiles, and the same command makes only the others.
    """
    count = whole_number("--workers", workers, least=1, most=_MOST_WORKERS)
    inflation = factor("--variance-inflation", variance_inflation)
    kind = "" if figure is None else Path(figure).suffix.lower()
    if figure is not None and kind not in (".png", ".svg"):
        raise InputError(f"--figure: {shown(figure)} must end in .png or .svg")
    store = None if output is None else f"{output}.profiles"
    check_outputs({"--output": output, "--figure": figure, "profiles": store}, [fitted])

    from surae.api import load, profile  # numba: only when the command is in order
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    with work() as progress, compilation_notice():
        progress.describe("profiles")

        def told(name: str, done: int, total: int) -> None:
            progress.describe(f"profiles: {done} of {total} done, {name} last")

        found = profile(
            fit,
            names or None,
            variance_inflation=inflation,
            workers=count,
            store=store,
            progress=told,
        )

    from surae.cli.screen import show_line

    if output is not None:
        found.save(output)
    drawn = figure is not None and bool(found.profiles)
    if figure is not None and drawn:
        from surae.report.figures import png, svg
        from surae.report.figures.profile import profile_figure

        picture = profile_figure(tuple(found.profiles.values()), found.noise)
        write_atomic(figure, svg(picture) if kind == ".svg" else png(picture))
    for line in _table(found):
        show_line(line)
    if output is not None:
        show_line(f"profiles: {shown(output)}")
    if figure is not None and drawn:
        show_line(f"figure: {shown(figure)}")
    if found.missing:
        done = "complete profiles are shown" + (" and written" if output is not None else "")
        left = ", ".join(found.missing)
        click.echo(f"surae: stopped by the user; {done}; not done: {left}", err=True)
        return 130
    return 0


def _table(found: "Profiles") -> list[str]:
    """Intervals of profile and covariance beside each other, then what is to be said of them."""
    from surae.report.digits import NONE, significant

    heads = ("parameter", "value", "95 % profile", "95 % covariance", "unit", "status")
    rows = [heads]
    for one in found.profiles.values():
        low, high = ("open" if end is None else significant(end, 4) for end in one.interval)
        parabola = one.from_covariance
        rows.append(
            (
                one.name,
                significant(one.value, 4),
                f"{low} … {high}",
                NONE if parabola is None else " … ".join(significant(end, 4) for end in parabola),
                one.unit,
                one.status,
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(
            cell.rjust(width) if 0 < i < 4 else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    notes = [
        f"{one.name}: {one.message}"
        for one in found.profiles.values()
        if one.status != "closed" or one.message != "both ends found"
    ]
    if found.noise:
        notes.append(found.noise)
    return [*lines, "", *notes, f"{len(found.profiles)} profiles in {found.seconds:.1f} s"]
