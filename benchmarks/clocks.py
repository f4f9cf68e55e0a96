"""What a check says of clocks that were put wrong: found, named rightly, intervals that hold.

    python benchmarks/clocks.py --seed 9502 --families abcdhopruvw

Legs are of the generator `ankle_legs`, which shares nothing with the model that is fitted. The
EMG's, the torque's or the angle's stamps run fast or slow, or are late or early; the truth of a
lag of the EMG is what is said of the leg as it is, plus what was put in.
"""

import argparse
import re
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

import surae
from ankle_legs.make import make
from surae.base.frozen import read_only
from surae.inference.diagnosis.clocks import estimated_clock
from surae.inference.diagnosis.moving import moved
from surae.inference.diagnosis.quick import quick_fit
from surae.quality.trial import signals_of
from surae.recording import Recording

STREAMS = ("emg", "torque", "angle")
RATES = (0.001, -0.001, 0.002, -0.002, 0.004)
LAGS = (-0.3, -0.2, -0.15, 0.15, 0.2, 0.3)
_ENDS = re.compile(r"\(([\d.]+) to ([\d.]+)\)")


def put_wrong(recording: Recording, stream: str, rate: float, late: float) -> Recording:
    """The recording with the stamps of a stream from another clock."""
    channels = {
        role: replace(c, time=read_only(c.time * (1.0 + rate) + late))
        if role.startswith(stream)
        else c
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


def emg_lag(recording: Recording, near: float = 0.0) -> tuple[float, float] | None:
    """Lag of the EMG [s] and its standard error, looked for near one."""
    signals = moved(signals_of(recording), near, 0.0)
    fit = quick_fit(recording, signals)
    found = None if fit is None else estimated_clock(recording, signals, fit, hinted=False)
    return None if found is None else (near + found.lag, found.lag_sem)


def main() -> None:
    """Count, and print a line a stream and what was put in."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=9502)
    parser.add_argument("--families", default="abcdhopruvw")
    asked = parser.parse_args()
    counts: dict[str, Counter[str]] = {}
    for family in asked.families:
        with tempfile.TemporaryDirectory() as folder:
            leg = surae.read(make(family, asked.seed, Path(folder))[0])
        _count(counts.setdefault("clean", Counter()), leg, "", 0.0)
        for stream in STREAMS:
            for rate in RATES:
                wrong = put_wrong(leg, stream, rate, 0.0)
                own = counts.setdefault(f"{stream} {abs(1e3 * rate):g} ms/s", Counter())
                _count(own, wrong, f"{stream}-clock", rate)
            for late in LAGS if stream != "emg" else ():
                wrong = put_wrong(leg, stream, 0.0, late)
                own = counts.setdefault(f"{stream} {abs(1e3 * late):g} ms", Counter())
                _count(own, wrong, f"angle-torque-lag:{stream}", late)
        _of_emg(counts.setdefault("emg lag, interval", Counter()), leg)
        for what, own in counts.items():
            print(family, what, dict(own), flush=True)


def _count(own: Counter[str], recording: Recording, right: str, truth: float) -> None:
    """One recording, what is said of its clocks, and whether that is right."""
    own["n"] += 1
    code, _, stream = right.partition(":")
    for finding in surae.check(recording).findings:
        if not finding.code.endswith("-clock") and finding.code != "angle-torque-lag":
            continue
        if finding.code != code or (stream and finding.channel != stream):
            own["false"] += 1
            continue
        own["found"] += 1
        low, high = (float(end) for end in _ENDS.findall(finding.message)[0])
        same_way = (finding.value or 0.0) * truth > 0.0
        own["hold"] += same_way and low - 0.05 <= abs(1e3 * truth) <= high + 0.05


def _of_emg(own: Counter[str], leg: Recording) -> None:
    """Whether the interval of the EMG's lag holds what was put in beside what is there."""
    there = emg_lag(leg)
    for late in LAGS if there is not None else ():
        found = emg_lag(put_wrong(leg, "emg", 0.0, late), late)
        if found is None or there is None:
            continue
        own["n"] += 1
        off = found[0] - there[0] - late
        own["hold"] += abs(off) <= 1.96 * (found[1] ** 2 + there[1] ** 2) ** 0.5


if __name__ == "__main__":
    main()
