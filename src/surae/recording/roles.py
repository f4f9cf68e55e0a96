"""Which signal a channel seems to be, by the words in its name; every guess says its rule.

A name is cut into words at whatever is no letter or digit, and where small letters turn into
capitals. In this order:

1. Our own names (``torque_Nm``) state role and unit.
2. Words of another joint (knee, hip, subtalar, …) or of a sensor that measures something else
   (acceleration, gyroscope, force plate, marker) mean: no role. ``MX`` to ``MZ`` are moments of a
   force plate or load cell.
3. ``torque``, ``moment``: the torque. ``velocity``, ``speed``, ``omega``: the angular velocity.
   ``acceleration`` with ``ankle`` or ``angular``: the angular acceleration. ``angle``,
   ``position``, ``dorsiflexion``, ``goniometer``: the angle. They are *named* with the word
   ankle, *likely* without. German, Dutch and French words count alike.
4. Muscles: tibialis anterior, gastrocnemius lateralis and medialis and soleus, in full or as
   ``tib_ant``, ``lat_gas``, ``med_gas`` (*named*); as ``TA``, ``GL``, ``LG``, ``GM``, ``MG``,
   ``SOL`` (*likely*, *named* with the word EMG).
   With ``fascicle``, ``FL`` or ``pennation``, ``PEN``, that of the muscle in a film.
5. ``gas`` without its head, ``tibialis`` without anterior or posterior, EMG without a muscle: no
   role, but the channels that could be one.
6. A unit of torque, angle or EMG (mV, µV) alone: *possible*; never written into a mapping as if it
   were known.

The words ``r``, ``right``, ``l``, ``left`` say the side. A unit that cannot be the role's (``N``
for a torque) makes it less certain, and an EMG only *possible*; it must be said what it is.
"""

import itertools
import re
import tomllib
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

from surae.base.errors import InputError
from surae.base.units import FACTORS, kind, plain, spelled, stated, to_si
from surae.recording.recording import FILMED, MUSCLE_NAMES, MUSCLES, ROLES

#: Column names of the time, and their factor to seconds.
TIMES: Mapping[str, float] = {f"time_{unit}": factor for unit, factor in FACTORS["time"].items()}


def _suffixes(role: str) -> dict[str, str]:
    """Units of a role by how they are written at the end of a column's name."""
    return {unit.replace("/", "_"): unit for unit in FACTORS[kind(role)]}


def _spellings(role: str) -> tuple[str, ...]:
    """A role's own name, and where it is of the tibialis, that with the name of its EMG."""
    return (role, f"{role[:-4]}_ta") if role.endswith("_tib") else (role,)


#: Role and unit of every column name that is ours.
NAMES: Mapping[str, tuple[str, str]] = {
    f"{name}_{suffix}": (role, unit)
    for role in ROLES
    for name in _spellings(role)
    for suffix, unit in _suffixes(role).items()
}


def role_and_unit(name: str, where: str) -> tuple[str, str] | None:
    """Role and unit that a column's name states, or None for a column that isn't ours.

    ``torque_passive_Nm`` and ``angle_rad_target`` are other quantities'; a name of ours that has no
    unit, or one that is not known, is refused.
    """
    name = plain(name)
    if name in NAMES:
        return NAMES[name]
    for role, spelling in ((each, spelled_so) for each in ROLES for spelled_so in _spellings(each)):
        if name.casefold() != spelling and not name.casefold().startswith(f"{spelling}_"):
            continue
        suffixes = _suffixes(role)
        suffix = name[len(spelling) + 1 :]
        if not suffix:
            ours = ", ".join(f"{spelling}_{known}" for known in suffixes)
            raise InputError(f"{where}: the unit is missing; write one of: {ours}")
        if suffix in suffixes:
            raise InputError(f"{where}: write it in small letters, {spelling}_{suffix}")
        if any(suffix.endswith(f"_{k}") or suffix.startswith(f"{k}_") for k in suffixes):
            return None
        to_si(role, suffix, where)
    return None


Confidence = Literal["stated", "named", "likely", "possible"]
Side = Literal["left", "right"]

