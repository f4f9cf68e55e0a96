"""How often the quality gate finds faults that were planted, and faults that are not there.

Virtual recordings of healthy subjects and patients, of several protocols, as raw EMG at 2048 Hz and
as envelopes at 256 Hz, without and with each fault. Run it as

    .venv/bin/python benchmarks/quality.py [--first 100000] [--count 100] [--only CODE]

`--first` is the seed of the first recording: thresholds were set on seeds below 60,000.
"""

import argparse
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from surae.base.frozen import read_only
from surae.inference.diagnosis import examined
from surae.protocol import Protocol, Trajectory, generate, named_device
from surae.protocol.effort import effort, named_task
from surae.recording import MUSCLES, Recording
from surae.studies import virtual_subject, virtual_trial
from surae.studies.imperfections import Imperfections, raw_emg, realistic_imperfections
from surae.studies.virtual import virtual_recording

#: Profile, chirp amplitude [rad], whether adapted to the device.
MOTIONS = (
    ("multiple-holds", 0.0, False),
    ("multiple-holds", 0.2, True),
    ("multiple-holds", 0.2, False),
    ("multi-sine-holds", 0.0, False),
    ("multi-sine-holds", 0.2, True),
    ("multi-sine", 0.0, False),
    ("ramp-and-hold", 0.0, False),
    ("scaled-chirp", 0.1, False),
    ("sine", 0.0, False),
)
RAW, ENVELOPE = 2048.0, 256.0


@dataclass
class Signals:
    """A recording as arrays that a fault may change."""

    time: np.ndarray
    angle: np.ndarray
    torque: np.ndarray
    emg: np.ndarray
    raw: bool
    trajectory: Trajectory
    rng: np.random.Generator
    drop: tuple[str, ...] = ()

    @property
    def rate(self) -> float:
        """Samples per second, as meant."""
        return RAW if self.raw else ENVELOPE

    @property
    def recording(self) -> Recording:
        """As it is read from a file."""
        kind = "raw" if self.raw else "envelope"
        made = Recording.from_arrays(
            self.time, self.angle, self.torque, self.emg, emg_kind=kind, name="virtual"
        )
        channels = {r: c for r, c in made.channels.items() if r not in self.drop}
        return replace(made, channels=channels)


@lru_cache(64)
def trajectory(profile: str, task: str, chirp: float, adapted: bool, rate: float) -> Trajectory:
    """A protocol, with its chirp at the thesis's rate."""
    device = named_device("achilles") if adapted else None
    settings = Protocol(
        profile=profile, task=task, chirp_amplitude=chirp, rate_hz=rate, device=device
    )
    if not adapted:
        return generate(settings)
    still = _moved(profile, chirp, rate)
    asked = effort(still.time, named_task(task))
    return replace(still, settings=settings, effort=read_only(asked))


@lru_cache(16)
def _moved(profile: str, chirp: float, rate: float) -> Trajectory:
    return generate(
        Protocol(
            profile=profile,
            task="passive",
            chirp_amplitude=chirp,
            rate_hz=rate,
            device=named_device("achilles"),
        )
    )


def signals(
    seed: int,
    *,
    task: str | None = None,
    reflex: bool = False,
    motions: tuple[tuple[str, float, bool], ...] = MOTIONS,
) -> Signals:
    """A clean recording: everything about it follows from the seed."""
    rng = np.random.default_rng([seed, 1])
    raw = seed % 2 == 0
    profile, chirp, adapted = motions[int(rng.integers(len(motions)))]
    task = task or ("part-passive" if rng.random() < 0.6 else "active")
    subject = virtual_subject(seed, "patient" if rng.random() < 0.5 else "healthy")
    imperfections = realistic_imperfections(subject) if rng.random() < 0.5 else Imperfections()
    gain = float(rng.uniform(0.15, 0.5)) if reflex else 0.0
    imperfections = replace(imperfections, reflex_gain=gain)
    moved = trajectory(profile, task, chirp, adapted, RAW if raw else ENVELOPE)
    if raw:
        made = virtual_recording(subject, moved, seed=seed, imperfections=imperfections)
        emg = np.column_stack([made.channels[f"emg_{m}"].values for m in MUSCLES])
        # An amplifier's own noise.
        emg = emg + 1e-6 * rng.standard_normal(emg.shape)
        torque = made.channels["torque"].values
    else:
        trial = virtual_trial(
            subject,
            moved,
            noise=0.05 if seed % 4 == 1 else 0.01,
            seed=seed,
            imperfections=imperfections,
        )
        emg, torque = trial.emg, trial.torque
    return Signals(
        moved.time.copy(), moved.angle.copy(), np.array(torque), np.array(emg), raw, moved, rng
    )


