"""The table of the quality gate's codes, made of its registry at every build."""

from surae.quality import CHECKS, CODES

#: What the checks of the time axis and quick fits look for, which the registry lists by code alone.
_OTHERS = {
    "angle-sign": "an angle that is turned, by what a quick fit then explains",
    "angle-still": "a static hold",
    "torque-unit": "mNm, or kNm, for Nm",
    "emg-unit": "mV or µV for V, in one channel or all",
    "time-unit": "ms or µs for s",
    "time-gap": "samples that are missing",
    "time-jitter": "time stamps that scatter or go back",
    "samples-missing": "samples that are not numbers",
    "trial-too-short": "trials too short for the relaxation",
}
#: What to do, in a few words; the finding itself says it with the recording's own numbers.
ADVICE = {
    "emg-missing": "add the channel, or `--fixed g1=0` (its weight)",
    "emg-flat": "electrode and cable; leave that time out, or record again",
    "emg-clipped": "lower the amplifier's gain",
    "emg-offset": "take the offset away in the mapping; rest the muscle for an envelope",
    "emg-artefact": "fasten cable and electrode; `--exclude` that time, or `--robust`",
    "mains-hum": "reference electrode; cables away from power lines",
    "electrode-off": "fix the electrode, then record again",
    "electrode-lag": "the delay of that sensor, a wireless one above all",
    "emg-torque-lag": "how the devices are synchronised; shift the time of one file",
    "torque-limit": "less effort or slower motion",
    "torque-artefact": "look there; `--exclude` that time, or `--robust`",
    "torque-sign": "`sign = -1` for the torque, or for the angle if that is turned",
    "torque-offset": "zero the sensor with the empty footplate, or an `offset`",
    "angle-units": "the unit in the column's name or in the mapping; 0 is the foot at 90°",
    "rom-not-covered": "move through the subject's whole range",
    "position-steps": "record again, slower: the device lost its profile",
    "overshoot": "`surae protocol --device`, or a lower speed",
    "passive-not-passive": "repeat the passive part relaxed",
    "active-not-active": "ask for efforts in both directions, or fix what they would tell",
    "co-contraction": "one direction at a time; look for crosstalk",
    "reflex-suspected": "stretch more slowly, or [free a reflex](../models/drives.md)",
    "time-gap": "use a part without a gap",
    "time-jitter": "time from the device's sample counter, not the computer's clock",
    "samples-missing": "cut the recording to a part without them",
    "emg-kind": "`# emg: raw` or `# emg: envelope`, as it is",
    "angle-sign": "`sign = -1` for the angle",
    "angle-still": "record a trial that moves",
    "torque-unit": "the torque's `unit`",
    "emg-unit": "that channel's `unit`",
    "time-unit": "the unit of time in the column's name",
    "trial-too-short": "record longer, or fix `tau_rel` and `k_rel`",
}


def table() -> str:
    """A table in Markdown: every code, what it looks for, what to do.

    Raises
    ------
    ValueError
        The gate has a code that this page knows nothing of, or the other way round.
    """
    sought = {code: check.looks_for for check in CHECKS for code in check.codes} | _OTHERS
    if set(sought) != set(CODES) or set(ADVICE) != set(CODES):
        differ = set(CODES) ^ set(ADVICE) | set(CODES) ^ set(sought)
        raise ValueError(f"docs/_ext/quality_table.py does not fit the gate: {sorted(differ)}")
    rows = "".join(f"| `{code}` | {sought[code]} | {ADVICE[code]} |\n" for code in CODES)
    return "| code | looks for | what to do |\n|---|---|---|\n" + rows
