"""How findings call channels."""

from surae.recording import MUSCLES, Channel

_NAMES = {
    "ta": "tibialis anterior",
    "gl": "gastrocnemius lateralis",
    "sol": "soleus",
    "gm": "gastrocnemius medialis",
}


def muscle_name(muscle: str) -> str:
    """A muscle in full."""
    return _NAMES[muscle]


def weight_of(muscle: str) -> str:
    """The parameter that weighs a muscle's EMG."""
    return f"g{MUSCLES.index(muscle) + 1}"


def quantity(value: float, channel: Channel) -> str:
    """A value of a channel with its unit; a normalised one has none."""
    return f"{value:.3g}" if channel.unit == "1" else f"{value:.3g} {channel.unit}"
