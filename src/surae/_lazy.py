"""Public names that are loaded when they are first used, so that an import costs nothing."""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import find_spec


def lazy_names(
    package: str, source: str
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Make `__getattr__` and `__dir__` of a package whose stub, the only list, names all it has."""

    @cache
    def homes() -> dict[str, tuple[str, str]]:
        import ast
        from pathlib import Path

        stub = ast.parse(Path(source).with_suffix(".pyi").read_text(encoding="utf-8"))
        return {
            alias.asname: (str(node.module), alias.name)
            for node in stub.body
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
            if alias.asname
        }

    def load(name: str) -> object:
        """Load a public name when it is first used."""
        if name == "__all__":
            return names()
        if name.startswith("__") or name not in homes():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, original = homes()[name]
        if not _installed(module):
            own = module.partition(".")[0].replace("_", "-")
            raise AttributeError(f"{package}.{name} is not installed; run pip install {own}")
        return getattr(import_module(module), original)

    def names() -> list[str]:
        """List the public names, loaded or not."""
        return sorted(name for name, (module, _) in homes().items() if _installed(module))

    return load, names


def _installed(module: str) -> bool:
    """Whether what a module belongs to is there: some names come with another distribution."""
    package = module.partition(".")[0]
    return package == "surae" or find_spec(package) is not None
