"""Docstrings say what signatures say: names in their order, what is returned, what is raised."""

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from importlib import import_module
from types import FunctionType

from numpydoc.docscrape import ClassDoc, FunctionDoc

import surae

LAYERS = (
    "recording",
    "signals",
    "model",
    "protocol",
    "quality",
    "inference",
    "studies",
    "report",
    "api",
)


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


def members_of(public: type) -> dict[str, object]:
    """What a class has of its own, and of those that the public face makes it of."""
    parts = [each for each in public.__mro__ if each.__module__.startswith("surae.api.")]
    return {
        name: value for each in (*reversed(parts), public) for name, value in vars(each).items()
    }


def functions() -> Iterator[tuple[str, Callable[..., object], bool]]:
    """Name, function, and whether its first parameter is self or cls."""
    for name, public in PUBLIC.items():
        if inspect.isfunction(public):
            yield name, public, False
        elif inspect.isclass(public):
            for member, value in members_of(public).items():
                if member.startswith("_"):
                    continue
                if isinstance(value, classmethod | staticmethod):
                    yield f"{name}.{member}", value.__func__, isinstance(value, classmethod)
                elif inspect.isfunction(value):
                    yield f"{name}.{member}", value, True


FUNCTIONS = {name: (function, bound) for name, function, bound in functions()}
#: What users call: surae.fit, surae.Fit.save, not what only one layer says to another.
USERS = [
    name
    for name in FUNCTIONS
    if ".".join(name.split(".")[:2]) in {f"surae.{public}" for public in surae.__all__}
]


def _parameters(function: Callable[..., object], bound: bool) -> list[str]:
    if "__signature__" in vars(function) and "\n**keywords\n" in inspect.getdoc(function):
        function = FunctionType(function.__code__, {})  # completion says more than is repeated
    return list(inspect.signature(function).parameters)[bound:]


def _named(entries: list) -> list[str]:
    """Names of a section: ``a, b`` stands for both."""
    return [name.strip().lstrip("*") for entry in entries for name in entry.name.split(",")]


def test_there_is_much_to_look_at():
    assert len(PUBLIC) > 100
    assert len(USERS) > 25


def test_a_function_is_as_its_docstring_says():
    wrong = []
    for name, (function, bound) in FUNCTIONS.items():
        doc, returned = FunctionDoc(function), inspect.signature(function).return_annotation
        if not doc["Summary"]:
            wrong.append(f"{name}: no summary")
        if _named(doc["Parameters"]) not in ([], _parameters(function, bound)):
            wrong.append(f"{name}: parameters are {_parameters(function, bound)}")
        if returned in (None, "None") and doc["Returns"]:
            wrong.append(f"{name}: it returns nothing")
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
        if any(isinstance(node, ast.Raise) for node in ast.walk(tree)) and not doc["Raises"]:
            wrong.append(f"{name}: it raises, and does not say so")
    assert wrong == []


def test_what_users_call_says_all_of_it():
    wrong = []
    for name in USERS:
        function, bound = FUNCTIONS[name]
        doc, parameters = FunctionDoc(function), _parameters(function, bound)
        if _named(doc["Parameters"]) != parameters:
            wrong.append(f"{name}: parameters are {parameters}")
        returned = inspect.signature(function).return_annotation
        if parameters and returned not in (None, "None") and not doc["Returns"]:
            wrong.append(f"{name}: it returns {returned}, and does not say what that is")
    assert wrong == []


def test_a_class_names_what_it_is_made_of():
    wrong = []
    for name, kind in CLASSES.items():
        doc = ClassDoc(kind)
        if not doc["Summary"]:
            wrong.append(f"{name}: no summary")
        given = _named(doc["Parameters"]) + _named(doc["Attributes"])
        own = {field.name for field in fields(kind)} if is_dataclass(kind) else set()
        if given and (unsaid := own - set(given) - _undocumented(kind)):
            wrong.append(f"{name}: not said: {unsaid}")
        wrong += [
            f"{name}.{member}: no docstring"
            for member, value in members_of(kind).items()
            if isinstance(value, property) and not member.startswith("_")
            if not inspect.getdoc(value)
        ]
    assert wrong == []


def _undocumented(kind: type) -> set[str]:
    """Fields that are nobody's business."""
    return {name for name in getattr(kind, "__dataclass_fields__", {}) if name.startswith("_")}
