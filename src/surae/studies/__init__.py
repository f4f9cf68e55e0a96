"""Virtual subjects and what is learnt from fitting them."""

from surae.studies.imperfections import Imperfections, realistic_imperfections
from surae.studies.virtual import (
    POPULATIONS,
    VirtualSubject,
    virtual_recording,
    virtual_subject,
    virtual_trial,
)

__all__ = [
    "POPULATIONS",
    "Imperfections",
    "VirtualSubject",
    "realistic_imperfections",
    "virtual_recording",
    "virtual_subject",
    "virtual_trial",
]
