"""What was the distribution surae-formats is part of surae."""

raise ImportError(
    "surae_formats is part of surae: use surae.read; "
    "its modules are in surae.recording.programs (pip uninstall surae-formats)"
)
