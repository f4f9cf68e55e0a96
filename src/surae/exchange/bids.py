"""Recordings and a fit as a data set of EMG-BIDS: EDF with its sidecars, the fit as a derivative.

BIDS 1.11 has electromyography (extension proposal 42): one EDF a recording, its JSON and its table
of channels; what was computed lies in `derivatives`. What a recording does not state is written as
not stated.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surae._version import __version__
from surae.base.errors import InputError
from surae.base.files import PathLike, shown, write_atomic
from surae.base.units import FloatArray
from surae.inference import AssessedFit
from surae.inference.saved.fit_json import save_fit
from surae.recording import MUSCLE_NAMES, Channel, Recording
from surae.recording.frames import library
from surae.recording.writing import column_name

VERSION = "1.11.1"  #: Of BIDS.
#: What EMG is written in, and by how much it is multiplied.
_MICRO = ("uV", 1e6)
#: Shortest and longest data record [s]; EDF is read by the record.
_SHORTEST, _LONGEST = 0.05, 10.0
#: To such a part of a second [s] a recording is cut that no records fill whole.
_CUT_S = 0.1
_LABEL = re.compile(r"[A-Za-z0-9]+")


@dataclass(frozen=True, slots=True)
class BidsSet:
    """What was written."""

    root: str  #: The folder of the data set.
    paths: tuple[str, ...]  #: Its files, relative to it.
    #: Seconds that were cut from the end of each recording, by its file: what filled no record.
    cut: dict[str, float]

    def __repr__(self) -> str:
        said = "".join(f"; {name}: its last {s:.3g} s cut" for name, s in self.cut.items() if s > 0)
        return f"EMG-BIDS in {self.root}: {len(self.paths)} files{said}"


def write_bids(
    root: PathLike,
    recordings: Sequence[Recording],
    fit: AssessedFit | None = None,
    *,
    subject: str = "01",
    session: str | None = None,
    task: str = "ankle",
    mains_hz: float | None = None,
) -> BidsSet:
    """Write recordings of one person as EMG-BIDS, and the fit of them as a derivative.

    Parameters
    ----------
    root : path
        Folder of the data set; other subjects in it stay as they are.
    recordings : sequence of Recording
        As they were measured; each becomes a run.
    fit : Fit, optional
        Its file goes to ``derivatives/surae``.
    subject, session, task : str
        Labels, of letters and digits.
    mains_hz : float, optional
        Frequency of the mains [Hz]; by default not stated.

    Returns
    -------
    BidsSet
        What was written.

    Raises
    ------
    InputError
        The package edfio is missing, a label is none, a file cannot be written, or channels of a
        recording begin at different times.

    Examples
    --------
    >>> surae.write_bids("study", [surae.read("trial.csv")], surae.load("fit.json"))
    """
    labels = {"subject": subject, "task": task} | ({} if session is None else {"session": session})
    for what, label in labels.items():
        if not _LABEL.fullmatch(label):
            raise InputError(f"{what} {label!r}: a label of BIDS has letters and digits alone")
    if not recordings:
        raise InputError("no recording is given; a data set of EMG-BIDS is made of recordings")
    place = Path(root)
    who = f"sub-{subject}"
    folder = Path(who) if session is None else Path(who) / f"ses-{session}"
    stem = who if session is None else f"{who}_ses-{session}"
    texts: dict[str, str] = dict(_about_set(place, who))
    edfs: dict[str, Any] = {}
    cut: dict[str, float] = {}
    for number, recording in enumerate(recordings, 1):
        run = f"{stem}_task-{task}_run-{number:02d}"
        base = folder / "emg" / run
        edfs[f"{base}_emg.edf"], seconds, cut[f"{run}_emg.edf"] = _edf(recording)
        texts[f"{base}_emg.json"] = _json(_sidecar(recording, task, mains_hz, seconds))
        texts[f"{base}_channels.tsv"] = _tsv(_channels(recording))
    if fit is not None:
        derived = Path("derivatives") / "surae"
        texts[str(derived / "dataset_description.json")] = _json(_about_derivative())
        base = derived / folder / "emg" / f"{stem}_task-{task}_desc-surae"
        texts[f"{base}_parameters.tsv"] = _tsv(_parameters(fit))
        (place / base).parent.mkdir(parents=True, exist_ok=True)
        save_fit(place / f"{base}_fit.json", fit)
    for relative, text in texts.items():
        (place / relative).parent.mkdir(parents=True, exist_ok=True)
        write_atomic(place / relative, text)
    for relative, edf in edfs.items():
        edf.write(place / relative)
    written = [*texts, *edfs, *([] if fit is None else [f"{base}_fit.json"])]
    return BidsSet(shown(place), tuple(sorted(written)), cut)


def _about_set(place: Path, who: str) -> dict[str, str]:
    """What the whole set has; files that are there stay, but for the list of people."""
    described = {
        "Name": place.name,
        "BIDSVersion": VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "surae", "Version": __version__}],
    }
    readme = (
        "Ankle recordings: angle, torque and EMG, as EMG-BIDS by surae.\n\nAngle is positive in "
        "dorsiflexion, torque where the triceps surae pulls.\n"
    )
    wanted = {"dataset_description.json": _json(described), "README.md": readme}
    made = {name: text for name, text in wanted.items() if not (place / name).exists()}
    people = {who, *(each.name for each in place.glob("sub-*") if each.is_dir())}
    return made | {"participants.tsv": _tsv([("participant_id",), *((p,) for p in sorted(people))])}


def _about_derivative() -> dict[str, Any]:
    return {
        "Name": "surae",
        "BIDSVersion": VERSION,
        "DatasetType": "derivative",
        "GeneratedBy": [{"Name": "surae", "Version": __version__}],
        "SourceDatasets": [{"URL": "../.."}],
    }


def _unit(channel: Channel) -> tuple[str, float]:
    """What a channel is written in, and what it is multiplied by."""
    return _MICRO if channel.unit == "V" else (channel.unit, 1.0)


def _name(role: str, channel: Channel) -> str:
    """What a channel is called, as our CSV would; EDF has room for 16 letters."""
    return column_name(role, _unit(channel)[0])[:16]


def _edf(recording: Recording) -> tuple[Any, float, float]:
    """The EDF of a recording, the seconds it lasts, and those that were cut from its end."""
    edfio = library("edfio", "EMG-BIDS", "formats")
    channels = recording.signals
    starts = [c.time[0] for c in channels.values()]
    fastest = max(c.rate_hz for c in channels.values())
    if max(starts) - min(starts) > 1.0 / fastest:
        raise InputError(
            f"{recording.where}: its channels begin up to {max(starts) - min(starts):.3g} s apart, "
            "which EDF cannot say; prepare the recording first (surae convert --prepare)"
        )
    rates = {role: _rate(c) for role, c in channels.items()}
    seconds = min(len(c.time) / rates[role] for role, c in channels.items())
    record = _record({role: len(c.time) for role, c in channels.items()}, rates)
    kept = seconds
    if record is None:
        record = _CUT_S if all(float(_CUT_S * r).is_integer() for r in rates.values()) else 1.0
        kept = np.floor(seconds / record + 1e-9) * record
        if not kept > 0.0:
            raise InputError(f"{recording.where}: too short for EDF ({seconds:.3g} s)")
    signals = []
    for role, channel in channels.items():
        unit, factor = _unit(channel)
        values = factor * channel.values[: round(kept * rates[role])]
        signals.append(
            edfio.EdfSignal(
                np.ascontiguousarray(values),
                rates[role],
                label=_name(role, channel),
                physical_dimension=unit[:8],
                physical_range=_range(values),
            )
        )
    return edfio.Edf(signals, data_record_duration=record), kept, seconds - kept


def _rate(channel: Channel) -> float:
    """Sampling rate, whole where it nearly is [Hz]."""
    rate = channel.rate_hz
    return float(round(rate)) if abs(rate - round(rate)) < 1e-6 * rate else rate


def _record(counts: dict[str, int], rates: dict[str, float]) -> float | None:
    """Seconds of a data record that all of the recording fills; None where there are none."""
    n = set(counts.values())
    if len(n) > 1 or len(set(rates.values())) > 1:
        return None
    (size,) = n
    (rate,) = set(rates.values())
    most = int(_LONGEST * rate)
    for samples in range(min(most, size), int(_SHORTEST * rate), -1):
        seconds = samples / rate
        if size % samples == 0 and len(f"{seconds:.10g}") <= 8:
            return seconds
    return None


def _range(values: FloatArray) -> tuple[float, float]:
    """Ends of the calibration, which the header has room for."""
    low, high = float(values.min()), float(values.max())
    if high <= low:
        high = low + max(abs(low), 1.0)
    room = 1e-3 * (high - low)
    return _short(low - room, -1), _short(high + room, 1)


def _short(value: float, way: int) -> float:
    """A number of at most eight characters beyond another one."""
    for digits in range(6, 0, -1):
        for tried in (value, value + way * abs(value) * 10.0**-digits):
            text = f"{tried:.{digits}g}"
            if "e" in text:
                text = f"{tried:.{max(digits - 1, 0)}f}"
            if len(text) <= 8 and way * (float(text) - value) >= 0.0:
                return float(text)
    return value


def _sidecar(
    recording: Recording, task: str, mains_hz: float | None, seconds: float
) -> dict[str, Any]:
    """What the recording's JSON says."""
    emg = [c for role, c in recording.signals.items() if role.startswith("emg_")]
    envelope = recording.emg != "raw"
    return {
        "TaskName": task,
        "TaskDescription": recording.name,
        "EMGPlacementScheme": "Other",
        "EMGPlacementSchemeDescription": "Not stated in the recording.",
        "EMGReference": "Not stated in the recording.",
        "SamplingFrequency": max(map(_rate, emg or recording.signals.values())),
        "PowerLineFrequency": "n/a" if mains_hz is None else mains_hz,
        "SoftwareFilters": {"Envelope": {"Description": "EMG came as envelopes."}}
        if envelope
        else "n/a",
        "EMGChannelCount": len(emg),
        "RecordingDuration": seconds,
        "RecordingType": "continuous",
        "SoftwareVersions": f"surae {__version__}",
    }


