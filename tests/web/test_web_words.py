"""Every text of every page is one of the catalogue, and pages speak the reader's language."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from babel.messages.pofile import read_po

import surae_workbench
from surae.api import words_in
from surae.base.names import LANGUAGES
from surae.report.language import catalogue

HERE = Path(surae_workbench.__file__).parent
#: What is no language: names, formats, what browsers and servers read.
_NAMES = """
    surae CSV rad R² µV °/s² Nm mV uV TA GL SOL GM OK SHA sha256 RMSE VAF EMG rad/s rad/s2 rad/s² Hz
    Hz/s kB MB min English Nederlands Deutsch Français POST PATCH DELETE AbortError X-CSRF-Token
    Content-Type fit.json impedance my-trials --output --rehearse live s M R N
"""
NO_WORDS = set(_NAMES.split())
#: What the server says in a word, marked in one place.
WORDS = set(
    re.findall(
        r'N_\("([^"]*)"\)', (HERE / "web/static/js/core/words.js").read_text(encoding="utf-8")
    )
)
#: Contexts whose string is an attribute or a key.
KEYS = re.compile(
    r"(?:\b(?:class|id|key|type|role|scope|href|lang|method|preserveAspectRatio): "
    r"|(?:from|import) |byId\(|[qQ]uerySelector(?:All)?\(|className = |font(?: =|:) |closest\("
    r"|matchMedia\(|\.format === |document\.cookie = |\.parse\(|\.log\()$"
)
#: Comments, strings, and the begin of a template.
TOKENS = re.compile(
    r"//[^\n]*|/\*.*?\*/|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'|`|/(?:[^/\\\n ]|\\.)+/[giu.]",
    re.DOTALL,
)


def prose(text: str) -> bool:
    """Whether it is written for a reader: words, and not only an identifier or an address."""
    words = re.findall(r"[\w./\-²]*[^\W\d_²]{2}[\w./\-²]*", text)
    if re.match(r"[/.?&]|\w+ = |https?:|surae[-.:]|[\[(]|application/|text/|:scope", text.strip()):
        return False
    alone = re.fullmatch(r"[a-z0-9_.:/?=&\-#>,*+()\0]*", text)
    return not alone and any(word not in NO_WORDS for word in words)


def strings(text: str, begin: int = 0, inside: bool = False) -> Iterator[tuple[int, str]]:
    """Where strings begin, and what they say; of templates, what is not computed."""
    depth = 0
    while begin < len(text):
        if inside and text[begin] in "{}":
            depth += 1 if text[begin] == "{" else -1
            if depth < 0:
                yield begin, ""  # where the computed part of a template ends
                return
        token = TOKENS.match(text, begin)
        if token is None:
            begin += 1
        elif token[0] != "`":
            if token[0][0] != "/":
                yield begin, token[0][1:-1]
            begin = token.end()
        else:
            at, said, begin = begin, "", begin + 1
            while text[begin] != "`":
                if text.startswith("${", begin):
                    *within, (end, _) = strings(text, begin + 2, inside=True)
                    yield from within
                    said, begin = said + "\0", end + 1
                else:
                    said, begin = said + text[begin], begin + 1
            begin += 1
            yield at, said


def unmarked_in_script(text: str) -> list[str]:
    """Texts that are shown as they stand."""
    found = []
    for at, said in strings(text):
        before = text[max(0, at - 400) : at]
        marked = re.search(r"(?<![\w.])(?:_|N_|many)\((?:\"[^\"]*\", )?$", before)
        if not marked and said not in WORDS and not KEYS.search(before) and prose(said):
            found.append(said)
    return found


def unmarked_in_template(text: str) -> list[str]:
    """Texts, and attributes that are read out, which stand as they are."""
    text = re.sub(r"<script.*?</script>|<code>.*?</code>|\{%.*?%\}", " ", text, flags=re.DOTALL)
    text = re.sub(r"\{\{.*?\}\}", " ", text, flags=re.DOTALL)
    said = re.findall(r'\b(?:title|aria-label|placeholder|alt)="([^"]*)"', text)
    return [one.strip() for one in [*re.split(r"<[^>]*>", text), *said] if prose(one)]


@pytest.mark.parametrize(
    "path",
    sorted(p for p in HERE.rglob("static/**/*.js") if "vendor" not in p.parts),
    ids=lambda path: path.name,
)
def test_no_script_says_what_is_not_in_the_catalogue(path) -> None:
    assert unmarked_in_script(path.read_text(encoding="utf-8")) == []


def test_every_marked_text_of_a_script_is_in_the_catalogue() -> None:
    """What the extraction does not see, such as a text within another's values, is found here."""
    with catalogue("de").open("rb") as file:
        known = {m.id if isinstance(m.id, str) else m.id[0] for m in read_po(file)}
    marked = re.compile(r'(?<![\w.])(?:_|N_|many)\(\s*"([^"]*)"')
    scripts = (path.read_text(encoding="utf-8") for path in HERE.rglob("static/**/*.js"))
    assert {text for script in scripts for text in marked.findall(script)} <= known


@pytest.mark.parametrize("path", sorted(HERE.rglob("*.html.j2")), ids=lambda path: path.name)
def test_no_template_says_what_is_not_in_the_catalogue(path) -> None:
    assert unmarked_in_template(path.read_text(encoding="utf-8")) == []


def test_what_is_not_marked_is_found() -> None:
    script = (
        'h("p", { class: "muted small" }, "No trials yet.", _("Trial"), `of ${n} fits`, "/api/x")'
    )
    assert unmarked_in_script(script) == ["No trials yet.", "of \0 fits"]
    assert unmarked_in_template('<p title="A hint">{{ _("Leg") }} or <b>Legs</b></p>') == [
        "or",
        "Legs",
        "A hint",
    ]


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("page", ["/", "/import", "/analyse", "/cohort", "/plan", "/live", "/fit"])
def test_a_page_brings_its_scripts_words_along(browser, page, language) -> None:
    text = browser.get(page, headers={"cookie": f"surae-language={language}"}).text
    assert f'<html lang="{language}">' in text
    found = re.search(r'<script type="application/json" id="messages">(.*?)</script>', text)[1]
    assert json.loads(found).get("Trial", "Trial") == words_in(language)("Trial")


def test_a_browser_that_chose_nothing_is_answered_in_what_it_asks_for(browser) -> None:
    for asked, language in (("fr-CA,en;q=0.5", "fr"), ("it", "en"), ("de", "de"), ("\udcff", "en")):
        text = browser.get("/live", headers={"accept-language": asked.encode("utf-8", "replace")})
        assert f'<html lang="{language}">' in text.text