def _channel(s: Signals) -> int:
    return int(s.rng.integers(4))


def missing(s: Signals) -> None:
    """One muscle, or all of them, without a column."""
    k = _channel(s)
    s.drop = tuple(f"emg_{m}" for m in MUSCLES) if s.rng.random() < 0.2 else (f"emg_{MUSCLES[k]}",)


def flat(s: Signals) -> None:
    """A constant, no contact, or a drop-out of a second or more."""
    k, kind = _channel(s), s.rng.integers(4)
    if kind == 0:
        s.emg[:, k] = 0.0
    elif kind == 1:
        s.emg[:, k] = 1e-4
    elif kind == 2:
        s.emg[:, k] *= 1e-3
    else:
        first = int(s.rng.uniform(0.4, 0.8) * len(s.time))
        last = first + int(s.rng.uniform(1.0, 5.0) * s.rate)
        s.emg[first:last, k] = 0.0 if s.rng.random() < 0.5 else s.emg[first, k]


def clipped(s: Signals) -> None:
    """One channel or all at 20 to 70 % of their largest value."""
    part = s.rng.uniform(0.2, 0.7)
    for k in range(4) if s.rng.random() < 0.5 else [_channel(s)]:
        top = part * np.abs(s.emg[:, k]).max()
        s.emg[:, k] = np.clip(s.emg[:, k], -top, top)


def hum(s: Signals) -> None:
    """50 or 60 Hz of 10 to 100 µV."""
    frequency = (50.0 if s.rng.random() < 0.7 else 60.0) + s.rng.uniform(-0.05, 0.05)
    size = np.exp(s.rng.uniform(np.log(1e-5), np.log(1e-4)))
    wave = size * np.sin(2 * np.pi * frequency * s.time + s.rng.uniform(0, 6.3))
    for k in range(4) if s.rng.random() < 0.5 else [_channel(s)]:
        s.emg[:, k] += wave


def emg_offset(s: Signals) -> None:
    """A constant of 50 to 300 µV."""
    s.emg[:, _channel(s)] += s.rng.uniform(5e-5, 3e-4) * (s.rng.choice([-1, 1]) if s.raw else 1)


def artefact(s: Signals) -> None:
    """One to five swings of 20 to 150 ms, or spikes, of three times the largest EMG or more."""
    k = _channel(s)
    usual = np.quantile(np.abs(s.emg[:, k]), 0.998)
    for _ in range(int(s.rng.integers(1, 6))):
        centre = s.rng.uniform(0.05, 0.95) * s.time[-1]
        size = s.rng.uniform(4.0, 10.0) * usual
        if s.rng.random() < 0.3:
            s.emg[int(centre * s.rate), k] += size
        else:
            width = s.rng.uniform(0.02, 0.15) / 2.35
            s.emg[:, k] += size * np.exp(-0.5 * ((s.time - centre) / width) ** 2)


def electrode_lag(s: Signals) -> None:
    """One channel late by 0.25 to 0.4 s."""
    _late(s, [_channel(s)], s.rng.uniform(0.25, 0.4))


def torque_lag(s: Signals) -> None:
    """All EMG late or early by 0.17 to 0.4 s."""
    _late(s, range(4), s.rng.uniform(0.17, 0.4) * s.rng.choice([-1, 1]))


def _late(s: Signals, which: object, seconds: float) -> None:
    for k in which:  # type: ignore[attr-defined]
        s.emg[:, k] = np.roll(s.emg[:, k], round(seconds * s.rate))


def torque_limit(s: Signals) -> None:
    """A torque that would go beyond 80 Nm, cut off there; sometimes by a noisy sensor."""
    top = float(np.abs(s.torque).max())
    s.torque *= s.rng.uniform(1.05, 1.5) * 80.0 / top if top < 84.0 else 1.0
    s.torque = np.clip(s.torque, -80.0, 80.0)
    if s.rng.random() < 0.3:
        s.torque += 0.1 * s.rng.standard_normal(len(s.torque))


def torque_sign(s: Signals) -> None:
    """The other sign."""
    s.torque *= -1.0


def torque_offset(s: Signals) -> None:
    """8 to 20 Nm either way."""
    s.torque += s.rng.uniform(8.0, 20.0) * s.rng.choice([-1, 1])


def units(s: Signals) -> None:
    """Degrees under the name of radians, or the reverse."""
    s.angle = np.rad2deg(s.angle) if s.rng.random() < 0.7 else np.deg2rad(s.angle)


def small_range(s: Signals) -> None:
    """A third to half of the range of motion."""
    middle = s.rng.uniform(-0.5, 0.2)
    s.angle = middle + s.rng.uniform(0.33, 0.5) * (s.angle - s.angle.mean())


