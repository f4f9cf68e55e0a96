"""What workers do: fits, profiles, studies and designs, each by its kind; reports.

A job takes its task, which is plain data, tells what happens, and returns plain data.
"""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from datetime import date
from math import isfinite
from pathlib import Path
from typing import Any

from surae import api
from surae.base.errors import InputError
from surae.base.files import write_json
from surae.base.names import LANGUAGES
from surae.base.words import N_
from surae.processes import tell
from surae_workbench.web import imports, sliders
from surae_workbench.web.draft import settings_of
from surae_workbench.web.fit_progress import FitProgress
from surae_workbench.web.places import FILES, file_of, recording_suffix
from surae_workbench.web.rows import MEASURES

Task = Mapping[str, Any]


def _file(task: Task, kind: str, id_: str, suffix: str | None = None) -> Path:
    """The file of an entry of the project that the task belongs to."""
    folder, usual = FILES[kind]
    return file_of(Path(task["root"]), folder, id_, suffix or usual)


def _read(task: Task, ids: Sequence[str]) -> list[api.Recording]:
    """Recordings of the project."""
    recordings = []
    for id_ in ids:
        tell({"phase": "reading"})
        suffix = recording_suffix(task.get("versions", {}).get(id_, 0))
        recordings.append(imports.read_recording(_file(task, "recording", id_, suffix)))
    return recordings


def _request_of(
    task: Task,
) -> "tuple[api.FitSettings, list[api.Recording], tuple[api.ModelInputs, ...]]":
    """What the draft of a task asks, its recordings, and what a model reads of them."""
    draft = task["draft"]
    settings = settings_of(draft, task["recordings"])
    recordings = _read(task, task["recordings"])
    contractions = _read(task, draft["mvc"])
    tell({"phase": "preparing"})
    return settings, recordings, settings.inputs(recordings, contractions)


def _compiling() -> AbstractContextManager[None]:
    """Tell when the models have to be compiled, which takes some ten seconds, once."""
    return api.on_compilation(lambda: tell({"phase": "compiling"}))


def fit(task: Task) -> dict[str, Any]:
    """Fit, as `surae fit` does, and write FIT.json."""
    settings, recordings, inputs = _request_of(task)
    quality = api.checks_for(settings, recordings)
    news = FitProgress(settings.starts or 2)
    with _compiling():
        fitted = api.fit_inputs(inputs, settings, quality, progress=news.start, follow=news.point)
    fitted.save(_file(task, "fit", task["id"]))
    return {
        "message": fitted.message,
        "interrupted": fitted.result.solution.is_interrupted,
        "summary": summary(fitted),
    }


def session(task: Task) -> dict[str, Any]:
    """Fit trials each and all together as `surae session` does, and write fits and report."""
    recordings = [
        replace(recording, name=task["names"][id_])
        for id_, recording in zip(task["recordings"], _read(task, task["recordings"]), strict=True)
    ]

    settings = settings_of(task["draft"], ())
    efforts = {task["names"][id_]: effort for id_, effort in task["efforts"].items()}
    leg = api.session(recordings, name=task["name"], efforts=efforts)

    first = {_: api.first_answer(leg.trials, api.words_in(_)) for _ in LANGUAGES}

    lines: list[dict[str, Any]] = []
    begun = last = time.monotonic()

    def progress(step: "api.Step") -> None:
        nonlocal last
        if step.outcome:  # what ended, with what came of it and how long it took
            now = time.monotonic()
            lines.append({"what": step.what, "outcome": step.outcome, "seconds": now - last})
            last = now
        news = {"what": step.what, "done": step.done, "total": step.total, "left_s": step.left_s}
        tell({**news, "first": first, "lines": lines})

    with _compiling():
        result = leg.run(None, settings, progress=progress, workers=None)
    fitted_at = time.monotonic()
    language = str(task.get("language", "en"))
    answers = dict(result.answers(language=language)) if result.fits or result.joint else {}
    news = {"what": N_("drawing the page"), "lines": lines, "answers": answers}
    tell({**news, "done": 0, "total": len(LANGUAGES)})
    fits = {**result.fits, **({} if result.joint is None else {"joint": result.joint})}
    for name, fitted in fits.items():
        fitted.save(_file(task, "fit", task["fits"][name]))
    pages = {}
    for done, each in enumerate(LANGUAGES, 1):
        pages[each] = result.blocks(each)
        tell({**news, "done": done, "total": len(LANGUAGES)})
    kept = {**pages.pop("en"), "translated": pages}
    write_json(_file(task, "session", task["id"]), kept)
    graded = None if result.main is None else {"grade": str(result.main.adequacy.grade)}
    return {
        "message": f"{len(result.fits)} of {len(recordings)} trials fitted"
        + ("" if result.joint is None else f", {len(result.joined)} together")
        + f": {fitted_at - begun:.0f} s for the fits, {time.monotonic() - fitted_at:.0f} s for the "
        f"page in {len(LANGUAGES)} languages",
        "interrupted": result.interrupted,
        "summaries": {
            name: summary(fitted, measured=name == "joint" or len(fits) == 1)
            for name, fitted in fits.items()
        },
        "joined": list(result.joined),
        "content": {"adequacy": graded},
    }


