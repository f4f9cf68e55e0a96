"""The trajectories that the figures and the claims speak of."""

from functools import cache

from surae.protocol import DEVICES, Protocol, Trajectory, chirp_rate, generate

#: The five basic profiles of the simulation study (2.5.1) after the one in use before it (2.1).
NAMES = (
    "ramp-and-hold",
    "sine",
    "multiple-holds",
    "multi-sine",
    "multi-sine-holds",
    "scaled-chirp",
)
#: The two that were chosen for the subjects, with their chirp (4.1.5).
CHOSEN = ("multiple-holds", "multi-sine-holds")
AMPLITUDE, RATE = 0.2, 0.5
#: Fine enough that no peak of a velocity is missed.
RATE_HZ = 512.0


@cache
def basic(profile: str, task: str = "part-passive") -> Trajectory:
    """A profile without a chirp."""
    return generate(Protocol(profile=profile, task=task, rate_hz=RATE_HZ))


@cache
def chirped(profile: str, amplitude: float = AMPLITUDE, rate: float = RATE) -> Trajectory:
    """A profile with the chirp, for a device without limits."""
    return generate(
        Protocol(
            profile=profile,
            chirp_amplitude=amplitude,
            chirp_rate=chirp_rate(rate),
            rate_hz=RATE_HZ,
        )
    )


@cache
def for_achilles(profile: str) -> Trajectory:
    """A chosen profile as the manipulator of the thesis can follow it."""
    return generate(
        Protocol(
            profile=profile,
            chirp_amplitude=AMPLITUDE,
            chirp_rate=chirp_rate(RATE),
            rate_hz=RATE_HZ,
            device=DEVICES["achilles"],
        )
    )
