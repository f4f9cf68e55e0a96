"""The leg's page in the reader's language: one gettext catalogue, and numbers as written there.

English messages stand in the source, in calls of `Words` that are named ``_``, or marked by `N_`.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from gettext import NullTranslations
from io import BytesIO

from surae.base.formatting import check_known, ends, of_interval
from surae.base.names import LANGUAGES
from surae.base.words import N_, Message, Values, catalogue, english
from surae.measures.plain import PLAIN
from surae.model.joint import ANKLE, Joint
from surae.quality.finding import KINDS, Finding

#: What measures, and one parameter, are called, in the order in which they are shown.
MEASURES = PLAIN
#: Parts of the torque: the measures of their shares.
PARTS = {
    "tissue_share": N_("tissue"),
    "neural_share": N_("muscle"),
    "gravity_share": N_("weight"),
    "inertia_share": N_("inertia"),
}
#: Groups of the norms that come with surae.
GROUPS = (N_("healthy adults"), N_("spastic ankles after stroke"))


class Words:
    """The page's messages in one language, of one joint; one without catalogue is refused.

    A joint's words stand in a message before anything is filled in.
    """

    def __init__(self, language: str = "en", joint: Joint = ANKLE) -> None:
        check_known("language", LANGUAGES, language)
        self.language = language
        self._joint = joint
        self._decimal = "."
        self._messages = NullTranslations()
        self.messages: dict[str, str | Sequence[str]] = {**english()}
        if language != "en":
            from babel.messages.mofile import write_mo
            from babel.messages.pofile import read_po
            from babel.numbers import get_decimal_symbol
            from babel.support import Translations

            self._decimal = get_decimal_symbol(language)
            compiled = BytesIO()
            with catalogue(language).open("rb") as text:
                messages = read_po(text, language)
            write_mo(compiled, messages)
            #: Translations by the English messages, several forms as a list: what scripts read.
            self.messages = {
                m.id if isinstance(m.id, str) else m.id[0]: m.string or () for m in messages if m.id
            }
            compiled.seek(0)
            self._messages = Translations(compiled)

    def __call__(self, message: str, **given: str) -> str:
        """A message, filled in, its own values included."""
        values: Mapping[str, object] = given
        code = message
        if isinstance(message, Message):
            code = message.code
            values = message.values
        text = self._messages.gettext(code) if code else ""
        if self.language == "en":
            text = english().get(code, text)
        text = self._joint.worded(text, self.language)
        return _Values(self).vformat(text, (), values) if values else text

    def many(self, one: str, several: str, n: int, **given: str) -> str:
        """The message for so many; ``{n}`` in it is their number."""
        text = self._joint.worded(self._messages.ngettext(one, several, n), self.language)
        return text.format(n=n, **given)

    def number(self, text: str) -> str:
        """A number, or several in a text without words, as they are written here."""
        return text.replace(".", self._decimal)

    def estimate(self, value: float, ci95: tuple[float, float] | None) -> tuple[str, str]:
        """A value and its 95 % interval, ``"0.18 to 0.24"``."""
        text = self.number(of_interval(value, ci95).value)
        return text, "" if ci95 is None else self.span(*ends(value, ci95))

    def span(self, low: str, high: str) -> str:
        """From one number to another."""
        return self("{low} to {high}", low=self.number(low), high=self.number(high))

    def angle(self, degrees: float) -> str:
        """An angle of the ankle with its direction."""
        text = self.number(f"{abs(degrees):g}°")
        if degrees == 0.0:
            return text
        if degrees > 0.0:
            return self("{angle} dorsiflexion", angle=text)
        return self("{angle} plantarflexion", angle=text)

    def measure(self, name: str) -> str:
        """What a measure is called; its own name where the page has none."""
        base = name.partition("@")[0]
        return self(MEASURES[base], at=self.point(name)) if base in MEASURES else name

    def point(self, name: str) -> str:
        """The angle, torque or time at which a measure is given."""
        at = name.partition("@")[2]
        if at.endswith("deg"):
            return self.angle(float(at.removesuffix("deg")))
        if at.endswith("Nm"):
            return f"{at.removesuffix('Nm')} Nm"
        return f"{at.removesuffix('s')} s"

    def finding(self, finding: Finding) -> str:
        """What was found and what to do; of one that was read from a file, what such are of."""
        if isinstance(finding.message, Message):
            return f"{self(finding.message)} {self(finding.advice)}"
        kind = KINDS[finding.code]
        return f"{self.sentence(kind.looks_for)} {self(kind.advice)}"

    def sentence(self, message: str) -> str:
        """A message as a sentence of its own."""
        text = self(message)
        return f"{text[:1].upper()}{text[1:]}."


class _Values(Values):
    """What fills in a message, in a language."""

    def __init__(self, words: Words) -> None:
        self._words = words

    def format_field(self, value: object, form: str) -> str:
        """Give messages and numbers as they are there."""
        if isinstance(value, Message):
            return self._words(value)
        text = super().format_field(value, form)
        return text if isinstance(value, str) else self._words.number(text)


#: The messages of a language and a joint, read once.
words_in = cache(Words)
