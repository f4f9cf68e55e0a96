"""Words that judge: one record each, of which colours, styles and the clinical page are made."""

from typing import Literal, NamedTuple


class Text(NamedTuple):
    """One text in every language of the page for clinicians."""

    en: str
    nl: str
    de: str
    fr: str


class Judgement(NamedTuple):
    """What a word means to the eye, and what the clinical page says for it."""

    role: Literal["good", "weak", "bad", "quiet"]
    clinic: Text | None = None


JUDGEMENTS = {
    "identified": Judgement("good", Text("known", "bekend", "bekannt", "connu")),
    "weak": Judgement("weak", Text("roughly", "ruw", "grob", "approximatif")),
    "undetermined": Judgement("weak", Text("not known", "onbekend", "unbekannt", "inconnu")),
    "at-bound": Judgement(
        "bad", Text("at its limit", "op de grens", "an der Grenze", "à la limite")
    ),
    "fixed": Judgement("quiet", Text("assumed", "aangenomen", "angenommen", "supposé")),
    "changed": Judgement("good", Text("changed", "veranderd", "verändert", "changé")),
    "no change shown": Judgement(
        "weak", Text("none shown", "niet aangetoond", "nicht nachgewiesen", "non démontré")
    ),
    "not comparable": Judgement(
        "quiet",
        Text("not comparable", "niet vergelijkbaar", "nicht vergleichbar", "non comparable"),
    ),
    "adequate": Judgement("good"),
    "doubtful": Judgement("weak"),
    "inadequate": Judgement("bad"),
    "error": Judgement("bad"),
    "warning": Judgement("weak"),
    "info": Judgement("quiet"),
    "holds": Judgement("good"),
    "differs": Judgement("bad"),
    "cannot be checked": Judgement("weak"),
}