def summary(fitted: "api.Fit", *, measured: bool = True) -> dict[str, Any]:
    """What lists and tables show of a fit, and where it stands for a leg of what was `measured`."""
    known = fitted.measures((10.0,)) if measured else {}
    return {
        "model": fitted.result.problem.spec.name,
        "status": fitted.status,
        "grade": str(fitted.adequacy.grade),
        "r2": fitted.adequacy.r2 if isfinite(fitted.adequacy.r2) else None,
        "vaf": fitted.vaf if isfinite(fitted.vaf) else None,
        "ipde": fitted.ipde,
        "names": [recording.name for recording in fitted.assessment.recordings],
        "measures": {name: _estimate(known[name], None) for name in MEASURES if name in known},
        "parameters": {p.name: _estimate(p, p.trusted_sem) for p in fitted.parameters.values()},
    }


def _estimate(known: "api.Measure | api.ParameterEstimate", sem: float | None) -> dict[str, Any]:
    """A measure or parameter as tables show it."""
    low, high = known.ci95 or (None, None)
    return {
        "value": known.value,
        "sem": sem,
        "low": low,
        "high": high,
        "verdict": str(known.verdict),
    }


def profile(task: Task) -> dict[str, Any]:
    """Profile parameters of a fit, and write them."""
    fitted = api.load(_file(task, "fit", task["fit"]))

    def progress(name: str, done: int, total: int) -> None:
        tell({"parameter": name, "done": done, "total": total})

    with _compiling():
        profiles = api.profile(fitted, task["parameters"], workers=1, progress=progress)
    missing = ", ".join(profiles.missing)
    return {
        "message": f"stopped before {missing}" if missing else f"{len(profiles.profiles)} profiles",
        "interrupted": bool(profiles.missing),
        "profiles": {name: _profile(row) for name, row in profiles.as_dict()["profiles"].items()},
    }


def _profile(row: Mapping[str, Any]) -> dict[str, Any]:
    """What a page draws of a profile."""
    low, high = row["interval"]
    renamed = {"values": "grid", "delta": "delta_chi2", "threshold": "threshold", "note": "message"}
    return {"lower": low, "upper": high} | {key: row[of] for key, of in renamed.items()}


def _counting(before: int = 0, total: int | None = None) -> Callable[..., None]:
    """Tells how many parts are done, not too often; after `before` others, of so many in all."""
    last = 0.0

    def count(done: int, of: int, *_: object) -> None:
        nonlocal last
        if time.monotonic() - last > 0.2 or done == of:
            last = time.monotonic()
            tell({"done": before + done, "total": total or of})

    return count


def study(task: Task) -> dict[str, Any]:
    """Run a study, or go on with it."""
    with api.Store(_file(task, "study", task["study"]), write=True) as store:
        finished = api.run_study(api.parse_study(task["toml"]), store, progress=_counting())
    return {"message": f"{finished.fits} fits, all there", "interrupted": False}


#: Keys of a design's task that `surae.design` is not given.
_OWN = ("durations", "id", "root")


