"""What is expected of foot, plate, sensor and nerve: hypotheses that the evidence weighs."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference.relaxed.regressors import SHARED, TAUS
from surae.settings import FitSettings

#: Weight of foot and plate at a lever of 0.15 m [Nm]: 1.9 ± 0.3 kg (thesis, bounds 1.2 to 3 kg).
_WEIGHT = (2.8, 0.45)
#: Inertia goes with the weight: lever over gravity [kg·m² / Nm], as equations (6) and (7), but for
#: so many kg·m² by which a foot is no point.
_LEVER = 0.15 / 9.81
_INERTIA = 0.008
#: The foot's weight hangs within so many degrees of where the angle says.
_PLUMB = 3.0
#: A plate whose weight nobody took off: Nm, and kg·m² beyond a foot's (the product's prior of it).
_PLATE = (5.0, 0.03)
#: Data that add less than this to a foot's precision say nothing of its inertia.
_UNTOLD = 0.05
#: Viscosity [Nm·s/rad], friction [Nm], the sensor's zero and its drift [Nm, Nm/min]; what a piece
#: of rest has left of the past [Nm], fast and slow.
_VISCOSITY = 0.3
_FRICTION = 0.3
_ZERO = 30.0
_DRIFT = 0.5
_PAST = (0.15, 0.1)
#: Zeros of trials of one mounting differ by so many Nm, or by the sensor's whole zero.
_SAME_ZERO = 0.3
#: Torque of a reflex per velocity [Nm·s/rad], where there is one and where there is none.
_REFLEX = 2.0
_NO_REFLEX = 0.02
#: Torque at the largest EMG that a leg has shown, of calf and tibialis [Nm]: what little a muscle
#: works at rest goes with its EMG. Of efforts by halves, as laboratories ask for, it is larger.
_TONE = (60.0, 20.0)
#: Prior of relaxation: ln γ, and its standard deviation (a third of the elastic torque relaxes,
#: within a factor of two, over three times).
GAMMA = (math.log(0.12), 0.7)
#: How unsure the ankle's zero is where nobody measured it [deg], as in a fit (Konor et al. 2012: a
#: goniometer's standard error is 1.8 to 2.8°).
_ANGLE_ZERO = 2.5
#: Prior probabilities: an unstated plate, a reflex, zeros of trials apart.
ODDS_PLATE = 0.03
ODDS_REFLEX = 0.1
_ODDS_APART = 0.5


@dataclass(frozen=True, slots=True)
class Laboratory:
    """What is known of the laboratory, as far as a resting leg asks."""

    #: `zero_deg`, `zero_sd`: angle of the ankle where the device shows 0 [deg].
    zero_deg: float = 0.0
    zero_sd: float = _ANGLE_ZERO
    plate_known: bool = False  #: Whether the plate was tared, or taken off.
    foot_rad: float = 0.0  #: Angle of the foot to the horizontal at 0 rad, equation (7).

    @classmethod
    def of(cls, settings: FitSettings) -> "Laboratory":
        """What settings of a fit say, and a session's knowledge in them."""
        stated = settings.stated_zero
        zero = math.degrees(settings.fixed.get("angle_zero", 0.0)) if stated is None else stated[0]
        known = settings.knowledge is not None and settings.knowledge.plate is not None
        return cls(zero, settings.zero_sd, known, settings.options.theta_foot)


#: A laboratory of which nothing is known.
UNKNOWN = Laboratory()


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """One reading of what is no tissue, with its prior probability."""

    plate: bool  #: Whether a plate hangs on the sensor that nobody took off.
    reflex: bool
    apart: bool  #: Whether each trial has a zero of its own.
    odds: float
    foot_rad: float = 0.0  #: As of `Laboratory`.


def hypotheses(laboratory: Laboratory, trials: int) -> tuple[Hypothesis, ...]:
    """All that is weighed; odds sum to one."""
    untold = 0.0 if laboratory.plate_known else ODDS_PLATE
    plates = {False: 1.0 - untold, True: untold}
    reflexes = {False: 1.0 - ODDS_REFLEX, True: ODDS_REFLEX}
    zeros = {False: 1.0 - _ODDS_APART, True: _ODDS_APART} if trials > 1 else {True: 1.0}
    return tuple(
        Hypothesis(plate, reflex, apart, a * b * c, laboratory.foot_rad)
        for plate, a in plates.items()
        for reflex, b in reflexes.items()
        for apart, c in zeros.items()
        if a > 0.0
    )


