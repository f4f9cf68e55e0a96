"""Results that a change of form must not change: what each is, its digest, and how to renew it.

``tests/studies/test_frozen_results.py`` computes each of ``tests/frozen_cases.py`` again. By hand,
from the repository::

    python tests/frozen_results.py                      # what differs from the kept file
    python tests/frozen_results.py --only auto,session  # of some cases
    python tests/frozen_results.py --renew              # and write what was computed in its place
    python tests/frozen_results.py --documents NEW --beside OLD  # each number that differs

Bits depend on the processor and on the libraries, so the kept file says what it was made with. To
compare two commits elsewhere, renew another file by the older one's code and read it by the newer
one's: ``--kept FILE --renew``, then ``--kept FILE``. Each program is that of the Python which runs
the file, so that one copy of it serves both.
"""

import argparse
import base64
import contextlib
import hashlib
import io
import json
import os
import platform
import sys
import tempfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import EntryPoint, entry_points, version
from pathlib import Path
from typing import Any

from frozen_cases import CASES, LEGS, MAPPINGS

#: What was computed when, by which code: the kept digests and numbers.
KEPT = Path(__file__).with_name("data") / "frozen.json"
SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"
#: Folders that cases read, by the name that their commands give them.
FOLDERS = {
    "data": Path(__file__).with_name("data"),
    "wrist": Path(__file__).parents[1] / "examples" / "wrist",
}

#: Fields that say who computed when and where, not what.
_ASIDE = {"seconds", "versions", "surae", "judged_by", "path"}
#: Numbers of a case that are kept beside its digest.
_NUMBERS = 4


class AbsentError(Exception):
    """A case reads files that are not here."""


def maker_of(word: str) -> str | None:
    """The case whose output a word of a command is, or the legs of whom it is a file."""
    if word.endswith(".json") and "/" not in word:
        return word.removesuffix(".json")
    folder, slash, _ = word.partition("/")
    return folder if slash and folder in {*LEGS, *CASES} else None


def output_of(case: str) -> str:
    """What a case's command writes: a file, or a folder of them."""
    command = CASES[case].split()[0]
    return case + {"session": "", "simulate": ".csv", "export": ".xml"}.get(command, ".json")


class Results:
    """Documents of the cases, each computed in one folder when it is asked for."""

    def __init__(self, folder: Path, measured: Path = SHARED) -> None:
        self.folder = folder
        self._made: set[str] = set()
        for name, target in {**FOLDERS, "shared": measured.resolve()}.items():
            (folder / name).symlink_to(target)
        for name, text in MAPPINGS.items():
            (folder / name).write_text(text, encoding="utf-8")

    def document(self, case: str) -> Any:
        """A case's result without what is not of it.

        Raises
        ------
        AbsentError
            It reads files that are not here.
        """
        self._make(case)
        out = self.folder / output_of(case)
        files = [out] if out.is_file() else sorted(p for p in out.rglob("*") if _is_data(p))
        read = {str(p.relative_to(self.folder)): self._read(p) for p in files}
        return next(iter(read.values())) if out.is_file() else read

    def _read(self, file: Path) -> Any:
        text = file.read_text(encoding="utf-8").replace(str(self.folder.resolve()), ".")
        return canonical(json.loads(text) if file.suffix == ".json" else text.splitlines())

    def _make(self, name: str) -> None:
        if name in self._made:
            return
        if name in LEGS:
            _call("ankle-legs", [*LEGS[name].split(), "--output", name], self.folder)
        else:
            self._run(name)
        self._made.add(name)

    def _run(self, case: str) -> None:
        command = CASES[case].split()
        for maker in filter(None, map(maker_of, command)):
            self._make(maker)
        self._look(command)
        out = output_of(case)
        if "--json" in command:
            said = _call("surae", command, self.folder)
            (self.folder / out).write_text(said, encoding="utf-8")
        else:
            _call("surae", [*command, "--output", out], self.folder)

    def _look(self, command: list[str]) -> None:
        """Whether measured files that a command reads are here."""
        text = " ".join([*command, *(MAPPINGS.get(word, "") for word in command)])
        needed = [w for w in text.replace('"', " ").split() if w.startswith("shared/")]
        absent = [w for w in needed if not (self.folder / w).exists()]
        if absent:
            raise AbsentError(f"no measured data: ../{absent[0]} is not beside the repository")


def _is_data(file: Path) -> bool:
    return file.suffix in {".json", ".csv"}


