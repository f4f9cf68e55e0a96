"""Every parameter of every model, once: name, unit, meaning, start and bounds."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from surae.model.options import ModelOptions


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a model.

    Attributes
    ----------
    name : str
        The thesis's name, the same in files, figures and Python.
    unit : str
        SI unit; ``"-"`` when dimensionless.
    meaning : str
        What it is, in a few plain words.
    group : {"limb", "passive", "active", "tendon", "measurement"}
        Which part of the torque it acts on; the last are the laboratory's, not the leg's.
    start : float
        Where a fit starts, and the value of a tendon parameter that is left out.
    lower, upper : float
        Bounds of a fit.
    positive : bool
        Whether any use of the model needs a value above zero; otherwise zero is allowed too.
    signed : bool
        Whether values below zero have a meaning as well.
    """

    name: str
    unit: str
    meaning: str
    group: str
    start: float
    lower: float
    upper: float
    positive: bool = True
    signed: bool = False


_P = Parameter
#: The fifteen parameters of the muscle model (thesis Table 1, right), in the order of the thesis.
MUSCLE_PARAMETERS: tuple[Parameter, ...] = (
    _P("m", "kg", "mass of foot and footplate", "limb", 2.0, 1.2, 3.0, positive=False),
    _P("k_tri", "1/m", "stiffness coefficient, triceps surae", "passive", 150.0, 20.0, 600.0),
    _P("k_tib", "1/m", "stiffness coefficient, tibialis anterior", "passive", 100.0, 20.0, 600.0),
    _P("x0_tri", "m", "slack length, triceps surae", "passive", 0.016, 0.002, 0.06),
    _P("x0_tib", "m", "slack length, tibialis anterior", "passive", 0.060, 0.010, 0.12),
    _P("tau_rel", "s", "relaxation time constant", "passive", 3.0, 0.1, 30.0),
    _P("k_rel", "-", "relaxation factor", "passive", 0.3, 0.0, 3.0, positive=False),
    _P("g1", "N/V", "EMG weight, tibialis anterior", "active", 1e6, 0.0, 2e7, positive=False),
    _P("g2", "N/V", "EMG weight, gastrocnemius lateralis", "active", 1e6, 0.0, 2e7, positive=False),
    _P("g3", "N/V", "EMG weight, soleus", "active", 1e6, 0.0, 2e7, positive=False),
    _P("g4", "N/V", "EMG weight, gastrocnemius medialis", "active", 1e6, 0.0, 2e7, positive=False),
    _P("l0_tri", "m", "optimal length, triceps surae", "active", 0.042, 0.020, 0.070),
    _P("l0_tib", "m", "optimal length, tibialis anterior", "active", 0.080, 0.040, 0.130),
    _P("f0", "Hz", "cut-off frequency of the activation filter", "active", 2.5, 0.3, 15.0),
    _P("beta", "-", "relative damping of the activation filter", "active", 1.0, 0.2, 4.0),
)

_BY_NAME = {p.name: p for p in MUSCLE_PARAMETERS}
#: The ten parameters of the model of 2010 (thesis Table 1, left), in the order of the thesis.
MUSCLE_2010_PARAMETERS: tuple[Parameter, ...] = (
    _BY_NAME["m"],
    _BY_NAME["k_tri"],
    replace(_BY_NAME["x0_tri"], meaning="length shift, triceps surae"),
    replace(_BY_NAME["g1"], name="e1", meaning="IEMG weight, tibialis anterior"),
    replace(_BY_NAME["g2"], name="e2", meaning="IEMG weight, gastrocnemius lateralis"),
    replace(_BY_NAME["g3"], name="e3", meaning="IEMG weight, soleus"),
    replace(_BY_NAME["g4"], name="e4", meaning="IEMG weight, gastrocnemius medialis"),
    replace(_BY_NAME["f0"], name="f"),
    _P("b_tri", "N·s/m", "viscosity, triceps surae", "passive", 500.0, 0.0, 2e4, positive=False),
    _P("F0", "N", "force shift, triceps surae", "passive", 0.0, -500.0, 500.0, False, True),
)

