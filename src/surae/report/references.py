"""The papers behind the methods that a fit used, to be cited with it."""

from dataclasses import dataclass

from surae._version import __version__
from surae.assessment.assess import Assessment, Interval
from surae.estimation import FitResult


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """A publication.

    Attributes
    ----------
    key : str
        Of its BibTeX entry.
    kind : str
        Type of the entry.
    authors : str
        ``Family, Given and Family, Given``, as BibTeX has it.
    title : str
        Title.
    year : int or None
        Year; None for what has none.
    where : tuple of (str, str)
        Further fields of the entry, e.g. ``("journal", "…")``.
    doi : str
        Empty where it has none.
    """

    key: str
    kind: str
    authors: str
    title: str
    year: int | None
    where: tuple[tuple[str, str], ...]
    doi: str = ""

    @property
    def text(self) -> str:
        """One line for readers."""
        names = self.authors.replace(" and ", "; ").replace("{", "").replace("}", "")
        year = f" ({self.year})" if self.year else ""
        places = ", ".join(value for _, value in self.where)
        doi = f" doi:{self.doi}" if self.doi else ""
        return f"{names}{year}. {self.title}. {places}.{doi}"

    @property
    def bibtex(self) -> str:
        """The BibTeX entry."""
        fields = [("author", self.authors), ("title", f"{{{self.title}}}")]
        fields += [("year", str(self.year))] if self.year else []
        fields += [*self.where, *([("doi", self.doi)] if self.doi else [])]
        lines = ",\n".join(f"  {name} = {{{value}}}" for name, value in fields)
        return f"@{self.kind}{{{self.key},\n{lines}\n}}"


@dataclass(frozen=True, slots=True)
class Cited:
    """A reference and what of the fit it stands behind."""

    reference: Reference
    reason: str


def _article(
    key: str, authors: str, title: str, year: int, journal: str, volume: str, pages: str, doi: str
) -> Reference:
    return Reference(
        key=key,
        kind="article",
        authors=authors,
        title=title,
        year=year,
        where=(("journal", journal), ("volume", volume), ("pages", pages)),
        doi=doi,
    )


