"""A fit's torque while it is measured: angle and EMG in, torque with its doubt out."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.formatting import listed, percentage, significant
from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.units import FloatArray
from surae.causal.doubt import Doubt, doubt_of
from surae.causal.kernel import PARTS, ROWS, run, step
from surae.causal.layout import DOUBT
from surae.causal.numbers import LEFT_OUT, Numbers, check_supported, numbers_of
from surae.inference import Assessment, FitResult, Grade
from surae.inference.judging.goodness import counted, vaf
from surae.recording import MUSCLES, Recording
from surae.signals import ModelInputs, Preparation, SmoothEffort

if TYPE_CHECKING:
    from surae.causal.c99 import CSource

#: How EMG comes to a predictor.
Emg = Literal["raw", "envelope"]


@dataclass(frozen=True, slots=True)
class Causality:
    """What it costs not to look ahead, over the fit's own recordings."""

    vaf: float  #: Variance accounted for by a step after the other [%].
    vaf_ahead: float  #: The same by the model as it was fitted, by its parameters alone [%].

    @property
    def cost(self) -> float:
        """By how much a step is worse [percentage points of variance]."""
        return self.vaf_ahead - self.vaf


@dataclass(frozen=True, slots=True, eq=False)
class CausalTorque(Comparable):
    """What a predictor makes of signals that are at hand; arrays of shape (n,)."""

    time: FloatArray  #: [s].
    torque: FloatArray  #: Predicted from each sample and those before it [Nm].
    sd: FloatArray  #: Its standard deviation [Nm].
    #: The signals as a step has them, with the measured torque where there was one: `Fit.predict`
    #: gives the same torque of them.
    inputs: ModelInputs

    @property
    def vaf(self) -> float | None:
        """Variance of the measured torque that is accounted for [%]; None where none was given."""
        measured = self.inputs.torque
        if measured is None:
            return None
        return vaf(*counted(self.inputs, measured - self.torque))


