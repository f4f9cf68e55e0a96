"""A claim of the thesis, and what became of it here: plain data."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, Self

Verdict = Literal["holds", "differs", "cannot be checked"]
#: In the order in which they are counted.
VERDICTS: tuple[Verdict, ...] = ("holds", "differs", "cannot be checked")


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """What the thesis says, and when we say that it holds.

    Attributes
    ----------
    name : str
        Short and unique in its section, of letters, digits and hyphens.
    source : str
        Sections and figures of the thesis, e.g. ``"3.1.2, Figure 11a"``.
    text : str
        The claim, in one sentence.
    number : str
        The thesis's number with its unit; what it shows, where it gives no number.
    rule : str
        The numeric rule by which the claim holds, stated with the claim; never changed for a
        verdict.
    """

    name: str
    source: str
    text: str
    number: str
    rule: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What became of a claim.

    Attributes
    ----------
    claim : Claim
        The claim.
    ours : str
        Our number in the thesis's unit; empty where there is none.
    verdict : {"holds", "differs", "cannot be checked"}
        What the rule says.
    reason : str
        Why it differs or cannot be checked, supported by numbers; a remark where it holds.
    figure : str
        Name of the section's figure that shows it; empty where none does.

    Raises
    ------
    ValueError
        It differs or cannot be checked without a reason, or has a verdict without a number.
    """

    claim: Claim
    ours: str
    verdict: Verdict
    reason: str = ""
    figure: str = ""

    def __post_init__(self) -> None:
        """Refuse what a reader could not follow."""
        if self.verdict not in VERDICTS:
            raise ValueError(f"{self.claim.name}: unknown verdict {self.verdict!r}")
        if self.verdict != "holds" and not self.reason.strip():
            raise ValueError(f"{self.claim.name}: {self.verdict} without a reason")
        if self.verdict != "cannot be checked" and not self.ours.strip():
            raise ValueError(f"{self.claim.name}: {self.verdict} without a number")

    def plain(self) -> dict[str, Any]:
        """As plain data for a JSON file."""
        return asdict(self)

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Self:
        """From `plain`; TypeError, KeyError or ValueError where it is no such data."""
        return cls(**{**data, "claim": Claim(**data["claim"])})


def judged(
    claim: Claim, holds: bool, ours: str, *, why: str = "", remark: str = "", figure: str = ""
) -> Finding:
    """The finding of a claim that was checked.

    Parameters
    ----------
    claim : Claim
        The claim.
    holds : bool
        What its rule says.
    ours : str
        Our number.
    why : str
        Why it differs; used only where it does.
    remark : str
        What to know where it holds.
    figure : str
        Name of the figure that shows it.
    """
    return Finding(
        claim=claim,
        ours=ours,
        verdict="holds" if holds else "differs",
        reason=remark if holds else why,
        figure=figure,
    )


def unchecked(claim: Claim, why: str, *, ours: str = "", figure: str = "") -> Finding:
    """The finding of a claim that cannot be checked here."""
    return Finding(claim=claim, ours=ours, verdict="cannot be checked", reason=why, figure=figure)
