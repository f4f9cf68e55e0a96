"""What a command reads and writes, checked before any work is done."""

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from surae.base.errors import InputError
from surae.base.files import read_bytes, require_writable, shown

#: What commands of other distributions are made of.
__all__ = ["check_outputs"]

#: Beginning of a file in which a FIT.json says what it is [bytes].
_HEAD = 200


def in_folders(recordings: Sequence[str], mapping: str | None = None) -> tuple[str, ...]:
    """The recordings, with those of a folder in its place, as surae session takes them from it."""
    from surae import api

    files: list[str] = []
    for path in recordings:
        if Path(path).is_dir():
            files += [str(file) for file in api.files_of_trials(path, mapping)]
        else:
            files.append(path)
    check_recordings(files)
    return tuple(files)


def check_recordings(recordings: Sequence[str]) -> None:
    """Refuse what is given in place of recordings by mistake.

    Two paths may not lead to one file, whose samples would count double, and none may be a fit.
    """
    seen = set()
    for path in recordings:
        real = os.path.realpath(path)
        if real in seen:
            raise InputError(f"{shown(path)} is given twice and would count double; give it once")
        seen.add(real)
        if Path(path).suffix == ".json" and b'"parameters"' in read_bytes(path):
            raise InputError(
                f"{shown(path)}: this is a fit, not a recording; did you mean `surae validate "
                "FIT.json REC`?"
            )


def check_outputs(
    outputs: Mapping[str, str | None], inputs: Iterable[str], *, spare_fits: bool = False
) -> None:
    """Refuse outputs, by option, that cannot be written, before the work instead of after it.

    `inputs` are files that are read, and must not be replaced by results; nor is another fit, where
    they are to be spared.
    """
    taken = {os.path.realpath(path): "is read by this command" for path in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        if not path:
            raise InputError(f"{option} is empty; give the name of a file")
        require_writable(path)
        real = os.path.realpath(path)
        if real in taken:
            raise InputError(f"{option}: {shown(path)} {taken[real]}; choose another file")
        if not Path(real).exists() or Path(real).is_file():  # a device may take both
            taken[real] = f"is the file of {option} too"
        if spare_fits and Path(path).is_file():
            with Path(path).open("rb") as file:
                head = file.read(_HEAD)
            if b'"surae"' in head and b'"format"' in head:
                raise InputError(f"{option}: {shown(path)} is a fit; choose another file")
