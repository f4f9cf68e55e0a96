"""The architecture, enforced: imports only go down, nothing goes round, `import surae` is light."""

import ast
import importlib
import json
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import surae
import surae.api
import surae_thesis
import surae_workbench

PACKAGE = Path(surae.__file__).parent
THESIS = Path(surae_thesis.__file__).parent
WORKBENCH = Path(surae_workbench.__file__).parent

#: From the bottom to the top; modules on one line may use each other, never in a circle.
LAYERS = (
    ("_lazy", "_version", "base", "processes"),
    ("recording",),
    ("signals",),
    ("model",),
    ("protocol",),
    ("quality",),
    ("settings", "effects", "estimators", "prepared", "shorthands"),
    ("inference",),
    ("sampling", "nerve"),
    ("trials",),
    ("measures",),
    ("exchange",),
    ("causal",),
    ("cohorts",),
    ("studies",),
    ("planning",),
    ("report",),
    ("api",),
    ("cli", "__main__"),
)
RANK = {name: rank for rank, layer in enumerate(LAYERS) for name in layer}


def layer_of(module: str) -> str:
    """The layer of a module: that of the folder it lies in."""
    return module.split(".")[1]


#: Light enough to run a command that computes nothing without a pause.
HEAVY = ("numba", "scipy", "matplotlib", "h5py", "pydantic", "rich", "click", "jinja2", "joblib")