def _call(program: str, arguments: list[str], folder: Path) -> str:
    """Run a program of this installation within this process; return what it prints."""
    (point,) = _programs(program)
    run: Callable[[], Any] = point.load()
    said = io.StringIO()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_as_program(program, arguments))
        stack.enter_context(contextlib.chdir(folder))
        stack.enter_context(contextlib.redirect_stdout(said))
        stack.enter_context(contextlib.redirect_stderr(said))
        try:
            code = run()
        except SystemExit as end:
            code = end.code
    if code not in {None, 0, 1}:  # 1: what was computed is written, and is no result to trust
        raise RuntimeError(f"{program} {' '.join(arguments)}: exit {code}\n{said.getvalue()}")
    return said.getvalue()


def _programs(name: str) -> set[EntryPoint]:
    return set(entry_points(group="console_scripts", name=name))


@contextlib.contextmanager
def _as_program(name: str, arguments: list[str]) -> Iterator[None]:
    """As if the process had been begun with these arguments."""
    before, sys.argv = sys.argv, [name, *arguments]
    try:
        yield
    finally:
        sys.argv = before


def canonical(value: Any) -> Any:
    """Plain data without what is aside of the result; arrays as digests of their bits."""
    if isinstance(value, list):
        return [canonical(each) for each in value]
    if not isinstance(value, dict):
        return value
    if {"shape", "encoding", "data"} <= value.keys():
        bits = zlib.decompress(base64.b64decode(value["data"]))
        return {"shape": value["shape"], "bits": _digest(bits)}
    return {key: canonical(each) for key, each in value.items() if key not in _ASIDE}


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def _of_document(document: Any) -> str:
    return _digest(json.dumps(document, sort_keys=True).encode())


def summary(document: Any) -> dict[str, Any]:
    """What is kept of a document: digests of the whole and of each part, and a few numbers."""
    parts = document if isinstance(document, dict) else {"lines": document}
    found = dict(_numbers(document, "value")) or dict(_numbers(document, ""))
    vaf = {"vaf": document["vaf"]} if "vaf" in parts else {}
    first = list(found.items())[: _NUMBERS - len(vaf)]
    return {
        "digest": _of_document(document),
        "numbers": {**vaf, **dict(first)},
        "parts": {key: _of_document(part)[:8] for key, part in parts.items()},
    }


def _numbers(value: Any, key: str, at: str = "") -> Iterator[tuple[str, float]]:
    """Numbers of a document by where they stand: of that key; not what is fixed or at a bound."""
    if isinstance(value, dict):
        if not value.get("free", True) or value.get("at_bound"):
            return
        for name, each in value.items():
            yield from _numbers(each, key, f"{at}.{name}" if at else name)
    elif isinstance(value, list):
        for i, each in enumerate(value):
            yield from _numbers(each, key, f"{at}.{i}")
    elif isinstance(value, float) and at.rpartition(".")[2] in {key, key or at.rpartition(".")[2]}:
        yield at, value


def signature() -> dict[str, str]:
    """What bits depend on beside the code: processor, C library and those that compute."""
    import llvmlite.binding as llvm  # type: ignore[import-untyped]
    import scipy.linalg  # noqa: F401  it brings its linear algebra, of which threadpool_info tells
    from threadpoolctl import threadpool_info

    blas = {b["architecture"] for b in threadpool_info() if b["user_api"] == "blas"}
    features = sorted(name for name, here in llvm.get_host_cpu_features().items() if here)
    return {
        "processor": f"{llvm.get_host_cpu_name()} {_digest(' '.join(features).encode())[:8]}",
        "blas": " ".join(sorted(str(each) for each in blas)),
        "libc": " ".join(platform.libc_ver()),
        "python": platform.python_version(),
        **{name: version(name) for name in ("numpy", "scipy", "numba", "llvmlite")},
    }


def elsewhere(kept: Mapping[str, str]) -> list[str]:
    """What of a kept file's signature is otherwise here, in words."""
    here = signature()
    return [
        f"{key} was {kept.get(key)}, is {here[key]}" for key in here if here[key] != kept.get(key)
    ]