#: The tendons (thesis Table 2), after the fifteen; slack lengths matter to no torque and are
#: constants. ε0 is in metres as the printed equations take it.
TENDON_PARAMETERS: tuple[Parameter, ...] = (
    _P("dlt_tri", "m", "tendon strain factor, triceps surae", "tendon", 0.04, 0.005, 0.2),
    _P("dlt_tib", "m", "tendon strain factor, tibialis anterior", "tendon", 0.04, 0.002, 0.2),
    _P("pt_tri", "-", "tendon toe force, triceps surae", "tendon", 0.3, 0.05, 0.9),
    _P("pt_tib", "-", "tendon toe force, tibialis anterior", "tendon", 0.3, 0.05, 0.9),
    _P("kt_tri", "-", "tendon toe shape, triceps surae", "tendon", 4.0, 1.0, 10.0),
    _P("kt_tib", "-", "tendon toe shape, tibialis anterior", "tendon", 4.0, 1.0, 10.0),
    _P("fmax_tri", "N", "tendon force at dlt, triceps surae", "tendon", 8e3, 2e3, 2e4),
    _P(
        "fmax_tib",
        "N",
        "tendon force at dlt, tibialis anterior",
        "tendon",
        1.4e3,
        300.0,
        6e3,
    ),
)

_ELECTRODES = {
    "ta": "tibialis anterior",
    "gl": "gastrocnemius lateralis",
    "sol": "soleus",
    "gm": "gastrocnemius medialis",
}
#: Crosstalk: part of a muscle's envelope that the electrode of another hears, by their channels.
CROSSTALK: dict[tuple[int, int], str] = {
    (i, j): f"xt_{hears}_{of}"
    for i, hears in enumerate(_ELECTRODES)
    for j, of in enumerate(_ELECTRODES)
    if i != j
}
_NAMES = tuple(_ELECTRODES)
_GROUPS = {"tri": "triceps surae", "tib": "tibialis anterior"}


def _measurement(name: str, unit: str, meaning: str, lower: float, upper: float) -> Parameter:
    """What the laboratory cannot rule out: nothing at 0, where a fit starts."""
    return Parameter(name, unit, meaning, "measurement", 0.0, lower, upper, False, lower < 0.0)


