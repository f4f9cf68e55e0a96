"""How findings call channels."""

from surae.recording import MUSCLES

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
