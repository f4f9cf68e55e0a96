"""What a format's module offers: it recognises its files by their content, and opens them."""

from typing import Protocol, runtime_checkable

from surae.recording.source import Source
from surae.recording.table import Table


@runtime_checkable
class FormatModule(Protocol):
    """What a format's module offers; a plugin's may say how its files end, in `ENDINGS`."""

    def recognises(self, source: Source) -> bool:
        """Whether the content, not the name, is of this format."""
        ...

    def open_table(self, source: Source) -> Table:
        """Read the header; raise InputError where it is wrong."""
        ...
