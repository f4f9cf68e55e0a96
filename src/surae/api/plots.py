"""Plots of a fit for a notebook or a script: Matplotlib axes to go on with."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from surae.base.errors import InputError
from surae.base.working_folder import ignoring
from surae.inference import FitResult
from surae.inference.judging.assessed import Assessment

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from surae.report.traces import Traces

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Plots:
    """Plots of a fit: ``fit.plot()`` is all of a recording, its methods are one plot each.

    Each draws on the axes `ax`, or makes them, and returns them; recordings are numbered from 0.
    """

    result: FitResult  #: What was found.
    assessment: Assessment  #: What it is worth.

    def __repr__(self) -> str:
        names = ", ".join(
            f".{name}()"
            for name in dir(self)
            if not name.startswith("_") and callable(getattr(self, name))
        )
        return f"plots of a fit: call it, or {names}"

    def __call__(self, recording: int = 0) -> "Sequence[Axes]":
        """EMG, angle, torque and its parts against time, one below the other."""
        from surae.report.figures.torque import torque_figure

        traces = self._traces(recording)
        return list(torque_figure(traces, figure=_figure()).axes)

    def torque(self, recording: int = 0, *, ax: "Axes | None" = None) -> "Axes":
        """Measured and modelled torque against time."""
        from surae.report.figures.torque import draw_torque

        axes = axes_of(ax)
        traces = self._traces(recording)
        draw_torque((axes,), traces)
        axes.set_xlabel("Time [s]")
        return axes

    def parts(self, recording: int = 0, *, ax: "Axes | None" = None) -> "Axes":
        """What the modelled torque is made of, against time."""
        from surae.report.figures.torque import draw_parts

        axes = axes_of(ax)
        traces = self._traces(recording)
        draw_parts((axes,), traces)
        return axes

    def residuals(self, recording: int = 0, *, ax: "Axes | None" = None) -> "Axes":
        """Measured minus modelled torque against time."""
        from surae.report.figures import INK, dress, shade_excluded, trace

        traces = self._traces(recording)
        axes = axes_of(ax)
        dress(axes, "Measured − modelled [Nm]", "Time [s]")
        trace(axes, traces.time, traces.residual, color=INK, linewidth=0.7)
        shade_excluded(axes, traces.time, traces.excluded)
        return axes

    def film(self, recording: int = 0) -> "Sequence[Axes]":
        """A filmed fascicle beside the model's, over time and against force."""
        from surae.report.figures.tendon import film_figure

        traces = self._traces(recording)
        if not traces.films:
            raise InputError(f"{traces.name} has no film: map a channel such as fascicle_tib")
        return list(film_figure(traces, traces.films[0], _figure()).axes)

    def correlation(self) -> "Axes":
        """Correlations of the estimates as a map."""
        from surae.report.figures.research import correlation_figure

        of = self.assessment.covariance
        if not of.names:
            raise InputError("no estimate has a standard error: there is nothing to correlate")
        return correlation_figure(of.names, of.correlation, _figure()).axes[0]

    def _traces(self, recording: int) -> "Traces":
        from surae.report.traces import traces_of

        return numbered(traces_of(self.result), recording)


def numbered(recordings: Sequence[T], number: int) -> T:
    """The fit's first, second, … recording; a number that none has is refused."""
    if number not in range(len(recordings)):
        known = "only 0" if len(recordings) == 1 else f"0 … {len(recordings) - 1}"
        raise InputError(f"the fit has no recording {number!r}; they are numbered {known}")
    return recordings[number]


def _figure() -> "Figure":
    """A new figure that pyplot shows."""
    with ignoring("matplotlibrc"):
        from matplotlib import pyplot
    return pyplot.figure(layout="constrained")


def axes_of(given: "Axes | None") -> "Axes":
    """The axes to draw on, of a new figure where none are given."""
    if given is not None:
        return given
    figure = _figure()
    figure.set_size_inches(8.4, 3.6)
    return figure.subplots()
