"""What a command shows: tables on stdout, progress and notices on stderr."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from surae.api import Fit
from surae.assessment import ParameterEstimate, Prediction, Verdict

_STYLES = {
    Verdict.IDENTIFIED: "green",
    Verdict.WEAK: "yellow",
    Verdict.AT_BOUND: "red",
    Verdict.FIXED: "dim",
}


def console() -> Console:
    """Where results go: the terminal's width, or enough for a table in a file."""
    return Console() if sys.stdout.isatty() else Console(width=120)


def notice_compilation() -> None:
    """Say why the first run is slow, before it is."""
    from surae.model.jit import is_warm

    if not is_warm():
        print("Compiling the model, once for this installation: about half a minute …",
              file=sys.stderr, flush=True)  # fmt: skip


@contextmanager
def fit_progress() -> Iterator[Callable[[int, int, float], None]]:
    """A bar over the starts of a fit, on a terminal only."""
    columns = (
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(),
    )  # fmt: skip
    visible = sys.stderr.isatty()
    with Progress(
        *columns, console=Console(stderr=True), transient=True, disable=not visible
    ) as bar:
        task = bar.add_task("fitting, starts", total=None)

        def update(done: int, total: int, best: float) -> None:
            bar.update(task, completed=done, total=total,
                       description=f"fitting, best sum {best:.4g} Nm², starts")  # fmt: skip

        yield update


def show_fit(fit: Fit) -> None:
    """Parameters with intervals and verdicts, and how well the torque is followed."""
    out = console()
    problem = fit.result.problem
    table = Table(box=box.SIMPLE_HEAD, title=f"{problem.spec.title}", title_justify="left",
                  pad_edge=False)  # fmt: skip
    table.add_column("parameter", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("95 % interval", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    table.add_column("why", overflow="fold")
    for p in fit.parameters.values():
        style = _STYLES[p.verdict]
        table.add_row(p.name, f"{p.value:.5g}", _interval(p), p.unit,
                      Text(str(p.verdict), style=style), p.note)  # fmt: skip
    out.print(table)
    for quality in fit.assessment.recordings:
        out.print(f"{quality.name}: VAF {quality.vaf:.2f} %, RMSE {quality.rmse:.3g} Nm, "
                  f"{quality.n} samples at {quality.rate_hz:g} Hz", highlight=False)  # fmt: skip
    if len(fit.assessment.recordings) > 1:
        out.print(f"all together: VAF {fit.vaf:.2f} %", highlight=False)
    ipde = "none" if fit.ipde is None else f"{fit.ipde:.2f}"
    note = f" ({fit.assessment.ipde_note})" if fit.assessment.ipde_note else ""
    out.print(f"IPDE {ipde}{note}", highlight=False)
    out.print(f"{fit.status}: {fit.message} ({fit.result.seconds:.2f} s)", highlight=False)


def show_predictions(predictions: tuple[Prediction, ...]) -> None:
    """How well recordings are predicted."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("recording", overflow="fold")
    for heading in ("VAF [%]", "RMSE [Nm]", "bias [Nm]"):
        table.add_column(heading, justify="right", no_wrap=True)
    for one in predictions:
        table.add_row(one.name, f"{one.vaf:.2f}", f"{one.rmse:.3g}", f"{one.bias:.3g}")
    console().print(table)


def _interval(p: ParameterEstimate) -> str:
    return "–" if p.ci95 is None else f"{p.ci95[0]:.4g} … {p.ci95[1]:.4g}"


def stopwatch() -> Callable[[], float]:
    """Seconds since this call."""
    begin = time.perf_counter()
    return lambda: time.perf_counter() - begin
