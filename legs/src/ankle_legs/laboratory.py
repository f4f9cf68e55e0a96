"""A virtual laboratory: one leg measured as a session of steps, with what is known beforehand.

The leg of a family gets moment arms of its own, a device whose plate weighs, drags and rubs, an
angle zero and an axis that are set as well as people set them. The steps are files in one folder,
and ``session.toml`` says what they are and what is known, with its uncertainty. What is known may
be wrong, in six ways.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ankle_legs import look
from ankle_legs.leg import Departure, Leg, Run, drawn
from ankle_legs.movement import FINE, angles, fine_times
from ankle_legs.muscle import Array
from ankle_legs.subject import Geometry

STEPS = (
    *("tare", "zero", "axis", "geometry", "excursion", "again"),
    *("alone", "maximal", "slow", "fast", "active"),
)
#: What may be wrong of what a laboratory says: what each is, in words.
WRONG = {
    "tare": "the empty device had another plate",
    "zero": "the zero of the angle is 6° off, and said to be set within 1°",
    "axis": "the ankle's axis is 15 mm beside the device's, and said to be within 3 mm",
    "geometry": "the moment arms and lengths are those of another leg",
    "alone": "one muscle at a time was recorded with electrodes that were placed anew",
    "passive": "the passive trials are of another leg",
}
#: Kinds of a trial in session.toml.
KINDS = {
    "alone": "one muscle at a time",
    "maximal": "maximal",
    "slow": "passive",
    "fast": "passive",
    "active": "active",
    "isometric": "isometric",
}
HELD = ("alone", "maximal", "isometric")
SECONDS = {"alone": 48.0, "maximal": 30.0, "slow": 45.0, "fast": 30.0, "isometric": 64.0}
ACTIVE = 35.0
ZERO_SD, AXIS_SD, GEOMETRY_SD, ARM_SD = 1.0, 3.0, 3.0, 1.5  # [deg], [mm], [%], [mm]
STRAP = 0.13  # from the device's axis to where the foot presses on the plate [m]


@dataclass(frozen=True)
class Device(Departure):
    """The plate's inertia, weight, drag and friction, which the sensor feels."""

    unscored: ClassVar[dict[str, str]] = {}
    inertia: float  # [kg m2]
    weight: float  # [Nm]
    angle: float  # where it is level [rad]
    drag: float  # [Nm s/rad]
    friction: float  # [Nm]

    def torque(self, angle: Array, step: float) -> Array:
        """Return what the empty device's sensor shows [Nm]."""
        speed = np.gradient(angle, step)
        rubbed = self.friction * np.tanh(speed / 0.02)
        swing = self.inertia * np.gradient(speed, step)
        return np.asarray(
            swing + self.weight * np.cos(angle - self.angle) + self.drag * speed + rubbed
        )

    def measure(self, run: Run) -> None:
        run.torque += self.torque(run.plate, run.step)


@dataclass(frozen=True)
class Axis(Departure):
    """The ankle's axis lies beside the device's, and the foot slides on its plate.

    The strap holds the foot's front at a distance from the device's axis: the foot turns a little
    more or less than the plate, and its force has another arm to the ankle than to the device.
    """

    forward: float  # of the ankle's axis from the device's [m]
    up: float

    def turn(self, run: Run) -> None:
        aside = self.forward * np.sin(run.plate) - self.up * np.cos(run.plate)
        run.ankle = run.ankle + aside / STRAP

    def measure(self, run: Run) -> None:
        along = self.forward * np.cos(run.plate) + self.up * np.sin(run.plate)
        run.torque *= 1 + along / STRAP


@dataclass(frozen=True)
class Session:
    """A leg in its laboratory."""

    leg: Leg
    device: Device
    files: dict[str, dict[str, Array]]
    table: Geometry
    steps: tuple[str, ...]
    truth: dict[str, Any]
    minutes: float
    arms: tuple[float, float]  # by the tendons' excursion, triceps and tibialis [mm]
    zero_again: float  # by another reader [deg]
    axis_again: tuple[float, float]  # [mm]


def _device(rng: np.random.Generator) -> Device:
    return Device(
        inertia=float(rng.uniform(0.01, 0.04)),
        weight=float(rng.uniform(1, 6)),
        angle=float(rng.uniform(-0.5, 1.2)),
        drag=float(rng.uniform(0.02, 0.2)),
        friction=float(rng.uniform(0.05, 0.3)),
    )


