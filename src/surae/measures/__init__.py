"""What a clinician asks of a fit: measures in Nm and degrees, changes, norms.

The package itself may be called: ``surae.measures(fit)`` is ``fit.measures()``.
"""

from surae.measures import package as package
from surae.measures.compute import measures, measures_of_values
from surae.measures.measure import Measure, Measures
from surae.measures.points import ANGLES
from surae.measures.table import DEFINITIONS, Definition

__all__ = [
    "ANGLES",
    "DEFINITIONS",
    "Definition",
    "Measure",
    "Measures",
    "measures",
    "measures_of_values",
]
