"""What users read has no phrase that nobody understood at the first reading."""

import ast
from pathlib import Path

import surae

PACKAGE = Path(surae.__file__).parent
ROOTS = [PACKAGE, *sorted(PACKAGE.parents[1].glob("[a-z]*/src/surae_*"))]
REFUSED = (
    "says nothing of",
    "the same of",
    "imperfections: taken in",
    "say the data",
    "before the data object",
    "each for itself",
    "not told",
    "less noisily",
    "for what the form has not",
    "show in no name",
    "right or wrong",
    "becomes a recording",
    "who says so",
    "asked for",
    "as asked",
    "is asked of",
    "as told",
    "is told",
    "be told",
    "tells nothing",
    "tell nothing",
    "say nothing",
    "is said of",
    "not said",
    "nothing of it",
    "known of the laboratory",
    "what is known of",
    "taken for perfect",
    "trials disagree about",
    "the mapping is the place",
    "no change is claimed",
    "take over what",
    "hears little",
    "and it is known to",
    "proves nothing",
    "they reach to where",
    "not inadequate",
    "how steeply",
    "ask for moment arms",
)


def texts(path):
    """The texts of a file that users may read: no comments, and of Python no descriptions."""
    source = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        for line in source.splitlines():
            if not line.lstrip().startswith(("//", "/*", "*", "#", "{#")):
                yield line
        return
    tree = ast.parse(source)
    said = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in said:
            yield node.value


def refused(path):
    return [
        (path.name, phrase, text)
        for text in texts(path)
        for phrase in REFUSED
        if phrase in text.lower()
    ]


def test_no_phrase_that_nobody_understood():
    files = [
        p for kind in ("py", "js", "j2", "toml") for root in ROOTS for p in root.rglob(f"*.{kind}")
    ]
    assert len(files) > 300
    assert [found for path in files for found in refused(path)] == []


def test_a_refused_phrase_is_found(tmp_path):
    for name, text in (("a.py", 'x = f"a hold says nothing of {1}"'), ("b.js", 'h("not told")')):
        (tmp_path / name).write_text(text)
        assert refused(tmp_path / name)
    (tmp_path / "c.py").write_text('"""It says nothing of it."""')
    assert not refused(tmp_path / "c.py")
