"""A fit and a baseline as files."""
