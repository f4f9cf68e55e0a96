"""Every parameter of every model, once: one record each, of which all that names them is made."""

from collections.abc import Mapping
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.plugins import plugins
from surae.base.units import FloatArray
from surae.base.words import N_
from surae.model.joint import ANKLE, Value
from surae.model.parameter import Added, Parameter
from surae.model.prior import Prior
from surae.model.source import UncertaintySource
from surae.recording import MUSCLE_NAMES, MUSCLES, PLACES

if TYPE_CHECKING:
    from surae.signals import ModelInputs

T = TypeVar("T")
#: Angle about which the joint's own tissue turns from one way to the other [rad]: a relaxed foot's.
JOINT_RESTS = -0.26


def _people(healthy: T, patient: T | None = None) -> Mapping[str, T]:
    """By population; patients are as healthy people are unless it says otherwise."""
    return FrozenDict({"healthy": healthy, "patient": healthy if patient is None else patient})


_CHUNG = (
    "triceps passive torque at 10° dorsiflexion, 6.2 ± 3.6 Nm healthy, 9.5 ± 4.8 Nm spastic "
    "(Chung et al. 2004, Arch. Phys. Med. Rehabil. 85), through equations (8) and (9)"
)
_WARD = (
    "middle of equation (9)'s range; fibre lengths of legs differ by about 20 % in the triceps and "
    "11 % in the tibialis anterior (Ward et al. 2009, Clin. Orthop. Relat. Res. 467)"
)
_SHORTER = "shorter than in health (van de Poll 2015, 2.5.4); spread as in health"
_ASSUMED = "assumed, around the thesis's starting values (van de Poll 2015); no measurement known"
_FILTER = "about 2 Hz, near critical damping (van de Poll 2015, Table 1); spread assumed"
_TOE = "Table 2 (van de Poll 2015), after Thelen 2003; spread assumed"
_ELECTRODES_GIVE = (
    "up to about 80 Nm at envelopes of 6·10⁻⁴ V (van de Poll 2015, Figures 9, 18 to 20)"
)
_TABLE = "Table 2 (van de Poll 2015); spread assumed"
_TRAVEL = "for the muscles' larger travel by virtual work; spread assumed, no measurement known"
_STRAINED = "Thelen 2003, times the slack length; its prior is that of the length"
_REFLEX = "assumed: some Nm at a stretch of 3 rad/s; none known"

_STRETCH_TRI = N_("stretch the relaxed triceps further: more dorsiflexion")
_STRETCH_TIB = N_("stretch the relaxed tibialis further: more plantarflexion")
_HOLD = N_("hold the stretched angle longer, with a passive part in the trial")
_FORCE_TRI = N_("ask for higher forces of the triceps, past the toe of its tendon")
_FORCE_TIB = N_("ask for higher forces of the tibialis, past the toe of its tendon")
_EFFORT = (
    N_("ask for more effort of the tibialis"),
    N_("ask for more effort of the gastrocnemius lateralis"),
    N_("ask for more effort of the soleus"),
    N_("ask for more effort of the gastrocnemius medialis"),
)
_STRAIN = N_("fix it, and let the strain factor vary instead")