def steps(s: Signals) -> None:
    """From some time on, the profile is held for 0.2 to 1 s at a time."""
    hold = s.rng.uniform(0.2, 1.0)
    from_ = s.rng.uniform(0.0, 0.6) * s.time[-1]
    held = np.interp(np.floor(s.time / hold) * hold, s.time, s.angle)
    s.angle = np.where(s.time > from_, held, s.angle)


def overshoot(s: Signals) -> None:
    """A device that rings at 1.5 to 5 Hz, damping 0.15 to 0.4, by 4 to 15 % of the range."""
    omega, zeta = 2 * np.pi * s.rng.uniform(1.5, 5.0), s.rng.uniform(0.15, 0.4)
    t = np.arange(int(6.0 / (zeta * omega) * s.rate) + 1) / s.rate
    damped = omega * np.sqrt(1 - zeta**2)
    response = np.exp(-zeta * omega * t) * np.sin(damped * t)
    response /= response.sum()
    n = len(s.angle) + len(t)
    size = 1 << (n - 1).bit_length()
    rest = s.angle - s.angle[0]
    spectrum = np.fft.rfft(rest, size) * np.fft.rfft(response, size)
    left = np.fft.irfft(spectrum, size)[: len(rest)] - rest
    # A constant delay is not what is meant.
    velocity = np.gradient(rest)
    left -= velocity * (velocity @ left) / (velocity @ velocity)
    left *= s.rng.uniform(0.04, 0.15) * np.ptp(rest) / np.abs(left).max()
    s.angle = s.angle + left


def gap(s: Signals) -> None:
    """0.05 to 2 s of samples lost."""
    first = int(s.rng.uniform(0.1, 0.9) * len(s.time))
    count = int(s.rng.uniform(0.05, 2.0) * s.rate)
    kept = np.ones(len(s.time), dtype=bool)
    kept[first : first + count] = False
    s.time, s.angle, s.torque, s.emg = (x[kept] for x in (s.time, s.angle, s.torque, s.emg))


def jitter(s: Signals) -> None:
    """Time stamps off by 5 to 20 % of a step (standard deviation)."""
    size = s.rng.uniform(0.05, 0.2) / s.rate
    most = 0.45 / s.rate
    s.time = s.time + np.clip(size * s.rng.standard_normal(len(s.time)), -most, most)


def passive(s: Signals) -> None:
    """One to four bursts, or a tonic activity, in the first 11 s."""
    bump = np.zeros(len(s.time))
    if s.rng.random() < 0.3:
        tonic = (s.time > s.rng.uniform(0, 4)) & (s.time < s.rng.uniform(6, 10))
        bump[tonic] = s.rng.uniform(0.15, 0.5)
    else:
        for _ in range(int(s.rng.integers(1, 5))):
            centre, length = s.rng.uniform(1.0, 10.0), s.rng.uniform(0.5, 1.5)
            burst = np.abs(s.time - centre) < length / 2
            bump = np.maximum(bump, s.rng.uniform(0.2, 0.8) * burst)
    which = [0] if s.rng.random() < 0.3 else [1, 2, 3]
    added = 6e-4 * bump[:, None] * np.ones(len(which))
    s.emg[:, which] += raw_emg(added, RAW, s.rng) if s.raw else added


def inactive(s: Signals) -> None:
    """No effort at all, none of one side, or none from some time on."""
    kind = s.rng.integers(3)
    rest = 1e-6 * (1.0 + 0.05 * s.rng.standard_normal(s.emg.shape))
    if s.raw:
        rest = raw_emg(np.full(s.emg.shape, 1e-6), RAW, s.rng)
    if kind == 0:
        s.emg = rest
    elif kind == 1:
        which = [0] if s.rng.random() < 0.5 else [1, 2, 3]
        s.emg[:, which] = rest[:, which]
    else:
        first = 11.0 if s.trajectory.effort[: int(10 * s.rate)].max() == 0.0 else 0.0
        still = s.time > first + s.rng.uniform(0.15, 0.5) * (s.time[-1] - first)
        s.emg[still] = rest[still]


def co_contraction(s: Signals) -> None:
    """TA active with the triceps and the triceps with TA."""
    own = s.emg.copy()
    share = s.rng.uniform(0.6, 1.0)
    s.emg[:, 0] += share * own[:, 1:].mean(axis=1) * (1.7 if s.raw else 1.0)
    s.emg[:, 1:] += share * own[:, :1]


def short(s: Signals) -> None:
    """The first 3 to 12 s."""
    n = int(s.rng.uniform(3.0, 12.0) * s.rate)
    s.time, s.angle, s.torque, s.emg = s.time[:n], s.angle[:n], s.torque[:n], s.emg[:n]


