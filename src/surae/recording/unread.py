"""Formats that are not read: each by its name, and how its program exports what is."""

from importlib.metadata import entry_points
from pathlib import Path

from surae.recording.source import Source

#: How files begin, at which byte, what they are and what to do.
_MAGIC: tuple[tuple[int, bytes, str, str], ...] = (
    (2, b"(C) CED", "Spike2", "File, Export As, MATLAB data"),
    (0, b"S64", "Spike2", "File, Export As, MATLAB data"),
    (0, b"CFWB", "LabChart", "File, Export, MATLAB"),
    (0, b"ABF", "pCLAMP", "File, Save As, text"),
    (0, b"\xd6\x91\x27\xc6", "Intan", "Intan's own converter to MATLAB"),
    (0, b"\xc1\x91\x27\xd6", "Intan", "Intan's own converter to MATLAB"),
    (0, b"NEURAL", "Blackrock", "NPMK's openNSx, then save as MATLAB"),
    (0, b"Brain Vision", "BrainVision", "Export, EDF+"),
    (0, b"\x93NUMPY", "a NumPy array", "numpy.savetxt, with a row of names"),
    (0, b"\x80\x04", "a Python pickle, which may run code", "DataFrame.to_parquet or to_csv"),
    (0, b"\x80\x05", "a Python pickle, which may run code", "DataFrame.to_parquet or to_csv"),
    (0, b"\x1f\x8b", "compressed with gzip", "unpack it first"),
    (0, b"PK\x03\x04", "a zip archive", "unpack it first"),
    (0, b"7z\xbc\xaf", "an archive", "unpack it first"),
    (0, b"Rar!", "an archive", "unpack it first"),
    (0, b"%PDF", "a PDF", "export the numbers instead"),
    (0, b"<?xml", "XML", "export CSV, C3D or MATLAB instead"),
    (0, b"<mvnx", "Xsens MVN", "export C3D, or Excel"),
)  # fmt: skip
#: What surae-formats reads, by how the names of these files end.
_INSTALLED = {
    ".xlsx": "Excel", ".xls": "Excel", ".ods": "OpenDocument", ".c3d": "C3D", ".edf": "EDF",
    ".bdf": "BDF", ".xdf": "XDF", ".mat": "MATLAB", ".poly5": "Poly5", ".acq": "AcqKnowledge",
    ".flb": "FILELB", ".lvm": "LabVIEW", ".tdms": "LabVIEW", ".parquet": "Parquet",
    ".feather": "Feather",
}  # fmt: skip
#: Programs by how the names of their binary files end.
_ENDINGS = {
    ".adicht": ("LabChart", "File, Export, MATLAB"),
    ".qtm": ("Qualisys Track Manager", "File, Export, to MAT file or C3D"),
    ".hpf": ("Delsys EMGworks", "its File Utility, CSV"),
    ".shpf": ("Delsys Trigno Discover", "Export, CSV"),
    **dict.fromkeys((".otb", ".otb+", ".otb4"), ("OT BioLab", "File, Export, MATLAB")),
    **dict.fromkeys((".x1d", ".x2d", ".system"), ("Vicon Nexus", "Export C3D, or ASCII")),
    **dict.fromkeys((".anb", ".trb"), ("Motion Analysis Cortex", "Export C3D")),
    **dict.fromkeys((".wdq", ".wdh"), ("WinDaq", "File, Save As, CSV")),
    ".ibw": ("Igor", "Data, Save Waves, delimited text"),
    ".bwapp": ("Biodex", "the research toolkit, ASCII"),
    ".rds": ("R", "write.csv"),
    ".mrx": ("Noraxon MR3", "Export, MATLAB or CSV"),
}


def named(source: Source) -> str:
    """What a file is that no reader takes, and how to export it; empty where it is not known."""
    ending = Path(source.path).suffix.lower()
    if ending in _INSTALLED and not entry_points(group="surae.readers", name="formats"):
        return (
            f"{source.shown}: {_INSTALLED[ending]} is read by the package surae-formats; install "
            'it with: pip install "surae[formats]"'
        )
    for at, magic, what, export in _MAGIC:
        if source.data.startswith(magic, at):
            return _said(source, what, export)
    if b"\0" in source.data[:65536]:
        known = _ENDINGS.get(ending)
        if known is not None:
            return _said(source, f"of {known[0]}", known[1])
    return ""


def _said(source: Source, what: str, export: str) -> str:
    return f"{source.shown}: this is {what}, which is not read here; to export it: {export}"
