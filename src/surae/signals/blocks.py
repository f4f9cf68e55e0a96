"""Long recordings in blocks: what is kept of each are its normal equations, and not its rows.

Each block is simulated from some seconds before it on, which do not count: tissue that relaxes and
muscles that are active remember them. Gains, drift and errors of the drives are of each block; what
a model cannot express is the same in all blocks of a recording.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.signals.inputs import ModelInputs

#: A recording that lasts longer [s] is cut into blocks of at most that length, simulated from so
#: long before; blocks of each recording in which a search begins, at most.
LONGEST = 300.0
SECONDS = 60.0
LEAD_S = 12.0
FEW = 4
_ARRAYS = ("time", "angle", "velocity", "acceleration", "emg", "torque")


@dataclass(frozen=True, slots=True)
class RecordingBlock:
    """A block, and where in its recording it is with its lead-in; a short one is its own."""

    inputs: ModelInputs
    whole: ModelInputs
    at: slice
    number: int  #: Of the recording.
    seconds: float  #: How long it lasts.


def cut(whole: ModelInputs, number: int, seconds: float) -> tuple[RecordingBlock, ...]:
    """The blocks of recording `number`, which lasts so long [s].

    Films are of the whole, which then stays so.
    """
    if seconds <= LONGEST or whole.films:
        return (RecordingBlock(whole, whole, slice(0, whole.n), number, seconds),)
    edges = np.linspace(0, whole.n, int(np.ceil(seconds / SECONDS)) + 1).round().astype(int)
    lead = int(LEAD_S * whole.rate_hz)
    return tuple(_part(whole, number, int(begin), int(end), lead) for begin, end in pairwise(edges))


def _part(whole: ModelInputs, number: int, begin: int, end: int, lead: int) -> RecordingBlock:
    at = slice(max(begin - lead, 0), end)
    weight = whole.weights[at].copy()
    weight[: begin - at.start] = 0.0
    arrays: dict[str, Any] = {
        name: each[at] for name in _ARRAYS if (each := getattr(whole, name)) is not None
    }
    second = tuple(each[at] for each in whole.second)
    inputs = replace(
        whole, **arrays, second=second, weight=read_only(weight), block_of=number, steps=()
    )
    return RecordingBlock(inputs, whole, at, number, inputs.n / inputs.rate_hz)


def telling(parts: Sequence[RecordingBlock]) -> tuple[RecordingBlock, ...]:
    """Those few of a recording's blocks in which its angle and EMG vary most, in their order."""
    if len(parts) <= FEW:
        return tuple(parts)
    spread = np.array([[np.std(p.inputs.angle), *np.std(p.inputs.emg, axis=0)] for p in parts])
    score = (spread / np.maximum(spread.max(axis=0), 1e-300)).sum(axis=1)
    return tuple(parts[i] for i in sorted(np.argsort(-score, kind="stable")[:FEW]))


def recordings_of(inputs: Sequence[ModelInputs]) -> tuple[int, ...]:
    """The number of the recording that each of these is, or is a block of."""
    numbers: list[int] = []
    for i, own in enumerate(inputs):
        same = i > 0 and own.block_of is not None and own.block_of == inputs[i - 1].block_of
        numbers.append((numbers[-1] + (not same)) if numbers else 0)
    return tuple(numbers)


def summed(each: Sequence[FloatArray], of: Sequence[int]) -> list[FloatArray]:
    """Arrays of blocks added up by recording."""
    totals = [np.zeros_like(each[0]) for _ in range(of[-1] + 1)]
    for array, number in zip(each, of, strict=True):
        totals[number] = totals[number] + array
    return totals
