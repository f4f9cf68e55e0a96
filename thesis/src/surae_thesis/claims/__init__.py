"""The claims of the thesis, rows of data in this folder's TOML files, and their one judge.

A row has an id and the thesis's place, claim and number (``thesis``), its sentence (``says``) and
beside it the rule by which the claim holds, the function that decides (``ours``) and what that is
given (``given``), the group of views that it is judged under (the file's first, if none), what
explains our number (``why``, ``note``), and why it differs (``cause``). Texts may name what is
given in braces, so that a rule in words and its computation read the same number; ``each`` makes
several claims of one row.
"""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from functools import partial
from importlib import import_module
from importlib.resources import files
from typing import Any

#: In the order in which they are counted.
VERDICTS = (
    "holds",
    "holds under a reading",
    "holds with the thesis's integrator",
    "same direction, smaller",
    "calibrated",
    "differs",
    "not tested by this",
    "cannot be checked",
)
#: The view that is the thesis's own way to integrate and to fit, where we have another.
INTEGRATOR = "the thesis's integrator"
#: What a second look at a claim that differs found: the thesis contradicts itself or is wrong; its
#: integrator or optimiser; something that our model does not do, no more is shown; our virtual
#: cohort is not its subjects; nothing.
CAUSES = ("the thesis", "its scheme", "not ours", "our cohort", "unexplained")


class NotThereError(LookupError):
    """What a claim needs was not computed, or failed."""


@dataclass(frozen=True, slots=True)
class Ruling:
    """Whether a claim holds in one view of the numbers, and our number in the thesis's unit.

    `less`: it does not, but for its size: the order is the thesis's. `untested` says why these
    numbers could not have answered otherwise, or why chance answers; empty where they test it.
    """

    holds: bool
    ours: str
    less: bool = False
    untested: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stated:
    """What the thesis says: the place, our short claim, its number and sentence, and our rule."""

    id: str
    source: str
    statement: str
    number: str
    says: str
    rule: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim(Stated):
    """How it is decided in one view of the numbers.

    `why` and `note` explain our number, the latter from the view that decides; `cause` is one of
    `CAUSES`, where the claim differs; `views` are those that it is judged under, all if none;
    `calibrated` says that the numbers were made to fit the claim, which then cannot hold; `chance`
    says of a view and a ruling's function why chance decides, or nothing.
    """

    ours: Callable[[Any], Ruling]
    why: str = ""
    cause: str = ""
    calibrated: bool = False
    views: tuple[str, ...] = ()
    note: "Callable[[Any, Claim], str] | None" = None
    chance: "Callable[[Any, Callable[[Any], Ruling]], str] | None" = None


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedClaim(Stated):
    """What became of a claim, as plain data; `said` is the verdict in full, with views or cause.

    By view, `ours` says whether it holds and our number; its one key is empty where there is one.
    """

    verdict: str
    said: str
    ours: Mapping[str, tuple[bool, str]] = field(default_factory=dict)
    reason: str = ""

    def __post_init__(self) -> None:
        """Refuse a verdict that there is not: a damaged file."""
        if self.verdict not in VERDICTS:
            raise ValueError(self.verdict)


def judge_all(
    section: str, views: Mapping[str, Any], *modules: str, chance: bool = True
) -> tuple[JudgedClaim, ...]:
    """Judge every claim of a section, and `chance` too; see `read_claims` and `judge`."""
    claims = read_claims(section, *modules)
    if not chance:
        claims = tuple(replace(claim, chance=None) for claim in claims)
    return tuple(judge(claim, views) for claim in claims)


def turned(findings: Sequence[JudgedClaim], first: str, second: str) -> str:
    """Which claims another reading turns, in a sentence."""
    both = [f for f in findings if first in f.ours and second in f.ours]
    gained = [f.id for f in both if f.ours[second][0] and not f.ours[first][0]]
    lost = [f.id for f in both if f.ours[first][0] and not f.ours[second][0]]
    return (
        f"Of {len(both)} claims that are judged with {second} too, {len(gained)} hold so alone "
        f"({', '.join(gained) or 'none'}), and {len(lost)} no longer "
        f"({', '.join(lost) or 'none'})."
    )


