"""Small files as programs of laboratories write them, made by the libraries that write them."""

import io
import struct
import tempfile
import warnings
from pathlib import Path

import numpy as np

N, RATE = 64, 100.0
TIME = np.arange(N) / RATE
ANGLE = 0.1 * np.sin(7 * TIME)
EMG = 1e-4 * np.random.default_rng(1).normal(size=(N, 4))
NAMES = ("Ankle Angle", "Ankle Torque", "TA", "GL", "SOL", "GM")
UNITS = ("deg", "Nm", "V", "V", "V", "V")
DATA = np.column_stack([np.degrees(ANGLE), 10 * ANGLE, EMG])


def lvm_file(*, x_columns: str = "No") -> bytes:
    lines = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Separator\tTab",
        "Decimal_Separator\t.",
        f"X_Columns\t{x_columns}",
        "***End_of_Header***\t",
        "\t",
        f"Channels\t{len(NAMES)}",
        "\t".join(("Samples", *[str(N)] * len(NAMES))),
        "\t".join(("Y_Unit_Label", *UNITS)),
        "\t".join(("X0", *["0.5"] * len(NAMES))),
        "\t".join(("Delta_X", *["0.01"] * len(NAMES))),
        "***End_of_Header***\t",
        "\t".join(("X_Value", *NAMES, "Comment")),
    ]
    for time, row in zip(TIME, DATA, strict=True):
        first = "" if x_columns == "No" else f"{time + 0.5:.4f}"
        lines.append("\t".join((first, *(f"{x:.7g}" for x in row), "")))
    return "\r\n".join(lines).encode() + b"\r\n"


def tdms_file() -> bytes:
    from nptdms import ChannelObject, TdmsWriter

    buffer = io.BytesIO()
    about = {"wf_increment": 0.01, "wf_start_offset": 0.5}
    with TdmsWriter(buffer) as writer:
        writer.write_segment(
            [
                ChannelObject("trial", name, DATA[:, i].copy(), {**about, "unit_string": UNITS[i]})
                for i, name in enumerate(NAMES)
            ]
        )
    return buffer.getvalue()


def parquet_file(*, feather: bool = False, clock: bool = False) -> bytes:
    import pyarrow as pa
    from pyarrow import feather as arrow_feather
    from pyarrow import parquet

    time = pa.array((TIME * 1e6).astype("i8"), pa.timestamp("us")) if clock else pa.array(TIME)
    fields = [pa.field("Timestamp" if clock else "Time", time.type)]
    fields += [
        pa.field(n, pa.float64(), metadata={"unit": u}) for n, u in zip(NAMES, UNITS, strict=True)
    ]
    table = pa.Table.from_arrays([time, *map(pa.array, DATA.T)], schema=pa.schema(fields))
    buffer = io.BytesIO()
    if feather:
        arrow_feather.write_feather(table, buffer, compression="uncompressed")
    else:
        parquet.write_table(table, buffer)
    return buffer.getvalue()


def flb_file(*, cases: int = 1, version: int = 4, counts: bool = False) -> bytes:
    def text(value: str) -> bytes:
        return struct.pack("<i", len(value)) + value.encode("latin-1")

    form = 2 if counts else 4
    whole = b""
    for _ in range(cases):
        head = struct.pack("<iii", version, 2, 1) if version > 2 else struct.pack("<i", version)
        whole += head + struct.pack("<iii", len(NAMES), N, form) + text("Time (s)")
        whole += struct.pack("<ff", 0.01, 0.5) + text("a trial") + b"".join(map(text, NAMES))
        whole += np.zeros(2 * len(NAMES)).tobytes()
        whole += DATA.T.astype("<i2" if counts else "<f4").tobytes()
    return whole