#: What a model takes beside its own parameters: other drives of the muscles, and what the
#: laboratory cannot rule out. All are off at these starts (but for the delay of a reflex that is),
#: and no part of a model that is not asked for them (`surae.model.registry.with_optional`).
OPTIONAL_PARAMETERS: tuple[Parameter, ...] = (
    _P("emd", "s", "electromechanical delay of the EMG", "active", 0.0, 0.0, 0.2, positive=False),
    _P("reflex_tri", "N·s/m", "reflex gain, triceps surae", "active", 0.0, 0.0, 1e5, False),
    _P("reflex_tib", "N·s/m", "reflex gain, tibialis anterior", "active", 0.0, 0.0, 1e5, False),
    _P("reflex_delay", "s", "delay of the reflex", "active", 0.05, 0.02, 0.15, positive=False),
    *(
        _measurement(name, "-", f"crosstalk of {_NAMES[of]} at {_NAMES[hears]}", 0.0, 0.3)
        for (hears, of), name in CROSSTALK.items()
    ),
    *(
        _measurement(f"emg_rest_{at}", "V", f"EMG at rest, {muscle}", -1e-4, 1e-4)
        for at, muscle in _ELECTRODES.items()
    ),
    *(
        _measurement(f"emg_drift_{at}", "-", f"drift of the EMG, {muscle}", -0.5, 0.5)
        for at, muscle in _ELECTRODES.items()
    ),
    _measurement("emg_shape", "-", "curvature of force over EMG", -5.0, 1.0),
    _measurement("torque_zero", "Nm", "zero of the torque", -30.0, 30.0),
    _measurement("angle_zero", "rad", "zero of the angle", -0.35, 0.35),
    _measurement("axis_forward", "m", "ankle's axis before the device's", -0.03, 0.03),
    _measurement("axis_up", "m", "ankle's axis above the device's", -0.03, 0.03),
    _measurement("plate_inertia", "kg·m²", "inertia of the plate beside the foot's", -0.1, 0.1),
    _measurement("plate_cos", "Nm", "weight of the plate, times cos θ", -20.0, 20.0),
    _measurement("plate_sin", "Nm", "weight of the plate, times sin θ", -20.0, 20.0),
    _measurement("plate_give", "rad/Nm", "angle by which the foot plate gives way", 0.0, 4e-3),
    *(
        _measurement(f"{name}_{group}", unit, f"{meaning}, {muscle}", -limit, limit)
        for name, unit, meaning, limit in (
            ("arm_scale", "-", "logarithm of the moment arm over the assumed one", 0.4),
            ("arm_slope", "1/rad", "slope of the moment arm over the assumed one", 0.6),
            ("arm_bend", "1/rad²", "curvature of the moment arm over the assumed one", 0.8),
            ("path_scale", "-", "logarithm of the path's slope over the assumed one", 0.9),
            ("length_zero", "m", "muscle length at θ = 0 beyond the assumed one", 0.02),
        )
        for group, muscle in _GROUPS.items()
    ),
    *(
        _measurement(f"{name}_{group}", "-", f"{meaning}, {muscle}", -1.5, 1.5)
        for name, meaning in (
            ("fl_short", "logarithm of the force–length curve's width below l0"),
            ("fl_long", "logarithm of the force–length curve's width above l0"),
        )
        for group, muscle in _GROUPS.items()
    ),
    _measurement("fv_speed", "-", "logarithm of the greatest speed over the assumed", -1.0, 1.0),
    _measurement("fv_curve", "-", "logarithm of the force–velocity curve's bend", -1.0, 1.0),
    _measurement("fv_stretch", "-", "logarithm of the force gained in stretch", -1.0, 1.0),
    _measurement("emg_power", "-", "power of force over EMG, less one", -0.7, 1.0),
    *(
        _measurement(f"film_{name}_{at}", unit, f"{meaning}, {muscle}", -limit, limit)
        for at, muscle in (("tib", _GROUPS["tib"]), *list(_ELECTRODES.items())[1:])
        for name, unit, meaning, limit in (
            ("scale", "-", "filmed fascicle's changes of length over the muscle's, less one", 0.3),
            ("zero", "m", "filmed fascicle's length beyond the muscle's", 0.03),
        )
    ),
)
#: The same by the name under which all parameters of a group are freed.
OPTIONAL: dict[str, tuple[str, ...]] = {
    "emd": ("emd",),
    "reflex": ("reflex_tri", "reflex_tib", "reflex_delay"),
    "crosstalk": tuple(CROSSTALK.values()),
    "emg_rest": tuple(f"emg_rest_{at}" for at in _ELECTRODES),
    "emg_drift": tuple(f"emg_drift_{at}" for at in _ELECTRODES),
    "emg_shape": ("emg_shape",),
    "torque_zero": ("torque_zero",),
    "angle_zero": ("angle_zero",),
    "axis": ("axis_forward", "axis_up"),
    "plate": ("plate_inertia", "plate_cos", "plate_sin"),
    "plate_give": ("plate_give",),
    "arm": tuple(
        f"{of}_{g}" for of in ("arm_scale", "arm_slope", "arm_bend", "path_scale") for g in _GROUPS
    ),
    "length_zero": tuple(f"length_zero_{g}" for g in _GROUPS),
    "curves": (
        *(f"fl_{of}_{g}" for of in ("short", "long") for g in _GROUPS),
        "fv_speed", "fv_curve", "fv_stretch",
    ),
    "emg_power": ("emg_power",),
    **{
        f"film_{at}": (f"film_scale_{at}", f"film_zero_{at}")
        for at in ("tib", *list(_ELECTRODES)[1:])
    },
}  # fmt: skip

