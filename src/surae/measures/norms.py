"""Norms: how a leg's measure lies among legs that somebody measured, with the source beside it.

A norm is a mean and a spread over n legs, no range that decides. The result is a probability:
which part of the group lies below this leg, from Student's t with the uncertainty of the group's
mean and of the leg's own value in it. Only identified measures of fits that are not inadequate are
compared, in the same unit.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import as_file, files

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import PathLike
from surae.base.formatting import probability
from surae.base.normal import standard_error_of
from surae.base.records import from_file, read_toml
from surae.inference import Grade, Verdict
from surae.measures.measure import Measures
from surae.model.joint import ANKLE, Joint


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class Norm:
    """One measure over one group of legs."""

    #: `measure`, `unit`: as in `surae measures`, with its point in the name.
    measure: str
    unit: str
    condition: str  #: How it was measured.
    group: str  #: Who was measured.
    n: int  #: Number of legs, at least 3.
    #: `mean`, `sd`: over these legs.
    mean: float
    sd: float
    reference: str  #: Where that is written.
    #: `age`, `sex`: whose they were, in words; empty where that is not known here.
    age: str = ""
    sex: str = ""

    def __post_init__(self) -> None:
        """Refuse what is no norm."""
        if self.n < 3 or not self.sd > 0.0:
            raise InputError("n must be a whole number from 3, and sd above zero")


@dataclass(frozen=True, slots=True)
class _Norms:
    """A file of norms."""

    norm: tuple[Norm, ...]


@dataclass(frozen=True, slots=True)
class Placed:
    """A measure of a leg among a group: `below` is the part of the group that lies below it."""

    norm: Norm
    value: float
    below: float
    #: The same at both ends of the measure's interval, where the leg itself is known only roughly;
    #: None where the measure is identified.
    between: tuple[float, float] | None = None

    @property
    def text(self) -> str:
        """The part below in percent, never none or all of a group of which some were measured."""
        return probability(self.below)

    @property
    def ends(self) -> tuple[str, str] | None:
        """Both ends of `between` in the same way."""
        if self.between is None:
            return None
        low, high = self.between
        return probability(low), probability(high)


def read_norms(path: PathLike | None = None, joint: Joint = ANKLE) -> tuple[Norm, ...]:
    """The norms of a file; without one those that come with surae, of the ankle from cited papers.

    Raises
    ------
    InputError
        The file is no table of norms.
    """
    if path is None and joint != ANKLE:
        return ()
    shipped = files("surae.measures").joinpath("norms.toml")
    with as_file(shipped) as ours:
        given = ours if path is None else path
        return from_file(_Norms, given, read_toml(given)).norm


def placed(measures: Measures, norms: Sequence[Norm]) -> tuple[Placed, ...]:
    """Where a leg's measures lie among the groups that have them.

    Parameters
    ----------
    measures : Measures
        Of a fit.
    norms : sequence of Norm
        Groups.

    Returns
    -------
    tuple of Placed
        In the order of the norms; what is not even weakly known, or of an inadequate fit, is not
        there.
    """
    from scipy.special import stdtr

    among = []
    for norm in norms:
        m = measures.get(norm.measure)
        known_well = (Verdict.IDENTIFIED, Verdict.WEAK)
        usable = m is not None and m.verdict in known_well and m.unit == norm.unit
        if m is None or not usable or m.value is None or m.ci95 is None:
            continue
        if m.basis == "model" and measures.adequacy.grade is Grade.INADEQUATE:
            continue
        sd = standard_error_of(m.ci95)
        scale = math.sqrt(norm.sd**2 * (1.0 + 1.0 / norm.n) + sd**2)
        below = float(stdtr(norm.n - 1, (m.value - norm.mean) / scale))
        between = None
        if m.verdict is Verdict.WEAK:
            alone = norm.sd * math.sqrt(1.0 + 1.0 / norm.n)
            low, high = (float(stdtr(norm.n - 1, (end - norm.mean) / alone)) for end in m.ci95)
            between = low, high
        among.append(Placed(norm, m.value, below, between))
    return tuple(among)
