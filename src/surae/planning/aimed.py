"""What a protocol tells of parameters and measures by name, and of changes in them."""

import numpy as np

from surae.base.units import FloatArray
from surae.planning.information import SINGULAR, information, prior_precision
from surae.planning.legs import Legs
from surae.planning.search import CHANGE, MEAN, WORST, make_aim
from surae.protocol import Trajectory

#: What is expected of a protocol beside parameters: measures of the relaxed ankle.
MEASURES = (
    "torque_rise",
    "end_stiffness",
    "end_torque",
    "passive_stiffness@0deg",
    "passive_stiffness@10deg",
    "passive_torque@10deg",
)
#: Part of a direction's square from which on it counts that nothing is known of it.
_MISSED = 1e-6
#: How parameters begin that two visits of a leg share, whatever changed of its tissue or strength:
#: paths, curves, tendons' toes, delay, reflex, joint, cross-bridges, and how force follows EMG.
_SHARED = (
    *("arm_", "path_", "length_", "fl_", "fv_", "pt_", "emd", "reflex_", "joint_", "bridge_"),
    *("release", "emg_power", "emg_shape"),
)
#: Standard errors of a difference that are shown in four of five cases, at a level of 5 %.
SHOWS = 1.96 + 0.84


def aimed_errors(
    trajectory: Trajectory, legs: Legs, noise: float, aim: str, known: FloatArray | None
) -> dict[str, float | None]:
    """Relative standard errors of what is named, root mean square over the legs.

    Parameters
    ----------
    trajectory : Trajectory
        The protocol.
    legs : Legs
        Whose.
    noise : float
        Of one sample of the torque [Nm].
    aim : str
        As of `make_aim`; of ``"worst"`` and ``"mean"`` there is nothing by name.
    known : ndarray or None
        Information without the trial, shape (p, p); None: priors.

    Returns
    -------
    dict
        By name; None where some leg's is not determined.
    """
    if aim in (WORST, MEAN):
        return {}
    degrees = np.degrees(trajectory.angle)
    moved = float(np.quantile(degrees, 0.01)), float(np.quantile(degrees, 0.99))
    wanted = make_aim(aim, legs, moved)
    known_of = information(trajectory, legs, noise)
    precision = known_of.matrices + (
        prior_precision(known_of.names, legs) if known is None else known
    )
    variance = np.array(
        [
            _along(matrix, slopes, values)
            for matrix, slopes, values in zip(precision, wanted.slopes, legs.estimated, strict=True)
        ]
    )
    if wanted.anew is not None and wanted.is_change.any():
        # what both visits share is wrong alike and cancels: as if it were known
        apart_names = [i for i, name in enumerate(known_of.names) if not name.startswith(_SHARED)]
        apart = np.array(
            [
                2.0
                * _along(
                    matrix[np.ix_(apart_names, apart_names)],
                    slopes[:, apart_names],
                    values[apart_names],
                )
                for matrix, slopes, values in zip(
                    precision, wanted.slopes, legs.estimated, strict=True
                )
            ]
        )
        variance = np.where(wanted.is_change > 0.0, apart + wanted.anew**2, variance)
    rms = np.sqrt(variance.mean(axis=0))
    return {
        name: float(value) if np.isfinite(value) else None
        for name, value in zip(wanted.wanted, rms, strict=True)
    }


def _along(precision: FloatArray, slopes: FloatArray, values: FloatArray) -> FloatArray:
    """Variance along each row of `slopes`, shape (n, p); infinite where that is not determined."""
    if not np.isfinite(precision).all():
        return np.full(len(slopes), np.inf)
    scale = np.sqrt(np.maximum(np.diagonal(precision), 0.0))
    scale = np.where(scale > 0.0, scale, 1.0 / np.maximum(np.abs(values), 1e-12))
    level, axes = np.linalg.eigh(precision / np.outer(scale, scale))
    parts = ((slopes / scale) @ axes) ** 2
    nothing = level <= SINGULAR * level[-1]
    variance = (parts[:, ~nothing] / level[~nothing]).sum(axis=1)
    missed = parts[:, nothing].sum(axis=1) > _MISSED * parts.sum(axis=1)
    return np.where(missed, np.inf, variance)


def detectable(
    trajectory: Trajectory, legs: Legs, noise: float, known: FloatArray | None
) -> dict[str, tuple[float | None, float | None]]:
    """Relative standard error of every measure, and the change that two visits would show.

    Returns
    -------
    dict
        By measure, both as parts of the value; None where not determined. What would be shown is
        so in four of five cases: 2.8 standard errors of the difference, the foot mounted anew.
    """
    names = ",".join([*MEASURES, *(CHANGE + name for name in MEASURES)])
    errors = aimed_errors(trajectory, legs, noise, names, known)

    def shown(name: str) -> float | None:
        error = errors[CHANGE + name]
        return None if error is None else SHOWS * error

    return {name: (errors[name], shown(name)) for name in MEASURES}
