"""Why two values cannot be compared, and which fits are doubtful of their difference."""

from surae.base.words import Message
from surae.measures.compared import Quantities, Quantity

#: By how much two ranges may differ in which one stiffness is compared [deg].
_RANGES = 1.0


def doubt_of(name: str, before: Quantities, after: Quantities, *, legs: bool) -> str | None:
    """Which fits are doubtful of it: of unchanged pairs of a leg, such called one in four changed.

    A doubt that does not touch a value does not withhold its change; what both have by rest alone
    is not doubted with the fits.
    """
    pair = [side.by_name[name] for side in (before, after)]
    if all(q.basis == "rest" for q in pair):
        return next((q.doubt for q in pair if q.doubt), None)
    places = ("first", "second") if legs else ("before", "after")
    doubtful = [
        Message(f"change/doubtful/{place}", reason=str(doubt))
        for place, side in zip(places, (before, after), strict=True)
        if (doubt := side.adequacy.doubt_of(side.by_name[name].rests_on))
    ]
    if len(doubtful) < 2:
        return doubtful[0] if doubtful else None
    return Message("change/both", one=doubtful[0], other=doubtful[1])


def obstacle(before: Quantities, after: Quantities, a: Quantity | None, b: Quantity | None) -> str:
    """Why two values cannot be compared; empty where they can."""
    for side, when in ((a, "before"), (b, "after")):
        if side is None:
            return Message(f"change/not-estimated/{when}")
        if side.missing:
            both = a and b and a.missing == b.missing
            return side.missing if both else Message(f"change/only/{when}", why=side.missing)
    assert a is not None
    assert b is not None
    why = ""
    if before.options != after.options:
        every = sorted({*before.options, *after.options})
        differing = [n for n in every if before.options.get(n) != after.options.get(n)]
        why = Message("change/options", names=", ".join(differing))
    elif a.from_deg is not None and abs(a.from_deg - (b.from_deg or 0.0)) > _RANGES:
        why = Message("change/ranges")
    elif a.basis != b.basis:
        why = Message("change/bases")
    elif a.unit != b.unit:
        why = Message("change/units", before=a.unit, after=b.unit)
    elif a.kind == "parameter" and before.model != after.model:
        why = Message("change/models", before=before.model, after=after.model)
    return why
