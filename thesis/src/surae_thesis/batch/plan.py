"""What a batch computes: one call for each recording, fit, session and simulation.

A call is made of its label when it is handed out, so that a plan of many takes little room; all
that a label needs of other recordings is looked up by subject, so that it takes little time.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import chain
from typing import Any

from surae import FitSettings
from surae.base.records import to_plain
from surae_thesis.batch.files import NamedTrial
from surae_thesis.batch.work import Plain, Where
from surae_thesis.cohort.work import MODELS

#: Virtual legs whose simulations a standard error is compared with, as many trials as there are.
LEGS = 6
#: What a session is called where a recording has its protocol.
SESSION = "session"


@dataclass(frozen=True, slots=True)
class Batch:
    """Which recordings are fitted, by what; `read` says how they are read (mapping, corrections).

    Settings are by the model's name as it was given, then by what was fixed, in words.
    """

    trials: tuple[NamedTrial, ...]
    settings: Mapping[tuple[str, str], FitSettings]
    read: Mapping[str, Any]
    place: str = ""  #: Folder or URL that every FIT.json is kept in; empty: none is.
    sessions: bool = False  #: Whether all recordings of a subject are one session.
    #: "spectra": how those of repetitions differ, without a fit; "snsem": fits and the simulations
    #: that their standard errors are compared with, without predictions; empty: everything.
    only: str = ""
    _of: dict[str, list[NamedTrial]] = field(init=False, default_factory=dict, repr=False)
    _plain: dict[tuple[str, str], Plain] = field(init=False, default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        """Look up once what every call asks."""
        for trial in self.trials:
            self._of.setdefault(trial.subject, []).append(trial)
        self._plain.update({way: to_plain(settings) for way, settings in self.settings.items()})

    def where(self, trial: NamedTrial) -> Where:
        """How a recording is read."""
        return {"path": trial.path, **self.read}

    def labels(self) -> Iterator[Plain]:
        """What is computed, subject by subject."""
        if self.sessions:
            for subject in self._of:
                for model, fixed in self.settings:
                    about = {"subject": subject, "protocol": SESSION, "repetition": 0, "path": ""}
                    yield {"kind": "session", **about, "model": model, "fixed": fixed}
            return
        first: dict[str, list[NamedTrial]] = {}
        for several in self._of.values():
            begun = dict[str, int]()
            for trial in several:
                number = begun.get(trial.protocol, trial.repetition)
                begun[trial.protocol] = min(number, trial.repetition)
            for trial in several:
                if trial.repetition == begun[trial.protocol]:
                    first.setdefault(trial.protocol, []).append(trial)
                about = asdict(trial)
                if self.only != "snsem":
                    yield {"kind": "trial", **about}
                for model, fixed in self.settings:
                    yield {"kind": "fit", **about, "model": model, "fixed": fixed}
        yield from self._simulations(first)

    def _simulations(self, first: Mapping[str, Sequence[NamedTrial]]) -> Iterator[Plain]:
        """Those of the first repetitions of each protocol, by the thesis's models."""
        ways = {m: (m, fixed) for m, fixed in self.settings}
        for protocol, several in first.items():
            for model, way in ways.items():
                if self.settings[way].model not in MODELS.values():
                    continue
                for leg, trial in enumerate(several[:LEGS]):
                    label = {"kind": "simulation", "protocol": protocol, "model": model, "leg": leg}
                    yield {**label, "path": trial.path}

    def call(self, label: Plain) -> tuple[str, Plain]:
        """Function and keywords of what a label names, but for where its fit is kept."""
        where = {"path": label["path"], **self.read}
        if label["kind"] == "trial":
            return "trial_job", {"where": where}
        if label["kind"] == "simulation":
            model = next(s.model for (m, _), s in self.settings.items() if m == label["model"])
            given = {"settings": {"model": model}, "leg": label["leg"]}
            return "simulation_job", {"where": where, **given}
        settings = self._plain[label["model"], label["fixed"]]
        if label["kind"] == "session":
            each = [self.where(trial) for trial in self._of[label["subject"]]]
            return "session_job", {"name": label["subject"], "each": each, "settings": settings}
        of_subject = [] if self.only else self._of[label["subject"]]
        others = {t.name: self.where(t) for t in of_subject if t.path != label["path"]}
        return "fit_job", {"where": where, "settings": settings, "others": others}

    def paths(self, keywords: Plain) -> list[str]:
        """Files that a call reads."""
        one = [keywords["where"]] if "where" in keywords else keywords["each"]
        return [where["path"] for where in chain(one, keywords.get("others", {}).values())]

    def kept(self, label: Plain) -> Plain:
        """Where what a label names is kept, as a keyword; none where it is not."""
        if not self.place or label["kind"] not in ("fit", "session"):
            return {}
        words = [label["model"], *filter(None, label["fixed"].split(","))]
        way = "-".join(words).replace("/", "-")
        if label["kind"] == "session":
            return {"kept": [self.place, f"{label['subject']}/{way}"]}
        name = f"{label['subject']}/{label['protocol']}-{label['repetition']}.{way}.fit.json"
        return {"kept": [self.place, name]}


class Calls(Mapping[str, Plain]):
    """Keywords of `surae_thesis.batch.work.call` by key, made when they are asked for."""

    def __init__(self, batch: Batch, labels: Mapping[str, Plain]) -> None:
        self._batch = batch
        self._labels = labels

    def __getitem__(self, key: str) -> Plain:
        label = self._labels[key]
        function, keywords = self._batch.call(label)
        return {"function": function, "keywords": {**keywords, **self._batch.kept(label)}}

    def __iter__(self) -> Iterator[str]:
        return iter(self._labels)

    def __len__(self) -> int:
        return len(self._labels)


def text_of(batch: Batch, label: Plain, content: Mapping[str, str], program: str) -> str:
    """All that the result of a call depends on."""
    function, keywords = batch.call(label)
    files = [content[path] for path in batch.paths(keywords)]
    return json.dumps([program, function, keywords, *files])