def vicon_file(*, delimiter: str = ",", first: int = 1) -> bytes:
    devices = ["", "", "Dyno - Angle", "Dyno - Force", "EMG - Voltage", "", "", ""]
    columns = ["Frame", "Sub Frame", "Angle", "Torque", "LTibA1", "LGasL2", "LSol3", "LGasM4"]
    lines = ["Devices", "100", *(delimiter.join(row) for row in (devices, columns))]
    lines.append(delimiter.join(("", "", *UNITS)))
    for k, row in enumerate(DATA):
        frame, sub = divmod(k, 4)
        lines.append(delimiter.join((f"{frame + first}", f"{sub}", *(f"{x:.7g}" for x in row))))
    markers = ["", "Trajectories", "25", ",,LANK,,", "Frame,Sub Frame,X,Y,Z", ",,mm,mm,mm"]
    lines += [line.replace(",", delimiter) for line in markers]
    lines += [delimiter.join((f"{k + first}", "0", "1", "2", f"{k}")) for k in range(N // 4)]
    return ("\r\n".join(lines) + "\r\n").encode("cp1252")


def _mat(variables) -> bytes:
    import scipy.io

    buffer = io.BytesIO()
    scipy.io.savemat(buffer, variables)
    return buffer.getvalue()


def cell(texts):
    made = np.empty((1, len(texts)), dtype=object)
    made[0, :] = texts
    return made


def letters(texts):
    return np.array([text.ljust(max(map(len, texts))) for text in texts])


def labchart_file() -> bytes:
    ends = N * np.arange(1, len(NAMES) + 1)[:, None]
    units = sorted(set(UNITS))
    return _mat(
        {
            "data": DATA.T.reshape(1, -1),
            "datastart": ends - N + 1.0,
            "dataend": ends * 1.0,
            "samplerate": np.full((len(NAMES), 1), RATE),
            "titles": letters(NAMES),
            "unittext": letters(units),
            "unittextmap": np.array([[units.index(unit) + 1] for unit in UNITS]),
        }
    )


def acqknowledge_mat() -> bytes:
    about = {"labels": letters(NAMES), "units": letters(UNITS)}
    return _mat({"data": DATA, "isi": 10.0, "isi_units": "ms", "start_sample": 0.0, **about})


def otbiolab_file() -> bytes:
    described = [f"{name} [{unit}]" for name, unit in zip(NAMES, UNITS, strict=True)]
    about = {"Description": cell(described), "SamplingFrequency": RATE}
    return _mat({"Data": DATA, "Time": TIME[:, None], **about})


def qualisys_file() -> bytes:
    analog = {
        "BoardName": "Delsys",
        "Labels": cell(NAMES),
        "NrOfSamples": float(N),
        "Frequency": RATE,
        "Data": DATA.T,
    }
    return _mat({"qtm_1": {"Frames": 16.0, "FrameRate": 25.0, "Analog": analog}})


def nldat_file() -> bytes:
    with warnings.catch_warnings():  # of pandas, which mat-io asks for its older texts
        warnings.simplefilter("ignore")
        from matio import save_to_mat
        from matio.utils import MatlabOpaque

    properties = {
        "dataSet": DATA,
        "domainIncr": np.array([[0.01]]),
        "domainStart": np.array([[0.5]]),
        "chanNames": cell([np.array([name]) for name in NAMES]),
        "chanUnits": cell([np.array([unit]) for unit in UNITS]),
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.mat"
        trial = MatlabOpaque(properties=properties, classname="nldat")
        save_to_mat(str(path), {"trial": trial}, version="v7")
        return path.read_bytes()


def matrix_mat(*, by_rows: bool = False, version73: bool = False, named: bool = True) -> bytes:
    emg = EMG.T if by_rows else EMG
    variables = {"time": TIME, "angle_rad": ANGLE, "torque_Nm": 10 * ANGLE, "emg": emg}
    if not version73:
        return _mat({**variables, **({"emg_names": cell(NAMES[2:])} if named else {})})
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        for name, values in variables.items():
            file[name] = values
        if named:
            file["emg"].attrs["labels"] = list(NAMES[2:])
            file["emg"].attrs["unit"] = ["V"] * 4
    return buffer.getvalue()


def acq_file(revision: int = 39) -> bytes:
    """AcqKnowledge's own format before version 4: headers, then samples channel after channel."""
    from bioread import headers as form

    def header(kind: type, **fields: object) -> bytes:
        made = kind.for_revision(revision, "<")
        filled = made._struct_class()
        for name, value in fields.items():
            setattr(filled, name, value)
        return bytes(filled)

    graph = header(
        form.GraphHeader,
        lVersion=revision,
        nChannels=6,
        dSampleTime=10.0,
        lExtItemHeaderLen=len(header(form.GraphHeader)),
    )
    length = len(header(form.ChannelHeader))
    channels = [
        header(
            form.ChannelHeader,
            lChanHeaderLen=length,
            nNum=k,
            nChanOrder=k,
            lBufLength=N,
            szCommentText=name.encode(),
            szUnitsText=unit.encode(),
            dAmplScale=1.0,
            nVarSampleDivider=1,
        )
        for k, (name, unit) in enumerate(zip(NAMES, UNITS, strict=True))
    ]
    foreign = header(form.ForeignHeader, nLength=len(header(form.ForeignHeader)))
    kinds = header(form.ChannelDTypeHeader, nSize=8, nType=1) * 6
    return b"".join([graph, *channels, foreign, kinds, DATA.astype("<f8").tobytes()])