def measured_geometry(rng: np.random.Generator, true: Geometry) -> Geometry:
    """Return a leg's geometry as it is measured: 3 % in arms and in what paths travel."""
    arms, paths = true.arms.copy(), true.paths.copy()
    sd = GEOMETRY_SD / 100
    for i in range(2):
        scale = 1 + 0.9 * sd * rng.normal()
        arms[i] *= scale
        arms[i, 1] += 0.45 * sd * true.arms[i, 0] * rng.normal() / 0.5  # over half a radian
        paths[i, 1:] *= scale * (1 + 0.3 * sd * rng.normal())
        paths[i, 0] += 0.002 * rng.normal()
    return Geometry(arms, paths)


def _check(family: str, steps: Sequence[str], wrong: str | None) -> None:
    """Refuse what no session of a family can be."""
    from ankle_legs.make import RELAXED

    if family in RELAXED:
        raise ValueError(
            f"{family} has visits of its own and no laboratory; use make --trials 1,2,3"
        )
    for name in steps:
        if name not in (*STEPS, "isometric"):
            raise ValueError(f"no step {name!r}; there are {', '.join((*STEPS, 'isometric'))}")
    if wrong is not None and wrong not in WRONG:
        raise ValueError(f"nothing called {wrong!r} can be wrong; there are {', '.join(WRONG)}")
    if not {*SECONDS, "active"} & {*steps}:
        raise ValueError("no step has the leg in it; add slow, or active")


def measure(
    family: str,
    seed: int,
    steps: Sequence[str] = STEPS,
    *,
    wrong: str | None = None,
    active: int = 2,
) -> Session:
    """Return the session of a family's leg."""
    from ankle_legs.make import PATHS, leg

    _check(family, steps, wrong)
    one = leg(family, seed)
    device = _device(one.rng(21))
    zero = ZERO_SD * one.rng(22).normal()
    if wrong == "zero":
        zero = 6.0 * one.rng(22).choice([-1, 1])
    axis = AXIS_SD * one.rng(23).normal(size=2)
    if wrong == "axis":
        turned = one.rng(23).uniform(0, 2 * np.pi)
        axis = 15 * np.array([np.cos(turned), np.sin(turned)])
    setup_of = (
        ()
        if family in PATHS or any(isinstance(d, look.Arms) for d in one.departures)
        else drawn(look.Arms)(one.rng(24), 0.8)
    )
    in_laboratory = (
        *(d for d in (*setup_of, *one.departures) if not isinstance(d, look.Zero | look.Untared)),
        look.Zero(float(zero)),
        Axis(float(axis[0]) / 1000, float(axis[1]) / 1000),
        device,
    )
    one = replace(one, departures=in_laboratory)
    table = measured_geometry(one.rng(25), one.lasting(one.subject).geometry)
    if wrong == "geometry":
        table = _other_geometry(one.rng(25), one)
    files: dict[str, dict[str, Array]] = {}
    kinds, moves = [], []
    if "tare" in steps:
        empty = (
            device
            if wrong != "tare"
            else replace(
                _device(one.rng(26)), inertia=device.inertia + 0.03, weight=device.weight + 4
            )
        )
        files["empty"] = _tare(one.rng(27), one, empty)
    trials = [s for s in ("alone", "maximal", "slow", "fast", "isometric") if s in steps]
    trials += ["active"] * (active if "active" in steps else 0)
    for i, kind in enumerate(trials):
        number = sum(name.startswith(kind) for name in files) + 1
        name = f"{kind}-{number}" if kind == "active" else kind
        move, other, subject_of = 10 + i, None, one
        if kind == "alone" and wrong == "alone":
            other = one.mounting(1)
        if kind in ("slow", "fast") and wrong == "passive":
            subject_of = replace(one, subject=_other_leg(family, seed))
        run = subject_of.record(1, SECONDS.get(kind, ACTIVE), kind, movement=move, mounting=other)
        files[name] = subject_of.columns(run, move)
        kinds.append(kind)
        moves.append((move, SECONDS.get(kind, ACTIVE)))
    moving = [each for each in zip(kinds, moves, strict=True) if each[0] not in HELD]
    of, through = zip(*(moving or zip(kinds, moves, strict=True)), strict=True)
    truth = one.truth(*one.condition(1), 1, of, moves=through)  # of what a fit is made of
    truth |= {
        "zero_deg": float(zero),
        "axis_mm": axis.tolist(),
        "wrong": wrong,
        "crosstalk": one.mounting(0).crosstalk.tolist(),
        "device": {
            k: getattr(device, k) for k in ("inertia", "weight", "angle", "drag", "friction")
        },
    }
    minutes = _minutes(steps, [seconds for _, seconds in moves])
    # second statements are of this leg, whatever is wrong with the first
    true = 1000 * one.lasting(one.subject).geometry.arm(np.zeros(1))[:, 0]
    triceps, tibialis = map(float, true + ARM_SD * one.rng(28).normal(size=2))
    zero_again = float(ZERO_SD * one.rng(29).normal() - zero)
    before, above = map(float, axis + AXIS_SD * one.rng(30).normal(size=2))
    return Session(
        *(one, device, files, table, tuple(steps), truth, minutes),
        *((triceps, tibialis), zero_again, (before, above)),
    )