def module_name(source: Path, package: Path) -> str:
    parts = ("surae", *source.relative_to(package).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def called(call: ast.Call) -> str:
    """Name of the function that is called, without what it belongs to."""
    if isinstance(call.func, ast.Attribute):
        return call.func.attr
    return call.func.id if isinstance(call.func, ast.Name) else ""


def imports(source: Path, package: Path, known: frozenset[str]) -> set[str]:
    """Modules of the package that a file imports anywhere, inside functions too."""
    own = module_name(source, package)
    base = own.split(".") if source.name == "__init__.py" else own.split(".")[:-1]
    names: set[str] = set()
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = base[: len(base) - node.level + 1] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                inner = f"{origin}.{alias.name}"
                names.add(inner if inner in known else origin)
        elif isinstance(node, ast.Call) and called(node) in ("import_module", "__import__"):
            names.update(str(a.value) for a in node.args if isinstance(a, ast.Constant))
    return {name for name in names if name == "surae" or name.startswith("surae.")} - {own}


def graph(package: Path) -> dict[str, set[str]]:
    """Which module of the package imports which."""
    sources = sorted(package.rglob("*.py"))
    known = frozenset(module_name(s, package) for s in sources) - {"surae"}
    return {module_name(s, package): imports(s, package, known) for s in sources}


@cache
def surae_graph() -> dict[str, set[str]]:
    return graph(PACKAGE)


def upward(edges: dict[str, set[str]]) -> list[str]:
    """Imports that do not go down, and modules without a layer, one sentence each."""
    complaints = []
    for module, imported in edges.items():
        if module == "surae":
            continue  # names everything, lazily: tested apart
        layer = layer_of(module)
        if layer not in RANK:
            complaints.append(f"{module} belongs to no layer")
            continue
        for name in imported:
            if name == "surae":
                if RANK[layer] <= RANK["api"]:
                    complaints.append(f"{module} imports surae itself; take _version or the module")
            elif RANK.get(layer_of(name), 99) > RANK[layer]:
                complaints.append(f"{module} imports {name}, which lies above it")
    return complaints


def circle(edges: dict[str, set[str]]) -> list[str]:
    """One circle of imports, or nothing."""
    done: set[str] = set()

    def visit(module: str, path: list[str]) -> list[str]:
        if module in path:
            return [*path[path.index(module) :], module]
        if module in done:
            return []
        for name in sorted(edges.get(module, ())):
            if circle := visit(name, [*path, module]):
                return circle
        done.add(module)
        return []

    for start in sorted(edges):
        if circle := visit(start, []):
            return circle
    return []


def test_imports_only_go_down() -> None:
    assert upward(surae_graph()) == []


def test_nothing_imports_in_a_circle() -> None:
    inside = {module: names for module, names in surae_graph().items() if module != "surae"}
    assert " → ".join(circle(inside)) == ""


def test_every_import_of_the_package_leads_somewhere() -> None:
    edges = surae_graph()
    missing = {
        f"{module} imports {name}"
        for module, names in edges.items()
        for name in names
        if name not in edges
        and not (PACKAGE.parent / f"{name.replace('.', '/')}.pyi").exists()  # for types
    }
    assert missing == set()


def test_the_command_line_is_built_on_the_api() -> None:
    """What it computes with is `surae.api`; beside it it takes files, processes and the like."""
    allowed = {*LAYERS[0], "api", "cli"}
    inner = {
        f"{module} imports {name}: offer it in api/__init__.pyi"
        for module, imported in surae_graph().items()
        if module.split(".")[1:2] == ["cli"]
        for name in imported
        if name != "surae" and (name.split(".")[1] not in allowed or name.startswith("surae.api."))
    }
    assert inner == set()


@pytest.mark.parametrize("package", [surae, surae.api])
def test_what_a_stub_lists_is_there(package) -> None:
    """A stub lists every public name once, under its own name, and homes that lie below it."""
    stub = Path(package.__file__).with_suffix(".pyi")
    listed = [
        (node.module, alias.name, alias.asname)
        for node in ast.parse(stub.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    names = [name for _, name, _ in listed]
    assert sorted(names) == package.__all__ == dir(package)
    for home, name, public in listed:
        assert public == name
        assert not home.startswith("surae.") or RANK[layer_of(home)] <= RANK["api"]
        assert getattr(package, name) is getattr(importlib.import_module(home), name)
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = package.nothing


#: Packages whose public names others build on: those in their `__all__`; and modules that are one
#: thing, and public as they are.
PUBLIC_MODULES = (
    "_lazy",
    "base.errors",
    "base.file_form",
    "base.files",
    "base.records",
    "base.threads",
    "base.units",
    "processes.runner",
    "processes.ledger",
)


def from_surae(source: Path) -> set[tuple[str, str]]:
    """Modules of surae that a file imports from, and the names that it takes."""
    nodes = list(ast.walk(ast.parse(source.read_text(encoding="utf-8"))))
    taken = {
        (node.module, alias.name)
        for node in nodes
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
    whole = {(a.name, "") for node in nodes if isinstance(node, ast.Import) for a in node.names}
    return {(m, name) for m, name in taken | whole if m.split(".")[0] == "surae"}


def test_the_thesis_is_built_on_what_is_public() -> None:
    sources = sorted(THESIS.rglob("*.py"))
    assert len(sources) > 10
    inner = set()
    for source in sources:
        for module, name in from_surae(source):
            if (module == "surae" and name in ("", "api")) or module.removeprefix(
                "surae."
            ) in PUBLIC_MODULES:
                continue
            if not name or name not in getattr(importlib.import_module(module), "__all__", ()):
                inner.add(f"{source.name}: {module}.{name}")
    assert inner == set()


def is_for_commands(module: str, name: str) -> bool:
    """Whether the shell offers a name to commands of other distributions."""
    offered = getattr(importlib.import_module(module), "__all__", ())
    return module.startswith("surae.cli.") and name in offered


def test_the_workbench_is_built_on_the_api() -> None:
    """It takes `surae.api` by its names, files and the like, and what commands are made of."""
    sources = sorted(WORKBENCH.rglob("*.py"))
    assert len(sources) > 50
    allowed = {*(f"surae.{name}" for name in LAYERS[0]), "surae", "surae.api"}
    inner = {
        f"{source.relative_to(WORKBENCH)}: {module}.{name}: offer it in api/__init__.pyi"
        for source in sources
        for module, name in from_surae(source)
        if (
            not module.startswith("surae.base.")
            and module not in allowed
            and not (
                source.name.endswith(("command.py", "options.py")) and is_for_commands(module, name)
            )
        )
        or (module == "surae.api" and name not in surae.api.__all__)
        or (module == "surae" and name != "api")
    }
    assert inner == set()


#: Distributions of their own.
BESIDE = sorted(PACKAGE.parents[1].glob("[a-z]*/src/surae_*"))
BUILT_ON_IT = ("surae_thesis", "surae_workbench")


def test_nothing_of_surae_needs_what_is_built_on_it() -> None:
    users = {
        (path.relative_to(PACKAGE).as_posix(), name)
        for path in PACKAGE.rglob("*.py")
        for name in BUILT_ON_IT
        if name in path.read_text("utf-8")
    }
    assert users == set()


def test_libraries_that_obey_files_of_the_current_folder_are_imported_where_it_is_ignored() -> None:
    users = {
        source.relative_to(package.parent).as_posix()
        for package in (PACKAGE, *BESIDE)
        for source in package.rglob("*.py")
        for node in ast.parse(source.read_text(encoding="utf-8")).body
        if isinstance(node, ast.Import | ast.ImportFrom)
        and ast.unparse(node).split()[1].split(".")[0] in ("matplotlib", "numba")
    }
    assert {user for user in users if not user.startswith("surae/report/figures/")} == set()


def test_the_package_itself_imports_next_to_nothing() -> None:
    tree = ast.parse((PACKAGE / "__init__.py").read_text(encoding="utf-8"))
    eager = {
        node.module if isinstance(node, ast.ImportFrom) else node.names[0].name
        for node in tree.body
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    ours = {name for name in eager if name and name.split(".")[0] == "surae"}
    assert ours <= {
        "surae._lazy",
        "surae._version",
        "surae.base.errors",
    }  # the rest when it is first used


def test_importing_is_light() -> None:
    code = (
        "import sys, json, surae, surae.api, surae.base.errors; light = sorted(sys.modules); "
        "import surae.model, surae.base.units, surae.report; "
        "print(json.dumps([light, [*sys.modules]]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    light, all_ = ({name.split(".")[0] for name in names} for names in json.loads(done.stdout))
    assert light & {*HEAVY, "numpy"} == set()
    assert all_ & set(HEAVY) == set()


@pytest.fixture
def small(tmp_path) -> Path:
    """A package with one import of every kind, in order."""
    files = {
        "__init__.py": "from surae._version import __version__\n",
        "_version.py": "__version__ = '0'\n",
        "base/errors.py": "",
        "signals/__init__.py": "from surae.signals.inputs import x\n",
        "signals/inputs.py": "from surae.base.errors import y\nx = 1\n",
        "model/__init__.py": "",
        "model/rigid.py": "def f():\n    from ..signals import inputs\n"
        "    import surae.base.errors\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_test_follows_every_kind_of_import(small) -> None:
    edges = graph(small)
    assert edges["surae"] == {"surae._version"}
    assert edges["surae.signals"] == {"surae.signals.inputs"}
    assert edges["surae.model.rigid"] == {"surae.signals.inputs", "surae.base.errors"}
    assert upward(edges) == []
    assert circle(edges) == []


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("signals/up.py", "def f():\n    from surae.model import rigid\n", "lies above it"),
        ("signals/up.py", "import surae.model.rigid\n", "lies above it"),
        ("signals/up.py", "from .. import model\n", "lies above it"),
        ("signals/up.py", "importlib.import_module('surae.model.rigid')\n", "lies above it"),
        ("model/up.py", "from surae import __version__\n", "imports surae itself"),
        ("helpers/__init__.py", "", "belongs to no layer"),
    ],
)
def test_the_test_finds_what_it_is_for(small, name, text, complaint) -> None:
    (small / name).parent.mkdir(exist_ok=True)
    (small / name).write_text(text, encoding="utf-8")
    complaints = upward(graph(small))
    assert len(complaints) == 1
    assert complaint in complaints[0]


def test_the_test_finds_circles(small) -> None:
    (small / "signals" / "inputs.py").write_text("def f():\n    from surae.signals import x\n")
    path = circle(graph(small))
    assert path[0] == path[-1]
    assert set(path) == {"surae.signals", "surae.signals.inputs"}
