"""A virtual cohort in the place of the thesis's fourteen subjects (2.6, 3.2), drawn from a seed.

The measured recordings are not public. These subjects stand in: their leg is richer than any model
that is fitted, and it was chosen before anything was fitted to it. Every number below comes from
the thesis, from `surae.studies` or is a plausible choice:

==================== ===========================================================================
tendons              compliant, of the subject's own: ε0 of the triceps 2.8 to 5 % of the slack
                     length, about the 4 % that Table 2 calls a strain; those of a fit are wrong
strength             weights twice those of a leg on rigid tendons, women 0.75 times those of men:
                     so legs on these tendons reach the torques of Figures 18 to 20
range of motion      −0.95…−0.80 rad to 0.45…0.60 rad, each subject's own limit of comfort
tibialis             resists 3 to 5 Nm at full plantarflexion: the axis of Figure 31 (`thesis_leg`)
crosstalk, axis,     as `realistic_imperfections`: crosstalk, axis a few mm off, slow knee motion
knee
torque noise         0.06 to 0.2 Nm: a VAF of 99.95 % of a torque of 6.5 Nm RMS (Figure 18) leaves
                     0.15 Nm to noise and misfit together
EMG to torque        where asked for, a gain that wanders within seconds (`GAIN`)
misaligned           with probability 3/14, an ankle axis 12 to 20 mm above the device's (4.4: feet
                     with "higher ankle rotation points")
flexible             with probability 3/14, knee flexion of 0.08 to 0.15 rad (4.4: subjects who
                     "slightly twisted their knee")
muscles without EMG  10 to 20 % of the activity of those with (4.4: "muscles that are not measured")
stretch reflex       0.02 to 0.10 of full effort per l0/s
effort               follows the target 0.1 to 0.4 s late; its level differs by repetition, muscle
                     group by muscle group (coefficient of variation 15 %), and wanders within it
==================== ===========================================================================
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Literal

import numpy as np

from surae.base.errors import InputError
from surae.protocol import Protocol
from surae.studies import (
    VirtualSubject,
    realistic_imperfections,
    stream,
)
from surae_thesis.cohort.imperfections import CohortImperfections
from surae_thesis.legs import protocol, thesis_leg

#: Subjects of the thesis, how many of them are women, their ages [years] (2.6).
SUBJECTS = 14
WOMEN = 4
AGES = (20, 30)
#: Repetitions of each protocol (3.2.3).
REPETITIONS = 3
#: The protocols in the thesis's order, and how many of the subjects completed each (Table 3).
COMPLETED: Mapping[str, int] = {"ramp-and-hold": 14, "multiple-holds": 14, "multi-sine-holds": 7}
PASSIVE_PROTOCOL, ACTIVE_PROTOCOL, FAST_PROTOCOL = COMPLETED
#: How long they were measured [s]: the axes of Figures 18, 24 and 31 (30 s) and 20 (40 s); Figures
#: 19 and 25 end between 25 and 30 s, so that 28 s is an estimate. "During the passive phase (first
#: 7 seconds) of the measurement" (3.2.2, 4.2.2).
MEASURED_SECONDS = dict(zip(COMPLETED, (30.0, 28.0, 40.0), strict=True))
PASSIVE_SECONDS = 7.0

#: Weights over those of `surae.studies.POPULATIONS`, which are meant for rigid tendons.
_STRENGTH = 2.0
#: Weights of a woman's EMG over those of a man's: plantarflexors and dorsiflexors are about three
#: quarters as strong.
_WOMAN = 0.75
#: Slack length of the triceps's tendon [m] (Table 2).
SLACK_TRI = 0.415
_ODD = 3 / 14
#: Of the torque noise of `realistic_imperfections`, see above: the second calibration, on the VAF
#: of Figure 18.
QUIET = 0.2
#: Coefficient of variation of the gain from EMG to torque. Calibrated on one number, the mean VAF
#: of model 1.0 on the multiple holds, 95 % (Figure 17), in the first repetition of the first five
#: subjects (0.4: 97.6, 0.5: 96.6, 0.6: 95.6 %), with the protocols of the simulations; it was not
#: set again for those that were measured, and no other claim was looked at for it.
GAIN = 0.65
#: Cohorts of different seeds share no subject.
_SUBJECTS_OF_A_SEED = 1_000_000
_FIRST = 900_000


@dataclass(frozen=True, slots=True)
class CohortSubject:
    """One subject of a cohort: the leg with all that is true of it, and how it is measured.

    The range of motion [rad] are the limits of comfort; the level of effort varies between
    repetitions; age in years.
    """

    id: str
    sex: Literal["male", "female"]
    age: int
    subject: VirtualSubject
    angle_range: tuple[float, float]
    imperfections: CohortImperfections
    level_variation: float
    completed: tuple[str, ...]
    measured: bool = True  # whether by the protocols as they were measured

    @property
    def remarks(self) -> tuple[str, ...]:
        """What an experimenter would have noted: a misaligned axis, a moving knee."""
        noted = []
        if self.imperfections.axis_up >= 0.012:
            noted.append("ankle axis high")
        if self.imperfections.knee_motion >= 0.08:
            noted.append("knee moves")
        return tuple(noted)


def make_cohort(
    seed: int = 1,
    subjects: int = SUBJECTS,
    gain: float = GAIN,
    quiet: float = QUIET,
    measured: bool = True,
) -> tuple[CohortSubject, ...]:
    """The first subjects of the cohort of a seed.

    The gain from EMG to torque varies by `gain`, the torque's noise is the part `quiet` of the
    usual one, and the protocols are those that were `measured`, or those of the simulations.

    Raises
    ------
    InputError
        More or fewer subjects than there are.
    """
    if not 1 <= subjects <= SUBJECTS:
        raise InputError(f"cohort of {subjects} subjects; use 1 to {SUBJECTS}")
    rng = np.random.default_rng([seed, SUBJECTS])
    women = set(rng.permutation(SUBJECTS)[:WOMEN].tolist())
    ages = rng.integers(AGES[0], AGES[1], SUBJECTS, endpoint=True).tolist()
    finished = {
        name: set(rng.permutation(SUBJECTS)[:count].tolist()) for name, count in COMPLETED.items()
    }
    return tuple(
        _member(
            seed,
            number,
            "female" if number in women else "male",
            ages[number],
            tuple(name for name in COMPLETED if number in finished[name]),
            gain,
            quiet,
            measured,
        )
        for number in range(subjects)
    )


def _member(
    seed: int,
    number: int,
    sex: Literal["male", "female"],
    age: int,
    completed: tuple[str, ...],
    gain: float,
    quiet: float,
    measured: bool,
) -> CohortSubject:
    drawn = thesis_leg(_SUBJECTS_OF_A_SEED * seed + _FIRST + number, tendons=True)
    strength = _STRENGTH * (_WOMAN if sex == "female" else 1.0)
    subject = replace(
        drawn,
        parameters={
            name: value * strength if name in ("g1", "g2", "g3", "g4") else value
            for name, value in drawn.parameters.items()
        },
        # The draw of ε0, 0.028 to 0.050, is taken as a strain here.
        tendons={**drawn.tendons, "dlt_tri": drawn.tendons["dlt_tri"] * SLACK_TRI},
    )

    def uniform(name: str, low: float, high: float) -> float:
        return float(stream(subject, f"cohort: {name}").uniform(low, high))

    usual = realistic_imperfections(subject)
    misaligned = uniform("misaligned", 0.0, 1.0) < _ODD
    flexible = uniform("flexible", 0.0, 1.0) < _ODD
    imperfections = CohortImperfections(
        **asdict(usual)
        | {
            "axis_up": uniform("high axis", 0.012, 0.020) if misaligned else usual.axis_up,
            "knee_motion": uniform("moving knee", 0.08, 0.15) if flexible else usual.knee_motion,
            "reflex_gain": uniform("reflex", 0.02, 0.10),
            "torque_noise": quiet * usual.torque_noise,
        },
        unmeasured=uniform("unmeasured", 0.10, 0.20),
        gain_variation=gain,
    )
    return CohortSubject(
        id=f"S{number + 1:02d}",
        sex=sex,
        age=age,
        subject=subject,
        angle_range=(
            uniform("plantarflexion", -0.95, -0.80),
            uniform("dorsiflexion", 0.45, 0.60),
        ),
        imperfections=imperfections,
        level_variation=0.15,
        completed=completed,
        measured=measured,
    )


def cohort_protocol(
    name: str, angle_range: tuple[float, float], rate_hz: float, *, measured: bool = True
) -> Protocol:
    """One of the three protocols as the thesis's device could do it (4.1.5).

    As it was `measured`, by the figures' axes and `PASSIVE_SECONDS`, or as it was simulated.

    A chirp of 0.2 rad and factor 0.5 is asked for, which the device lowers to 0.1 rad for the
    multiple holds; the motion is filtered to stay below 1.5 rad/s.

    Raises
    ------
    InputError
        It is none of the three.
    """
    if name not in COMPLETED:
        raise InputError(f"cohort: protocol {name!r}; use one of: {', '.join(COMPLETED)}")
    passive = name == PASSIVE_PROTOCOL
    task, amplitude = ("passive", 0.0) if passive else ("part-passive", 0.2)
    asked = protocol(name, task, amplitude, rate_hz=rate_hz, device="achilles")
    asked = replace(asked, angle_range=angle_range)
    if not measured:
        return asked
    relaxed = None if passive else PASSIVE_SECONDS
    return replace(asked, duration=MEASURED_SECONDS[name], passive_seconds=relaxed)