#: From what the file states in our own words to what only a unit suggests.
CONFIDENCES: tuple[Confidence, ...] = ("stated", "named", "likely", "possible")

#: The words of names, by what they say.
WORDS: Mapping[str, Any] = tomllib.loads(
    files("surae.recording").joinpath("roles.toml").read_text(encoding="utf-8")
)
_ANKLE, _OTHER_JOINTS, _OTHER_SENSORS, _PLATE, _TORQUE, _VELOCITY, _ACCELERATION, _ANGLE, _EMG = (
    set(WORDS[each])
    for each in (
        "ankle",
        "other_joints",
        "other_sensors",
        "plate",
        "torque",
        "velocity",
        "acceleration",
        "angle",
        "emg",
    )
)
_LATERAL, _MEDIAL, _GASTROCNEMIUS, _TIBIALIS, _ANTERIOR, _OTHER_MUSCLES, _FRAMES = (
    set(WORDS[each])
    for each in (
        "lateral",
        "medial",
        "gastrocnemius",
        "tibialis",
        "anterior",
        "other_muscles",
        "frames",
    )
)
_SIDES, _WHOLE, _SHORT, _OF_OTHER_JOINTS = (
    {word: says for says, words in WORDS[each].items() for word in words}
    for each in ("sides", "whole", "short", "of_other_joints")
)
_FORCE = set(WORDS["force"])
#: Units of force, in small letters.
_FORCES = ("n", "kn", "newton", "newtons", "lbf", "lb", "kgf", "kg", "kp", "v", "mv")
#: Those that say a force alone, and what is in kilograms and none.
_FORCES_ALONE = ("n", "kn", "newton", "newtons", "lbf", "kgf", "kg", "kp")
_WEIGHTS = {"mass", "weight", "bodyweight", "bw", "masse", "gewicht", "poids", "peso", "massa"}
_FILMS: Mapping[str, Sequence[str]] = WORDS["films"]

_CAMEL = re.compile(
    r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])"
)
_BETWEEN = re.compile(r"[^0-9A-Za-z]+")
#: Joint and quantity in one word, as German and Dutch write them.
_COMPOUND = re.compile(
    r"^(enkel|sprunggelenk|knie|heup|huft)(?:gelenk|gewrichts)?s?"
    r"(winkel|hoek|(?:dreh|kracht)?moment|koppel|geschwindigkeit|snelheid)$"
)
#: A unit that a heading ends with: "Angle (deg)", "Moment [N.m]", "TA,uV"; "ankle_angle_deg".
_BRACKETED = re.compile(r".*\S\s*(?:\(\s*([^()]+?)\s*\)|\[\s*([^\[\]]+?)\s*\]|,\s*([^\s,]+))")
_COLON = re.compile(r".*\S\s*:\s*([^\s:]+)")
_SUFFIXED = re.compile(
    r".*[^\W_][_ ](deg|rad|mm|cm|Nm|mNm|Nmm|[mu\N{MICRO SIGN}\N{GREEK SMALL LETTER MU}]V)"
)


#: The thesis's symbol of the torque, with a unit or none; its time is a small t.
_SYMBOL = re.compile(r"T(?:_\w+|\s*[(\[][^()\[\]]*[)\]])?")
#: A coordinate of a point of motion capture.
_COORDINATE = re.compile(r".+\.([XYZ])")


@dataclass(frozen=True, slots=True)
class Guess:
    """What a channel seems to be."""

    #: The roles that it could have: one, or several where the name leaves it open (gastrocnemius
    #: without its head).
    roles: tuple[str, ...]
    confidence: Confidence  #: How plainly the name says it.
    rule: str  #: The rule that was applied, in plain words.
    side: Side | None = None  #: The leg that the name says.

    @property
    def role(self) -> str | None:
        """The role, None where the name leaves several open."""
        return self.roles[0] if len(self.roles) == 1 else None


