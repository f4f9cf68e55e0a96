"""Public names that are loaded when they are first used, so that an import costs nothing."""

from collections.abc import Callable
from functools import cache
from importlib import import_module


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
        return getattr(import_module(module), original)

    def names() -> list[str]:
        """List the public names, loaded or not."""
        return sorted(homes())

    return load, names
