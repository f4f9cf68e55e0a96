"""What a trial is worth, said by a child process so that nothing else waits: first quickly."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from surae import api
from surae.api import (
    FitSettings,
    Quality,
    Recording,
    assess,
    commanded_file,
    make_problem,
    read,
    solve,
    write_hdf5,
)
from surae.base.errors import SuraeError
from surae.base.files import write_atomic
from surae.base.formatting import of_interval
from surae.base.frozen import read_only
from surae.base.names import LANGUAGES
from surae.base.words import N_, Message
from surae_workbench.live.record import counted

if TYPE_CHECKING:
    from surae.api import Finding, Measure, ParameterEstimate, Words

#: The model of the first answer: it takes a second. What is identified, the second answer says.
_QUICK = FitSettings.of("muscle", starts=3)
#: Angles at which a trial's or a leg's measures are read [deg].
_ANGLES = (0.0, 10.0)
#: What is said first of a leg.
_HEADLINES = (
    "end_stiffness",
    "end_torque",
    "relaxed_share@10s",
    "active_torque_max_tri@0deg",
    "active_torque_max_tib@0deg",
    "activation_half_time",
    "delay",
)
#: What is said of movement and of a fit, which a trial that holds still has no part in.
_OF_MOVEMENT = (
    "angle-still",
    "rom-not-covered",
    "trial-too-short",
    "position-steps",
    "overshoot",
    "active-not-active",
    "torque-sign",
    "torque-offset",
    "torque-artefact",
    "angle-sign",
)
#: Reasons against a fit that only say what effort would show.
_OF_EFFORT = ("at-bound", "emg-steady", "implausible")
_NOTHING = N_("Nothing to fit: {why}.")
_OPEN = N_("Alone it leaves open: {what}.")
_REFERENCE = N_("Kept: other trials’ efforts are a part of this one.")
_WORKED = N_(
    "The leg should have rested, and muscles worked: record it again relaxed, or keep it as it is."
)
_RESTED = N_(
    "The leg should have worked, and every muscle stayed relaxed: record it again with effort, or "
    "keep it as it is."
)


def warm() -> None:
    """Judge a made-up trial, so that the first real one waits for nothing to be compiled."""
    from surae.api import Protocol, generate, virtual_recording, virtual_subject
    from surae_workbench.live.xdf import XdfLog

    protocol = Protocol(profile="multiple-holds", task="active", duration=10.0, rate_hz=1024.0)
    channels = virtual_recording(virtual_subject(1), generate(protocol)).channels
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        log = XdfLog(place / "warm.xdf")
        described = "".join(
            f"<channel><label>{role}</label><unit>{channel.unit}</unit></channel>"
            for role, channel in channels.items()
        )
        log.stream(
            1,
            f"<info><name>w</name><channel_count>{len(channels)}</channel_count><nominal_srate>"
            "1024</nominal_srate><channel_format>double64</channel_format><desc><channels>"
            f"{described}</channels></desc></info>",
        )
        time = channels["angle"].time
        log.samples(1, time, np.column_stack([c.values for c in channels.values()]))
        log.clock(1, float(time[0]), 0.0)
        log.close()
        mapping = (f'[channels.{role}]\ncolumn = "w: {role}"\n' for role in channels)
        write_atomic(place / "map.toml", "".join(mapping))
        judge(str(log.path), str(place / "warm.h5"), mapping=str(place / "map.toml"))


def judge(
    file: str,
    output: str,
    earlier: Sequence[str] = (),
    mapping: str | None = None,
    efforts: Mapping[str, str] | None = None,
    target: str | None = None,
    begin: float = 0.0,
    instructed: str | None = None,
) -> dict[str, Any]:
    """Read, check and, where it moves, fit a trial; write it as our HDF5.

    `earlier` are recordings of the session's other trials: what is rest and what is effort shows in
    them. `mapping` is the file of the session's mapping, `target` that of what was asked for, which
    began at `begin` [s] from the first sample, the recording's time 0; `efforts` are those of the
    others by name, as `surae.session` takes them, `instructed` the one asked for here. Said is a
    `record.Judgement`; None for what there is not, with `why`.
    """
    recording = replace(read(file, mapping=mapping), name=Path(output).stem)
    if begin:  # times are those that the operator saw: from where the target began
        recording = replace(
            recording,
            channels={
                role: replace(channel, time=read_only(channel.time - begin))
                for role, channel in recording.channels.items()
            },
        )
    write_hdf5(output, recording)
    commanded = None if target is None else commanded_file(target)
    quality = api.check(recording, commanded=commanded)
    trial = _session([recording, *earlier], efforts)[recording.name]
    judged = trial.effort  # by the signals alone: what was asked for would be believed
    effort = counted(instructed, judged)
    if effort is not None and effort != judged:
        trial = _session([recording, *earlier], {**(efforts or {}), recording.name: effort})[
            recording.name
        ]
    if not trial.moves or trial.use == "nerve":
        quality = replace(
            quality, findings=tuple(f for f in quality.findings if f.code not in _OF_MOVEMENT)
        )
    if trial.use == "nerve":  # no model of muscles, which warnings are about
        quality = replace(
            quality, findings=tuple(f for f in quality.findings if f.severity == "error")
        )
    wrong = None
    if {instructed, judged} == {"passive", "active"}:
        wrong = _WORKED if instructed == "passive" else _RESTED
    judgement: dict[str, Any] = {
        "findings": quality.as_dict()["findings"],
        "seconds": max(float(c.time[-1] - c.time[0]) for c in recording.channels.values()),
        "use": trial.use,
        "effort_judged": judged,
        "effort": effort,
        "why": trial.problem or trial.why,
        "grade": None,
        "vaf": None,
        "reasons": [],
    }
    if trial.use == "fit":
        try:
            # What intervals would have to be widened by, which takes as long again, nobody asks.
            problem = make_problem(_QUICK.inputs([recording]), _QUICK)
            quick = assess(solve(problem), alternatives=False)
        except SuraeError as error:
            judgement |= {"use": "none", "why": str(error).replace(file, recording.name)}
        else:
            # A leg that rests tells nothing of what only effort shows, and need not.
            of_effort = _OF_EFFORT if effort == "passive" else ()
            against = [r for r in quick.adequacy.against if r.code not in of_effort]
            grave = any(reason.is_grave for reason in against)
            judgement |= {
                "grade": "inadequate" if grave else "doubtful" if against else "adequate",
                "vaf": quick.vaf,
                "reasons": list(dict.fromkeys(reason.plain for reason in against)),
            }
    rests = effort == "passive" and judgement["grade"] is not None
    rest = relaxed_of(recording) if rests else None
    if rest is not None:
        judgement |= by_rest(rest)
    advised = decided(quality, judgement, wrong)
    by_curve = {
        _.language: {"advice": advised.said(_), "leg": of_leg(rest.measures, _) if rest else []}
        for _ in map(api.words_in, LANGUAGES)
    }
    return judgement | {"verdict": advised.verdict, **by_curve.pop("en"), "translated": by_curve}


def relaxed_of(recording: Recording) -> api.Relaxed | None:
    """What a relaxed trial says of the leg by itself and without a model; None: nothing."""
    try:
        curve = api.relaxed(recording, angles=_ANGLES)
    except SuraeError:
        return None
    measures = any(m.value is not None for m in curve.measures.values())
    return curve if measures else None


def by_rest(curve: api.Relaxed) -> dict[str, Any]:
    """Grade and reasons of a relaxed trial: its curve’s, whatever a model of muscles says of it.

    A leg whose tissue no model has would else be measured again and again. A curve that is doubted
    asks for no repetition: what was met is to be looked at.
    """
    adequate = curve.curve.grade == "adequate"
    return {
        "grade": str(curve.curve.grade),
        "reasons": [] if adequate else [str(curve.findings[0])],
        "against_rest": None if adequate else curve.findings[0],
    }


@dataclass(frozen=True, slots=True)
class Advised:
    """One word on a trial, and what to do."""

    verdict: Literal["keep", "look", "repeat"]
    message: Message
    is_clause: bool = False  #: A reason, which is no sentence by itself.

    def said(self, _: "Words") -> str:
        """What to do, in a language."""
        return _.sentence(self.message) if self.is_clause else _(self.message)


def decided(quality: Quality, judgement: Mapping[str, Any], wrong: str | None = None) -> Advised:
    """What a trial is worth, and what to do.

    Doubts of the quick fit alone ask for no repetition: the joint fit of the session judges them.
    `wrong` is what the leg did other than it was asked to, where the trial is well otherwise.
    """
    reasons = _listed(judgement["reasons"])
    why = _message(judgement["why"])
    if errors := _said(quality, "error"):
        return Advised("repeat", errors[0])
    if judgement["use"] == "none":
        return Advised("repeat", why)
    if judgement["grade"] == "inadequate":
        return Advised("repeat", reasons, is_clause=True)
    if warnings := _said(quality, "warning"):
        return Advised("look", warnings[0])
    if (met := wrong or judgement.get("against_rest")) is not None:
        return Advised("look", _message(met))
    remark = Message(_OPEN, what=reasons) if reasons else reasons
    if judgement.get("effort") == "maximal":
        remark = Message(_REFERENCE)
    elif judgement["grade"] is None:
        remark = Message(_NOTHING, why=why)
    return Advised("keep", remark)


def _said(quality: Quality, severity: str) -> list[Message]:
    """What was found and what to do, causes first."""
    return [
        Message("{found} {advice}", found=each.message, advice=each.advice)
        for each in sorted(quality.findings, key=_causes_first)
        if each.severity == severity
    ]


def _causes_first(finding: "Finding") -> bool:
    """The hum of an electrode that came off is no second fault."""
    return finding.code != "electrode-off"


def _message(text: str) -> Message:
    """A text that may be in the catalogues."""
    return text if isinstance(text, Message) else Message(text)


def _listed(reasons: Sequence[str]) -> Message:
    """Reasons one after another; none are an empty message."""
    if not reasons:
        return Message("")
    first, *others = map(_message, reasons)
    return Message("{first}; {others}", first=first, others=_listed(others)) if others else first


def of_leg(measures: Mapping[str, "Measure"], _: "Words") -> list[str]:
    """What is known of a leg, stiffness first, and what is not, in sentences."""
    headlines = [m for name in _HEADLINES if (m := measures.get(name)) is not None]
    known = [m for m in headlines if str(m.verdict) in ("identified", "weak")]
    sentences = []
    for m in known:
        assert m.value is not None
        text = of_interval(m.value, m.ci95)
        weak = f"; {_('weak')}" if str(m.verdict) == "weak" else ""
        unit = m.unit.replace("Nm/deg", "Nm/°").replace("deg", "°")
        sentences.append(
            f"{_.measure(m.name)}: {_.number(text.value)} {unit} "
            f"(95 %: {_.number(text.interval)}{weak})."
        )
    unknown = [_.measure(m.name) for m in headlines if m not in known]
    lower = [text if _.language == "de" else text[:1].lower() + text[1:] for text in unknown]
    return [*sentences, *([_("Still unknown: {what}.", what="; ".join(lower))] if lower else [])]


def _session(
    recordings: Sequence[Recording | str], efforts: Mapping[str, str] | None
) -> api.Session:
    """The session of some recordings; of others, efforts are not told."""
    read_in = [_read(each) if isinstance(each, str) else each for each in recordings]
    names = {recording.name for recording in read_in}
    own_efforts = {name: effort for name, effort in (efforts or {}).items() if name in names}
    return api.session(read_in, efforts=own_efforts)


@lru_cache(maxsize=16)
def _read(file: str) -> Recording:
    """A trial of before, which nobody changes; its file is read once."""
    return read(file)


def together(
    recordings: Sequence[str],
    output: str,
    target: str,
    efforts: Mapping[str, str] | None = None,
    device: str | None = None,
    span: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """Fit all trials of the session jointly, as `surae.fit` does by itself.

    The fit goes to `output`, and what to measure next to `target`; `efforts` are as of `judge`,
    `device` and `span` as ``device`` and ``angle_range`` of `surae.measure_next`. Said are grade,
    vaf, reasons, parameters, measures; and next, sentences on what to measure next, which is
    `proposed`.
    """
    fit = _session(recordings, efforts).fit()
    fit.save(output)
    known = fit.adequacy.grade != "inadequate"
    measures = fit.measures(angles=_ANGLES)
    # what rest tells no model of muscles spoils
    told = {name: m for name, m in measures.items() if known or m.basis == "rest"}
    next_ = _next(fit, target, device, span)
    return {
        "translated": {
            _.language: {
                "reasons": [*dict.fromkeys(_(reason.plain) for reason in fit.adequacy.against)],
                "leg": of_leg(told, _),
                "next": _next_in(next_, _),
                "gains": [_(sentence) for sentence in next_["next"]],
            }
            for _ in map(api.words_in, LANGUAGES)
        },
        "grade": fit.adequacy.grade,
        "vaf": fit.vaf,
        "reasons": list(dict.fromkeys(reason.plain for reason in fit.adequacy.against)),
        "leg": of_leg(told, api.words_in("en")),
        "parameters": [_row(name, p) for name, p in fit.parameters.items()],
        "measures": [{**_row(name, m), "meaning": m.meaning} for name, m in measures.items()],
        **next_,
    }


def _row(name: str, estimate: "Measure | ParameterEstimate") -> dict[str, Any]:
    ci95 = estimate.ci95
    return {
        "name": name,
        "value": estimate.value,
        "unit": estimate.unit,
        "verdict": str(estimate.verdict),
        "ci95": None if ci95 is None else [float(end) for end in ci95],
    }


def _next(
    fit: api.Fit, target: str, device: str | None, span: tuple[float, float] | None
) -> dict[str, Any]:
    """What to measure next, in sentences, and what the trial is called; its target is written."""
    try:
        following = api.measure_next(
            fit, device=device, angle_range=None if span is None else (span[0], span[1])
        )
    except SuraeError as error:
        return {"next": [str(error)], "proposed": None}
    if following.trajectory is not None:
        following.write(target)
    return {"next": list(following.sentences), "proposed": following.protocol}


def _next_in(following: Mapping[str, Any], _: "Words") -> list[str]:
    """The same in a language, without what it is expected to tell of parameters."""
    if following["proposed"] is not None:
        ready = api.ready_protocols()[following["proposed"]]
        return [_("Measure {name} next.", name=ready.name), _(ready.description)]
    return [_(sentence) for sentence in following["next"]]


def tells(protocol: str, fit: str | None = None) -> list[str]:
    """What a trial will tell, as `surae.expect` says: of a fitted leg, else of usual ones."""
    expected = api.expect(protocol, fit=fit)
    if not isinstance(expected, api.Expectation):  # of tissue and reflex
        table = expected.as_table()
        rows = (
            f"{name}, if it is {value} {unit}: {interval}"
            for name, value, interval, unit, *_ in table.rows
        )
        return [*table.above, *rows, *table.below]
    by: dict[str, list[str]] = {}
    for p in expected.parameters.values():
        width = "" if p.half_width is None else f" ± {100 * p.half_width:.2g} %"
        by.setdefault(str(p.verdict), []).append(f"{p.meaning}{width}")
    return [
        f"Of {expected.legs}; {expected.asks}.",
        *(
            f"{words}: {'; '.join(by[verdict])}."
            for verdict, words in (
                ("identified", "Identified afterwards"),
                ("weak", "Weak"),
                ("undetermined", "Undetermined"),
            )
            if verdict in by
        ),
    ]
