"""The settings of the preparation, each with its default and its allowed values."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from types import NoneType
from typing import Any

from surae.base.errors import within
from surae.base.formatting import named
from surae.base.setting import Request, documented, parts_of, setting
from surae.base.words import N_

#: Highest order a filter can have; it runs forward and backward, so this is 20th order in effect.
MAXIMUM_ORDER = 10


@documented
@dataclass(frozen=True, slots=True)
class Preparation(Request):
    """How a recording becomes model inputs.

    Every cut-off is the −3 dB point of what is applied in the end: filters run forward and backward
    (zero phase) and their single-pass corner is shifted so that both passes together lose 3 dB
    there. Orders are those of one pass. Defaults follow section 2.1 of van de Poll (2015), whose
    high-pass at "0.04 Hz" is read as 0.04 of the Nyquist frequency of 1024 Hz.

    Attributes
    ----------
    {settings}

    Raises
    ------
    InputError
        A value is of the wrong kind or out of range.
    """

    rate_hz: float = setting(
        256.0,
        "Highest sampling rate of the model inputs [Hz]; a slower recording keeps its own rate.",
        above=0.0,
        label=N_("Highest rate [Hz]"),
    )
    emg_highpass_hz: float | None = setting(
        41.0,
        "Butterworth high-pass of raw EMG before it is rectified [Hz]; None: no high-pass.",
        above=0.0,
        label=N_("EMG high-pass [Hz]"),
    )
    emg_highpass_order: int = setting(
        3, "Its order.", least=1, most=MAXIMUM_ORDER, label=N_("EMG high-pass: order")
    )
    emg_lowpass_hz: float | None = setting(
        None,
        "Butterworth low-pass of rectified EMG [Hz]; None: only the anti-aliasing filter.",
        above=0.0,
        label=N_("EMG low-pass [Hz]"),
    )
    emg_lowpass_order: int = setting(
        2, "Its order.", least=1, most=MAXIMUM_ORDER, label=N_("EMG low-pass: order")
    )
    bessel_hz: float | None = setting(
        20.0,
        "Bessel low-pass of angle and torque [Hz]; None: only the anti-aliasing filter.",
        above=0.0,
        label=N_("Angle and torque: low-pass [Hz]"),
    )
    bessel_order: int = setting(
        4,
        "Its order. The thesis gives none; 4 is the usual order of instrument Bessel filters, "
        "and a higher one hardly changes the pass band: all of them approach the same Gaussian.",
        least=1,
        most=MAXIMUM_ORDER,
        label=N_("Angle and torque: order"),
    )

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
        known = {setting.name: setting for setting in fields(self)}
        for name in mapping:
            named("prepare: setting", known, name)
        optional = {each.name for each in fields(self) if NoneType in parts_of(each.type)}
        off = {name: None for name in optional if mapping.get(name) is False}
        with within("prepare"):
            return replace(self, **{**mapping, **off})
