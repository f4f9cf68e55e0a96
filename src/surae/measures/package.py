"""The package of measures as ``surae.measures``, which may be called with a fit."""

import sys
from collections.abc import Sequence
from types import ModuleType
from typing import Any, cast

from surae.measures.measure import Measures
from surae.measures.points import ANGLES


class _Package(ModuleType):
    """A package that may be called like a function."""

    def __call__(self, fit: Any, angles: Sequence[float] = ANGLES) -> Measures:
        """Torque, stiffness and more of a fit, in a clinician's units.

        Parameters
        ----------
        fit : Fit
            As `surae.fit` and `surae.load` return it.
        angles : sequence of float
            Where torque and stiffness are given [deg], dorsiflexion positive.

        Returns
        -------
        Measures
            By name, e.g. ``"passive_stiffness@10deg"``.

        Examples
        --------
        >>> surae.measures(surae.load("fit.json"))["passive_stiffness@10deg"].ci95
        """
        answer: Measures = fit.measures(angles)
        return answer


# Python puts an imported package in the place of a function of its name.
sys.modules["surae.measures"].__class__ = _Package
measures = cast(_Package, sys.modules["surae.measures"])
