"""`surae demo`."""

import click

from surae import api
from surae.base.files import make_folder, shown, write_json
from surae.cli.fit import FitOutputs, judge_end, show_fitted
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice, work
from surae.cli.screen import show_line


@click.command("demo")
@click.option("--output", default="demo", show_default=True, metavar="DIR", help="Where to write.")
def command(output: str) -> None:
    """Fit an embedded virtual subject: protocol, noisy trial, fit, table and report.

    The subject's true parameters are known; they are written beside the fit, as true.json.
    """
    folder = make_folder(output)
    fitted, report, true = (str(folder / f) for f in ("fit.json", "report.html", "true.json"))
    check_outputs({"fit": fitted, "report": report, "true values": true}, ())

    subject = api.virtual_subject(seed=1)
    # The protocol that the thesis chose, on the device it was chosen for.
    achilles = api.named_device("achilles")
    protocol = api.Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.159, device=achilles
    )
    with work() as progress, compilation_notice():
        progress.describe("simulating a trial")
        trial = api.virtual_trial(subject, api.generate(protocol))
        result = api.fit(trial, progress=progress.starts)
    write_json(true, {"parameters": dict(subject.parameters)})
    show_fitted(result, FitOutputs(fitted, report))
    # the subject's tendons are rigid: of how far they stretch there is no true value
    true_values = subject.parameters
    intervals = {n: p.ci95 for n, p in result.parameters.items() if p.ci95 and n in true_values}
    inside = sum(low <= true_values[p] <= high for p, (low, high) in intervals.items())
    show_line(f"{inside} of {len(intervals)} true values lie in their 95 % interval: {shown(true)}")
    judge_end(result, fitted)
