"""How well two visits tell a change, and people apart: SDC and ICC of a measure.

    SDC = 1.96·√2·SEM,  ICC = σ²/(σ² + SEM²)

SEM is the standard deviation of what another such visit of an unchanged leg draws anew, σ that of
people (de Vet et al. 2006, J. Clin. Epidemiol. 59:1033-1039).
"""

import math
from functools import cache

from surae.base.normal import NORMAL
from surae.measures.measure import Reliability
from surae.measures.norms import Norm, read_norms

#: By how much sessions of one leg differ beyond their covariance: 1.05 on average over all measures
#: and parameters of 40 pairs of virtual legs, 1.6 of the worst.
SCATTER = 1.2
#: From which ICC on reliability is called so (Koo and Li 2016, J. Chiropr. Med. 15:155-163).
_WORDS = ((0.9, "excellent"), (0.75, "good"), (0.5, "moderate"), (-math.inf, "poor"))


def smallest_detectable(sem: float) -> float:
    """SDC = 1.96·√2·SEM, in the unit of the standard error of measurement."""
    return NORMAL * math.sqrt(2.0) * sem


def reliability_of(name: str, unit: str, sem: float) -> Reliability | None:
    """Reliability of a measure where the spread of people is known; None where it is not.

    Parameters
    ----------
    name : str
        The measure's, with its point.
    unit : str
        Its unit.
    sem : float
        Standard error of measurement between visits, in that unit.
    """
    norm = _people(name)
    if norm is None or norm.unit != unit:
        return None
    icc = norm.sd**2 / (norm.sd**2 + sem**2)
    source = f"{norm.n} {norm.group}, {norm.reference}"
    return Reliability(icc, norm.sd, source, word_of(icc))


def word_of(icc: float) -> str:
    """What an ICC is called (Koo and Li 2016)."""
    return next(word for least, word in _WORDS if icc > least)


@cache
def _people(name: str) -> Norm | None:
    """People of whom the spread is known: healthy ones before others."""
    known = [norm for norm in read_norms() if norm.measure == name]
    return next((norm for norm in known if "healthy" in norm.group), next(iter(known), None))
