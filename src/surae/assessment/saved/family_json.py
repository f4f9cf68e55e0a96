"""How FIT.json keeps what `model="auto"` chose, and what is not known of the laboratory."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae.assessment.saved.arrays import decode, encode
from surae.assessment.saved.json_file import real
from surae.estimation import Candidate, Family
from surae.estimation.noise import NoiseModel
from surae.frozen import FrozenDict
from surae.model.laboratory import Belief
from surae.units import FloatArray

#: Ways in which one source may shift the estimates, at most.
_MOST = 1000


def family_as_dict(family: Family | None) -> dict[str, Any] | None:
    """A family as plain data."""
    if family is None:
        return None
    return {
        "candidates": [
            {
                "model": candidate.model,
                "nuisances": list(candidate.groups),
                "evidence": candidate.evidence,
                "weight": candidate.weight,
                "values": dict(candidate.values),
            }
            for candidate in family.candidates
        ],
        "priors": {
            name: {"mean": belief.mean, "sd": belief.sd, "off": belief.off}
            for name, belief in family.beliefs.items()
        },
        "noise": [
            {
                "coefficients": noise.coefficients.tolist(),
                "variance": noise.variance,
                "autocovariance": noise.autocovariance.tolist(),
                "samples": noise.samples,
            }
            for noise in family.noise
        ],
        "zeros": list(family.zeros),
        "covariance": encode(family.covariance),
        "spread": {source: encode(by) for source, by in family.spread.items()},
    }


def read_family(data: Any, free: Sequence[str]) -> Family | None:
    """The family that `family_as_dict` made plain, of these free parameters."""
    if data is None:
        return None
    return Family(
        candidates=tuple(
            Candidate(
                str(candidate["model"]),
                tuple(str(group) for group in candidate["nuisances"]),
                real(candidate["evidence"]),
                real(candidate["weight"]),
                _numbers(candidate["values"]),
            )
            for candidate in data["candidates"]
        ),
        beliefs=FrozenDict(
            (str(name), Belief(real(belief["mean"]), real(belief["sd"]), real(belief["off"])))
            for name, belief in data["priors"].items()
        ),
        noise=tuple(
            NoiseModel(
                np.array([real(c) for c in noise["coefficients"]]),
                real(noise["variance"]),
                np.array([real(c) for c in noise["autocovariance"]]),
                real(noise["samples"]),
            )
            for noise in data["noise"]
        ),
        zeros=tuple(real(zero) for zero in data["zeros"]),
        covariance=decode(data["covariance"], (len(free), len(free))),
        spread=FrozenDict(
            (str(source), _shifts(by, free)) for source, by in data["spread"].items()
        ),
    )


def _shifts(packed: dict[str, Any], free: Sequence[str]) -> FloatArray:
    if "shape" not in packed:  # formerly standard deviations by name, each for itself
        return np.diag([real(packed.get(name, 0.0)) for name in free])
    rows = packed["shape"][0]
    if not isinstance(rows, int) or not 0 <= rows <= _MOST:
        raise ValueError(f"{rows} shifts, expected {_MOST} at most")
    return decode(packed, (rows, len(free)))


def _numbers(data: Mapping[str, Any]) -> FrozenDict[str, float]:
    return FrozenDict((str(name), real(value)) for name, value in data.items())
