"""What came of a session: its fits, what they predict of each other, its table and folder."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from surae._version import __version__
from surae.api.fitted import Fit
from surae.api.fitting import load
from surae.base.errors import InputError, within
from surae.base.file_form import filed
from surae.base.files import PathLike, shown, write_json, write_table
from surae.base.frozen import FrozenDict
from surae.base.packed import finite
from surae.base.records import SESSION_FORMAT, from_plain, read_json, to_plain
from surae.recording import SourceFile
from surae.trials import Trial, TrialSet, common_errors
from surae.trials.fitted_leg import FittedLeg
from surae.trials.folder import (
    INDEX,
    JOINT,
    REPORT,
    TABLE,
    claimed,
    fit_name,
    require_own,
    results_in,
    set_aside,
)

if TYPE_CHECKING:
    from surae.report.output import Report


@filed("session", "fits", "joint")
@dataclass(frozen=True, slots=True)
class SessionResult(FittedLeg):
    """What came of a session."""

    fits: Mapping[str, Fit] = field(default_factory=FrozenDict)  #: By trial.
    joint: Fit | None = None  #: Of all trials in `joined` together.

    def __repr__(self) -> str:
        lines = [f"{self.session.name}: {len(self.fits)} fits of {len(self.session.trials)} trials"]
        fits = [*self.fits.items(), *([("joint", self.joint)] if self.joint else [])]
        for name, fit in fits:
            lines.append(f"  {name}: {fit.adequacy.grade}, R² {fit.adequacy.r2:.2f} %")
        lines += [f"  {name}: {why}" for name, why in self.failed.items()]
        return "\n".join(lines)

    @property
    def common(self) -> tuple[str, ...]:
        """What is wrong in most trials alike, and what to do: it is mended once, in the mapping."""
        return common_errors(self.quality[name] for name in self.fits if name in self.quality)

    def rows(self) -> list[dict[str, Any]]:
        """The table: a row for every fit, the joint one last.

        Returns
        -------
        list of dict
            Trial, effort, grade, R² and VAF [%], RMSE [Nm], then of every parameter its value,
            ends of its 95 % interval and verdict; None where there is no number.
        """
        every = [(name, self.session[name], fit) for name, fit in self.fits.items()]
        rows = [_row(name, trial.effort, fit) for name, trial, fit in every]
        if self.joint is not None:
            rows.append(_row("joint", "", self.joint))
        return rows

    def to_dataframe(self) -> Any:
        """Convert the rows to a pandas DataFrame, units of the columns in ``attrs["units"]``."""
        from surae.recording.frames import frame

        every = [*self.fits.values(), *([self.joint] if self.joint else [])]
        units = {n: p.unit for fit in every for n, p in fit.parameters.items()}
        return frame(self.rows(), units)

    def report(
        self, path: PathLike, *, before: "SessionResult | None" = None, language: str = "en"
    ) -> None:
        """Write the leg's page: one self-contained HTML file, or a PDF where `path` ends so.

        Parameters
        ----------
        path : path
            Where to.
        before : SessionResult, optional
            An earlier visit of the leg, to say what has changed since.
        language : {"en", "nl", "de", "fr"}
            The reader's; details and research are in English alone.

        Raises
        ------
        InputError
            It cannot be written, a PDF needs typst, or the language is not known.
        """
        self._report(before, language).write(path)

    def answers(
        self, *, before: "SessionResult | None" = None, language: str = "en"
    ) -> Mapping[str, str]:
        """The questions of the leg's page and the answer to each, in a line.

        Parameters
        ----------
        before : SessionResult, optional
            An earlier visit of the leg, to say what has changed since.
        language : {"en", "nl", "de", "fr"}
            The reader's.

        Returns
        -------
        mapping of str to str
            By question: how stiff, of what, how much is nerve where that was measured, whether it
            changed, whether to trust it.
        """
        from surae.report.session import answers_in

        return FrozenDict(answers_in(self._report(before, language, brief=True).document))

    def blocks(self, language: str = "en") -> dict[str, Any]:
        """The leg's page as plain data.

        Parameters
        ----------
        language : {"en", "nl", "de", "fr"}
            The reader's.

        Returns
        -------
        dict
            Its blocks, its images as data URLs, and its signals.
        """
        return self._report(None, language).plain()

    def _repr_html_(self) -> str:
        """The leg's page, as a notebook's cell shows it."""
        from surae.report import part_of, style

        shown = part_of(**self.blocks() | {"signals": ""})
        return f'<style>{style()}</style><div class="report">{shown}</div>'

    @property
    def main(self) -> Fit | None:
        """The fit that stands for the leg: that of all together, or the only one."""
        return self.joint or (next(iter(self.fits.values())) if len(self.fits) == 1 else None)

    def _report(
        self, before: "SessionResult | None", language: str, *, brief: bool = False
    ) -> "Report":
        from surae.report.session import session_report  # matplotlib

        first = None if before is None else before.main
        now = datetime.now().astimezone()
        return session_report(self, created=now, before=first, language=language, brief=brief)

    def save(self, folder: PathLike) -> None:
        """Write the folder that `load_session` reads: fits, tables, report and index.

        Parameters
        ----------
        folder : path
            It is made where it is missing. Results that are in it already are replaced.

        Raises
        ------
        InputError
            Something cannot be written, or would replace what is no result of a session.
        """
        root = claimed(folder, self.session.trials)
        write_index(self, root, begun=True)
        for name, fit in self.fits.items():
            fit.save(root / fit_name(name))
        if self.joint is not None:
            self.joint.save(root / JOINT)
        write_summary(self, root)


def _row(name: str, effort: str, fit: Fit) -> dict[str, Any]:
    row: dict[str, Any] = {
        "trial": name,
        "effort": effort,
        "model": fit.result.problem.spec.name,
        "status": fit.status,
        "grade": str(fit.adequacy.grade),
        "r2": finite(fit.adequacy.r2),
        "vaf": finite(fit.vaf),
        "rmse_Nm": finite(fit.assessment.rmse),
    }
    for p in fit.parameters.values():
        low, high = p.ci95 or (None, None)
        row |= {p.name: p.value, f"{p.name}_low": low, f"{p.name}_high": high}
        row[f"{p.name}_verdict"] = str(p.verdict)
    return row


def write_summary(result: SessionResult, root: Path) -> None:
    """Write index, tables and report; fits of earlier runs go to the trash."""
    set_aside(root, _results(result))
    write_index(result, root)
    rows = result.rows()
    write_table(root / TABLE, list(dict.fromkeys(name for row in rows for name in row)), rows)
    result.report(root / REPORT)


def write_index(result: SessionResult, root: Path, *, begun: bool = False) -> None:
    """Write the index; of a run that has `begun`, before there is any fit.

    A fit that is on its way is the run's own then, whenever it is stopped; what was there before is
    no longer a result.
    """
    data = _index(replace(result, fits={}, joint=None, interrupted=True) if begun else result)
    data["results"] = sorted(_results(result))
    if begun:
        planned = {fit_name(trial.name) for trial in result.session.trials}
        data["results"] = sorted(results_in(root) | planned | {JOINT})
    write_json(root / INDEX, data)


def _results(result: SessionResult) -> set[str]:
    return {fit_name(name) for name in result.fits} | ({JOINT} if result.joint else set())


def _index(result: SessionResult) -> dict[str, Any]:
    return {
        "format": "surae session",
        "version": SESSION_FORMAT,
        "surae": __version__,
        **to_plain(result.session),
        "mapping": result.session.mapping and _source(result.session.mapping),
        "trials": [_trial(trial, trial.name in result.fits) for trial in result.session.trials],
        **to_plain(result),
        "joint": None if result.joint is None else JOINT,
    }


def _trial(trial: Trial, fitted: bool) -> dict[str, Any]:
    files = () if trial.recording is None else trial.recording.files
    more = {"files": [_source(file) for file in files], "fit": fit_name(trial.name)}
    return {**to_plain(trial), **more, **({} if fitted else {"fit": None})}


def _source(file: SourceFile) -> dict[str, str]:
    return {"name": file.name, "sha256": file.sha256}


@dataclass(frozen=True, slots=True)
class _ReadTrial:
    name: str
    fit: str | None


@dataclass(frozen=True, slots=True)
class _Index:
    """What is read of the index beside the fields of session and result."""

    trials: tuple[_ReadTrial, ...]
    joint: str | None


def load_session(folder: PathLike) -> SessionResult:
    """Read the folder that `surae session` or `SessionResult.save` wrote.

    Parameters
    ----------
    folder : path
        The folder.

    Returns
    -------
    SessionResult
        With its fits; the trials' own signals stay where they were.

    Raises
    ------
    InputError
        It is no such folder, or is damaged.

    Examples
    --------
    >>> surae.load_session("OUT").joint
    """
    root = Path(folder)
    if not (root / INDEX).is_file():
        raise InputError(f"{shown(folder)}: this is no session: it has no {INDEX}")
    data = read_json(root / INDEX)
    where = shown(root / INDEX)
    if data.get("format") != "surae session" or data.get("version") != SESSION_FORMAT:
        raise InputError(f"{where}: damaged, or of a newer surae")
    with within(where, "; damaged, or of a newer surae"):
        index = from_plain(_Index, data)
        session = from_plain(TrialSet, {**data, "mapping": None})
        result = from_plain(SessionResult, {**data, "session": session, "fits": {}, "joint": None})
    fits = {each.name: load(root / fit_name(each.name)) for each in index.trials if each.fit}
    joint = load(root / JOINT) if index.joint else None
    for name, fit in (*fits.items(), *([("", joint)] if joint else [])):
        require_own(root, fit.result.problem.inputs, name)
    return replace(result, fits=fits, joint=joint)
