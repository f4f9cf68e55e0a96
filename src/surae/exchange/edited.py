"""An OpenSim model with the muscles of a fitted leg in it, all else of the file as it is.

The file is not written anew: elements of it are replaced where they stand, byte by byte, and the
lines that change are kept as a difference that `patch` understands.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from surae.base.errors import InputError
from surae.exchange.into import FittedHead, LegForModel
from surae.exchange.text import row
from surae.exchange.xml_tree import Node, parse_xml

#: Formats that know these muscles, and forces along a path by an expression.
_OLDEST = 40000
#: What of a muscle stays as it is, beside its path.
_KEPT = ("appliesForce", "min_control", "max_control")
#: Activation below which a tendon of OpenSim that gives way finds no balance.
_LEAST = 0.01
#: Names of what is added to a model.
ADDED = "surae"
_CONTEXT = 2


@dataclass(frozen=True, slots=True)
class EditedModel:
    """A model's file as it was and as it is with the leg in it."""

    before: bytes
    after: bytes
    difference: str  #: The lines that changed, as ``diff -u`` shows them.


@dataclass(frozen=True, slots=True)
class _Change:
    """Bytes of a file that others take the place of."""

    start: int
    end: int
    text: bytes


def edited(leg: LegForModel, comments: Sequence[str]) -> EditedModel:
    """The model with the leg in it; comments stand before the first of its muscles."""
    into = leg.into
    if into.version < _OLDEST:
        raise InputError(
            f"{into.where}: it is of an older format ({into.version or 'none stated'}); open it in "
            "OpenSim 4 and save it"
        )
    data = into.data
    changes = []
    heads = sorted(leg.heads, key=lambda of: of.head.node.start)
    for place, of in enumerate(heads):
        node = of.head.node
        indent = _indent(data, node.start)
        before = comments if place == 0 else ()
        text = "".join(f"<!-- {_plain(c)} -->\n{indent}" for c in before) + _muscle(
            of, data, indent
        )
        changes.append(_Change(node.start, node.end, text.encode("ascii", "xmlcharrefreplace")))
    changes.append(_added(leg, data))
    changes.sort(key=lambda change: change.start)
    after = _spliced(data, changes)
    parse_xml(after, into.where)  # what is written can be read
    return EditedModel(data, after, _difference(data, changes, into.where))


def _plain(comment: str) -> str:
    """A comment without what would end it, in plain letters."""
    return comment.replace("--", "- -").replace("’", "'").replace("°", " deg").replace("·", "*")


def _indent(data: bytes, start: int) -> str:
    """White space before an element on its line."""
    line = data[data.rfind(b"\n", 0, start) + 1 : start]
    return line.decode("latin-1") if not line.strip() else ""


def _muscle(of: FittedHead, data: bytes, indent: str) -> str:
    """The element of a muscle: its path and controls as they were, all else the fit's."""
    muscle = of.muscle
    node = of.head.node
    rigid = muscle.strain == 0.0
    lines = []
    for child in node.children:
        if child.tag == "GeometryPath" or child.tag in _KEPT:
            lines.append(data[child.start : child.end].decode("utf-8", "surrogateescape"))
    values: dict[str, float | str] = {
        "max_isometric_force": muscle.peak,
        "optimal_fiber_length": muscle.optimal,
        "tendon_slack_length": muscle.slack,
        "pennation_angle_at_optimal": muscle.pennation,
        "max_contraction_velocity": muscle.speed,
        "ignore_tendon_compliance": "true" if rigid else "false",
        "activation_time_constant": muscle.lag,
        "deactivation_time_constant": muscle.lag,
        "default_activation": _LEAST,
        "fiber_damping": 0.0,
        "active_force_width_scale": muscle.width,
        "ignore_passive_fiber_force": "true",
        "tendon_strain_at_one_norm_force": 0.049 if rigid else muscle.strain,
    }
    if not rigid and not any(child.tag == "min_control" for child in node.children):
        values["min_control"] = _LEAST
    lines += [f"<{name}>{row(value)}</{name}>" for name, value in values.items()]
    return _element("DeGrooteFregly2016Muscle", node.name, lines, indent)


def _element(tag: str, name: str, lines: Sequence[str], indent: str) -> str:
    inner = "".join(f"\n{indent}\t{line}" for line in lines)
    return f'<{tag} name="{name}">{inner}\n{indent}</{tag}>'


def _added(leg: LegForModel, data: bytes) -> _Change:
    """Tissue of muscles and joint, as forces at the end of the model's."""
    forces = leg.into.model.find("ForceSet")
    objects = None if forces is None else forces.find("objects")
    assert objects is not None  # its muscles stand in it
    names = {node.name for node in objects.children}
    indent = _indent(data, objects.children[0].start)
    elements = [_tissue(of, data, indent) for of in leg.heads]
    if leg.tissue.pulls:
        elements.append(_joint(leg, indent))
    for element in elements:
        name = element.split('"')[1]
        if name in names:
            raise InputError(
                f"{leg.into.where}: it has a force {name!r} already: give the model as it was "
                "before a leg was written into it"
            )
    text = "".join(f"\n{indent}{element}" for element in elements)
    end = objects.children[-1].end
    return _Change(end, end, text.encode("utf-8", "surrogateescape"))


