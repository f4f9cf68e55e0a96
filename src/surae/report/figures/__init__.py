"""The figures of a report, each from plain data: the look that all share, and their bytes.

Importing this imports matplotlib, of which no ``matplotlibrc`` of the current folder is obeyed and
whose global state is left alone; nothing else of surae imports it first.
"""

import base64
import io
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from surae.base.files import PathLike, write_atomic
from surae.base.units import FloatArray
from surae.base.working_folder import ignoring
from surae.report.traces import min_max

with ignoring("matplotlibrc"):
    from matplotlib import rc_context
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes as Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure as Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.transforms import Bbox

__all__ = [
    "BLUE",
    "GREY",
    "GRID",
    "INK",
    "MUTED",
    "OCHRE",
    "RED",
    "WIDTH",
    "Axes",
    "Figure",
    "align",
    "data_url",
    "dress",
    "heading",
    "legend",
    "new_figure",
    "png",
    "shade_excluded",
    "shared_legend",
    "space",
    "svg",
    "trace",
    "write_figure",
]


#: Width of a figure [inch]: the printable width of A4 at 85 %.
WIDTH = 8.4
#: Pixels per inch of a raster figure.
DPI = 200

INK = "#1b1f24"
MUTED = "#57606a"
GRID = "#e3e6ea"
#: Dark, mid and light enough to be told apart without their hues.
BLUE = "#1f4e8c"
RED = "#a8321f"
OCHRE = "#b8860b"
GREY = "#a3abb5"

#: Room [inch] for a heading and for each entry of a legend beside it.
_HEADING = 2.0
_ENTRY = 0.85
#: Around panels over time [inch]: left of each, with a label of two lines and its numbers, right,
#: above and below; from an axis to its label, below and left of it.
_LEFT = 0.86
_RIGHT = 0.16
_ABOVE = 0.3
_BELOW = 0.46
_NUMBERS = (0.26, 0.5)
#: What labels of a column ask each axis of it for.
_ASKED = ("_update_ticks", "_get_ticklabel_bboxes")


