"""A recording as measured: channels with their own time axes, in SI units, never changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.files import shown
from surae.base.formatting import check_known, nearest
from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.numbers import real_numbers
from surae.base.records import FileName
from surae.base.units import SI, FloatArray, kind
from surae.recording.table import check_samples

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Muscles by the names of their channels, in the order of the equations (12) and (13).
MUSCLE_NAMES = {
    "ta": "tibialis anterior",
    "gl": "gastrocnemius lateralis",
    "sol": "soleus",
    "gm": "gastrocnemius medialis",
}
MUSCLES = tuple(MUSCLE_NAMES)

#: What the EMG of a recording may be.
EMG_KINDS = ("raw", "envelope")
#: Muscles whose fascicles are filmed: the tibialis, and those of the triceps.
FILMED = ("tib", "gl", "sol", "gm")
#: What may be filmed: those, and a second place of the tibialis.
PLACES = (*FILMED, "tib2")

#: Every role a channel can have, in the order in which they are listed.
ROLES = (
    "angle",
    "torque",
    *(f"emg_{muscle}" for muscle in MUSCLES),
    "angular_velocity",
    "angular_acceleration",
    "second_angle",  # of a joint that the muscles cross too, such as the knee
    "commanded_angle",  # that the device was told to take
    *(f"{seen}_{muscle}" for seen in ("fascicle", "pennation") for muscle in PLACES),
)
#: Roles that a film shows: it has a clock of its own, may lose frames and need not last.
FILM_ROLES = tuple(role for role in ROLES if role.startswith(("fascicle_", "pennation_")))


#: Largest values of a channel by its kind, in SI units: beyond these nothing was measured. Noise of
#: an amplifier is above 1e-9 V, and a normalised EMG of 1e6 is in the wrong unit by any factor.
_SIZES = {
    "angle": (1e-9, 1e5),
    "torque": (1e-9, 1e6),
    "emg": (1e-12, 1e9),
    "length": (1e-9, 1e5),
    "angular_velocity": (1e-9, 1e7),
    "angular_acceleration": (1e-9, 1e9),
}
#: Seconds from sample to sample, on average: 10 MHz, and a sample in twelve days.
_STEPS = (1e-7, 1e6)


def weight_of(muscle: str) -> str:
    """The parameter that weighs a muscle's EMG: ``"g1"`` for ``"ta"``."""
    return f"g{MUSCLES.index(muscle) + 1}"


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file that a recording was read from: its path as given and its SHA-256.

    Folders may be named after patients: what is written says `name`, never `path`.
    """

    path: FileName = field(compare=False)
    sha256: str

    @property
    def name(self) -> str:
        """The file's own name, without folders of any system."""
        return self.path.replace("\\", "/").rsplit("/", 1)[-1]


@dataclass(frozen=True, slots=True, eq=False)
class Channel(Comparable):
    """One measured signal."""

    role: str  #: One of `ROLES`.
    time: FloatArray  #: Increasing times of the samples [s], shape (n,).
    #: The signal in `unit`, sign applied, shape (n,): angle dorsiflexion positive, torque positive
    #: when the triceps pulls.
    values: FloatArray
    unit: str  #: SI unit (`surae.base.units.SI`), or ``"1"`` for a normalised EMG envelope.
    source: str  #: Where it came from and what was applied: ``"ik.sto: ankle_angle_r [deg]"``.

    def __post_init__(self) -> None:
        """Refuse sizes and times of which a wrong unit, or no measurement, is the only reason."""
        least, most = _SIZES.get(kind(self.role), _SIZES["angle"])
        top = 0.0
        if len(self.values):
            top = max(float(np.fmax.reduce(self.values)), -float(np.fmin.reduce(self.values)))
        if top > most or 0.0 < top < least:
            raise InputError(
                f"{self.source}: {self.role} is about {top:.0e} {self.unit}: wrong unit? Give the "
                "right one, or a scale"
            )
        if len(self.time) > 1:
            step = (self.time[-1] - self.time[0]) / (len(self.time) - 1)
            if not _STEPS[0] < step < _STEPS[1] or abs(self.time[0]) > _STEPS[1] ** 2:
                raise InputError(
                    f"{self.source}: samples are about {step:.0e} s apart: wrong unit of time? "
                    "Give the right one"
                )

    @property
    def rate_hz(self) -> float:
        """Mean sampling rate [Hz]."""
        return float((len(self.time) - 1) / (self.time[-1] - self.time[0]))

    @property
    def filmed(self) -> bool:
        """Whether a film shows it."""
        return self.role in FILM_ROLES


