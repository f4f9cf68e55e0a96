"""The trials of one leg: files in a folder, what each of them is, what it can tell."""

from surae.trials.folder import trial_files
from surae.trials.sorting import EFFORTS, Hold, Reading, Trial, sorted_trials, tell_together
from surae.trials.trial_set import (
    Crossed,
    TrialSet,
    common_errors,
    in_order_of_content,
    prepared_for,
    reading_of,
)

__all__ = [
    "EFFORTS",
    "Crossed",
    "Hold",
    "Reading",
    "Trial",
    "TrialSet",
    "common_errors",
    "in_order_of_content",
    "prepared_for",
    "reading_of",
    "sorted_trials",
    "tell_together",
    "trial_files",
]
