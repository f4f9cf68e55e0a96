"""Words that judge: one record each, of which colours, styles and the leg's page are made."""

from typing import Literal, NamedTuple


def N_(message: str) -> str:
    """Mark a message of the catalogue that `surae.report.language.Words` translates later."""
    return message


class Judgement(NamedTuple):
    """What a word means to the eye, and how the leg's page puts it."""

    role: Literal["good", "weak", "bad", "quiet"]
    plain: str = ""


JUDGEMENTS = {
    "identified": Judgement("good", N_("known")),
    "weak": Judgement("weak", N_("roughly")),
    "undetermined": Judgement("weak", N_("not known")),
    "at-bound": Judgement("bad", N_("at its limit")),
    "fixed": Judgement("quiet", N_("assumed")),
    "changed": Judgement("good", N_("changed")),
    "no change shown": Judgement("weak", N_("none shown")),
    "not comparable": Judgement("quiet", N_("not comparable")),
    **dict.fromkeys(("adequate", "holds"), Judgement("good")),
    **dict.fromkeys(("doubtful", "warning", "cannot be checked"), Judgement("weak")),
    **dict.fromkeys(("inadequate", "error", "differs"), Judgement("bad")),
    "info": Judgement("quiet"),
}
