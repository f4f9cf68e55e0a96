"""Crosstalk from contractions of one muscle at a time.

While muscle j contracts, electrode i shows rᵢⱼ = xᵢⱼ + hᵢⱼ of its envelope: x is crosstalk, the
same in every contraction; h ≥ 0 is how much muscle i helps, another each time. In parts of what
muscle i does by itself help is taken for even between 0 and the same H for all pairs: n helps are
then H·(n − 1)/(n + 1) apart, which tells H, and of a pair whose ratios are d apart x is even
between the largest ratio less H and the smallest.
"""

from collections.abc import Mapping

import numpy as np

from surae.base.units import FloatArray
from surae.recording import MUSCLES
from surae.signals.inputs import ModelInputs

#: Part of its largest envelope from which a muscle contracts, and below which the others have to
#: stay; the shortest contraction, and what of it is left out at both ends [s].
_WORKS = 0.5
_OTHERS = 0.5
_SHORTEST = 0.8
_RISE = 0.3
#: Contractions of a muscle from which its help is told from its crosstalk.
_FEWEST = 2
#: Of a ratio: what an envelope's noise leaves, and the part of H that is not known.
_NOISE = 0.006
_UNSURE = 0.5
#: Quantile that is EMG at rest.
_REST = 0.05

Ratios = Mapping[tuple[int, int], tuple[float, float]]


def contractions(
    envelopes: Mapping[str, FloatArray], rate_hz: float
) -> dict[int, list[FloatArray]]:
    """Levels above rest, (4,), of each contraction in which one muscle works alone, by muscle.

    `envelopes` are by muscle ("ta" …), shape (n,) each.
    """
    n = len(next(iter(envelopes.values()), np.zeros(0)))
    box = np.ones(max(round(0.25 * rate_hz), 1))
    emg = np.zeros((len(MUSCLES), n))
    for muscle, envelope in envelopes.items():
        row = np.convolve(envelope, box / len(box), "same")
        emg[MUSCLES.index(muscle)] = row - np.quantile(row, _REST)
    top = emg.max(axis=1, initial=0.0)
    share = emg / np.maximum(top, 1e-300)[:, None]
    by_muscle: dict[int, list[FloatArray]] = {}
    for j in np.flatnonzero(top):
        works = np.concatenate([[False], share[j] > _WORKS, [False]])
        edges = np.flatnonzero(np.diff(works.astype(int)))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            inner = slice(begin + round(_RISE * rate_hz), end - round(_RISE * rate_hz))
            if end - begin < _SHORTEST * rate_hz or inner.stop <= inner.start:
                continue
            level = emg[:, inner].mean(axis=1)
            if np.all(np.delete(level, j) < _OTHERS * np.delete(np.maximum(top, 1e-300), j)):
                by_muscle.setdefault(int(j), []).append(level)
    return by_muscle


def crosstalk(inputs: ModelInputs, prior: tuple[float, float]) -> Ratios:
    """Crosstalk and its standard deviation by the channels that hear it and whose it is.

    `prior` is its mean and standard deviation beforehand, which each estimate is joined with.
    """
    mean, sd = prior
    envelopes = {m: inputs.emg[:, i] for i, m in enumerate(MUSCLES) if m not in inputs.missing_emg}
    alone = contractions(envelopes, inputs.rate_hz)
    often = {j: levels for j, levels in alone.items() if len(levels) >= _FEWEST}
    levels_alone = {
        j: float(np.mean([level[j] for level in levels])) for j, levels in often.items()
    }
    pairs = {
        (i, j): np.sort(
            [level[i] / levels_alone[i] / (level[j] / levels_alone[j]) for level in levels]
        )
        for j, levels in often.items()
        for i in often
        if i != j
    }
    apart = {pair: float(each[-1] - each[0]) for pair, each in pairs.items()}
    helps = [d * (len(pairs[pair]) + 1) / (len(pairs[pair]) - 1) for pair, d in apart.items()]
    most = float(np.mean(helps)) if helps else 0.0
    known: dict[tuple[int, int], tuple[float, float]] = {}
    for (i, j), each in pairs.items():
        room = max(most - apart[i, j], 0.0)
        middle = levels_alone[i] / levels_alone[j] * (float(each[0]) - room / 2.0)
        spread = levels_alone[i] / levels_alone[j] * (room + _UNSURE * most) / np.sqrt(12.0)
        precise = np.hypot(_NOISE, spread) ** -2.0
        before = sd**-2.0
        together = float(precise + before)
        known[i, j] = (max(float(precise * middle + before * mean), 0.0) / together, together**-0.5)
    return known


def one_at_a_time(envelopes: Mapping[str, FloatArray], rate_hz: float) -> bool:
    """Whether at least three muscles contract alone, each several times."""
    alone = contractions(envelopes, rate_hz).values()
    return sum(len(levels) >= _FEWEST for levels in alone) >= 3
