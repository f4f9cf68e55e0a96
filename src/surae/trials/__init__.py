"""The trials of one leg: files in a folder, what each of them is, what it can tell."""

from surae.trials.folder import trial_files
from surae.trials.sorting import (
    EFFORTS,
    Hold,
    Reading,
    Trial,
    is_named_maximal,
    sorted_trials,
    tell_together,
)
from surae.trials.strength import Effort, efforts_of
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
    "Effort",
    "Hold",
    "Reading",
    "Trial",
    "TrialSet",
    "common_errors",
    "efforts_of",
    "in_order_of_content",
    "is_named_maximal",
    "prepared_for",
    "reading_of",
    "sorted_trials",
    "tell_together",
    "trial_files",
]
