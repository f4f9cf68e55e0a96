"""Docstrings say what signatures say: names in their order, what is returned, what is raised."""

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterator
from importlib import import_module
from types import FunctionType

import pytest
from numpydoc.docscrape import ClassDoc, FunctionDoc

import surae

LAYERS = (
    "recording", "signals", "model", "protocol", "quality", "estimation", "assessment", "studies",
    "report", "api",
)  # fmt: skip


def documented() -> dict[str, object]:
    """Everything public, each object once, under the shortest name that it has."""
    functions: dict[int, tuple[str, object]] = {}
    for module in ("surae", *(f"surae.{layer}" for layer in LAYERS)):
        home = import_module(module)
        for name in home.__all__:
            public = getattr(home, name)
            if inspect.isfunction(public) or inspect.isclass(public):
                functions.setdefault(id(public), (f"{module}.{name}", public))
    return dict(functions.values())


PUBLIC = documented()
CLASSES = {name: public for name, public in PUBLIC.items() if inspect.isclass(public)}


def functions() -> Iterator[tuple[str, Callable[..., object], bool]]:
    """Name, function, and whether its first parameter is self or cls."""
    for name, public in PUBLIC.items():
        if inspect.isfunction(public):
            yield name, public, False
        elif inspect.isclass(public):
            for member, value in vars(public).items():
                if member.startswith("_"):
                    continue
                if isinstance(value, classmethod | staticmethod):
                    yield f"{name}.{member}", value.__func__, isinstance(value, classmethod)
                elif inspect.isfunction(value):
                    yield f"{name}.{member}", value, True


FUNCTIONS = {name: (function, bound) for name, function, bound in functions()}
#: What users call: surae.fit, surae.Fit.save, not what only one layer says to another.
USERS = [name for name in FUNCTIONS if ".".join(name.split(".")[:2]) in
         {f"surae.{public}" for public in surae.__all__}]  # fmt: skip


def _parameters(function: Callable[..., object], bound: bool) -> list[str]:
    if "__signature__" in vars(function) and "\n**asked\n" in inspect.getdoc(function):
        function = FunctionType(function.__code__, {})  # completion says more than is repeated
    return list(inspect.signature(function).parameters)[bound:]


def _named(entries: list) -> list[str]:
    """Names of a section: ``a, b`` stands for both."""
    return [name.strip().lstrip("*") for entry in entries for name in entry.name.split(",")]


def test_there_is_much_to_look_at():
    assert len(PUBLIC) > 100
    assert len(USERS) > 25


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_is_as_its_docstring_says(name):
    function, bound = FUNCTIONS[name]
    doc = FunctionDoc(function)
    assert doc["Summary"], "no summary"
    given = _named(doc["Parameters"])
    assert given in ([], _parameters(function, bound))
    returned = inspect.signature(function).return_annotation
    if returned in (None, "None"):
        assert not doc["Returns"]
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    if any(isinstance(node, ast.Raise) for node in ast.walk(tree)):
        assert doc["Raises"], "it raises, and does not say so"


@pytest.mark.parametrize("name", USERS)
def test_what_users_call_says_all_of_it(name):
    function, bound = FUNCTIONS[name]
    doc = FunctionDoc(function)
    parameters = _parameters(function, bound)
    assert _named(doc["Parameters"]) == parameters
    returned = inspect.signature(function).return_annotation
    if parameters and returned not in (None, "None"):
        assert doc["Returns"], f"it returns {returned}, and does not say what that is"


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_names_what_it_is_made_of(name):
    kind = CLASSES[name]
    doc = ClassDoc(kind)
    assert doc["Summary"], "no summary"
    given = _named(doc["Parameters"]) + _named(doc["Attributes"])
    fields = getattr(kind, "__dataclass_fields__", {})
    if fields and doc["Parameters"] + doc["Attributes"]:
        assert set(fields) <= set(given) | _undocumented(kind)
    for member, value in vars(kind).items():
        if isinstance(value, property) and not member.startswith("_"):
            assert inspect.getdoc(value), f"{member} has no docstring"


def _undocumented(kind: type) -> set[str]:
    """Fields that are nobody's business."""
    return {name for name in kind.__dataclass_fields__ if name.startswith("_")}