_P = Parameter
#: The fifteen parameters of the muscle model (thesis Table 1, right), in the order of the thesis.
MUSCLE_PARAMETERS: tuple[Parameter, ...] = (
    _P(
        "m",
        "kg",
        "mass of foot and footplate",
        "limb",
        2.0,
        1.2,
        3.0,
        positive=False,
        straight=True,
        drawn=_people((1.5, 2.7), (1.25, 2.0)),
        known=_people(
            Prior(2.0, 0.30, "foot 1.45 % of 50 … 100 kg (Winter 2009), footplate about 1 kg"),
            Prior(1.58, 0.30, "less than in health (van de Poll 2015, 2.5.4)"),
        ),
        advice=N_(
            "move faster, with a chirp of more acceleration, or weigh foot and footplate and fix it"
        ),
    ),
    _P(
        "k_tri",
        "1/m",
        "stiffness coefficient, triceps surae",
        "passive",
        150.0,
        20.0,
        600.0,
        known=_people(Prior(198.0, 0.20, _CHUNG), Prior(211.0, 0.20, _CHUNG)),
        drawn=_people((170.0, 230.0), (190.0, 235.0)),
        travel=Value(60.0, 10.0, 300.0, 0.6, _TRAVEL),
        advice=_STRETCH_TRI,
    ),
    _P(
        "k_tib",
        "1/m",
        "stiffness coefficient, tibialis anterior",
        "passive",
        100.0,
        20.0,
        600.0,
        known=_people(Prior(108.0, 0.30, _ASSUMED), Prior(139.0, 0.30, _ASSUMED)),
        drawn=_people((90.0, 130.0), (120.0, 160.0)),
        travel=Value(70.0, 10.0, 400.0, 0.6, _TRAVEL),
        advice=_STRETCH_TIB,
    ),
    _P(
        "x0_tri",
        "m",
        "slack length, triceps surae",
        "passive",
        0.016,
        0.002,
        0.06,
        straight=True,
        known=_people(Prior(0.0170, 0.12, _CHUNG), Prior(0.0155, 0.12, _CHUNG)),
        drawn=_people((0.016, 0.018), (0.0145, 0.0165)),
        travel=Value(0.030, 0.001, 0.15, 0.6, _TRAVEL),
        advice=_STRETCH_TRI,
    ),
    _P(
        "x0_tib",
        "m",
        "slack length, tibialis anterior",
        "passive",
        0.060,
        0.010,
        0.12,
        known=_people(Prior(0.0645, 0.12, _ASSUMED), Prior(0.0600, 0.12, _ASSUMED)),
        drawn=_people((0.062, 0.067), (0.058, 0.062)),
        straight=True,
        travel=Value(0.075, 0.005, 0.20, 0.6, _TRAVEL),
        advice=_STRETCH_TIB,
    ),
    _P(
        "tau_rel",
        "s",
        "relaxation time constant",
        "passive",
        3.0,
        0.1,
        30.0,
        advice=_HOLD,
        known=_people(Prior(2.45, 0.90, _ASSUMED)),
        drawn=_people((1.0, 6.0)),
    ),
    _P(
        "k_rel",
        "-",
        "relaxation factor",
        "passive",
        0.3,
        0.0,
        3.0,
        positive=False,
        advice=_HOLD,
        known=_people(Prior(0.346, 0.55, _ASSUMED)),
        drawn=_people((0.2, 0.6)),
    ),
    *(
        _P(
            f"g{number}",
            "N/V",
            f"EMG weight, {muscle}",
            "active",
            1e6,
            0.0,
            2e7,
            positive=False,
            wide=Prior(median, 1.0, _ELECTRODES_GIVE),
            drawn=_people(drawn),
            advice=_EFFORT[number - 1],
        )
        for number, muscle, median, drawn in zip(
            (1, 2, 3, 4),
            MUSCLE_NAMES.values(),
            (6e5, 1e6, 1e6, 1e6),
            ((4e5, 8e5), (6e5, 1.2e6), (9e5, 1.7e6), (7e5, 1.3e6)),
            strict=True,
        )
    ),
    _P(
        "l0_tri",
        "m",
        "optimal length, triceps surae",
        "active",
        0.042,
        0.020,
        0.070,
        known=_people(Prior(0.0447, 0.20, _WARD), Prior(0.0378, 0.20, _SHORTER)),
        drawn=_people((0.040, 0.050), (0.034, 0.042)),
        travel=Value(0.080, 0.030, 0.20, 0.4, _TRAVEL),
        advice=N_("use more of the range of motion while the triceps is active"),
    ),
    _P(
        "l0_tib",
        "m",
        "optimal length, tibialis anterior",
        "active",
        0.080,
        0.040,
        0.130,
        known=_people(Prior(0.0794, 0.15, _WARD), Prior(0.0671, 0.15, _SHORTER)),
        drawn=_people((0.070, 0.090), (0.060, 0.075)),
        travel=Value(0.105, 0.040, 0.25, 0.4, _TRAVEL),
        advice=N_("use more of the range of motion while the tibialis is active"),
    ),
    _P(
        "f0",
        "Hz",
        "cut-off frequency of the activation filter",
        "active",
        2.5,
        0.3,
        15.0,
        known=_people(Prior(1.96, 0.25, _FILTER)),
        drawn=_people((1.6, 2.4)),
        advice=N_("ask for faster bursts of effort"),
    ),
    _P(
        "beta",
        "-",
        "relative damping of the activation filter",
        "active",
        1.0,
        0.2,
        4.0,
        known=_people(Prior(0.98, 0.25, _FILTER)),
        drawn=_people((0.8, 1.2)),
        advice=N_("ask for faster bursts of effort, or fix it at 1, critical damping"),
    ),
)

