"""Findings on another joint than the ankle."""

from dataclasses import replace

from surae.model.joint import Joint
from surae.quality.finding import Quality, Skipped
from surae.recording import MUSCLES

#: Checks with limits of the ankle, or by a quick fit that has its arms.
_ANKLES = (
    "angle-sign", "angle-still", "angle-units", "emg-unit", "film-unit", "reflex-suspected",
    "time-unit", "torque-artefact", "torque-offset", "torque-unit",
)  # fmt: skip


def of_joint(quality: Quality, joint: Joint) -> Quality:
    """Findings in a joint's words, but for those by the ankle's limits and of no muscle."""
    silent = {f"emg_{MUSCLES[channel]}" for channel in joint.silent}
    findings = tuple(
        replace(each, message=joint.worded(each.message), advice=joint.worded(each.advice))
        for each in quality.findings
        if each.code not in _ANKLES and each.channel not in silent
    )
    others = (skip for skip in quality.skipped if skip.check not in _ANKLES)
    skipped = (
        *(replace(skip, reason=joint.worded(skip.reason)) for skip in others),
        *(Skipped(code, "Its limits are known of the ankle alone.") for code in _ANKLES),
    )
    return replace(quality, findings=findings, skipped=skipped)
