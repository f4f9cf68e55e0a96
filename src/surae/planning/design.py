"""A designed protocol: searched, held to its device, judged on legs that the search never saw."""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.base.file_form import filed
from surae.base.files import PathLike
from surae.base.formatting import part
from surae.base.frozen import Comparable, FrozenDict
from surae.base.records import Plain
from surae.base.tables import Tabular, TextTable
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.planning.aimed import aimed_errors
from surae.planning.at_rest import expected_at_rest
from surae.planning.expectation import Expectation, expected
from surae.planning.genes import Genes
from surae.planning.legs import Legs
from surae.planning.plan import Limits, Plan, eased, highest_hz, limits_of
from surae.planning.ready import Ready
from surae.planning.search import SEARCH_RATE, SearchBudget, make_aim, search
from surae.planning.torque import within_torque
from surae.protocol import Device, Trajectory, write_protocol

#: Part of the device's torque that the search keeps to, for legs stronger than those it sees.
_RESERVE = 0.93


@filed("trajectory", "device", "aimed", "curve", "seconds", "stopped")
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Design(Tabular, Comparable, Plain):
    """A designed protocol and what it will tell."""

    plan: Plan  #: The protocol as ramps, perturbations and bursts.
    limits: Limits  #: Of the movement.
    trajectory: Trajectory  #: The same, sampled.
    device: Device | None  #: Whose limits it keeps.
    expectation: Expectation  #: What it will tell of legs that the search did not see.
    #: Relative standard error of each parameter or measure that was aimed at by name, root mean
    #: square over those legs; None where the trial does not determine it.
    aimed: Mapping[str, float | None]
    notes: tuple[str, ...]  #: What was given up for device and subject, a sentence each.
    #: Plans judged, seconds, and the cost of the best one, as the search went on.
    curve: tuple[tuple[int, float, float], ...]
    seconds: float  #: Time that the search took [s].
    stopped: bool  #: Whether the user ended it: then this is the best plan until then.

    def as_table(self) -> TextTable:
        """What it will tell, and what was given up."""
        table = self.expectation.as_table()
        plans = f"{self.curve[-1][0]:,} plans to the best"
        aims = [f"{name} {part(sem)}" for name, sem in self.aimed.items()]
        aimed = [f"standard error of what was aimed at: {', '.join(aims)}"] if aims else []
        below = (*table.below, *self.notes, *aimed, f"{plans}; {self.seconds:.0f} s")
        return replace(table, below=below)

    def write(self, path: PathLike, *, without_limits: str | None = None) -> None:
        """Write the protocol for a device: CSV, or MATLAB where the path ends in ``.mat``.

        Parameters
        ----------
        path : path
            Where to.
        without_limits : str, optional
            Without a device, why its limits need not be kept; that is in the file.
        """
        write_protocol(self.trajectory, path, without_limits=without_limits)


@dataclass(frozen=True, slots=True)
class Asked:
    """What kind of a protocol is asked for."""

    name: str  #: What it is to be called.
    seconds: float  #: Duration [s].
    rate_hz: float  #: At which it is written and recorded.
    device: Device | None  #: Whose limits hold.
    angle_range: tuple[float, float]  #: Of the subject [rad].
    effort: bool  #: Whether the subject's efforts are designed too.
    aim: str  #: What is to be known well, as of `make_aim`.


@dataclass(frozen=True, slots=True, eq=False)
class Judges:
    """By which legs protocols are judged, and what is known without the trial."""

    legs: Legs  #: While it is searched.
    unseen: Legs  #: Others, by which the end is judged.
    noise: float  #: Of one sample of the torque [Nm].
    known: FloatArray | None = None  #: Information without the trial, shape (p, p).
    precision: Mapping[str, Any] = FrozenDict()  #: As of `expected`.


def make_design(
    asked: Asked, judges: Judges, budget: SearchBudget, start: Ready | None = None
) -> Design:
    """Search a protocol from `start`, hold it to the device, and judge it.

    Where the device cannot do it, the message says what to give up.
    """
    begin = time.perf_counter()
    device = asked.device
    unseen = judges.unseen
    limits = limits_of(device, asked.angle_range)
    genes = Genes(asked.name, asked.seconds, limits, highest_hz(device), asked.effort)
    torque = math.inf if device is None else device.max_torque
    relaxed = eased(genes.plan(genes.start()), 0.0)
    _, limits, given_up = within_torque(relaxed, limits, unseen, device)
    genes = replace(genes, limits=limits)
    result = search(
        genes,
        judges.legs,
        make_aim(asked.aim, judges.legs, tuple(np.degrees(asked.angle_range))),
        noise=judges.noise * (SEARCH_RATE / asked.rate_hz) ** 0.5,
        torque=_RESERVE * torque,
        budget=budget,
        known=judges.known,
        start=None if start is None else genes.carried(start.genes, start.counts),
    )
    plan, limits, notes = within_torque(genes.plan(result.genes), limits, unseen, device)
    trajectory = plan.trajectory(limits, asked.rate_hz, device=device, legs=unseen.spec.name)
    span = float(np.ptp(trajectory.angle)) / (limits.high - limits.low)
    reached = () if span > 0.98 else (Message("plan/used", percent=100 * span),)
    if result.stopped:
        notes = (*notes, Message("plan/stopped", n=result.evaluations))
    return Design(
        plan,
        limits,
        trajectory,
        device,
        expectation=replace(
            expected(trajectory, unseen, judges.noise, **judges.precision),
            at_rest=expected_at_rest(trajectory, unseen, judges.noise),
        ),
        aimed=FrozenDict(aimed_errors(trajectory, unseen, judges.noise, asked.aim, judges.known)),
        notes=(*reached, *given_up[:-1], *notes),
        curve=result.curve,
        seconds=time.perf_counter() - begin,
        stopped=result.stopped,
    )