def differences(kept: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """What of a summary differs, in words: parts and numbers."""
    if kept.get("digest") == now["digest"]:
        return []
    old, new = kept.get("parts", {}), now["parts"]
    parts = [key for key in dict.fromkeys([*old, *new]) if old.get(key) != new.get(key)]
    lines = [f"differs in {', '.join(parts)}"]
    before = kept.get("numbers", {})
    for name, number in now["numbers"].items():
        if before.get(name) != number:
            lines.append(f"  {name}: {before.get(name)!r} was kept, now {number!r}")
    return lines


def far(kept: Mapping[str, Any], now: Mapping[str, Any], relative: float) -> list[str]:
    """The kept numbers that are not what they were to a relative difference."""
    found = now["numbers"]
    return [
        f"{name}: {number!r} was kept, now {found.get(name)!r}"
        for name, number in kept["numbers"].items()
        if name not in found or abs(found[name] - number) > relative * abs(number)
    ]


def read_kept(path: Path = KEPT) -> dict[str, Any]:
    """The kept file: ``signature``, and ``cases`` by name."""
    if not path.exists():
        return {"signature": {}, "cases": {}}
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return data


def _written(kept: Mapping[str, Any]) -> str:
    """The kept file's text: a line for each of a case's three entries."""
    cases = []
    for name, case in kept["cases"].items():
        lines = ",\n".join(f"   {json.dumps(key)}: {json.dumps(case[key])}" for key in case)
        cases.append(f"  {json.dumps(name)}: {{\n{lines}\n  }}")
    head = json.dumps(kept["signature"], indent=2).replace("\n", "\n ")
    return f'{{\n "signature": {head},\n "cases": {{\n' + ",\n".join(cases) + "\n }\n}\n"


def _beside(old: Any, new: Any, at: str = "") -> Iterator[str]:
    """Where two documents differ."""
    if type(old) is type(new) and isinstance(old, dict | list):
        keys = (
            dict.fromkeys([*old, *new]) if isinstance(old, dict) else range(max(len(old), len(new)))
        )
        for key in keys:
            a, b = (_get(each, key) for each in (old, new))
            yield from _beside(a, b, f"{at}.{key}" if at else str(key))
    elif old != new:
        yield f"  {at}: {old!r}, now {new!r}"


def _get(table: Any, key: Any) -> Any:
    if isinstance(table, list):
        return table[key] if key < len(table) else "absent"
    return table.get(key, "absent")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="What differs from the kept results.")
    parser.add_argument("--kept", type=Path, default=KEPT, metavar="FILE")
    parser.add_argument("--only", default="", metavar="CASE,…")
    parser.add_argument("--renew", action="store_true", help="write what is computed to the file")
    parser.add_argument("--documents", type=Path, metavar="DIR", help="write whole results there")
    parser.add_argument("--beside", type=Path, metavar="DIR", help="another code's --documents")
    parser.add_argument(
        "--measured", type=Path, default=SHARED, metavar="DIR", help="../shared/data"
    )
    return parser.parse_args()


def main() -> int:
    """Compute the cases, say what differs from the kept file, and renew it if asked to."""
    given = _arguments()
    kept = read_kept(given.kept)
    for line in elsewhere(kept["signature"]):
        print(f"bits may differ: {line}")
    chosen, changed = given.only.split(",") if given.only else list(CASES), 0
    with tempfile.TemporaryDirectory() as folder:
        results, cases = Results(Path(folder), given.measured), dict(kept["cases"])
        for case in chosen:
            started = os.times()
            try:
                document = results.document(case)
            except AbsentError as why:
                print(f"{case}: not computed, what was kept stays: {why}")
                continue
            except RuntimeError as why:
                print(f"{case}: FAILED: {why}")
                changed += 1
                continue
            now = summary(document)
            lines = differences(kept["cases"].get(case, {}), now)
            took = os.times().user - started.user
            print("\n".join([f"{case}: {took:.1f} s, {'' if lines else 'equal'}", *lines]))
            if given.documents:
                given.documents.mkdir(parents=True, exist_ok=True)
                text = json.dumps(document, indent=1)
                (given.documents / f"{case}.json").write_text(text, encoding="utf-8")
            if given.beside and (given.beside / f"{case}.json").exists():
                old = json.loads((given.beside / f"{case}.json").read_text(encoding="utf-8"))
                for line in _beside(old, document):
                    print(line)
            changed += bool(lines)
            cases[case] = now
    if given.renew:
        ordered = {case: cases[case] for case in CASES if case in cases}
        text = _written({"signature": signature(), "cases": ordered})
        given.kept.write_text(text, encoding="utf-8")
    print(f"{changed} of {len(chosen)} cases differ from the kept file")
    return int(bool(changed) and not given.renew)


if __name__ == "__main__":
    sys.exit(main())