class Predictor:
    """A fit's torque, sample by sample: what `Fit.predictor` gives.

    It knows what was measured so far, and nothing of what comes. Every sample takes the same few
    microseconds, and no memory. `step` gives the torque of one; `run` those of many.

    Attributes
    ----------
    rate_hz : float
        How many samples come in a second [Hz]; steps are to come at this rate.
    emg : {"raw", "envelope"}
        How EMG comes.
    causality : Causality
        What it costs not to look ahead.
    doubt : Doubt
        What its standard deviation is made of.
    at_means : tuple of str
        What the fit has from moment to moment, and a prediction at its mean: of `auto` alone.
    left_out : tuple of str
        Parameters of the fit that a step has not, for they need the torque that is measured.
    """

    __slots__ = (
        "_args",
        "_emg",
        "_fit",
        "_held",
        "_late",
        "_numbers",
        "_state",
        "_terms",
        "at_means",
        "causality",
        "doubt",
        "emg",
        "left_out",
        "rate_hz",
    )

    def __init__(
        self, result: FitResult, assessment: Assessment, rate_hz: float, emg: Emg | None
    ) -> None:
        problem = result.problem
        first = problem.inputs[0]
        self.rate_hz = float(rate_hz)
        self.emg: Emg = emg or ("raw" if first.own_envelopes else "envelope")
        self.at_means = () if result.posterior is None else ("gains", "drift", "misfit", "noise")
        self.left_out = tuple(name for name in LEFT_OUT if result.values.get(name))
        preparation = Preparation().updated(problem.settings.preparation)
        numbers = _numbers(result, self.rate_hz, preparation if self.emg == "raw" else None)
        runs = [_run(_own_numbers(result, r), r.angle, r.emg) for r in problem.inputs]
        errors = [_torque(r) - out[0] for r, out in zip(problem.inputs, runs, strict=True)]
        if not all(np.isfinite(error).all() for error in errors):
            raise InputError(
                "stepped through, the fit’s own recordings give no finite torque; fit again"
            )
        self.doubt: Doubt = doubt_of(
            result, assessment.uncertainty, [out[-DOUBT:] for out in runs], errors
        )
        numbers.record["doubt"] = self.doubt.form
        numbers.record["noise"] = self.doubt.noise
        pairs = [counted(r, e) for r, e in zip(problem.inputs, errors, strict=True)]
        ahead = [counted(r, e) for r, e in zip(problem.inputs, result.residuals, strict=True)]
        self.causality = Causality(_vaf(pairs), _vaf(ahead))
        self._numbers: Numbers = numbers
        self._fit = result
        self._emg = np.zeros(4)
        self.reset()

    def __repr__(self) -> str:
        return (
            f"predictor at {self.rate_hz:g} Hz of {self._fit.problem.spec.name}, EMG "
            f"{self.emg}: ± {significant(1.96 * self.doubt.noise, 2)} Nm or more. {self.account}"
        )

    @property
    def account(self) -> str:
        """What causality costs, and what is left out or at its mean, in a few sentences."""
        cost = self.causality
        said = [
            f"Over the fit’s recordings it accounts for {percentage(cost.vaf)} % of the variance, "
            f"where filters that look ahead account for {percentage(cost.vaf_ahead)} %."
        ]
        if self.at_means:
            said.append(
                "What auto lays on single moments (gains of the drives, drift, what no model has, "
                "noise of the EMG) is at its mean."
            )
        if self.left_out:
            said.append(f"Left out, as it needs the measured torque: {listed(self.left_out)}.")
        knowledge = self._fit.problem.settings.knowledge
        plate = None if knowledge is None else knowledge.plate
        if plate is not None and plate.file:
            said.append("The torque is without that of the empty device, as the fit’s is.")
        return " ".join(said)

    def reset(self) -> None:
        """Forget all that was measured: the next step is the first."""
        self._state, self._late = self._numbers.state()
        self._held, self._terms = np.zeros(2), np.zeros(DOUBT)
        n = self._numbers
        room = (self._late, self._held, self._terms)
        self._args = (n.record, n.path, (n.curve, n.relaxing), self._state, room)

    def step(self, angle_rad: float, emg_V: Sequence[float] | FloatArray) -> float:
        """The torque now.

        Parameters
        ----------
        angle_rad : float
            The angle as it is measured now [rad], dorsiflexion positive.
        emg_V : sequence of float, shape (4,)
            EMG of tibialis anterior, gastrocnemius lateralis, soleus and gastrocnemius medialis
            now [V], raw or as envelopes; that of a muscle that the fit has none of has no effect.

        Returns
        -------
        float
            Predicted torque [Nm]; `sd` is how unsure it is.

        Raises
        ------
        InputError
            A number is not finite, or there are not four EMG.
        ComputationError
            The forces of muscle and tendon find no balance any more: `reset`.
        """
        emg = self._emg
        try:
            emg[0], emg[1], emg[2], emg[3] = emg_V
        except (TypeError, ValueError):
            raise InputError(
                f"emg_V is {emg_V!r}; give four numbers: {', '.join(MUSCLES)}"
            ) from None
        if not math.isfinite(angle_rad + emg[0] + emg[1] + emg[2] + emg[3]):
            raise InputError(
                f"angle {angle_rad!r} or EMG {emg.tolist()} is not finite; leave this step out, "
                "or repeat the one before"
            )
        torque = step(*self._args, angle_rad, emg)
        if math.isnan(torque):
            raise ComputationError(
                "muscle and tendon find no balance with these numbers; call reset, and check the "
                "units of angle and EMG"
            )
        return float(torque)

    @property
    def needs(self) -> tuple[str, ...]:
        """Muscles whose EMG it needs: those that the fit has."""
        missing = self._fit.problem.inputs[0].missing_emg
        return tuple(muscle for muscle in MUSCLES if muscle not in missing)

    @property
    def sd(self) -> float:
        """Standard deviation of the measured torque about that of the last step [Nm]."""
        return float(self._state["sd"][0])

    @property
    def parts(self) -> Mapping[str, float]:
        """What the last step's torque is made of [Nm]: tissue, contraction, inertia and more."""
        return FrozenDict(zip(PARTS, map(float, self._state["parts"][0]), strict=True))

    def run(
        self,
        angle_rad: FloatArray,
        emg_V: FloatArray,
        torque_Nm: FloatArray | None = None,
    ) -> CausalTorque:
        """The torques of signals that are at hand, as so many steps would give them.

        Steps that were taken before are not continued, and go on as they were.

        Parameters
        ----------
        angle_rad : ndarray, shape (n,)
            Angle [rad] at the predictor's rate.
        emg_V : ndarray, shape (n, 4)
            EMG of the four muscles [V].
        torque_Nm : ndarray, shape (n,), optional
            Measured torque, to compare with.

        Returns
        -------
        CausalTorque
            Torque and doubt, and the signals as a step has them.

        Raises
        ------
        InputError
            Shapes differ, or a number is not finite.
        """
        angle = np.ascontiguousarray(angle_rad, dtype=np.float64)
        emg = np.ascontiguousarray(emg_V, dtype=np.float64)
        if angle.ndim != 1 or emg.shape != (len(angle), 4):
            raise InputError(
                f"angle has shape {angle.shape} and EMG {emg.shape}; give (n,) and (n, 4)"
            )
        if not (np.isfinite(angle).all() and np.isfinite(emg).all()):
            raise InputError("an angle or EMG is not finite; leave these samples out")
        out = _run(self._numbers, angle, emg)
        if out[5].any():
            raise ComputationError(
                f"muscle and tendon find no balance from sample {int(out[5].argmax())} on; check "
                "the units of angle and EMG"
            )
        first = self._fit.problem.inputs[0]
        smooth, rate, smooth_rate = (read_only(out[k : k + 4]) for k in (14, 10, 18))
        time = np.arange(len(angle)) / self.rate_hz
        inputs = ModelInputs(
            "causal",
            self.rate_hz,
            read_only(time),
            read_only(out[2]),
            read_only(out[3]),
            read_only(out[4]),
            read_only(out[6:10].T),
            first.emg_unit,
            None if torque_Nm is None else read_only(torque_Nm),
            first.missing_emg,
            prepared=True,
            emg_reference=first.emg_reference,
            own_envelopes=first.own_envelopes,
            effort=SmoothEffort(smooth, rate, smooth_rate),
        )
        return CausalTorque(inputs.time, read_only(out[0]), read_only(out[1]), inputs)

    def follow(self, recording: Recording) -> CausalTorque:
        """The torques of a recording, as if its channels came in now, at the predictor's rate.

        Channels of another rate are brought to this one first, which no device would have to do.

        Parameters
        ----------
        recording : Recording
            As it was measured: with raw EMG for a predictor that takes it raw.

        Returns
        -------
        CausalTorque
            Beside the measured torque, if there is one, which no filter goes over.

        Raises
        ------
        InputError
            Its EMG comes otherwise, or a channel cannot be brought to the rate.
        """
        from surae.causal.arriving import arriving

        return self.run(*arriving(recording, self.rate_hz, self.emg, self._fit.problem.inputs[0]))

    def to_c(self, name: str = "surae_predictor", *, precision: str = "double") -> "CSource":
        """The predictor as one file of C99 with its header.

        Parameters
        ----------
        name : str
            How the files are called, without their endings.
        precision : {"double", "float"}
            Of all numbers.

        Returns
        -------
        CSource
            `save` writes ``NAME.c``, which has a test program too, and ``NAME.h``.

        Raises
        ------
        InputError
            The name is none that C allows, or the precision is another.
        """
        from surae.causal.c99 import c_source

        return c_source(self, self._numbers, self._fit, name, precision)


