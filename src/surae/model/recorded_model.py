"""A model tied to a recording: what all models have in common, whatever their muscles do.

    T = m·(T_inertia + T_gravity) + Σ r·(F_tissue + F_active) + torque_zero + T_plate
        + joint_stiffness·(θ + 0.26) + joint_torque + joint_damping·θ' + T_tissue        (1)
    T_plate = plate_inertia·θ'' + plate_cos·cos θ + plate_sin·sin θ

T_tissue is the curve of `ModelOptions.tissue`. A model gives the forces of a muscle group, and its
torque with derivatives; movement, excitation and activation are the same for all.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import ActivationFilter, ActiveState, IntArray
from surae.model.excitation import Excitation
from surae.model.movement import LegMovement, Movement, MusclePath
from surae.model.options import ModelOptions
from surae.model.parameters import OPTIONAL_PARAMETERS
from surae.model.simulator import TendonState, TorqueParts
from surae.signals import ModelInputs

_TORQUES = {p.name: p.torque for p in OPTIONAL_PARAMETERS}


@dataclass(frozen=True, slots=True)
class Sums:
    """What a muscle group adds its torque and derivatives to."""

    torque: FloatArray  #: Of the whole leg [Nm], shape (n,).
    jacobian: FloatArray  #: Its derivatives, the last row of what is not wanted, shape (rows, n).
    slots: IntArray  #: Row of every parameter, by its column, shape (P,).
    #: Rows of the parameters that turn the path: those of `MusclePath.arm_slopes` and the like.
    turned: IntArray
    #: Are filled where there is room: what `surae.model.compliant.drive_columns` needs of both
    #: groups, (2, 2, 8, n), and derivatives of their lengths, (2, rows, n).
    linear: FloatArray | None = None
    seen: FloatArray | None = None
    states: list[FloatArray] = field(default_factory=list)  #: Of each group, (5, n), compliant.


class Simulator:
    """A model tied to the signals of one recording: parameters in, torque out.

    Parameter vectors hold all parameters of the model in the order of its `ModelSpec`; columns of a
    jacobian are to be distinct.

    `names` are the model's parameters, the mass first, `optional` its optional ones, which
    follow; `weights` are those of the EMG of TA, GL, SOL, GM, `emg`, shape (4, n), is what they
    weigh, if it is not the recording's envelopes. `filtered` names the activation filter's cutoff
    and damping; with "" for the latter it is critically damped. Active states are wanted `lags` [s]
    before each sample.
    """

    def __init__(
        self,
        inputs: ModelInputs,
        options: ModelOptions,
        *,
        names: Sequence[str],
        optional: Sequence[str],
        weights: tuple[str, ...] = ("g1", "g2", "g3", "g4"),
        emg: FloatArray | None = None,
        filtered: tuple[str, str] = ("f0", "beta"),
        lags: tuple[float, ...] = (0.0,),
    ) -> None:
        self._at = {name: column for column, name in enumerate((*names, *optional))}
        self._dt = 1.0 / inputs.rate_hz
        self._lags = lags
        self._factor = float(options.vmax_factor)
        cutoff, damping = filtered
        self._cutoff = self._at[cutoff]
        self._damping = self._at.get(damping, -1)
        added = ((self._at[name], _TORQUES[name]) for name in optional)
        #: Part, column and torque of one unit of all that adds a torque by itself.
        self._added = [(a.part, column, a.of(inputs)) for column, a in added if a is not None]
        #: Torque of a tissue that is given as a curve [Nm], shape (n,); None without one.
        self._tissue = None if options.tissue is None else options.tissue.of(inputs)
        #: Active states that the next call may ask for, and at which values, by which columns.
        self._ahead: tuple[tuple[bytes, frozenset[int]], list[ActiveState]] | None = None
        self._movement = Movement(inputs, options, self._at)
        self._excitation = Excitation(
            inputs, options, at=self._at, weights=weights, emg=inputs.emg.T if emg is None else emg
        )

    def torque(self, values: FloatArray, ahead: Collection[int] = ()) -> FloatArray:
        """Modelled torque [Nm], shape (n,).

        Active states are kept with derivatives by columns `ahead`, for the one call that asks for
        them next, if it is at the same values.
        """
        p = np.array(values, dtype=np.float64)
        leg = self._movement.at(p)
        torque: FloatArray = p[0] * (leg.inertia + leg.gravity)
        if self._tissue is not None:
            torque += self._tissue
        for _, column, row in self._added:
            torque += p[column] * row
        if self._excitation.has_reflex:  # which the movement moves
            ahead = ()
        states = self._active(p, leg, ahead)
        if ahead:
            self._ahead = (p.tobytes(), frozenset(ahead)), states
        for group, active in enumerate(states):
            muscle = leg.muscles[group]
            torque += muscle.arm * self._force(p, group, muscle, active.alone())
        return torque

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        # A copy: for a read-only or strided array numba would compile every kernel once more.
        p = np.array(values, dtype=np.float64)
        into = self._summed(p, columns, self._movement.at(p, columns))
        return into.torque, into.jacobian[:-1]

    def _summed(
        self,
        p: FloatArray,
        columns: Sequence[int],
        leg: LegMovement,
        linear: FloatArray | None = None,
        seen: FloatArray | None = None,
    ) -> Sums:
        """The torque and its derivatives, and of each group what there is room for."""
        slots = np.full(len(p), len(columns))
        slots[list(columns)] = np.arange(len(columns))
        limb = leg.inertia + leg.gravity
        torque: FloatArray = p[0] * limb
        if self._tissue is not None:
            torque += self._tissue
        jacobian = np.zeros((len(columns) + 1, len(limb)))  # the last row is of what is not wanted
        jacobian[slots[0]] = limb
        for _, column, row in self._added:
            torque += p[column] * row
            jacobian[slots[column]] = row
        turned = slots[np.array(leg.columns, dtype=np.int64)]
        for row, slope in zip(turned, leg.limb_slopes, strict=True):
            jacobian[row] = p[0] * slope
        into = Sums(torque, jacobian, slots, turned, linear, seen)
        for group, active in enumerate(self._active(p, leg, columns)):
            self._contract(p, group, leg.muscles[group], active, into)
        return into

    def parts(self, values: FloatArray) -> TorqueParts:
        """The torque split into its parts; of a compliant tendon's, tissue is F_elas·r."""
        return self.split(values)[0]

    def split(self, values: FloatArray) -> tuple[TorqueParts, FloatArray, FloatArray]:
        """The parts of the torque; force and active state of both groups [N], shape (2, n)."""
        p = np.array(values, dtype=np.float64)
        leg = self._movement.at(p)
        split = []
        reflex = []
        force = []
        states = []
        for group, active in enumerate(self._active(p, leg)):
            muscle = leg.muscles[group]
            forces = self._forces(p, group, muscle, active)
            force.append(forces[0] + forces[1])
            states.append(active.alpha[-1])
            split.append(muscle.arm * forces)
            if self._excitation.has_reflex:
                alpha = active.alpha[-1]
                by_reflex = active.drives[1][-1]
                share = np.divide(by_reflex, alpha, out=np.zeros_like(alpha), where=alpha != 0.0)
                reflex.append(share * split[-1][1])
        (tissue_tri, neural_tri), (tissue_tib, neural_tib) = split
        added = {
            part: sum(p[column] * row for of, column, row in self._added if of == part)
            for part, _, _ in self._added
        }
        if self._tissue is not None:
            added["joint"] = added.get("joint", 0.0) + self._tissue
        reflex_tri, reflex_tib = reflex or (None, None)
        parts = TorqueParts(
            tissue_tri,
            tissue_tib,
            neural_tri,
            neural_tib,
            inertial=p[0] * leg.inertia + added.get("inertial", 0.0),
            gravitational=p[0] * leg.gravity + added.get("gravitational", 0.0),
            reflex_tri=reflex_tri,
            reflex_tib=reflex_tib,
            zero=added.get("zero"),
            joint=added.get("joint"),
        )
        return parts, np.stack(force), np.stack(states)

    def activity(self, values: FloatArray) -> FloatArray:
        """Active state of both groups [N], shape (2, n), as in `split`."""
        p = np.array(values, dtype=np.float64)
        return np.stack([active.alpha[-1] for active in self._active(p, self._movement.at(p))])

    def tendon(self, values: FloatArray) -> TendonState | None:
        """What muscles and tendons do over time; None from a model whose tendons are rigid."""
        del values
        return None

    def muscles(self, values: FloatArray) -> FloatArray:
        """Muscle length [m], tendon elongation [m] and force [N] of both groups, (3, 2, n)."""
        p = np.array(values, dtype=np.float64)
        leg = self._movement.at(p)
        length = [muscle.length for muscle in leg.muscles]
        active = self._active(p, leg)
        force = [self._force(p, g, leg.muscles[g], active[g]) for g in range(2)]
        return np.stack([length, np.zeros_like(length), force])

    def _active(
        self, p: FloatArray, leg: LegMovement, columns: Collection[int] = ()
    ) -> list[ActiveState]:
        """Active states of both groups, with their derivatives by `columns`."""
        wanted = frozenset(columns)
        made = self._ahead
        self._ahead = None
        if made is not None and made[0] == (p.tobytes(), wanted):
            return made[1]
        step = self.activation(p, wanted)
        return [step.active_state(drives) for drives in self._excitation.drives(p, leg, wanted)]

    def activation(self, p: FloatArray, wanted: frozenset[int] = frozenset()) -> ActivationFilter:
        """The activation filter, with its derivatives by the wanted columns."""
        f0 = self._cutoff
        beta = self._damping
        return ActivationFilter(
            f0=p[f0],
            beta=1.0 if beta < 0 else p[beta],
            dt=self._dt,
            lags=self._lags,
            columns=(f0 if f0 in wanted else -1, beta if beta in wanted else -1),
        )

    def pulled_by(self, torque: FloatArray) -> None:
        """Let a foot plate that gives way be turned by this torque [Nm], shape (n,)."""
        self._movement.pulled_by(torque)

    def with_log_gain(self, gain: FloatArray | None) -> None:
        """Let the drives of TA, GL, SOL, GM have these logarithmic gains, shape (4, n)."""
        self._excitation.log_gain = gain
        self._ahead = None

    def _force(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        """Force of a muscle group [N], shape (n,)."""
        passive, contractile = self._forces(p, group, muscle, active)
        return np.asarray(passive + contractile)

    def _forces(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        """Passive and active force of a muscle group [N], shape (2, n)."""
        raise NotImplementedError

    def _contract(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState, into: Sums
    ) -> None:
        """Add a group's torque and its derivatives, those by what turns its path included."""
        raise NotImplementedError
