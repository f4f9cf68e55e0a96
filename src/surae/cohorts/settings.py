"""What may be asked of a cohort."""

from dataclasses import dataclass

from surae.base.setting import Request, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class CohortSettings(Request):
    """What is done with many legs; see `surae.cohort`."""

    refit: bool = setting(
        False,
        "Learn the population from the fits and fit every leg again with it, until both rest.",
        help="Learn the population and fit every leg again with it.",
    )
    angles: tuple[float, ...] = setting(
        (10.0,),
        "Where torque and stiffness are given [deg].",
        option="angle",
        metavar="DEG",
        help="Where torque and stiffness are given; may be repeated.  [default: 10]",
    )
    question: tuple[str, ...] = setting(
        (),
        "Names of measures that were in question beforehand, judged at the full level; all else is "
        "exploratory.",
        option="question",
        metavar="NAME",
        help="A measure asked beforehand, as end_stiffness; may be repeated. All else is "
        "exploratory.",
    )
