"""`surae measures`."""

import click

from surae import api
from surae.cli.options import NUMBER
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files, show_line


@click.command("measures")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.option(
    "--angle",
    "angles",
    type=NUMBER,
    multiple=True,
    metavar="DEG",
    help="Where torque and stiffness are given; may be repeated.  [default: −10, 0, 10]",
)
@click.option("--norms", metavar="N.toml", help="Your own norms in place of published ones.")
@click.option("--output", metavar="M.json|csv", help="Write the measures.")
def command(fitted: str, angles: tuple[float, ...], norms: str | None, output: str | None) -> None:
    """Compute stiffness, torque and more of a fitted leg in Nm and degrees, with intervals.

    Torque and stiffness at rest, what relaxes, how strong and how fast the muscles are, and what
    the torque of the recordings is made of. Dorsiflexion is positive.
    """
    check_outputs({"--output": output}, [fitted], spare_fits=True)

    fit = api.fit_of(fitted)
    beside = api.read_norms(norms, fit.result.problem.options.anatomy)
    with compilation_notice():
        measures = fit.measures(angles) if angles else fit.measures()

    if output is not None:
        measures.save(output)
    show_answer(measures.as_table())
    for place in api.placed(measures, beside):
        norm = place.norm
        show_line(
            f"{norm.measure}: {place.text} of {norm.group} (n = {norm.n}, "
            f"{norm.condition}) lie below; {norm.reference}"
        )
    show_files({"measures": output})
