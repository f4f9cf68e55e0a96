"""Readers of other programs' results: OpenSim, NMSM, CEINMS and MuscleRedundancySolver."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from surae.base.errors import InputError
from surae.base.files import PathLike, is_link, read_bytes, shown
from surae.base.words import Message
from surae.exchange.foreign_result import ForeignResult, ForeignValue
from surae.exchange.leg_in_model import muscles_of
from surae.exchange.results_matlab import read_matlab
from surae.exchange.xml_tree import Node, parse_xml
from surae.recording.formats import open_table
from surae.recording.source import Source

_LARGEST = 256 * 2**20
_OPENSIM = {
    "optimal_fiber_length": ("optimal_fiber_length",),
    "tendon_slack_length": ("tendon_slack_length",),
    "max_isometric_force": ("max_isometric_force",),
    "pennation_angle": ("pennation_angle_at_optimal", "pennation_angle"),
    "tendon_strain": ("tendon_strain_at_one_norm_force", "FmaxTendonStrain"),
}
#: What NMSM writes of a muscle: our name, how its number becomes ours, where it begins, its limits;
#: of its lengths the limits are parts of what they began from.
_NMSM = {
    "electromechanical_delay": ("electromechanical_delay", 0.1, 0.5, (0.0, 1.25)),
    "activation_time_constant": ("activation_time", 0.01, 1.5, (0.75, 3.5)),
    "activation_nonlinearity_constant": ("activation_nonlinearity", 1.0, 0.05, (0.0, 0.35)),
    "emg_scale_factor": ("emg_scale", 1.0, 0.5, (0.05, 1.0)),
}
_NMSM_LENGTHS = {
    "optimal_fiber_length": ("optimal_fiber_length",),
    "tendon_slack_length": ("tendon_slack_length", "slack_tendon_length"),
    "max_isometric_force": ("max_isometric_force",),
}
_NMSM_SCALES = (0.6, 1.4)
#: Rows of NMSM's muscleModelParameters.sto.
_NMSM_ROWS = (
    "activation_time_constant",
    "activation_nonlinearity_constant",
    "electromechanical_delay",
    "emg_scale_factor",
    "optimal_fiber_length",
    "tendon_slack_length",
)
#: CEINMS' names, in both of its layouts.
_CEINMS = {
    "c1": "c1",
    "c2": "c2",
    "shapefactor": "shape_factor",
    "optimalfibrelength": "optimal_fiber_length",
    "optimalfiberlength": "optimal_fiber_length",
    "pennationangle": "pennation_angle",
    "tendonslacklength": "tendon_slack_length",
    "maxisometricforce": "max_isometric_force",
    "strengthcoefficient": "strength_coefficient",
    "strengthcoefficients": "strength_coefficient",
    "emdelay": "electromechanical_delay",
}
_DEGREES = 1.6  #: A pennation above is in degrees [rad].
_FOLDER = ("*.osimx", "*_mtp.xml", "*muscleModelParameters.sto", "*_Results.mat")


def read_result(path: PathLike, *, calibration: PathLike | None = None) -> ForeignResult:
    """What a program's file, or the folder of its results, says of muscles.

    A `calibration` is CEINMS' set-up, with the limits of its search.
    """
    file = _file_of(Path(path))
    data = read_bytes(file, _LARGEST)
    where = shown(file)
    if file.suffix.casefold() == ".mat":
        return ForeignResult(*read_matlab(data, where))
    if file.suffix.casefold() == ".sto":
        return _nmsm_table(data, where)
    root = parse_xml(data, where)
    if root.tag == "OpenSimDocument" and root.find("Model") is not None:
        return _of_model(root, where, str(file))
    if next(root.all("RCNLMuscle"), None) is not None:
        return _nmsm(root, file)
    if root.tag == "subject":
        return _ceinms(root, file, calibration)
    raise InputError(
        f"{where}: <{root.tag}> is no result that is known; give an OpenSim model (.osim), NMSM’s "
        ".osimx or muscleModelParameters.sto, CEINMS’ subject (.xml) or MuscleRedundancySolver’s "
        "results (.mat)"
    )


def _file_of(path: Path) -> Path:
    """The file itself, or the one result in a folder."""
    if not path.is_dir():
        return path
    files = [
        each
        for pattern in _FOLDER
        for each in sorted(path.rglob(pattern))
        if each.is_file() and not is_link(each)
    ]
    if not files:
        raise InputError(
            f"{shown(path)}: no result is in this folder ({', '.join(_FOLDER)}); name the file"
        )
    return files[0]


def _of_model(root: Node, where: str, path: str) -> ForeignResult:
    """An OpenSim model's muscles."""
    values = []
    for muscle in muscles_of(root, where):
        for name, tags in _OPENSIM.items():
            number = muscle.number(*tags)
            if number is not None:
                values.append(ForeignValue(muscle.name, name, number))
    if not values:
        raise InputError(f"{where}: this OpenSim model has no muscle")
    model = root.find("Model")
    assert model is not None  # `muscles_of` found it
    mass = sum(
        body.number("mass") or 0.0
        for listed in (model.find("BodySet"),)
        if listed is not None
        for body in listed.all("Body")
    )
    return ForeignResult("OpenSim", where, tuple(values), path, mass or None)


