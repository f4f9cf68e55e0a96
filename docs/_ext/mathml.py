"""Equations as MathML, which browsers draw by themselves: the site is read offline."""

import re

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

#: The number that the thesis gives an equation.
_TAG = re.compile(r"\\tag\{([^}]*)\}")
#: Words below a symbol, such as tri and elas,tri: upright, which variables are not.
_WORDS = re.compile(r"_\{([A-Za-z]{2,}(?:,\s*[A-Za-z0-9]+)*)\}")
#: A letter alone is drawn italic unless it says otherwise.
_LONE = re.compile(r"\\mathrm\{([A-Za-z])\}")
_MARK = "\ue000"


def mathml(source: str, display: str) -> str:
    """An equation as MathML.

    Parameters
    ----------
    source : str
        LaTeX.
    display : {"inline", "block"}
        In a line of text, or on its own.
    """
    source = _WORDS.sub(r"_{\\mathrm{\1}}", source)
    source = _LONE.sub(rf"\\mathrm{{\1{_MARK}}}", source)
    return convert(source, display=display).replace(f'<mi mathvariant="normal">{_MARK}</mi>', "")


def inline(translator: HTML5Translator, node: nodes.math) -> None:
    """Write an inline equation."""
    translator.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def block(translator: HTML5Translator, node: nodes.math_block) -> None:
    """Write a displayed equation, with its number where it has a tag."""
    source = node.astext()
    tag = _TAG.search(source)
    number = tag[1] if tag else None
    translator.body.append(translator.starttag(node, "div", CLASS="equation"))
    translator.body.append(mathml(_TAG.sub("", source), "block"))
    if number is not None:
        translator.body.append(f'<span class="eqno">({number})</span>')
    translator.body.append("</div>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
