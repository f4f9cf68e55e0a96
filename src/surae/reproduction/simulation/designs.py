"""The studies that the simulation section runs: the thesis's grid, its variants, and our controls.

The thesis samples the muscle-tendon model at 1000 Hz since its explicit scheme is stiff (4.4); the
implicit one is not, so that both models run at the muscle model's 125 Hz here.
"""

from dataclasses import dataclass

from surae.reproduction.chapter import Context
from surae.reproduction.simulation.cells import NOISE

#: The five basic profiles (2.5.1) in the order of Figure 13.
PROFILES = ("sine", "multiple-holds", "multi-sine", "multi-sine-holds", "scaled-chirp")
MODELS = ("muscle", "muscle-tendon")
TASKS = ("part-passive", "active")
#: Chirp: amplitudes [rad], and the 23 rates [-] (2.5.1).
AMPLITUDES = (0.0, 0.1, 0.2, 0.3)
RATES = tuple(round(0.05 + 0.025 * k, 3) for k in range(23))
#: What the thesis chose (4.1.5).
CHOSEN = ("multiple-holds", "multi-sine-holds")
CHOSEN_AMPLITUDE, CHOSEN_RATE = 0.2, 0.5
#: Sampling rate [Hz] (4.4).
RATE_HZ = 125
#: Noise: repeats, amplitude and the rates from 0.3 to 0.6 (2.5.3).
NOISE_REPEATS, NOISE_AMPLITUDE = 5, 0.1
NOISE_RATES = tuple(rate for rate in RATES if rate >= 0.3)

_QUICK_RATES = (0.05, 0.2, 0.35, 0.5, 0.6)
#: Virtual subjects on whom the grid's conclusions are tried again.
_SUBJECTS, _QUICK_SUBJECTS = 20, 5


@dataclass(frozen=True, slots=True)
class Designs:
    """Each a STUDY.toml.

    Attributes
    ----------
    grid : str
        Profiles by amplitudes by rates by tasks by models, one healthy subject.
    noise : str
        Five repeats of the noise, muscle model.
    patients : str
        The grid at fewer rates, part-passive, with a patient's parameters.
    others : str
        Amplitudes at rate 0.5, part-passive, for more healthy subjects.
    explicit : tuple of str
        The muscle-tendon model by the thesis's explicit scheme, at 125 and at 1000 Hz.
    """

    grid: str
    noise: str
    patients: str
    others: str
    explicit: tuple[str, str]


def designs(context: Context) -> Designs:
    """The studies, of fewer rates and subjects where it has to be quick."""
    quick, seed = context.quick, context.seed
    rates = _QUICK_RATES if quick else RATES
    return Designs(
        grid=_toml("simulation-grid", seed, chirp_factor=rates, task=TASKS),
        noise=_toml(
            "simulation-noise",
            seed,
            model="muscle",
            chirp_amplitude=NOISE_AMPLITUDE,
            chirp_factor=(0.3, 0.5, 0.6) if quick else NOISE_RATES,
            repeats=NOISE_REPEATS,
        ),
        patients=_toml(
            "simulation-patients",
            seed,
            population="patient",
            chirp_factor=(0.1, 0.3, 0.5, 0.6) if quick else RATES[::2],
        ),
        others=_toml("simulation-others", seed, subjects=_QUICK_SUBJECTS if quick else _SUBJECTS),
        explicit=(_explicit(seed, RATE_HZ), _explicit(seed, 1000, quick)),
    )


def _explicit(seed: int, rate_hz: int, quick: bool = False) -> str:
    return _toml(
        f"simulation-explicit-{rate_hz}",
        seed,
        model="muscle-tendon",
        protocol=("multiple-holds", "multi-sine") if quick else PROFILES,
        chirp_amplitude=(0.2, 0.3) if quick else AMPLITUDES,
        integrator="explicit-euler",
        rate_hz=rate_hz,
    )


def _toml(name: str, seed: int, **factors: object) -> str:
    """A STUDY.toml; what is not given is the thesis's."""
    settings: dict[str, object] = {
        "name": name,
        "model": MODELS,
        "protocol": PROFILES,
        "chirp_amplitude": AMPLITUDES,
        "chirp_factor": CHOSEN_RATE,
        "task": "part-passive",
        "population": "healthy",
        "noise": NOISE,
        "rate_hz": RATE_HZ,
        "seed": seed,
        "starts": 2,
        **factors,
    }
    return "".join(f"{key} = {_value(value)}\n" for key, value in settings.items())


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_value(one) for one in value)}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)