def predictor_of(
    result: FitResult,
    assessment: Assessment,
    rate_hz: float = 1000.0,
    *,
    emg: Emg | None = None,
    even_if_doubtful: bool = False,
) -> Predictor:
    """The predictor of a fit, as `Fit.predictor` gives it."""
    check_supported(result.problem.spec, result.problem.options)
    if not (np.isfinite(rate_hz) and rate_hz > 0):
        raise InputError(f"rate_hz is {rate_hz!r}; give the steps in a second, above 0")
    if emg not in (None, "raw", "envelope"):
        raise InputError(f"emg is {emg!r}; use 'raw' or 'envelope'")
    adequacy = assessment.adequacy
    if adequacy.grade != Grade.ADEQUATE and not even_if_doubtful:
        why = "; ".join(map(str, adequacy.reasons)) or "see its report"
        raise InputError(
            f"the fit is {adequacy.grade}, so its torque is not to be acted on: {why}; "
            "even_if_doubtful=True (--even-if-doubtful) makes a predictor all the same"
        )
    return Predictor(result, assessment, rate_hz, emg)


def _numbers(result: FitResult, rate_hz: float, emg: Preparation | None) -> Numbers:
    problem = result.problem
    like = problem.inputs[0]
    return numbers_of(problem.spec, problem.options, result.values, like, rate_hz, emg)


def _own_numbers(result: FitResult, recording: ModelInputs) -> Numbers:
    """Those of a step that is given a recording of the fit, prepared and normalised as it is."""
    problem = result.problem
    like = replace(recording, emg_reference=None)
    return numbers_of(problem.spec, problem.options, result.values, like, recording.rate_hz, None)


def _run(numbers: Numbers, angle: FloatArray, emg: FloatArray) -> FloatArray:
    state, late = numbers.state()
    out = np.zeros((ROWS, len(angle)))
    room = (late, np.zeros(2), np.zeros(DOUBT))
    tissue = (numbers.curve, numbers.relaxing)
    # copies: for read-only arrays numba would compile it once more
    signals = np.array(angle, order="C"), np.array(emg, order="C")
    run(numbers.record, numbers.path, tissue, state, room, signals, out)
    return out


def _torque(recording: ModelInputs) -> FloatArray:
    return np.zeros(recording.n) if recording.torque is None else recording.torque


def _vaf(pairs: Sequence[tuple[FloatArray, FloatArray]]) -> float:
    measured, residual = (np.concatenate(each) for each in zip(*pairs, strict=True))
    return vaf(measured, residual)
