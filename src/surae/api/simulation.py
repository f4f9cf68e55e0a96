"""What a model gives for a recording: torque, its parts, its tendons."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from surae.api.given import AnyRecording, read_in
from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.model import (
    MODELS,
    ModelOptions,
    ModelSpec,
    TendonState,
    TorqueParts,
    check_finite_torque,
    get_model,
    with_optional,
)
from surae.protocol import Trajectory, read_protocol
from surae.recording import MUSCLES, Channel, Recording
from surae.signals import ModelInputs, prepare


@overload
def simulate(
    model: str,
    parameters: Mapping[str, float],
    recording: AnyRecording,
    *,
    jacobian: Literal[False] = False,
    **options: Any,
) -> FloatArray: ...


@overload
def simulate(
    model: str,
    parameters: Mapping[str, float],
    recording: AnyRecording,
    *,
    jacobian: Literal[True],
    **options: Any,
) -> tuple[FloatArray, FloatArray]: ...


def simulate(
    model: str,
    parameters: Mapping[str, float],
    recording: AnyRecording,
    *,
    jacobian: bool = False,
    **options: Any,
) -> FloatArray | tuple[FloatArray, FloatArray]:
    """Torque that a model gives for the angle and EMG of a recording, used as they are.

    Parameters
    ----------
    model : str
        Name of the model.
    parameters : mapping of str to float
        Its parameters; those it does not free by default may be left out. So may those of its
        drives: `emd`, and `reflex_tri`, `reflex_tib`, `reflex_delay`, off unless given.
    recording : Recording, ModelInputs, Trajectory or path
        Angle and EMG on one uniform time axis. Of raw EMG the envelopes are used, made and sampled
        as a fit does by default; of a protocol, whose file is read too, the efforts as EMG in parts
        of the largest.
    jacobian : bool
        Also return the derivatives of the torque.
    **options
        Model options, see `surae.model.ModelOptions`.

    Returns
    -------
    torque : ndarray, shape (n,)
        Modelled torque [Nm].
    jacobian : ndarray, shape (n, p)
        Its derivatives by the parameters that the model frees by default, in its order, then by
        those given of its drives; only with ``jacobian=True``.

    Raises
    ------
    InputError
        Something given is unknown, missing or unusable.
    ComputationError
        The torque is not finite; the message names the first such sample.

    Examples
    --------
    >>> values = surae.load("fit.json").values
    >>> torque = surae.simulate("muscle", values, "trial.csv")
    """
    spec = with_optional(get_model(model), parameters)
    chosen = ModelOptions.of(**options)
    inputs = to_simulate(recording)
    simulator = spec.simulator(inputs, chosen)
    values = spec.vector(parameters, chosen)
    wanted = (*spec.free, *(name for name in spec.optional if name in parameters))
    columns = [spec.names.index(name) for name in wanted]
    with _quietly():
        if not jacobian:
            torque = simulator.torque(values)
            check_finite_torque(torque, inputs)
            return torque
        torque, rows = simulator.torque_jacobian(values, columns)
        check_finite_torque(torque, inputs)
        return torque, rows.T


def simulate_parts(
    model: str, parameters: Mapping[str, float], recording: AnyRecording, **options: Any
) -> TorqueParts:
    """The torque of `simulate`, split into its parts.

    Parameters
    ----------
    model, parameters, recording, **options
        As of `simulate`.

    Returns
    -------
    TorqueParts
        Each part over time [Nm], shape (n,).

    Raises
    ------
    InputError
        Something given is unknown, missing or unusable.
    ComputationError
        The torque is not finite.

    Examples
    --------
    >>> values = surae.load("fit.json").values
    >>> surae.simulate_parts("muscle", values, "trial.csv").tissue.max()
    """
    inputs = to_simulate(recording)
    spec = with_optional(get_model(model), parameters)
    return parts_of(spec, parameters, inputs, ModelOptions.of(**options))


def simulate_tendon(
    model: str, parameters: Mapping[str, float], recording: AnyRecording, **options: Any
) -> TendonState:
    """Lengths, velocities and forces of muscles and tendons over time.

    Where the model has no finite state, the result says so itself, in `TendonState.unsolved`.

    Parameters
    ----------
    model, parameters, recording, **options
        As of `simulate`.

    Returns
    -------
    TendonState
        Of triceps and tibialis.

    Raises
    ------
    InputError
        The model's tendons are rigid, or something given is unknown, missing or unusable.

    Examples
    --------
    >>> values = surae.load("fit.json").values
    >>> surae.simulate_tendon("muscle-tendon", values, "trial.csv").elongation.max()
    """
    inputs = to_simulate(recording)
    spec = with_optional(get_model(model), parameters)
    return tendon_of(spec, parameters, inputs, ModelOptions.of(**options))


def to_simulate(recording: AnyRecording | Trajectory) -> ModelInputs:
    """What a simulation is made of: signals as they are, but for raw EMG, which no model takes.

    Raises
    ------
    InputError
        It cannot be read, or not be used so.
    """
    measured = to_read(recording)
    if isinstance(measured, ModelInputs):
        return measured
    raw = measured.emg == "raw" and any(role.startswith("emg_") for role in measured.channels)
    return prepare(measured, prepared=not raw or _is_rectified(measured))


def to_read(recording: AnyRecording | Trajectory) -> Recording | ModelInputs:
    """A recording as it is given or lies in a file, which may be of a protocol."""
    if isinstance(recording, Trajectory):
        return _of_protocol(recording)
    if isinstance(recording, str | Path):
        with suppress(InputError):  # else it is a recording, and reading it says what is wrong
            return _of_protocol(read_protocol(recording), Path(recording).stem)
    return read_in(recording)


def _is_rectified(recording: Recording) -> bool:
    """Whether what is said to be raw never goes below zero, as no raw EMG does."""
    emg = [c.values for role, c in recording.channels.items() if role.startswith("emg_")]
    return all(float(values.min()) >= 0.0 for values in emg)


def _of_protocol(trajectory: Trajectory, name: str = "") -> Recording:
    """What a protocol asks for as a recording: efforts are EMG in parts of the largest."""
    said = "requested by a protocol"
    channels = {"angle": Channel("angle", trajectory.time, trajectory.angle, "rad", said)}
    for muscle, effort in zip(MUSCLES, trajectory.effort.T, strict=True):
        role = f"emg_{muscle}"
        channels[role] = Channel(role, trajectory.time, effort, "1", said)
    return Recording(name=name or trajectory.settings.profile, channels=channels, emg="envelope")


def _quietly() -> np.errstate:
    """No warnings of numbers that overflow: a torque that is not finite is refused in words."""
    return np.errstate(over="ignore", invalid="ignore")


def parts_of(
    spec: ModelSpec, values: Mapping[str, float], inputs: ModelInputs, options: ModelOptions
) -> TorqueParts:
    """The torque of a model for one recording, in parts."""
    with _quietly():
        parts = spec.simulator(inputs, options).parts(spec.vector(values, options))
        check_finite_torque(parts.total, inputs)
    return parts


def tendon_of(
    spec: ModelSpec, values: Mapping[str, float], inputs: ModelInputs, options: ModelOptions
) -> TendonState:
    """What muscles and tendons of a model do in one recording."""
    with _quietly():
        state = spec.simulator(inputs, options).tendon(spec.vector(values, options))
    if state is None:
        others = [m.name for m in MODELS.values() if any(p.group == "tendon" for p in m.parameters)]
        raise InputError(
            f"model {spec.name!r} has rigid tendons; models whose tendons give way: "
            f"{', '.join(others)}"
        )
    return state
