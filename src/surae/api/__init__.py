"""The public functions: what the command line and Python code all call."""

from surae.api.comparison import compare
from surae.api.fitted import Fit
from surae.api.fitting import Priors, fit, fit_inputs, load
from surae.api.intervals import bootstrap, emg_bias, posterior, profile
from surae.api.quality import check
from surae.api.recordings import AnyRecording, normalise
from surae.api.simulation import simulate, simulate_parts, simulate_tendon
from surae.api.validation import leave_one_out, validate
from surae.assessment.comparison.compare import compare_models as compare_inputs

__all__ = [
    "AnyRecording",
    "Fit",
    "Priors",
    "bootstrap",
    "check",
    "compare",
    "compare_inputs",
    "emg_bias",
    "fit",
    "fit_inputs",
    "leave_one_out",
    "load",
    "normalise",
    "posterior",
    "profile",
    "simulate",
    "simulate_parts",
    "simulate_tendon",
    "validate",
]
