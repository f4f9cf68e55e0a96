"""A joint as data: what turns it to either side, its constants with their sources, and its words.

The ankle of the thesis is the first. Names in files stay the ankle's: `tri` is the group that
lengthens as the angle rises, `tib` its antagonist, whatever the joint calls them.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import PathLike, shown
from surae.base.frozen import FrozenDict

#: Parameters that every joint has to state: the ankle's would be wrong for any other.
STATED = ("m", *(f"{of}_{g}" for of in ("k", "x0", "l0", "dlt", "fmax") for g in ("tri", "tib")))


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class Value:
    """Where a fit of a joint starts, what it keeps to, and what is known beforehand."""

    start: float  #: Also the median of its prior, in the parameter's unit.
    lower: float
    upper: float
    spread: float  #: Standard deviation of the logarithm.
    source: str


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class Joint:
    """A joint that two groups of muscles turn.

    Raises
    ------
    InputError
        A constant is missing or not physical.
    """

    name: str  #: The joint, such as ``ankle``.
    body: str  #: What has the joint, such as ``leg``.
    limb: str  #: What turns about it, such as ``foot``.
    #: `groups`, `short`: the muscles that lengthen as the angle rises (`tri` in files) and their
    #: antagonists (`tib`), by their names and in a word.
    groups: tuple[str, str]
    short: tuple[str, str]
    #: Muscles of the channels ``emg_ta`` (an antagonist), ``emg_gl``, ``emg_sol``, ``emg_gm``;
    #: empty where the joint has none, whose weight is then 0.
    muscles: tuple[str, str, str, str]
    directions: tuple[str, str]  #: Of a rising and of a falling angle.
    #: From the axis to the point in which all mass is thought to be, and to the strap [m].
    distance: float
    slack: tuple[float, float]  #: Slack lengths of both groups' tendons [m].
    source: str  #: Where the constants are from.
    #: What is otherwise than at the ankle, all of `STATED` included.
    parameters: Mapping[str, Value] = field(default_factory=FrozenDict)
    #: Priors of what the laboratory cannot rule out, mean and sd, where they are otherwise.
    nuisances: Mapping[str, tuple[float, float]] = field(default_factory=FrozenDict)
    #: By language, what stands in place of the ankle's words on the leg's page.
    words: Mapping[str, Mapping[str, str]] = field(default_factory=FrozenDict)

    def __post_init__(self) -> None:
        """Refuse what is no joint."""
        where = f"joint {self.name!r}"
        if not all(v > 0.0 for v in (self.distance, *self.slack)):
            raise InputError(f"{where}: distance and slack must be positive")
        if not (self.muscles[0] and any(self.muscles[1:])):
            raise InputError(f"{where}: a group has no muscle; name one of each")
        for name, v in self.parameters.items():
            if not (0.0 < v.lower <= v.start <= v.upper and v.spread > 0.0):
                raise InputError(
                    f"{where}: {name} must be above zero and within its bounds, its spread too"
                )

    @property
    def headings(self) -> tuple[str, str]:
        """The groups' names with a capital."""
        first, second = (group[:1].upper() + group[1:] for group in self.groups)
        return first, second

    @property
    def silent(self) -> tuple[int, ...]:
        """The channels, of TA, GL, SOL, GM, that stand for no muscle."""
        return tuple(i for i, muscle in enumerate(self.muscles) if not muscle)

    def worded(self, text: str, language: str = "en") -> str:
        """A text about the ankle in the words of this joint, before anything is filled into it.

        What stands in braces is filled in later and stays.

        Raises
        ------
        InputError
            The joint has no words in this language.
        """
        if self.name == ANKLE.name:
            return text
        if language != "en" and language not in self.words:
            raise InputError(
                f"joint {self.name!r} has no words in {language!r}; give [words.{language}]"
            )
        words = _words(self) if language == "en" else self.words[language]
        words = {word.lower(): instead for word, instead in words.items()}
        return _pattern(language).sub(
            lambda match: _as(match[0], words[match[0].lower()]) if match["word"] else match[0],
            text,
        )


