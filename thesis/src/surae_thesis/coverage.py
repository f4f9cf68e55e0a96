"""Where a motion goes in the muscle's length–velocity plane, and how much of it (Figures 3, 38)."""

from dataclasses import dataclass

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.protocol import Trajectory

#: The axes of the thesis's figures, in cells of 0.05 l0 by 0.1 l0/s.
LENGTH_EDGES = np.linspace(0.3, 1.2, 19)
VELOCITY_EDGES = np.linspace(-5.0, 5.0, 101)


@dataclass(frozen=True, slots=True)
class Coverage:
    """The part of the length–velocity plane where a muscle has been; arrays read-only."""

    share: float  #: Share of the cells that were visited, 0…1.
    #: Share of the time spent in each cell; 0 where it never was, shape (n_velocity, n_length).
    time_share: FloatArray
    outside: float  #: Share of the time spent outside the grid.
    length_edges: FloatArray  #: Borders of the cells [L/l0], shape (n_length + 1,).
    velocity_edges: FloatArray  #: Borders of the cells [l0/s], shape (n_velocity + 1,).


def coverage(
    length: FloatArray,
    velocity: FloatArray,
    *,
    length_edges: FloatArray = LENGTH_EDGES,
    velocity_edges: FloatArray = VELOCITY_EDGES,
) -> Coverage:
    """Share of the length–velocity plane that a path through it visits.

    The path between two samples counts as a straight line in steps of half a cell at most, so that
    a fast movement is not under-counted at a low sampling rate.

    Parameters
    ----------
    length, velocity : ndarray, shape (n,)
        Normalised muscle length [L/l0] and velocity [l0/s], uniformly sampled.
    length_edges, velocity_edges : ndarray
        Borders of equal cells, increasing.

    Raises
    ------
    InputError
        The arrays differ in length, are too short or aren't finite.
    """
    length = np.asarray(length, dtype=float)
    velocity = np.asarray(velocity, dtype=float)
    if length.ndim != 1 or length.shape != velocity.shape or len(length) < 2:
        raise InputError(
            f"coverage: length {length.shape} and velocity {velocity.shape} must be "
            "one-dimensional, equally long and of two samples or more"
        )
    if not (np.isfinite(length).all() and np.isfinite(velocity).all()):
        raise InputError("coverage: length and velocity must be finite; remove NaN and infinity")
    cell = np.array([np.diff(length_edges).min(), np.diff(velocity_edges).min()])
    step = np.abs(np.diff(np.column_stack([length, velocity]), axis=0)).max(axis=0)
    parts = int(np.ceil((2 * step / cell).max())) or 1
    at = np.arange(len(length))
    between = np.arange((len(length) - 1) * parts + 1) / parts
    counts, _, _ = np.histogram2d(
        np.interp(between, at, velocity),
        np.interp(between, at, length),
        bins=[velocity_edges, length_edges],
    )
    time_share = counts / len(between)
    return Coverage(
        share=float((counts > 0).mean()),
        time_share=read_only(time_share),
        outside=max(0.0, 1.0 - float(time_share.sum())),
        length_edges=read_only(length_edges),
        velocity_edges=read_only(velocity_edges),
    )


#: Optimal length of the triceps [m] for which the ramp and hold of 0.9 rad/s reaches 0.35 l0/s, as
#: in Figure 3; also the middle of healthy subjects.
L0_TRI = 0.045


@dataclass(frozen=True, slots=True)
class TricepsPath:
    """The triceps surae during a motion, its tendon rigid; arrays read-only.

    Attributes
    ----------
    l0 : float
        Optimal length that both are divided by [m].
    length : ndarray, shape (n,)
        Muscle length [L/l0].
    velocity : ndarray, shape (n,)
        Lengthening velocity [l0/s].
    coverage : Coverage
        How much of the plane they visit.
    """

    l0: float
    length: FloatArray
    velocity: FloatArray
    coverage: Coverage


def triceps_path(trajectory: Trajectory, *, l0: float = L0_TRI) -> TricepsPath:
    """Length and velocity of the triceps by equation (9); `l0` is its optimal length [m]."""
    arm = 0.0480 - 0.0104 * trajectory.angle  # equation (4) [m]
    length = (0.118 - 1.67 * arm) / l0
    velocity = 1.67 * 0.0104 * trajectory.velocity / l0
    return TricepsPath(l0, read_only(length), read_only(velocity), coverage(length, velocity))
