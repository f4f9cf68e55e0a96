"""The verdicts of a FIT.json beside those of this version; words are always this version's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.base.records import from_plain
from surae.inference.judging.adequacy import doubted
from surae.inference.judging.assessed import Assessment
from surae.inference.judging.grade import Grade
from surae.inference.judging.reasons import OF_OTHER_TRIALS, Reason, against
from surae.inference.judging.verdict import Verdict

#: Grades that withhold every claim.
_GRAVE = (Grade.INADEQUATE,)
#: Letters of a version's name.
_VERSION = 40
#: Part of an interval's width by which its ends may differ and are the same.
_ALIKE = 0.005


@dataclass(frozen=True, slots=True)
class _Graded:
    grade: Grade
    codes: tuple[Reason, ...] = ()  #: What speaks against it; older files have sentences alone.


@dataclass(frozen=True, slots=True)
class _Claimed:
    verdict: Verdict
    ci95: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class _Judged:
    """What was judged when the fit was made."""

    parameters: Mapping[str, _Claimed]
    adequacy: _Graded
    surae: str  #: The version that fitted.
    nuisances: Mapping[str, _Claimed] = field(default_factory=FrozenDict)
    judged_by: str = ""  #: The version that gave the verdicts; older files have none.


def as_judged(now: Assessment, data: Mapping[str, Any]) -> Assessment:
    """The verdicts and intervals of the file, and where this version's, `now`, are others.

    Words and all other numbers are this version's: nothing vouches for those of the file.
    """
    if "adequacy" not in data or not all("ci95" in p for p in data["parameters"].values()):
        return now  # older files have none
    for kind, fresh in (("parameters", now.parameters), ("nuisances", now.nuisances)):
        if list(data.get(kind, {})) != list(fresh):
            raise InputError(f"{kind}: others than the fit has")
    saved = from_plain(_Judged, data)
    version = cleaned(saved.judged_by or saved.surae, _VERSION)
    differs = []
    others = _of_other_trials(saved.adequacy.codes)
    names = [each.name for each in now.recordings]
    adequacy = doubted(now.adequacy, others, OF_OTHER_TRIALS, names)
    if saved.adequacy.grade != adequacy.grade:
        grade = saved.adequacy.grade
        differs.append(f"the fit is {adequacy.grade}, not {grade}")
        said = against("said", text=f"judged {grade} by surae {version}", grave=grade in _GRAVE)
        reasons = () if grade == Grade.ADEQUATE else (said,)
        adequacy = replace(adequacy, grade=grade, against=reasons)
    claimed = {**saved.parameters, **saved.nuisances}
    every = {**now.parameters, **now.nuisances}
    moved = []
    for name, p in every.items():
        judged = claimed[name]
        if p.verdict != judged.verdict:
            differs.append(f"{name} is {p.verdict}, not {judged.verdict}")
            every[name] = replace(p, verdict=judged.verdict, ci95=judged.ci95, note="")
        elif not _alike(p.ci95, judged.ci95):
            moved.append(name)
            every[name] = replace(p, ci95=judged.ci95)
    if moved:
        differs.append(f"the intervals of {', '.join(moved)} are others")
    return replace(
        now,
        parameters={name: every[name] for name in now.parameters},
        nuisances={name: every[name] for name in now.nuisances},
        adequacy=adequacy,
        version=version,
        differs=tuple(differs),
    )


def _of_other_trials(reasons: Sequence[Reason]) -> list[Reason]:
    """What other trials of the leg said against a fit, which it alone does not know; in our words.

    Their values stand in the second checksum.
    """
    try:
        return [
            against(each.code, grave=each.is_grave, scope=each.scope, **each.values)
            for each in reasons
            if each.code in OF_OTHER_TRIALS
        ]
    except (LookupError, TypeError, ValueError):
        raise InputError("adequacy.codes: what other trials say lacks a value") from None


def _alike(one: tuple[float, float] | None, other: tuple[float, float] | None) -> bool:
    """Whether ends of intervals differ by no more than a hundredth of a half-width."""
    if one is None or other is None:
        return one == other
    return max(abs(a - b) for a, b in zip(one, other, strict=True)) <= _ALIKE * (one[1] - one[0])
