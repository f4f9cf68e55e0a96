"""What the package offers, one line each, and where it is made."""

from surae.studies.imperfections import Imperfections as Imperfections
from surae.studies.imperfections import realistic_imperfections as realistic_imperfections
from surae.studies.populations import POPULATIONS as POPULATIONS
from surae.studies.populations import VirtualSubject as VirtualSubject
from surae.studies.populations import stream as stream
from surae.studies.populations import virtual_subject as virtual_subject
from surae.studies.virtual import virtual_recording as virtual_recording
from surae.studies.virtual import virtual_trial as virtual_trial
