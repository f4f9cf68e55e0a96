"""Replicates in a file that grows line by line, so that a bootstrap that was killed goes on."""

import json
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Self

import numpy as np

from surae.errors import InputError
from surae.files import PathLike, read_bytes, require_writable, shown


class ReplicateFile:
    """JSON lines: a head that says what the replicates are of, then one replicate a line.

    Parameters
    ----------
    path : path or None
        The file, made where there is none; None keeps nothing.
    head : mapping
        What must be the same for replicates to belong together.

    Attributes
    ----------
    found : dict of int to (list of float, or None)
        Replicates that were there already; None for one whose fit failed.

    Raises
    ------
    InputError
        The file cannot be read or written, or holds something else.
    """

    def __init__(self, path: PathLike | None, head: Mapping[str, Any]) -> None:
        self._path, self._head = path, dict(head)
        self._handle: BinaryIO | None = None
        self.found: dict[int, list[float] | None] = {}

    def __enter__(self) -> Self:
        if self._path is None:
            return self
        require_writable(self._path)
        whole = b""
        if Path(self._path).exists():
            content = read_bytes(self._path)
            whole = content[: content.rfind(b"\n") + 1]  # a line cut short is no replicate
            if whole:
                self._read(whole)
            elif content:
                raise self._foreign()
        try:
            # Nothing else may be open: what was cut short goes before anything is added.
            self._handle = Path(self._path).open("r+b" if Path(self._path).exists() else "xb")
            self._handle.truncate(len(whole))
            self._handle.seek(len(whole))
            if not whole:
                self._write(self._head)
        except OSError as error:
            raise InputError(f"cannot write {shown(self._path)}: {error.strerror}") from None
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._handle is not None:
            self._handle.close()

    def add(self, number: int, values: list[float] | None) -> None:
        """Add a replicate; it is in the file when this returns."""
        if self._handle is not None:
            self._write({"replicate": number, "values": values})

    def _write(self, line: Mapping[str, Any]) -> None:
        assert self._handle is not None
        self._handle.write(json.dumps(line, allow_nan=False).encode() + b"\n")
        self._handle.flush()

    def _read(self, content: bytes) -> None:
        assert self._path is not None
        try:
            head, *lines = map(json.loads, content.decode("utf-8").splitlines())
            p = len(self._head["parameters"])
            for line in lines:
                values = line["values"]
                if values is not None:
                    values = [float(value) for value in values]
                    if len(values) != p or not np.isfinite(values).all():
                        raise ValueError("a replicate is damaged")
                self.found[int(line["replicate"])] = values
        except (ValueError, KeyError, TypeError, UnicodeDecodeError, RecursionError):
            raise self._foreign() from None
        if head != self._head:
            raise InputError(
                f"{shown(self._path)} holds replicates of another fit, seed or block length; "
                "remove it or choose another output"
            )

    def _foreign(self) -> InputError:
        assert self._path is not None
        return InputError(
            f"{shown(self._path)} is not a file of replicates; remove it or choose another output"
        )
