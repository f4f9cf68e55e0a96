"""The judgement of a whole fit, and the reasons that lead to it."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import StrEnum

from surae.base.file_form import filed
from surae.base.records import OrNaN
from surae.inference.judging.reasons import Reason, Scope


class Grade(StrEnum):
    """Judgement of a whole fit."""

    ADEQUATE = "adequate"
    DOUBTFUL = "doubtful"
    INADEQUATE = "inadequate"


@filed(against="codes", reasons="reasons")
@dataclass(frozen=True, slots=True)
class Adequacy:
    """Whether a fit is good enough for its numbers to mean something."""

    grade: Grade  #: ``inadequate`` withholds every claim; ``doubtful`` asks for caution.
    against: tuple[Reason, ...]  #: The gravest first; empty for an adequate fit.
    #: Centred R² over all recordings, 100·(1 − Σe²/Σ(T − T̄)²) [%]; NaN without a finite torque.
    r2: OrNaN

    def doubt_of(self, rests_on: Collection[Scope]) -> Reason | None:
        """Find what speaks against a value.

        Parameters
        ----------
        rests_on : collection of Scope
            What of the fit the value rests on (`scopes_of`); empty where that is not known.

        Returns
        -------
        Reason or None
            The gravest doubt that touches it.
        """
        return next((reason for reason in self.against if reason.touches(rests_on)), None)

    @property
    def reasons(self) -> tuple[str, ...]:
        """What speaks against it, in sentences, the gravest first."""
        return tuple(map(str, self.against))


def graded(reasons: Iterable[Reason], r2: float) -> Adequacy:
    """The judgement that reasons lead to, the gravest first."""
    ordered = tuple(sorted(reasons, key=lambda reason: not reason.is_grave))
    grade = Grade.ADEQUATE
    if ordered:
        grade = Grade.INADEQUATE if ordered[0].is_grave else Grade.DOUBTFUL
    return Adequacy(grade, ordered, r2)
