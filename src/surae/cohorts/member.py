"""The rows of a cohort and the sessions of each leg."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from surae.base.errors import InputError
from surae.base.files import natural_order
from surae.measures.compared import Quantities


@dataclass(frozen=True, slots=True)
class CohortMember:
    """One row of a cohort."""

    #: `subject`, `side`, `group`, `session`: whose leg it is, and when it was measured; sessions
    #: are in the order of their names.
    subject: str
    side: str
    group: str
    session: str
    scales: Mapping[str, float]  #: Clinical scales of this row.
    quantities: Quantities | None  #: Of its fit; None where there is none.
    missing: str = ""  #: Why there is no fit.

    @property
    def leg(self) -> str:
        """Subject and side."""
        return " ".join(part for part in (self.subject, self.side) if part)

    @property
    def row(self) -> str:
        """Leg and session."""
        return " ".join(part for part in (self.leg, self.session) if part)


def sessions_of(members: Sequence[CohortMember]) -> dict[str, list[CohortMember]]:
    """The sessions of each leg, in order."""
    sessions: dict[str, list[CohortMember]] = {}
    for member in sorted(members, key=lambda m: natural_order(m.session)):
        before = sessions.setdefault(member.leg, [])
        if any(m.session == member.session for m in before):
            raise InputError(f"cohort: {member.leg} is there twice in session {member.session!r}")
        if before and before[0].group != member.group:
            raise InputError(f"cohort: {member.leg} is in two groups")
        before.append(member)
    return sessions
