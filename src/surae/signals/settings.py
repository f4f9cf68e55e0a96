"""The settings of the preparation, each with its default and its allowed values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from surae.errors import InputError

#: Settings that can be switched off: None in Python, ``false`` in a TOML file.
OPTIONAL = ("emg_highpass_hz", "emg_lowpass_hz", "bessel_hz")

#: Highest order a filter can have; it runs forward and backward, so this is 20th order in effect.
MAXIMUM_ORDER = 10


@dataclass(frozen=True, slots=True)
class Preparation:
    """How a recording becomes model inputs.

    Every cut-off is the −3 dB point of what is applied in the end: filters run forward and backward
    (zero phase) and their single-pass corner is shifted so that both passes together lose 3 dB
    there. Orders are those of one pass. Defaults follow section 2.1 of van de Poll (2015), whose
    high-pass at "0.04 Hz" is read as 0.04 of the Nyquist frequency of 1024 Hz.

    Attributes
    ----------
    rate_hz : float
        Highest sampling rate of the model inputs [Hz]; a slower recording keeps its own rate.
    emg_highpass_hz : float or None
        Butterworth high-pass of raw EMG before it is rectified [Hz]; None: no high-pass.
    emg_highpass_order : int
        Its order.
    emg_lowpass_hz : float or None
        Butterworth low-pass of rectified EMG [Hz]; None: only the anti-aliasing filter.
    emg_lowpass_order : int
        Its order.
    bessel_hz : float or None
        Bessel low-pass of angle and torque [Hz]; None: only the anti-aliasing filter.
    bessel_order : int
        Its order. The thesis gives none; 4 is the usual order of instrument Bessel filters, and a
        higher one hardly changes the pass band: all of them approach the same Gaussian.

    Raises
    ------
    InputError
        A value is of the wrong kind or out of range.
    """

    rate_hz: float = 256.0
    emg_highpass_hz: float | None = 41.0
    emg_highpass_order: int = 3
    emg_lowpass_hz: float | None = None
    emg_lowpass_order: int = 2
    bessel_hz: float | None = 20.0
    bessel_order: int = 4

    def __post_init__(self) -> None:
        """Check every value."""
        for setting in fields(self):
            _check(setting.name, getattr(self, setting.name))

    def updated(self, mapping: Mapping[str, Any]) -> "Preparation":
        """These settings with those of `mapping` in their place.

        Parameters
        ----------
        mapping : mapping of str to object
            Settings by name, as in a TOML's ``[prepare]``; False switches an optional filter off.

        Returns
        -------
        Preparation
            All settings, the others as they were.

        Raises
        ------
        InputError
            A setting is not known or its value is not allowed.
        """
        known = [setting.name for setting in fields(self)]
        for name in mapping:
            if name not in known:
                raise InputError(
                    f"prepare: setting {name!r} is not known; use one of: {', '.join(known)}"
                )
        off = {name: None for name in OPTIONAL if mapping.get(name) is False}
        return replace(self, **{**mapping, **off})


def _check(name: str, value: Any) -> None:
    """Raise InputError unless `value` is allowed for the setting `name`."""
    if name.endswith("_order"):
        whole = isinstance(value, int) and not isinstance(value, bool)
        if not whole or not 1 <= value <= MAXIMUM_ORDER:
            raise InputError(
                f"prepare: {name} is {value!r}; use a whole number from 1 to {MAXIMUM_ORDER}"
            )
        return
    if value is None and name in OPTIONAL:
        return
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not math.isfinite(value) or value <= 0:
        off = ", or false to leave it out" if name in OPTIONAL else ""
        raise InputError(f"prepare: {name} is {value!r}; use a number above 0, in Hz{off}")
