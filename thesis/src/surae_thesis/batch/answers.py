"""What a batch says: a summary by model and protocol, and the thesis's figures of one cohort."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import fmean, median

import numpy as np

from surae_thesis.batch.table import predictions
from surae_thesis.batch.work import FREQUENCIES, Plain, comparable
from surae_thesis.cohort.boxes import Box, snsem_figure, vaf_figure
from surae_thesis.cohort.drawings import spectra_figure
from surae_thesis.section import Cell, Drawing, Result, Table

Key = tuple[str, int]
#: Where two spectra are compared [Hz], as the thesis's Figure 40.
_COMPARED = (0.25, 5.0)


@dataclass(frozen=True, slots=True)
class Outcomes:
    """What came of a batch, to be asked: labels and outcomes."""

    every: Sequence[tuple[Plain, Plain]]

    def fits(self, way: str = "", protocol: str = "") -> Iterator[tuple[Plain, Plain]]:
        """Fits that gave estimates, of a way (`ways`) and a protocol."""
        for label, fit in self.every:
            if label["kind"] == "fit" and "parameters" in fit:
                of_way = not way or way == way_of(label)
                if of_way and (not protocol or label["protocol"] == protocol):
                    yield label, fit

    @property
    def ways(self) -> list[str]:
        """Models, each with what was fixed."""
        return list(dict.fromkeys(way_of(lb) for lb, _ in self.every if lb["kind"] == "fit"))

    @property
    def protocols(self) -> list[str]:
        """Protocols, in the order of their names."""
        return list(
            dict.fromkeys(lb["protocol"] for lb, _ in self.every if lb["kind"] in ("trial", "fit"))
        )

    def vaf(self, way: str, protocol: str) -> dict[Key, float]:
        """VAF of the fits [%]."""
        return {_key(lb): fit["vaf"] for lb, fit in self.fits(way, protocol) if fit["vaf"]}

    def predicted(self, way: str, protocol: str, target: str = "") -> dict[Key, float]:
        """VAF [%] of the others, or of another protocol, as the first repetition predicts them."""
        first = self._first(way, protocol)
        return {
            (label["subject"], repetition): vaf
            for label, fit in first
            for repetition, vaf in predictions(label, fit, target or protocol)
        }

    def _first(self, way: str, protocol: str) -> list[tuple[Plain, Plain]]:
        by_subject: dict[str, tuple[Plain, Plain]] = {}
        for label, fit in sorted(self.fits(way, protocol), key=lambda one: one[0]["repetition"]):
            by_subject.setdefault(label["subject"], (label, fit))
        return list(by_subject.values())

    def snsem(self, way: str, protocol: str) -> dict[str, list[float]]:
        """Standard errors over the mean one of the simulations, by parameter."""
        several: dict[str, list[float]] = {}
        model = way.partition(" ")[0]
        for label, outcome in self.every:
            if (label["kind"], label.get("model")) == ("simulation", model):
                for name, sem in outcome.get("sem", {}).items():
                    if label["protocol"] == protocol:
                        several.setdefault(name, []).append(sem)
        baseline = {name: fmean(values) for name, values in several.items()}
        ratios: dict[str, list[float]] = {}
        for _, fit in self.fits(way, protocol):
            for name, p in fit["parameters"].items():
                if name in baseline:
                    of_name = ratios.setdefault(name, [])
                    if p["sem"] is not None:
                        of_name.append(comparable(name, p["value"], p["sem"]) / baseline[name])
        return ratios

    def spectra(self, protocol: str) -> dict[str, list[np.ndarray]]:
        """Power densities of the torque of the repetitions, by subject."""
        several: dict[str, list[np.ndarray]] = {}
        for label, seen in self.every:
            if label["kind"] == "trial" and label["protocol"] == protocol and "spectrum" in seen:
                several.setdefault(label["subject"], []).append(np.array(seen["spectrum"]))
        return {subject: each for subject, each in several.items() if len(each) > 1}


def way_of(label: Plain) -> str:
    """A model, and what was fixed."""
    return f"{label['model']} {label['fixed']}".strip()


def _key(label: Plain) -> Key:
    return label["subject"], label["repetition"]


def answers(outcomes: Sequence[tuple[Plain, Plain]]) -> Result:
    """Summary, parameters, repetitions and figures."""
    o = Outcomes(outcomes)
    failed = [(lb, out["failed"]) for lb, out in outcomes if out.get("failed")]
    notes = (
        f"{sum(1 for _ in o.fits())} fits of {len({_subject(lb) for lb, _ in o.fits()})} subjects; "
        f"{sum(lb['kind'] == 'fit' for lb, _ in failed)} failed. Validation: a subject's first "
        "repetition predicts the others of the protocol. snSEM: the standard error of equation "
        "(34) over the mean one of simulations, in which virtual legs move and strain as recorded, "
        "with noise of 5 %; of EMG weights both relative to the value. IPDE: equation (35).",
    )
    tables = [_summary(o), _parameters(o), _repetitions(o)]
    if failed:
        rows = tuple((" ".join(map(str, lb.values())), why) for lb, why in failed)
        tables.append(Table("batch-failed", "What failed", ("what", "why"), rows))
    return Result(findings=(), notes=notes, tables=tuple(tables), figures=tuple(_figures(o)))


def _subject(label: Plain) -> str:
    return str(label["subject"])


def _of(values: Iterable[float], how: Callable[[Sequence[float]], float]) -> Cell:
    several = list(values)
    return round(float(how(several)), 4) if several else None


def _summary(o: Outcomes) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for way in o.ways:
        for protocol in o.protocols:
            fits = [fit for _, fit in o.fits(way, protocol)]
            vaf = o.vaf(way, protocol).values()
            valid = o.predicted(way, protocol).values()
            free = [p for fit in fits for p in fit["parameters"].values()]
            relative = [100 * p["sem"] / abs(p["value"]) for p in free if p["sem"] and p["value"]]
            ratios = [median(v) for v in o.snsem(way, protocol).values() if v]
            rows.append(
                (
                    way,
                    protocol,
                    len(fits),
                    _of(vaf, fmean),
                    _of(vaf, min),
                    _of(valid, fmean),
                    _of(valid, min),
                    _of(relative, median),
                    _of(ratios, median),
                    _of((f["ipde"] for f in fits if f["ipde"] is not None), median),
                    _of((100.0 * (f["grade"] == "adequate") for f in fits), fmean),
                    _of((f["seconds"] for f in fits), fmean),
                )
            )
    return Table(
        "batch-summary",
        "By model and protocol",
        (
            "model",
            "protocol",
            "fits",
            "VAF, mean [%]",
            "lowest",
            "validation VAF, mean [%]",
            "lowest ",
            "SEM, median [%]",
            "snSEM, median",
            "IPDE, median",
            "adequate [%]",
            "seconds a fit",
        ),
        tuple(rows),
    )


def _parameters(o: Outcomes) -> Table:
    """Every parameter's level, and how well subjects repeat it."""
    rows: list[tuple[Cell, ...]] = []
    for way in o.ways:
        for protocol in o.protocols:
            several: dict[str, dict[str, list[float]]] = {}
            verdicts: dict[str, list[str]] = {}
            for label, fit in o.fits(way, protocol):
                for name, p in fit["parameters"].items():
                    if p["value"] is not None:
                        of = several.setdefault(name, {})
                        of.setdefault(label["subject"], []).append(p["value"])
                        verdicts.setdefault(name, []).append(p["verdict"])
            ratios = o.snsem(way, protocol)
            for name, by_subject in several.items():
                repeat = [
                    100 * float(np.std(v, ddof=1)) / abs(fmean(v))
                    for v in by_subject.values()
                    if len(v) > 1 and fmean(v)
                ]
                judged = verdicts[name]
                rows.append(
                    (
                        way,
                        protocol,
                        name,
                        _of((fmean(v) for v in by_subject.values()), median),
                        _of(repeat, median),
                        _of(ratios.get(name, ()), median),
                        _of((100.0 * (v == "identified") for v in judged), fmean),
                        _of((100.0 * (v == "at-bound") for v in judged), fmean),
                    )
                )
    columns = (
        "model",
        "protocol",
        "parameter",
        "median",
        "between repetitions, CV [%]",
        "snSEM, median",
        "identified [%]",
        "at bound [%]",
    )
    title = "Parameters: median of subjects, and how well they repeat"
    return Table("batch-parameters", title, columns, tuple(rows), long=True)


