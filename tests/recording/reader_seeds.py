"""A small sound file of every format, and mutations of it: what the readers are fuzzed with."""

import io
import random
import re
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path

import h5py
import layouts
import layouts_more
import numpy as np
import program_files as files

from surae.base.errors import InputError
from surae.recording import Recording, read, write_hdf5
from surae.recording.channels import Scaling, channel
from surae.recording.formats import open_table
from surae.recording.recording import MUSCLES
from surae.recording.source import open_source
from surae.recording.table import load_each, sampling_of

N, RATE = 64, 100.0
TIME = np.arange(N) / RATE
ANGLE = 0.1 * np.sin(7 * TIME)
EMG = 1e-4 * np.random.default_rng(1).normal(size=(N, len(MUSCLES)))


def csv_file() -> bytes:
    head = b"# emg: raw\n# name: x\ntime_s,angle_rad,torque_Nm,emg_ta_V,note\n"
    return head + b"".join(b"%d.5,0.%d,%d,%de-6,%d\n" % (i, i, i, i, i) for i in range(5))


def tsv_file() -> bytes:
    return csv_file().replace(b",", b"\t")


def sto_file() -> bytes:
    return (
        b"ID\nversion=1\nnRows=3\ninDegrees=yes\nendheader\ntime\tankle_angle_r\tankle_moment\n"
        b"0.0\t1\t2\n0.1\t-3\t4e1\n0.2\t5\t-6\n"
    )


def trigno_file() -> bytes:
    label = "Label: {0} Sampling frequency: {1} Number of points: {2} start: 0 Unit: {3} "
    lines = [
        label.format("EMG 1", "1.0e+002", 8, "V") + "Domain Unit: s",
        label.format("ACC.X 1", "5.0e+001", 4, "g") + "Domain Unit: s",
        "Start Trigger Method: None",
        "",
        'X[s],"EMG 1",X[s],"ACC.X 1"',
    ]
    for i in range(8):
        slow = f"{i / 50},{i}.5" if i < 4 else ","
        lines.append(f"{i / 100},{i}e-6,{slow}")
    return ("\n".join(lines) + "\n").encode()


def xlsx_file() -> bytes:
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["Trial of today"])
    sheet.append(["time_s", "angle_rad", "torque_Nm", "note"])
    for time, angle in zip(TIME.tolist(), ANGLE.tolist(), strict=True):
        sheet.append([time, angle, 10 * angle, 1])
    buffer = io.BytesIO()
    book.save(buffer)
    return buffer.getvalue()


def hdf5_file() -> bytes:
    recording = Recording.from_arrays(TIME, ANGLE, ANGLE, EMG)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x"
        write_hdf5(path, recording)
        return path.read_bytes()


def mat73_file() -> bytes:
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", userblock_size=512) as file:
        for name, kind in (("Angle", "f8"), ("EMG_TA", "i2")):
            group = file.create_group(name)
            group.create_dataset("values", data=np.arange(N, dtype=kind)[None], compression="gzip")
            numbers = {"interval": 0.01, "start": 0.1, "scale": 2.0, "offset": 1.0}
            for key, number in numbers.items():
                group[key] = [[number]]
            group["units"] = np.array([[ord(letter)] for letter in "Deg"], dtype=np.uint16)
            group["units"].attrs["MATLAB_class"] = np.bytes_("char")
        file["t"], file["x"] = TIME[None], ANGLE[None]
    data = buffer.getvalue()
    return b"MATLAB 7.3 MAT-file".ljust(512) + data[512:]


def mat5_file(*, compressed: bool = False) -> bytes:
    import scipy.io

    buffer = io.BytesIO()
    spike2 = {"values": ANGLE, "interval": 0.01, "start": 0.5, "units": "Deg", "title": "Angle"}
    variables = {"Angle": spike2, "time": TIME, "torque": ANGLE, "emg": EMG, "fs": RATE}
    cells = np.empty((1, 2), dtype=object)
    cells[:] = [["a", 2.0]]
    scipy.io.savemat(buffer, {**variables, "notes": cells}, do_compression=compressed)
    return buffer.getvalue()


