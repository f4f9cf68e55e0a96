"""Texts from outside, such as names in files, of files and of streams, before they are shown."""

import re

#: Orders to a terminal: colours, the cursor's moves, a window's title (ECMA-48).
_ORDERS = re.compile(
    r"(?:\x1b\[|\x9b)[0-?]*[ -/]*[@-~]|\x1b[]PX^_][^\x07\x1b]*(?:\x07|\x1b\\)?|\x1b[ -/]*[0-~]?"
)
#: Bytes of a file's name that are no UTF-8, as Python has them (PEP 383).
_BYTES = re.compile("[\udc80-\udcff]+")


def cleaned(text: str, most: int = 200) -> str:
    """A text from outside in one printable line of at most `most` letters.

    Orders to a terminal are left out, every other letter that cannot be printed (controls, marks
    that turn the writing round, halves of a letter) becomes a question mark or, where it separates
    words, a space. Bytes that are no UTF-8 are read as Windows' Western letters (cp1252), which is
    what old archives hold. What remains can be encoded, and stand in XML.
    """
    text = _BYTES.sub(
        lambda found: found[0].encode("utf-8", "surrogateescape").decode("cp1252", "replace"),
        _ORDERS.sub("", text[: 100 * most]),
    )
    line = "".join(
        letter if letter.isprintable() else " " if letter.isspace() else "?" for letter in text
    ).strip()
    return line if len(line) <= most else f"{line[: most - 1]}…"
