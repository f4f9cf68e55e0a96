"""A rehearsal without a person: trials as a person would make them, a line of JSON for each."""

import json
import time
from typing import Unpack

import click

from surae.base.errors import ComputationError, InputError
from surae.base.files import PathLike
from surae_workbench.live.rehearsal import FAULTS
from surae_workbench.live.room import Room, RoomOptions

#: Streams are waited for so long [s]: the first time, all is compiled.
_PATIENCE = 180.0


def unattended(
    folder: PathLike,
    *,
    trials: int,
    seconds: float,
    faults: tuple[str, ...] = (),
    **options: Unpack[RoomOptions],
) -> None:
    """Make some trials of a virtual leg in real time, and print what is said of each.

    `trials` of `seconds` each are kept in `folder`; `faults` are ``kind@seconds`` for all trials,
    or ``kind@seconds@trial``; all else is as of `Room`, with somebody's `leg`.
    """
    planned = [_fault(text) for text in faults]
    room = Room(folder, **options)
    laboratory = room.laboratory
    assert laboratory is not None
    for sentence in room.trials.broken:
        click.echo(f"surae: {sentence}", err=True)
    try:
        for index in range(1, trials + 1):
            room.load(
                profile="multiple-holds", task="active", chirp_amplitude=0.1, duration=seconds
            )
            _until_heard(room)
            for kind, at, only in planned:
                if only in (None, index):
                    laboratory.fault(kind=kind, at=at)
            number = room.start()
            while number not in room.trials.verdicts:
                time.sleep(0.05)
            judgement = room.trials.verdicts[number].result()
            laboratory.fault(kind="none")
            shown_keys = {
                "trial",
                "recording",
                "grade",
                "vaf",
                "seconds_to_verdict",
                "verdict",
                "advice",
            }
            line = {key: value for key, value in judgement.items() if key in shown_keys}
            line["alarms"] = [
                {key: alarm[key] for key in ("at", "code", "role")} for alarm in judgement["alarms"]
            ]
            line["findings"] = [finding["code"] for finding in judgement["findings"]]
            click.echo(json.dumps(line, ensure_ascii=False))
    finally:
        room.close()


def _fault(text: str) -> tuple[str, float, int | None]:
    kind, *numbers = text.split("@")
    try:
        at, *only = [float(number) for number in numbers]
        if kind in FAULTS and len(only) < 2:
            return kind, at, int(only[0]) if only else None
    except ValueError:
        pass
    raise InputError(f"--fault {text}: give KIND@SECONDS, kind one of: {', '.join(FAULTS)}")


def _until_heard(room: Room) -> None:
    """Wait until the streams are there and everybody is ready."""
    end = time.monotonic() + _PATIENCE
    while len(room.trials.recorder.streams) < 3 or room.trials.mapping is None:
        if time.monotonic() > end:
            raise ComputationError("the rehearsal's streams did not come; try again")
        time.sleep(0.1)
    if (warm := room.trials.warm.result()).how != "done":
        raise ComputationError(f"the judge cannot work: {warm.message}")
