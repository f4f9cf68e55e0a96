"""Recordings to model inputs: filters, resampling, derivatives."""

from surae.signals.estimable import check_estimable
from surae.signals.inputs import ModelInputs
from surae.signals.prepare import prepare
from surae.signals.settings import Preparation
from surae.signals.thinning import thinned, thinning_factor
from surae.signals.weighting import Weighting, weighted

__all__ = [
    "ModelInputs",
    "Preparation",
    "Weighting",
    "check_estimable",
    "prepare",
    "thinned",
    "thinning_factor",
    "weighted",
]