def guess_role(name: str, unit: str | None = None) -> Guess | None:
    """Guess a channel's role from its name and the unit that its file states.

    None: nothing in the name is of the ankle.
    """
    if plain(name) in NAMES:
        role, unit_of_name = NAMES[plain(name)]
        return Guess((role,), "stated", f"{role} in {unit_of_name}: a name of surae's own format")
    if _SYMBOL.fullmatch(name.strip()) and unit_kind(unit) in (None, "torque"):
        return Guess(("torque",), "likely", "T, the symbol of the torque")
    words = words_of(name)
    word = _first(words, _SIDES)
    side = _SIDES[word] if word else None
    suggested = unit_kind(unit)
    match = _film(words) or _quantity(words) or _muscle(words)
    if match is None and ": " in name:  # behind the name of a device, which says less
        last = words_of(name.rpartition(": ")[2])
        match = _quantity(last) or _muscle(last)
    if match is None:
        return _by_unit(words, unit, side)
    roles, confidence, rule = match
    of_kind = tuple(role for role in roles if kind(role) == suggested)
    if len(roles) > 1 and len(of_kind) == 1:
        roles, confidence, rule = (
            of_kind,
            "likely",
            f"{rule.partition(',')[0]}, and its unit {unit}",
        )
    emg = roles[0].startswith("emg_")
    if suggested is not None and all(kind(role) != suggested for role in roles):
        if unit_is_volts(unit):
            rule += "; in volts: give the sensor's scale"
        else:
            rule += f"; but its unit {unit} is none of {'EMG' if emg else roles[0]}"
            vague = emg or (confidence != "named" and suggested != "other")
            confidence = "possible" if vague else "likely"
    if (coordinate := _COORDINATE.fullmatch(name)) is not None and not emg:
        if coordinate[1] != "X":
            confidence = "possible"
            rule = f"{rule}, but not its first coordinate"
        else:
            rule += "; X of three coordinates, the flexion in most models"
    return Guess(roles, confidence, rule, side)


def _by_unit(
    words: Sequence[str], unit: str | None, side: Literal["left", "right"] | None
) -> Guess | None:
    """What a channel may be by its unit alone, where its name says nothing of the ankle."""
    suggested = unit_kind(unit)
    if _is_load(words, unit) or _is_force(words, unit):
        rule = "a force: a torque once it is multiplied by its lever arm [m] (scale)"
        return Guess(("torque",), "possible", rule, side)
    known = {*words} & (_OTHER_JOINTS | _OTHER_SENSORS | _OTHER_MUSCLES | _PLATE)
    of_unit = {"torque": ("torque",), "angle": ("angle",), "emg": _EMGS}.get(suggested or "")
    if not of_unit or known or unit == "V":  # volts are of any sensor
        return None
    called = "EMG" if of_unit is _EMGS else suggested
    return Guess(of_unit, "possible", f"only its unit, {unit}, is one of {called}", side)


def _is_load(words: Sequence[str], unit: str | None) -> bool:
    """Whether a channel is the force of a load cell, and of no plate or other joint."""
    said = plain(unit or "").strip().casefold()
    others = _PLATE | _OTHER_JOINTS | _OTHER_MUSCLES | (_OTHER_SENSORS - _FORCE - {"forces"})
    numbered = any(word.isdigit() for word in words)
    return bool({*words} & _FORCE) and not {*words} & others and said in _FORCES and not numbered


def _is_force(words: Sequence[str], unit: str | None) -> bool:
    """Whether a channel is in a unit of force alone, and by its name of nothing else."""
    others = _PLATE | _OTHER_JOINTS | _OTHER_MUSCLES | _OTHER_SENSORS | _ANGLE | _EMG | _WEIGHTS
    numbered = any(word.isdigit() for word in words)
    said = plain(unit or "").strip().casefold()
    return said in _FORCES_ALONE and not {*words} & others and not numbered


def _first(words: Sequence[str], vocabulary: Collection[str]) -> str:
    """The first of the words that is in a vocabulary; empty where none is."""
    return next((word for word in words if word in vocabulary), "")