def reflex_bursts(s: Signals) -> None:
    """Bursts of 30 to 60 ms, 40 to 90 ms after each stretch reaches its speed."""
    velocity = np.gradient(s.angle, s.time)
    fast = velocity > 0.3
    starts = np.flatnonzero(np.diff(fast.astype(int)) > 0)
    delay, length = s.rng.uniform(0.04, 0.09), s.rng.uniform(0.03, 0.06)
    bump = np.zeros(len(s.time))
    for start in starts:
        end = start + 1 + int(np.argmin(fast[start + 1 :]))
        piece = velocity[start : end + 1]
        peak = start + int(np.argmax(piece >= 0.95 * piece.max()))
        bump[np.abs(s.time - s.time[peak] - delay) < length / 2] = 1.0
    added = s.rng.uniform(1e-4, 4e-4) * bump[:, None] * np.ones(3)
    s.emg[:, 1:] += raw_emg(added, RAW, s.rng) if s.raw else added


def nothing(s: Signals) -> None:
    """The subject has the fault."""


Fault = Callable[[Signals], None]

_STRETCHING = tuple(m for m in MOTIONS if m[0] != "sine" and m[:2] != ("ramp-and-hold", 0.0))
_LONG = tuple(m for m in MOTIONS if m[0] != "ramp-and-hold")

#: Code → fault and what the clean recording must be.
FAULTS: dict[str, tuple[Fault, dict[str, object]]] = {
    "emg-missing": (missing, {}),
    "emg-flat": (flat, {}),
    "emg-clipped": (clipped, {}),
    "emg-offset": (emg_offset, {}),
    "emg-artefact": (artefact, {}),
    "mains-hum": (hum, {}),
    # Where efforts last 7 s, at the end of a ramp and hold, a lag is often not told.
    "electrode-lag": (electrode_lag, {"motions": _LONG}),
    "emg-torque-lag": (torque_lag, {"motions": _LONG}),
    "torque-limit": (torque_limit, {}),
    "torque-sign": (torque_sign, {}),
    "torque-offset": (torque_offset, {}),
    "angle-units": (units, {}),
    "rom-not-covered": (small_range, {}),
    "position-steps": (steps, {}),
    "overshoot": (overshoot, {"motions": tuple(m for m in MOTIONS if m[0] != "sine")}),
    "time-gap": (gap, {}),
    "time-jitter": (jitter, {}),
    "passive-not-passive": (passive, {"task": "part-passive", "motions": _LONG}),
    "active-not-active": (inactive, {"motions": _LONG}),
    "co-contraction": (co_contraction, {}),
    "trial-too-short": (short, {}),
    "reflex-suspected": (nothing, {"reflex": True}),
    "reflex-suspected (bursts)": (reflex_bursts, {"task": "part-passive", "motions": _STRETCHING}),
}


def codes(s: Signals) -> set[str]:
    """What is found, information left out where it is of no fault."""
    return {f.code for f in examined(s.recording).findings}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=100_000)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--only")
    parser.add_argument("--missed", action="store_true", help="Say which seeds are missed.")
    chosen = parser.parse_args()
    seeds = range(chosen.first, chosen.first + chosen.count)
    false: Counter[str] = Counter()
    clean = 0
    for seed in seeds:
        reported = codes(signals(seed))
        clean += not reported
        false.update(reported)
        if reported and chosen.missed:
            print("  clean", seed, sorted(reported))
    print(f"| fault | found in {len(seeds)} with it | in {len(seeds)} without | others beside it |")
    print("|---|---|---|---|")
    # Another range, so that no recording is counted on both sides.
    for number, (name, (plant, needs)) in enumerate(FAULTS.items(), start=1):
        if chosen.only and chosen.only not in name:
            continue
        code = name.split()[0]
        hits, beside = 0, Counter[str]()
        for seed in range(chosen.first + 1000 * number, chosen.first + 1000 * number + len(seeds)):
            s = signals(seed, **needs)  # type: ignore[arg-type]
            plant(s)
            reported = codes(s)
            hits += code in reported
            beside.update(reported - {code})
            if chosen.missed and code not in reported:
                print(
                    "  missed",
                    name,
                    seed,
                    s.raw,
                    s.trajectory.settings.profile,
                    s.trajectory.settings.task,
                    s.trajectory.settings.chirp_amplitude,
                    s.trajectory.settings.device is not None,
                    sorted(reported),
                )
        others = ", ".join(f"{c} {k}" for c, k in beside.most_common(5) if k > 0.05 * len(seeds))
        print(f"| {name} | {hits} | {false[code]} | {others} |", flush=True)
    print(
        f"\n{clean} of {len(seeds)} clean recordings have no finding, "
        f"all together {sum(false.values())} findings: {dict(false)}"
    )


if __name__ == "__main__":
    main()