def rows(section: str) -> list[dict[str, Any]]:
    """The rows of a section's file, ``each`` taken apart and texts filled in."""
    content = tomllib.loads(files(__name__).joinpath(f"{section}.toml").read_text(encoding="utf-8"))
    groups = content.get("views", {"": ()})
    every = []
    for row in content["claim"]:
        for case in row.pop("each", [{}]):
            one = {"given": {}, "views": next(iter(groups)), **row, **case}
            texts = ("id", "source", "statement", "number")
            one |= zip(texts, one.pop("thesis"), strict=True)
            filled = {**one, **one["given"]}
            one |= {key: t.format(**filled) for key, t in one.items() if isinstance(t, str)}
            every.append({**one, "views": tuple(groups[one["views"]])})
    return every


def read_claims(section: str, *modules: str) -> tuple[Claim, ...]:
    """The claims of a section, whose functions are in modules of these names."""
    rules = {k: v for name in modules for k, v in vars(import_module(name)).items()}
    texts = {f.name for f in fields(Claim)} - {"ours", "note"}
    return tuple(
        Claim(
            ours=partial(rules[row["ours"]], **row["given"]),
            note=rules[row["note"]] if "note" in row else None,
            chance=rules.get("by_chance"),
            **{key: row[key] for key in texts if key in row},
        )
        for row in rows(section)
    )


def judge(claim: Claim, views: Mapping[str, Any]) -> JudgedClaim:
    """What a claim's rule says of its views of the numbers, in one verdict.

    It *holds* when it does so under the reading, the first of its views; *holds under* the others
    that it holds in; *holds with the thesis's integrator*, where in that alone. It has the *same
    direction, smaller* where only the size is not there, and else *differs*. It is *not tested by
    this* where the reading's numbers do not test it, or where it would hold in such a view alone.
    """
    names = [name for name in claim.views if name in views] if claim.views else list(views)
    rulings: dict[str, Ruling] = {}
    missing = "it was not computed"
    for name in names:
        try:
            rulings[name] = _ruled(claim, views[name])
        except NotThereError as error:
            missing = str(error)
    reading = names[0] if names else ""
    reason = claim.why if reading in rulings else missing
    if claim.note and reading in rulings:
        with suppress(NotThereError):
            reason = f"{claim.note(views[reading], claim)} {reason}"
    verdict, said = _verdict(claim, reading, rulings)
    same = {f.name: getattr(claim, f.name) for f in fields(Stated)}
    ours = {name: (_yes(ruling), _text(ruling)) for name, ruling in rulings.items()}
    return JudgedClaim(**same, verdict=verdict, said=said, ours=ours, reason=reason.strip())


def _verdict(claim: Claim, reading: str, rulings: Mapping[str, Ruling]) -> tuple[str, str]:
    """A claim's verdict, and how it is said, from what its rule says of each view."""
    holding = [name for name, ruling in rulings.items() if _yes(ruling)]
    others = [name for name in holding if name != INTEGRATOR]
    if reading not in rulings:
        verdict = "cannot be checked"
    elif claim.calibrated:
        verdict = "calibrated"
    elif rulings[reading].untested:
        verdict = "not tested by this"
    elif reading in holding:
        verdict = "holds"
    elif others:
        return "holds under a reading", f"holds under {' and '.join(others)}"
    elif holding:
        verdict = "holds with the thesis's integrator"
    elif rulings[reading].less:
        verdict = "same direction, smaller"
    elif any(ruling.untested and ruling.holds for ruling in rulings.values()):
        verdict = "not tested by this"
    else:
        return "differs", f"differs: {claim.cause}" if claim.cause else "differs"
    return verdict, verdict


def _yes(ruling: Ruling) -> bool:
    """Whether a claim holds by a rule that could have said no."""
    return bool(ruling.holds and not ruling.untested)


def _text(ruling: Ruling) -> str:
    """Our number, and why it tests nothing."""
    return f"{ruling.ours}; not tested: {ruling.untested}" if ruling.untested else ruling.ours


def _ruled(claim: Claim, view: Any) -> Ruling:
    """What a rule says of a view, and whether that is more than chance."""
    ruling = claim.ours(view)
    if claim.chance is None or ruling.untested:
        return ruling
    return replace(ruling, untested=claim.chance(view, claim.ours))
