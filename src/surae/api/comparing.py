"""Several fits beside each other."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surae.api.fitted import Fit
from surae.base.errors import InputError
from surae.base.formatting import NO_NUMBER, significant
from surae.base.frozen import FrozenDict
from surae.base.tables import Tabular, TextTable
from surae.inference import Grade
from surae.inference.judging.criteria import criteria_of, is_same_torque
from surae.inference.judging.goodness import rmse

#: What is to be said of the criteria.
_DEPENDENT = "samples of a torque are not independent: AIC and BIC differ more than the evidence"
_OTHERS = "the fits are of other samples, of another rate or weight: no criterion compares them"


@dataclass(frozen=True, slots=True)
class Compared:
    """One fit among others."""

    model: str
    status: str
    grade: Grade
    n: int  #: Samples that count.
    free: int  #: Estimated parameters, of the leg and of the laboratory.
    r2: float  #: Part of the torque's changes that is followed [%].
    rmse: float  #: Root mean square of the residual [Nm].
    #: `aic`, `bic`: information criteria, and how far each is above the least of the fits; None
    #: where there is none, or where fits are of other samples.
    aic: float | None
    bic: float | None
    above_aic: float | None
    above_bic: float | None


@dataclass(frozen=True, slots=True, repr=False)
class Comparison(Tabular):
    """Fits beside each other."""

    fits: FrozenDict[str, Compared]  #: By the name that each was given.
    note: str  #: What the criteria mean here, or why there is none.

    def __getitem__(self, name: str) -> Compared:
        return self.fits[name]

    def as_table(self) -> TextTable:
        """A row for each fit, and how to read the criteria."""
        heads = ("fit", "model", "grade", "samples", "free", "R² %", "RMSE Nm", "ΔAIC", "ΔBIC")
        rows = tuple(
            (
                name,
                each.model,
                str(each.grade),
                str(each.n),
                str(each.free),
                significant(each.r2, 4),
                significant(each.rmse, 3),
                *(
                    NO_NUMBER if above is None else f"{above:.1f}"
                    for above in (each.above_aic, each.above_bic)
                ),
            )
            for name, each in self.fits.items()
        )
        return TextTable(heads, rows, below=(self.note,), numbers=heads[3:])

    def to_dataframe(self) -> Any:
        """The fits as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row each by name, with the fields of `Compared`.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        from surae.recording.frames import records_frame

        return records_frame(self.fits, "fit")


def compare(fits: Mapping[str, Fit]) -> Comparison:
    """Lay fits beside each other: what each follows, with how many parameters.

    Parameters
    ----------
    fits : mapping of str to Fit
        By any names; at least two.

    Returns
    -------
    Comparison
        With the differences of AIC and BIC where all are of the same samples. Samples of a torque
        are not independent: such differences are larger than the evidence is. Between models
        `auto` weighs by evidence instead.

    Raises
    ------
    InputError
        There are fewer than two.

    Examples
    --------
    >>> fits = {"march": surae.load("before.json"), "june": surae.load("after.json")}
    >>> surae.compare(fits).to_dataframe()
    """
    if len(fits) < 2:
        raise InputError(f"{len(fits)} fit to compare; give at least two, by name")
    known = {name: criteria_of(fit.result) for name, fit in fits.items()}
    inputs = [fit.result.problem.inputs for fit in fits.values()]
    alike = all(is_same_torque(inputs[0], other) for other in inputs[1:])
    least = {
        of: min(
            (v for each in known.values() if (v := getattr(each, of)) is not None), default=None
        )
        for of in ("aic", "bic")
    }

    def above(name: str, of: str) -> float | None:
        value, low = getattr(known[name], of), least[of]
        return value - low if alike and value is not None and low is not None else None

    rows = {
        name: Compared(
            model=fit.result.problem.spec.name,
            status=fit.status,
            grade=fit.adequacy.grade,
            n=known[name].n,
            free=known[name].free,
            r2=fit.adequacy.r2,
            rmse=rmse(fit.residual),
            aic=known[name].aic,
            bic=known[name].bic,
            above_aic=above(name, "aic"),
            above_bic=above(name, "bic"),
        )
        for name, fit in fits.items()
    }
    return Comparison(FrozenDict(rows), _DEPENDENT if alike else _OTHERS)
