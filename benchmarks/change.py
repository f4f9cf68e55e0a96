"""How often a change is claimed of virtual legs, where there is none and where there is one.

Each leg is measured before and after, each time with electrodes put on anew (crosstalk, the gain of
each electrode), the foot strapped in anew (zero, axis), other efforts and other noise, and every
recording goes through a CSV file and the fit that users get. The leg itself is richer than every
model: compliant tendons and a delay of its own. With --plain it is a leg of model 1.0, and of all
this only the electrodes' gain, efforts and noise change. Fits are kept in the folder, so that it
goes on where it was stopped. With --case the one leg of the documentation is compared, kept in
``change_case.json``, and written into its page.
"""

import argparse
import json
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq

import surae
from surae.base.frozen import read_only
from surae.measures import measures_of_values
from surae.model.geometry import JointAxis
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject

RATE, FINER, NOISE = 128.0, 4, 0.03
#: What a treatment leaves of stiffness k, and of the triceps's passive torque at 10° dorsiflexion.
SOFTER, LESS = 0.80, 0.85
#: Where measures are asked for [deg], and the quantities that the treatment changes.
ANGLE = 10.0
ASKED = (
    "passive_stiffness@10deg",
    "passive_torque@10deg",
    "passive_torque_tri@10deg",
    "k_tri",
    "x0_tri",
)
#: The documentation's case: its leg, its page, where it is kept, and what is shown of it.
CASE = 1
CASE_KEPT = Path(__file__).with_name("change_case.json")
CASE_PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "before-and-after.md"
CASE_MARKS = "<!-- case: begin -->", "<!-- case: end -->"
CASE_ASKED = "passive_stiffness@10deg"
CASE_ROWS = {
    "passive_stiffness@10deg": "stiffness at rest, 10° [Nm/°]",
    "slow_stiffness@10deg": "stiffness in a slow stretch, 10° [Nm/°]",
    "end_stiffness": "stiffness at the end of the range [Nm/°]",
    "passive_torque@10deg": "torque at rest, 10° [Nm]",
    "k_tri": "the calf's stiffness k [1/m]",
    "relaxed_share@10s": "part that relaxes within 10 s [%]",
}


@dataclass(frozen=True)
class Session:
    """One measurement of one leg."""

    seed: int
    number: int
    treated: bool = False
    plain: bool = False

    @property
    def name(self) -> str:
        """Name of its files."""
        kind = "p" if self.plain else ""
        return f"{self.seed:03d}{kind}-{self.number}{'t' if self.treated else ''}"

    @property
    def model(self) -> str:
        """The model that the leg is simulated with."""
        return "muscle" if self.plain else "muscle-tendon"

    def leg(self) -> tuple[dict[str, float], float]:
        """True parameters of the leg, and its delay [s]."""
        subject = virtual_subject(60_000 + self.seed, "healthy" if self.seed % 3 else "patient")
        rng = np.random.default_rng([self.seed, 1])
        p, delay = dict(subject.parameters), 0.0
        if not self.plain:
            p["dlt_tri"], p["dlt_tib"] = rng.uniform(0.012, 0.030), rng.uniform(0.005, 0.012)
            delay = float(rng.uniform(0.020, 0.060))
        if self.treated:
            less = LESS * self.triceps_torque(p)
            p["k_tri"] *= SOFTER
            p["x0_tri"] = brentq(
                lambda x0: self.triceps_torque({**p, "x0_tri": x0}) - less, 1e-4, 0.06
            )
        return p, delay

    def triceps_torque(self, p: dict[str, float]) -> float:
        """True passive torque of the triceps at 10° of dorsiflexion [Nm]."""
        return measures_of_values(p, self.model, angles=[ANGLE])[f"passive_torque_tri@{ANGLE:g}deg"]


def write(session: Session, path: Path) -> None:
    """Measure a leg: write the session's recording as a CSV file."""
    p, delay = session.leg()
    rng = np.random.default_rng([session.seed, session.number, 7])
    task = "active" if session.seed % 2 else "part-passive"
    motion = generate(
        Protocol(
            profile="multiple-holds",
            task=task,
            chirp_amplitude=0.2,
            chirp_rate=0.16,
            rate_hz=RATE * FINER,
        )
    )
    time = motion.time
    envelopes = 1e-6 + 6e-4 * motion.effort * rng.uniform(0.7, 1.0, 4)
    late = np.stack([np.interp(time - delay, time, column) for column in envelopes.T], axis=1)
    forward, up = np.clip(0.004 * rng.standard_normal(2), -0.01, 0.01) * (not session.plain)
    joint = JointAxis(angle=motion.angle, forward=forward, up=up).joint
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
    zero, mixing = rng.uniform(-6.0, 6.0), rng.uniform(0.0, 0.08, (4, 4))
    gains = np.exp(0.3 * rng.standard_normal(4))
    drift = 1.0 + rng.uniform(-0.05, 0.05, 4) * (time[:, None] / time[-1] - 0.5)
    torque = joint.factor * surae.simulate(session.model, p, inputs)
    if session.plain:
        heard = envelopes * gains
    else:
        torque = torque + zero
        np.fill_diagonal(mixing, 1.0)
        heard = envelopes @ mixing.T * gains * drift
    kept = slice(None, None, FINER)
    emg, torque = heard[kept], torque[kept]
    emg = emg + NOISE * emg.mean(axis=0) * rng.standard_normal(emg.shape)
    torque = torque + NOISE * np.abs(torque).mean() * rng.standard_normal(len(torque))
    columns = {"time_s": time[kept], "angle_rad": motion.angle[kept], "torque_Nm": torque}
    columns |= {f"emg_{m}_V": np.maximum(emg[:, i], 0.0) for i, m in enumerate(MUSCLES)}
    surae.write_csv(path, columns, ["emg: envelope"])


