"""What speaks against a fit: by code, its sentence, and what the leg's page says of it."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from surae.base.file_form import filed
from surae.base.frozen import FrozenDict
from surae.base.words import Message, english
from surae.model.laboratory import group_of


class Scope(StrEnum):
    """What of a fit a doubt touches, or a value rests on."""

    ALL = "all"  #: Everything that the fit says.
    #: What muscles make of their EMG: gains, optimal lengths, activation, tendons under it.
    MUSCLES = "muscles"
    RELAXED = "relaxed"  #: The relaxed curve: tissue, its relaxation, what weighs on the foot.


#: Groups of parameters and of nuisances that muscles have where they make force.
_OF_MUSCLES = (
    "active",
    "delay",
    "crosstalk",
    "rest",
    "shape",
    "release",
    "lag",
    "curves",
    "bridges",
    "reflex",
    "reflex_length",
    "reflex_force",
)
_OF_TISSUE = ("passive", "limb")
#: Part of a value's standard deviation from which on it rests on a parameter.
_MATTERS = 0.1


def scopes_of(parts: Iterable[tuple[str, str, float]]) -> frozenset[Scope]:
    """What a value rests on, of its parameters: the name of each, its group, and its part.

    A part is how much of the value's standard deviation comes from it; one that is hardly any does
    not count. Stretched tissue pulls through its tendon, which is no matter of the muscles where
    tissue has the larger part; else it is, for only contraction tells how a tendon stretches.
    """
    largest: dict[Scope, float] = {}
    tendon = 0.0
    for name, of, part in parts:
        group = group_of(name) or of
        if part < _MATTERS:
            continue
        if group in ("tendon", "toe"):
            tendon = max(tendon, part)
        elif group in (*_OF_MUSCLES, *_OF_TISSUE):
            scope = Scope.MUSCLES if group in _OF_MUSCLES else Scope.RELAXED
            largest[scope] = max(largest.get(scope, 0.0), part)
    if tendon > largest.get(Scope.RELAXED, 0.0):
        largest[Scope.MUSCLES] = tendon
    return frozenset(largest)


#: Reasons that other trials of a leg give against its fit; the first are of its stiffness at rest.
OF_STIFFNESS = ("other-slope", "other-holds", "other-stiffness", "apart")
OF_OTHER_TRIALS = (*OF_STIFFNESS, "misses-trial", "mean-of-trial", "error-stands")


@filed("says")
@dataclass(frozen=True, slots=True)
class Reason:
    """One reason against a fit."""

    code: str  #: Which.
    #: What its sentence tells, by name: numbers, and names of parameters and recordings.
    values: Mapping[str, str | float] = FrozenDict()
    is_grave: bool = False  #: Whether nothing that the fit says counts.
    #: What it touches; older files have none, and say it of everything.
    scope: Scope = Scope.ALL
    says: str = ""  #: The sentence: a `Message`, or as a file has it.

    def touches(self, rests_on: Collection[Scope]) -> bool:
        """Whether it is a doubt of a value that rests on these.

        One that is grave touches all, and any doubt a value of which it is not known.
        """
        everything = self.is_grave or self.scope is Scope.ALL or not rests_on
        return everything or self.scope in rests_on

    @property
    def plain(self) -> Message:
        """What the leg's page says of it."""
        code = f"plainly/{self.code}"
        return Message(code if code in english() else "plainly/said", **self.values)

    def __str__(self) -> str:
        """The sentence."""
        return self.says


def against(
    code: str,
    worded: Callable[[str], str] = str,
    /,
    *,
    grave: bool = False,
    scope: Scope = Scope.ALL,
    **values: str | float,
) -> Reason:
    """A reason against a fit, with what its sentence tells, whose words are `worded` as a joint's.

    `scope` is what of the fit it touches.

    ``said`` is what was stated and is doubted, and all that older files have.
    """
    says = Message(f"against/{code}", worded, **values)
    return Reason(code, FrozenDict(values), grave, scope, says)
