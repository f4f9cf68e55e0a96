"""Mean standard errors of simulated trials, with which those of a measurement are compared."""

from typing import TYPE_CHECKING

import numpy as np

from surae.errors import ComputationError, InputError
from surae.model import ModelOptions, get_model
from surae.progress import Progress
from surae.protocol import Protocol, generate
from surae.studies.virtual import virtual_subject, virtual_trial

if TYPE_CHECKING:
    from surae.assessment import Baseline


def make_baseline(
    protocol: Protocol,
    model: str = "muscle",
    n: int = 10,
    seed: int = 0,
    *,
    population: str = "healthy",
    noise: float = 0.05,
    options: ModelOptions | None = None,
    progress: Progress | None = None,
) -> "Baseline":
    """Mean standard errors of the free parameters over virtual subjects, to compare fits with.

    Each subject does the protocol once, simulated with the model that is fitted. The fit starts
    from the true parameters: the baseline is of fits that found them, as the thesis's was (2.7).

    Parameters
    ----------
    protocol : Protocol
        What the measured subject did too.
    model : str
        Name of the model.
    n : int
        Number of subjects.
    seed : int
        The subjects are those of the seeds `seed` … `seed` + n − 1.
    population : str
        Where they come from.
    noise : float
        Of EMG and torque, a part of each signal's mean magnitude.
    options : ModelOptions, optional
        The model's switches.
    progress : callable, optional
        Called after every subject.

    Returns
    -------
    Baseline
        Mean SEM, equation (34), in the parameter's unit; a parameter that no fit could tell, or
        that ended at a bound in all of them, is left out.

    Raises
    ------
    InputError
        Something given is unknown or no number of subjects.
    ComputationError
        No parameter of any subject has a standard error.
    """
    from surae.assessment import Baseline, covariance  # the compiler: only when something is fitted
    from surae.estimation import fit_problem, make_problem

    if n < 1:
        raise InputError(f"{n} subjects; give at least 1")
    options, trajectory = options or ModelOptions(), generate(protocol)
    spec = get_model(model)
    tendons = any(p.group == "tendon" and p.name in spec.free for p in spec.parameters)
    values_by_name: dict[str, list[float]] = {}
    for number in range(n):
        subject = virtual_subject(seed + number, population, tendons=tendons)
        trial = virtual_trial(subject, trajectory, model=model, options=options, noise=noise)
        truth = subject.truth(model, options)
        result = fit_problem(make_problem([trial], model, start=truth, options=options), starts=1)
        problem = result.problem
        if result.status != "failed":
            known = covariance(result.R, problem.free, result.sse, problem.n, result.bounded)
            for name, variance in zip(known.names, np.diag(known.matrix).tolist(), strict=True):
                values_by_name.setdefault(name, []).append(float(np.sqrt(variance)))
        if progress is not None:
            progress(number + 1, n)
    if not values_by_name:
        raise ComputationError("no simulated fit gave a standard error; use another protocol")
    sem = {
        name: float(np.mean(values_by_name[name])) for name in spec.names if name in values_by_name
    }
    chirp = ""
    if protocol.chirp_amplitude:
        chirp = f", chirp {protocol.chirp_amplitude:g} rad at {protocol.chirp_rate:g} Hz/s"
    device = f" on the {protocol.device.name}" if protocol.device else ""
    about = (
        f"{n} {population} virtual subject{'' if n == 1 else 's'} from seed {seed}, "
        f"{protocol.profile}{chirp}{device}, {protocol.task}, {protocol.seconds:g} s at "
        f"{protocol.rate_hz:g} Hz, noise {100 * noise:g} %"
    )
    return Baseline(model, options, sem, about)