SOFTWARE = Reference(
    key="surae",
    kind="software",
    authors="{The surae developers}",
    title="surae: ankle muscle parameters from angle, torque and EMG, with honest uncertainty",
    year=None,
    where=(("version", __version__),),
)
THESIS = Reference(
    key="vandepoll2015",
    kind="mastersthesis",
    authors="van de Poll, Koen",
    title="Estimating ankle muscle parameters",
    year=2015,
    where=(("school", "Delft University of Technology"),),
)
DE_VLUGT = _article(
    "devlugt2010",
    "de Vlugt, Erwin and de Groot, Jurriaan H. and Schenkeveld, Kim E. and Arendzen, J. Hans and "
    "van der Helm, Frans C. T. and Meskers, Carel G. M.",
    "The relation between neuromechanical parameters and Ashworth score in stroke patients",
    2010, "Journal of NeuroEngineering and Rehabilitation", "7", "35", "10.1186/1743-0003-7-35",
)  # fmt: skip
THELEN = _article(
    "thelen2003",
    "Thelen, Darryl G.",
    "Adjustment of muscle mechanics model parameters to simulate dynamic contractions in older "
    "adults",
    2003, "Journal of Biomechanical Engineering", "125", "70--77", "10.1115/1.1531112",
)  # fmt: skip
ALEXANDER = _article(
    "alexander1977",
    "Alexander, Roger",
    "Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s",
    1977, "SIAM Journal on Numerical Analysis", "14", "1006--1021", "10.1137/0714068",
)  # fmt: skip
GOLUB = _article(
    "golub1973",
    "Golub, Gene H. and Pereyra, Victor",
    "The differentiation of pseudo-inverses and nonlinear least squares problems whose variables "
    "separate",
    1973, "SIAM Journal on Numerical Analysis", "10", "413--432", "10.1137/0710036",
)  # fmt: skip
MORE = Reference(
    key="more1978",
    kind="incollection",
    authors="Moré, Jorge J.",
    title="The Levenberg-Marquardt algorithm: implementation and theory",
    year=1978,
    where=(
        ("booktitle", "Numerical Analysis, Lecture Notes in Mathematics 630"),
        ("pages", "105--116"),
    ),
    doi="10.1007/BFb0067700",
)
LJUNG = _article(
    "ljung1978",
    "Ljung, Greta M. and Box, George E. P.",
    "On a measure of lack of fit in time series models",
    1978, "Biometrika", "65", "297--303", "10.1093/biomet/65.2.297",
)  # fmt: skip
WORSLEY = _article(
    "worsley2002",
    "Worsley, Keith J. and Liao, C. H. and Aston, J. and Petre, V. and Duncan, G. H. and "
    "Morales, F. and Evans, A. C.",
    "A general statistical analysis for fMRI data",
    2002, "NeuroImage", "15", "1--15", "10.1006/nimg.2001.0933",
)  # fmt: skip
HOLLAND = _article(
    "holland1977",
    "Holland, Paul W. and Welsch, Roy E.",
    "Robust regression using iteratively reweighted least-squares",
    1977, "Communications in Statistics - Theory and Methods", "6", "813--827",
    "10.1080/03610927708827533",
)  # fmt: skip
NUMPY = _article(
    "harris2020",
    "Harris, Charles R. and others",
    "Array programming with NumPy",
    2020, "Nature", "585", "357--362", "10.1038/s41586-020-2649-2",
)  # fmt: skip
SCIPY = _article(
    "virtanen2020",
    "Virtanen, Pauli and others",
    "SciPy 1.0: fundamental algorithms for scientific computing in Python",
    2020, "Nature Methods", "17", "261--272", "10.1038/s41592-019-0686-2",
)  # fmt: skip
NUMBA = Reference(
    key="lam2015",
    kind="inproceedings",
    authors="Lam, Siu Kwan and Pitrou, Antoine and Seibert, Stanley",
    title="Numba: a LLVM-based Python JIT compiler",
    year=2015,
    where=(
        ("booktitle", "Proceedings of the Second Workshop on the LLVM Compiler Infrastructure"),
    ),
    doi="10.1145/2833157.2833162",
)

#: Of every fit, whatever it used.
ALWAYS: tuple[Cited, ...] = (
    Cited(SOFTWARE, "the program"),
    Cited(THESIS, "the models and the measures of a fit"),
    Cited(NUMPY, "arrays"),
    Cited(SCIPY, "linear algebra and filters"),
    Cited(NUMBA, "compiled kernels"),
)


def cited_by(result: FitResult, assessment: Assessment) -> tuple[Cited, ...]:
    """What a fit stands on: the program, its model, its estimation, its intervals.

    Parameters
    ----------
    result : FitResult
        The fit.
    assessment : Assessment
        What it is worth.
    """
    spec, options = result.problem.spec, result.problem.options
    known = {p.group for p in spec.parameters}
    cited = list(ALWAYS[:2])
    if spec.name == "muscle-2010":
        cited.append(Cited(DE_VLUGT, "the model, reconstructed"))
    if "tendon" in known:
        cited.append(Cited(THELEN, "the tendons"))
        if options.integrator == "implicit":
            cited.append(Cited(ALEXANDER, "the integrator of muscle and tendon"))
    if spec.linear or spec.parent is not None:
        cited.append(Cited(GOLUB, "starts: linear parameters solved for given the others"))
    cited.append(Cited(MORE, "least squares within bounds"))
    if result.outliers is not None:
        cited.append(Cited(HOLLAND, f"the loss {result.outliers.loss}"))
    cited.append(Cited(LJUNG, "the test of the residual for correlation"))
    if assessment.interval is Interval.ROBUST:
        cited.append(Cited(WORSLEY, "intervals under correlated noise"))
    return (*cited, *ALWAYS[2:])
