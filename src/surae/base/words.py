"""What is said: messages with their values, and words that judge, a record each."""

import json
import re
from collections.abc import Callable
from functools import cache
from string import Formatter
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable


def N_(message: str) -> str:
    """Mark a message of the catalogue that `surae.report.language.Words` translates later."""
    return message


class Message(str):
    """A sentence by its code in the catalogues, and the values that fill it in.

    As a text it is English, in the joint's words; `surae.report.language.Words` says it in every
    language. A value may be a message too; a code that no catalogue has is its own sentence.
    """

    code: str
    values: dict[str, Any]
    worded: Callable[[str], str]

    def __new__(cls, code: str, worded: Callable[[str], str] = str, /, **values: Any) -> "Message":
        """Fill in a sentence, whose words of the ankle are `worded` as the joint's before."""
        text = worded(english().get(code, code))
        made = super().__new__(cls, Values().vformat(text, (), values) if values else text)
        made.code = code
        made.values = values
        made.worded = worded
        return made

    def __getnewargs_ex__(self) -> tuple[tuple[Any, ...], dict[str, Any]]:
        return (self.code, self.worded), self.values

    @property
    def given(self) -> dict[str, Any]:
        """The values as texts and messages, as pages fill them in."""
        sentence = english().get(self.code, self.code)
        return {
            name: self.values[name].parts()
            if isinstance(self.values[name], Message)
            else Values().format_field(self.values[name], form or "")
            for _, name, form, _ in Formatter().parse(sentence)
            if name
        }

    def parts(self) -> dict[str, Any]:
        """What pages make it of, in the reader's language."""
        return {"message": self.code, "given": self.given}


class Values(Formatter):
    """What fills in a sentence: negative numbers have a minus sign."""

    def format_field(self, value: object, form: str) -> str:
        """Give a value as it stands in a text."""
        text = format(value, form)
        return text if isinstance(value, str) else text.replace("-", "−")


def catalogue(language: str) -> "Traversable":
    """Where the sentences of a language are."""
    from importlib.resources import files

    return files("surae") / f"report/locale/{language}/LC_MESSAGES/surae.po"


@cache
def english() -> dict[str, str]:
    """Sentences in English by their codes."""
    text = catalogue("en").read_text("utf-8")
    pairs = re.findall(r'^msgid (".+")\nmsgstr (".+")$', text, re.M)
    return {json.loads(code): json.loads(sentence) for code, sentence in pairs}


class Judgement(NamedTuple):
    """What a word that judges means to the eye, and how every page in English puts it."""

    role: Literal["good", "weak", "bad", "quiet"]
    plain: str = ""


#: The one table of words that judge: on pages each is translated, and has no second one.
JUDGEMENTS = {
    "identified": Judgement("good", N_("identified")),
    "weak": Judgement("weak", N_("weak")),
    "undetermined": Judgement("weak", N_("undetermined")),
    "at-bound": Judgement("bad", N_("at bound")),
    "fixed": Judgement("quiet", N_("fixed")),
    "changed": Judgement("good", N_("changed")),
    "no change shown": Judgement("weak", N_("no change shown")),
    "not comparable": Judgement("quiet", N_("not comparable")),
    **dict.fromkeys(("adequate", "holds"), Judgement("good")),
    **dict.fromkeys(("doubtful", "warning", "cannot be checked"), Judgement("weak")),
    **dict.fromkeys(("inadequate", "error", "differs"), Judgement("bad")),
    "info": Judgement("quiet"),
}