#: The tendons (thesis Table 2), after the fifteen; slack lengths matter to no torque and are
#: constants. ε0 is in metres as the printed equations take it.
TENDON_PARAMETERS: tuple[Parameter, ...] = (
    _P(
        "dlt_tri",
        "m",
        "tendon strain factor, triceps surae",
        "tendon",
        0.04,
        0.005,
        0.2,
        straight=True,
        known=_people(
            Prior(0.0374, 0.45, "430 ± 200 N/mm (Peltonen et al. 2010, J. Exp. Biol. 213)"),
            Prior(
                0.0561,
                0.45,
                "42 % less stiff than in health (Zhao et al. 2015, J. Appl. Physiol. 118)",
            ),
        ),
        drawn=_people((0.028, 0.050), (0.045, 0.070)),
        strain=Value(0.10, 0.01, 0.5, 0.0, _STRAINED),
        slack=ANKLE.slack[0],
        advice=_FORCE_TRI,
    ),
    _P(
        "dlt_tib",
        "m",
        "tendon strain factor, tibialis anterior",
        "tendon",
        0.04,
        0.002,
        0.2,
        straight=True,
        known=_people(
            Prior(
                0.0120, 0.45, "161 N/mm (Maganaris and Paul 1999, J. Physiol. 521); spread assumed"
            )
        ),
        drawn=_people((0.008, 0.018)),
        strain=Value(0.035, 0.005, 0.5, 0.0, _STRAINED),
        slack=ANKLE.slack[1],
        advice=_FORCE_TIB,
    ),
    _P(
        "pt_tri",
        "-",
        "tendon toe force, triceps surae",
        "tendon",
        0.3,
        0.05,
        0.9,
        known=_people(Prior(0.283, 0.35, _TOE)),
        drawn=_people((0.2, 0.4)),
        advice=_FORCE_TRI,
    ),
    _P(
        "pt_tib",
        "-",
        "tendon toe force, tibialis anterior",
        "tendon",
        0.3,
        0.05,
        0.9,
        known=_people(Prior(0.283, 0.35, _TOE)),
        drawn=_people((0.2, 0.4)),
        advice=_FORCE_TIB,
    ),
    _P(
        "kt_tri",
        "-",
        "tendon toe shape, triceps surae",
        "tendon",
        4.0,
        1.0,
        10.0,
        wide=Prior(4.0, 0.4, _TABLE),
        advice=_FORCE_TRI,
    ),
    _P(
        "kt_tib",
        "-",
        "tendon toe shape, tibialis anterior",
        "tendon",
        4.0,
        1.0,
        10.0,
        wide=Prior(4.0, 0.4, _TABLE),
        advice=_FORCE_TIB,
    ),
    _P(
        "fmax_tri",
        "N",
        "tendon force at dlt, triceps surae",
        "tendon",
        8e3,
        2e3,
        2e4,
        wide=Prior(8e3, 0.3, _TABLE),
        advice=_STRAIN,
    ),
    _P(
        "fmax_tib",
        "N",
        "tendon force at dlt, tibialis anterior",
        "tendon",
        1.4e3,
        300.0,
        6e3,
        wide=Prior(1.4e3, 0.3, _TABLE),
        advice=_STRAIN,
    ),
)

