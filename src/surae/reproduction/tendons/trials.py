"""The trials that the claims on tendons need, simulated once."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from surae.model import ModelOptions, TendonState, get_model
from surae.model.simulator import Simulator
from surae.protocol import Protocol, chirp_rate, generate
from surae.signals import ModelInputs
from surae.studies.populations import VirtualSubject, virtual_subject
from surae.studies.virtual import virtual_trial
from surae.units import FloatArray

#: The virtual subject whose leg it is: the first; nothing is chosen by it.
SUBJECT = 1
#: Rates at which both schemes are tried [Hz]; the thesis used the second last (4.4).
RATES = (125.0, 256.0, 512.0, 1000.0, 2000.0)
SCHEMES = ("implicit", "explicit-euler")
_NONE: Mapping[str, float] = {}


@dataclass(frozen=True, slots=True)
class Errors:
    """RMS error of the torque by scheme and rate, in percent of the torque's RMS."""

    reference_hz: float
    of: Mapping[tuple[str, float], float]


def subject() -> VirtualSubject:
    """Whose leg the section simulates."""
    return virtual_subject(SUBJECT)


@cache
def trial(rate_hz: float, profile: str, amplitude: float, task: str) -> ModelInputs:
    """A trial without noise."""
    trajectory = generate(
        Protocol(
            profile=profile,
            task=task,
            chirp_amplitude=amplitude,
            chirp_rate=chirp_rate(0.5),
            rate_hz=rate_hz,
        )
    )
    return virtual_trial(subject(), trajectory, model="muscle-tendon", noise=0.0)


def chirped(rate_hz: float) -> ModelInputs:
    """The trial on which both schemes are compared."""
    return trial(rate_hz, "multiple-holds", 0.2, "part-passive")


def states(
    inputs: ModelInputs, scheme: str, *, tendon_strain: str = "thesis", **tendon: float
) -> TendonState:
    """What muscles and tendons do in it, with other tendon parameters where they are given."""
    simulator, values = _tied(inputs, scheme, tendon_strain, tendon)
    state = simulator.tendon(values)
    assert state is not None  # the model has tendons
    return state


def torque(inputs: ModelInputs, scheme: str) -> FloatArray:
    """The modelled torque [Nm], shape (n,)."""
    simulator, values = _tied(inputs, scheme)
    with np.errstate(over="ignore", invalid="ignore"):
        found: FloatArray = simulator.torque(values)
    return found


def _tied(
    inputs: ModelInputs, scheme: str, strain: str = "thesis", given: Mapping[str, float] = _NONE
) -> tuple[Simulator, FloatArray]:
    spec = get_model("muscle-tendon")
    options = ModelOptions(integrator=scheme, tendon_strain=strain)
    truth = {**subject().truth(spec.name), **given}
    return spec.simulator(inputs, options), spec.vector(truth, options)


@cache
def errors(*, quick: bool = False) -> Errors:
    """How far each scheme at each rate is from the implicit one at a rate far above.

    All start from the same EMG: that of the fine trial at the samples of the coarse one.
    """
    finest = 8000.0
    exact = chirped(finest)
    reference = torque(exact, "implicit")
    scale = float(np.sqrt(np.mean(reference**2)))
    found = {}
    for rate in RATES[::2] if quick else RATES:
        inputs = chirped(rate)
        at = np.interp(inputs.time, exact.time, reference)
        for scheme in SCHEMES:
            off = torque(inputs, scheme) - at
            found[scheme, rate] = 100 * float(np.sqrt(np.mean(off**2))) / scale
    return Errors(finest, found)
