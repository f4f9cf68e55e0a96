"""What excites the muscles of a recording: its EMG, as far as that can be believed, and a reflex.

    E_tri(t) = g2·ê2(t − emd) + g3·ê3(t − emd) + g4·ê4(t − emd) + R_tri(t − reflex_delay)
    E_tib(t) = g1·ê1(t − emd) + R_tib(t − reflex_delay)                        (12)(13)
    R        = reflex·max(d lmt/dt, 0) + reflex_length·max(x − x0, 0) + reflex_force·F0(x)      [N]

Every muscle's own envelope ê is that of its electrode but for what the laboratory cannot rule out:
a level at rest r (`emg_rest_…`), what electrodes hear of other muscles (`xt_ta_gl`: that of the
tibialis of the gastrocnemius lateralis), and a force that does not grow as EMG does (`emg_shape` A,
Lloyd and Besier 2003; −3 to 0 there, 0 is linear; and `emg_power` P, 0 is linear) and falls later
than it rises, by ρ (`release`; Zajac 1989):

    u = M⁻¹·(e + λ·de/dt − r)
    ê = u·e_ref/s·(exp(A·s/e_ref) − 1)/(exp(A) − 1)·(s/e_ref)^P + ½·ρ·|dε/dt|

Of raw EMG powers add up in place of envelopes (`surae.model.crosstalk`). An envelope that lags the
EMG as a filter of the first order does is led by its time constant λ (`emg_lag`). M is 1 on its
diagonal; s is u made of envelopes that are as smooth as effort is (`surae.signals.smooth_effort`):
rectified EMG fluctuates by as much as itself, and force is curved over effort, not over noise. ε is
the electrode's own smooth envelope: to first order force is half of ρ ahead where it grows, and as
much behind where it falls. Nothing is clipped: a muscle that is less active than its electrode's
rest has a small negative ê. The weights keep their unit, for ê = u at s = 0 and at the reference
level e_ref (`ModelOptions.emg_ref`; 1 for a normalised EMG). A muscle without EMG hears nothing and
is not heard.

lmt is the muscle-tendon unit's length: with it lengthens the muscle on a rigid tendon, x, and what
a compliant tendon leaves to the muscle is not known before the force is; F0 is the force (8) of
tissue of that length (force feedback: Falisse et al. 2018). `reflex_delay` is all of the
time from stretch to the filter's input, the loop's and the muscle's own; `emd` is not added to it.

References
----------
F. E. Zajac (1989). Muscle and tendon: properties, models, scaling, and application to biomechanics
and motor control. Critical Reviews in Biomedical Engineering 17(4):359-411.
A. Falisse, L. Bar-On, K. Desloovere, I. Jonkers, F. De Groote (2018). A spasticity model based on
feedback from muscle force explains muscle activity during passive stretches and gait in children
with cerebral palsy. PLoS ONE 13(12):e0208811.
D. G. Lloyd, T. F. Besier (2003). An EMG-driven musculoskeletal model to estimate muscle forces and
knee joint moments in vivo. Journal of Biomechanics 36(6):765-776.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.model.activation import Drive, shaped
from surae.model.crosstalk import OfEnvelopes, OfPowers
from surae.model.movement import LegMovement, MusclePath
from surae.model.options import ModelOptions
from surae.model.parameters import CROSSTALK, OPTIONAL, OPTIONAL_PARAMETERS
from surae.recording import MUSCLES
from surae.signals import ModelInputs, SmoothEffort, smooth_effort

#: EMG channels of triceps and tibialis.
GROUPS = (slice(1, 4), slice(0, 1))
_DELAY = OPTIONAL["reflex"][2]
_OFF = next(p.start for p in OPTIONAL_PARAMETERS if p.name == _DELAY)
#: Of each group: tissue's stiffness and slack length; a reflex's gains, to velocity, length, force.
_TISSUE = tuple((f"k_{group}", f"x0_{group}") for group in ("tri", "tib"))
_LAWS = ("reflex", "reflex_length", "reflex_force")
_GAINS = tuple(tuple(f"{law}_{group}" for law in _LAWS) for group in ("tri", "tib"))
_RESTS = OPTIONAL["emg_rest"]


@dataclass(frozen=True, slots=True)
class _Envelopes:
    """Envelopes of the muscles themselves, shape (4, n), and what their derivatives are made of.

    `weighted` are ê, `unmixed` are u. `steep` is ∂ê/∂u, `by_shape` is ∂ê/∂A and `by_power` ∂ê/∂P,
    None where the force grows as EMG does; where it does not, u and `steep` are followed by those
    of the smooth envelopes, shape (4, 2n).
    """

    weighted: FloatArray
    unmixed: OfEnvelopes | OfPowers
    steep: FloatArray | None = None
    by_shape: FloatArray | None = None
    by_power: FloatArray | None = None


class Excitation:
    """Excitation of one recording's muscles; `at` holds the columns of the model's parameters.

    `weights` names the weights of TA, GL, SOL, GM, `emg`, shape (4, n), are their envelopes.
    """

    def __init__(
        self,
        inputs: ModelInputs,
        options: ModelOptions,
        *,
        at: Mapping[str, int],
        weights: tuple[str, ...],
        emg: FloatArray,
    ) -> None:
        curved = "emg_shape" in at or "emg_power" in at
        #: ∂ê/∂ρ, shape (4, n); None where there is no release.
        self._by_release: FloatArray | None = None
        if "release" in at:
            self._by_release = 0.5 * np.abs(_effort(inputs, emg).smooth_rate)
        given = emg
        if curved:
            emg = np.concatenate([emg, _effort(inputs, given).smooth], axis=1)
        #: de/dt, of envelopes and of smooth ones behind them; None where there is no lag.
        self._rate: FloatArray | None = None
        if "emg_lag" in at:
            effort = _effort(inputs, given)
            parts = (effort.rate, effort.smooth_rate) if curved else (effort.rate,)
            self._rate = np.concatenate(parts, axis=1)
        self._emg = np.array(emg, dtype=np.float64, order="C")
        self._at = at
        self._weights = [at[name] for name in weights]
        corrections = ("emg_lag", *_RESTS, *CROSSTALK.values())
        self._corrections = {at[name] for name in corrections if name in at}
        curves = (at[name] for name in ("release", "emg_shape", "emg_power") if name in at)
        self._changing = sorted({*self._corrections, *curves})  # columns: all that changes them
        self._made: tuple[bytes, _Envelopes] | None = None  # of which values, the last ones
        #: Smooth envelopes of electrodes in which powers add up; None where envelopes do.
        self._smooth: FloatArray | None = None
        if inputs.own_envelopes and CROSSTALK[0, 1] in at:
            smooth = _effort(inputs, given).smooth
            self._smooth = np.tile(smooth, emg.shape[1] // inputs.n)
        self._present = np.array([m not in inputs.missing_emg for m in MUSCLES], dtype=float)
        self._reference = _reference(inputs, options, self._present) if curved else None
        #: Whether there is a reflex of any law.
        self.has_reflex = any(name in at for name in chain(*_GAINS))
        #: Logarithmic gain of each muscle's drive over time, shape (4, n); None where it has none.
        self.log_gain: FloatArray | None = None

    def drives(
        self, values: FloatArray, leg: LegMovement, wanted: frozenset[int]
    ) -> tuple[list[Drive], list[Drive]]:
        """Drives of triceps and tibialis, EMG before reflex, with slopes by the wanted columns."""
        envelopes = self._envelopes(values)
        tri, tib = (
            [self._of_emg(group, values, envelopes, wanted)] for group in range(len(GROUPS))
        )
        if self.has_reflex:
            tri.append(self._of_stretch(0, values, leg, wanted))
            tib.append(self._of_stretch(1, values, leg, wanted))
        return tri, tib

    def _value(self, values: FloatArray, name: str) -> float:
        return float(values[self._at[name]]) if name in self._at else 0.0

    def _envelopes(self, values: FloatArray) -> _Envelopes:
        key = values[self._changing].tobytes()
        made = self._made
        if made is None or made[0] != key:
            made = self._made = key, self._envelopes_at(values)
        return made[1]

    def _envelopes_at(self, values: FloatArray) -> _Envelopes:
        heard: FloatArray = self._emg
        if self._rate is not None:
            heard = heard + self._value(values, "emg_lag") * self._rate
        if _RESTS[0] in self._at:
            rest = np.array([self._value(values, name) for name in _RESTS])
            heard = heard - (self._present * rest)[:, None]
        unmixed: OfEnvelopes | OfPowers
        mixing = np.eye(4)
        for (hears, of), name in CROSSTALK.items():
            mixing[hears, of] = self._present[hears] * self._value(values, name)
        if self._smooth is not None:
            unmixed = OfPowers.of(heard, self._smooth, mixing)
        elif CROSSTALK[0, 1] in self._at:
            unmixed = OfEnvelopes.of(heard, mixing)
        else:
            unmixed = OfEnvelopes(heard, mixing)
        envelopes = unmixed.envelopes
        later: FloatArray | float = 0.0
        if self._by_release is not None:
            later = self._value(values, "release") * self._by_release
        if self._reference is None:
            return _Envelopes(envelopes + later, unmixed)
        n = envelopes.shape[1] // 2
        curved, by_own, by_smooth, by_shape, by_power = shaped(
            np.ascontiguousarray(envelopes[:, :n]),
            np.ascontiguousarray(envelopes[:, n:]),
            self._reference,
            self._value(values, "emg_shape"),
            self._value(values, "emg_power"),
        )
        steep = np.concatenate([by_own, by_smooth], axis=1)
        return _Envelopes(curved + later, unmixed, steep, by_shape, by_power)

    def weighted(self, values: FloatArray) -> FloatArray:
        """What each of the four muscles adds to its group's excitation [N], shape (4, n)."""
        drives: FloatArray = values[self._weights][:, None] * self._envelopes(values).weighted
        return drives if self.log_gain is None else drives * np.exp(self.log_gain)

    def _of_emg(
        self, group: int, values: FloatArray, envelopes: _Envelopes, wanted: frozenset[int]
    ) -> Drive:
        channels = GROUPS[group]
        at = self._at
        columns = self._weights[channels]
        weights = values[columns]
        n = envelopes.weighted.shape[1]
        grown = np.ones((len(columns), n))
        if self.log_gain is not None:
            grown = np.exp(self.log_gain[channels])
        weighted = envelopes.weighted[channels] * grown
        # einsum, not BLAS: its threads cost more than they save on so few rows
        signal = np.einsum("c,cn->n", weights, weighted)
        slopes = [(c, row) for c, row in zip(columns, weighted, strict=True) if c in wanted]
        for name, by in (
            ("emg_shape", envelopes.by_shape),
            ("emg_power", envelopes.by_power),
            ("release", self._by_release),
        ):
            if by is not None and at.get(name, -1) in wanted:
                slopes.append((at[name], np.einsum("c,cn->n", weights, by[channels] * grown)))
        if self._corrections.intersection(wanted):
            # ∂E/∂u of each muscle
            steep = np.ones((4, n)) if envelopes.steep is None else envelopes.steep
            steep = steep[channels] * np.tile(grown, steep.shape[1] // n)
            steep *= weights[:, None]
            heard = envelopes.unmixed.by_electrode(steep, channels) * self._present[:, None]
            taken = [(name, -heard[i]) for i, name in enumerate(_RESTS)]
            if self._rate is not None:
                taken.append(("emg_lag", np.einsum("in,in->n", heard, self._rate)))
            if CROSSTALK[0, 1] in at:
                crossed = envelopes.unmixed.by_crosstalk(steep, channels)
                taken += [
                    (CROSSTALK[pair], by * self._present[pair[0]]) for pair, by in crossed.items()
                ]
            # by way of the envelopes and, behind them, of the smooth ones
            slopes += [
                (at[name], by.reshape(-1, n).sum(axis=0))
                for name, by in taken
                if at.get(name, -1) in wanted and by.any()
            ]
        if "emd" not in at:
            return Drive(signal, slopes)
        column = at["emd"]
        return Drive(signal, slopes, float(values[column]), column if column in wanted else -1)

    def _of_stretch(
        self, group: int, values: FloatArray, leg: LegMovement, wanted: frozenset[int]
    ) -> Drive:
        at = self._at
        muscle = leg.muscles[group]
        signal: FloatArray = np.zeros_like(muscle.speed)
        slopes: list[tuple[int, FloatArray]] = []
        for name, law in zip(_GAINS[group], (_of_speed, _of_length, _of_force), strict=True):
            if name not in at:
                continue
            gain = float(values[at[name]])
            tissue = [at[n] for n in _TISSUE[group] if n in at]
            answered, by_speed, by_length, by_tissue = law(muscle, values[tissue])
            signal += gain * answered
            moving = zip(leg.columns, muscle.speed_slopes, muscle.length_slopes, strict=True)
            slopes += [(c, gain * (by_speed * v + by_length * x)) for c, v, x in moving]
            slopes += [
                (c, gain * by) for c, by in zip(tissue, by_tissue, strict=False) if c in wanted
            ]
            slopes += [(at[name], answered)] if at[name] in wanted else []
        delay = at.get(_DELAY, -1)
        late = _OFF if delay < 0 else float(values[delay])
        return Drive(signal, slopes, late, delay if delay in wanted else -1)


def _effort(inputs: ModelInputs, emg: FloatArray) -> SmoothEffort:
    """The recording's effort, or that of envelopes of shape (4, n)."""
    if inputs.effort is not None:
        return inputs.effort
    smooth = smooth_effort(emg, inputs.rate_hz)
    rate, smooth_rate = (np.gradient(e, 1.0 / inputs.rate_hz, axis=1) for e in (emg, smooth))
    return SmoothEffort(smooth, np.asarray(rate), np.asarray(smooth_rate))


#: What a reflex answers; its derivatives by speed and by length, and those by k and x0.
_Answer = tuple[FloatArray, FloatArray | float, FloatArray | float, tuple[FloatArray, ...]]


def _of_speed(muscle: MusclePath, _: FloatArray) -> _Answer:
    return np.maximum(muscle.speed, 0.0), (muscle.speed > 0.0).astype(float), 0.0, ()


def _of_length(muscle: MusclePath, tissue: FloatArray) -> _Answer:
    beyond = muscle.length - tissue[1]
    on = (beyond > 0.0).astype(float)
    return on * beyond, 0.0, on, (0.0 * on, -on)


def _of_force(muscle: MusclePath, tissue: FloatArray) -> _Answer:
    k = tissue[0]
    beyond = muscle.length - tissue[1]
    force = np.exp(k * beyond)
    return force, 0.0, k * force, (beyond * force, -k * force)


def _reference(inputs: ModelInputs, options: ModelOptions, present: FloatArray) -> FloatArray:
    """Reference levels e_ref of the four electrodes, shape (4,); 1 for one that is missing."""
    if inputs.emg_unit == "1":
        return np.ones(4)
    if options.emg_ref is None:
        raise InputError(
            f"{inputs.where}: emg_shape needs the EMG's reference level; give the option emg_ref, "
            "four levels in V, e.g. those of surae.signals.emg_levels"
        )
    levels = np.where(present > 0, options.emg_ref, 1.0)
    if not np.all(levels > 0):
        muscle = MUSCLES[int(np.argmin(levels))]
        raise InputError(
            f"{inputs.where}: option emg_ref is {levels.min():g} V for {muscle}, which has EMG; "
            "its reference level must be positive"
        )
    return levels
