"""The models and their tendons: Tables 1 and 2, Figures 10, 39, 44 and 45.

`trials` simulates, `claims` judges, `figures` draws.
"""

from surae.model import MODELS
from surae.model.parameters import Parameter
from surae.reproduction.chapter import Context, Result, Section, Table
from surae.reproduction.tendons.claims import findings
from surae.reproduction.tendons.figures import drawings
from surae.reproduction.tendons.trials import errors


def run(context: Context) -> Result:
    """Tabulate the parameters, integrate one trial both ways, judge and draw."""
    context.progress("tendons", 0, 2)
    measured = errors(quick=context.quick)
    context.progress("tendons", 1, 2)
    result = Result(
        findings=findings(measured),
        figures=drawings(),
        tables=(
            _parameters("table-1-left", "Table 1, left: the model of 2010", "muscle-2010"),
            _parameters("table-1-right", "Table 1, right: the muscle model [1.0]", "muscle"),
            _tendons(),
            Table(
                name="integrators",
                title="Torque of one chirped trial against the implicit scheme at "
                f"{measured.reference_hz:g} Hz",
                columns=("rate [Hz]", "scheme", "RMS error [% of the torque's RMS]"),
                rows=tuple(
                    (rate, scheme, round(e, 4)) for (scheme, rate), e in measured.of.items()
                ),
            ),
        ),
        notes=(
            "Both integrators solve the same equations (18) to (30) on the same trial of a typical "
            "healthy subject: multiple holds with a chirp of 0.2 rad and 0.5, part-passive. "
            "The tendon's strain ε0 is in metres, as the printed equations take it.",
        ),
    )
    context.progress("tendons", 2, 2)
    return result


def _parameters(name: str, title: str, model: str) -> Table:
    return Table(
        name=name,
        title=title,
        columns=("parameter", "unit", "meaning", "part", "start", "lower", "upper"),
        rows=tuple(_row(p) for p in MODELS[model].parameters),
    )


def _row(p: Parameter) -> tuple[str | float, ...]:
    return p.name, p.unit, p.meaning, p.group, p.start, p.lower, p.upper


def _tendons() -> Table:
    from surae.model.tendon import SLACK_TIB, SLACK_TRI

    start = {p.name: p.start for p in MODELS["muscle-tendon"].parameters}
    rows: tuple[tuple[str, str, float, float], ...] = (
        ("lt0", "m", SLACK_TRI, SLACK_TIB),
        *(
            (symbol, unit, start[f"{name}_tri"], start[f"{name}_tib"])
            for symbol, unit, name in (
                ("ε0", "m", "dlt"),
                ("Fmax", "N", "fmax"),
                ("F̄toe", "-", "pt"),
                ("ktoe", "-", "kt"),
            )
        ),
    )
    return Table(
        name="table-2",
        title="Table 2: the tendons",
        columns=("parameter", "unit", "triceps surae", "tibialis anterior"),
        rows=rows,
    )


SECTION = Section(
    name="tendons",
    title="Models and tendons",
    source="2.3, 2.4, 4.4, appendix B; Tables 1 and 2, Figures 10, 39, 44 and 45",
    run=run,
)