def model_beside(name: str, path: Path) -> ForeignResult | None:
    """The model that a result names, where it lies beside it or in a folder above."""
    name = name.replace("\\", "/").strip()
    if not name:
        return None
    places = [
        path.parent / name,
        *(folder / Path(name).name for folder in (path.parent, *path.parents[1:3])),
    ]
    for place in places:
        if place.is_file() and not is_link(place):
            root = parse_xml(read_bytes(place, _LARGEST), shown(place))
            return _of_model(root, shown(place), str(place))
    return None


def _nmsm(root: Node, path: Path) -> ForeignResult:
    """NMSM's .osimx, with the model that it names."""
    where = shown(path)
    named = next((n.text for n in root.all("associated_osim_model")), "")
    model = model_beside(named, path)
    began = {} if model is None else {(v.muscle, v.parameter): v.value for v in model.values}
    values: list[ForeignValue] = []
    for muscle in root.all("RCNLMuscle"):
        for tag, (name, factor, start, limits) in _NMSM.items():
            number = muscle.number(tag)
            if number is not None:
                low, high = (factor * end for end in limits)
                values.append(
                    ForeignValue(muscle.name, name, factor * number, factor * start, low, high)
                )
        for name, tags in _NMSM_LENGTHS.items():
            number = muscle.number(*tags)
            if number is not None:
                values.append(_scaled(muscle.name, name, number, began.get((muscle.name, name))))
    notes = (
        ()
        if model is not None or not named.strip()
        else (Message("opinion/no-model", name=named.strip()),)
    )
    known = ("", None) if model is None else (model.path, model.mass)
    return ForeignResult("NMSM", where, tuple(values), *known, notes)


def _scaled(muscle: str, name: str, number: float, generic: float | None) -> ForeignValue:
    """A length that NMSM scales, between its limits."""
    if generic is None or name == "max_isometric_force":
        return ForeignValue(muscle, name, number, generic)
    low, high = (end * generic for end in _NMSM_SCALES)
    return ForeignValue(muscle, name, number, generic, low, high)


