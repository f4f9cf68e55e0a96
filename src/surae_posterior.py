"""What was the distribution surae-posterior is part of surae."""

raise ImportError(
    "surae_posterior is part of surae: use surae.posterior and surae.profile; "
    "its modules are in surae.sampling (pip uninstall surae-posterior)"
)
