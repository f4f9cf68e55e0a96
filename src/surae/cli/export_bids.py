"""`surae export --to bids`: recordings as EMG-BIDS, the fit of them as a derivative."""

from dataclasses import dataclass

import click

from surae import api
from surae.base.errors import InputError
from surae.cli.option_records import as_record, refuse
from surae.cli.options import MAPPING, Typed, number
from surae.cli.screen import show_line


@dataclass(frozen=True, slots=True)
class BidsOptions:
    """What only a data set is told."""

    recordings: tuple[str, ...]  #: Files of the recordings that are written.
    mapping: str | None  #: A description of them.
    subject: str | None  #: Label of the person.
    task: str | None  #: Label of what was done.
    mains: float | None  #: Frequency of the mains [Hz].

    def refuse_for(self, to: str) -> None:
        """Refuse them where no data set is written."""
        given: dict[str, object] = {
            "--recording": bool(self.recordings),
            "--mapping": self.mapping is not None,
            "--subject": self.subject is not None,
            "--task": self.task is not None,
            "--mains": self.mains is not None,
        }
        refuse(given, to)


#: The options of a data set, as one argument `bids`.
bids_options = as_record(
    "bids",
    BidsOptions,
    click.option(
        "--recording",
        "recordings",
        multiple=True,
        metavar="REC",
        help="EMG-BIDS: a recording to write, as it was measured; may be repeated.",
    ),
    MAPPING,
    click.option("--subject", metavar="LABEL", help="EMG-BIDS: whose.  [default: 01]"),
    click.option("--task", metavar="LABEL", help="EMG-BIDS: which.  [default: ankle]"),
    click.option(
        "--mains",
        type=Typed(number),
        metavar="HZ",
        help="EMG-BIDS: frequency of the mains.  [default: not stated]",
    ),
)


def write_set(fitted: str, output: str | None, options: BidsOptions) -> None:
    """Write the data set, or join one that is there."""
    if output is None:
        raise InputError("--to bids: name the folder of the data set with --output")
    if not options.recordings:
        raise InputError("--to bids: name the recordings of the fit with --recording")
    fit = api.fit_of(fitted)
    made = api.write_bids(
        output,
        [api.read(path, mapping=options.mapping) for path in options.recordings],
        fit,
        subject=options.subject or "01",
        task=options.task or "ankle",
        mains_hz=options.mains,
    )
    show_line(repr(made))
