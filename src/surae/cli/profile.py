"""`surae profile`."""

from typing import TYPE_CHECKING

import click

from surae.cli.options import INFLATION, WORKERS, Picture
from surae.cli.paths import check_outputs
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import Profiles


@click.command("profile")
@click.argument("fitted", metavar="FIT.json")
@click.argument("names", metavar="[NAME…]", nargs=-1)
@click.option("--workers", type=WORKERS, metavar="N",
              help="Profiles at a time.  [default: all processors]")  # fmt: skip
@INFLATION
@click.option("--output", metavar="PROFILE.json", help="Write the profiles; makes it resumable.")
@click.option("--figure", type=Picture(), metavar="PROFILE.svg|pdf|png", help="Draw them.")
def command(
    fitted: str,
    names: tuple[str, ...],
    workers: int | None,
    variance_inflation: float | None,
    output: str | None,
    figure: str | None,
) -> int:
    """Find how far each parameter can move before the fit gets worse.

    The profile holds a parameter at value after value and fits all others again: its 95 % interval
    need not be symmetric, and may be open where the recordings set no limit. Without names, every
    parameter that was estimated. Ctrl-C keeps the profiles that are complete; with --output P.json
    they are also in P.json.profiles, and the same command makes only the others.
    """
    store = None if output is None else f"{output}.profiles"
    check_outputs({"--output": output, "--figure": figure, "profiles": store}, [fitted])

    from surae.api import load, profile  # numba: only when the command is in order
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    with work() as progress, compilation_notice():
        progress.describe("profiles")

        def told(name: str, done: int, total: int) -> None:
            progress.describe(f"profiles: {done} of {total} done, {name} last")

        profiles = profile(
            fit,
            names or None,
            variance_inflation=variance_inflation,
            workers=workers,
            store=store,
            progress=told,
        )

    from surae.cli.screen import show_line, show_table

    if output is not None:
        profiles.save(output)
    drawn = figure is not None and bool(profiles.profiles)
    if figure is not None and drawn:
        from surae.api import profile_figure, write_figure

        write_figure(figure, profile_figure(tuple(profiles.profiles.values()), profiles.noise))
    show_table(*_table(profiles))
    for line in _notes(profiles):
        show_line(line)
    if output is not None:
        show_line(f"profiles: {shown(output)}")
    if figure is not None and drawn:
        show_line(f"figure: {shown(figure)}")
    if profiles.missing:
        done = "complete profiles are shown" + (" and written" if output is not None else "")
        left = ", ".join(profiles.missing)
        click.echo(f"surae: stopped by the user; {done}; not done: {left}", err=True)
        return 130
    return 0


def _table(profiles: "Profiles") -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Intervals of profile and covariance beside each other."""
    from surae.api import NO_NUMBER, significant

    heads = ("parameter", "value", "95 % profile", "95 % covariance", "status", "unit")
    rows: list[tuple[str, ...]] = []
    for p in profiles.profiles.values():
        low, high = ("open" if end is None else significant(end, 4) for end in p.interval)
        ends = p.from_covariance
        parabola = NO_NUMBER if ends is None else " … ".join(significant(end, 4) for end in ends)
        rows.append(
            (p.name, significant(p.value, 4), f"{low} … {high}", parabola, str(p.status), p.unit)
        )
    return heads, rows


def _notes(profiles: "Profiles") -> list[str]:
    """What is to be said of them."""
    notes = [
        f"{p.name}: {p.message}"
        for p in profiles.profiles.values()
        if p.status != "closed" or p.message != "both ends found"
    ]
    if profiles.noise:
        notes.append(profiles.noise)
    return [*notes, f"{len(profiles.profiles)} profiles in {profiles.seconds:.1f} s"]
