"""The joint fit, made in a process beside the others, for it takes longer than all of them."""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from surae.api.fitted import Fit
from surae.api.fitting import fit_inputs, load
from surae.base.records import from_plain, to_plain
from surae.processes import Child, End, Plain
from surae.quality import Quality
from surae.settings import FitSettings
from surae.signals import ModelInputs
from surae.trials.folder import JOINT


class Beside:
    """A process in which the joint fit is made while this one makes the others; a context."""

    def __init__(self) -> None:
        self._child, self._thread = Child(), ThreadPoolExecutor(1)
        self._folder = TemporaryDirectory(prefix="surae-")
        self._path = Path(self._folder.name, JOINT)
        self._names: tuple[str, ...] = ()
        self._end = self._submit("ready")  # to load all that a fit needs takes seconds

    def __enter__(self) -> "Beside":
        return self

    def __exit__(self, *_: object) -> None:
        """End it, with the fit at work."""
        self._child.close()
        self._thread.shutdown()
        self._folder.cleanup()

    def begin(
        self,
        names: tuple[str, ...],
        inputs: Sequence[ModelInputs],
        quality: Sequence[Quality],
        settings: FitSettings,
    ) -> None:
        """Begin the fit of these trials."""
        self._names = names
        request = {"inputs": inputs, "quality": quality, "settings": settings}
        self._end = self._submit("fit_apart", path=str(self._path), **to_plain(request))

    def fit(self, names: tuple[str, ...]) -> Fit | None:
        """The fit of these trials, when it is there; None where none was made."""
        if names != self._names or self._end.result().how != "done":
            return None
        return load(self._path)

    def _submit(self, function: str, **arguments: Plain) -> Future[End]:
        return self._thread.submit(self._child.call, f"{__name__}:{function}", arguments)


def ready() -> None:
    """Nothing: to call it loads this module."""


def fit_apart(inputs: Plain, quality: Plain, settings: Plain, path: str) -> None:
    """Fit in another process, and write the fit there."""
    fit_inputs(
        from_plain(tuple[ModelInputs, ...], inputs),
        from_plain(FitSettings, settings),
        from_plain(tuple[Quality, ...], quality),
    ).save(path)
