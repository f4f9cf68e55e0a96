"""How often a change is claimed of virtual legs, where there is none and where there is one.

Each leg is measured before and after, each time with electrodes put on anew (crosstalk, the gain of
each electrode), the foot strapped in anew (zero, axis), other efforts and other noise, and every
recording goes through a CSV file and the fit that users get. The leg itself is richer than every
model: compliant tendons and a delay of its own. Fits are kept in the folder, so that it goes on
where it was stopped.
"""

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import surae
from surae.frozen import read_only
from surae.measures import measures_of_values
from surae.model.geometry import AnkleAxis
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject

RATE, FINER, NOISE = 128.0, 4, 0.03
#: What a treatment leaves of stiffness k, and of the triceps's passive torque at 10° dorsiflexion.
SOFTER, LESS = 0.80, 0.85


@dataclass(frozen=True)
class Session:
    """One measurement of one leg."""

    seed: int
    number: int
    treated: bool = False

    @property
    def name(self) -> str:
        """Of its files."""
        return f"{self.seed:03d}-{self.number}{'t' if self.treated else ''}"


def leg(seed: int, *, treated: bool = False) -> tuple[dict[str, float], float]:
    """True parameters of a leg, and its delay [s]."""
    subject = virtual_subject(60_000 + seed, "patient" if seed % 3 == 0 else "healthy")
    rng = np.random.default_rng([seed, 1])
    p = dict(subject.parameters)
    p["dlt_tri"], p["dlt_tib"] = rng.uniform(0.012, 0.030), rng.uniform(0.005, 0.012)
    delay = rng.uniform(0.020, 0.060)
    if treated:
        less = LESS * triceps_torque(p)
        p["k_tri"] *= SOFTER
        p["x0_tri"] = brentq(lambda x0: triceps_torque({**p, "x0_tri": x0}) - less, 1e-4, 0.06)
    return p, float(delay)


def triceps_torque(p: dict[str, float]) -> float:
    """True passive torque of the triceps at 10° of dorsiflexion [Nm]."""
    return measures_of_values(p, "muscle-tendon", angles=[10.0])["passive_torque_tri@10deg"]


def write(session: Session, path: Path) -> None:
    """Measure a leg: write the session's recording as a CSV file."""
    p, delay = leg(session.seed, treated=session.treated)
    rng = np.random.default_rng([session.seed, session.number, 7])
    task = "active" if session.seed % 2 else "part-passive"
    motion = generate(
        Protocol(
            profile="multiple-holds", task=task, chirp_amplitude=0.2, chirp_rate=0.16,
            rate_hz=RATE * FINER,
        )
    )  # fmt: skip
    time = motion.time
    envelopes = 1e-6 + 6e-4 * motion.effort * rng.uniform(0.7, 1.0, 4)
    late = np.stack([np.interp(time - delay, time, column) for column in envelopes.T], axis=1)
    forward, up = np.clip(0.004 * rng.standard_normal(2), -0.01, 0.01)
    joint = AnkleAxis(angle=motion.angle, forward=forward, up=up).joint
    inputs = surae.ModelInputs(
        name=session.name,
        rate_hz=RATE * FINER,
        time=read_only(time),
        angle=read_only(joint.angle),
        velocity=read_only(joint.factor * motion.velocity),
        acceleration=read_only(
            joint.factor * motion.acceleration + joint.bend * motion.velocity**2
        ),
        emg=read_only(late),
        emg_unit="V",
        torque=None,
        prepared=True,
    )
    torque = joint.factor * surae.simulate("muscle-tendon", p, inputs) + rng.uniform(-6.0, 6.0)
    mixing = rng.uniform(0.0, 0.08, (4, 4))
    np.fill_diagonal(mixing, 1.0)
    heard = envelopes @ mixing.T * np.exp(0.3 * rng.standard_normal(4))
    heard *= 1.0 + rng.uniform(-0.05, 0.05, 4) * (time[:, None] / time[-1] - 0.5)
    kept = slice(None, None, FINER)
    emg, torque = heard[kept], torque[kept]
    emg = emg + NOISE * emg.mean(axis=0) * rng.standard_normal(emg.shape)
    torque = torque + NOISE * np.abs(torque).mean() * rng.standard_normal(len(torque))
    columns = {"time_s": time[kept], "angle_rad": motion.angle[kept], "torque_Nm": torque}
    columns |= {f"emg_{m}_V": np.maximum(emg[:, i], 0.0) for i, m in enumerate(MUSCLES)}
    surae.write_csv(path, columns, ["emg: envelope"])


def fitted(session: Session, folder: Path) -> surae.Fit:
    """The fit of a session, from its file where it was made before."""
    path = folder / f"{session.name}.json"
    if not path.exists():
        recording = folder / f"{session.name}.csv"
        write(session, recording)
        surae.fit(recording, quality=()).save(path)
        recording.unlink()
    return surae.load(path)


def main() -> None:
    """Print how often each kind of pair was called changed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--pairs", type=int, default=30)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--fits-only", action="store_true")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for seed in range(given.first, given.pairs):
        before = Session(seed, 0)
        for after in (Session(seed, 1), replace(before, number=2, treated=True)):
            fitted(before, given.folder), fitted(after, given.folder)
            print(after.name, flush=True)


if __name__ == "__main__":
    main()
