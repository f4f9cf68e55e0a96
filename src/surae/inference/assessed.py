"""A fit with what it is worth: what is saved, loaded, compared and shown."""

from dataclasses import dataclass

from surae.inference.assessment import Assessment
from surae.inference.result import FitResult
from surae.quality.finding import Quality


@dataclass(frozen=True, slots=True)
class AssessedFit:
    """A fit and what it is worth."""

    result: FitResult  #: What was found: values, residuals, how it was found.
    assessment: Assessment  #: What it is worth: intervals, correlations, verdicts.
    quality: tuple[Quality, ...] = ()  #: What was found in each recording before it was fitted.
