"""The claims of the thesis, rows of data in this folder's TOML files, and their one judge.

Beside its texts a row names the function that computes our number and decides (``ours``), what that
is given (``given``), the group of views that it is judged under, the functions that explain our
number, with their arguments (``explain``), and why it differs, where it does (``cause``). The texts
may name what is given in braces, so that a rule in words and its computation read the same number;
``each`` makes several claims of one row.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from importlib.resources import files
from typing import Any

#: In the order in which they are counted.
VERDICTS = (
    "holds", "holds under a reading", "holds with the thesis's integrator", "differs",
    "cannot be checked",
)  # fmt: skip
#: The view that is the thesis's own way to integrate the tendon, where we have another.
INTEGRATOR = "the thesis's integrator"
#: What a second look at a claim that differs found: the thesis contradicts itself or is wrong; our
#: virtual cohort is not its subjects; our fits fall short; or what decides it is not published.
CAUSES = ("the thesis", "our cohort", "our fits", "not published")
#: The texts of a row.
_TEXTS = ("id", "source", "statement", "number", "rule", "why", "figure", "cause")


class NotThereError(LookupError):
    """What a claim needs was not computed, or failed."""


@dataclass(frozen=True, slots=True)
class Ruling:
    """Whether a claim holds in one view of the numbers, and our number in the thesis's unit."""

    holds: bool
    ours: str


@dataclass(frozen=True, slots=True)
class Claim:
    """What the thesis says, how we compute it, and when we say that it holds.

    Attributes
    ----------
    id : str
        Short and unique in its section, of letters, digits and hyphens.
    source : str
        Sections and figures of the thesis, e.g. ``"3.1.2, Figure 11a"``.
    statement, number : str
        The claim in one sentence; the thesis's number with its unit, or what it shows.
    rule : str
        The numeric rule by which the claim holds; never changed for a verdict.
    ours : callable
        From a view of the section's numbers to its `Ruling`; NotThereError where it cannot say.
    why, figure : str
        What explains our number; the section's figure that shows it. Empty where nothing does.
    views : tuple of str
        Those of the section's views that it is judged under; all of them where it names none.
    explain : callable, optional
        From the view that is looked at first, and the claim, to what stands before `why`.
    cause : str
        One of `CAUSES`, where the claim differs.
    given : mapping
        What `ours` was given.
    """

    id: str
    source: str
    statement: str
    number: str
    rule: str
    ours: Callable[[Any], Ruling]
    why: str = ""
    figure: str = ""
    views: tuple[str, ...] = ()
    explain: "Callable[[Any, Claim], str] | None" = None
    given: Mapping[str, Any] = field(default_factory=dict)
    cause: str = ""


def judge_all(section: str, views: Mapping[str, Any], *modules: str) -> "tuple[JudgedClaim, ...]":
    """Judge every claim of a section; see `read_claims` and `judge`."""
    return tuple(judge(claim, views) for claim in read_claims(section, *modules))


def read_claims(section: str, *modules: str) -> tuple[Claim, ...]:
    """The claims of a section, whose functions are in modules of these names."""
    rules = {k: v for name in modules for k, v in vars(import_module(name)).items()}
    text = files(__name__).joinpath(f"{section}.toml").read_text(encoding="utf-8")
    content = tomllib.loads(text)
    groups = content.get("views", {})
    return tuple(
        _claim(row | case, rules, groups)
        for row in content["claim"]
        for case in row.pop("each", [{}])
    )


def _claim(row: dict[str, Any], rules: Mapping[str, Any], groups: Mapping[str, list[str]]) -> Claim:
    arguments_of_rule = row.pop("given", {})
    texts = {key: value.format(**{**row, **arguments_of_rule}) for key, value in row.items()}
    calls = [call.split() for call in texts["explain"].split(";")] if "explain" in texts else []

    def explained(view: Any, claim: Claim) -> str:
        return " ".join(rules[name](view, claim, *arguments) for name, *arguments in calls)

    return Claim(
        ours=partial(rules[texts["ours"]], **arguments_of_rule),
        explain=explained if calls else None,
        given=arguments_of_rule,
        views=tuple(groups[texts["views"]]) if "views" in texts else (),
        **{key: text for key, text in texts.items() if key in _TEXTS},
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedClaim:
    """What became of a claim, as plain data; what is not named here is the claim's.

    Attributes
    ----------
    verdict, said : str
        One of `VERDICTS`; the same in full: under which readings, or by what cause it differs.
    ours : mapping of str to (bool, str)
        By view, whether it holds and our number; the one key is empty where there is one view.
    reason : str
        What explains it.
    """

    id: str
    source: str
    statement: str
    number: str
    rule: str
    verdict: str
    said: str
    ours: Mapping[str, tuple[bool, str]] = field(default_factory=dict)
    reason: str = ""
    figure: str = ""

    def __post_init__(self) -> None:
        """Refuse a verdict that there is not: a damaged file."""
        if self.verdict not in VERDICTS:
            raise ValueError(self.verdict)


def judge(claim: Claim, views: Mapping[str, Any]) -> JudgedClaim:
    """What a claim's rule says of its views of the numbers, in one verdict.

    It *holds* when it does so in every view but that of the thesis's integrator; *holds under* the
    readings, where it does so in some; *holds with the thesis's integrator*, where in that alone;
    and else *differs*.

    Parameters
    ----------
    claim : Claim
        The claim.
    views : mapping of str to data
        By name; the first of the claim's is the one that is explained.
    """
    views = {name: views[name] for name in claim.views if name in views} if claim.views else views
    rulings: dict[str, tuple[bool, str]] = {}
    missing = ""
    for name, data in views.items():
        try:
            ruling = claim.ours(data)
        except NotThereError as error:
            missing = str(error)
        else:
            rulings[name] = bool(ruling.holds), ruling.ours
    readings = [name for name in views if name != INTEGRATOR]
    holding = [name for name in readings if name in rulings and rulings[name][0]]
    reason = claim.why
    if not any(name in rulings for name in readings):
        verdict = said = "cannot be checked"
        reason = missing
    elif holding == readings:
        verdict = said = "holds"
    elif holding:
        verdict, said = "holds under a reading", f"holds under {' and '.join(holding)}"
    elif rulings.get(INTEGRATOR, (False, ""))[0]:
        verdict = said = "holds with the thesis's integrator"
    else:
        verdict, said = "differs", f"differs: {claim.cause}" if claim.cause else "differs"
    if claim.explain and verdict != "cannot be checked":
        try:
            reason = f"{claim.explain(next(iter(views.values())), claim)} {reason}"
        except NotThereError as error:
            reason = str(error)
    return JudgedClaim(
        id=claim.id, source=claim.source, statement=claim.statement, number=claim.number,
        rule=claim.rule, verdict=verdict, said=said, ours=rulings, reason=reason.strip(),
        figure=claim.figure,
    )  # fmt: skip