def _nmsm_table(data: bytes, where: str) -> ForeignResult:
    """NMSM's muscleModelParameters.sto: six rows of numbers, a column for each muscle."""
    table = open_table(Source(where, data, ""))
    muscles = table.names
    read = table.load(muscles)
    values: list[ForeignValue] = []
    for muscle in muscles:
        numbers = read[muscle].values.tolist()
        if len(numbers) != len(_NMSM_ROWS):
            raise InputError(
                f"{where}: it has {len(numbers)} rows; NMSM’s muscleModelParameters.sto has "
                f"{len(_NMSM_ROWS)}"
            )
        for tag, number in zip(_NMSM_ROWS, numbers, strict=True):
            if tag in _NMSM:
                name, factor, start, limits = _NMSM[tag]
                low, high = (factor * end for end in limits)
                values.append(
                    ForeignValue(muscle, name, factor * number, factor * start, low, high)
                )
            else:  # the part of what it began from
                values.append(ForeignValue(muscle, tag, number, 1.0, *_NMSM_SCALES))
    return ForeignResult("NMSM", where, tuple(values), notes=(Message("opinion/parts"),))


def _ceinms(root: Node, path: Path, calibration: PathLike | None) -> ForeignResult:
    """CEINMS' subject, with the one that it began from and its limits, where they are known."""
    where = shown(path)
    values = list(_ceinms_values(root))
    if not values:
        raise InputError(f"{where}: this subject of CEINMS has no muscle (<mtu>)")
    began = next((n.text.strip() for n in root.all("startSubjectFile")), "")
    result = ForeignResult("CEINMS", where, tuple(values))
    start = path.parent / Path(began.replace("\\", "/")).name if began else None
    if start is not None and start.is_file() and not is_link(start):
        first = parse_xml(read_bytes(start, _LARGEST), shown(start))
        result = result.with_generic(
            ForeignResult("CEINMS", shown(start), tuple(_ceinms_values(first)))
        )
    elif began:
        result = replace(result, notes=(Message("opinion/no-start", name=began),))
    if calibration is not None:
        limits = _ceinms_limits(calibration)
        values = [_limited(v, limits) for v in result.values]
        result = replace(result, values=tuple(values))
    return result


def _ceinms_values(root: Node) -> Iterator[ForeignValue]:
    for muscle in root.all("mtu", "muscle"):
        name = muscle.said("name")
        for child in muscle.children:
            ours = _CEINMS.get(child.tag.casefold())
            if not name or ours is None:
                continue
            number = muscle.number(child.tag)
            if number is None:
                continue
            if ours == "pennation_angle" and (
                child.attributes.get("unit") == "deg" or abs(number) > _DEGREES
            ):
                number *= 0.017453292519943295
            yield ForeignValue(name, ours, number)


_Limits = Mapping[str, list[tuple[bool, float, float, frozenset[str]]]]


def _ceinms_limits(path: PathLike) -> _Limits:
    """Limits by parameter: relative or not, ends, and the muscles, empty for every one."""
    data = read_bytes(path, _LARGEST)
    root = parse_xml(data, shown(path))
    limits: dict[str, list[tuple[bool, float, float, frozenset[str]]]] = {}
    for parameter in root.all("parameter"):
        name = _CEINMS.get(parameter.said("name").casefold())
        for tag in ("absolute", "relativeToSubjectValue"):
            node = parameter.find(tag)
            ends = () if node is None else node.numbers("range")
            if name is None or len(ends) != 2:
                continue
            single = parameter.said("single").split()
            groups = [m.text.split() for m in parameter.all("muscles")]
            muscles = frozenset(single).union(*map(frozenset, groups))
            limits.setdefault(name, []).append((tag != "absolute", min(ends), max(ends), muscles))
    if not limits:
        raise InputError(
            f"{shown(path)}: no calibration of CEINMS: it has no <parameter> with a range"
        )
    return limits


def _limited(value: ForeignValue, limits: _Limits) -> ForeignValue:
    """A value with the limits of its search."""
    for relative, low, high, muscles in limits.get(value.parameter, ()):
        if muscles and value.muscle not in muscles:
            continue
        if not relative:
            return replace(value, low=low, high=high, free=True)
        if value.generic is not None:
            ends = sorted((low * value.generic, high * value.generic))
            return replace(value, low=ends[0], high=ends[1], free=True)
    return value
