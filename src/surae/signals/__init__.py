"""Recordings to model inputs: filters, resampling, derivatives."""

from surae.signals.filters import one_pass
from surae.signals.inputs import (
    EmgReference,
    Film,
    ModelInputs,
    SmoothEffort,
    check_estimable,
    inputs_as_given,
    same_signals,
)
from surae.signals.lead_in import led_in
from surae.signals.normalise import (
    emg_levels,
    emg_reference,
    emg_sizes,
    noise_alone,
    normalise,
    normalised,
    quiet_levels,
    smooth_effort,
    smooth_effort_s,
    steady_emg,
)
from surae.signals.prepare import prepare
from surae.signals.resample import sampled, thinned, thinning_factor
from surae.signals.settings import Preparation
from surae.signals.weighting import Weighting, settled, weighted

__all__ = [
    "EmgReference",
    "Film",
    "ModelInputs",
    "Preparation",
    "SmoothEffort",
    "Weighting",
    "check_estimable",
    "emg_levels",
    "emg_reference",
    "emg_sizes",
    "inputs_as_given",
    "led_in",
    "noise_alone",
    "normalise",
    "normalised",
    "one_pass",
    "prepare",
    "quiet_levels",
    "same_signals",
    "sampled",
    "settled",
    "smooth_effort",
    "smooth_effort_s",
    "steady_emg",
    "thinned",
    "thinning_factor",
    "weighted",
]
