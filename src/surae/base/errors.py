"""The errors of surae: one line each, saying what, where and what to do."""


class SuraeError(Exception):
    """Base of every error that surae raises on purpose."""


class InputError(SuraeError, ValueError):
    """A file, setting or argument is wrong; the message says which and how to mend it."""


class ComputationError(SuraeError, RuntimeError):
    """A computation could not be carried out on valid input."""
