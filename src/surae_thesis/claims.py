"""A claim of the thesis as a row of data, the one judge of all of them, and what it finds."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

Data = TypeVar("Data")
#: In the order in which they are counted.
VERDICTS = (
    "holds", "holds under a reading", "holds with the thesis's integrator", "differs",
    "cannot be checked",
)  # fmt: skip
#: The view that is the thesis's own way to integrate the tendon, where we have another.
INTEGRATOR = "the thesis's integrator"


class NotThereError(LookupError):
    """What a claim needs was not computed, or failed."""


@dataclass(frozen=True, slots=True)
class Ruling:
    """Whether a claim holds in one view of the numbers, and our number in the thesis's unit."""

    holds: bool
    ours: str


@dataclass(frozen=True, slots=True)
class Claim(Generic[Data]):
    """What the thesis says, how we compute it, and when we say that it holds.

    Attributes
    ----------
    id : str
        Short and unique in its section, of letters, digits and hyphens.
    source : str
        Sections and figures of the thesis, e.g. ``"3.1.2, Figure 11a"``.
    statement : str
        The claim, in one sentence.
    number : str
        The thesis's number with its unit; what it shows, where it gives no number.
    rule : str
        The numeric rule by which the claim holds; never changed for a verdict.
    ours : callable
        From a view of the section's numbers to its `Ruling`; NotThereError where it cannot say.
    why : str or callable
        What explains our number, from the view that is looked at first.
    figure : str
        Name of the section's figure that shows it; empty where none does.
    views : tuple of str
        Those of the section's views that it is judged under; all of them where it names none.
    """

    id: str
    source: str
    statement: str
    number: str
    rule: str
    ours: Callable[[Data], Ruling]
    why: str | Callable[[Data], str] = ""
    figure: str = ""
    views: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What became of a claim, as plain data; what is not named here is the claim's.

    Attributes
    ----------
    verdict : str
        One of `VERDICTS`.
    said : str
        The verdict in full: under which readings.
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


def judge(claim: Claim[Data], views: Mapping[str, Data]) -> Finding:
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
    held = [name for name in readings if name in rulings and rulings[name][0]]
    if not any(name in rulings for name in readings):
        verdict = said = "cannot be checked"
    elif held == readings:
        verdict = said = "holds"
    elif held:
        verdict, said = "holds under a reading", f"holds under {' and '.join(held)}"
    elif rulings.get(INTEGRATOR, (False, ""))[0]:
        verdict = said = "holds with the thesis's integrator"
    else:
        verdict = said = "differs"
    reason = missing if verdict == "cannot be checked" else claim.why
    if callable(reason):
        try:
            reason = reason(next(iter(views.values())))
        except NotThereError as error:
            reason = str(error)
    return Finding(
        id=claim.id, source=claim.source, statement=claim.statement, number=claim.number,
        rule=claim.rule, verdict=verdict, said=said, ours=rulings, reason=reason.strip(),
        figure=claim.figure,
    )  # fmt: skip