#: Crosstalk: part of a muscle's envelope that the electrode of another hears, by their channels.
CROSSTALK: dict[tuple[int, int], str] = {
    (i, j): f"xt_{hears}_{of}"
    for i, hears in enumerate(MUSCLES)
    for j, of in enumerate(MUSCLES)
    if i != j
}
_GROUPS = {"tri": "triceps surae", "tib": "tibialis anterior"}


def _measurement(
    name: str,
    unit: str,
    meaning: str,
    lower: float,
    upper: float,
    advice: str,
    torque: Added | None = None,
) -> Parameter:
    """What the laboratory cannot rule out: nothing at 0, where a fit starts."""
    return Parameter(
        name,
        unit,
        meaning,
        "measurement",
        0.0,
        lower,
        upper,
        False,
        lower < 0.0,
        advice,
        straight=True,
        torque=torque,
    )


def _both(advice: str, *rows: tuple[str, str, str, float]) -> tuple[Parameter, ...]:
    """Of each muscle group: name, unit, meaning, limit to either side."""
    return tuple(
        _measurement(f"{name}_{group}", unit, f"{meaning}, {muscle}", -limit, limit, advice)
        for name, unit, meaning, limit in rows
        for group, muscle in _GROUPS.items()
    )


def _constant(inputs: "ModelInputs") -> FloatArray:
    return np.ones(inputs.n)


def _cosine(inputs: "ModelInputs") -> FloatArray:
    return np.cos(inputs.angle)


def _sine(inputs: "ModelInputs") -> FloatArray:
    return np.sin(inputs.angle)


def _from_rest(inputs: "ModelInputs") -> FloatArray:
    return inputs.angle - JOINT_RESTS


