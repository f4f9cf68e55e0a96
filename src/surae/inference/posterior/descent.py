"""What a descent knows of its surface beyond the normal equations, and how far a step goes.

Gauss–Newton leaves out of the Hessian what residuals bend, S = Σ r·∇²r. Where a recording's noise
stays in the residuals S is not small, and steps without it zigzag where they should end. Gradients
at both ends of a step say what S does along it (Dennis, Gay & Welsch 1981).
"""

import numpy as np
from scipy.linalg import solve_triangular

from surae.base.units import FloatArray

#: Part of its cost that a step has to gain for Gauss–Newton to be trusted alone (Fletcher & Xu
#: 1987, ε = 0.2): far from the mode S is another at every point.
FAR = 0.2
#: Least part of Gauss–Newton's curvature that S leaves in any direction: what it says of it is of
#: steps that were shorter.
_BENT = 0.5
#: Least and greatest part of a step that is tried where the whole one, or a part, rose.
_LEAST = 0.1
_MOST = 0.5


class Secant:
    """Learns S of q coordinates."""

    def __init__(self, q: int) -> None:
        self.S = np.zeros((q, q))

    def learn(self, step: FloatArray, turned: FloatArray, H: FloatArray) -> None:
        """Let H + S make of a step what the gradient turned by: the least change of S that does.

        `turned` is the gradient behind the step minus that before it, H what Gauss–Newton says at
        the better of both. S is made smaller first where it is too large along the step.
        """
        missed = turned - H @ step
        along = turned if turned @ step > 1e-8 * (step @ H @ step) else H @ step
        length = float(along @ step)
        if not (length > 0.0 and np.isfinite(missed).all()):
            return
        before = abs(float(step @ self.S @ step))
        if before > 0.0:
            self.S *= min(1.0, abs(float(step @ missed)) / before)
        away = missed - self.S @ step
        self.S += (np.outer(away, along) + np.outer(along, away)) / length
        self.S -= (step @ away) * np.outer(along, along) / length**2

    def added(self, A: FloatArray, scale: FloatArray) -> FloatArray:
        """A + S of scaled coordinates, in no direction less than half as bent as A."""
        if not self.S.any():
            return A
        try:
            L = np.linalg.cholesky(A)
        except np.linalg.LinAlgError:  # data without noise outweigh every prior to the last digit
            return A
        inner = solve_triangular(L, self.S / np.outer(scale, scale), lower=True)
        sizes, axes = np.linalg.eigh(solve_triangular(L, inner.T, lower=True))
        axes = L @ axes
        return np.asarray((axes * np.maximum(1.0 + sizes, _BENT)) @ axes.T)


def shorter(part: float, slope: float, rise: float) -> float:
    """The part of a step at which a parabola is least.

    It falls with `slope` at the beginning and has risen by `rise` at the part that was tried.
    """
    least = 0.5 * slope * part**2 / (rise + slope * part) if np.isfinite(rise) else 0.0
    return float(np.clip(least, _LEAST * part, _MOST * part))