def other_joint(name: str) -> str | None:
    """The joint, other than the ankle, whose angle, torque or velocity a name says; else None."""
    words = words_of(name)
    if {*words} & _ANKLE or not {*words} & (_ANGLE | _TORQUE | _VELOCITY):
        return None
    return _first(words, _OTHER_JOINTS) or None


def is_plate_moment(name: str, unit: str | None = None) -> bool:
    """Whether a channel is a moment of a force plate or load cell, by its name and unit."""
    vocabulary = set(words_of(name))
    return bool(vocabulary & _PLATE) and bool(
        vocabulary & (_TORQUE | {"mx", "my", "mz"}) or unit_kind(unit) == "torque"
    )


def joint_of_muscles(names: Sequence[str]) -> str | None:
    """The other joint that all muscles in a recording are of; None where one may be the ankle's."""
    joints = set()
    for name in names:
        if _muscle(words_of(name)) is not None:
            return None
        joints |= {_OF_OTHER_JOINTS[word] for word in words_of(name) if word in _OF_OTHER_JOINTS}
    return joints.pop() if len(joints) == 1 else None


def words_of(name: str) -> tuple[str, ...]:
    """The words of a name, small and without accents: ``"EMG_TA"``, ``"Accélération"``."""
    bare = "".join(
        c for c in unicodedata.normalize("NFKD", plain(name)) if not unicodedata.combining(c)
    )
    parts = (part for piece in _BETWEEN.split(bare) for part in _CAMEL.split(piece))
    words = (_COMPOUND.sub(r"\1 \2", part.casefold()).split() for part in parts if part)
    return tuple(itertools.chain.from_iterable(words))


def unit_kind(unit: str | None) -> str | None:
    """The kind of signal that has this unit, None where it is missing or no unit known here."""
    known = stated(unit)
    return None if known is None else known.kind


def heading_unit(name: str) -> str | None:
    """The unit that a channel's name ends with, as written there; None where it ends with none.

    Only what is a unit of the signals that are read here counts: "EMG (left)" states none, nor
    does "EMG (1)", which numbers its sensor.
    """
    text = name.strip()
    if len(text) > _SHORTEST.get(unit_kind(text) or "", len(text)):  # Biodex: N-M, Degrees
        return text
    match = _BRACKETED.fullmatch(text) or _SUFFIXED.fullmatch(text) or _COLON.fullmatch(text)
    if match is None:
        return None
    unit = next(text for text in match.groups() if text is not None)
    return unit if unit != "1" and unit_kind(unit) not in (None, "other", "time") else None


def unknown_unit(name: str) -> str | None:
    """What stands in a name where a unit would be, and is none that is known; None for words."""
    match = _BRACKETED.fullmatch(name.strip())
    text = next((text for text in match.groups() if text), "") if match else ""
    words = {*words_of(text)}
    known = {*_SIDES, *_WHOLE, *_SHORT} | _ANKLE | _EMG | _ANGLE | _TORQUE | _NO_UNITS
    letters = any(c.isalpha() or c in "%°" for c in text)
    return text if text and letters and len(text) <= _LONGEST and not words & known else None


def unit_is_volts(unit: str | None) -> bool:
    """Whether a unit is one of voltage, as of a sensor that was not calibrated."""
    return unit is not None and spelled(unit) in ("V", "mV", "uV")


#: A name that is a unit says so where it is longer: deg may be a name of its own.
_SHORTEST = {"angle": 5, "torque": 2}
#: A unit is no longer, and none of these words.
_LONGEST = 12
_NO_UNITS = {
    "raw",
    "filtered",
    "rectified",
    "rms",
    "env",
    "norm",
    "anat",
    "x",
    "y",
    "z",
    "s",
    "ch",
}
_Match = tuple[tuple[str, ...], Confidence, str]


