"""What was the distribution surae-exchange is part of surae."""

raise ImportError(
    "surae_exchange is part of surae: use surae.export; "
    "its modules are in surae.exchange (pip uninstall surae-exchange)"
)