def c3d_file(*, floats: bool = True) -> bytes:
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [RATE / 2]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["heel"]
    file["parameters"]["ANALOG"]["RATE"]["value"] = [RATE]
    file["parameters"]["ANALOG"]["LABELS"]["value"] = ["Angle", "TA"]
    file["parameters"]["ANALOG"]["UNITS"]["value"] = ["deg", "V"]
    file["data"]["points"] = np.ones((4, 1, N // 2))
    file["data"]["analogs"] = np.stack([ANGLE, EMG[:, 0]])[None]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.c3d"
        file.write(str(path))
        data = path.read_bytes()
    return data if floats else integer_c3d()


def integer_c3d(
    processor: int = 84,
    counts: np.ndarray | None = None,
    *,
    floats: bool = False,
    first: int = 1,
    more: tuple[tuple[int, str, int, list[int], bytes], ...] = (),
) -> bytes:
    """A C3D file with two analog channels, two samples a frame, no points."""
    order = ">" if processor == 86 else "<"
    if counts is None:
        counts = np.arange(2 * N).reshape(N, 2) - 50

    def real(number: float) -> bytes:
        raw = struct.pack(f"{order}f", 4 * number if processor == 85 else number)
        return raw[2:] + raw[:2] if processor == 85 else raw

    def parameter(group: int, name: str, kind: int, shape: list[int], raw: bytes) -> bytes:
        body = bytes([kind & 255, len(shape), *shape]) + raw + b"\0"
        head = bytes([len(name), group]) + name.encode()
        return head + struct.pack(f"{order}h", len(body) + 2) + body

    def group(number: int, name: str) -> bytes:
        return (
            bytes([len(name), 256 - number]) + name.encode() + struct.pack(f"{order}h", 3) + b"\0"
        )

    def integers(*numbers: int) -> bytes:
        return struct.pack(f"{order}{len(numbers)}h", *numbers)

    frames = len(counts) // 2
    body = b"".join(
        [
            bytes([1, 80, 2, processor]),
            group(1, "POINT"),
            parameter(1, "USED", 2, [], integers(0)),
            parameter(1, "FRAMES", 2, [], integers(frames)),
            parameter(1, "DATA_START", 2, [], integers(4)),
            parameter(1, "RATE", 4, [], real(RATE / 2)),
            group(2, "ANALOG"),
            parameter(2, "USED", 2, [], integers(2)),
            parameter(2, "LABELS", -1, [5, 2], b"AngleEMG  "),
            parameter(2, "UNITS", -1, [3, 2], b"deguV "),
            parameter(2, "SCALE", 4, [2], real(0.5) + real(2.0)),
            parameter(2, "GEN_SCALE", 4, [], real(0.25)),
            parameter(2, "OFFSET", 2, [2], integers(10, -10)),
            parameter(2, "RATE", 4, [], real(RATE)),
            group(3, "TRIAL"),
            *(parameter(*parts) for parts in more),
            b"\0\0",
        ]
    ).ljust(1024, b"\0")
    header = struct.pack(f"{order}BB5H", 2, 80, 0, 4, first, first + frames - 1, 0)
    header += real(-1.0 if floats else 1.0) + struct.pack(f"{order}HH", 4, 2) + real(RATE / 2)
    if floats:
        data = b"".join(real(float(count)) for count in counts.ravel())
    else:
        data = counts.astype(f"{order}i2").tobytes()
    return header.ljust(512, b"\0") + body + data


def poly5_file(n: int = 50, per_block: int = 20, version: int = 203) -> bytes:
    """A pair of words, a float in uV, and a single word, counts to mV."""
    samples = np.zeros((-(-n // per_block), per_block), dtype=[("pair", "<f4"), ("word", "<i2")])
    flat = samples.reshape(-1)
    flat["pair"], flat["word"] = np.arange(len(flat)) - 3.5, np.arange(len(flat))
    blocks, size = len(samples), 6 * per_block
    magic = f"POLY SAMPLE FILEversion {version / 100:.2f}\r\n\x1a".encode().ljust(31, b"\0")
    magic += b"" if version == 203 else b"\0"
    head = struct.pack(
        "<H81phhBHi4x14xiHHH64x", version, b"x", 2048, 2048, 0, 3, n, blocks, per_block, size, 0
    )
    plain, counts = (0.0, 1.0, 0.0, 1.0), (-1.0, 1.0, -1000.0, 1000.0)
    signals = [(b"(Lo) EMG", b"uV", plain), (b"(Hi) EMG", b"uV", plain), (b"Aux", b"mV", counts)]
    described = b"".join(
        struct.pack("<41p4x11pffffH62x", name, unit, *ranges, i)
        for i, (name, unit, ranges) in enumerate(signals)
    )
    body = b"".join(bytes(86) + block.tobytes() for block in samples)
    return magic + head + described + body


def edf_file(*, binary: bool = False) -> bytes:
    import edfio

    kind, whole = (edfio.BdfSignal, edfio.Bdf) if binary else (edfio.EdfSignal, edfio.Edf)
    signals = [
        kind(100 * ANGLE[:60], 20, label="Angle", physical_dimension="deg"),
        kind(1e6 * EMG[:30, 0], 10, label="TA", physical_dimension="uV"),
    ]
    notes = [edfio.EdfAnnotation(0.5, None, "go")]
    return bytes(whole(signals, annotations=notes, data_record_duration=1).to_bytes())


def interrupted_edf() -> bytes:
    """The records of `edf_file` marked as interrupted, the last one 5 s late."""
    data = edf_file()
    data = data.replace(b"EDF+C", b"EDF+D", 1)
    assert data.count(b"+2\x14\x14") == 1
    return data.replace(b"+2\x14\x14", b"+7\x14\x14")


def xdf_chunk(tag: int, content: bytes) -> bytes:
    body = struct.pack("<H", tag) + content
    return b"\x04" + struct.pack("<I", len(body)) + body


def xdf_file(*, lost: int = 0, offset: float = 0.0, irregular: bool = False) -> bytes:
    """A stream of two channels (100 Hz, jittered), one of another clock, one of words."""
    rng = np.random.default_rng(2)
    streams = [
        (1, "EMG", "float32", 2, 0.0 if irregular else 100.0),
        (2, "Robot", "double64", 1, 50.0),
        (3, "Notes", "string", 1, 0.0),
    ]
    parts = [b"XDF:", xdf_chunk(1, b"<info><version>1.0</version></info>")]
    for number, name, kind, channels, rate in streams:
        each = "".join(
            f"<channel><label>c{i}</label><unit>microvolts</unit></channel>"
            for i in range(channels)
        )
        xml = (
            f"<info><name>{name}</name><type>x</type><channel_count>{channels}</channel_count>"
            f"<nominal_srate>{rate}</nominal_srate><channel_format>{kind}</channel_format>"
            f"<desc><channels>{each}</channels></desc></info>"
        )
        parts.append(xdf_chunk(2, struct.pack("<I", number) + xml.encode()))
    for at in (1000.0, 1005.0):
        parts.append(xdf_chunk(4, struct.pack("<Idd", 2, at, offset)))
    for first in range(0, N, 16):
        index = np.arange(first, first + 16)
        fast = 1000 + (index + (lost if first >= N // 2 else 0)) / 100 + rng.uniform(0, 2e-3, 16)
        body = struct.pack("<IBB", 1, 1, 16)
        body += b"".join(
            b"\x08" + struct.pack("<dff", t, i, -i) for t, i in zip(fast, index, strict=True)
        )
        parts.append(xdf_chunk(3, body))
        # The first sample has a stamp, the others follow at the stream's rate.
        body = struct.pack("<IBB", 2, 1, 8)
        for k, i in enumerate(index[:8]):
            i = first // 2 + k  # noqa: PLW2901
            stamp = b"\x00" if k else b"\x08" + struct.pack("<d", 1000 - offset + i / 50)
            body += stamp + struct.pack("<d", i)
        parts.append(xdf_chunk(3, body))
    parts.append(
        xdf_chunk(
            3, struct.pack("<IBB", 3, 1, 1) + b"\x08" + struct.pack("<d", 1000.1) + b"\x01\x02go"
        )
    )
    for number in (1, 2, 3):
        parts.append(
            xdf_chunk(6, struct.pack("<I", number) + b"<info><sample_count>1</sample_count></info>")
        )
    return b"".join(parts)


def first_lines(text: str, n: int = 60) -> bytes:
    """The beginning of a text."""
    return "".join(text.splitlines(keepends=True)[:n]).encode()


#: What every reader is fuzzed with, by the reader's name.
SEEDS: dict[str, tuple[Callable[[], bytes], ...]] = {
    "delimited": (csv_file, tsv_file),
    "layouts": (
        lambda: first_lines(layouts.biodex()),
        lambda: first_lines(layouts.openbci()),
        lambda: first_lines(layouts.rostopic()),
        lambda: first_lines(layouts.trials()),
    ),
    "spike2-text": (lambda: layouts_more.spike2(60).encode(),),
    "discover": (lambda: layouts.discover(slow=2, n=60).encode(),),
    "text-exports": (
        lambda: layouts.acqknowledge(60).encode(),
        lambda: layouts_more.acqknowledge_in_minutes(60).encode(),
        lambda: layouts.qualisys(60).encode(),
        lambda: layouts.anc(60).encode(),
    ),
    "text-uncounted": (
        lambda: layouts.labchart(60).encode(),
        lambda: layouts.opensignals(60).encode(),
        lambda: layouts_more.opensignals_two(60).encode(),
    ),
    "opensim": (sto_file,),
    "trigno": (trigno_file,),
    "hdf5": (hdf5_file,),
    "hdf5-plain": (lambda: layouts_more.grouped((0.0, 0.5)), layouts_more.nwb),
    "matlab73": (mat73_file,),
    "matlab5": (mat5_file, lambda: mat5_file(compressed=True)),
    "c3d": (c3d_file, integer_c3d, lambda: integer_c3d(85, floats=True)),
    "poly5": (poly5_file, lambda: poly5_file(version=204)),
    "edf": (edf_file, lambda: edf_file(binary=True), interrupted_edf),
    "excel": (xlsx_file,),
    "vicon": (files.vicon_file,),
    "lvm": (files.lvm_file, lambda: files.lvm_file(x_columns="One")),
    "tdms": (files.tdms_file,),
    "parquet": (files.parquet_file, lambda: files.parquet_file(feather=True)),
    "filelb": (lambda: files.flb_file(cases=2), lambda: files.flb_file(version=2, counts=True)),
    "acqknowledge": (files.acq_file,),
    "matlab-programs": (
        files.labchart_file,
        files.acqknowledge_mat,
        files.otbiolab_file,
        files.qualisys_file,
        files.nldat_file,
        lambda: files.matrix_mat(version73=True),
    ),
    "xdf": (xdf_file, lambda: xdf_file(offset=3.0, irregular=True)),
}
TEXT = (
    *("delimited", "opensim", "trigno", "vicon", "lvm"),
    *("layouts", "spike2-text", "discover", "text-exports", "text-uncounted"),
)

WORDS = (
    *(b"", b",", b";", b"\t", b"\n", b"\r", b'"', b"#", b"=", b"[", b"]", b"{", b".", b"-", b"_"),
    *(b"nan", b"inf", b"1e999", b"\0", b"\xff", b"\xc2\xb5", b"\xef\xbb\xbf", b"endheader\n"),
    *(b"time", b"angle_", b"channels.", b"9" * 400, b"0x", b"'''", b"\\u0000", b"\xe2\x80\xa8"),
)
#: Counts that are huge, negative or nothing, in the sizes in which files hold them.
NUMBERS = (
    *(bytes([byte]) * size for byte in (0, 127, 255) for size in (1, 2, 4, 8)),
    *(b"\xff\x7f", b"\x00\x80", b"\xff\xff\xff\x7f", b"\x00\x00\x00\x80", b"\x7f\xff\xff\xff"),
    *(
        b"\x00\x00\x80\x7f",
        b"\x00\x00\xc0\x7f",
        b"\x00" * 6 + b"\xf0\x7f",
        b"\x00" * 6 + b"\xf8\x7f",
    ),
    *(b"99999999", b"-1      ", b"nan     ", b"1e308   ", b"0       "),
)


def _rearranged(data: bytes, rng: random.Random) -> bytes:
    """A text with lines left out or exchanged, or two cells of a line exchanged."""
    lines = data.splitlines(keepends=True)
    if len(lines) < 3:
        return data
    at = rng.randrange(min(len(lines) - 1, rng.choice((12, len(lines)))))
    match rng.randrange(3):
        case 0:
            del lines[at : at + rng.choice((1, 1, 2, 20))]
        case 1:
            lines[at], lines[at + 1] = lines[at + 1], lines[at]
        case _:
            cells = re.split(rb"([,;\t])", lines[at].rstrip(b"\r\n"))
            if len(cells) > 4:
                one, other = (2 * rng.randrange(len(cells) // 2) for _ in range(2))
                cells[one], cells[other] = cells[other], cells[one]
                lines[at] = b"".join(cells) + b"\n"
    return b"".join(lines)


def mutated(data: bytes, rng: random.Random, *, text: bool) -> bytes:
    """The file with something wrong in it: cut, flipped, repeated, or with a huge number.

    Of a text also lines and cells are left out and exchanged.
    """
    if text and rng.random() < 0.3:
        return _rearranged(data, rng)
    for _ in range(rng.choice((1, 1, 2, 5))):
        # Most of what a reader believes stands at the beginning.
        reach = rng.choice((len(data), len(data), 512, 2048))
        start = rng.randrange(min(reach, len(data)) + 1)
        stop = min(len(data), start + rng.choice((0, 1, 1, 3, 20)))
        match rng.randrange(6 if text else 8):
            case 0 if text:
                data = data[:start] + rng.choice(WORDS) + data[stop:]
            case 0 | 6 | 7:
                number = rng.choice(NUMBERS)
                data = data[:start] + number + data[start + len(number) :]
            case 1:
                data = data[:start] + data[stop:]
            case 2:
                data = data[:start] + data[start:stop] * 2 + data[stop:]
            case 3:
                data = data[:start] if rng.random() < 0.3 else data
            case 4 if data:
                at = min(start, len(data) - 1)
                data = data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]
            case _:
                data = data[:start] + bytes([rng.randrange(256)]) + data[start + 1 :]
    return data


def exercise(path: Path) -> str:
    """Read a file in every way; "read" or "refused"; whatever isn't ours comes out."""
    outcome = "read"
    try:
        table = open_table(open_source(path))
        for signal in load_each(table, table.names).values():
            if not isinstance(signal, InputError):
                sampling_of(signal.time)
        for column in table.load(list(dict.fromkeys(table.names))).values():
            assert column.time.ndim == column.values.ndim == 1
            channel("angle", column, Scaling("rad"), table)
    except InputError as error:
        said(error)
        outcome = "refused"
    try:
        recording = read(path)
    except InputError as error:
        said(error)
    else:
        for signal in recording.channels.values():
            assert np.isfinite(signal.values).all()
            assert (np.diff(signal.time) > 0).all()
    return outcome


def said(error: InputError) -> None:
    """An error is one short printable line."""
    text = str(error)
    assert text.isprintable(), repr(text)
    assert len(text) < 1000, text
