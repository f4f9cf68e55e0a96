"""One short trial of an ankle, and how laboratories lay it out in files."""

import csv
import io

import numpy as np

RATE = 500.0
N = 1000
TIME = np.arange(N) / RATE
ANGLE = 20.0 * np.sin(2 * np.pi * 0.7 * TIME)  # deg
TORQUE = 4.0 + 0.3 * ANGLE
_noise = np.random.default_rng(7).normal(size=(N, 4))
EMG = _noise * (0.005 + 0.1 * (np.sin(2 * np.pi * 0.9 * TIME) > 0.3))[:, None]  # mV
MUSCLES = ("TA", "GL", "SOL", "GM")
OURS = ("angle_deg", "torque_Nm", "emg_ta_mV", "emg_gl_mV", "emg_sol_mV", "emg_gm_mV")
THEIRS = ("Ankle angle (deg)", "Ankle torque (Nm)", *(f"{m} (mV)" for m in MUSCLES))
DATA = np.column_stack([ANGLE, TORQUE, EMG])


def text(
    names,
    columns,
    *,
    between=",",
    decimal=".",
    form="{:.6g}",
    above="",
    below="",
) -> str:
    """A table as text."""
    rows = [between.join(form.format(x) for x in row) for row in np.column_stack(columns)]
    body = "\n".join(rows).replace(".", decimal) + "\n"
    return f"{above}{between.join(names)}\n{body}{below}"


def timed(time_name="time_s", time=TIME, names=THEIRS, data=DATA, **how) -> str:
    """The trial with a column of times."""
    return text((time_name, *names), (time, data), form="{:.9g}", **how)


def trials(column="trial", labels=("1", "2", "3"), *, again=True) -> str:
    """Trials under each other, the time beginning again at 0 in each or going on."""
    rows = []
    for k, label in enumerate(labels):
        for i in range(0, N, 2):
            at = TIME[i] + (0.0 if again else k * (N / RATE))
            rows.append([label, f"{at:.6f}", *(f"{x + k:.6g}" for x in DATA[i])])
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([[column, "time_s", *OURS], *rows])
    return out.getvalue()


def discover(rate=RATE, slow=10, n: int = N) -> str:
    """What Trigno Discover exports, a slower accelerometer beside each EMG."""
    lines = [
        "Application:,Trigno Discover (1.7.0)",
        "Date/Time:,5/4/2023 10:11:12 AM",
        f"Collection Length (seconds):,{n / rate:g}",
        "".join(f"{m} (7592{k}),,,," for k, m in enumerate(MUSCLES)).rstrip(","),
        ",,,,".join(["sensor mode: 65"] * 4),
        ",".join(["EMG 1 Time Series (s),EMG 1 (mV),ACC X Time Series (s),ACC X (G)"] * 4),
        ",".join([f",{rate} Hz,,{rate / slow} Hz"] * 4),
        ",".join([f",{1 / rate} s,,{slow / rate} s"] * 4),
    ]
    for i in range(n):
        cells = []
        for k in range(4):
            acc = f"{TIME[i * slow]:.6f},{0.98 + 0.001 * (i % 3)}" if i * slow < n else ","
            cells.append(f"{TIME[i]:.6f},{EMG[i, k]:.6f},{acc}")
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def labchart(n: int = N) -> str:
    """LabChart's text with channel titles."""
    head = [
        f"Interval=\t{1 / RATE} s",
        "ExcelDateTime=\t4.4e4\t5/4/2023 10:11:12.345",
        "TimeFormat=\tStartOfBlock",
        "DateFormat=\t",
        "ChannelTitle=\tAngle\tTorque\tTA\tGL\tSOL\tGM",
        "Range=\t10 V\t10 V\t5 mV\t5 mV\t5 mV\t5 mV",
        "UnitName=\tdeg\tNm\tmV\tmV\tmV\tmV",
    ]
    rows = ["\t".join(f"{x:.7g}" for x in row) for row in np.column_stack([TIME, DATA])[:n]]
    return "\n".join([*head, *rows]) + "\n"


def acqknowledge(n: int = N) -> str:
    """AcqKnowledge's text with headers."""
    names = ("Angle", "Torque", *MUSCLES)
    units = ("deg", "Nm", "mV", "mV", "mV", "mV")
    about = [line for pair in zip(names, units, strict=True) for line in pair]
    head = ["trial.acq", f"{1e3 / RATE} msec/sample", "6 channels", *about]
    heads = ["sec", *(f"CH{k}" for k in range(1, 7))]
    counts = ["", *[f"{n} samples"] * 6]
    rows = ["\t".join(f"{x:.7g}" for x in row) for row in np.column_stack([TIME, DATA])[:n]]
    return "\n".join([*head, "\t".join(heads), "\t".join(counts), *rows]) + "\n"


