"""What a fit is worth: goodness, uncertainty, identifiability, validation."""

from surae.assessment.adequacy import Adequacy, Grade
from surae.assessment.assess import Assessment, RecordingQuality, assess
from surae.assessment.parameter import Interval, ParameterEstimate, Verdict
from surae.assessment.residual import Whiteness, rmse, vaf, whiteness
from surae.assessment.uncertainty.covariance import Covariance, covariance, half_width, ipde
from surae.assessment.validation import Prediction, pooled

__all__ = [
    "Adequacy",
    "Assessment",
    "Covariance",
    "Grade",
    "Interval",
    "ParameterEstimate",
    "Prediction",
    "RecordingQuality",
    "Verdict",
    "Whiteness",
    "assess",
    "covariance",
    "half_width",
    "ipde",
    "pooled",
    "rmse",
    "vaf",
    "whiteness",
]
