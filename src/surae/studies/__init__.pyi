"""What the package offers, one line each, and where it is made."""

from surae.studies.imperfections import Imperfections as Imperfections
from surae.studies.imperfections import realistic_imperfections as realistic_imperfections
from surae.studies.populations import POPULATIONS as POPULATIONS
from surae.studies.populations import VirtualSubject as VirtualSubject
from surae.studies.populations import stream as stream
from surae.studies.populations import virtual_subject as virtual_subject
from surae.studies.store import Store as Store
from surae.studies.store import export_study as export_study
from surae.studies.store import run_study as run_study
from surae.studies.store import study_columns as study_columns
from surae.studies.store import study_table as study_table
from surae.studies.study import Study as Study
from surae.studies.study import parse_study as parse_study
from surae.studies.study import read_study as read_study
from surae.studies.tasks import fingerprint as fingerprint
from surae.studies.virtual import virtual_recording as virtual_recording
from surae.studies.virtual import virtual_trial as virtual_trial
