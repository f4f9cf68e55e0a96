"""The body of a text table: numbers in columns, read fast, explained line by line when wrong."""

import csv
import re
from array import array
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.units import FloatArray
from surae.recording.source import Source
from surae.recording.table import Column, regular, some

#: hh:mm:ss.f, mm:ss.f, with a date of any kind or a number of days before it and, in the morning
#: and afternoon, AM, PM; or a zone, which is that of all.
_CLOCK = re.compile(
    r"(?:(?:[\d./-]{6,10}|\d{1,2}[ -][A-Za-z]{3,9}\.?[ -]\d{2,4}|\d+ days?),?[ T])?"
    r"(?:(\d{1,3}):)?(\d{1,2}):(\d{1,2}(?:[.,]\d{0,12}|:\d{3,9})?)"
    r"(?: ?([AaPp])\.?[Mm]\.?)?(?: ?(?:Z|UTC|GMT|[+-]\d\d:?\d\d))?",
    re.ASCII,
)
#: Texts that pyarrow reads [bytes], and how much of one at a time.
_LARGE = 2**23
_BLOCK = 2**24
_HALF_A_DAY = 43200.0
#: Times [s] so large are counted from the first of them: their digits would else hide a rounding.
_FAR = 1e6
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_OF_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+\.\d*")


@dataclass(frozen=True, slots=True)
class Rows:
    """Everything after the header row of a text table."""

    source: Source  #: The file, of which `Source.require_text` has passed.
    header: int  #: Line number of the row with the names; the first line of a file is 1.
    names: tuple[str, ...]  #: The names in that row.
    delimiter: str | None  #: What separates the cells; None for white space of any length.
    #: What begins the decimals: a point, or a comma, which then is no `delimiter`.
    decimal: str = "."
    clock: int | None = None  #: The column whose cells are times of day, if one's are.

    def load(self, wanted: Sequence[int]) -> FloatArray:
        """Read the columns with these indices, each as one row of the result.

        What is no number is NaN; `reason` says what stands there. A row with more or fewer cells
        than the header is refused.
        """
        first = next(self._numbered(), None)
        if first is None:
            raise InputError(
                f"{self.source.shown}: row {self.header}: no samples follow the header"
            )
        number, line = first
        if (table := self._by_arrow(wanted)) is not None:
            return table
        lines = chain((line,), islice(self.source.lines(), number, None))
        rows = (line for line in lines if (text := line.lstrip()) and text[0] != "#")
        try:  # NumPy's parser takes rows with a number in every cell
            cells = split(self._with_point(line), self.delimiter)
            if len([float(cell) for cell in cells]) == len(self.names):
                table = np.loadtxt(
                    map(self._with_point, rows), delimiter=self.delimiter, comments=None, ndmin=2
                )
                return np.ascontiguousarray(table[:, list(wanted)].T)
        except (ValueError, csv.Error):
            pass
        return self._load(wanted)

    def _by_arrow(self, wanted: Sequence[int]) -> FloatArray | None:
        """A large file's columns, which pyarrow reads ten times as fast; None where it cannot.

        It rounds as NumPy does; whatever it refuses is read line by line, and explained.
        """
        large = len(self.source.data) >= _LARGE and self.delimiter is not None
        if not large or self.clock in wanted:
            return None
        try:
            import pyarrow
            from pyarrow import csv as arrow_csv
        except ImportError:
            return None
        names = [str(index) for index in range(len(self.names))]
        columns_read = list(dict.fromkeys(names[index] for index in wanted))
        columns = np.empty((len(columns_read), self.source.data.count(b"\n") + 1))
        n = 0
        try:
            with arrow_csv.open_csv(
                pyarrow.BufferReader(self.source.data),
                arrow_csv.ReadOptions(column_names=names, skip_rows=self.header, block_size=_BLOCK),
                arrow_csv.ParseOptions(delimiter=self.delimiter),
                arrow_csv.ConvertOptions(
                    column_types=dict.fromkeys(columns_read, pyarrow.float64()),
                    include_columns=columns_read,
                    decimal_point=self.decimal,
                ),
            ) as reader:
                for batch in reader:
                    for place, values in zip(columns, batch.columns, strict=True):
                        place[n : n + batch.num_rows] = values.to_numpy(zero_copy_only=False)
                    n += batch.num_rows
        except (pyarrow.ArrowException, ValueError):
            return None
        of = {name: columns[place, :n] for place, name in enumerate(columns_read)}
        if columns_read == [names[index] for index in wanted]:
            return columns[:, :n]
        return np.array([of[names[index]] for index in wanted])

    def columns(self, wanted: Sequence[str], time: str, factor: float) -> dict[str, Column]:
        """The named columns with the times in column `time`, multiplied by `factor` to seconds.

        Where there is no such column, the times are the numbers of the rows.
        """
        first = {name: index for index, name in reversed(list(enumerate(self.names)))}
        timed = (time,) if time else ()
        data = self.load([first[name] for name in (*timed, *wanted)])
        if time and (wrong := np.flatnonzero(np.isnan(data[0]))).size:
            at = int(wrong[0])
            if why := self.reason(first[time])(at):
                where = f"{self.source.shown}: column {time!r}, {self.position(at)}"
                clock = "; write seconds, or hh:mm:ss.fff" if ":" in why else ""
                raise InputError(f"{where}: {why}{clock}")
        seconds = np.arange(data.shape[1], dtype=np.float64)
        remark = ""
        clock_s = None
        if time and self.clock == first[time]:
            began = float(data[0, 0]) if data.shape[1] else 0.0
            clock_s = began
            days = np.cumsum(np.diff(data[0], prepend=began) < -_HALF_A_DAY)
            seconds, rounded = regular(data[0] - began + 2 * _HALF_A_DAY * days)
            remark = "; ".join(filter(None, (f"{time!r} is a clock's: 0 s is its first", rounded)))
        elif time:
            far = float(data[0, 0]) if data.shape[1] and abs(data[0, 0]) * factor > _FAR else 0.0
            seconds, remark = regular((data[0] - far) * factor)
            seconds = seconds + far * factor if far else seconds
        seconds = freeze(seconds)
        return {
            name: Column(
                name,
                seconds,
                freeze(values),
                time,
                self.position,
                self.reason(first[name]),
                remark,
                clock_s,
            )
            for name, values in zip(wanted, data[len(timed) :], strict=True)
        }

    def reason(self, column: int) -> Callable[[int], str]:
        """Why a sample of a column is no number."""

        def why(index: int) -> str:
            _, line = next(islice(self._numbered(), index, None))
            try:
                parse = time_of_day if column == self.clock else as_number
                parse(self._with_point(split(line, self.delimiter)[column]))
            except ValueError as error:
                return str(error)
            return ""

        return why

    def texts(self, name: str) -> list[str]:
        """What stands in a column, row by row; empty where a row has no such cell."""
        at = self.names.index(name)
        column = []
        for _, line in self._numbered():
            try:
                cells = split(line, self.delimiter)
            except csv.Error:
                cells = []
            column.append(cells[at] if at < len(cells) else "")
        return column

    def position(self, index: int) -> str:
        """The line number of a sample: ``"row 12"``."""
        number, _ = next(islice(self._numbered(), index, None))
        return f"row {number}"

    def _numbered(self) -> Iterator[tuple[int, str]]:
        """Line number and text of each row; blank lines and ``#`` comments are left out."""
        lines = islice(self.source.lines(), self.header, None)
        for number, line in enumerate(lines, start=self.header + 1):
            text = line.lstrip()
            if text and text[0] != "#":
                yield number, line

    def _with_point(self, text: str) -> str:
        """A text in which decimals begin with a point."""
        return text if self.decimal == "." else text.replace(self.decimal, ".")

    def _load(self, wanted: Sequence[int]) -> FloatArray:
        """Read line by line; the definition of what `load` accepts."""
        columns = [array("d") for _ in wanted]
        for number, line in self._numbered():
            where = f"{self.source.shown}: row {number}"
            try:
                cells = split(line, self.delimiter)
            except csv.Error as error:
                raise InputError(f"{where}: {error}") from None
            if len(cells) != len(self.names):
                lost = self.names[len(cells) :]
                at = (
                    f"none for column {some(lost, 1)}"
                    if lost
                    else (f"the last is column {some(self.names[-1:])}")
                )
                raise InputError(
                    f"{where}: {len(cells)} cells where the header names {len(self.names)} "
                    f"columns; {at}"
                )
            for values, index in zip(columns, wanted, strict=True):
                try:
                    parse = time_of_day if index == self.clock else as_number
                    values.append(parse(self._with_point(cells[index])))
                except ValueError:
                    values.append(np.nan)
        return np.array(columns, dtype=np.float64)


