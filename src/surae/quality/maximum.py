"""EMG against the maximum contractions that it was divided by."""

from collections.abc import Iterator, Sequence

from surae.base.words import Message
from surae.quality.finding import Finding, Quality, make_finding
from surae.quality.numeric import span_of
from surae.quality.registry import ordered
from surae.recording import MUSCLE_NAMES, MUSCLES
from surae.signals import ModelInputs
from surae.signals.normalise import largest_envelope

#: EMG may reach so many times its maximum: contractions differ from day to day by some tenths.
ABOVE = 1.2


def above_maximum(inputs: ModelInputs) -> Iterator[Finding]:
    """EMG that reaches more than its own maximum contraction, each muscle's."""
    reference = inputs.emg_reference
    if reference is None or reference.kind != "mvc":
        return
    for column, muscle in enumerate(MUSCLES):
        if muscle in inputs.missing_emg:
            continue
        reached = largest_envelope(inputs.emg[:, column], inputs.rate_hz)
        if reached > ABOVE:
            yield make_finding(
                "emg-above-mvc",
                f"emg_{muscle}",
                span_of(inputs.time),
                reached,
                muscle=Message(MUSCLE_NAMES[muscle]),
                percent=100.0 * reached,
            )


def with_maximum(quality: Sequence[Quality], inputs: Sequence[ModelInputs]) -> tuple[Quality, ...]:
    """Findings of recordings, with where their EMG is above its maximum.

    A recording that is fitted in parts has several inputs, of which the one that reaches most says
    it; parts are called after their recording.
    """
    made = []
    for each in quality:
        of_recording = [one for one in inputs if one.name.startswith(each.recording)]
        of_recording = of_recording or (list(inputs) if len(quality) == 1 else [])
        most: dict[str | None, Finding] = {}
        for finding in (f for one in of_recording for f in above_maximum(one)):
            before = most.get(finding.channel)
            if before is None or (before.value or 0.0) < (finding.value or 0.0):
                most[finding.channel] = finding
        kept = [f for f in each.findings if f.code != "emg-above-mvc"]
        findings = ordered([*most.values(), *kept])
        made.append(Quality(each.recording, findings, each.skipped))
    return tuple(made)
