"""Where in its length–velocity plane a motion takes the triceps surae (thesis Figures 3 and 38)."""

from dataclasses import dataclass

from surae.frozen import read_only
from surae.model import ModelOptions
from surae.protocol.coverage import Coverage, coverage
from surae.protocol.protocol import Trajectory
from surae.units import FloatArray

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


def triceps_path(
    trajectory: Trajectory, *, l0: float = L0_TRI, options: ModelOptions | None = None
) -> TricepsPath:
    """Length and velocity of the triceps by the models' geometry, equation (9).

    Parameters
    ----------
    trajectory : Trajectory
        The motion.
    l0 : float
        The subject's optimal length [m].
    options : ModelOptions, optional
        Which geometry.
    """
    from surae.model.geometry import paths  # imports the compiler

    triceps, _ = paths(
        angle=trajectory.angle, velocity=trajectory.velocity, options=options or ModelOptions()
    )
    length, velocity = triceps.length / l0, triceps.speed / l0
    return TricepsPath(l0, read_only(length), read_only(velocity), coverage(length, velocity))