def _repetitions(o: Outcomes) -> Table:
    inside = (_COMPARED[0] <= FREQUENCIES) & (_COMPARED[1] >= FREQUENCIES)
    rows = []
    for protocol in o.protocols:
        for subject, spectra in o.spectra(protocol).items():
            shorter = min(map(len, spectra))
            use = inside[:shorter]
            apart = [
                float(np.mean(np.abs(a[:shorter][use] - b[:shorter][use])))
                for a, b in combinations(spectra, 2)
            ]
            rows.append((protocol, subject, len(spectra), round(fmean(apart), 2)))
    columns = ("protocol", "subject", "repetitions", "apart [dB]")
    title = "How far the torque's spectra of repetitions lie apart, 0.25 to 5 Hz"
    return Table("batch-repetitions", title, columns, tuple(rows))


def _figures(o: Outcomes) -> Iterator[Drawing]:
    """Figures 17, 23 and 32; 29 and 35; 30; 21, 22, 26, 27, 33 and 34; 40 of the thesis."""
    boxes = [
        ("vaf", "VAF of the fits", "as Figures 17, 23 and 32", o.vaf),
        (
            "validation",
            "VAF of repetitions that the first one predicts",
            "as Figures 29 and 35",
            o.predicted,
        ),
    ]
    for way in o.ways:
        for name, title, like, points in boxes:
            yield from _boxes(
                f"batch-{name}-{_file(way)}",
                f"Model {way}: {title}",
                like,
                {p: points(way, p) for p in o.protocols},
            )
        across = {
            f"{target} from {p}": o.predicted(way, p, target)
            for p in o.protocols
            for target in o.protocols
            if target != p
        }
        yield from _boxes(
            f"batch-across-{_file(way)}",
            f"Model {way}: VAF of other protocols that the first repetition predicts",
            "as Figure 30",
            across,
        )
        for protocol in o.protocols:
            ratios = o.snsem(way, protocol)
            fits = sum(1 for _ in o.fits(way, protocol))
            if any(ratios.values()):
                without = {name: fits - len(values) for name, values in ratios.items()}
                yield Drawing(
                    f"batch-snsem-{_file(way)}-{_file(protocol)}",
                    f"Model {way}, {protocol}: snSEM (as Figures 21, 22, 26, 27, 33 and 34)",
                    "Standard error of every recording over the mean of the simulations.",
                    f"Box plots of snSEM by parameter, model {way}, {protocol}.",
                    snsem_figure({n: v for n, v in ratios.items() if v}, without),
                )
    for protocol in o.protocols:
        several = o.spectra(protocol)
        if several:
            subject = max(several, key=lambda one: len(several[one]))
            yield Drawing(
                f"batch-spectra-{_file(protocol)}",
                f"{protocol}: power spectra of one subject's repetitions (as Figure 40)",
                f"Subject {subject}, torque as recorded, Welch's method; of all subjects the table "
                "says how far they lie apart.",
                f"Power density of the torque of {len(several[subject])} repetitions.",
                spectra_figure([(FREQUENCIES[: len(p)], p) for p in several[subject]]),
            )


def _boxes(
    name: str, title: str, like: str, groups: Mapping[str, Mapping[Key, float]]
) -> Iterator[Drawing]:
    some = {label: points for label, points in groups.items() if points}
    if not some:
        return
    least = min(min(points.values()) for points in some.values())
    low = max(0.0, 10.0 * np.floor(least / 10.0))
    boxes = [Box(label.replace(" from ", "\nfrom "), points) for label, points in some.items()]
    yield Drawing(
        name,
        f"{title} ({like})",
        "Boxes: 25th to 75th percentile, whiskers to 1.5 times their distance, every recording a "
        "dot.",
        f"Box plots of VAF: {', '.join(some)}.",
        vaf_figure(boxes, low),
    )


def _file(text: str) -> str:
    return "".join(c if c.isalnum() or c in ".-" else "-" for c in text)