@dataclass(frozen=True, slots=True)
class Recording:
    """One trial of one leg.

    Raises
    ------
    InputError
        Some EMG is in volts and some normalised: their weights would not compare.
    """

    name: str  #: Shown in tables and figures.
    #: By role, in the order of `ROLES`; angle is always there.
    channels: Mapping[str, Channel]
    #: Whether the EMG is raw (the EMG chain applies) or envelopes already.
    emg: Literal["raw", "envelope"] = "raw"
    fixed: Mapping[str, float] = field(default_factory=dict)  #: Parameters that it prescribes.
    #: Settings of the preparation that its description overrides.
    prepare: Mapping[str, Any] = field(default_factory=dict)
    files: tuple[SourceFile, ...] = ()  #: What it was read from; empty for a simulated one.
    side: str | None = None  #: "left", "right", where its description says so.
    #: What its description says of the measuring device.
    device: Mapping[str, Any] = field(default_factory=dict)

    @property
    def where(self) -> str:
        """How messages call it: the file it was read from, else its name."""
        return shown(self.files[0].path) if self.files else self.name

    def __post_init__(self) -> None:
        """Order the channels and make the mappings read-only."""
        ordered = {role: self.channels[role] for role in ROLES if role in self.channels}
        object.__setattr__(self, "channels", FrozenDict(ordered))
        for name in ("fixed", "prepare", "device"):
            object.__setattr__(self, name, FrozenDict(getattr(self, name)))
        emg = [channel for role, channel in ordered.items() if kind(role) == "emg"]
        for channel in emg[1:]:
            if channel.unit != emg[0].unit:
                raise InputError(
                    f"{self.where}: {emg[0].role} is in {emg[0].unit!r} but {channel.role} in "
                    f"{channel.unit!r}; give all EMG in volts or all normalised ('1')"
                )

    def __getitem__(self, role: str) -> Channel:
        """The channel of a role: ``rec["angle"].values``.

        Raises
        ------
        InputError
            The recording has no such channel.
        """
        if role not in self.channels:
            raise InputError(
                f"{self.where} has no channel {role!r}{nearest(role, self.channels)}; it has: "
                f"{', '.join(self.channels)}"
            )
        return self.channels[role]

    def crop(self, start: float, end: float) -> "Recording":
        """The part between two times, whose clock goes on as it was.

        Parameters
        ----------
        start, end : float
            First and last time that are kept [s].

        Returns
        -------
        Recording
            All else as in this one.

        Raises
        ------
        InputError
            A channel has fewer than two samples there.
        """
        kept = {}
        for role, channel in self.channels.items():
            inside = (channel.time >= start) & (channel.time <= end)
            if inside.sum() < 2:
                raise InputError(
                    f"{self.where}: {role} has no two samples between {start:g} and {end:g} s; it "
                    f"lasts from {channel.time[0]:g} to {channel.time[-1]:g} s"
                )
            kept[role] = replace(
                channel,
                time=read_only(channel.time[inside]),
                values=read_only(channel.values[inside]),
            )
        return replace(self, channels=kept)

    @property
    def signals(self) -> Mapping[str, Channel]:
        """The channels that the robot recorded, without what a film shows."""
        return {role: each for role, each in self.channels.items() if not each.filmed}

    @property
    def shared(self) -> tuple[float, float]:
        """Begin and end of the time that all signals share [s]; a negative span where none."""
        spans = [(float(c.time[0]), float(c.time[-1])) for c in self.signals.values()]
        return max(begin for begin, _ in spans), min(end for _, end in spans)

    @property
    def films(self) -> Mapping[str, Channel]:
        """What a film shows: fascicles' lengths and pennation."""
        return {role: each for role, each in self.channels.items() if each.filmed}

    def __repr__(self) -> str:
        emg = {"raw": "raw EMG", "envelope": "EMG envelopes"}[self.emg]
        lines = [f"Recording {self.name!r}: {', '.join(filter(None, (self.side, emg)))}"]
        for role, channel in self.channels.items():
            low = channel.values.min()
            high = channel.values.max()
            lines.append(
                f"  {role:<21}{len(channel.values):>8} samples, {channel.rate_hz:.6g} Hz, "
                f"{low:.4g} … {high:.4g} {'' if channel.unit == '1' else channel.unit}".rstrip()
                + f"  ({channel.source})"
            )
        if self.fixed:
            lines.append(f"  fixed: {dict(self.fixed)}")
        return "\n".join(lines)

    def plot(self) -> "Sequence[Axes]":
        """Draw the signals against time: angle, torque, EMG, one below the other.

        Returns
        -------
        sequence of matplotlib.axes.Axes
            A panel for each kind of signal.
        """
        from surae.recording.frames import plotted

        return plotted(self.name, self.channels)

    def to_dataframe(self) -> Any:
        """The channels as a pandas DataFrame with the columns of our CSV.

        Returns
        -------
        pandas.DataFrame
            Time and channels, units in ``attrs["units"]``; `surae.fit` takes it. Channels with
            times of their own share one column of all times, and are NaN where they have no
            sample: ``attrs["times"]`` is then ``"own"``.

        Raises
        ------
        InputError
            The package pandas is not installed.
        """
        from surae.recording.frames import channels_frame

        return channels_frame(self.channels, {"name": self.name, "emg": self.emg})

    def to_xarray(self) -> Any:
        """The channels as an xarray Dataset over time, as `to_dataframe` has them.

        Returns
        -------
        xarray.Dataset
            By ``time_s``, units as attributes.

        Raises
        ------
        InputError
            The package pandas or xarray is not installed.
        """
        from surae.recording.frames import library

        library("xarray", "a Dataset")
        table = self.to_dataframe()
        made = table.set_index("time_s").to_xarray().assign_attrs(name=self.name, emg=self.emg)
        for name in made:
            made[name].attrs["units"] = table.attrs["units"][name]
        return made

    @classmethod
    def from_arrays(
        cls,
        time: npt.ArrayLike,
        angle: npt.ArrayLike,
        torque: npt.ArrayLike | None = None,
        emg: npt.ArrayLike | None = None,
        *,
        name: str = "arrays",
        emg_kind: Literal["raw", "envelope"] = "raw",
        velocity: npt.ArrayLike | None = None,
        acceleration: npt.ArrayLike | None = None,
    ) -> "Recording":
        """Build a recording from arrays on one time axis, which are copied.

        Parameters
        ----------
        time : array_like, shape (n,)
            Increasing times [s], at least two.
        angle : array_like, shape (n,)
            Ankle angle [rad], dorsiflexion positive.
        torque : array_like, shape (n,), optional
            Reaction torque [Nm], positive when the triceps pulls.
        emg : array_like, shape (n, 4), optional
            EMG [V] in the order of `MUSCLES`.
        name : str
            Name shown in tables and figures.
        emg_kind : {"raw", "envelope"}
            Whether `emg` is raw or already envelopes.
        velocity, acceleration : array_like, shape (n,), optional
            Derivatives of the angle [rad/s, rad/s²], used as they are.

        Returns
        -------
        Recording
            Its channels are read-only copies.

        Raises
        ------
        InputError
            A shape is wrong, a sample is not finite, or time doesn't increase; the message names
            the array and the sample.
        """
        check_known(f"{name}: emg_kind", EMG_KINDS, emg_kind)
        axis = _floats(time, name, "time")
        arrays = {
            "angle": angle,
            "torque": torque,
            "angular_velocity": velocity,
            "angular_acceleration": acceleration,
        }
        signals = {role: _floats(a, name, role) for role, a in arrays.items() if a is not None}
        if emg is not None:
            table = _floats(emg, name, "emg")
            if table.shape != (len(axis), len(MUSCLES)):
                raise InputError(
                    f"{name}: emg has shape {table.shape}; it must be ({len(axis)}, "
                    f"{len(MUSCLES)}), one column each for {', '.join(MUSCLES)}"
                )
            signals |= {f"emg_{m}": read_only(table[:, i]) for i, m in enumerate(MUSCLES)}
        for role, values in signals.items():
            check_samples(axis, values, where=name, names=("time", role))
        channels = {
            role: Channel(role, axis, values, SI[kind(role)], f"array: {role} [{SI[kind(role)]}]")
            for role, values in signals.items()
        }
        return cls(name=name, channels=channels, emg=emg_kind)


def _floats(values: npt.ArrayLike, where: str, name: str) -> FloatArray:
    """A read-only copy of an argument as numbers of at least one dimension."""
    try:
        array = real_numbers(values)
    except (TypeError, ValueError) as error:
        raise InputError(f"{where}: {name} is not an array of numbers: {error}") from None
    if array.ndim == 0:
        raise InputError(f"{where}: {name} is a single number; it must be an array")
    return array
