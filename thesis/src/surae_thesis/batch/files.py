"""Whose recording a file is, which protocol, and which repetition of it: told by its name."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from surae.base.errors import InputError
from surae.base.files import PathLike, natural_order, sha256_of, shown
from surae.recording import description_of, files_of
from surae.trials import trial_files

#: What parts a name: ``S01/holds_2`` and ``S01_holds_2`` say the same.
_BETWEEN = re.compile(r"[/_\s]+")
#: How a repetition is written: a number, alone or after a word for it, or after the protocol.
_REPETITION = re.compile(r"(?P<word>.*?)-?(?P<number>\d+)")
_WORDS = ("", "r", "rep", "repetition", "trial", "run")
#: What a pattern may ask for.
_PLACES = ("subject", "protocol", "repetition")


@dataclass(frozen=True, slots=True, order=True)
class NamedTrial:
    """A recording's file, and what its name says."""

    subject: str
    protocol: str
    repetition: int
    path: str

    @property
    def name(self) -> str:
        """What it is called."""
        return f"{self.subject} {self.protocol} {self.repetition}"


def find_trials(
    sources: Sequence[PathLike], mapping: PathLike | None = None, pattern: str = ""
) -> tuple[NamedTrial, ...]:
    """The recordings in folders and below them, or the files given, by subject and protocol.

    Parameters
    ----------
    sources : sequence of paths
        Folders, or files.
    mapping : path, optional
        A TOML that describes all of them.
    pattern : str
        What names look like, as ``{subject}/{protocol}-{repetition}``; without it a name's first
        part is the subject, a number at its end the repetition, and the protocol between them.

    Raises
    ------
    InputError
        There is none, a name does not say whose it is, or two files are the same repetition.
    """
    description = None if mapping is None else description_of(mapping)
    by_key: dict[tuple[str, str, int], NamedTrial] = {}
    for label, path in _labelled(sources, lambda at: trial_files([at], description)):
        trial = NamedTrial(*_read(label, pattern), str(path))
        key = (trial.subject, trial.protocol, trial.repetition)
        if key in by_key:
            raise InputError(
                f"{shown(by_key[key].path)} and {shown(path)} are both {trial.name!r}; rename one, "
                "or say by --name where subject, protocol and repetition stand"
            )
        by_key[key] = trial
    if not by_key:
        raise InputError(f"{', '.join(map(shown, sources))}: no recording is there")
    every = sorted(by_key, key=lambda key: (*map(natural_order, key[:2]), key[2]))
    return tuple(by_key[key] for key in every)


def _labelled(
    sources: Iterable[PathLike], trials_at: Callable[[Path], Mapping[str, Path]]
) -> Iterator[tuple[str, Path]]:
    """Names of recordings, with the folders below a source, and their files."""
    for source in sources:
        root = Path(source)
        if not root.is_dir():
            for name, path in trials_at(root).items():
                yield name, path
            continue
        for folder in (root, *sorted(p for p in root.rglob("*") if p.is_dir())):
            try:
                several = trials_at(folder)
            except InputError:  # none lies in this folder itself
                continue
            inside = folder.relative_to(root).parts
            for name, path in several.items():
                if path.parent == folder:  # those below it come with their own folder
                    yield "/".join((*inside, name)), path


def _read(label: str, pattern: str) -> tuple[str, str, int]:
    """Subject, protocol and repetition of a name."""
    if pattern:
        return _matched(label, pattern)
    parts = [part for part in _BETWEEN.split(label) if part]
    number = 1
    last = _REPETITION.fullmatch(parts[-1])
    if last and len(parts) > 1:
        number = int(last["number"])
        word = last["word"].rstrip("-")
        parts[-1:] = [] if word.lower() in _WORDS else [word]
    return parts[0], "_".join(parts[1:]) or "trial", number


def _matched(label: str, pattern: str) -> tuple[str, str, int]:
    expected = re.escape(pattern)
    for place in _PLACES:
        shape = r"\d+" if place == "repetition" else r"[^/]+?"
        expected = expected.replace(re.escape(f"{{{place}}}"), f"(?P<{place}>{shape})", 1)
    named = re.fullmatch(expected, label)
    if named is None or "subject" not in (parts := named.groupdict()):
        raise InputError(
            f"{label!r} is not as --name {pattern!r} says; write it with {{subject}}, {{protocol}} "
            "and {repetition} where these stand in the path from the folder, without the ending"
        )
    return parts["subject"], parts.get("protocol", "trial"), int(parts.get("repetition", 1))


def content_of(path: PathLike, mapping: PathLike | None) -> str:
    """What a recording's numbers depend on: its files, and the mapping that describes them."""
    files = files_of(path, mapping)
    return " ".join(sha256_of(file) if file.is_file() else str(file) for file in files)
