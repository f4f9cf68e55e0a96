"""What a fit is worth, as it is kept and read."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from surae._version import __version__
from surae.base.file_form import filed
from surae.base.frozen import Comparable
from surae.inference import FitResult
from surae.inference.judging.fascicles import FascicleQuality
from surae.inference.judging.goodness import Whiteness
from surae.inference.judging.grade import Adequacy
from surae.inference.judging.parameter import Interval, ParameterEstimate
from surae.inference.uncertainty.combined import Uncertainty
from surae.inference.uncertainty.covariance import Covariance
from surae.inference.uncertainty.robust import RobustCovariance
from surae.quality.finding import Quality


@filed(sparse=("fascicles",), rmse="rmse_Nm", bias="bias_Nm")
@dataclass(frozen=True, slots=True, eq=False)
class RecordingQuality(Comparable):
    """How well one recording is followed where its samples count: VAF, R² [%], RMSE, bias [Nm].

    `vaf_weighted` counts the samples as the fit did; None where all that count count alike. `r2` is
    centred: of the torque's changes.
    """

    name: str
    path: str | None
    sha256: str | None
    n: int
    rate_hz: float
    vaf: float
    rmse: float
    bias: float
    vaf_weighted: float | None
    r2: float
    fascicles: tuple[FascicleQuality, ...] = ()


@filed(
    "robust",
    "uncertainty",
    "differs",
    rmse="rmse_Nm",
    covariance="correlation",
    version="judged_by",
)
@dataclass(frozen=True, slots=True, eq=False)
class Assessment(Comparable):
    """What a fit is worth."""

    #: `vaf`, `rmse`: of all recordings together [%, Nm]; NaN where the model gave no finite torque.
    vaf: float
    rmse: float
    #: VAF with the samples counted as the fit did, 1 − Σwe²/ΣwT² [%]; None where all that count
    #: count alike.
    vaf_weighted: float | None
    parameters: Mapping[str, ParameterEstimate]  #: All parameters of the model, in its order.
    covariance: Covariance  #: Of the estimates that have one, equation (33): for white residuals.
    #: Of the same estimates, for residuals that are correlated over time.
    robust: RobustCovariance | None
    #: Autocorrelation of each recording's residual, and the test of it.
    whiteness: tuple[Whiteness, ...]
    interval: Interval  #: Which of the two the intervals and verdicts rest on.
    interval_note: str  #: Why, in a plain sentence: a `Message`, unless it was read from a file.
    #: Equation (35); None, with `ipde_note` saying why, when fewer than two have a variance.
    ipde: float | None
    #: Which parameters it leaves out, or why there is none; empty when it has them all.
    ipde_note: str
    recordings: tuple[RecordingQuality, ...]  #: One for each recording.
    adequacy: Adequacy  #: Whether the fit is good enough for any of this to mean something.
    uncertainty: Uncertainty  #: Of all free parameters together, of which all intervals are made.
    #: What `model="auto"` found of the laboratory; empty for a named model.
    nuisances: Mapping[str, ParameterEstimate] = field(default_factory=dict)
    version: str = __version__  #: The version of surae that gave the verdicts.
    #: Where this version judges otherwise than the file that the verdicts are read from.
    differs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class AssessedFit:
    """A fit and what it is worth."""

    result: FitResult  #: What was found: values, residuals, how it was found.
    assessment: Assessment  #: What it is worth: intervals, correlations, verdicts.
    quality: tuple[Quality, ...] = ()  #: What was found in each recording before it was fitted.


def outdated(assessment: Assessment) -> str:
    """How this version would judge a fit that was read, in a sentence; empty where as it did."""
    if not assessment.differs:
        return ""
    text = "; ".join(assessment.differs)
    return (
        f"Judged by surae {assessment.version}. By this version, {__version__}, {text}; surae "
        "reassess renews what the file says."
    )


def variance_inflation(assessment: Assessment) -> dict[str, float]:
    """Factors on the variance of the noise that an assessment asks for, for its `interval_note`.

    1 where its residuals pass for white noise. Where intervals are robust it is (sem_robust/sem)²
    of each parameter that was estimated; one without a standard error, as at a bound, has the
    median of the others.
    """
    free = [p for p in assessment.parameters.values() if p.free]
    known = {}
    if assessment.interval is Interval.ROBUST:
        known = {p.name: (p.sem_robust / p.sem) ** 2 for p in free if p.sem and p.sem_robust}
    common = float(np.median(list(known.values()))) if known else 1.0
    return {p.name: known.get(p.name, common) for p in free}


def described(factors: Mapping[str, float], reason: str) -> str:
    """What was done to the noise and why, as a line: ``variance of the noise ×4: …``."""
    least, most = (f"{end(factors.values()):.3g}" for end in (min, max))
    text = f"×{least}" if least == most else f"×{least} … ×{most}, by parameter"
    return f"variance of the noise {text}" + (f": {reason}" if reason else "")
