"""What workers do, by name: fits, profiles, comparisons, studies, imports and reports.

Each takes a task of plain data and a function that tells what happens, and returns plain data.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from surae import api, processes
from surae.web import imports
from surae.web.draft import settings_of, upgraded
from surae.web.places import file_of, recording_suffix

Tell = Callable[[Mapping[str, Any]], None]


def read_recording(path: str | Path) -> api.Recording:
    """A recording of the project, as it was read from the user's own files."""
    recording = api.read(path)
    return replace(recording, files=recording.files[1:] or recording.files)


def _file(task: Mapping[str, Any], folder: str, id_: str, suffix: str) -> Path:
    """A file of the project that the task belongs to."""
    return file_of(Path(task["root"]), folder, id_, suffix)


def _read(task: Mapping[str, Any], ids: Sequence[str], tell: Tell) -> list[api.Recording]:
    """Recordings of the project."""
    recordings = []
    for id_ in ids:
        tell({"phase": "reading"})
        suffix = recording_suffix(task.get("versions", {}).get(id_, 0))
        recordings.append(read_recording(_file(task, "recordings", id_, suffix)))
    return recordings


def _asked(
    task: Mapping[str, Any], tell: Tell
) -> "tuple[api.FitSettings, list[api.Recording], tuple[api.ModelInputs, ...]]":
    """What the draft of a task asks, its recordings, and what a model reads of them."""
    draft = upgraded(task["draft"])
    settings = settings_of(draft, task["recordings"])
    recordings = _read(task, task["recordings"], tell)
    contractions = _read(task, draft["mvc"], tell)
    tell({"phase": "preparing"})
    return settings, recordings, settings.inputs(recordings, contractions)


def _compiling(tell: Tell) -> AbstractContextManager[None]:
    """Tell when the models have to be compiled, which takes some ten seconds, once."""
    return api.on_compilation(lambda: tell({"phase": "compiling"}))


