"""The signals of one recording beside what the model makes of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.estimation import FitResult
from surae.model.simulator import TorqueParts
from surae.recording import read_only
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class Traces:
    """What the figures of one recording show, each of shape (n,) unless stated.

    Attributes
    ----------
    time : ndarray
        Time [s].
    emg : ndarray, shape (n, 4)
        EMG envelopes in the order TA, GL, SOL, GM.
    emg_unit : {"V", "1"}
        Volts, or a normalised envelope.
    missing_emg : tuple of str
        Muscles without EMG.
    angle : ndarray
        Ankle angle [rad].
    measured, modelled : ndarray
        Torque [Nm].
    parts : TorqueParts
        Parts of the modelled torque [Nm].
    """

    time: FloatArray
    emg: FloatArray
    emg_unit: str
    missing_emg: Sequence[str]
    angle: FloatArray
    measured: FloatArray
    modelled: FloatArray
    parts: TorqueParts

    @property
    def residual(self) -> FloatArray:
        """Measured minus modelled torque [Nm]."""
        return self.measured - self.modelled


def traces_of(result: FitResult) -> tuple[Traces, ...]:
    """The traces of every recording of a fit."""
    problem = result.problem
    vector = np.array([result.values[name] for name in problem.spec.names])
    return tuple(
        Traces(
            time=one.time,
            emg=one.emg,
            emg_unit=one.emg_unit,
            missing_emg=one.missing_emg,
            angle=one.angle,
            measured=one.torque,
            modelled=read_only(one.torque - residual),
            parts=problem.spec.simulator(one, problem.options).parts(vector),
        )
        for one, residual in zip(problem.inputs, result.residuals, strict=True)
        if one.torque is not None
    )
