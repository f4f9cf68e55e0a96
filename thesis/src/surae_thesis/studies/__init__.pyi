"""What the package offers, one line each, and where it is made."""

from surae_thesis.studies.store import Store as Store
from surae_thesis.studies.store import export_study as export_study
from surae_thesis.studies.store import run_study as run_study
from surae_thesis.studies.store import study_columns as study_columns
from surae_thesis.studies.store import study_table as study_table
from surae_thesis.studies.study import Study as Study
from surae_thesis.studies.study import parse_study as parse_study
from surae_thesis.studies.study import read_study as read_study
