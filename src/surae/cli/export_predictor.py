"""`surae export --to predictor`: a fit's torque while it is measured, as one file of C99."""

from dataclasses import dataclass
from pathlib import Path

import click

from surae import api
from surae.base.errors import InputError
from surae.cli.option_records import as_record, refuse
from surae.cli.options import Typed, number
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_files, show_line

#: Steps in a second by default [Hz].
_RATE_HZ = 1000.0


@dataclass(frozen=True, slots=True)
class PredictorOptions:
    """What only a predictor is told."""

    rate: float | None  #: Steps in a second [Hz]; None: not given.
    emg: str | None  #: How EMG comes.
    precision: str | None  #: Of all numbers.
    even_if_doubtful: bool  #: Whether a fit that is not adequate has one too.

    def refuse_for(self, to: str) -> None:
        """Refuse them where no predictor is written."""
        given: dict[str, object] = {
            "--rate": self.rate is not None,
            "--emg": self.emg is not None,
            "--precision": self.precision is not None,
            "--even-if-doubtful": self.even_if_doubtful,
        }
        refuse(given, to)


#: The options of a predictor, as one argument `predictor`.
predictor_options = as_record(
    "predictor",
    PredictorOptions,
    click.option(
        "--rate",
        type=Typed(number),
        metavar="HZ",
        help=f"Predictor: samples in a second.  [default: {_RATE_HZ:g}]",
    ),
    click.option(
        "--emg",
        type=click.Choice(["raw", "envelope"]),
        help="Predictor: how EMG comes.  [default: as it came to the fit]",
    ),
    click.option(
        "--precision",
        type=click.Choice(["double", "float"]),
        help="Predictor: of its numbers.  [default: double]",
    ),
    click.option(
        "--even-if-doubtful",
        is_flag=True,
        help="Predictor: of a fit that is not adequate too.",
    ),
)


def write_predictor(fitted: str, output: str | None, options: PredictorOptions) -> None:
    """Write the predictor's C file, and its header beside it."""
    path = Path(output or Path(fitted).with_suffix(".c"))
    if path.is_dir():
        path /= "surae_predictor.c"
    elif path.suffix != ".c":
        raise InputError(f"--output {path}: name a file that ends in .c, or a folder that is there")
    header = path.with_suffix(".h")
    outputs = {"--output": str(path), "the header": str(header)}
    check_outputs(outputs, [fitted], spare_fits=True)
    with compilation_notice():
        predictor = api.fit_of(fitted).predictor(
            options.rate or _RATE_HZ,
            emg=options.emg,  # type: ignore[arg-type]
            even_if_doubtful=options.even_if_doubtful,
        )
        source = predictor.to_c(path.stem, precision=options.precision or "double")
    source.save(path.parent)
    show_line(predictor.account)
    show_files({"predictor": str(path), "header": str(header)})
