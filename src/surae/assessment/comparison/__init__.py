"""Rigid or elastic: several models on the same data."""
