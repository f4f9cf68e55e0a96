"""Samples and their times: the one check that every signal passes, whatever it comes from."""

from collections.abc import Callable

import numpy as np

from surae.errors import InputError
from surae.units import FloatArray

#: Says where sample `index` is, in the terms of its source: "row 12", "sample 12".
Position = Callable[[int], str]


def sample(index: int) -> str:
    """Position of a sample in an array or a binary file; the first is sample 1."""
    return f"sample {index + 1}"


def instants(start_s: float, rate_hz: float, n: int) -> FloatArray:
    """Read-only times [s] of `n` samples at `rate_hz`, the first at `start_s`."""
    time = start_s + np.arange(n, dtype=np.float64) / rate_hz
    time.setflags(write=False)
    return time


def check_samples(
    time: FloatArray,
    values: FloatArray,
    *,
    where: str,
    names: tuple[str, str],
    position: Position = sample,
) -> None:
    """Check that a signal has two finite samples or more, at times that increase.

    `where` is the file or object that the signal belongs to, the beginning of the message; `names`
    are those of the time and of the signal there; `position` says where a sample is.
    """
    for name, array in zip(names, (time, values), strict=True):
        if array.ndim != 1:
            raise InputError(f"{where}: {name} has {array.ndim} dimensions; it must have one")
    if len(time) != len(values):
        raise InputError(
            f"{where}: {names[1]} has {len(values)} samples but {names[0]} has {len(time)}"
        )
    if len(time) < 2:
        count = "one sample" if len(time) else "no samples"
        raise InputError(f"{where}: {names[1]} has {count}; at least two are needed")
    for name, array in zip(names, (time, values), strict=True):
        check_finite(array, where=where, name=name, position=position)
    stuck = np.flatnonzero(time[1:] <= time[:-1])
    if stuck.size:
        index = int(stuck[0]) + 1
        raise InputError(
            f"{where}: {names[0]}, {position(index)}: time doesn't increase "
            f"({time[index]:.12g} s after {time[index - 1]:.12g} s)"
        )


def check_finite(values: FloatArray, *, where: str, name: str, position: Position = sample) -> None:
    """Check that all of `values` are finite numbers; the message names the first that isn't."""
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        index = int(wrong[0])
        raise InputError(
            f"{where}: {name}, {position(index)}: {values[index]} is not a finite number"
        )


def rounding(time: FloatArray, coarsest: float) -> float | None:
    """The decimal step [s], at most `coarsest`, of which all times are multiples, or None.

    Stamps finer than a ten-thousandth of `coarsest` are not rounded in any way that matters.
    """
    digits = int(np.ceil(-np.log10(coarsest)))
    for decimals in range(digits, digits + 4):
        scaled = time * 10.0**decimals
        if np.max(np.abs(scaled - np.round(scaled))) < 1e-4:
            return float(10.0**-decimals)
    return None
