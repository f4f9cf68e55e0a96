"""`surae convert`."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from surae.cli.paths import check_outputs
from surae.errors import InputError
from surae.files import shown

if TYPE_CHECKING:
    from surae.recording import Recording

_SUFFIXES = (".h5", ".hdf5", ".csv", ".sto")


@click.command("convert")
@click.argument("recording", metavar="IN")
@click.argument("output", metavar="OUT")
@click.option("--prepare", "prepared", is_flag=True,
              help="Filter and resample as a fit does: one time axis for all.")  # fmt: skip
def command(recording: str, output: str, prepared: bool) -> None:
    """Write a recording in another format, in SI units with our signs.

    OUT ends in .h5 (keeps everything), .csv or .sto (one time axis), or is a new folder, which is
    written as BIDS: BDF at 24 bits with its sidecars.
    """
    suffix = Path(output).suffix.lower()
    if suffix not in ("", *_SUFFIXES):
        raise InputError(
            f"{shown(output)}: {suffix} is not written; end it in .h5, .csv or .sto, or give the "
            "name of a new folder (BIDS)"
        )
    if suffix:
        check_outputs({"OUT": output}, [recording])

    from surae.cli.progress import work
    from surae.recording import columns, read, write_bids, write_csv, write_hdf5, write_sto
    from surae.recording.writing import shared_time

    with work() as progress:
        progress.describe(f"reading {recording}")
        one = read(recording)
        check_outputs({"OUT": output} if suffix else {}, [file.path for file in one.files])
        if prepared:
            progress.describe(f"preparing {recording}")
            one = _prepared(one)
        progress.describe(f"writing {output}")
        if suffix in (".h5", ".hdf5"):
            write_hdf5(output, one)
        elif suffix == ".csv":
            shared_time(one, f"cannot write {shown(output)}")
            name = " ".join(one.name.split())
            write_csv(output, columns(one), [f"name: {name}", f"emg: {one.emg}"])
        elif suffix == ".sto":
            write_sto(output, one)
        else:
            write_bids(output, one)

    from surae.cli.screen import show_line

    again = "; fit it with --prepared, or it is filtered again" if prepared else ""
    show_line(f"converted: {shown(output)}{again}")
    lost = [name for name in ("fixed", "prepare", "side", "device") if getattr(one, name)]
    if lost and suffix not in (".h5", ".hdf5"):
        show_line(f"not kept in this format: {', '.join(lost)}; .h5 keeps all")


def _prepared(recording: "Recording") -> "Recording":
    """The recording as a model reads it."""
    from dataclasses import replace

    from surae.recording import MUSCLES, Channel, Recording
    from surae.signals import prepare
    from surae.units import SI

    inputs = prepare(recording)
    values = {
        "angle": inputs.angle,
        "torque": inputs.torque,
        **{
            f"emg_{muscle}": inputs.emg[:, i]
            for i, muscle in enumerate(MUSCLES)
            if muscle not in inputs.missing_emg
        },
        "angular_velocity": inputs.velocity,
        "angular_acceleration": inputs.acceleration,
    }
    channels = {
        role: Channel(
            role=role,
            time=inputs.time,
            values=signal,
            unit=inputs.emg_unit if role.startswith("emg_") else SI[role],
            source=f"prepared from {recording.channels[role].source}"
            if role in recording.channels
            else "computed from the angle",
        )
        for role, signal in values.items()
        if signal is not None
    }
    made = Recording(name=recording.name, channels=channels, emg="envelope", fixed=recording.fixed)
    return replace(made, side=recording.side, device=recording.device, files=recording.files)