def qualisys(n: int = N) -> str:
    """Qualisys' TSV of analog channels."""
    head = [
        f"NO_OF_SAMPLES\t{n}",
        "TOTAL_NO_OF_CHANS\t6",
        f"FREQUENCY\t{RATE:g}",
        "DESCRIPTION\t--",
        "CHANNEL_NAMES\tAngle\tTorque\tTA\tGL\tSOL\tGM",
    ]
    rows = ["\t".join(f"{x:.7g}" for x in row) for row in DATA[:n]]
    return "\n".join([*head, *rows]) + "\n"


def anc(n: int = N) -> str:
    """Motion Analysis' analog text."""
    head = [
        "File_Type:\tAnalog R/C ASCII\tGeneration#:\t1",
        "Board_Type:\tNational\tPolarity:\tBipolar",
        f"Trial_Name:\twalk\tTrial#:\t1\tDuration(Sec.):\t{n / RATE}\t#Channels:\t6",
        "BitDepth:\t16\tPreciseRate:\t500.0",
        "",
        "Name\tAngle\tTorque\tTA\tGL\tSOL\tGM",
        "Rate\t" + "\t".join(["500"] * 6),
        "Range\t" + "\t".join(["5000"] * 6),
    ]
    rows = ["\t".join(f"{x:.7g}" for x in row) for row in np.column_stack([TIME, DATA])[:n]]
    return "\n".join([*head, *rows]) + "\n"


def opensignals(n: int = N) -> str:
    """OpenSignals' text: JSON, then a count and the channels."""
    about = (
        '{"00:07": {"sensor": ["EMG", "EMG", "EMG", "EMG"], "label": ["A1", "A2", "A3", "A4"], '
        '"column": ["nSeq", "A1", "A2", "A3", "A4"], "sampling rate": 500, "resolution": [16]}}'
    )
    head = ["# OpenSignals Text File Format. Version 1", f"# {about}", "# EndOfHeader"]
    rows = ["\t".join([str(i % 16), *(f"{x:.6g}" for x in EMG[i])]) + "\t" for i in range(n)]
    return "\n".join([*head, *rows]) + "\n"


def openbci() -> str:
    """OpenBCI's text."""
    head = [
        "%OpenBCI Raw EXG Data",
        "%Number of channels = 4",
        "%Sample Rate = 500 Hz",
        "%Board = OpenBCI_GUI$BoardGanglion",
    ]
    names = ", ".join(["Sample Index", *(f"EXG Channel {k}" for k in range(4))])
    rows = [", ".join([f"{i % 200}.0", *(f"{x:.6g}" for x in EMG[i])]) for i in range(N)]
    return "\n".join([*head, names, *rows]) + "\n"


def biodex() -> str:
    """Biodex' text: three lines, names, units, columns apart by white space."""
    head = ["Ankle Plantar/Dorsiflexion", "Right", "Passive 60", ""]
    names = f"{'TIME':>10}{'TORQUE':>10}{'POSITION':>10}{'POS (ANAT)':>12}{'VELOCITY':>10}"
    units = f"{'mSec':>10}{'N-M':>10}{'Degrees':>10}{'Degrees':>12}{'DEG/SEC':>10}"
    rows = [
        f"{1e3 * TIME[i]:10.0f}{TORQUE[i]:10.1f}{ANGLE[i] + 90:10.1f}{ANGLE[i]:12.1f}{0.0:10.1f}"
        for i in range(0, N, 5)
    ]
    return "\n".join([*head, names, units, *rows]) + "\n"


def rostopic() -> str:
    """What rostopic echo -p prints: times in ns since 1970."""
    names = ["%time", "field.header.seq", "field.ankle_angle", "field.ankle_torque"]
    names += [f"field.emg_{m.lower()}" for m in MUSCLES]
    begin = 1_683_187_872_000_000_000
    rows = [
        ",".join([str(begin + round(1e9 * TIME[i])), str(i), *(f"{x:.6g}" for x in DATA[i])])
        for i in range(N)
    ]
    return ",".join(names) + "\n" + "\n".join(rows) + "\n"
