"""`surae measures`."""

from typing import TYPE_CHECKING

import click

from surae.cli.options import LANGUAGE, Number, figure_options
from surae.cli.paths import check_outputs, spare_fits
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import Measures


@click.command("measures")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.option("--angle", "angles", type=Number(), multiple=True, metavar="DEG",
              help="Where torque and stiffness are told; may be repeated.  "
              "[default: −10, 0, 10]")  # fmt: skip
@click.option("--norms", metavar="N.toml", help="Your own norms in place of published ones.")
@click.option("--output", metavar="M.json|csv", help="Write the measures.")
@click.option("--report", metavar="M.html", help="Write the page for clinicians.")
@LANGUAGE
@figure_options
def command(
    fitted: str,
    angles: tuple[float, ...],
    norms: str | None,
    output: str | None,
    report: str | None,
    language: str,
    figure: str | None,
    width: float,
) -> None:
    """Tell what a fit says of the leg in a clinician's units, and how far it may be believed.

    Torque and stiffness at rest, what relaxes, how strong and how fast the muscles are, and what
    the torque of the recordings is made of. Dorsiflexion is positive.
    """
    outputs = {"--output": output, "--report": report, "--figure": figure}
    check_outputs(outputs, [fitted])
    spare_fits(outputs)

    from surae.api import (
        check_clinical_page,
        fit_of,
        placed,
        read_norms,
        write_clinical_page,
        write_curve_figure,
    )

    check_clinical_page(report)
    beside = read_norms(norms)
    from surae.cli.progress import compilation_notice

    fit = fit_of(fitted)
    with compilation_notice():
        told = fit.measures(angles) if angles else fit.measures()

    from surae.cli.screen import show_adequacy, show_line, show_verdicts

    if output is not None:
        told.save(output)
    show_adequacy(told.adequacy)
    show_verdicts(*_table(told), numbers=("value", "95 % interval"))
    for measure in told.values():
        if measure.value is None:
            show_line(f"{measure.name}: {measure.note}")
    for place in placed(told, beside):
        norm = place.norm
        show_line(
            f"{norm.measure}: {place.text} of {norm.group} (n = {norm.n}, "
            f"{norm.condition}) lie below; {norm.reference}"
        )
    if output is not None:
        show_line(f"measures: {shown(output)}")
    if report is not None:
        angle = angles[0] if len(angles) == 1 else 10.0
        write_clinical_page(report, [fit], language=language, angle=angle, norms=norms)
        show_line(f"report: {shown(report)}")
    if figure is not None:
        write_curve_figure(figure, fit, language=language, norms=norms, width=width)
        show_line(f"figure: {shown(figure)}")


def _table(told: "Measures") -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    from surae.api import estimate

    heads = ("measure", "value", "95 % interval", "unit", "note", "verdict")
    rows: list[tuple[str, ...]] = []
    for m in told.values():
        if m.value is None:
            continue
        sem = None if m.ci95 is None else (m.ci95[1] - m.ci95[0]) / 3.92
        text = estimate(m.value, sem, m.ci95)
        rows.append((m.name, text.value, text.interval, m.unit, m.note, str(m.verdict)))
    return heads, rows
