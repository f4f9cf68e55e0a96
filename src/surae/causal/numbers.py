"""The numbers that a step needs, made once of a fit's model, options and parameters."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import listed
from surae.base.names import CHOICES
from surae.base.units import FloatArray
from surae.causal.layout import NUMBERS_RECORD, PATH, RELAXING
from surae.model import ModelSpec
from surae.model.activation import ActivationFilter, IntArray
from surae.model.compliant_stage import GAMMA
from surae.model.geometry import paths
from surae.model.geometry_table import GeometryTable
from surae.model.movement import OWN_PATH
from surae.model.options import ModelOptions
from surae.model.parameters import CROSSTALK, OPTIONAL, OPTIONAL_PARAMETERS
from surae.model.passive import relaxation_step
from surae.recording import MUSCLES
from surae.signals import ModelInputs, Preparation, one_pass, smooth_effort_s

#: Models whose equations a step has.
SUPPORTED = ("muscle", "muscle-tendon", "muscle-tendon-strain", "muscle-tendon-toe")
#: What a step has not: it would need the measured torque.
LEFT_OUT = ("plate_give",)
#: Time over which the angle is smoothed [s]: its polynomial of second degree forgets with it.
ANGLE_S = 0.008
_GROUPS = ("tri", "tib")
#: Own parameters of a group, in the order of `surae.model.compliant`.
_OWN = ("k", "x0", "l0", "", "", "dlt", "pt", "kt", "fmax")
_CURVES = ("fl_short", "fl_long", "fv_speed", "fv_curve", "fv_stretch")
#: How far a path goes where it is no table [rad].
_ANYWHERE = 1e6


@dataclass(frozen=True, slots=True)
class Numbers:
    """What stays as it is from step to step."""

    record: "np.ndarray[tuple[int], np.dtype[np.void]]"  #: Of `NUMBERS_RECORD`, shape (1,).
    path: FloatArray  #: Cubics of lengths and arms over the angle, shape (k, 17).
    curve: FloatArray  #: Angles [deg] and torques [Nm] of a tissue's curve, shape (2, q).
    relaxing: FloatArray  #: Shares of it that relax, and what stays of each, shape (2, r).
    delay: int  #: Samples of a drive that are remembered.

    def state(self) -> tuple["np.ndarray[tuple[int], np.dtype[np.void]]", FloatArray]:
        """What a step remembers, before the first one, and the drives that it delays."""
        from surae.causal.layout import STATE_RECORD

        return np.zeros(1, STATE_RECORD), np.zeros((4, self.delay))


def check_supported(spec: ModelSpec, options: ModelOptions) -> None:
    """Refuse a model that a step has no equations of.

    Raises
    ------
    InputError
        It is another model, integrator or geometry.
    """
    known = {name for group in OPTIONAL.values() for name in group}
    builtin = {p.name for p in OPTIONAL_PARAMETERS} & known
    if spec.name not in SUPPORTED or set(spec.optional) - builtin:
        raise InputError(
            f"{spec.name} has no causal predictor; fit {listed(('auto', *SUPPORTED), 'or')}"
        )
    if options.integrator != CHOICES["integrator"][0]:
        raise InputError(
            f"integrator {options.integrator} has no causal predictor; fit with the implicit one"
        )
    if isinstance(options.geometry, GeometryTable) and options.geometry.second:
        raise InputError(
            f"{options.geometry.name}: a geometry over a second angle has no causal predictor; "
            "give its table with that joint held still"
        )


def numbers_of(
    spec: ModelSpec,
    options: ModelOptions,
    values: Mapping[str, float],
    like: ModelInputs,
    rate_hz: float,
    emg: Preparation | None,
) -> Numbers:
    """The numbers of a model at these values, for signals `like` those of the fit.

    Parameters
    ----------
    spec, options, values
        The model, how it is read, and its parameters.
    like : ModelInputs
        A recording of the fit: its EMG's unit, which muscles have one, and how envelopes came.
    rate_hz : float
        Of the steps [Hz].
    emg : Preparation or None
        How raw EMG is filtered; None where it comes as envelopes.

    Returns
    -------
    Numbers
        All but the doubt of the torque.
    """
    check_supported(spec, options)
    by_name = dict(zip(spec.names, map(float, spec.vector(values, options)), strict=True))
    by_name |= dict.fromkeys(LEFT_OUT, 0.0)

    def value(name: str) -> float:
        return by_name.get(name, 0.0)

    dt = 1.0 / rate_hz
    record = np.zeros(1, NUMBERS_RECORD)
    n = record[0]
    n["dt"] = dt
    n["angle_gains"] = angle_gains(dt)
    _filters(n, like, rate_hz, emg)
    n["effort_gain"] = 1.0 - math.exp(-dt / (_STAGE * smooth_effort_s()))
    _envelopes(n, spec, options, by_name, like)
    n["weights"] = [value(name) for name in spec.weights]
    delay = _delays(n, spec, by_name, dt)
    for g, group in enumerate(_GROUPS):
        laws = (f"{law}_{group}" for law in ("reflex", "reflex_length", "reflex_force"))
        n["reflexes"][g] = [value(law) for law in laws]
        of_path = [f"{of}_{group}" for of in OWN_PATH]
        n["has_own_path"][g] = any(name in by_name for name in of_path)
        n["own_path"][g] = [value(name) for name in of_path]
    n["angle_zero"] = value("angle_zero")
    n["has_axis"] = "axis_forward" in by_name
    n["forward"], n["up"] = value("axis_forward"), value("axis_up")
    n["strap"] = options.anatomy.distance
    n["theta_foot"] = options.theta_foot
    n["mass"] = by_name["m"]
    n["zero"] = value("torque_zero")
    n["plate"] = [value(f"plate_{of}") for of in ("inertia", "cos", "sin")]
    n["joint"] = [value(f"joint_{of}") for of in ("stiffness", "torque", "damping")]
    _muscles(n, spec, options, by_name)
    curve, relaxing = _tissue(options, dt)
    return Numbers(record, _paths(n, options), curve, relaxing, delay)


#: Time constant of each of three stages in a row that leave as much of noise as a Gaussian of unit
#: width does: both have an effective length of 2·√π, a stage a third of 16 times its own.
_STAGE = 2.0 * math.sqrt(math.pi) / (16.0 / 3.0)


def angle_gains(dt: float) -> tuple[float, float, float]:
    """Gains of the angle, its speed and its acceleration on what is measured beyond expectation.

    A polynomial of second degree that forgets by exp(−dt/τ) a sample (critically damped g-h-k
    filter, Brookner 1998, Tracking and Kalman filtering made easy, 2.6): of a movement whose
    acceleration stays it has no delay.

    Parameters
    ----------
    dt : float
        Sample time [s].

    Returns
    -------
    tuple of float
        Of the angle [-], the speed [1/s] and the acceleration [1/s²].
    """
    stays = math.exp(-dt / ANGLE_S)
    less = 1.0 - stays
    return 1.0 - stays**3, 1.5 * less**2 * (1.0 + stays) / dt, less**3 / dt**2


def _filters(n: np.void, like: ModelInputs, rate_hz: float, emg: Preparation | None) -> None:
    """How EMG becomes an envelope in the fit's unit."""
    reference = like.emg_reference
    for at, muscle in enumerate(MUSCLES):
        level = 1.0 if reference is None else reference.values[at] or math.inf
        n["emg_scale"][at] = 0.0 if muscle in like.missing_emg else 1.0 / level
    if emg is None:
        return
    n["raw"] = 1
    for name, kind, passes in (("high", "highpass", 2), ("low", "lowpass", 1)):
        cutoff = getattr(emg, f"emg_{kind}_hz")
        if cutoff is not None:
            order = getattr(emg, f"emg_{kind}_order")
            once = one_pass(kind, rate_hz, cutoff, order)  # type: ignore[arg-type]
            sections = np.concatenate([once] * passes)
            n[name][: len(sections)] = sections
            n[f"{name}s"] = len(sections)


