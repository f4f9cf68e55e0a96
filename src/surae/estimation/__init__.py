"""Parameters from recordings: problem, solver, variable projection, multi-start."""

from surae.estimation.fit import fit_problem
from surae.estimation.least_squares import minimise
from surae.estimation.outliers import LOSSES, fit_robust
from surae.estimation.population import Prior
from surae.estimation.problem import FitProblem, make_problem
from surae.estimation.result import Candidate, Family, FitResult, Outliers, Start
from surae.estimation.solve import solve
from surae.settings import STARTS, FitSettings

__all__ = [
    "LOSSES",
    "STARTS",
    "Candidate",
    "Family",
    "FitProblem",
    "FitResult",
    "FitSettings",
    "Outliers",
    "Prior",
    "Start",
    "fit_problem",
    "fit_robust",
    "make_problem",
    "minimise",
    "solve",
]
