"""Help of a command with many options: these stand in groups, the usual ones first."""

import click

#: What a group of options is called, and its options.
GROUPS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "Results",
        ("output", "report", "language", "before", "figure", "width", "workers", "strict"),
    ),
    ("How files are read", ("mapping", "wrap", "scale", "offset", "sign", "swap", "mvc")),
    (
        "What of the signals is fitted",
        (
            "exclude",
            "weight",
            "weight-peaks",
            "peaks-of",
            "normalise",
            "prepared",
            "filter",
        ),
    ),
    (
        "What is estimated",
        (
            "model",
            "fixed",
            "free",
            "start",
            "bound",
            "prior",
            "priors",
            "nuisances",
            "knowledge",
            "angle-zero-sd",
        ),
    ),
    ("How it is searched", ("seed", "starts", "loss")),
    (
        "The model’s own",
        (
            "joint",
            "geometry",
            "geometry-of",
            "tendon-strain",
            "integrator",
            "theta-foot",
            "vmax-factor",
            "x-ref-tri",
            "x-ref-tib",
        ),
    ),
)
_OTHERS = "Others"


class Grouped(click.Command):
    """A command whose help has its options in groups."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options, group by group; what is in none comes last."""
        rows: dict[str, list[tuple[str, str]]] = {}
        of = {name: heading for heading, names in GROUPS for name in names}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                name = max(param.opts, key=len).lstrip("-")
                rows.setdefault(of.get(name, _OTHERS), []).append(record)
        for heading in (*(heading for heading, _ in GROUPS), _OTHERS):
            if heading in rows:
                with formatter.section(heading):
                    formatter.write_dl(rows[heading])
