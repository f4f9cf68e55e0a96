"""The settings of other requests, one field each, as `settings.py` has those of a fit."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surae.base.names import AUTO, CHIRP_RATE, EFFORTS, FITTED, NUISANCES, POPULATIONS, TASKS
from surae.base.setting import Request, setting
from surae.base.words import N_

#: More fits or threads than these are slips of the keyboard.
_MOST_FITS = 1_000_000
_MOST_WORKERS = 1000


def _model(default: str, what: str) -> Any:
    text = f'{what} ``"auto"``: muscles on compliant tendons with all that the laboratory cannot '
    return setting(
        default, f"{text}rule out, under its priors.", choices=FITTED, metavar="M", help=what
    )


def _film() -> Any:
    return setting(
        "",
        'Muscles whose fascicles would be filmed: ``"tib"``, ``"gm"``, ``"gl"``, ``"sol"``.',
        type="str or sequence of str",
        metavar="MUSCLE,…",
        help="Fascicles that are filmed: tib, gm, gl, sol.",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class LegSettings(Request):
    """By whose legs a protocol is judged."""

    model: str = _model(AUTO, "What would be fitted.")
    population: str | None = setting(
        None,
        "Whose legs; by default as many of each.",
        choices=POPULATIONS,
        metavar="P",
        help="healthy or patient legs.  [default: as many of each]",
    )
    noise: float | None = setting(
        None,
        "Standard deviation of the torque's noise [Nm], white, sample by sample at the "
        "protocol's rate; by default 0.5, or what the fit's residual comes to.",
        least=1e-6,
        most=1000.0,
        metavar="NM",
        help="Standard deviation of the torque's white noise, sample by "
        "sample at the protocol's rate.  [default: 0.5, or the fit's]",
    )
    nuisances: str | Mapping[str, tuple[float, float]] | None = setting(
        None,
        "As of `surae.fit`.",
        choices=NUISANCES,
        help="Which of the laboratory's imperfections count.  [default: all for auto]",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectSettings(LegSettings):
    """Whose protocol is judged, and by how many legs; see `surae.expect`."""

    legs: int = setting(
        20, "How many legs are drawn.", least=1, most=10_000, help="How many legs are drawn."
    )
    film: str | tuple[str, ...] = _film()


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignSettings(LegSettings):
    """What a protocol is searched for; see `surae.design`."""

    angle_range: tuple[float, float] | None = setting(
        None,
        "The subject's full plantarflexion and dorsiflexion [rad]; by default what the fit's "
        "recordings reached, or -0.9 … 0.6 rad, as far as the device reaches. Required for "
        "patients.",
        option="range",
        metavar="LOW:HIGH",
        help="Full plantarflexion and "
        "dorsiflexion of the subject in rad, or as 20deg; required for patients.  [default: the "
        "fit's, or -0.9:0.6, or the device's]",
    )
    aim: str = setting(
        "worst",
        '``"worst"``: the largest relative standard error; ``"mean"``: the mean of their '
        "logarithms; or names of parameters and measures with commas between, e.g. "
        '``"passive_stiffness@10deg"``, ``"end_stiffness"`` or ``"change in torque_rise"``: the '
        "difference of two such visits, the foot mounted anew.",
        metavar="worst|mean|NAME,…",
        help="What is to be known: parameters and measures by name, or a 'change in NAME'.",
    )
    effort: str = setting(
        EFFORTS[0],
        "What the subject can do: bursts of any level, or nothing.",
        choices=EFFORTS,
        help="What the subject can do.",
    )
    film: str | tuple[str, ...] = _film()
    model: str = _model(AUTO, "Whose parameters are to be known.")
    duration: float = setting(
        35.0,
        "Of the trial [s], rests at both ends included.",
        least=5.0,
        most=600.0,
        metavar="S",
        help="Of the trial, in s.",
    )
    rate_hz: float = setting(
        256.0,
        "Sampling rate [Hz].",
        least=20.0,
        most=2048.0,
        option="rate",
        metavar="HZ",
        help="Samples per second.",
    )
    evaluations: int | None = setting(
        None,
        "Plans that are judged; more is better and takes longer.",
        least=1,
        most=10_000_000,
        help="Plans that are judged: more is better and slower.",
    )
    seed: int = setting(0, "Of the search.", least=0, help="Of the search.")


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionSettings:
    """The motion and effort of a protocol beside its profile; `surae.protocol.Protocol` has all."""

    task: str = setting(
        TASKS[0], "A name of `TASKS`.", choices=TASKS, help="What the subject does."
    )
    passive_seconds: float | None = setting(
        None,
        "How long the subject is relaxed before the bursts of the task `part-passive` [s]; "
        "None for its 11 s.",
        least=0.0,
        most=600.0,
        metavar="S",
        label=N_("Relaxed at first [s]"),
        needs="task=part-passive",
        help="How long the task part-passive begins relaxed, in s.  [default: 11]",
    )
    turns: tuple[str, ...] = setting(
        (),
        "Whose bursts follow each other, over and over: muscles of one direction, joined by +; "
        "where none is given ``gl+sol+gm`` and ``ta``.",
        option="turn",
        metavar="MUSCLE[+MUSCLE]",
        help="Muscles of a burst; repeated, their order.  [default: gl+sol+gm, ta]",
    )
    chirp_amplitude: float = setting(
        0.0,
        "Amplitude of the added chirp [rad], less than half the range of motion; 0 for none. "
        "Without a device it goes on to the last sample and stops there; a motion that is "
        "filtered for a device ends at rest.",
        least=0.0,
        most=3.0,
        metavar="A",
        label=N_("Chirp amplitude [rad]"),
        help="Of the added chirp, in rad or as 3deg.",
    )
    chirp_rate: float = setting(
        CHIRP_RATE,
        "Rise of the chirp's frequency [Hz/s]; irrelevant at amplitude 0. The thesis's "
        "factors are converted by `surae.protocol.chirp_rate`.",
        least=0.0,
        most=100.0,
        metavar="R",
        label=N_("Chirp rate [Hz/s]"),
        help="Rise of its frequency, in Hz/s.",
    )
    angle_range: tuple[float, float] = setting(
        (-0.9, 0.6),
        "The subject's angles of full plantarflexion and full dorsiflexion [rad], "
        "within the device's.",
        option="range",
        metavar="LOW:HIGH",
        help="Full plantarflexion and dorsiflexion of the subject, in rad or as 20deg.  "
        "[default: -0.9:0.6, as far as the device]",
    )
    duration: float | None = setting(
        None,
        "None for the profile's own; another value plays the profile slower or faster, while "
        "the chirp and the task keep their own time [s].",
        above=0.0,
        most=600.0,
        metavar="S",
        label=N_("Duration [s]"),
        help="In s.  [default: the profile's own]",
    )
    rate_hz: float = setting(
        256.0,
        "Sampling rate [Hz].",
        above=0.0,
        most=2048.0,
        option="rate",
        metavar="HZ",
        label=N_("Rate [Hz]"),
        help="Samples per second.",
    )
    adapt: bool = setting(
        True,
        "Adapt a motion that the device cannot follow, instead of refusing it.",
        option="no-adapt",
        help="Refuse what the device cannot follow instead.",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeSettings(Request):
    """What is compared of two sessions or legs; see `surae.change`."""

    angles: tuple[float, ...] | None = setting(
        None,
        "Where torque and stiffness are compared [deg]; by default 0 and 10. Each adds "
        "differences that are looked at, which asks more of all.",
        option="angle",
        metavar="DEG",
        help="Where torque and stiffness are compared; may be repeated.  [default: 0, 10]",
    )
    legs: bool = setting(
        False,
        "Whether they are two legs of one person. What two sessions of a leg are wrong in "
        "alike cancels; of two legs it does not.",
        help="BEFORE and AFTER are two legs of one person.",
    )
    mounted: bool = setting(
        False,
        "Whether the foot stayed in the device between the two, as between trials of one visit: "
        "what rest tells is then compared without an error of mounting it anew.",
        help="The foot stayed in the device between BEFORE and AFTER.",
    )
    question: tuple[str, ...] = setting(
        (),
        "Names of measures that were in question before the second visit was opened, judged at "
        'the full level; all else is exploratory. ``"strength"`` is that of both muscle groups.',
        option="question",
        metavar="NAME",
        help="What was in question beforehand: curve_size, torque_rise, strength …; may "
        "be repeated. All else is exploratory.",
    )