def _tissue(of: FittedHead, data: bytes, indent: str) -> str:
    """Relaxed tissue along a head's path."""
    path = next(c for c in of.head.node.children if c.tag == "GeometryPath")
    copy = data[path.start : path.end].decode("utf-8", "surrogateescape")
    copy = f'<GeometryPath name="path">{copy.partition(">")[2]}'
    tissue = of.tissue
    terms = [f"({c:.12g})*s^{power}" for power, c in enumerate(tissue.coefficients) if power]
    expression = f"exp({'+'.join([f'{tissue.coefficients[0]:.12g}', *terms])})"
    lines = [
        copy,
        f"<resting_length>{row(tissue.rest)}</resting_length>",
        f"<expression>{expression}</expression>",
        "<clamp_stretch>false</clamp_stretch>",
    ]
    name = f"{ADDED}_{of.head.name}_tissue"
    return _element("ExpressionBasedPathForce", name, lines, indent)


def _joint(leg: LegForModel, indent: str) -> str:
    """The joint's own tissue, against the angle's sign there."""
    of = leg.tissue
    sign = leg.into.sign
    terms = f"{sign * of.torque:.12g}+({of.stiffness:.12g})*q+({of.damping:.12g})*qdot"
    terms += "".join(
        f"+({c * sign ** (power + 1):.12g})*q^{power}" for power, c in enumerate(of.bends, start=2)
    )
    lines = [
        f"<coordinate>{leg.into.coordinate}</coordinate>",
        f"<expression>-({terms})</expression>",
    ]
    name = f"{ADDED}_{leg.into.coordinate}_tissue"
    return _element("ExpressionBasedCoordinateForce", name, lines, indent)


def _spliced(data: bytes, changes: Sequence[_Change]) -> bytes:
    parts = []
    here = 0
    for change in changes:
        parts += [data[here : change.start], change.text]
        here = change.end
    return b"".join([*parts, data[here:]])


def _difference(data: bytes, changes: Sequence[_Change], name: str) -> str:
    """The changed lines with those around them, as ``diff -u`` shows them."""
    old = _lines(data)
    made = [f"--- {name}\n", f"+++ {name} with the leg\n"]
    moved = 0
    for hunk in _hunks(data, changes):
        top = max(hunk[0].first - _CONTEXT, 0)
        bottom = min(hunk[-1].last + _CONTEXT, len(old))
        body = []
        here = top
        for each in hunk:
            body += [f" {line}" for line in old[here : each.first]]
            body += [f"-{line}" for line in old[each.first : each.last]]
            body += [f"+{line}" for line in each.lines]
            here = each.last
        body += [f" {line}" for line in old[here:bottom]]
        grown = sum(len(each.lines) - (each.last - each.first) for each in hunk)
        size = bottom - top
        made.append(f"@@ -{top + 1},{size} +{top + 1 + moved},{size + grown} @@\n")
        made += body
        moved += grown
    return "".join(made)


@dataclass(frozen=True, slots=True)
class _NewLines:
    """Lines of a file, from `first` to before `last`, that others take the place of."""

    first: int
    last: int
    lines: list[str]


def _hunks(data: bytes, changes: Sequence[_Change]) -> list[list[_NewLines]]:
    """Changes by whole lines, those whose surroundings meet together."""
    spans: list[tuple[int, int, list[_Change]]] = []
    for change in changes:
        begin = data.rfind(b"\n", 0, change.start) + 1
        ending = data.find(b"\n", change.end) + 1 or len(data)
        if spans and begin < spans[-1][1]:  # on a line that another changes too
            begin, _, before = spans.pop()
            spans.append((begin, ending, [*before, change]))
        else:
            spans.append((begin, ending, [change]))
    hunks: list[list[_NewLines]] = []
    for begin, ending, within in spans:
        first = data.count(b"\n", 0, begin)
        last = first + len(_lines(data[begin:ending]))
        moved = [_Change(c.start - begin, c.end - begin, c.text) for c in within]
        fresh = _NewLines(first, last, _lines(_spliced(data[begin:ending], moved)))
        if hunks and first - hunks[-1][-1].last <= 2 * _CONTEXT:
            hunks[-1].append(fresh)
        else:
            hunks.append([fresh])
    return hunks


def _lines(data: bytes) -> list[str]:
    """Lines with their ends; only a line feed ends one."""
    parts = data.decode("utf-8", "replace").split("\n")
    return [f"{part}\n" for part in parts[:-1]] + ([parts[-1]] if parts[-1] else [])


def changed(leg: LegForModel) -> list[tuple[str, str, str, str]]:
    """What of each muscle changes: its name, the property, before and after."""
    rows = []
    for of in leg.heads:
        node: Node = of.head.node
        rows.append((of.head.name, "muscle", node.tag, "DeGrooteFregly2016Muscle"))
        after = {
            "max_isometric_force": of.muscle.peak,
            "tendon_slack_length": of.muscle.slack,
            "active_force_width_scale": of.muscle.width,
            "max_contraction_velocity": of.muscle.speed,
        }
        for name, value in after.items():
            before = node.number(name)
            rows.append(
                (of.head.name, name, "" if before is None else f"{before:.5g}", f"{value:.5g}")
            )
    return rows
