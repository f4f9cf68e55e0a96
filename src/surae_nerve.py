"""What was the distribution surae-nerve is part of surae."""

raise ImportError(
    "surae_nerve is part of surae: use surae.impedance and surae.stretches; "
    "its modules are in surae.nerve (pip uninstall surae-nerve)"
)
