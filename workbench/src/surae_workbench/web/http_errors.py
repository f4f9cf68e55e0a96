"""What the workbench refuses, each with its HTTP status and one line that says what to do."""

from surae.base.errors import InputError


class RefusedError(InputError):
    """A request that is refused with an HTTP status, and what, where and what to do."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


def not_found(what: str) -> RefusedError:
    """There is nothing under an id."""
    return RefusedError(
        404, f"there is no such {what}; it may have been deleted, load the page again"
    )
