"""The papers behind the methods that a fit used, to be cited with it: references.bib."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from surae._version import __version__
from surae.assessment import Assessment, Interval
from surae.estimation import FitResult

_ENTRY = re.compile(r"@(?P<kind>\w+)\{(?P<key>\w+),\n(?P<fields>.*?)\n\}\n", re.DOTALL)
_FIELD = re.compile(r"  (\w+) = \{(.*)\},?")


@dataclass(frozen=True, slots=True)
class Reference:
    """A publication as BibTeX has it: its key, the kind of entry, and the fields in their order."""

    key: str
    kind: str
    fields: Mapping[str, str]

    @property
    def doi(self) -> str:
        """The DOI; empty where it has none."""
        return self.fields.get("doi", "")

    @property
    def title(self) -> str:
        """The title without BibTeX's braces."""
        return self.fields["title"].strip("{}")

    @property
    def text(self) -> str:
        """The reference as one line for readers."""
        names = re.sub("[{}]", "", self.fields["author"]).replace(" and ", "; ")
        year = f" ({self.fields['year']})" if "year" in self.fields else ""
        in_front = ("author", "title", "year", "doi")
        places = ", ".join(text for name, text in self.fields.items() if name not in in_front)
        doi = f" doi:{self.doi}" if self.doi else ""
        return f"{names}{year}. {self.title}. {places}.{doi}"

    @property
    def bibtex(self) -> str:
        """The BibTeX entry."""
        lines = ",\n".join(f"  {name} = {{{text}}}" for name, text in self.fields.items())
        return f"@{self.kind}{{{self.key},\n{lines}\n}}"


@dataclass(frozen=True, slots=True)
class Cited:
    """A reference and what of the fit it stands behind."""

    reference: Reference
    reason: str


@cache
def references() -> dict[str, Reference]:
    """Every reference of references.bib by its key; the program's own has its version."""
    text = files("surae.report").joinpath("references.bib").read_text(encoding="utf-8")
    entries = {
        entry["key"]: Reference(entry["key"], entry["kind"], dict(_FIELD.findall(entry["fields"])))
        for entry in _ENTRY.finditer(text)
    }
    own = entries["surae"]
    return entries | {"surae": Reference("surae", own.kind, {**own.fields, "version": __version__})}


def always_cited() -> tuple[Cited, ...]:
    """What every fit stands on, whatever it used."""
    return (
        _cited("surae", "the program"),
        _cited("vandepoll2015", "the models and the measures of a fit"),
        _cited("harris2020", "arrays"),
        _cited("virtanen2020", "linear algebra and filters"),
        _cited("lam2015", "compiled kernels"),
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
    cited = [_cited(key, why) for key, why in spec.cites.items()]
    if "tendon" in known:
        cited.append(_cited("thelen2003", "the tendons"))
        if options.integrator == "implicit":
            cited.append(_cited("alexander1977", "the integrator of muscle and tendon"))
    if spec.linear or spec.parent is not None:
        cited.append(_cited("golub1973", "starts: linear parameters solved for given the others"))
    cited.append(_cited("more1978", "least squares within bounds"))
    if result.outliers is not None:
        cited.append(_cited("holland1977", f"the loss {result.outliers.loss}"))
    cited.append(_cited("ljung1978", "the test of the residual for correlation"))
    if assessment.interval is Interval.ROBUST:
        cited.append(_cited("worsley2002", "intervals under correlated noise"))
    always = always_cited()
    return (*always[:2], *cited, *always[2:])


def _cited(key: str, reason: str) -> Cited:
    return Cited(references()[key], reason)
