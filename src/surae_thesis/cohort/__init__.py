"""The subjects of the thesis (3.2), a virtual cohort in their place: fits, claims, figures.

`members` and `trials` make the cohort, `work` computes one fit, `plan` says which, `results` holds
what came of them; `claims` has a row for each claim, and `beyond` fits the same cohort our way,
against the truth.
"""

from surae_thesis.section import Context, Result, Section

__all__ = ["SECTION"]


def _run(context: Context) -> Result:
    from surae_thesis.cohort.subjects import reproduce

    return reproduce(context)


SECTION = Section(
    name="subjects",
    title="Subjects: a virtual cohort",
    source="3.2, 4.2, 4.4; Figures 17 to 35 and 40",
    run=_run,
)
