"""What an inspection says of trials, of times and of signals that have no channel."""

from collections.abc import Iterator, Mapping

import numpy as np

from surae.base.files import shown
from surae.base.formatting import listed
from surae.recording.inspected_channels import InspectedChannel, Inspection
from surae.recording.roles import unit_is_volts, unit_kind
from surae.recording.source import open_source
from surae.recording.table import Clock, some
from surae.recording.trials import TrialsInFile
from surae.recording.unknown import export_of

#: Units of accelerometers, gyroscopes and thermometers, which are no angle and no torque.
_OTHER_UNITS = ("other", "angular_velocity", "angular_acceleration")
#: What is remarked of a column that does.
COUNTS = "counts the samples"


def not_one(trials: Mapping[str, TrialsInFile], clocks: Mapping[str, Clock]) -> Iterator[str]:
    """That a file holds several trials, and that its times are taken by their shape."""
    for each in dict.fromkeys(trials.values()):
        yield f"{each.text}: each is a recording; the mapping says trial = {each.line}"
    for clock in dict.fromkeys(clocks.values()):
        yield (
            f"column {clock.column!r} is offered as the time in {clock.unit}: {clock.rule}; the "
            "mapping says so"
        )


def no_shared_span(roles: Mapping[str, InspectedChannel]) -> Iterator[str]:
    """That channels have no time in common."""
    timed = [c for c in roles.values() if c.start_s is not None and c.end_s is not None]
    back = [c for c in timed if (c.end_s or 0.0) <= (c.start_s or 0.0)]
    if back:
        yield (
            f"the time of {some([c.column for c in back], 3)} ends at {back[0].end_s:.10g} s, "
            f"which is not after its begin, {back[0].start_s:.10g} s: it falls back; leave out the "
            "rows from there, or tell trials that follow each other apart by a column `trial`"
        )
    if len(timed) < 2 or back:
        return
    last = max(timed, key=lambda c: c.start_s or 0.0)
    first = min(timed, key=lambda c: c.end_s or 0.0)
    if (last.start_s or 0.0) >= (first.end_s or 0.0):
        yield (
            f"the channels share no span of time: {last.column!r} begins at {last.start_s:.10g} s, "
            f"when {first.column!r} has ended at {first.end_s:.10g} s; give start_s to one, when "
            "the other's clock shows its first sample"
        )


def other_starts(began: Mapping[str, str], roles: Mapping[str, InspectedChannel]) -> Iterator[str]:
    """That files whose channels are used began at other instants, as they say."""
    used = dict.fromkeys(channel.file for channel in roles.values())
    stated = {path: np.datetime64(began[path]) for path in used if began.get(path)}
    if len(stated) < 2 or len(set(stated.values())) < 2:
        return
    first = min(stated, key=lambda path: stated[path])
    last = max(stated, key=lambda path: stated[path])
    late = float((stated[last] - stated[first]) / np.timedelta64(1, "us")) * 1e-6
    yield (
        f"{shown(last)} says that it began {late:.6g} s after {shown(first)}, and each is read "
        f"from its own 0 s: if both clocks are right, start_s = {late:.6g} in each channel of the "
        "later one says so"
    )


def missing_signals(inspection: Inspection) -> Iterator[str]:
    """That angle or torque is missing; first what could be them."""
    why = {
        "angle": "no recording can be read without it",
        "torque": "nothing can be fitted without it",
    }
    used = {id(c) for c in inspection.roles.values()}
    used |= {id(c) for several in inspection.open.values() for c in several}
    rest = [c for c in inspection.channels if id(c) not in used and could_be(c)]
    missing = [role for role in why if role in inspection.missing]
    if (
        len(missing) == len(why)
        and not rest
        and any(r.startswith("emg_") for r in inspection.roles)
    ):
        yield (
            "angle and torque are missing: as a recording of maximum contractions EMG is enough "
            "(surae fit TRIAL --normalise mvc --mvc FILE); for a fit add the file that has them"
        )
        return
    if missing and rest:
        reasons = [f"{c.column!r}{_because(c)}" for c in rest[:6]]
        more = f" and {len(rest) - 6} more" if len(rest) > 6 else ""
        verb = "is" if len(missing) == 1 else "are"
        yield (
            f"{listed(missing)} {verb} none of the names that are known: if it is one of "
            f"{', '.join(reasons)}{more}, add [channels.{missing[0]}] with that column to the "
            "mapping; if it is none, its file is missing"
        )
    else:
        emg = any(role.startswith("emg_") for role in inspection.roles)
        for role in missing:
            alone = (
                " (as a recording of maximum contractions EMG is enough: surae fit TRIAL "
                "--normalise mvc --mvc FILE)"
            )
            yield f"{role} is missing: {why[role]}; add its file{alone * (emg and role == 'angle')}"


def if_among(inspection: Inspection) -> str:
    """Which channels without a role may be an EMG by their look or unit; empty where none may."""
    volts = [c.column for c in inspection.channels if could_be(c) and unit_is_volts(c.unit)]
    return f"; if one of them is among {some(volts, 4)}, name it in the mapping" if volts else ""


def could_be(channel: InspectedChannel) -> bool:
    """Whether a channel that has no role may be an angle or a torque."""
    no = ("not the ankle", COUNTS, "force plate")
    free = channel.guess is None and channel.alive and channel.usable
    free = free and unit_kind(channel.unit) not in _OTHER_UNITS
    return free and not any(text in channel.remark for text in no)


def _because(channel: InspectedChannel) -> str:
    """What speaks for a channel, or what its unit is."""
    if unit_is_volts(channel.unit):
        return f" (a sensor's volts: {channel.low:.3g} … {channel.high:.3g} {channel.unit})"
    if channel.low is None or channel.high is None:
        return ""
    unit = f" {channel.unit}" if channel.unit else ""
    return f" ({channel.low:.3g} … {channel.high:.3g}{unit})"


def nothing_mapped(inspection: Inspection) -> str:
    """One sentence on files of which no channel is, or could be, a signal."""
    files = ", ".join(map(shown, inspection.formats))
    likely = [
        said
        for path, form in inspection.formats.items()
        if form == "CSV" and (said := export_of(open_source(path)))
    ]
    names = some([channel.column for channel in inspection.channels])
    return "; ".join(
        [
            f"{files}: none of its columns is known as an angle, a torque or an EMG: {names}",
            *likely[:1],
            "name the columns after what they are (ankle angle, torque, EMG TA, with their units), "
            "or write a mapping with [channels.angle] and so on",
        ]
    )
