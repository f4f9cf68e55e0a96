"""A claim of the thesis as a row of data, the one judge of all of them, and what it finds."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Generic, Literal, Self, TypeVar

Data = TypeVar("Data")
Verdict = Literal[
    "holds", "holds under a reading", "holds with the thesis's integrator", "differs",
    "cannot be checked",
]  # fmt: skip
#: In the order in which they are counted.
VERDICTS: tuple[Verdict, ...] = (
    "holds", "holds under a reading", "holds with the thesis's integrator", "differs",
    "cannot be checked",
)  # fmt: skip
#: The view that is the thesis's own way to integrate the tendon, where we have another.
INTEGRATOR = "the thesis's integrator"


class NotThereError(LookupError):
    """What a claim needs was not computed, or failed."""


@dataclass(frozen=True, slots=True)
class Ruling:
    """What a claim's rule says of one view of the numbers.

    Attributes
    ----------
    holds : bool
        Whether the claim holds there.
    ours : str
        Our number, in the thesis's unit.
    """

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
    """

    id: str
    source: str
    statement: str
    number: str
    rule: str
    ours: Callable[[Data], Ruling]
    why: str | Callable[[Data], str] = ""
    figure: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What became of a claim, as plain data.

    Attributes
    ----------
    id, source, statement, number, rule, figure : str
        Of the claim.
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
    verdict: Verdict
    said: str
    ours: Mapping[str, tuple[bool, str]] = field(default_factory=dict)
    reason: str = ""
    figure: str = ""

    def plain(self) -> dict[str, Any]:
        """As plain data for a JSON file."""
        return asdict(self)

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Self:
        """From `plain`; TypeError, KeyError or ValueError where it is no such data."""
        ours = {name: (bool(holds), str(text)) for name, (holds, text) in data["ours"].items()}
        if data["verdict"] not in VERDICTS:
            raise ValueError(data["verdict"])
        return cls(**{**data, "ours": ours})


def judge(claim: Claim[Data], views: Mapping[str, Data]) -> Finding:
    """What a claim's rule says of every view of the numbers, in one verdict.

    It *holds* when it does so in every view but that of the thesis's integrator; *holds under* the
    readings, where it does so in some; *holds with the thesis's integrator*, where in that alone;
    and else *differs*.

    Parameters
    ----------
    claim : Claim
        The claim.
    views : mapping of str to data
        By name; the first is the one that is explained.
    """
    rulings: dict[str, Ruling] = {}
    missing = ""
    for name, data in views.items():
        try:
            rulings[name] = claim.ours(data)
        except NotThereError as error:
            missing = str(error)
    readings = [name for name in views if name != INTEGRATOR]
    held = [name for name in readings if name in rulings and rulings[name].holds]
    verdict: Verdict
    if not any(name in rulings for name in readings):
        verdict = said = "cannot be checked"
    elif held == readings:
        verdict = said = "holds"
    elif held:
        verdict, said = "holds under a reading", f"holds under {' and '.join(held)}"
    elif INTEGRATOR in rulings and rulings[INTEGRATOR].holds:
        verdict = said = "holds with the thesis's integrator"
    else:
        verdict = said = "differs"
    first = next(iter(views.values()))
    reason = missing if verdict == "cannot be checked" else claim.why
    if callable(reason):
        try:
            reason = reason(first)
        except NotThereError as error:
            reason = str(error)
    return Finding(
        id=claim.id,
        source=claim.source,
        statement=claim.statement,
        number=claim.number,
        rule=claim.rule,
        verdict=verdict,
        said=said,
        ours={name: (bool(ruling.holds), ruling.ours) for name, ruling in rulings.items()},
        reason=reason.strip(),
        figure=claim.figure,
    )
