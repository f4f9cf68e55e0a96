"""Norms: how a leg's measure lies among legs that somebody measured, with the source beside it.

A norm is a mean and a spread over n legs, no range that decides. The result is a probability:
which part of the group lies below this leg, from Student's t with the uncertainty of the group's
mean and of the leg's own value in it. Only identified measures of fits that are not inadequate are
compared, in the same unit.
"""

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, fields
from importlib.resources import files

from surae.assessment import Grade, Verdict
from surae.errors import InputError
from surae.files import PathLike, read_bytes, shown
from surae.measures.measure import Measures
from surae.model.joint import ANKLE, Joint
from surae.normal import standard_error_of


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


@dataclass(frozen=True, slots=True)
class Placed:
    """A measure of a leg among a group: `below` is the part of the group that lies below it."""

    norm: Norm
    value: float
    below: float

    @property
    def text(self) -> str:
        """The part below in percent, never none or all of a group of which some were measured."""
        percent = 100.0 * self.below
        return "< 1 %" if percent < 1.0 else "> 99 %" if percent > 99.0 else f"{percent:.0f} %"


def read_norms(path: PathLike | None = None, joint: Joint = ANKLE) -> tuple[Norm, ...]:
    """The norms of a file; without one those that come with surae, of the ankle from cited papers.

    Raises
    ------
    InputError
        The file is no table of norms.
    """
    if path is None:
        if joint != ANKLE:
            return ()
        data = files("surae.measures").joinpath("norms.toml").read_bytes()
        where = "norms.toml"
    else:
        data, where = read_bytes(path), shown(path)
    try:
        entries = tomllib.loads(data.decode("utf-8")).get("norm", [])
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{where}: not TOML ({error})") from None
    if not isinstance(entries, list):
        raise InputError(f"{where}: norm is no list; write [[norm]] before each")
    return tuple(_norm(entry, f"{where}, norm {i}") for i, entry in enumerate(entries, 1))


def _norm(entry: object, where: str) -> Norm:
    names = [field.name for field in fields(Norm)]
    if not isinstance(entry, dict) or set(entry) != set(names):
        raise InputError(f"{where}: give each of {', '.join(names)}, and nothing else")
    for name in names:
        value = entry[name]
        if name in ("n", "mean", "sd"):
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not math.isfinite(value):
                raise InputError(f"{where}: {name} is {value!r}; give a number")
        elif not isinstance(value, str) or not value.strip():
            raise InputError(f"{where}: {name} is {value!r}; give a text")
    if entry["n"] < 3 or entry["n"] != int(entry["n"]) or not entry["sd"] > 0:
        raise InputError(f"{where}: n must be a whole number from 3, and sd above zero")
    return Norm(**{**entry, "n": int(entry["n"])})


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
        In the order of the norms; what is not identified, or of an inadequate fit, is not there.
    """
    if measures.adequacy.grade is Grade.INADEQUATE:
        return ()
    from scipy.special import stdtr

    among = []
    for norm in norms:
        m = measures.get(norm.measure)
        usable = m is not None and m.verdict is Verdict.IDENTIFIED and m.unit == norm.unit
        if m is None or not usable or m.value is None or m.ci95 is None:
            continue
        own = standard_error_of(m.ci95)
        scale = math.sqrt(norm.sd**2 * (1.0 + 1.0 / norm.n) + own**2)
        below = float(stdtr(norm.n - 1, (m.value - norm.mean) / scale))
        among.append(Placed(norm, m.value, below))
    return tuple(among)