_GEOMETRY = N_("give the leg's own geometry")
_LEVELS = N_("ask for weak and strong efforts of the same muscle")
_AXIS = N_("measure where the ankle lies from the device's axis, and fix it")
_PLATE = N_("move the plate without the foot, and take its torque away")
_ANGLES = N_("ask for efforts at more angles and velocities")
_REVERSALS = N_("turn the movement about under steady effort, fast and slowly")
_M = _measurement
#: What a model takes beside its own parameters: other drives of the muscles, and what the
#: laboratory cannot rule out, by the name under which all of a group are freed. All are off at
#: these starts (but for the delay of a reflex that is), and no part of a model that is not asked
#: for them (`surae.model.registry.with_optional`).
_OPTIONAL: dict[str, tuple[Parameter, ...]] = {
    "emd": (
        _P(
            "emd",
            "s",
            "electromechanical delay of the EMG",
            "active",
            0.0,
            0.0,
            0.2,
            positive=False,
            straight=True,
            wide=Prior(
                0.03, 0.7, "20 to 100 ms with the surface EMG (Cavanagh and Komi 1979); assumed"
            ),
            advice=N_("ask for faster bursts of effort, or fix it at a measured delay"),
        ),
    ),
    "reflex": (
        _P(
            "reflex_tri",
            "N·s/m",
            "reflex gain, triceps surae",
            "active",
            0.0,
            0.0,
            1e5,
            False,
            straight=True,
            wide=Prior(2e3, 1.5, _REFLEX),
            advice=N_("stretch the relaxed triceps faster, and at several speeds"),
        ),
        _P(
            "reflex_tib",
            "N·s/m",
            "reflex gain, tibialis anterior",
            "active",
            0.0,
            0.0,
            1e5,
            False,
            straight=True,
            wide=Prior(2e3, 1.5, _REFLEX),
            advice=N_("stretch the relaxed tibialis faster, and at several speeds"),
        ),
        _P(
            "reflex_delay",
            "s",
            "delay of the reflex",
            "active",
            0.05,
            0.02,
            0.15,
            positive=False,
            straight=True,
            wide=Prior(0.05, 0.4, "short latency 40 ms and the muscle's own delay; assumed"),
            advice=N_("stretch faster and shorter at rest, and hold for half a second after each"),
        ),
    ),
    "reflex_length": tuple(
        _M(
            f"reflex_length_{group}",
            "N/m",
            f"reflex to length beyond slack, {muscle}",
            0.0,
            1e6,
            _HOLD,
        )
        for group, muscle in _GROUPS.items()
    ),
    "reflex_force": tuple(
        _M(
            f"reflex_force_{group}",
            "-",
            f"reflex to the tissue's force, {muscle}",
            0.0,
            10.0,
            _HOLD,
        )
        for group, muscle in _GROUPS.items()
    ),
    "crosstalk": tuple(
        _M(
            name,
            "-",
            f"crosstalk of {MUSCLES[of]} at {MUSCLES[hears]}",
            0.0,
            0.3,
            N_("ask for efforts of one muscle at a time, which show what other electrodes hear"),
        )
        for (hears, of), name in CROSSTALK.items()
    ),
    "emg_rest": tuple(
        _M(
            f"emg_rest_{at}",
            "V",
            f"EMG at rest, {muscle}",
            -1e-4,
            1e-4,
            N_("include a part in which all muscles are at rest"),
        )
        for at, muscle in MUSCLE_NAMES.items()
    ),
    "emg_shape": (_M("emg_shape", "-", "curvature of force over EMG", -5.0, 1.0, _LEVELS),),
    "torque_zero": (
        _M(
            "torque_zero",
            "Nm",
            "zero of the torque",
            -30.0,
            30.0,
            N_("measure the zero of the torque's sensor, without a foot, and fix it"),
            Added("zero", _constant),
        ),
    ),
    "angle_zero": (
        _M(
            "angle_zero",
            "rad",
            "zero of the angle",
            -0.35,
            0.35,
            N_("measure the angle at which the foot is perpendicular to the shank, and fix it"),
        ),
    ),
    "axis": (
        _M("axis_forward", "m", "ankle's axis before the device's", -0.03, 0.03, _AXIS),
        _M("axis_up", "m", "ankle's axis above the device's", -0.03, 0.03, _AXIS),
    ),
    "plate": (
        _M(
            "plate_inertia",
            "kg·m²",
            "inertia of the plate beside the foot's",
            -0.1,
            0.1,
            _PLATE,
            Added("inertial", attrgetter("acceleration")),
        ),
        _M(
            "plate_cos",
            "Nm",
            "weight of the plate, times cos θ",
            -20.0,
            20.0,
            _PLATE,
            Added("gravitational", _cosine),
        ),
        _M(
            "plate_sin",
            "Nm",
            "weight of the plate, times sin θ",
            -20.0,
            20.0,
            _PLATE,
            Added("gravitational", _sine),
        ),
    ),
    "joint_spring": (
        _M(
            "joint_stiffness",
            "Nm/rad",
            "stiffness of the joint beside the muscles",
            0.0,
            30.0,
            N_("tare the empty plate, and move the relaxed ankle slowly over its whole range"),
            Added("joint", _from_rest),
        ),
        _M(
            "joint_torque",
            "Nm",
            "torque of the joint's own tissue at −15°",
            -10.0,
            10.0,
            N_("tare the empty plate"),
            Added("joint", _constant),
        ),
    ),
    "joint_damper": (
        _M(
            "joint_damping",
            "Nm·s/rad",
            "damping of the joint beside the muscles",
            0.0,
            5.0,
            N_("move the relaxed ankle at several speeds"),
            Added("joint", attrgetter("velocity")),
        ),
    ),
    "plate_give": (
        _M(
            "plate_give",
            "rad/Nm",
            "angle by which the foot plate gives way",
            0.0,
            4e-3,
            N_("strap the foot tighter, or measure the angle at the ankle"),
        ),
    ),
    "arm": _both(
        _GEOMETRY,
        ("arm_scale", "-", "logarithm of the moment arm over the assumed one", 0.4),
        ("arm_slope", "1/rad", "slope of the moment arm over the assumed one", 0.6),
        ("arm_bend", "1/rad²", "curvature of the moment arm over the assumed one", 0.8),
        ("path_scale", "-", "logarithm of the path's slope over the assumed one", 0.9),
    ),
    "path_bend": _both(
        _GEOMETRY,
        ("path_bend", "m/rad²", "curvature of the path beyond the assumed one, halved", 0.02),
    ),
    "length_zero": _both(
        _GEOMETRY, ("length_zero", "m", "muscle length at θ = 0 beyond the assumed one", 0.02)
    ),
    "curves": (
        *_both(
            _ANGLES,
            ("fl_short", "-", "logarithm of the force–length curve's width below l0", 1.5),
            ("fl_long", "-", "logarithm of the force–length curve's width above l0", 1.5),
        ),
        _M("fv_speed", "-", "logarithm of the greatest speed over the assumed", -1.0, 1.0, _ANGLES),
        _M("fv_curve", "-", "logarithm of the force–velocity curve's bend", -1.0, 1.0, _ANGLES),
        _M("fv_stretch", "-", "logarithm of the force gained in stretch", -1.0, 1.0, _ANGLES),
    ),
    "bridges": (
        _M(
            "bridge_stiffness",
            "-",
            "short-range stiffness, in forces per optimal length",
            0.0,
            200.0,
            _REVERSALS,
        ),
        _P(
            "bridge_reach",
            "-",
            "stretch at which bridges yield, as a part of the optimal length",
            "measurement",
            0.01,
            0.001,
            0.05,
            straight=True,
            advice=_REVERSALS,
        ),
    ),
    "emg_power": (_M("emg_power", "-", "power of force over EMG, less one", -0.7, 1.0, _LEVELS),),
    "release": (
        _M(
            "release",
            "s",
            "time by which force falls later than it rises",
            -0.05,
            0.15,
            N_("ask for bursts of effort that end as fast as they begin"),
        ),
    ),
    "emg_lag": (
        _M(
            "emg_lag",
            "s",
            "time constant by which envelopes lag the EMG",
            -0.05,
            0.1,
            N_("give the raw EMG, or envelopes of a filter that does not delay"),
        ),
    ),
    **{
        f"film_{at}": tuple(
            _M(
                f"film_{name}_{at}",
                unit,
                f"{meaning}, {muscle}",
                -limit,
                limit,
                N_("film several places of the muscle"),
            )
            for name, unit, meaning, limit in (
                (
                    "scale",
                    "-",
                    "filmed fascicle's changes of length over the muscle's, less one",
                    0.3,
                ),
                ("zero", "m", "filmed fascicle's length beyond the muscle's", 0.03),
            )
        )
        for at, muscle in zip(
            PLACES, (*MUSCLE_NAMES.values(), f"{MUSCLE_NAMES['ta']}, second place"), strict=True
        )
    },
}
#: Sources of uncertainty that other distributions bring, with parameters of their own.
ADDED: dict[str, UncertaintySource] = plugins("sources", UncertaintySource)
_OPTIONAL |= {s.nuisance.group: s.adds for s in ADDED.values() if s.nuisance}
OPTIONAL_PARAMETERS: tuple[Parameter, ...] = tuple(chain(*_OPTIONAL.values()))
#: The names of each group.
OPTIONAL: dict[str, tuple[str, ...]] = {
    group: tuple(p.name for p in members) for group, members in _OPTIONAL.items()
}
#: Groups that models of rigid tendons have not.
COMPLIANT_ALONE = ("curves", "bridges", "reflex_length", "reflex_force")