def design(task: Task) -> dict[str, Any]:
    """Search a protocol of each duration; the best until it is stopped is kept."""
    designs = list[dict[str, Any]]()
    each = task["evaluations"]
    settings = {key: value for key, value in task.items() if key not in _OWN}
    for k, seconds in enumerate(task["durations"]):
        with _compiling():
            designed = api.design(
                seconds, progress=_counting(k * each, each * len(task["durations"])), **settings
            )
        designs.append({"name": f"designed {seconds:g} s {task['aim']}", **designed.to_json()})
        if designed.stopped:
            break
    expectation = designs[-1]["expectation"]
    worst = "unknown" if expectation["worst"] is None else f"{100 * expectation['worst']:.2g} %"
    return {
        "message": f"largest error {worst} ({expectation['weakest']})",
        "interrupted": designed.stopped,
        "designs": designs,
    }


def report(fit: str, output: str) -> None:
    """Write a fit's report."""
    api.load(fit).report(output)


def leg_report(
    blocks: str, output: str, language: str, comparison: str, name: str, side: str, day: str
) -> None:
    """Write a leg's page as a file to keep, with what it is compared with."""
    kept = in_language(json.loads(Path(blocks).read_text(encoding="utf-8")), language)
    if comparison:
        made = _compared(comparison, language)
        kept["images"] = {**kept["images"], **made["images"]}
        page = next(each for each in kept["blocks"] if each.get("look") == "leg")
        for card in page["blocks"]:
            if card["anchor"] == "change":
                card["blocks"] = made["blocks"]
    kept |= {"heading": name, "title": name, "kicker": about_leg(side, day, language)}
    api.write_blocks(output, **kept)


def about_leg(side: str, day: str, language: str) -> str:
    """Which leg, and the day of the visit."""
    _ = api.words_in(language)
    sides = {"left": _("left leg"), "right": _("right leg")}
    return ", ".join(filter(None, (sides.get(side), day)))


def in_language(kept: dict[str, Any], language: str) -> dict[str, Any]:
    """A leg's page, which is kept in every language, in one of them."""
    translated = kept.pop("translated", {})
    if language != "en":
        if language not in translated:
            raise InputError("an older version made this leg: analyse it again")
        return dict(translated[language])
    return kept


def fit_part(fit: str) -> str:
    """A fit's report, as its page shows it."""
    return api.part_of(**api.load(fit).blocks())


def predictions(fit: str, recordings: Mapping[str, str]) -> str:
    """How a fit predicts other recordings, by name and file, as its page shows it."""
    fitted = api.load(fit)
    others = [replace(imports.read_recording(path), name=name) for name, path in recordings.items()]
    report = api.predictions_report(fitted.assessment, api.validate(fitted, others))
    return api.part_of(**report.plain())


def change(comparison: str, language: str) -> str:
    """What changed between visits, as the leg's page shows it."""
    return api.part_of(**_compared(comparison, language))


def _compared(comparison: str, language: str) -> dict[str, Any]:
    asked = json.loads(comparison)
    visits = [(name, date.fromisoformat(day), *rest) for name, day, *rest in asked["visits"]]
    pair = asked["before"], asked["after"]
    try:
        return api.visits_blocks(visits, *pair, language, asked.get("question", ()))
    except InputError as error:  # these visits have no such measure: what they have is shown
        if not asked.get("question"):
            raise
        made = api.visits_blocks(visits, *pair, language)
        note = {"kind": "paragraph", "text": str(error), "look": "note"}
        return {**made, "blocks": [note, *made["blocks"]]}


def nerve(recordings: Mapping[str, str], by: str, language: str, output: str = "") -> str:
    """What is tissue and what reflex in recordings, by name and file, as a page shows it.

    Where `output` says so it is written as a file to keep.
    """
    read = [replace(imports.read_recording(path), name=name) for name, path in recordings.items()]
    tell = api.impedance if by == "perturbations" else api.stretches
    page = api.perturbation_page(tell(read), language)
    if output:
        page.write(output)
        return ""
    return api.part_of(**page.plain())


def warm() -> None:
    """Load what a report needs, which takes longer than the report."""
    sliders.warm()
    api.png(api.new_figure(1.0))


def demo(trial: int, output: str) -> dict[str, Any]:
    """Make a recording of the virtual subject, and keep it."""
    recording = api.example(trial=trial)
    api.write_hdf5(output, recording)
    return imports.described(recording)
