"""`session.toml`: what a laboratory knows of a leg beforehand, and what each of its files is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import PathLike, shown
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict
from surae.base.names import GEOMETRY_OF
from surae.base.records import from_file, from_plain, read_toml
from surae.model.geometry_file import read_geometry
from surae.model.knowledge import GEOMETRY_SD, Knowledge, Plate
from surae.model.parameters import CROSSTALK
from surae.model.source_table import NUISANCES
from surae.model.statements import StatedNumber
from surae.model.tare import tared
from surae.recording import Recording
from surae.recording.described import ALONE, EFFORTS, EMPTY
from surae.recording.reading import read
from surae.signals import Preparation, prepare
from surae.signals.selective import crosstalk

#: The file in a session's folder, and what it calls a plate that was taken away before.
SESSION_TOML = "session.toml"
TARED = "tared"


@filed(strict=True)
@dataclass(frozen=True, slots=True, kw_only=True)
class SessionFile:
    """What a `session.toml` says."""

    knowledge: Knowledge = field(default_factory=Knowledge)  #: Without plate and geometry's table.
    plate: str | None = None  #: `TARED`, or the empty device's file.
    geometry: str | None = None  #: The geometry's file.
    trials: Mapping[str, str] = field(default_factory=FrozenDict)  #: Kind of each file.
    path: str = ""  #: The file itself.

    def named(self, file: str) -> Path:
        """A file that it names, as seen from its folder."""
        path = Path(self.path).parent / file
        if not path.is_file():
            near = nearest(file, [TARED, *(p.name for p in path.parent.glob("*") if p.is_file())])
            raise InputError(f"{shown(self.path)}: there is no file {shown(file)}{near}")
        return path

    @property
    def aside(self) -> frozenset[Path]:
        """Files that it names and that are no trials."""
        return frozenset({self.named(self.geometry).resolve()} if self.geometry else ())

    def kinds(self, trials: Mapping[str, PathLike | None]) -> dict[str, str]:
        """Kind of trials by name, of which this is the file."""
        files = {Path(path).name: name for name, path in trials.items() if path is not None}
        given: dict[str, str] = {}
        if self.plate is not None and Path(self.plate).name in files:
            given[files[Path(self.plate).name]] = EMPTY
        for file, kind in self.trials.items():
            name = files.get(Path(file).name) or (file if file in trials else None)
            if name is None:
                near = nearest(file, [*files, *trials])
                raise InputError(f"{shown(self.path)}: trials: there is no {shown(file)}{near}")
            given[name] = kind
        return given


def read_session_toml(path: PathLike) -> SessionFile:
    """The file, all of it checked but what other files hold."""
    plain = read_toml(path)
    known = plain.get("knowledge", {})
    if not all(isinstance(plain.get(name, {}), dict) for name in ("knowledge", "trials")) or (
        plain.keys() & {"path", "plate", "geometry"}
    ):
        raise InputError(f"{shown(path)}: trials: write a table of files and kinds")
    files = {name: known.pop(name) for name in ("plate", "geometry") if name in known}
    said = replace(from_file(SessionFile, path, {**plain, **files}), path=str(path))
    for file, kind in said.trials.items():
        if kind not in EFFORTS:
            raise InputError(
                f"{shown(path)}: trials: {shown(file)} is {shown(kind)!r}{nearest(kind, EFFORTS)}; "
                f"use one of: {', '.join(EFFORTS)}"
            )
    try:
        return replace(said, knowledge=_stated(said))
    except InputError as error:
        raise InputError(f"{shown(path)}: knowledge: {error}") from None


def _stated(said: SessionFile) -> Knowledge:
    """What it says itself, without any step."""
    k = said.knowledge
    sd = k.geometry_sd_percent
    measured = k.geometry_of == GEOMETRY_OF[1]
    if said.geometry is None and (measured or (sd is not None and not k.size)):
        raise InputError("geometry_of and geometry_sd_percent have no effect without geometry")
    return replace(
        k,
        plate=None if said.plate is None else Plate(),
        geometry=Path(said.geometry or "").name,
        geometry_sd_percent=GEOMETRY_SD if sd is None and measured else sd,
    )


def known_from(
    said: SessionFile,
    recordings: Mapping[str, Recording] | None = None,
    kinds: Mapping[str, str] | None = None,
    *,
    read: Callable[[Path], Recording] = read,
) -> Knowledge:
    """What the file states, its geometry, and the tare and crosstalk that steps show.

    `recordings` are trials that are read already, and `kinds` what each is; by default those that
    the file names, as `read` reads them.
    """
    plate = said.plate
    known = said.knowledge
    there = dict(recordings or {})
    if recordings is None:
        kinds = dict(said.trials)
        steps = (file for file, kind in kinds.items() if kind in (EMPTY, ALONE))
        there = {file: read(said.named(file)) for file in steps}
    if said.geometry is not None:
        known = replace(known, table=read_geometry(said.named(said.geometry)))
    empty = [name for name, kind in (kinds or {}).items() if kind == EMPTY and name in there]
    if plate is not None and plate != TARED:
        known = _with_plate(known, read(said.named(plate)))
    elif plate is None and empty:
        known = _with_plate(known, there[empty[0]])
    alone = [name for name, kind in (kinds or {}).items() if kind == ALONE and name in there]
    for name in alone[:1]:
        prior = NUISANCES["crosstalk"].nuisance
        assert prior is not None
        shares = crosstalk(prepare(there[name], Preparation()), (prior.prior.mean, prior.prior.sd))
        by_name = {CROSSTALK[pair]: StatedNumber(*stated) for pair, stated in shares.items()}
        source = there[name].files[0].name if there[name].files else name
        known = replace(known, crosstalk=by_name, crosstalk_of=source)
        if not shares:
            doubt = f"{name}: no muscle contracts alone twice, so that it tells no crosstalk"
            known = replace(known, doubts=(*known.doubts, doubt))
    return known


def read_knowledge(path: PathLike) -> Knowledge:
    """What a `session.toml` says is known, with the steps that it names; see `known_from`."""
    return known_from(read_session_toml(path))


def _with_plate(known: Knowledge, recording: Recording) -> Knowledge:
    """The same with the plate that a recording shows, or why it shows none."""
    try:
        return replace(known, plate=tared(prepare(recording, Preparation())))
    except InputError as error:
        return replace(known, plate=None, doubts=(*known.doubts, str(error)))


def knowledge_of(given: object) -> Knowledge:
    """Knowledge as a keyword has it: itself, its file, or plain data."""
    if isinstance(given, Knowledge):
        return given
    if isinstance(given, Mapping):
        return from_plain(Knowledge, given)
    if not isinstance(given, str) and not hasattr(given, "__fspath__"):
        raise InputError(f"knowledge is {given!r}; give the path of a session.toml")
    return read_knowledge(given)
