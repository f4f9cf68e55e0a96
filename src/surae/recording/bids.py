"""Recordings as a BIDS folder of EMG data: BDF with its sidecars, and nobody's name.

Channels on one time axis share a ``_emg.bdf``; those with times of their own get files of their
own, told apart by ``acq-1``, ``acq-2``, …, each with its ``StartTime``. A sample is kept to the
resolution of 24 bits over the channel's range. EMG is in µV, all else in SI units.

Source: Brain Imaging Data Structure, electromyography (Gorgolewski et al. 2016; BIDS 1.11).
"""

import importlib
import os
import re
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from surae._version import __version__
from surae.errors import InputError
from surae.files import PathLike, shown, write_json
from surae.recording.recording import Channel, Recording
from surae.recording.samples import rounding
from surae.recording.writing import column_name

_VERSION = "1.11.0"
_LABEL = re.compile(r"[0-9A-Za-z]+")
#: A BDF data record should not be larger than this [bytes]; a sample has three.
_RECORD_BYTES = 61440
#: Relative error of a rate that its field of eight characters may cause.
_RATE_ERROR = 1e-6
#: Samples further from a uniform axis than this many steps are not sampled uniformly.
_UNIFORM_STEPS = 1e-3
#: Stamps rounded more coarsely than this [steps] cannot be told from gaps.
_COARSEST_STEPS = 0.4

_MUSCLES = {
    "emg_ta": "tibialis anterior",
    "emg_gl": "gastrocnemius lateralis",
    "emg_sol": "soleus",
    "emg_gm": "gastrocnemius medialis",
}
_DESCRIPTIONS = {
    "angle": "ankle angle, dorsiflexion positive, 0 with the foot perpendicular to the shank",
    "torque": "reaction torque on the manipulator, positive when the triceps surae pulls",
    "angular_velocity": "of the ankle, dorsiflexion positive",
    "angular_acceleration": "of the ankle, dorsiflexion positive",
}
#: Names that fit the sixteen characters of a BDF label.
_SHORT = {"angular_velocity": "ankle_vel_rad_s", "angular_acceleration": "ankle_acc_rad_s2"}


def write_bids(
    folder: PathLike, recording: Recording, *, subject: str = "01", task: str = "ankle"
) -> None:
    """Write a new BIDS folder with one recording, all of it or nothing.

    The recording's own name is left out, since it may be a person's.

    Parameters
    ----------
    folder : str or path
        The folder, which must not exist yet.
    recording : Recording
        Its channels must be sampled uniformly.
    subject, task : str
        Labels, of letters and digits.

    Raises
    ------
    InputError
        A label is none, the folder exists or cannot be written, a channel is not sampled
        uniformly, or the extra ``formats`` is not installed.
    """
    where = f"cannot write {shown(folder)}"
    for name, label in (("subject", subject), ("task", task)):
        if not _LABEL.fullmatch(label):
            raise InputError(f"{where}: {name} {label!r} must be letters and digits only")
    target = Path(folder)
    if target.exists() or target.is_symlink():
        raise InputError(f"{where}: it exists already; choose a new folder")
    if not target.parent.is_dir():
        raise InputError(f"{where}: there is no folder {shown(target.parent)}; make it first")
    groups = _groups(recording, where)
    temporary = target.with_name(f".surae-{os.urandom(8).hex()}.part")
    try:
        data = temporary / f"sub-{subject}" / "emg"
        data.mkdir(parents=True)
        _describe_dataset(temporary, subject, recording)
        for number, group in enumerate(groups, start=1):
            acquisition = f"_acq-{number}" if len(groups) > 1 else ""
            _write_group(data / f"sub-{subject}_task-{task}{acquisition}", group, recording, task)
        temporary.rename(target)
    except (OSError, ValueError) as error:
        shutil.rmtree(temporary, ignore_errors=True)
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise InputError(f"{where}: {' '.join(reason.split())[:200]}") from None
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise


def _groups(recording: Recording, where: str) -> list[list[Channel]]:
    """The channels by their time axis."""
    groups: list[list[Channel]] = []
    for channel in recording.channels.values():
        step = 1.0 / channel.rate_hz
        off = np.max(np.abs(channel.time - (channel.time[0] + step * np.arange(len(channel.time)))))
        # Stamps as programs write them are rounded, once at the ends and once in between.
        rounded = rounding(channel.time, _COARSEST_STEPS * step) or 0.0
        if off > max(_UNIFORM_STEPS * step, rounded):
            raise InputError(
                f"{where}: {channel.role} is not sampled uniformly (off by {1e3 * off:.3g} ms); "
                "prepare the recording first (--prepare), or write .h5"
            )
        for group in groups:
            if np.array_equal(group[0].time, channel.time):
                group.append(channel)
                break
        else:
            groups.append([channel])
    return groups


