"""What a fit is worth: goodness, uncertainty, identifiability, validation."""

from surae.assessment.assess import Assessment, ParameterEstimate, RecordingQuality, assess
from surae.assessment.comparison import Comparison, Finding
from surae.assessment.quality import autocorrelation, rmse, vaf
from surae.assessment.uncertainty import Covariance, ipde
from surae.assessment.validation import Prediction, predict
from surae.assessment.verdict import Verdict

__all__ = [
    "Assessment",
    "Comparison",
    "Covariance",
    "Finding",
    "ParameterEstimate",
    "Prediction",
    "RecordingQuality",
    "Verdict",
    "assess",
    "autocorrelation",
    "ipde",
    "predict",
    "rmse",
    "vaf",
]
