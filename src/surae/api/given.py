"""Recordings as they are given: read, prepared or as files, one or several."""

from collections.abc import Sequence

from surae.base.files import PathLike
from surae.recording import Recording, read
from surae.recording.dataframe import DataFrame, of_frame
from surae.recording.reading import read_contraction, read_trials
from surae.signals import ModelInputs

#: A recording in any form: read, prepared, the path of its file, or a DataFrame with the columns of
#: our CSV.
AnyRecording = Recording | ModelInputs | PathLike | DataFrame


def several(recordings: AnyRecording | Sequence[AnyRecording]) -> Sequence[AnyRecording]:
    """A sequence of recordings, of one that is given alone too."""
    alone = isinstance(recordings, Recording | ModelInputs | str | DataFrame)
    alone = alone or hasattr(recordings, "__fspath__")
    return [recordings] if alone else recordings  # type: ignore[list-item,return-value]


def read_in(recording: AnyRecording) -> Recording | ModelInputs:
    """A recording, read if it is a file or a table."""
    if isinstance(recording, Recording | ModelInputs):
        return recording
    return of_frame(recording) if isinstance(recording, DataFrame) else read(recording)


def each_in(recording: AnyRecording) -> Sequence[Recording | ModelInputs]:
    """The recordings in a file, which may be several trials; or the one that is given."""
    if isinstance(recording, Recording | ModelInputs | DataFrame):
        return [read_in(recording)]
    return read_trials(recording)


def contraction_in(recording: AnyRecording) -> Recording | ModelInputs:
    """A maximum contraction, of which EMG is all that is read."""
    if isinstance(recording, Recording | ModelInputs | DataFrame):
        return read_in(recording)
    return read_contraction(recording)