def _channels(recording: Recording) -> list[tuple[str, ...]]:
    """The table of channels."""
    rows: list[tuple[str, ...]] = [
        ("name", "type", "units", "description", "sampling_frequency", "target_muscle")
    ]
    for role, channel in recording.signals.items():
        muscle = MUSCLE_NAMES.get(role.removeprefix("emg_"), "n/a")
        kind = "EMG" if role.startswith("emg_") else "MISC"
        words = channel.source or role.replace("_", " ")
        rows.append(
            (
                _name(role, channel),
                kind,
                _unit(channel)[0],
                " ".join(words.split()),
                f"{_rate(channel):g}",
                muscle,
            )
        )
    return rows


def _parameters(fit: AssessedFit) -> list[tuple[str, ...]]:
    """The fit's parameters with their intervals."""
    rows: list[tuple[str, ...]] = [
        ("name", "value", "units", "ci95_low", "ci95_high", "verdict", "description")
    ]
    for p in fit.assessment.parameters.values():
        low, high = ("n/a", "n/a") if p.ci95 is None else map(repr, map(float, p.ci95))
        rows.append((p.name, repr(float(p.value)), p.unit, low, high, str(p.verdict), p.meaning))
    return rows


def _json(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _tsv(rows: Sequence[Sequence[str]]) -> str:
    return "".join("\t".join(row) + "\n" for row in rows)