def new_figure(
    height: float, *, width: float = WIDTH, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """An empty white figure; `height` and `width` in inches."""
    return Figure(figsize=(width, height), layout=layout, facecolor="white")


def space(figure: Figure, rows: int, columns: int = 1, between: float = 0.3) -> None:
    """Lay out a grid of panels over time by margins [inch], in a figure without a layout.

    To ask how far letters reach takes as long as to draw them: here it is known beforehand, as long
    as there is room for each legend `between` panels.
    """
    if figure.get_layout_engine() is not None:  # that of a window, which may get another size
        figure.align_ylabels()
        return
    width, height = figure.get_size_inches()
    high = (height - _ABOVE - _BELOW - between * (rows - 1)) / rows
    wide = (width - _RIGHT - _LEFT * columns) / columns
    figure.subplots_adjust(
        left=_LEFT / width,
        right=1.0 - _RIGHT / width,
        top=1.0 - _ABOVE / height,
        bottom=_BELOW / height,
        hspace=between / high,
        wspace=_LEFT / wide,
    )
    for axes in figure.axes:
        box = axes.get_position()
        axes.yaxis.set_label_coords(-_NUMBERS[1] / (box.width * width), 0.5)
        axes.xaxis.set_label_coords(0.5, -_NUMBERS[0] / (box.height * height))


def align(figure: Figure) -> None:
    """Lay a figure out and hold its axes' labels there, those of a column in line; at its end.

    The layout asks twice how far each axes' letters reach and each drawing asks again: they hold.
    """
    engine = figure.get_layout_engine()
    if figure.canvas.manager is not None:
        figure.align_ylabels()  # a window may get another size
    if figure.canvas.manager is not None or not isinstance(engine, ConstrainedLayoutEngine):
        return
    every = [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
    for axis in every:
        if not axis.label.get_text():
            axis.set_label_coords(0.5, 0.5)
    with _asked_once(every):
        for axes in figure.axes:
            if axes.get_aspect() == "auto":
                vars(axes)["get_tightbbox"] = _held(axes)
    engine.execute(figure)
    for axes in figure.axes:
        vars(axes).pop("get_tightbbox", None)
    figure.set_layout_engine("none")
    figure.align_ylabels()
    with _asked_once(every):
        for axis in every:
            if axis.label.get_text() and axis.get_tightbbox():
                x, y = axis.label.get_position()
                inside = axis.axes.transAxes.inverted().transform((x, y))
                there = (x, inside[1]) if axis.axis_name == "x" else (inside[0], y)
                axis.set_label_coords(*there)


@contextmanager
def _asked_once(every: Sequence[Axis]) -> Iterator[None]:
    """Ticks of axes that stay where they are: the labels of a column ask all of them in turn."""
    asked = [name for name in _ASKED if hasattr(Axis, name)]  # they are matplotlib's own
    for axis in every:
        vars(axis).update({name: _once(getattr(axis, name)) for name in asked})
    try:
        yield
    finally:
        for axis in every:
            for name in asked:
                vars(axis).pop(name, None)


def _once(function: Callable[..., Any]) -> Callable[..., Any]:
    """What a function gave when it was first asked."""
    given: list[Any] = []

    def asked(*arguments: Any) -> Any:
        if not given:
            given.append(function(*arguments))
        return given[0]

    return asked


def _held(axes: Axes) -> Callable[..., Bbox]:
    """Where an axes and its letters are, as far beyond it as they reach now."""
    around = axes.get_tightbbox(for_layout_only=True) or axes.bbox
    reach = around.get_points() - axes.bbox.get_points()
    return lambda *_given, **_named: Bbox(axes.bbox.get_points() + reach)


def dress(axes: Axes, ylabel: str, xlabel: str = "", *, grid: bool = True) -> None:
    """Give an axis its labels, quiet spines and a quiet grid."""
    axes.set_ylabel(ylabel, fontsize=9, color=INK)
    if xlabel:
        axes.set_xlabel(xlabel, fontsize=9, color=INK)
    axes.tick_params(labelsize=8, color=MUTED, labelcolor=INK, length=3, width=0.7)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[:].set(color=MUTED, linewidth=0.7)
    if grid:
        axes.grid(visible=True, color=GRID, linewidth=0.6)
        axes.set_axisbelow(True)


def heading(axes: Axes, text: str, pad: float | None = None) -> None:
    """A small bold title at the left, which leaves room for a legend."""
    axes.set_title(text, loc="left", fontsize=9, color=INK, weight="bold", y=1.0, pad=pad)


def card_legend(axes: Axes, columns: int = 2, size: float = 7, **more: Any) -> None:
    """A legend above the axis of a card's figure, from its left edge on."""
    axes.legend(
        frameon=False,
        fontsize=size,
        labelcolor=INK,
        loc="lower left",
        ncols=columns,
        bbox_to_anchor=(0.0, 1.0),
        **more,
    )


def legend(axes: Axes, columns: int) -> None:
    """A legend above the axis, where it hides no data: beside the heading, or below it."""
    room = float(axes.get_window_extent().width) / axes.figure.dpi
    narrow = room < _HEADING + _ENTRY * columns
    if narrow:
        columns = min(columns, int(room / _ENTRY))
    axes.legend(
        loc="lower left" if narrow else "lower right",
        bbox_to_anchor=(0.0 if narrow else 1.0, 1.0),
        ncols=columns,
        frameon=False,
        fontsize=7 if narrow else 8,
        labelcolor=INK,
        handlelength=1.8 if narrow else 3.0,
        borderaxespad=0.1,
        columnspacing=1.0 if narrow else 1.6,
    )
    if narrow and (text := axes.get_title(loc="left")):
        lines = -(-len(axes.get_legend_handles_labels()[0]) // columns)
        heading(axes, text, 5 + 12 * lines)


def trace(axes: Axes, time: FloatArray, values: FloatArray, label: str = "", **line: Any) -> None:
    """Draw a signal against time; a long one is thinned so that its peaks stay."""
    axes.plot(*min_max(time, values), label=label or "_", solid_joinstyle="round", **line)


def shade_excluded(axes: Axes, time: FloatArray, spans: Sequence[tuple[int, int]]) -> None:
    """Hatch the stretches, each from a first to a last sample, that a fit left out."""
    half = 0.5 * float(time[1] - time[0])
    for number, (first, last) in enumerate(spans):
        axes.axvspan(
            float(time[first]) - half,
            float(time[last]) + half,
            facecolor="none",
            edgecolor=GREY,
            hatch="////",
            linewidth=0,
            zorder=0.5,
            label="_" if number else "left out",
        )


def png(figure: Figure, dpi: int = DPI) -> bytes:
    """The figure as PNG of 256 colours: lines and letters need no more."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image  # matplotlib writes its own PNG with it

    figure.set_dpi(dpi)
    align(figure)
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()  # once: to save a figure draws it twice, and writes a file that is read again
    drawn = Image.frombytes("RGBA", canvas.get_width_height(), canvas.buffer_rgba())
    small = drawn.convert("RGB").quantize(256, Image.Quantize.FASTOCTREE)  # its white is 254
    small.putpalette([255 if level == 254 else level for level in small.getpalette() or ()])
    buffer = io.BytesIO()
    small.save(buffer, format="PNG", compress_level=6, dpi=(dpi, dpi))
    return buffer.getvalue()


def svg(figure: Figure) -> bytes:
    """The figure as SVG with its letters as outlines; equal figures give equal bytes."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    align(figure)
    buffer = io.StringIO()
    canvas: Any = FigureCanvasSVG(figure)
    with rc_context({"svg.hashsalt": "surae"}):  # else its names are drawn by lot
        canvas.print_svg(buffer, metadata={"Date": None, "Creator": None})
    return buffer.getvalue().encode()


def data_url(data: bytes, kind: str = "svg+xml") -> str:
    """An image as a page carries it within itself."""
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def pdf(figure: Figure) -> bytes:
    """The figure as PDF, its letters from embedded TrueType fonts; equal figures, equal bytes."""
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    buffer = io.BytesIO()
    canvas: Any = FigureCanvasPdf(figure)
    with rc_context({"pdf.fonttype": 42}):  # Type 3, its default, is refused by many journals
        canvas.print_pdf(buffer, metadata={"CreationDate": None, "Creator": None, "Producer": None})
    return buffer.getvalue()


def write_figure(path: PathLike, figure: Figure) -> None:
    """Write the figure as its file is named: ``.svg`` and ``.pdf`` are lines, all else is a PNG.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    kinds: dict[str, Callable[[Figure], bytes]] = {".svg": svg, ".pdf": pdf}
    write_atomic(path, kinds.get(Path(path).suffix.lower(), png)(figure))


def shared_legend(
    figure: Figure,
    panels: Sequence[Axes],
    columns: int,
    where: Literal["outside upper center", "outside lower center"] = "outside upper center",
) -> None:
    """One legend of all panels."""
    handles: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if handles:
        figure.legend(
            list(handles.values()),
            list(handles),
            loc=where,
            ncols=min(columns, len(handles)),
            frameon=False,
            fontsize=8,
            labelcolor=INK,
            handlelength=3.4,
            columnspacing=1.3,
        )
