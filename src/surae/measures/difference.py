"""A measure or parameter at two sessions: its difference, and the answer in one sentence."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from surae.base.file_form import filed
from surae.base.words import Message
from surae.inference.judging.parameter import percent
from surae.measures.plain import PLAIN, plain_name

#: Sentences at most, of what was asked.
_MOST_SAID = 4


class ChangeVerdict(StrEnum):
    """Judgement of one difference."""

    CHANGED = "changed"
    NONE_SHOWN = "no change shown"
    NOT_COMPARABLE = "not comparable"


@filed("name", "kind", sparse=("from_deg", "to_deg", "ci95_device"))
@dataclass(frozen=True, slots=True)
class Difference:
    """One measure or parameter of two sessions."""

    #: `name`, `unit`, `meaning`, `kind`: as of `Quantity`.
    name: str
    unit: str
    meaning: str
    kind: str
    #: `before`, `after`: values; None where there is none.
    before: float | None
    after: float | None
    difference: float | None  #: After minus before; None where it cannot be compared.
    ci95: tuple[float, float] | None  #: Its 95 % interval.
    #: p-value of no difference: Holm's among what was asked, else of the false discovery rate.
    p: float | None
    #: Smallest change that these recordings would show in four of five cases.
    smallest: float | None
    verdict: ChangeVerdict  #: ``changed``, ``no change shown`` or ``not comparable``.
    note: str  #: The verdict in a plain sentence: a `Message`, unless it was read from a file.
    #: `from_deg`, `to_deg`: as of `Measure`.
    from_deg: float | None = None
    to_deg: float | None = None
    #: Of a measure at a stated angle that rest tells: of what differs at one angle of the device,
    #: how the foot is mounted in it.
    ci95_device: tuple[float, float] | None = None
    asked: bool = False  #: Whether it was asked beforehand.
    #: ``"rest"``: read from rest, or from maximal efforts less the rest before them, no muscles'
    #: fit in it; or ``"model"``, of that fit.
    basis: str = "model"


def with_part(said: Message, change: float, of: Difference) -> Message:
    """What is said of a change, in percent of the value before too, where that means something."""
    if of.unit == "deg" or not of.before or abs(change) > 10.0 * abs(of.before):
        return said
    return Message("{said} ({percent})", said=said, percent=percent(abs(change / of.before)))


def sentence_of(every: Sequence[Difference], looked: int, *, legs: bool) -> Message:
    """The answer: a sentence of each that was asked, else of what changed most clearly."""
    asked = [d for d in every if d.asked]
    if len(asked) > 1:
        sentences = [_said_of(d, looked, legs=legs) for d in asked[:_MOST_SAID]]
        said = sentences[0]
        for each in sentences[1:]:
            said = Message("{said} {more}", said=said, more=each)
        return said
    lead = _lead(asked or [d for d in every if d.kind == "measure"])
    if lead is None or (lead.p is None and not lead.asked):
        return Message("change/said/nothing")
    return _said_of(lead, looked, legs=legs)


def _said_of(lead: Difference, looked: int, *, legs: bool) -> Message:
    """A sentence with direction, amount, interval, and what would have been shown."""
    what = plain_name(lead.name)
    if lead.difference is None or lead.ci95 is None or lead.p is None:
        return Message("change/said/none", what=what, why=lead.note)
    unit = lead.unit.strip("-").replace("deg", "°")

    def sized(size: float, of: float) -> Message:
        return with_part(Message("{size:.2g} {unit}", size=size, unit=unit), of, lead)

    said = {
        "what": what,
        "low": Message("{end:.2g}", end=lead.ci95[0]),
        "high": Message("{end:.2g}", end=lead.ci95[1]),
    }
    side = "legs" if legs else "visits"
    smallest = sized(lead.smallest or 0.0, lead.smallest or 0.0)
    size = lead.difference
    if lead.verdict is not ChangeVerdict.CHANGED:
        code = f"change/said/not-shown/{side}"
        return Message(code, **said, difference=sized(size, size), smallest=smallest)
    kind = "asked" if lead.asked else "explored"
    more: dict[str, object] = {"smallest": smallest} if lead.asked else {"n": looked}
    direction = "more" if size > 0.0 else "less"
    return Message(
        f"change/said/{kind}/{direction}/{side}", **said, amount=sized(abs(size), size), **more
    )


def _lead(every: Sequence[Difference]) -> Difference | None:
    """What a sentence is about: the surest change, else the first that was judged."""
    changed = [d for d in every if d.verdict is ChangeVerdict.CHANGED]
    if changed:
        return min(changed, key=lambda d: d.p or 0.0)
    order = list(PLAIN)
    named = [d for d in every if d.asked or d.name.partition("@")[0] in PLAIN]
    if named and not named[0].asked:
        named.sort(key=lambda d: order.index(d.name.partition("@")[0]))
    judged = [d for d in named if d.p is not None]
    return next(iter(judged or named), None)