def _describe_dataset(folder: Path, subject: str, recording: Recording) -> None:
    """The files that every BIDS data set has."""
    write_json(
        folder / "dataset_description.json",
        {
            "Name": "Ankle torque, angle and electromyography",
            "BIDSVersion": _VERSION,
            "DatasetType": "raw" if recording.emg == "raw" else "derivative",
            "GeneratedBy": [{"Name": "surae", "Version": __version__}],
        },
    )
    side = "n/a" if recording.side is None else recording.side
    _write_table(folder / "participants.tsv", [{"participant_id": f"sub-{subject}", "leg": side}])
    write_json(
        folder / "participants.json",
        {"leg": {"Description": "The leg that was measured.", "Levels": {"left": "left leg",
                 "right": "right leg"}}},
    )  # fmt: skip
    (folder / "README.md").write_text(
        "# Ankle recording\n\nAngle, torque and EMG of one leg, written by surae. Names of persons "
        "are left out.\n",
        encoding="utf-8",
    )


def _write_group(stem: Path, group: Sequence[Channel], recording: Recording, task: str) -> None:
    """The data of channels on one time axis, with what describes them."""
    first = group[0]
    _write_bdf(Path(f"{stem}_emg.bdf"), group)
    envelope = {"envelope": {"description": "rectified and low-passed"}}
    write_json(
        f"{stem}_emg.json",
        {
            "TaskName": task,
            "EMGPlacementScheme": "Other",
            "EMGPlacementSchemeDescription": "not recorded; channels.tsv names the muscles",
            "EMGReference": "n/a",
            "EMGChannelCount": sum(channel.role in _MUSCLES for channel in group),
            "SamplingFrequency": _rate(first),
            "PowerLineFrequency": "n/a",
            "SoftwareFilters": "n/a" if recording.emg == "raw" else envelope,
            "RecordingType": "continuous",
            "RecordingDuration": len(first.time) / _rate(first),
            "StartTime": float(first.time[0]),
        },
    )
    _write_table(
        Path(f"{stem}_channels.tsv"),
        [
            {
                "name": label_of(channel),
                "type": "EMG" if channel.role in _MUSCLES else "MISC",
                "units": {"V": "uV", "1": "n/a"}.get(channel.unit, channel.unit),
                "description": _DESCRIPTIONS.get(channel.role, "electromyogram"),
                "sampling_frequency": f"{_rate(channel):.12g}",
                "target_muscle": _MUSCLES.get(channel.role, "n/a"),
            }
            for channel in group
        ],
    )


def label_of(channel: Channel) -> str:
    """A channel's name in the BDF, at most sixteen characters."""
    unit = "uV" if channel.unit == "V" else channel.unit
    return _SHORT.get(channel.role) or column_name(channel.role, unit)


def _write_bdf(path: Path, group: Sequence[Channel]) -> None:
    """Channels on one time axis as BDF."""
    edfio = _edfio(str(path))
    n, rate = len(group[0].time), _rate(group[0])
    duration, exact = _record(n, rate, len(group))
    signals = [
        edfio.BdfSignal(
            channel.values * (1e6 if channel.unit == "V" else 1.0),
            exact,
            label=label_of(channel),
            physical_dimension="uV" if channel.unit == "V" else channel.unit,
        )
        for channel in group
    ]
    edfio.Bdf(signals, data_record_duration=duration).write(path)


def _edfio(path: str) -> Any:
    """The library that writes BDF."""
    try:
        return importlib.import_module("edfio")
    except ImportError:
        raise InputError(
            f"cannot write {shown(path)}: BDF needs the package edfio; install it with: "
            'pip install "surae[formats]"'
        ) from None


def _record(n: int, rate_hz: float, channels: int) -> tuple[float, float]:
    """Duration [s] of a data record of which `n` samples are a whole number, and the file's rate.

    The duration has eight characters, so that the rate of most numbers of samples is rounded. The
    largest record whose rounding does not matter is taken; else all samples are one record.
    """
    most = max(_RECORD_BYTES // (3 * channels), 1)
    for size in sorted((k for k in range(1, min(n, most) + 1) if n % k == 0), reverse=True):
        duration = _eight(size / rate_hz)
        if duration > 0 and abs(size / duration / rate_hz - 1.0) < _RATE_ERROR / 1e3:
            return duration, size / duration
    duration = _eight(n / rate_hz)
    if duration <= 0 or abs(n / duration / rate_hz - 1.0) > _RATE_ERROR:
        raise ValueError(
            f"{n} samples at {rate_hz:g} Hz are too short for the BDF header; write .h5"
        )
    return duration, n / duration


def _eight(seconds: float) -> float:
    """A number as eight characters hold it."""
    for digits in range(8, 0, -1):
        if len(text := f"{seconds:.{digits}g}") <= 8 and "e" not in text:
            return float(text)
    return 0.0


def _rate(channel: Channel) -> float:
    """Sampling rate [Hz], the roundest that its stamps allow."""
    rounded = rounding(channel.time, _COARSEST_STEPS / channel.rate_hz) or 0.0
    reach = max(1e-9, rounded / (channel.time[-1] - channel.time[0]))
    rates = (round(channel.rate_hz, decimals) for decimals in (0, 3, 6))
    return next((r for r in rates if abs(r / channel.rate_hz - 1.0) <= reach), channel.rate_hz)


def _write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a BIDS table."""
    lines = ["\t".join(rows[0]), *("\t".join(str(cell) for cell in row.values()) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
