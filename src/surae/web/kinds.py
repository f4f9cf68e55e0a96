"""What the workbench's jobs are, and what becomes of them."""

from typing import TYPE_CHECKING

from surae.web.fits import keep_comparison, keep_designs, keep_fit, keep_profile, keep_study
from surae.web.jobs import Kind
from surae.web.legs import keep_session

if TYPE_CHECKING:
    from surae.web.workbench import Workbench


def job_kinds(bench: "Workbench") -> dict[str, Kind]:
    """Each kind of job by its name."""
    return {
        "fit": Kind("fits", lambda job, end: keep_fit(bench, job, end)),
        "profile": Kind("fits", lambda job, end: keep_profile(bench, job, end)),
        "session": Kind("fits", lambda job, end: keep_session(bench, job, end)),
        "compare": Kind("fits", lambda job, end: keep_comparison(bench, job, end)),
        "design": Kind("studies", lambda job, end: keep_designs(bench, job, end)),
        "study": Kind("studies", lambda job, end: keep_study(bench, job, end)),
    }
