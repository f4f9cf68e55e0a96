"""A run of a session: its trials checked, each and all fitted, each predicted by the others."""
