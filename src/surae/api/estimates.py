"""Parameters of a fit by name."""

from typing import TYPE_CHECKING

from surae.base.errors import UnknownNameError
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict
from surae.base.tables import Tabular, TextTable
from surae.inference.judging.parameter import ParameterEstimate

if TYPE_CHECKING:
    pass


class Estimates(Tabular, FrozenDict[str, ParameterEstimate]):
    """Parameters of a fit by name, which show themselves as a table."""

    def __getitem__(self, name: str) -> ParameterEstimate:
        if name not in self._entries:
            raise UnknownNameError(
                f"this fit has no parameter {name!r}{nearest(name, self._entries)}; it has: "
                f"{', '.join(self._entries)}"
            )
        return self._entries[name]

    def as_table(self) -> TextTable:
        """A row for each: value, interval, unit, verdict."""
        from surae.report.summary import estimates_table

        return estimates_table(self.values())
