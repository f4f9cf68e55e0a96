"""What the house is held to: sizes that CONTRIBUTING names, what the formatter is kept from.

By hand, from the repository: ``python tests/house.py`` writes the sizes into CONTRIBUTING's tree.
"""

import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "CONTRIBUTING.md"
#: A line of the tree: where, and thousands of lines of Python.
_ROW = re.compile(r"^( *)([\w/.]+)( +)(\d+\.\d)(?= )", re.M)
#: Folders of the repository whose sources are ours.
FOLDERS = ("src", "legs", "thesis", "workbench", "tests", "benchmarks", "examples", "docs")


def tree(text: str) -> str:
    """The block of CONTRIBUTING that draws the tree."""
    return text.split("\n## The tree\n")[1].split("```\n")[1]


def rows(text: str) -> Iterator[tuple[Path, float]]:
    """Every folder or file of the tree, with the thousands of lines that the page says."""
    above: list[tuple[int, Path]] = []
    for indent, name, _, size in _ROW.findall(tree(text)):
        while above and above[-1][0] >= len(indent):
            above.pop()
        place = (above[-1][1] if above else ROOT) / name
        above.append((len(indent), place))
        yield place, float(size)


def sizes(text: str) -> dict[Path, float]:
    """Thousands of lines of each, without those of what has a row of its own below it."""
    places = [place for place, _ in rows(text)]
    lines = {place: sum(map(_lines, _sources(place))) for place in places}
    return {
        place: (lines[place] - sum(lines[inner] for inner in _directly_below(place, places))) / 1000
        for place in places
    }


def _directly_below(place: Path, places: list[Path]) -> list[Path]:
    """Rows within a row, but for those within another one of these."""
    within = [each for each in places if place in each.parents]
    return [each for each in within if not any(other in each.parents for other in within)]


def _sources(place: Path) -> list[Path]:
    return [place] if place.is_file() else sorted(place.rglob("*.py"))


def _lines(source: Path) -> int:
    return len(source.read_text(encoding="utf-8").splitlines())


def unformatted(folder: str) -> list[str]:
    """Where the formatter is kept from a statement: file and line."""
    marks = re.compile(r"#\s*fmt:\s*(skip|off)")
    return [
        f"{source.relative_to(ROOT)}:{number}"
        for source in sorted((ROOT / folder).rglob("*.py"))
        if ".venv" not in source.parts
        for number, line in enumerate(source.read_text(encoding="utf-8").splitlines(), start=1)
        if marks.search(line)
    ]


def write() -> None:
    """Bring the sizes of the page up to the sources."""
    text = PAGE.read_text(encoding="utf-8")
    now = iter(sizes(text).values())
    block = tree(text)
    renewed = _ROW.sub(lambda row: f"{row[1]}{row[2]}{row[3]}{next(now):.1f}", block)
    PAGE.write_text(text.replace(block, renewed), encoding="utf-8")


if __name__ == "__main__":
    write()