def split(line: str, delimiter: str | None) -> list[str]:
    """Cells of a line, without quotes and surrounding white space."""
    if delimiter is None:
        return line.split()
    if '"' in line:
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    else:
        cells = line.split(delimiter)
    return [cell.strip() for cell in cells]


def time_of_day(cell: str) -> float:
    """Seconds since midnight of a time of day, ``09:41:00.25`` with a date before it or none."""
    match = _CLOCK.fullmatch(cell)
    if match is None:
        raise ValueError(f"{some([cell])} is not a time of day")
    hours, minutes, seconds, half = match.groups()
    noon = 12 * ((half or "a").lower() == "p") + (int(hours or 0) % 12 if half else int(hours or 0))
    return 3600.0 * noon + 60.0 * int(minutes) + float(re.sub("[,:]", ".", seconds))


def is_clock(cell: str) -> bool:
    """Whether a cell holds a time of day."""
    return _CLOCK.fullmatch(cell) is not None


def as_number(cell: str) -> float:
    """The number in a cell; Python's own underscores and foreign digits are none."""
    if not cell:
        raise ValueError("the cell is blank")
    try:
        if "_" in cell or not cell.isascii():
            raise ValueError
        return float(cell.replace(",", "") if _THOUSANDS.fullmatch(cell) else cell)
    except ValueError:
        pass
    if _OF_THOUSANDS.fullmatch(cell):
        raise ValueError(
            f"{cell!r} has a comma, of thousands or of decimals; write numbers without thousands' "
            "commas, decimals behind a point"
        )
    if _DECIMAL_COMMA.fullmatch(cell):
        raise ValueError(f"{cell!r} has a decimal comma; write {cell.replace(',', '.')!r}")
    raise ValueError(f"{some([cell])} is not a number")
