"""Further layouts of the trial in `layouts`: exports of programs, and stores with groups."""

import io

import numpy as np
from layouts import ANGLE, DATA, EMG, MUSCLES, RATE, TIME, TORQUE, N, timed

#: What a data set of BIDS holds beside its recordings.
BIDS_NOTES = {
    "dataset_description.json": '{"Name": "x", "BIDSVersion": "1.10.0"}',
    "participants.tsv": "participant_id\tage\nsub-01\t30\n",
}


def spike2(n: int = N, emg_start: float = 0.25) -> str:
    """Spike2's text: channels one below the other, the interval rounded."""
    titles = ("Angle", "Torque", "TA", "SOL")
    units = ("deg", "Nm", "mV", "mV")
    signals = (ANGLE, TORQUE, EMG[:, 0], EMG[:, 2])
    lines = ['"INFORMATION"', '"x.smr"', '""', '""', "", '"SUMMARY"']
    for k, (title, unit) in enumerate(zip(titles, units, strict=True), start=1):
        lines.append(f'"{k}"\t"Waveform"\t"{title}"\t"{unit}"\t{RATE:g}\t{RATE:.6f}\t1\t0')
    lines += ['"31"\t"Marker"\t"Keyboard"', ""]
    for k, (title, unit, signal) in enumerate(zip(titles, units, signals, strict=True), start=1):
        start = emg_start if k > 2 else 0.0
        lines += [f'"CHANNEL"\t"{k}"', '"Waveform"', '"No comment"', f'"{title}"', ""]
        lines += [f'"{unit}"\t{RATE:g}', f'"START"\t{start:.5f}\t{1 / RATE:.4f}']
        lines += [f"{value:.6g}" for value in signal[:n]] + [""]
    return "\n".join(lines)


def acqknowledge_in_minutes(n: int = N) -> str:
    """AcqKnowledge's text with commas, a row of counts and times in minutes."""
    lines = ["x.acq", f"{1e3 / RATE:g} msec/sample", "6 channels"]
    lines += ["Angle", "deg", "Torque", "Nm"]
    lines += [line for muscle in MUSCLES for line in (muscle, "mV")]
    lines += ["min,CH1,CH2,CH3,CH4,CH5,CH6,", f",{n}" + f",{n}" * 5 + ","]
    lines += [
        f"{at / 60:.9g}," + ",".join(f"{x:.6g}" for x in row) + ","
        for at, row in zip(TIME[:n], DATA[:n], strict=True)
    ]
    return "\n".join(lines) + "\n"


def opensignals_two(n: int = N) -> str:
    """OpenSignals' text of two devices, whose labels were changed."""
    import json

    def device(labels, sensor):
        return {
            "column": ["nSeq", "DI", *(f"CH{k + 1}" for k in range(len(labels)))],
            "sensor": [sensor] * len(labels),
            "label": list(labels),
            "sampling rate": int(RATE),
        }

    about = {"AA": device(MUSCLES, "EMG"), "BB": device(["Ankle angle"], "GONIO")}
    lines = ["# OpenSignals Text File Format. Version 1", f"# {json.dumps(about)}", "# EndOfHeader"]
    for i in range(n):
        emg = "\t".join(f"{x:.6g}" for x in EMG[i])
        lines.append(f"{i % 64}\t0\t{emg}\t{i % 64}\t0\t{ANGLE[i]:.6g}\t")
    return "\n".join(lines) + "\n"


def openbci() -> str:
    """OpenBCI's text with its own names of channels and a formatted time stamp."""
    lines = ["%OpenBCI Raw EXG Data", "%Number of channels = 4", f"%Sample Rate = {RATE:g} Hz"]
    heads = ["Sample Index", *(f"EXG Channel {k}" for k in range(4))]
    lines.append(", ".join([*heads, "Timestamp", "Timestamp (Formatted)"]))
    for i in range(N):
        row = [f"{i % 256}", *(f"{1e3 * x:.6g}" for x in EMG[i]), f"{1.7e9 + TIME[i]:.6f}"]
        lines.append(", ".join([*row, f"2024-03-01 10:00:{TIME[i]:06.3f}"]))
    return "\n".join(lines) + "\n"


