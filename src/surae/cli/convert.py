"""`surae convert`."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.base.files import shown
from surae.cli.options import MAPPING, corrections
from surae.cli.paths import check_outputs
from surae.cli.progress import work
from surae.cli.screen import show_line

_SUFFIXES = (".h5", ".hdf5", ".csv", ".parquet")
#: Those that keep everything.
_WHOLE = (".h5", ".hdf5")


@click.command("convert")
@click.argument("recording", metavar="IN")
@click.argument("output", metavar="OUT")
@MAPPING
@corrections
@click.option(
    "--prepare",
    "prepared",
    is_flag=True,
    help="Filter and resample as a fit does: one time axis for all.",
)
def command(
    recording: str, output: str, mapping: str | None, prepared: bool, corrections: dict[str, Any]
) -> None:
    """Write a recording in another format, in SI units with our signs.

    OUT ends in .h5, which keeps everything, or in .csv or .parquet, which have one time axis.
    """
    suffix = Path(output).suffix.lower()
    if suffix not in _SUFFIXES:
        raise InputError(
            f"{shown(output)}: {suffix or 'no ending'} is not written; end it in .h5, "
            ".csv or .parquet"
        )
    check_outputs({"OUT": output}, [recording])

    with work() as progress:
        progress.describe(f"reading {recording}")
        measured = api.read(recording, mapping=mapping, **corrections)
        check_outputs({"OUT": output}, [file.path for file in measured.files])
        if prepared:
            progress.describe(f"preparing {recording}")
            measured = _prepared(measured)
        # Films that have not a frame at every sample of the first channel.
        time = next(iter(measured.channels.values())).time.tolist()
        films = {} if suffix in _WHOLE else measured.films
        left_out = [role for role, film in films.items() if film.time.tolist() != time]
        if left_out:
            kept = {role: c for role, c in measured.channels.items() if role not in left_out}
            measured = replace(measured, channels=kept)
        progress.describe(f"writing {output}")
        if suffix in _WHOLE:
            api.write_hdf5(output, measured)
        elif suffix == ".parquet":
            api.write_parquet(output, measured)
        else:
            api.shared_time(measured, f"cannot write {shown(output)}")
            name = " ".join(measured.name.split())
            api.write_csv(
                output, api.csv_columns(measured), [f"name: {name}", f"emg: {measured.emg}"]
            )

    again = "; fit it with --prepared, or it is filtered again" if prepared else ""
    show_line(f"converted: {shown(output)}{again}")
    lost = [name for name in ("fixed", "prepare", "side", "device") if getattr(measured, name)]
    lost += left_out
    if lost and suffix not in _WHOLE:
        show_line(f"not kept in this format: {', '.join(lost)}; .h5 keeps all")


def _prepared(recording: "api.Recording") -> "api.Recording":
    """The recording as a model reads it; films as they came, on their own clock."""
    made = api.recording_of(api.prepare(recording), derivatives=True)
    channels = {
        role: replace(
            channel,
            source=f"prepared from {recording.channels[role].source}"
            if role in recording.channels
            else "computed from the angle",
        )
        for role, channel in made.channels.items()
    }
    return replace(
        made, channels={**channels, **recording.films}, side=recording.side, device=recording.device
    )
