"""`surae export`."""

from pathlib import Path

import click

from surae import api
from surae.cli.export_bids import BidsOptions, bids_options, write_set
from surae.cli.export_into import IntoOptions, into_options, write_into
from surae.cli.export_predictor import PredictorOptions, predictor_options, write_predictor
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_files, show_line

#: Formats and how their files end; written out so that help comes at once.
_ENDINGS = {"osim": ".osim", "mjcf": ".xml"}
#: A program in C instead of a model's file: what it is, and what it is written in.
_PREDICTOR = ("predictor", "c")
#: A data set of recordings, of which the fit is a derivative.
_BIDS = "bids"


@click.command("export")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.option(
    "--to",
    type=click.Choice([*_ENDINGS, *_PREDICTOR, _BIDS]),
    required=True,
    help="OpenSim (4.5 or later), MuJoCo, a causal predictor as one file of C99, or EMG-BIDS.",
)
@click.option("--output", metavar="FILE", help="Model file to write.  [default: beside the fit]")
@into_options
@predictor_options
@bids_options
def command(
    fitted: str,
    to: str,
    output: str | None,
    into: IntoOptions,
    predictor: PredictorOptions,
    bids: BidsOptions,
) -> None:
    """Write the leg of a fit as a model for another simulator, a predictor in C, or a data set.

    A model's file says how far its torque is from surae's, and the parameters' intervals.
    With --into, the lines that change and a table of bounds are written beside it.
    """
    into.refuse_for(to)
    if to not in _PREDICTOR:
        predictor.refuse_for(to)
    if to != _BIDS:
        bids.refuse_for(to)
    if to in _PREDICTOR:
        write_predictor(fitted, output, predictor)
        return
    if to == _BIDS:
        write_set(fitted, output, bids)
        return
    path = output or str(Path(fitted).with_suffix(_ENDINGS[to]))
    if into.into is not None:
        write_into(fitted, to, path, into)
        return
    check_outputs({"--output": path}, [fitted], spare_fits=True)
    with compilation_notice():
        model = api.export(fitted, to=to)
    model.save(path)
    show_line(model.agreement)
    show_files({"model": path})