def _quantity(words: tuple[str, ...]) -> _Match | None:
    """Angle, torque and derivatives of the angle."""
    present = {*words}
    ankle = _first(words, _ANKLE)
    if present & (_OTHER_JOINTS | _EMG | (_OTHER_SENSORS | _PLATE) - _ACCELERATION):
        return None
    for role, vocabulary in _QUANTITIES.items():
        word = _first(words, vocabulary)
        other = role == "angular_acceleration" and not (ankle or "angular" in present)
        if word and not other:
            if ankle:
                return (role,), "named", f"the words {ankle} and {word}"
            return (role,), "likely", f"the word {word}; no joint is named"
    if ankle and not present & _OTHER_SENSORS:
        return ("angle", "torque"), "possible", "the ankle, but not whether angle or torque"
    return None


def _film(words: tuple[str, ...]) -> _Match | None:
    """A fascicle's length or pennation, of a muscle that the name may say."""
    seen, word = next(
        ((seen, word) for seen, known in _FILMS.items() if (word := _first(words, known))), ("", "")
    )
    if not seen or _first(words, _FRAMES):
        return None
    match = _muscle(words)
    muscles = FILMED if match is None else [role[4:].replace("ta", "tib") for role in match[0]]
    roles = tuple(f"{seen}_{muscle}" for muscle in muscles)
    if match is None or len(roles) > 1:
        return roles, "possible", f"the word {word}; the muscle is not named"
    return roles, "named", f"the word {word}, and {match[2]}"


def _two_words(words: tuple[str, ...]) -> _Match | None:
    """A muscle by two words of its name, or by a letter behind one."""
    present = {*words}
    for first, other, role, rule in _TWO_WORDS:
        if present & first and present & other:
            return (role,), "named", rule
    for vocabulary, letter, role, rule in _IN_TURN:
        behind = any(a in vocabulary and b == letter for a, b in itertools.pairwise(words))
        # L is the side unless the side stands before it: LGasL.
        if behind and (letter != "l" or words.count("l") + words.count("r") > 1):
            return (role,), "likely", rule
    return None


def _muscle(words: tuple[str, ...]) -> _Match | None:
    """EMG of one of the four muscles: by its name, or by shorthand."""
    present = {*words}
    if present & (_OTHER_SENSORS | _OTHER_JOINTS):
        return None
    if (two := _two_words(words)) is not None:
        return two
    if whole := _first(words, _WHOLE):
        return (_WHOLE[whole],), "named", f"the muscle {whole}"
    if present & _OTHER_MUSCLES:
        return None
    if short := _first(words, _SHORT):
        rule = f"{short.upper()}, short for {MUSCLE_NAMES[_SHORT[short][4:]]}"
        rule += " (not gluteus?)" if short == "gm" else ""
        named = bool(present & _EMG)
        return (_SHORT[short],), "named" if named else "likely", rule + ", with EMG" * named
    vague = ((roles, rule) for vocabulary, roles, rule in _VAGUE if present & vocabulary)
    return next(((roles, "possible", rule) for roles, rule in vague), None)


_QUANTITIES = {
    "torque": _TORQUE,
    "angular_velocity": _VELOCITY,
    "angular_acceleration": _ACCELERATION,
    "angle": _ANGLE,
}
_TWO_WORDS = (
    (_GASTROCNEMIUS, _LATERAL, "emg_gl", "gastrocnemius and lateralis"),
    (_GASTROCNEMIUS, _MEDIAL, "emg_gm", "gastrocnemius and medialis"),
    (_TIBIALIS, _ANTERIOR, "emg_ta", "tibialis and anterior"),
)
_IN_TURN = (
    (_GASTROCNEMIUS, "l", "emg_gl", "gastrocnemius L, for lateralis, behind the side"),
    (_GASTROCNEMIUS, "m", "emg_gm", "gastrocnemius M, for medialis"),
    (_TIBIALIS, "a", "emg_ta", "tibialis A, for anterior"),
)
_EMGS = tuple(f"emg_{muscle}" for muscle in MUSCLES)
_VAGUE: tuple[tuple[set[str], tuple[str, ...], str], ...] = (
    (_GASTROCNEMIUS, ("emg_gl", "emg_gm"), "gastrocnemius, but not which head"),
    (_TIBIALIS, ("emg_ta",), "tibialis, but not whether anterior"),
    (_EMG, _EMGS, "an EMG, but not of which muscle"),
)