def fit(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Fit, as `surae fit` does, and write FIT.json."""
    settings, recordings, inputs = _asked(task, tell)
    from surae.web.fit_progress import FitProgress

    quality = [api.check(recording, prepared=settings.prepared) for recording in recordings]
    news = FitProgress(inputs, task["recordings"], settings, tell)
    with _compiling(tell):
        fitted = api.fit_inputs(inputs, settings, quality, progress=news.start, follow=news.point)
    fitted.save(_file(task, "fits", task["id"], ".json"))
    return {
        "message": fitted.message,
        "interrupted": fitted.result.starts[-1].outcome == "interrupted",
        "summary": summary(fitted),
    }


def session(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Fit trials each and all together as `surae session` does, and write fits and report."""
    recordings = [
        replace(recording, name=task["names"][id_])
        for id_, recording in zip(
            task["recordings"], _read(task, task["recordings"], tell), strict=True
        )
    ]

    settings = settings_of(upgraded(task["draft"]), ())
    efforts = {task["names"][id_]: effort for id_, effort in task["efforts"].items()}
    leg = api.session(recordings, name=task["name"], efforts=efforts)

    def told(step: "api.Step") -> None:
        tell({"what": step.what, "done": step.done, "total": step.total})

    with _compiling(tell):
        result = leg.run(None, settings, told=told)
    fits = {**result.fits, **({} if result.joint is None else {"joint": result.joint})}
    for name, fitted in fits.items():
        fitted.save(_file(task, "fits", task["fits"][name], ".json"))
    for suffix in (".html", *((".pdf",) if api.has_typst() else ())):
        result.report(_file(task, "sessions", task["id"], suffix))
    return {
        "message": f"{len(result.fits)} of {len(recordings)} trials fitted"
        + ("" if result.joint is None else f", {len(result.joined)} together"),
        "interrupted": result.interrupted,
        "summaries": {name: summary(fitted) for name, fitted in fits.items()},
        "joined": list(result.joined),
        "content": asdict(result.content()),
    }


def summary(fitted: "api.Fit") -> dict[str, Any]:
    """What lists and tables show of a fit."""
    from math import isfinite

    return {
        "model": fitted.result.problem.spec.name,
        "status": fitted.status,
        "vaf": fitted.vaf if isfinite(fitted.vaf) else None,
        "ipde": fitted.ipde,
        "seconds": fitted.result.seconds,
        "names": [recording.name for recording in fitted.assessment.recordings],
        "starts": len(fitted.result.starts),
        "agreeing": fitted.result.agreeing,
        "parameters": {
            p.name: {
                "value": p.value,
                "sem": p.trusted_sem,
                "low": None if p.ci95 is None else p.ci95[0],
                "high": None if p.ci95 is None else p.ci95[1],
                "verdict": str(p.verdict),
            }
            for p in fitted.parameters.values()
        },
    }


def profile(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Profile parameters of a fit, and write them."""
    fitted = api.load(_file(task, "fits", task["fit"], ".json"))

    def told(name: str, done: int, total: int) -> None:
        tell({"parameter": name, "done": done, "total": total})

    with _compiling(tell):
        profiles = api.profile(fitted, task["parameters"], workers=1, progress=told)
    profiles.save(_file(task, "fits", task["id"], ".profiles.json"))
    missing = ", ".join(profiles.missing)
    return {
        "message": f"stopped before {missing}" if missing else f"{len(profiles.profiles)} profiles",
        "interrupted": bool(profiles.missing),
    }


def compare(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Compare models with rigid and compliant tendons on the same recordings."""
    settings, _, inputs = _asked(task, tell)

    def told(what: str, done: int, total: int) -> None:
        tell({"what": what, "done": done, "total": total})

    with _compiling(tell):
        comparison = api.compare_models(inputs, task["models"], settings, told)
    comparison.save(_file(task, "comparisons", task["id"], ".json"))
    return {"message": comparison.conclusion, "interrupted": bool(comparison.missing)}


def study(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Run a study, or go on with it."""
    last = 0.0

    def told(done: int, total: int) -> None:
        nonlocal last
        if time.monotonic() - last > 0.2 or done == total:
            last = time.monotonic()
            tell({"done": done, "total": total})

    with api.Store(_file(task, "studies", task["study"], ".db"), write=True) as kept:
        finished = api.run_study(api.parse_study(task["toml"]), kept, progress=told)
    return {"message": f"{finished.fits} fits, all there", "interrupted": False}


def design(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Search a protocol of each duration; what was found when it is stopped is kept."""
    settings, designs, total = task["settings"], list[dict[str, Any]](), task["evaluations"]
    last, stopped = 0.0, False
    for k, seconds in enumerate(task["durations"]):

        def told(done: int, of: int, best: float, k: int = k) -> None:
            nonlocal last
            del of, best
            if time.monotonic() - last > 0.2:
                last = time.monotonic()
                tell({"done": k * total + done, "total": total * len(task["durations"])})

        with _compiling(tell):
            made = api.design(
                seconds, device=settings["device"], range=tuple(settings["range"]),
                rate_hz=settings["rate_hz"], evaluations=total, progress=told,
                **{key: task[key] for key in ("model", "population", "noise", "aim", "effort")},
            )  # fmt: skip
        designs.append({"name": f"designed {seconds:g} s {task['aim']}", **made.to_json()})
        stopped = made.stopped
        if stopped:
            break
    expectation = designs[-1]["expectation"]
    worst = "unknown" if expectation["worst"] is None else f"{100 * expectation['worst']:.2g} %"
    return {
        "message": f"largest error {worst} ({expectation['weakest']})",
        "interrupted": stopped,
        "designs": designs,
    }


def report(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Write a fit's report, or, in a language, its page for clinicians."""
    del tell

    fit = api.load(task["fit"])
    if "language" in task:
        api.write_clinical_page(task["output"], [fit], language=task["language"])
    else:
        fit.report(task["output"])
    return {}


def short(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """What a fit's page for clinicians says, to be shown by a page of ours."""
    del tell

    return asdict(api.clinical_page([api.load(task["fit"])], language=task["language"]))


def warm(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Load what a report needs, which takes longer than the report."""
    del task, tell
    from surae.web.live import warm

    warm()
    return {"bytes": len(api.png(api.new_figure(1.0)))}


def inspect(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Say what is in uploaded files, and guess what each column is."""
    del tell
    return {"found": imports.inspected(task["files"])}


def load(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Read what a mapping describes; keep it as a recording where ``output`` is given."""
    del tell
    return {"found": imports.imported(task["files"], task["mapping"], task.get("output"))}


def describe(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Describe an imported recording anew, from its own file or, for other columns, the uploads."""
    del tell
    from surae.web.remap import described_anew

    if task["files"] is not None:
        return {"found": imports.imported(task["files"], task["wanted"], task["output"])}
    recording = read_recording(task["path"])
    recording = described_anew(recording, task["first"], task["wanted"])
    if task["output"] is not None:
        api.write_hdf5(task["output"], recording)
    return {"found": imports.described(recording)}


def columns(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The columns that an imported recording was made of, in their files' own numbers."""
    del tell
    from surae.web.remap import imported_columns

    return {"columns": imported_columns(read_recording(task["path"]), task["first"])}


def demo(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Make a recording of the virtual subject, and keep it."""
    del tell

    recording = api.example(trial=task["trial"])
    api.write_hdf5(task["output"], recording)
    return {"found": imports.described(recording)}


def quality(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Judge the quality of a recording."""
    del tell
    return {"findings": imports.findings(read_recording(task["path"]))}


#: Everything a worker can do.
TASKS: dict[str, Callable[[Mapping[str, Any], Tell], dict[str, Any]]] = {
    "fit": fit,
    "profile": profile,
    "session": session,
    "compare": compare,
    "design": design,
    "study": study,
    "report": report,
    "short": short,
    "warm": warm,
    "inspect": inspect,
    "load": load,
    "describe": describe,
    "columns": columns,
    "demo": demo,
    "quality": quality,
}


def do(task: Mapping[str, Any]) -> dict[str, Any]:
    """Do the task that ``do`` names; what the server calls."""
    return TASKS[task["do"]](task, processes.tell)
