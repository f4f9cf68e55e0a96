"""Formats that have one column of times need channels that share one."""

import numpy as np

from surae.errors import InputError
from surae.recording.recording import Recording
from surae.units import FloatArray


def shared_time(recording: Recording, where: str) -> FloatArray:
    """The times that all channels have, shape (n,) [s].

    Raises
    ------
    InputError
        The channels have times of their own; the message begins with `where`.
    """
    channels = list(recording.channels.values())
    time = channels[0].time
    for one in channels[1:]:
        if len(one.time) != len(time) or not np.array_equal(one.time, time):
            raise InputError(
                f"{where}: {channels[0].role} and {one.role} have times of their own "
                f"({channels[0].rate_hz:.6g} and {one.rate_hz:.6g} Hz, from "
                f"{channels[0].time[0]:.6g} and {one.time[0]:.6g} s), but the file has one column "
                "of times; prepare the recording first (--prepare), or write .h5 or a BIDS folder"
            )
    return time
