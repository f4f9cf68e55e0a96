"""Tables of the numbers that judge, by room, made of the source: value, and what each decides."""

import ast
import re
from pathlib import Path

import surae

#: Rooms whose numbers decide what is claimed, found or proposed, and what they do.
ROOMS = {
    "quality": "What is found in a recording before its fit is believed",
    "inference/diagnosis": "Turned signs and wrong units, tried with a quick fit",
    "inference": "Search, uncertainty and verdicts of a fit",
    "measures": "What is made of parameters, and what counts as a change",
    "trials": "What each trial of a session is",
    "recording": "What a file is taken for, and when it is refused",
    "signals": "What is made of a recording before it is fitted",
    "model": "Equations, curves, and what a laboratory is taken to know",
    "protocol": "Movements, devices, what a protocol will tell, and which tells most",
    "studies": "Virtual legs",
}
#: What is longer is a table of its own, in letters.
_LONGEST = 300
_NAME = re.compile(r"_?[A-Z][A-Z0-9_]*")


def constants(room: str) -> list[tuple[str, str, str, str]]:
    """Module, names, values and comment of every number of a room that has a name in capitals."""
    found = []
    folder = Path(surae.__file__).parent / room
    for file in sorted(folder.rglob("*.py")):
        module = str(file.relative_to(folder).with_suffix(""))
        if room == "inference" and module.startswith("diagnosis"):
            continue
        if module.startswith("programs"):  # what a format has, and decides nothing
            continue
        text = file.read_text(encoding="utf-8")
        lines = text.splitlines()
        for node in ast.parse(text).body:
            if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                names = [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
                if all(map(_NAME.fullmatch, names)) and _is_number(node.value):
                    about = _comment(lines, node.lineno - 1)
                    found.append((module, ", ".join(names), ast.unparse(node.value), about))
    return found


def _is_number(value: ast.expr) -> bool:
    """Whether a value is made of numbers."""
    parts = [n.value for n in ast.walk(value) if isinstance(n, ast.Constant)]
    numbers = [p for p in parts if isinstance(p, int | float) and not isinstance(p, bool)]
    calls = [n for n in ast.walk(value) if isinstance(n, ast.Call)]
    called = {n.id for c in calls for n in ast.walk(c.func) if isinstance(n, ast.Name)} - {"np"}
    plain = not any(name == "Path" or name[:1].islower() for name in called)
    return bool(numbers) and plain and len(ast.unparse(value)) < _LONGEST


def _comment(lines: list[str], at: int) -> str:
    """What stands with a line: behind it, or above it and those that share it."""
    if "#:" in lines[at]:
        return " ".join(lines[at].partition("#:")[2].split())
    while at > 0 and _NAME.match(lines[at - 1]):
        at -= 1
    said: list[str] = []
    while at > 0 and lines[at - 1].startswith("#:"):
        at -= 1
        said.insert(0, lines[at][2:])
    return " ".join(" ".join(said).split())


def table(room: str) -> str:
    """A table in Markdown."""

    def cell(text: str) -> str:
        return text.replace("|", "\\|")

    rows = "".join(
        f"| {module} | `{cell(names)}` | `{cell(value)}` | {cell(about)} |\n"
        for module, names, value, about in constants(room)
    )
    head = "| module | constant | value | what it decides, and from what |\n|---|---|---|---|\n"
    return f"## {ROOMS[room]}\n\n`surae/{room}`\n\n{head}{rows}\n"


def tables() -> str:
    """All of them."""
    return "\n".join(map(table, ROOMS))
