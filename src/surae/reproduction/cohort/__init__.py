"""The subjects of the thesis (3.2), a virtual cohort in their place: fits, figures, claims.

`subjects` does what the thesis did and judges its claims; `beyond` fits the same cohort our way,
against the truth. `work` computes one fit, `plan` says which, `results` holds what came of them.
"""
