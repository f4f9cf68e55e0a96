"""The subjects of the thesis (3.2), a virtual cohort in their place: fits, claims, figures.

`members` and `trials` make the cohort, `work` fits one subject, `results` says which and holds what
came of them; `rules` decide the claims, and `beyond` looks at the same cohort against the truth.
"""