#: Parameters that are off at 0: what they stand for is then not there.
OFF_AT_ZERO = frozenset(
    p.name
    for p in (
        *MUSCLE_PARAMETERS, *MUSCLE_2010_PARAMETERS, *TENDON_PARAMETERS, *OPTIONAL_PARAMETERS
    )
    if p.lower <= 0.0 <= p.upper
)  # fmt: skip

#: Start and bounds that differ in the virtual-work geometry, whose muscles travel about 2.8 times
#: (triceps) and 1.5 times (tibialis) as far per radian.
_VIRTUAL_WORK = {
    "k_tri": (60.0, 10.0, 300.0),
    "k_tib": (70.0, 10.0, 400.0),
    "x0_tri": (0.030, 0.001, 0.15),
    "x0_tib": (0.075, 0.005, 0.20),
    "l0_tri": (0.080, 0.030, 0.20),
    "l0_tib": (0.105, 0.040, 0.25),
}
#: ε0 as a strain, times the slack length (Thelen 2003).
_SLACK_LENGTH = {"dlt_tri": (0.10, 0.01, 0.5), "dlt_tib": (0.035, 0.005, 0.5)}
#: The weights of a normalised EMG envelope (unit "1") are forces [N].
_NORMALISED_WEIGHT = (1e3, 0.0, 2e4)
#: And their level at rest is a part of 1.
_NORMALISED_REST = (0.0, -0.2, 0.2)


def adapted(
    parameters: tuple[Parameter, ...], options: ModelOptions, emg_unit: str = "V"
) -> dict[str, Parameter]:
    """The parameters by name, start, bounds and unit adapted to options and EMG unit.

    Parameters
    ----------
    parameters : tuple of Parameter
        The model's parameters.
    options : ModelOptions
        The virtual-work geometry, and a table in which muscles travel as far, has other starts and
        bounds for lengths and stiffnesses; the tendon's ε0 is a length or a strain.
    emg_unit : {"V", "1"}
        Weights of a normalised envelope are in N and of another magnitude.
    """
    changes: dict[str, Mapping[str, object]] = {}
    if options.travel == "virtual-work":
        longer = _longer(options)
        for name, (usual, lower, upper) in _VIRTUAL_WORK.items():
            start = min(max(usual + longer.get(name, 0.0), lower), upper)
            changes[name] = {"start": start, "lower": lower, "upper": upper}
    if options.tendon_strain == "slack-length":
        for name, (start, lower, upper) in _SLACK_LENGTH.items():
            changes[name] = {"unit": "-", "start": start, "lower": lower, "upper": upper}
    if emg_unit == "1":
        units = {"N/V": ("N", *_NORMALISED_WEIGHT), "V": ("-", *_NORMALISED_REST)}
        for p in parameters:
            if p.unit in units:
                fields = ("unit", "start", "lower", "upper")
                changes[p.name] = dict(zip(fields, units[p.unit], strict=True))
    return {p.name: replace(p, **changes.get(p.name, {})) for p in parameters}  # type: ignore[arg-type]


def _longer(options: ModelOptions) -> dict[str, float]:
    """By how much muscles of a table are longer than is assumed otherwise [m]."""
    table = options.geometry
    if isinstance(table, str) or not table.slack:
        return {}
    assumed = {"tri": options.x_ref_tri, "tib": options.x_ref_tib}
    rest = {group: table.rest(row) - assumed[group] for row, group in enumerate(assumed)}
    return {f"{of}_{group}": rest[group] for of in ("l0", "x0") for group in rest}
