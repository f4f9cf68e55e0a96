"""What was the distribution surae-cohort is part of surae."""

raise ImportError(
    "surae_cohort is part of surae: use surae.cohort; "
    "its modules are in surae.cohorts (pip uninstall surae-cohort)"
)
