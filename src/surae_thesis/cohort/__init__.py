"""The subjects of the thesis (3.2), a virtual cohort in their place: fits, claims, figures.

`members` and `trials` make the cohort, `work` computes one fit, `plan` says which, `results` holds
what came of them; `claims` has a row for each claim, and `beyond` fits the same cohort our way,
against the truth.
"""
