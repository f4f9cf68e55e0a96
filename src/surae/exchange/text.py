"""XML as text, with comments."""

import xml.etree.ElementTree as ET


def row(*values: float | str) -> str:
    """Numbers, or words, as XML has them."""
    return " ".join(v if isinstance(v, str) else f"{v:.12g}" for v in values)


def text_of(root: ET.Element, comments: list[str]) -> str:
    """A file of one element, with comments in it before all else."""
    for place, comment in enumerate(comments):
        # two hyphens would end a comment
        root.insert(place, ET.Comment(f" {comment.replace('--', '- -')} "))
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"