def _envelopes(
    n: np.void,
    spec: ModelSpec,
    options: ModelOptions,
    by_name: Mapping[str, float],
    like: ModelInputs,
) -> None:
    """What an electrode's envelope says of its muscle."""
    present = np.array([muscle not in like.missing_emg for muscle in MUSCLES], dtype=float)
    n["lag"] = by_name.get("emg_lag", 0.0)
    n["rest"] = present * [by_name.get(name, 0.0) for name in OPTIONAL["emg_rest"]]
    mixing = np.eye(4)
    for (hears, of), name in CROSSTALK.items():
        mixing[hears, of] = present[hears] * by_name.get(name, 0.0)
    if CROSSTALK[0, 1] in spec.names:
        n["unmix"] = 2 if like.own_envelopes else 1
    n["inverse"] = np.linalg.inv(mixing**2 if n["unmix"] == 2 else mixing)
    n["release"] = by_name.get("release", 0.0)
    n["curved"] = "emg_shape" in spec.names or "emg_power" in spec.names
    n["shape"] = by_name.get("emg_shape", 0.0)
    n["power"] = by_name.get("emg_power", 0.0)
    levels = np.ones(4)
    if n["curved"] and like.emg_unit != "1" and options.emg_ref is not None:
        levels = np.where(present > 0, options.emg_ref, 1.0)
    n["reference"] = levels


