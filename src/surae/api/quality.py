"""Findings on a recording in any form."""

from collections.abc import Iterable
from dataclasses import replace

from surae.api.recordings import AnyRecording
from surae.diagnosis import examined, wrong_units
from surae.errors import InputError
from surae.files import PathLike
from surae.model.joint import ANKLE, Joint, read_joint
from surae.quality import (
    Commanded,
    Quality,
    check_recording,
    commanded_file,
    of_joint,
    recording_of,
    recording_or_findings,
)
from surae.recording import Recording
from surae.recording.dataframe import DataFrame, of_frame
from surae.settings import FitSettings
from surae.signals import ModelInputs


def explained(error: InputError, recordings: Iterable[Recording | ModelInputs]) -> InputError:
    """The error that a recording cannot be used, with what is wrong with its units."""
    messages = [
        finding.message
        for recording in recordings
        if isinstance(recording, Recording)
        for finding in wrong_units(recording)[0]
        if finding.severity == "error"
    ]
    return InputError(" ".join([f"{error}.", *messages])) if messages else error


def check(
    recording: AnyRecording,
    *,
    commanded: Commanded | PathLike | None = None,
    prepared: bool = False,
    joint: Joint | PathLike | None = None,
) -> Quality:
    """Look for faults in a recording before it is fitted.

    Parameters
    ----------
    recording : Recording, ModelInputs or path
        As it was measured, if possible: preparation hides faults. Of a file that no fit would read,
        the gaps and missing samples are findings too.
    commanded : Commanded or path, optional
        What the device was to follow, or the file of `surae protocol` that says so. Without it, the
        protocols of `surae.protocol` are recognised in the angle.
    prepared : bool
        Whether the signals are to be used as they are, without filters: envelopes are then right
        whatever the file says of its EMG.
    joint : Joint or path, optional
        Another joint than the ankle: its words, and no check by limits of ankles.

    Returns
    -------
    Quality
        Findings, the most severe first, and the checks that could not be made.

    Raises
    ------
    InputError
        A file cannot be read.
    """
    protocol = commanded if isinstance(commanded, Commanded | None) else commanded_file(commanded)
    own = joint if isinstance(joint, Joint | None) else read_joint(joint)
    quality = _checked(recording, protocol, ANKLE if own is None else own)
    if not prepared:
        return quality
    right = tuple(f for f in quality.findings if (f.code, f.severity) != ("emg-kind", "warning"))
    return replace(quality, findings=right)


def check_for(settings: FitSettings, recording: AnyRecording) -> Quality:
    """Findings of a recording that is fitted with these settings; see `check`."""
    return check(recording, prepared=settings.prepared, joint=settings.options.anatomy)


def _checked(recording: AnyRecording, protocol: Commanded | None, joint: Joint) -> Quality:
    if isinstance(recording, ModelInputs):
        recording = recording_of(recording)
    if isinstance(recording, DataFrame):
        recording = of_frame(recording)
    if not isinstance(recording, Recording):
        found, commanded = recording_or_findings(recording)
        if isinstance(found, Quality):
            return found
        recording, protocol = found, protocol or commanded
    if joint == ANKLE:
        return examined(recording, protocol)
    return of_joint(check_recording(recording, protocol), joint)