def grouped(starts, attribute="start_time") -> bytes:
    """HDF5 with a group for each device, whose attributes are rate and start."""
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as store:
        columns = ({"ankle_angle_deg": ANGLE, "ankle_torque_Nm": TORQUE}, {"emg_sol_mV": EMG[:, 2]})
        for name, start, each in zip(("robot", "emg"), starts, columns, strict=True):
            group = store.create_group(name)
            group.attrs["fs"] = RATE
            group.attrs[attribute] = start
            for column, values in each.items():
                group[column] = values
    return buffer.getvalue()


def nwb(start: float = 0.5) -> bytes:
    """NWB as pynwb lays it out: a file of attributes, time series with data and starting time."""
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as store:
        store.attrs["nwb_version"] = "2.6.0"
        store["session_start_time"] = "2024-03-01T10:00:00"
        series = {"ankle_angle": (np.deg2rad(ANGLE), "radians", 0.0, 1.0)}
        series["ankle_torque"] = (TORQUE, "N*m", 0.0, 1.0)
        series["emg_sol"] = (np.round(1e4 * EMG[:, 2]).astype("i2"), "volts", start, 1e-7)
        for name, (values, unit, begins, conversion) in series.items():
            group = store.create_group(f"acquisition/{name}")
            group.attrs["neurodata_type"] = "TimeSeries"
            data = group.create_dataset("data", data=values)
            data.attrs["unit"], data.attrs["conversion"], data.attrs["offset"] = (
                unit,
                conversion,
                0.0,
            )
            when = group.create_dataset("starting_time", data=begins)
            when.attrs["rate"], when.attrs["unit"] = RATE, "seconds"
    return buffer.getvalue()


def edf(*, binary=False, hour=(10, 0, 0), only=None) -> bytes:
    """EDF or BDF of whole seconds, all channels or those of `only`."""
    import datetime

    import edfio

    kind, whole = (edfio.BdfSignal, edfio.Bdf) if binary else (edfio.EdfSignal, edfio.Edf)
    seconds = int(N / RATE)
    units = ("deg", "Nm", *("uV",) * 4)
    names = ("angle", "torque", *MUSCLES)
    scales = (1.0, 1.0, *(1e3,) * 4)
    signals = [
        kind(scale * DATA[: int(seconds * RATE), k], RATE, label=name, physical_dimension=unit)
        for k, (name, unit, scale) in enumerate(zip(names, units, scales, strict=True))
        if only is None or name in only
    ]
    made = whole(signals, starttime=datetime.time(*hour), data_record_duration=1)
    return bytes(made.to_bytes())


def beside(style: str, n: int = 200) -> str:
    """Three trials side by side, told apart by a number in the names."""
    forms = {
        "number": lambda what, unit, k: f"{what} {k} ({unit})",
        "suffix": lambda what, unit, k: f"{what.replace(' ', '_')}_{unit}_{k}",
        "again": lambda what, unit, k: f"{what} ({unit})" + f".{k - 1}" * (k > 1),
        "before": lambda what, unit, k: f"Trial {k}: {what} ({unit})",
    }
    signals = (
        ("Ankle angle", "deg", ANGLE),
        ("Ankle torque", "Nm", TORQUE),
        ("SOL", "mV", EMG[:, 2]),
    )
    names = [forms[style](what, unit, k) for k in (1, 2, 3) for what, unit, _ in signals]
    columns = [x[(k - 1) * n : k * n] for k in (1, 2, 3) for *_, x in signals]
    return timed("Time (s)", TIME[:n], names, np.column_stack(columns))
