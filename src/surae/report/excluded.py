"""Samples that a fit left out: those of weight zero."""

import numpy as np

from surae.report.formatting import short
from surae.units import FloatArray

#: Spans that are written out at most.
_SPANS = 6


def excluded_spans(weight: FloatArray | None) -> tuple[tuple[int, int], ...]:
    """First and last sample of every stretch of weight zero."""
    if weight is None:
        return ()
    edges = np.diff(np.concatenate([[0], (weight == 0).astype(int), [0]]))
    first, past = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    return tuple(zip(first.tolist(), (past - 1).tolist(), strict=True))


def excluded_text(time: FloatArray, weight: FloatArray | None) -> str:
    """How many samples were left out, and when; empty where all count."""
    spans = excluded_spans(weight)
    if not spans:
        return ""
    count = sum(last - first + 1 for first, last in spans)
    texts = [
        f"{_second(time[first])} s"
        if first == last
        else f"{_second(time[first])} … {_second(time[last])} s"
        for first, last in spans[:_SPANS]
    ]
    if len(spans) > _SPANS:
        texts.append(f"and {len(spans) - _SPANS} spans more")
    return f"{count} of {len(time)} samples, weight 0: {', '.join(texts)}"


def _second(time: float) -> str:
    return short(round(float(time), 3))
