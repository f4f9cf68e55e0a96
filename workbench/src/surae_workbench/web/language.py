"""The reader's language, and what templates and scripts say in it."""

import json
from functools import cache
from typing import Any

from babel import negotiate_locale
from fastapi import Request
from markupsafe import Markup

from surae import api
from surae.base.names import LANGUAGES


def language_of(request: Request) -> str:
    """The language that was chosen in this browser, else the one that it asks for, else English."""
    chosen = request.cookies.get("surae-language")
    if chosen in LANGUAGES:
        return chosen
    asked = request.headers.get("accept-language", "")[:200].split(",")
    return negotiate_locale([a.partition(";")[0].strip() for a in asked], LANGUAGES, "-") or "en"


def spoken(request: Request) -> dict[str, Any]:
    """What every template is filled with: `_`, its language, the messages of its scripts."""
    language = language_of(request)
    return {"_": api.words_in(language), "language": language, "messages": _messages(language)}


#: Codes of sentences on fits, which no script says.
_NOT_ON_PAGES = (
    "against/",
    "alone/",
    "apart/",
    "beyond/",
    "change/",
    "ended/",
    "identify/",
    "interval/",
    "kind/",
    "made/",
    "measure/",
    "none/",
    "plainly/",
    "step/",
)


@cache
def _messages(language: str) -> Markup:
    """What pages say of the catalogue, as JSON that no tag can end."""
    every = api.words_in(language).messages.items()
    said = {m: text for m, text in every if not m.startswith(_NOT_ON_PAGES)}
    return Markup(json.dumps(said).replace("<", "\\u003c"))