def _delays(n: np.void, spec: ModelSpec, by_name: Mapping[str, float], dt: float) -> int:
    """The activation filter and its delays; how many samples are remembered of a drive."""
    lags = ((1.0 - GAMMA) * dt, 0.0)
    filters = ActivationFilter(f0=by_name["f0"], beta=by_name["beta"], dt=dt, lags=lags)
    off = next(p.start for p in OPTIONAL_PARAMETERS if p.name == "reflex_delay")
    late = ("emd" in spec.names, True)
    delays = (by_name.get("emd", 0.0), by_name.get("reflex_delay", off))
    for drive, (is_late, delay) in enumerate(zip(late, delays, strict=True)):
        steps, back = filters.instants(delay)
        n["late"][drive] = is_late
        n["back"][drive] = back
        n["part"][drive] = steps[:, 1, 0, 0]
    steps, _ = filters.instants(0.0)
    n["whole"] = steps[0, 0, 0]
    n["held"] = steps[:, 1, 0, 0]
    backs: IntArray = n["back"]
    return int(backs.max()) + 2


def _muscles(
    n: np.void, spec: ModelSpec, options: ModelOptions, by_name: Mapping[str, float]
) -> None:
    """Both groups' own parameters."""
    n["compliant"] = spec.parent is not None
    n["vmax_factor"] = options.vmax_factor
    in_metres = options.tendon_strain == CHOICES["tendon_strain"][0]
    n["tendon_unit"] = (1.0, 1.0) if in_metres else options.anatomy.slack
    for g, group in enumerate(_GROUPS):
        parameters = [by_name.get(f"{of}_{group}", 0.0) for of in _OWN]
        parameters[3], parameters[4] = by_name["tau_rel"], by_name["k_rel"]
        shapes = [by_name.get(f"{of}_{group}", by_name.get(of, 0.0)) for of in _CURVES]
        bridges = [by_name.get(f"bridge_{of}", 0.0) for of in ("stiffness", "reach")]
        n["groups"][g] = [*parameters, *shapes, *bridges]
    n["relax"] = relaxation_step(by_name["tau_rel"], by_name["k_rel"], n["dt"])[:3]


def _paths(n: np.void, options: ModelOptions) -> FloatArray:
    """Lengths and arms of both groups over the angle, as cubics from knot to knot."""
    at = np.array([-1.0, 0.0, 1.0])
    geometry = options.geometry
    n["at_rest"] = [
        p.length[0] for p in paths(angle=np.zeros(1), velocity=np.zeros(1), options=options)
    ]
    if not isinstance(geometry, GeometryTable):  # of second degree throughout
        n["range"] = (-_ANYWHERE, _ANYWHERE)
        row = [0.0]
        for path in paths(angle=at, velocity=np.zeros(3), options=options):
            for low, middle, high in (path.length, path.arm):
                bent = 0.5 * (high + low) - middle
                row += [0.0, bent, 0.5 * (high - low), middle]
        return np.array([row])
    from scipy.interpolate import CubicSpline

    n["range"] = geometry.range
    knots = np.array(geometry.angle)
    table = np.zeros((len(knots) - 1, PATH))
    table[:, 0] = knots[:-1]
    for g in range(2):
        length, arm = (CubicSpline(knots, row[g]) for row in (geometry.length, geometry.arm))
        first = 1 + 8 * g
        table[:, first : first + 4] = length.c.T
        table[:, first + 4 : first + 8] = arm.c.T
        table[:, first + 3] += n["at_rest"][g] - float(geometry.at(g, np.zeros(1))[0][0])
    return table


def _tissue(options: ModelOptions, dt: float) -> tuple[FloatArray, FloatArray]:
    """A tissue's curve, and how it relaxes."""
    tissue = options.tissue
    if tissue is None:
        return np.zeros((2, 0)), np.zeros((2, 0))
    if len(tissue.shares) > RELAXING:
        raise InputError(f"a tissue’s curve of more than {RELAXING} times has no causal predictor")
    stays = [math.exp(-dt / tau) for tau in tissue.seconds]
    return np.array([tissue.degrees, tissue.torque]), np.array([tissue.shares, stays]).reshape(
        2, -1
    )
