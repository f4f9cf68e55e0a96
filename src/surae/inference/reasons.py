"""What speaks against a fit: by code, its sentence, and what the leg's page says of it."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from surae.base.frozen import FrozenDict
from surae.base.words import N_

#: What the page says where it has nothing plainer.
_WEAKNESS = N_("the fit has a weakness, see the details in English")
#: By code the sentence, in which values stand by name, and what the page says.
_SAID: dict[str, tuple[str, str]] = {
    "failed": ("the fit failed", N_("the fit failed")),
    "not-followed": (
        "the model does not follow the torque's changes (centred R² {r2:.1f} %)",
        N_("the model does not follow the torque"),
    ),
    "followed-roughly": (
        "the torque's changes are followed only roughly (centred R² {r2:.1f} %)",
        N_("the model follows the torque only roughly"),
    ),
    "still": (
        "the {joint} hardly moves ({moved:.2g}° in all): nothing tells stiffness from strength",
        N_("the ankle hardly moves in these trials"),
    ),
    "moves-little": (
        "the {joint} moves little ({moved:.2g}° in all)",
        N_("the ankle moves little in these trials"),
    ),
    "emg-steady": (
        "the EMG of {muscles} hardly changes: its weight is a guess",
        N_("the EMG of a muscle hardly changes"),
    ),
    "left-out": (
        "{share:.0f} % of the residual follow angle, velocity or activation ({left_out:.1f} % of "
        "the torque's variance): the model leaves something out",
        N_("the model leaves something out"),
    ),
    "at-bound": ("at a bound: {names}", N_("a value lies at the end of what is allowed")),
    "implausible": (
        "{names}: implausible; check electrodes and set-up",
        N_("a value is implausible; check electrodes and set-up"),
    ),
    "contradicted": (
        "what was stated of the {label} contradicts the torque: measure it again, or leave it out",
        _WEAKNESS,
    ),
    "trial-not-followed": (
        "{trial} is not followed (R² {r2:.1f} %)",
        N_("the model does not follow one of the trials"),
    ),
    "hold-not-followed": (
        "{trial} is not followed ({error:.2g} Nm are left, {usual:.2g} Nm usually)",
        N_("the model does not follow one of the trials"),
    ),
    "film-rigid": (
        "{channel} of {trial}: the film shows the muscle move otherwise than the model, by "
        "{away:.1f} mm (standard deviation): its tendon is rigid",
        N_("the film shows the muscle move otherwise than the model"),
    ),
    "film-differs": (
        "{channel} of {trial}: the film shows the muscle move otherwise than the model, by "
        "{away:.1f} mm (standard deviation): or the film is wrong",
        N_("the film shows the muscle move otherwise than the model"),
    ),
    "softened": (
        "{trial}: passive tissue was {stiffer:.0f} % stiffer in the first stretches than in the "
        "last: it softened within the trial. Stretch it a few times before, or leave the first "
        "stretches out",
        N_("the leg softened during the trial"),
    ),
    "unchanging": ("the torque does not change", _WEAKNESS),
    "held-still": ("the {joint} holds still there: following it says little", _WEAKNESS),
    "errs": ("it errs by {error:.2g} Nm where the fit promises {promised:.2g} Nm", _WEAKNESS),
    "mean-off": (
        "its mean is off by {bias:+.2g} Nm: another zero of the sensor, or another {body}",
        _WEAKNESS,
    ),
    "said": ("{text}", _WEAKNESS),  # what was stated and is doubted, and all that older files have
}


@dataclass(frozen=True, slots=True)
class Reason:
    """One reason against a fit."""

    code: str  #: Which.
    #: What its sentence tells, by name: numbers, and names of parameters and recordings.
    values: Mapping[str, str | float] = FrozenDict()
    is_grave: bool = False  #: Whether nothing that the fit says counts.

    @property
    def plain(self) -> str:
        """What the leg's page says of it, a message of its catalogue."""
        return _SAID.get(self.code, _SAID["said"])[1]

    def __str__(self) -> str:
        """The sentence."""
        return _SAID[self.code][0].format(**self.values)


def against(code: str, *, grave: bool = False, **values: str | float) -> Reason:
    """A reason against a fit, with what its sentence tells."""
    return Reason(code, FrozenDict(values), grave)


def as_given(sentences: Sequence[str], saved: Sequence[Reason]) -> tuple[Reason, ...]:
    """Reasons of a file, each with the sentence that it was given there.

    Older files have sentences alone, and a newer surae may put a reason otherwise.
    """
    known = {}
    for reason in saved:
        with suppress(ArithmeticError, LookupError, TypeError, ValueError):
            known[str(reason)] = reason
    return tuple(known.get(text, against("said", text=text)) for text in sentences)
