"""A file read into memory once: the bytes that are hashed are the bytes that are parsed."""

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from surae.base import files
from surae.base.errors import InputError
from surae.recording.recording import SourceFile

_BOM = b"\xef\xbb\xbf"
_BOMS_UTF16 = (b"\xff\xfe", b"\xfe\xff")

#: Bytes between letters that Central European code pages have for letters, Western ones for signs.
_EASTERN = {
    "iso8859_2": re.compile(rb"[A-Za-z][\xb1\xb6\xbc][A-Za-z]"),
    "cp1250": re.compile(rb"[A-Za-z][\xb9\xb3\xbf\x9c\x9f\xbe\x9d][A-Za-z]"),
}

#: A file's kind shows within so many bytes: OpenSim's header, a TOML's first key.
HEAD = 65536


@dataclass(frozen=True, slots=True)
class Source:
    """A file's path as given, its bytes and their SHA-256."""

    path: str
    data: bytes = field(repr=False)
    sha256: str
    #: What a user should know of how its letters were read; empty where it is UTF-8.
    decoded: str = ""

    @property
    def shown(self) -> str:
        """The path as it appears in messages."""
        return files.shown(self.path)

    @property
    def name(self) -> str:
        """The file's name without folder and extension, in one printable line."""
        return files.shown(Path(self.path).stem)

    @property
    def file(self) -> SourceFile:
        """What a recording keeps of it."""
        return SourceFile(path=self.shown, sha256=self.sha256)

    def lines(self) -> Iterator[str]:
        r"""The text's lines with their ends, ``\r\n`` and ``\r`` turned into ``\n``."""
        stream = io.BytesIO(self.data)
        stream.seek(len(_BOM) if self.data.startswith(_BOM) else 0)
        return iter(io.TextIOWrapper(stream, encoding="utf-8"))

    def head(self) -> list[str]:
        """Lines of the file's first part, for recognising it; never fails."""
        return self.data[:HEAD].removeprefix(_BOM).decode(errors="replace").splitlines()

    def in_utf8(self) -> "Source":
        """The same text in UTF-8, where it is UTF-16 or of Windows' or ISO's European letters."""
        encoding = ""
        if self.data.startswith(_BOMS_UTF16):
            encoding = "utf-16"
        elif not any(self.data[1:40:2]) and all(self.data[:40:2]):  # the same without its mark
            encoding = "utf-16-le"
        elif b"\0" not in self.data[:HEAD] and not self.data.isascii():
            try:
                self.data.decode()
            except UnicodeDecodeError:
                encoding = next(
                    (name for name, between in _EASTERN.items() if between.search(self.data)),
                    "cp1252",
                )
        try:
            text = self.data.decode(encoding) if encoding else ""
        except UnicodeDecodeError:
            return self
        if not text:
            return self
        said = f"its letters are read as {encoding}" if encoding in _EASTERN else ""
        return replace(self, data=text.encode(errors="replace"), decoded=said)

    def require_text(self) -> None:
        """Check that it is UTF-8 text with something in it."""
        start = self.data[:HEAD].removeprefix(_BOM).strip()  # of a large file no copy is made
        if not start and not self.data.removeprefix(_BOM).strip():
            raise InputError(f"{self.shown}: the file is empty")
        if b"\0" in self.data:
            raise InputError(
                f"{self.shown}: the file is binary, in no format that is read here; supported: "
                "CSV, TOML mapping, our HDF5, MATLAB, C3D, EDF/BDF, Poly5, XDF, Trigno, OpenSim, "
                "Nexus, LabVIEW, AcqKnowledge, Excel, Parquet; export one of these"
            )
        try:
            if not self.data.isascii():
                self.data.decode()
        except UnicodeDecodeError as error:
            row = self.data.count(b"\n", 0, error.start) + 1
            raise InputError(
                f"{self.shown}: row {row}: byte 0x{self.data[error.start]:02x} is not UTF-8 text; "
                "save the file as UTF-8"
            ) from None


def open_source(path: files.PathLike) -> Source:
    """Read a regular file into memory.

    Raises
    ------
    InputError
        It cannot be read; see `surae.base.files.read_bytes`.
    """
    data = files.read_bytes(path)
    return Source(path=str(path), data=data, sha256=files.sha256(data))