def _words(joint: Joint) -> dict[str, str]:
    """What the ankle's words are for a joint."""
    group = joint.groups[0]
    (first, second) = joint.short
    muscles = zip(ANKLE.muscles[1:], joint.muscles[1:], strict=True)
    heads = [muscle for muscle in joint.muscles[1:] if muscle]
    return {
        "ankle": joint.name,
        "ankles": f"{joint.name}s",
        "leg": joint.body,
        "legs": f"{joint.body}s",
        "foot": joint.limb,
        "footplate": f"{joint.limb} plate",
        "triceps surae": group,
        "calf": group,
        "calf muscles": group,
        "triceps": first,
        "achilles tendon": f"tendon of the {group}",
        "tibialis anterior": joint.groups[1],
        "perpendicular to the shank": "at 0°",
        "tibialis": second,
        "soleus and both gastrocnemii": " and ".join(heads),
        "gastrocnemius": heads[-1],
        **{of: named or "no muscle" for of, named in muscles},
        **dict(zip(ANKLE.directions, joint.directions, strict=True)),
    }


def _as(written: str, instead: str) -> str:
    """A word with a capital where the one in its place has it."""
    return instead[:1].upper() + instead[1:] if written[:1].isupper() else instead


#: The ankle, by the thesis: la of equation (6), lt0 of Table 2.
ANKLE = Joint(
    name="ankle",
    body="leg",
    limb="foot",
    groups=("triceps surae", "tibialis anterior"),
    short=("triceps", "tibialis"),
    muscles=(
        "tibialis anterior",
        "gastrocnemius lateralis",
        "soleus",
        "gastrocnemius medialis",
    ),
    directions=("dorsiflexion", "plantarflexion"),
    distance=0.15,
    slack=(0.415, 0.216),
    source="van de Poll (2015)",
    words=FrozenDict(
        {
            language: FrozenDict({word: word for word in words.split("|")})
            for language, words in (
                (
                    "nl",
                    "enkel|kuit|kuitkracht|tibialis|soleus en beide gastrocnemii|dorsaalflexie|"
                    "plantairflexie|been|benen|voet|voetplaat",
                ),
                (
                    "de",
                    "Sprunggelenk|Sprunggelenks|Wade|Wadenkraft|Tibialis|"
                    "Soleus und beide Gastrocnemii|Dorsalextension|Plantarflexion|dieses Bein|"
                    "dieses Beins|des Beins|erstes Bein|zweites Bein|das andere Bein|"
                    "Bein|Beine|den Fuß|des Fußes|Fuß|Fußplatte",
                ),
                (
                    "fr",
                    "la cheville|mollet|du mollet|tibial|du tibial|"
                    "le soléaire et les deux gastrocnémiens|flexion dorsale|de flexion dorsale|"
                    "flexion plantaire|de flexion plantaire|première jambe|deuxième jambe|"
                    "les jambes|la jambe|cette jambe|l’autre jambe|jambe|le pied|du pied",
                ),
            )
        }
    ),
)


@cache
def _pattern(language: str) -> re.Pattern[str]:
    """The ankle's words in a language, or a place to be filled in."""
    words = sorted(_words(ANKLE) if language == "en" else ANKLE.words[language], key=len)
    return re.compile(rf"\{{[^{{}}]*\}}|\b(?P<word>{'|'.join(reversed(words))})\b", re.IGNORECASE)


def read_joint(path: PathLike) -> Joint:
    """A joint from a TOML file, whose keys are the fields of `Joint`.

    Raises
    ------
    InputError
        It cannot be read, or is no joint.
    """
    from surae.base.records import from_file, read_toml

    joint = from_file(Joint, path, read_toml(path))
    if missing := [name for name in STATED if name not in joint.parameters]:
        raise InputError(f"{shown(path)}: parameters: {', '.join(missing)} missing; state them")
    for language, words in joint.words.items():
        if missing := [word for word in ANKLE.words.get(language, ()) if word not in words]:
            raise InputError(f"{shown(path)}: words.{language}: {', '.join(missing)} missing")
    return joint
