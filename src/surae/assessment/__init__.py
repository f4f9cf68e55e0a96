"""What a fit is worth: goodness, uncertainty, identifiability, validation."""

from surae.assessment.assess import (
    Assessment,
    Interval,
    ParameterEstimate,
    RecordingQuality,
    assess,
)
from surae.assessment.comparison import Comparison, Finding
from surae.assessment.quality import autocorrelation, rmse, vaf
from surae.assessment.robust import RobustCovariance
from surae.assessment.snsem import Baseline
from surae.assessment.uncertainty import Covariance, ipde
from surae.assessment.validation import Pooled, Prediction, pooled, predict
from surae.assessment.verdict import Verdict
from surae.assessment.whiteness import Whiteness, whiteness

__all__ = [
    "Assessment",
    "Baseline",
    "Comparison",
    "Covariance",
    "Finding",
    "Interval",
    "ParameterEstimate",
    "Pooled",
    "Prediction",
    "RecordingQuality",
    "RobustCovariance",
    "Verdict",
    "Whiteness",
    "assess",
    "autocorrelation",
    "ipde",
    "pooled",
    "predict",
    "rmse",
    "vaf",
    "whiteness",
]
