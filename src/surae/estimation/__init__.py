"""Parameters from recordings: problem, solver, variable projection, multi-start."""

from surae.estimation.fit import STARTS, fit_problem
from surae.estimation.problem import FitProblem, Prior, make_problem
from surae.estimation.result import FitResult, Start

__all__ = ["STARTS", "FitProblem", "FitResult", "Prior", "Start", "fit_problem", "make_problem"]
