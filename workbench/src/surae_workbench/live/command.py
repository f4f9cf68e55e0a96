"""`surae live`."""

import os
from dataclasses import dataclass
from pathlib import Path

import click

from surae.base.errors import InputError
from surae.cli.option_records import as_record
from surae.cli.options import RANGE
from surae_workbench.options import Listening, server_options


@dataclass(frozen=True, slots=True)
class Rehearsal:
    """Whether and how a simulated leg stands in for a person."""

    rehearse: bool
    unattended: bool  #: Without a browser.
    trials: int
    seconds: float  #: Of each trial.
    faults: tuple[str, ...]
    seed: int  #: Whose leg it is.

    def __post_init__(self) -> None:
        if self.unattended and not self.rehearse:
            raise InputError("--unattended goes with --rehearse; leave it away, or add that")


@click.command("live")
@as_record(
    "rehearsal",
    Rehearsal,
    click.option("--rehearse", is_flag=True, help="Practise with a simulated manipulator and leg."),
    click.option("--unattended", is_flag=True, help="With --rehearse: no person and no browser."),
    click.option(
        "--trials",
        type=click.IntRange(1, 1000),
        default=1,
        show_default=True,
        metavar="N",
        help="With --unattended: how many.",
    ),
    click.option(
        "--seconds",
        type=click.FloatRange(1.0, 3600.0),
        default=35.0,
        show_default=True,
        metavar="S",
        help="With --unattended: how long each.",
    ),
    click.option(
        "--fault",
        "faults",
        multiple=True,
        metavar="KIND@SECONDS[@TRIAL]",
        help="With --unattended: a fault, e.g. electrode-off@12.",
    ),
    click.option(
        "--seed",
        type=click.IntRange(0),
        default=1,
        show_default=True,
        metavar="N",
        help="With --rehearse: whose leg it is.",
    ),
)
@click.option("--mapping", metavar="MAP.toml", help="Which channel of the streams is which signal.")
@click.option(
    "--device",
    metavar="NAME|FILE.toml|none",
    help="What moves the leg: its limits are watched.  [default: none; to rehearse, achilles]",
)
@click.option(
    "--range",
    type=RANGE,
    metavar="LOW:HIGH",
    help="Full plantarflexion and dorsiflexion of the subject, in rad or as 20deg.  "
    "[default: -0.9:0.6, as far as the device]",
)
@click.option(
    "--output",
    default="surae-live",
    show_default=True,
    metavar="DIR",
    help="Where the trials are kept.",
)
@server_options(8766)
@click.option("--watch", metavar="DIR", help="Files that appear in DIR are trials too.")
@click.option("--network", is_flag=True, help="Take streams of other computers too.")
def command(
    rehearsal: Rehearsal,
    mapping: str | None,
    device: str | None,
    range: tuple[float, float] | None,
    output: str,
    listening: Listening,
    watch: str | None,
    network: bool,
) -> None:
    """Record streams of the Lab Streaming Layer, show them, and judge every trial as it ends.

    DIR is made where it is missing; trials that are in it are kept. surae commands no motor and is
    no medical device: the manipulator's own safety applies.
    """
    if watch is not None and not Path(watch).is_dir():
        raise InputError(f"--watch {watch}: there is no such folder; make it first")
    from surae.api import open_mapping
    from surae_workbench.live.lsl import SESSION, lsl

    if mapping is not None:
        open_mapping(mapping)
    if rehearsal.rehearse:  # two rehearsals on one computer must not hear each other
        os.environ.setdefault(SESSION, f"rehearsal-{os.getpid()}")
    lsl(network and not rehearsal.rehearse)
    if device is None:
        device = "achilles" if rehearsal.rehearse else None
    elif device == "none":
        device = None
    if rehearsal.unattended:
        from surae_workbench.live.unattended import unattended as run_unattended

        run_unattended(
            output,
            trials=rehearsal.trials,
            seconds=rehearsal.seconds,
            faults=rehearsal.faults,
            mapping=mapping,
            leg=rehearsal.seed,
            joint=False,
            device=device,
            span=range,
        )
        return
    from surae_workbench.live.pages import serve
    from surae_workbench.web.server import Address

    serve(
        output,
        Address(listening.host, listening.port, listening.token, listening.open_browser),
        mapping=mapping,
        network=network,
        watch=watch,
        leg=rehearsal.seed if rehearsal.rehearse else None,
        device=device,
        span=range,
    )
