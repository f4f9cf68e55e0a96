"""How large the torque of a cell is, by which the thesis's noise is measured.

Noise of 5 % of the torque's mean magnitude makes a VAF and scales all standard errors, whatever the
motion tells of the parameters. Knowing it, the two can be told apart.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.reproduction.chapter import Context
from surae.reproduction.jobs import run_jobs
from surae.reproduction.simulation.cells import Cell, TorqueSize


def with_torques(
    context: Context, name: str, found: Sequence[Cell], population: str, rate_hz: float
) -> tuple[Cell, ...]:
    """Cells with the size of their torque without noise, simulated again.

    Parameters
    ----------
    context : Context
        Of the section.
    name : str
        Of the store.
    found : sequence of Cell
        Of one study.
    population : str
        Of its subjects.
    rate_hz : float
        Its sampling rate [Hz].
    """
    groups: dict[str, list[Cell]] = {}
    for cell in found:
        label = f"{cell.model} {cell.profile} {cell.task} {cell.subject}"
        groups.setdefault(label, []).append(cell)
    jobs = {
        label: {
            "model": some[0].model,
            "profile": some[0].profile,
            "task": some[0].task,
            "population": population,
            "truth": dict(some[0].truth),
            "rate_hz": rate_hz,
            "chirps": [[cell.amplitude, cell.rate] for cell in some],
        }
        for label, some in groups.items()
    }
    sizes = run_jobs(context, name, torque_sizes, jobs)
    by_place = {
        (label, cell.amplitude, cell.rate): TorqueSize(*size)
        for label, some in groups.items()
        for cell, size in zip(some, sizes[label], strict=True)
    }
    return tuple(
        replace(
            cell,
            torque=by_place[
                f"{cell.model} {cell.profile} {cell.task} {cell.subject}",
                cell.amplitude,
                cell.rate,
            ],
        )
        for cell in found
    )


def torque_sizes(
    model: str,
    profile: str,
    task: str,
    population: str,
    truth: Mapping[str, float],
    rate_hz: float,
    chirps: Sequence[Sequence[float | None]],
) -> list[list[float]]:
    """Mean magnitude, mean and root mean square [Nm] of the torque at chirps (amplitude, rate)."""
    from surae.protocol import Protocol, chirp_rate, generate
    from surae.studies import VirtualSubject, virtual_trial

    subject, sizes = VirtualSubject(population, 0, truth), []
    still = Protocol(profile=profile, task=task, rate_hz=rate_hz)
    for amplitude, rate in chirps:
        motion = (
            still
            if not amplitude or rate is None
            else replace(still, chirp_amplitude=amplitude, chirp_rate=chirp_rate(rate))
        )
        trial = virtual_trial(subject, generate(motion), model=model, noise=0.0)
        torque = np.zeros(1) if trial.torque is None else trial.torque
        sizes.append(
            [
                float(np.abs(torque).mean()),
                float(torque.mean()),
                float(np.sqrt(np.mean(torque**2))),
            ]
        )
    return sizes


def at_equal_noise(found: Sequence[Cell]) -> tuple[Cell, ...]:
    """Cells with the SEMs that noise of 1 Nm in every cell would give.

    A standard error is proportional to the noise, equation (34): what remains is the motion's part.
    Cells whose torque is not known are left out.
    """
    return _scaled(found, lambda size: 1.0 / size.noise)


def at_signed_noise(found: Sequence[Cell]) -> tuple[Cell, ...]:
    """Cells with the SEMs that noise of the torque's signed mean would give, in the same way."""
    return _scaled(found, lambda size: size.signed_noise / size.noise)


def _scaled(found: Sequence[Cell], factor: Callable[[TorqueSize], float]) -> tuple[Cell, ...]:
    return tuple(
        replace(cell, sem={name: value * factor(cell.torque) for name, value in cell.sem.items()})
        for cell in found
        if cell.torque is not None
    )
