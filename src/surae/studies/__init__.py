"""Virtual subjects and what is learnt from fitting them."""

from surae.studies.imperfections import Imperfections, realistic_imperfections
from surae.studies.populations import POPULATIONS, VirtualSubject, stream, virtual_subject
from surae.studies.tasks import fingerprint
from surae.studies.virtual import virtual_recording, virtual_trial

__all__ = [
    "POPULATIONS",
    "Imperfections",
    "VirtualSubject",
    "fingerprint",
    "realistic_imperfections",
    "stream",
    "virtual_recording",
    "virtual_subject",
    "virtual_trial",
]