def _minutes(steps: Sequence[str], trials: Sequence[float]) -> float:
    """Return the minutes that a leg is there: its trials [s], and what is beside them."""
    waits = {"zero": 0.5, "axis": 0.5, "geometry": 2.0, "excursion": 0.75, "again": 0.5}
    minutes = sum(waits.get(s, 0.0) for s in steps) + sum(trials) / 60
    return minutes + 0.25 * len(trials)


def _other_leg(family: str, seed: int) -> Any:
    from ankle_legs.make import leg

    return leg(family, seed + 5000).subject


def _other_geometry(rng: np.random.Generator, one: Leg) -> Geometry:
    """Return a table of a leg whose arms differ from this one's by some 12 to 20 %."""
    true = one.lasting(one.subject).geometry
    sign = float(rng.choice([-1, 1]))
    scales = 1 + sign * rng.uniform(0.12, 0.2, 2) * np.array([1, rng.choice([-1, 1])])
    paths = true.paths.copy()
    paths[:, 1:] *= scales[:, None]
    paths[:, 0] += 0.006 * rng.normal(size=2)
    return Geometry(true.arms * scales[:, None], paths)


def _tare(rng: np.random.Generator, one: Leg, device: Device) -> dict[str, Array]:
    """Return the empty device's record: it moves through the leg's range, nothing is on it."""
    times = fine_times(ACTIVE)
    angle = angles(one.rng(3, 10), times, *one.subject.range, "active")
    torque = device.torque(angle, float(times[1]))[::FINE]
    n = torque.size
    columns = {"time_s": times[::FINE], "angle_rad": angle[::FINE]}
    columns["torque_Nm"] = torque + one.mounting(0).zero + 0.1 * rng.normal(size=n)
    return columns | {
        f"emg_{e}_V": np.abs(2e-6 * rng.normal(size=n)) for e in ("ta", "gl", "sol", "gm")
    }


def session_toml(session: Session) -> str:
    """Return the session.toml that the laboratory writes."""
    lines, twice = ["[knowledge]"], "again" in session.steps
    if "zero" in session.steps:
        again = f", again = {session.zero_again:.1f}" if twice else ""
        lines.append(f"angle_zero_deg = {{value = 0.0, sd = {ZERO_SD}{again}}}")
    if "axis" in session.steps:
        again = ", again = [{:.0f}.0, {:.0f}.0]".format(*session.axis_again) if twice else ""
        lines.append(f"axis_mm = {{value = [0.0, 0.0], sd = {AXIS_SD}{again}}}")
    if "excursion" in session.steps:
        for group, arm in zip(("tri", "tib"), session.arms, strict=True):
            lines.append(f"arm_{group}_mm = {{value = {arm:.1f}, sd = {ARM_SD}}}")
    if "tare" in session.steps:
        lines.append('plate = "empty.csv"')
    if "geometry" in session.steps:
        lines += ['geometry = "geometry/geometry.csv"', 'geometry_of = "person"']
        lines.append(f"geometry_sd_percent = {GEOMETRY_SD:g}")
    lines += ["", "[trials]"]
    for name in session.files:
        kind = "empty device" if name == "empty" else KINDS[name.partition("-")[0]]
        lines.append(f'"{name}.csv" = "{kind}"')
    return "\n".join(lines) + "\n"


def write(session: Session, output: Path) -> Path:
    """Write a session to ``output/FAMILY-SEED`` and its truth to ``output/truth``."""
    from ankle_legs.make import write_csv, write_geometry, write_truth

    one = session.leg
    folder = output / f"{one.family}-{one.seed}"
    for name, columns in session.files.items():
        write_csv(folder / f"{name}.csv", columns, "# emg: envelope\n")
    if "geometry" in session.steps:
        write_geometry(folder / "geometry" / "geometry.csv", session.table)
    (folder / "session.toml").write_text(session_toml(session), encoding="utf-8")
    about = {"family": one.family, "seed": one.seed, "minutes": session.minutes}
    write_truth(output, folder.name, about | session.truth)
    return folder
