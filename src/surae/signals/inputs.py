"""What a model reads: signals on one uniform time axis, with everything that was done to them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import shown
from surae.base.frozen import Comparable, FrozenDict, as_read_only
from surae.base.units import FloatArray
from surae.recording import MUSCLES, SourceFile


@filed(values="values_V", count="recordings")
@dataclass(frozen=True, slots=True)
class EmgReference:
    """What EMG was divided by: one number for each muscle, the same for all recordings."""

    #: The largest envelope of the session, or of maximum voluntary contractions.
    kind: Literal["session", "mvc"]
    #: Of TA, GL, SOL, GM [V]; None for a muscle without EMG.
    values: Annotated[tuple[float | None, ...], MUSCLES]
    files: tuple[SourceFile, ...] = ()  #: Files of the recordings that it was taken of.
    count: int = 1  #: Number of these recordings.


@dataclass(frozen=True, slots=True, eq=False)
class Film(Comparable):
    """A muscle's fascicle length over time, on the film's own clock; arrays read-only."""

    channel: str  #: ``"fascicle_tib"``, or of one muscle of the triceps: ``"fascicle_gm"`` …
    time: FloatArray  #: Times of the frames in which the tracker found it [s], shape (k,).
    length: FloatArray  #: Its length [m], shape (k,).
    #: How thick the muscle is across its tendons, sin(pennation) times the length on the average
    #: [m]; 0 where no pennation was filmed.
    thickness: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class SmoothEffort(Comparable):
    """EMG envelopes as smooth as effort is, and how fast both change; arrays (4, n), read-only.

    Where a recording has none, they are made of it by filters that look ahead.
    """

    smooth: FloatArray  #: Smooth envelopes of TA, GL, SOL, GM, in the EMG's unit.
    rate: FloatArray  #: Rate of change of the envelopes [per second].
    smooth_rate: FloatArray  #: That of the smooth ones [per second].


@filed(
    n="n", sparse=("films", "second", "own_envelopes", "rectified", "emg_lost", "effort", "lead_in")
)
@dataclass(frozen=True, slots=True, eq=False)
class ModelInputs(Comparable):
    """Prepared signals of one recording, arrays read-only and of shape (n,) unless stated."""

    name: str  #: Name of the recording.
    rate_hz: float  #: Sampling rate [Hz].
    time: FloatArray  #: Uniform time axis [s].
    #: `angle`, `velocity`, `acceleration`: of the ankle, dorsiflexion positive [rad, rad/s, …].
    angle: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    #: EMG envelopes in the order TA, GL, SOL, GM, shape (n, 4); a missing muscle has zeros.
    emg: FloatArray
    emg_unit: str  #: "V", "1": volts, or a normalised envelope.
    #: Measured reaction torque [Nm], positive when the triceps pulls; None to simulate only.
    torque: FloatArray | None
    missing_emg: tuple[str, ...] = ()  #: Muscles ("ta" …) without EMG: their weights must be fixed.
    steps: tuple[str, ...] = ()  #: What was done to the signals, in order, a plain sentence each.
    prepared: bool = False  #: Whether the signals were used as they came.
    #: What each sample counts in a fit, 0 to leave it out; None: all the same.
    weight: FloatArray | None = None
    #: What unequal weights mean: how much a sample matters (True, as `Weighting` makes them), or
    #: how precise it is, noise having the inverse of the weight as its variance.
    emphasised: bool = False
    fixed: Mapping[str, float] = field(default_factory=dict)  #: Values that it prescribes.
    files: tuple[SourceFile, ...] = ()  #: What the recording was read from.
    #: What the EMG was divided by; None for volts, and for EMG that came normalised.
    emg_reference: EmgReference | None = None
    #: Cut-off [Hz] and order of the Bessel low-pass that angle and torque went through, and the EMG
    #: did not; None for no such filter.
    lowpass: tuple[float, int] | None = None
    #: Which of "velocity" and "acceleration" were measured: no filter went over them.
    measured: tuple[str, ...] = ()
    films: tuple[Film, ...] = ()  #: Fascicles that were filmed while it was recorded.
    own_envelopes: bool = False  #: Whether envelopes were made of raw EMG here, without delay.
    #: Angle [rad] and velocity [rad/s] of a second joint that the muscles cross too.
    second: tuple[FloatArray, ...] = ()
    #: Noise that rectifying left in each envelope that was made here, of TA, GL, SOL, GM: two-sided
    #: spectral density at 0 Hz of its relative error [s], see `rectified_density`; empty where
    #: envelopes came as such.
    rectified: tuple[float, ...] = ()
    #: How far its EMG may be too small for the rate of the raw EMG, see `lost_to_rate`.
    emg_lost: float = 0.0
    #: Its effort as a causal filter knows it; None: by `smooth_effort`, which looks ahead.
    effort: SmoothEffort | None = None
    #: Time [s] at its begin that stands for what was before it, see `surae.signals.lead_in`.
    lead_in: float = 0.0

    def columns(self) -> dict[str, FloatArray]:
        """The signals under the names that our CSV gives them, time first."""
        named = {"time_s": self.time, "angle_rad": self.angle}
        if self.torque is not None:
            named["torque_Nm"] = self.torque
        for index, muscle in enumerate(MUSCLES):
            if muscle not in self.missing_emg:
                named[f"emg_{muscle}_{self.emg_unit}"] = self.emg[:, index]
        return named

    def __post_init__(self) -> None:
        """Make the mapping read-only; the arrays are made so by whoever prepares them."""
        object.__setattr__(self, "fixed", FrozenDict(self.fixed))

    def __repr__(self) -> str:
        muscles = f"EMG in {self.emg_unit}" + "".join(f", no {m}" for m in self.missing_emg)
        return f"model inputs of {self.name!r}: {self.n} samples, {self.rate_hz:g} Hz, {muscles}"

    @property
    def where(self) -> str:
        """How messages call it: the file it was read from, else its name."""
        return shown(self.files[0].path) if self.files else self.name

    @property
    def n(self) -> int:
        """Number of samples."""
        return len(self.time)

    @property
    def counted(self) -> int:
        """Number of samples that count in a fit."""
        return int(np.count_nonzero(self.counts))

    @property
    def counts(self) -> npt.NDArray[np.bool_]:
        """Which samples count in a fit, shape (n,)."""
        return self.weights > 0

    @property
    def weights(self) -> FloatArray:
        """What each sample counts in a fit, 1 where there is no `weight`, shape (n,)."""
        return np.ones(self.n) if self.weight is None else self.weight


def same_signals(one: ModelInputs, other: ModelInputs) -> bool:
    """Whether both are the same signals, whatever is said of what was done to them.

    A fit adds to what is said what it decimated.
    """
    return replace(one, steps=()) == replace(other, steps=())


def inputs_as_given(
    name: str,
    rate_hz: float,
    time: FloatArray,
    motion: tuple[FloatArray, FloatArray, FloatArray],
    emg: FloatArray,
    *,
    emg_unit: str = "V",
    torque: FloatArray | None = None,
    steps: tuple[str, ...] = (),
) -> ModelInputs:
    """Inputs of signals that are used as they are: simulated ones, or a protocol's.

    `motion` is angle, velocity and acceleration [rad, rad/s, rad/s²]; all else is as of
    `ModelInputs`.
    """
    time, emg, angle, velocity, acceleration = map(as_read_only, (time, emg, *motion))
    return ModelInputs(
        name,
        rate_hz,
        time,
        angle,
        velocity,
        acceleration,
        emg,
        emg_unit,
        None if torque is None else as_read_only(torque),
        steps=steps,
        prepared=True,
    )


#: An angle [rad] or torque [Nm] that stays within this range never changes.
_STILL = 1e-6
#: No ankle turns half a circle [rad]: such an angle is in degrees, or another channel.
_FAR = np.pi


def check_estimable(inputs: ModelInputs, *, alone: bool = True) -> None:
    """Refuse inputs from which no parameter can be estimated.

    Raises
    ------
    InputError
        There is no torque, the angle or the torque never changes, or the angle is no ankle's.
    """
    if inputs.torque is None:
        raise InputError(
            f"{inputs.where}: there is no torque, so nothing can be estimated; add its column, or "
            f"simulate instead"
        )
    highest = float(np.abs(inputs.angle).max())
    if highest > _FAR:
        raise InputError(
            f"{inputs.where}: the angle reaches {highest:.3g} rad, which no ankle does; if it is "
            f'in degrees, name the column angle_deg (or write unit = "deg" in the TOML)'
        )
    for name, signal, unit in (("angle", inputs.angle, "rad"), ("torque", inputs.torque, "Nm")):
        # Holds at several angles tell together.
        if np.ptp(signal) < _STILL and (alone or name == "torque"):
            raise InputError(
                f"{inputs.where}: the {name} never changes ({signal[0]:.4g} {unit}): nothing can "
                f"be estimated; check the channel mapped to {name}"
            )
