"""The sentences of the clinical page, from clinical.toml, in one language."""

import tomllib
from functools import cache
from importlib.resources import files

from surae.errors import InputError
from surae.names import LANGUAGES


class Words:
    """The sentences of one language."""

    def __init__(self, language: str) -> None:
        if language not in LANGUAGES:
            known = ", ".join(LANGUAGES)
            raise InputError(f"no page in language {language!r}; use one of: {known}")
        self.language = language

    def __call__(self, key: str, **given: str) -> str:
        """A sentence, filled in."""
        text = sentences()[key][self.language]
        return text.format(**given) if given else text

    def number(self, text: str) -> str:
        """A number as it is written here."""
        return text if self.language == "en" else text.replace(".", ",")

    def angle(self, degrees: float) -> str:
        """An angle of the ankle with its direction."""
        return self("dorsal" if degrees >= 0.0 else "plantar", degrees=f"{abs(degrees):g}°")

    def own(self, text: str) -> str:
        """A text of a norm, translated where the page knows it."""
        return self(text) if text in sentences() else text

    def measure(self, name: str) -> str:
        """What a measure is called here; its own name where the page has none."""
        base, _, at = name.partition("@")
        if base not in sentences():
            return name
        at = at.replace("deg", "°").replace("s", " s").replace("-", "−")
        return self(base).replace("{at}", at)


@cache
def sentences() -> dict[str, dict[str, str]]:
    """Every sentence by its key and language."""
    text = files("surae.report").joinpath("clinical.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)