def plate_by_inertia(mean: float, variance: float) -> float:
    """Logarithm of the Bayes factor of a plate against a foot alone, by the inertia only.

    What the curve's shape says of a weight it says through what curves are expected, so that it
    is not asked. Mean [kg·m²] and variance are the posterior's with a foot's prior, whose part is
    taken out again:  N(x; m₁, s₁² + v)/N(x; m₀, s₀² + v), x ± √v what the data alone say.
    """
    foot = _WEIGHT[0] * _LEVER
    known = _INERTIA**2 + (_LEVER * _WEIGHT[1]) ** 2
    precision = 1.0 / variance - 1.0 / known
    if precision <= _UNTOLD / known:
        return 0.0
    v = 1.0 / precision
    x = v * (mean / variance - foot / known)
    if x < foot:
        return 0.0  # a plate takes no inertia away
    logs = [
        -0.5 * (x - at) ** 2 / (spread + v) - 0.5 * math.log(spread + v)
        for at, spread in ((foot + _PLATE[1], _PLATE[1] ** 2), (foot, known))
    ]
    return logs[0] - logs[1]


@dataclass(frozen=True, slots=True)
class Gaussians:
    """Independent priors of all unknowns: weights of the curve, ln γ, context; shapes (k,)."""

    mean: FloatArray
    #: Standard deviations; the inertia's is that beside the weight's, of which `factor` is a part.
    precision: FloatArray  #: Inverse of the covariance, shape (k, k).
    log_det: float  #: Logarithm of the covariance's determinant.


def gaussians(
    curve: FloatArray, names: Sequence[str], hypothesis: Hypothesis, offset: float
) -> Gaussians:
    """Priors under a hypothesis.

    Parameters
    ----------
    curve : ndarray
        Standard deviations of the curve's weights [Nm], shape (p,).
    names : sequence of str
        Columns of the context.
    hypothesis : Hypothesis
        What foot, sensor and nerve are taken for.
    offset : float
        Mean torque [Nm], about which the zero may lie.
    """
    sds = _context(names, hypothesis)
    inner = len(curve) + len(TAUS)
    mean = np.concatenate([np.zeros(len(curve)), np.full(len(TAUS), GAMMA[0]), np.zeros(len(sds))])
    at = {name: inner + names.index(name) for name in SHARED}
    mean[at["weight"]] = _WEIGHT[0] * math.cos(hypothesis.foot_rad)
    mean[at["tilt"]] = _WEIGHT[0] * math.sin(hypothesis.foot_rad)
    mean[at["inertia"]] = _WEIGHT[0] * _LEVER + hypothesis.plate * _PLATE[1]
    mean[at["constant"]] = offset - _WEIGHT[0]
    spread = np.concatenate([curve, np.full(len(TAUS), GAMMA[1]), sds])
    precision = np.diag(spread**-2)
    # a heavier foot is a more inert one: inertia − lever·weight is what its spread is of
    along = np.zeros(len(spread))
    along[at["inertia"]] = 1.0
    along[at["weight"]] = 0.0 if hypothesis.plate else -_LEVER
    precision[at["inertia"], at["inertia"]] = 0.0
    precision += np.outer(along, along) / spread[at["inertia"]] ** 2
    return Gaussians(mean, precision, 2.0 * float(np.log(spread).sum()))


def _context(names: Sequence[str], hypothesis: Hypothesis) -> FloatArray:
    """Standard deviations of the context's columns."""
    plate = hypothesis.plate
    reflex = _REFLEX if hypothesis.reflex else _NO_REFLEX
    fixed = {
        "weight": math.hypot(_WEIGHT[1], _PLATE[0]) if plate else _WEIGHT[1],
        "tilt": _PLATE[0] if plate else math.radians(_PLUMB) * _WEIGHT[0],
        "viscosity": _VISCOSITY,
        "friction": _FRICTION,
        "inertia": math.hypot(_INERTIA, _PLATE[1]) if plate else _INERTIA,
        "reflex": reflex,
        "reflex_long": reflex,
        "constant": _ZERO,
        "tone_calf": _TONE[0],
        "tone_tibialis": _TONE[1],
    }
    families = {
        "zero": _ZERO if hypothesis.apart else _SAME_ZERO,
        "drift": _DRIFT,
        "step": STEP,
        "slip": SLIP,
    }
    sds = []
    for name in names:
        family, *rest = name.split("_")
        if name in fixed:
            sds.append(fixed[name])
        elif family == "past":
            sds.append(_PAST[0] if float(rest[-1]) < 2.0 else _PAST[1])
        else:
            sds.append(families[family])
    return np.array(sds)


#: A step of the torque's zero in mid-trial [Nm], and of the foot on its plate [deg].
STEP = 3.0
SLIP = 4.0
