"""Which of another program's muscle parameters say something of the person, and which do not.

What is said of a value needs no knowledge of the person: it stands at a limit of its search, is the
number that the search began from or a plain part of it, is shared by muscles at the end of what
any of them has, or is none that a human has.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from surae.base.words import Message
from surae.exchange.against_recording import LEAST, AgainstRecording
from surae.exchange.foreign_result import ForeignResult, ForeignValue
from surae.exchange.humans import GENERIC, range_of

#: How near to a limit, of the range between limits, a value stands at it: optimisers end a little
#: inside, and one of 1000 values that are anywhere stands there too.
AT_LIMIT = 1e-3
#: How near two numbers are the same, relatively: files round to seven digits.
SAME = 1e-6
#: How near a ratio is a plain one, and the plain ones: multiples of a twentieth. Solvers that relax
#: their bounds end by 1e-8 of the force or length beyond them.
PLAIN = 2e-5
_PLAIN = 0.05
#: As many values together at the end of what any muscle has are a limit that no file states.
SHARED = 3


@dataclass(frozen=True, slots=True)
class Remark:
    """One thing said of a value."""

    #: "at-limit", "at-shared-end", "generic", "generic-scaled", "plain-part", "outside-human",
    #: "at-start", "contradicted".
    kind: str
    sentence: str  #: A `Message`.


@dataclass(frozen=True, slots=True)
class JudgedValue:
    """A value with what is said of it."""

    of: ForeignValue
    remarks: tuple[Remark, ...]

    @property
    def kinds(self) -> tuple[str, ...]:
        """What kinds of things are said of it."""
        return tuple(remark.kind for remark in self.remarks)


def judged(result: ForeignResult) -> tuple[JudgedValue, ...]:
    """Every value of a result with what is said of it."""
    shared = _shared_ends(result)
    scaled = _scaled_generic(result.values)
    made = []
    for value in result.values:
        remarks = [
            *_limit(value),
            *_origin(value),
            *scaled.get((value.muscle, value.parameter), ()),
            *_human(value, result.mass),
        ]
        kinds = {remark.kind for remark in remarks}
        if not kinds & {"at-limit", "generic", "at-start", "generic-scaled"}:
            remarks = [*shared.get((value.muscle, value.parameter), ()), *remarks]
        made.append(JudgedValue(value, tuple(remarks)))
    return tuple(made)


def with_recording(
    values: Sequence[JudgedValue], recorded: AgainstRecording
) -> tuple[JudgedValue, ...]:
    """Values with what a recording says against them."""
    verdicts = recorded.verdicts()
    against = {
        (each.muscle, each.parameter): each
        for each in recorded.told
        if verdicts[each.muscle, each.parameter] == "contradicted"
    }
    made = []
    for value in values:
        each = against.get((value.of.muscle, value.of.parameter))
        if each is None:
            made.append(value)
            continue
        said = Message("opinion/contradicted", better=1e3 * each.better, gain=each.gain)
        made.append(JudgedValue(value.of, (Remark("contradicted", said), *value.remarks)))
    return tuple(made)


def recording_said(of: AgainstRecording) -> Message:
    """What a recording says of all muscles together."""
    code = "opinion/followed" if of.r2 >= LEAST else "opinion/not-followed"
    return Message(code, recording=of.recording, r2=of.r2)


def disputed_said(of: AgainstRecording) -> Message | None:
    """Which muscles the recording opposes without telling which of them; None where none."""
    muscles = sorted({m for (m, _), verdict in of.verdicts().items() if verdict == "disputed"})
    return Message("opinion/disputed", muscles=", ".join(muscles)) if muscles else None


def same(one: float, other: float, by: float = SAME) -> bool:
    """Whether two numbers are the same but for rounding."""
    return abs(one - other) <= by * max(abs(one), abs(other), 1e-12)


def _limit(value: ForeignValue) -> Iterable[Remark]:
    """Whether it stands at a limit of its search."""
    low, high = value.low, value.high
    if low is None or high is None or not high > low:
        return
    near = AT_LIMIT * (high - low)
    for end, which in ((low, "lower"), (high, "upper")):
        if abs(value.value - end) <= near:
            yield Remark("at-limit", Message(f"opinion/at-limit-{which}", limit=end))
            return
        if (which == "lower" and value.value < end) or (which == "upper" and value.value > end):
            yield Remark("at-limit", Message("opinion/beyond-limit", limit=end))
            return


def _origin(value: ForeignValue) -> Iterable[Remark]:
    """Whether it is what it began from, or a plain part of it."""
    began = value.generic
    if began is None or began == 0.0:
        return
    if same(value.value, began):
        # of the muscle's activation there is a start, of its anatomy a generic value
        code = "generic" if _is_anatomy(value) else "at-start"
        yield Remark(code, Message(f"opinion/{code}"))
        return
    ratio = value.value / began
    plain = round(ratio / _PLAIN) * _PLAIN
    if plain > 0.0 and abs(ratio - plain) <= PLAIN * plain and _is_anatomy(value):
        yield Remark("plain-part", Message("opinion/plain-part", part=plain))


def _is_anatomy(value: ForeignValue) -> bool:
    return value.parameter in (
        "optimal_fiber_length",
        "tendon_slack_length",
        "max_isometric_force",
        "pennation_angle",
        "max_contraction_velocity",
        "tendon_strain",
        "tendon_stiffness",
    )


def _human(value: ForeignValue, mass: float | None) -> Iterable[Remark]:
    """Whether no human has it."""
    if value.generic == 1.0 and value.parameter.endswith("_length"):
        return  # a part of a length, not a length
    ends = range_of(value.anatomy, value.parameter, mass)
    if ends is None or ends[0] <= value.value <= ends[1]:
        return
    factor, unit = {"m": (1e3, "mm"), "s": (1e3, "ms"), "rad": (57.29577951308232, "°")}.get(
        value.unit, (100.0, "%")
    )
    low, high = (factor * end for end in ends)
    yield Remark("outside-human", Message("opinion/outside-human", low=low, high=high, unit=unit))


def _shared_ends(result: ForeignResult) -> Mapping[tuple[str, str], tuple[Remark, ...]]:
    """Values that stand together at the end of what any muscle of the result has."""
    remarks: dict[tuple[str, str], tuple[Remark, ...]] = {}
    by_parameter: dict[str, list[tuple[float, ForeignValue]]] = defaultdict(list)
    for value in result.values:
        if value.low is not None and value.high is not None:
            continue
        number = value.value
        if _is_anatomy(value):  # lengths and forces differ from muscle to muscle: their parts
            if not value.generic or same(value.value, value.generic):
                continue
            number = value.value / value.generic
        by_parameter[value.parameter].append((number, value))
    for values in by_parameter.values():
        for end, together in _ends(values):
            said = Remark(
                "at-shared-end",
                Message("opinion/at-shared-end", count=len(together), end=end),
            )
            remarks.update({(v.muscle, v.parameter): (said,) for v in together})
    return remarks


def _ends(
    values: Sequence[tuple[float, ForeignValue]],
) -> Iterable[tuple[float, list[ForeignValue]]]:
    """Ends of a set of numbers at which several stand."""
    numbers = [number for number, _ in values]
    low, high = min(numbers), max(numbers)
    if not high > low:
        return
    groups = _grouped(numbers)
    for end in (low, high):
        near = [(n, v) for n, v in values if abs(n - end) <= AT_LIMIT * (high - low)]
        different = len({n for n, _ in near}) if groups else len(near)
        if different >= SHARED:
            yield end, [v for _, v in near]


def _grouped(numbers: Sequence[float]) -> bool:
    """Whether muscles share their numbers in groups, as a search may be told to have them.

    Then equal numbers lie between the ends too.
    """
    low, high = min(numbers), max(numbers)
    inside = [n for n in numbers if low < n < high]
    return any(count > 1 for count in Counter(inside).values())


def _scaled_generic(
    values: Sequence[ForeignValue],
) -> Mapping[tuple[str, str], tuple[Remark, ...]]:
    """Fibres and tendons that are a public model's, scaled alike with the body."""
    lengths: dict[str, dict[str, ForeignValue]] = defaultdict(dict)
    for value in values:
        lengths[value.muscle][value.parameter] = value
    remarks = {}
    for muscle, of in lengths.items():
        fibre = of.get("optimal_fiber_length")
        tendon = of.get("tendon_slack_length")
        if fibre is None or tendon is None or not tendon.value > 0.0:
            continue
        if fibre.generic is not None or tendon.generic is not None:
            if fibre.generic and tendon.generic and not same(fibre.value, fibre.generic):
                scales = fibre.value / fibre.generic, tendon.value / tendon.generic
                if same(*scales, by=PLAIN) and not same(scales[0], 1.0):
                    said = Message("opinion/generic-scaled", model="", scale=scales[0])
                    pair = (Remark("generic-scaled", said),)
                    remarks[muscle, fibre.parameter] = remarks[muscle, tendon.parameter] = pair
            continue
        for model, muscles in GENERIC.items():
            if fibre.anatomy not in muscles:
                continue
            own_fibre, own_tendon, own_force = muscles[fibre.anatomy]
            scale = fibre.value / own_fibre
            if same(scale, tendon.value / own_tendon, by=PLAIN) and 0.5 < scale < 1.5:
                said = Message("opinion/generic-of-model", model=model, scale=scale)
                pair = (Remark("generic-scaled", said),)
                remarks[muscle, fibre.parameter] = remarks[muscle, tendon.parameter] = pair
                force = of.get("max_isometric_force")
                if force is not None and same(force.value, own_force, by=1e-4):
                    said = Message("opinion/generic-force", model=model)
                    remarks[muscle, force.parameter] = (Remark("generic", said),)
                break
    return remarks


def counted(values: Iterable[JudgedValue]) -> dict[str, int]:
    """How many values each kind of thing is said of."""
    counts = Counter(kind for value in values for kind in set(value.kinds))
    return dict(sorted(counts.items(), key=lambda item: -item[1]))


def parts(value: ForeignValue) -> float | None:
    """The value as a part of what it began from; None where that is not known."""
    began = value.generic
    return None if not began or not math.isfinite(began) else value.value / began