def sessions(seed: int, plain: bool) -> tuple[Session, Session, Session]:
    """A leg before, again without any change, and treated."""
    return (
        Session(seed, 0, plain=plain),
        Session(seed, 1, plain=plain),
        Session(seed, 2, treated=True, plain=plain),
    )


def fitted(session: Session, folder: Path) -> surae.Fit:
    """The fit of a session, from its file where it was made before."""
    path = folder / f"{session.name}.json"
    if not path.exists():
        recording = folder / f"{session.name}.csv"
        write(session, recording)
        surae.fit(recording, quality=()).save(path)
        recording.unlink()
    return surae.load(path)


def intervals(pairs: Iterable[int], folder: Path, plain: bool) -> pd.DataFrame:
    """Every measure that a known leg has, of all recordings: whether its interval is true."""
    rows = []
    for seed in pairs:
        for session in sessions(seed, plain):
            truth = measures_of_values(session.leg()[0], session.model, angles=[ANGLE])
            for name, told in fitted(session, folder).measures(angles=[ANGLE]).items():
                if name in truth and not name.startswith("torque_per_emg") and told.ci95:
                    low, high = told.ci95
                    unit = 1.0 if told.unit == "deg" else abs(told.value) / 100.0
                    rows.append(
                        {
                            "measure": name,
                            "true": low <= truth[name] <= high,
                            "identified": told.verdict == "identified",
                            "half-width [% or deg]": (high - low) / 2.0 / unit,
                        }
                    )
    return pd.DataFrame(rows)


def claims(pairs: Iterable[int], folder: Path, plain: bool) -> pd.DataFrame:
    """Of each pair and each quantity: whether `changed` is said of it."""
    rows = []
    for seed in pairs:
        before, same, treated = (fitted(session, folder) for session in sessions(seed, plain))
        for kind, after in (("no change", same), ("treated", treated)):
            told = surae.change(before, after, angles=[ANGLE])
            said = {d.name for d in told.changed}
            rows.append({"kind": kind, "any": bool(said)} | {name: name in said for name in ASKED})
    return pd.DataFrame(rows)


def case(folder: Path) -> dict[str, object]:
    """What the documentation shows of one leg, before and treated."""
    first, _, last = sessions(CASE, False)
    before, treated = fitted(first, folder), fitted(last, folder)
    told = surae.change(before, treated, angles=[ANGLE], question=[CASE_ASKED])
    rows = {}
    for name in CASE_ROWS:
        d = {**told.measures, **told.parameters}[name]
        rows[name] = [d.before, d.after, d.difference, d.ci95, str(d.verdict)]
    return {
        "surae": surae.__version__,
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "sentence": str(told.sentence),
        "rows": rows,
    }


def case_text(kept: dict[str, object]) -> str:
    """The case as the page has it."""

    def number(value: float | None) -> str:
        return "–" if value is None else f"{value:.3g}".replace("-", "−")

    lines = [
        f"Compared on {kept['date']} by `python benchmarks/change.py FOLDER --case`; asked "
        f"beforehand for `{CASE_ASKED}`, and answered: *{kept['sentence']}*",
        "",
        "| | before | after | difference | 95 % interval | verdict |",
        "|---|--:|--:|--:|--:|---|",
    ]
    for name, (before, after, difference, ci95, verdict) in kept["rows"].items():
        ends = "–" if ci95 is None else " … ".join(map(number, ci95))
        numbers = " | ".join(map(number, (before, after, difference)))
        lines.append(f"| {CASE_ROWS[name]} | {numbers} | {ends} | {verdict} |")
    return "\n".join(lines)


def with_case(page: str, kept: dict[str, object]) -> str:
    """A page with the case between its marks."""
    begin, end = CASE_MARKS
    return f"{page.partition(begin)[0]}{begin}\n{case_text(kept)}\n{end}{page.partition(end)[2]}"


def main() -> None:
    """Print how often intervals hold the truth, and how often each kind of pair was `changed`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--pairs", type=int, default=30)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--plain", action="store_true", help="legs of model 1.0")
    parser.add_argument("--case", action="store_true", help="the documentation's one leg alone")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    if given.case:
        kept = case(given.folder)
        CASE_KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        CASE_PAGE.write_text(with_case(CASE_PAGE.read_text("utf-8"), kept), encoding="utf-8")
        print(case_text(kept))
        return
    pairs = range(given.first, given.first + given.pairs)
    for seed in pairs:
        for session in sessions(seed, given.plain):
            fitted(session, given.folder)
        print(f"leg {seed} is measured", file=sys.stderr, flush=True)
    held = intervals(pairs, given.folder, given.plain)
    sure = held[held["identified"]]
    print(
        f"{held['true'].mean():.1%} of {len(held)} intervals hold the truth, of "
        f"those identified {sure['true'].mean():.1%} of {len(sure)}\n"
    )
    grouped = held.groupby("measure", sort=False)
    table = grouped[["true", "identified"]].mean()
    table["half-width [% or deg]"] = grouped["half-width [% or deg]"].median()
    print(table.to_string(float_format="{:.3f}".format), "\n")
    counted = claims(pairs, given.folder, given.plain).groupby("kind").mean()
    print(f"part of {given.pairs} pairs in which it is changed\n")
    print(counted.T.to_string(float_format="{:.2f}".format))


if __name__ == "__main__":
    main()
