"""What workers do, by name: fits, profiles, comparisons, studies, imports and reports.

Each takes a task of plain data and a function that tells what happens, and returns plain data.
"""

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from surae import processes
from surae.recording import Recording, read
from surae.web import imports
from surae.web.draft import fit_keywords, weighting
from surae.web.places import file_of

if TYPE_CHECKING:
    from surae.api import Fit
    from surae.signals import ModelInputs

Tell = Callable[[Mapping[str, Any]], None]


def read_recording(path: str | Path) -> Recording:
    """A recording of the project, as it was read from the user's own files."""
    recording = read(path)
    return replace(recording, files=recording.files[1:] or recording.files)


def _file(task: Mapping[str, Any], folder: str, id_: str, suffix: str) -> Path:
    """A file of the project that the task belongs to."""
    return file_of(Path(task["root"]), folder, id_, suffix)


def _prepared(task: Mapping[str, Any], tell: Tell) -> "list[ModelInputs]":
    """The recordings of a task, prepared, with their weights."""
    from surae.signals import prepare, weighted

    draft, inputs = task["draft"], []
    for id_ in task["recordings"]:
        tell({"phase": "reading"})
        recording = read_recording(_file(task, "recordings", id_, ".h5"))
        tell({"phase": "preparing"})
        inputs.append(prepare(recording, prepared=draft["prepared"]))
    if draft["body_mass"] is not None:
        from surae.model.anthropometry import with_foot_mass

        inputs = list(with_foot_mass(inputs, draft["body_mass"]))
    for number, id_ in enumerate(task["recordings"]):
        how = weighting(draft, id_)
        if how is not None:
            inputs[number] = weighted([inputs[number]], how)[0]
    return inputs


def _compiling(tell: Tell) -> AbstractContextManager[None]:
    """Tell when the models have to be compiled, which takes some ten seconds, once."""
    from surae.model.jit import on_compilation

    return on_compilation(lambda: tell({"phase": "compiling"}))


def fit(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Fit, as `surae fit` does, and write FIT.json."""
    inputs = _prepared(task, tell)
    from surae import api
    from surae.web.fit_progress import FitProgress

    prescribed = {name: value for recording in inputs for name, value in recording.fixed.items()}
    keywords = fit_keywords(task["draft"], prescribed)
    news = FitProgress(inputs, task["recordings"], keywords, tell)
    with _compiling(tell):
        fitted = api.fit(inputs, progress=news.start, follow=news.point, **keywords)
    fitted.save(_file(task, "fits", task["id"], ".json"))
    return {
        "message": fitted.message,
        "interrupted": fitted.result.starts[-1].outcome == "interrupted",
        "summary": summary(fitted),
    }


def summary(fitted: "Fit") -> dict[str, Any]:
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
    from surae import api

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
    inputs = _prepared(task, tell)
    from surae import api
    from surae.model import MODELS

    prescribed = {name: value for recording in inputs for name, value in recording.fixed.items()}
    keywords = fit_keywords(task["draft"], prescribed)
    known = {p.name for name in task["models"] for p in MODELS[name].parameters}

    def told(what: str, done: int, total: int) -> None:
        tell({"what": what, "done": done, "total": total})

    with _compiling(tell):
        comparison = api.compare(
            inputs,
            task["models"],
            fixed={n: v for n, v in keywords["fixed"].items() if n in known},
            seed=keywords["seed"],
            progress=told,
            **task["draft"]["options"],
        )
    comparison.save(_file(task, "comparisons", task["id"], ".json"))
    return {"message": comparison.conclusion, "interrupted": bool(comparison.missing)}


def study(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Run a study, or go on with it."""
    from surae.studies.run import run
    from surae.studies.store import Store
    from surae.studies.study import parse_study

    last = 0.0

    def told(done: int, total: int) -> None:
        nonlocal last
        if time.monotonic() - last > 0.2 or done == total:
            last = time.monotonic()
            tell({"done": done, "total": total})

    with Store(_file(task, "studies", task["study"], ".db"), write=True) as kept:
        finished = run(parse_study(task["toml"]), kept, progress=told)
    return {"message": f"{finished.fits} fits, all there", "interrupted": False}


def report(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Write a fit's report."""
    del tell
    from surae import api

    api.load(task["fit"]).report(task["output"])
    return {}


def warm(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Load what a report needs, which takes longer than the report."""
    del task, tell
    from surae.report.figures import png
    from surae.report.figures.style import new_figure
    from surae.web.live import warm

    warm()
    return {"bytes": len(png(new_figure(1.0)))}


def inspect(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Say what is in uploaded files, and guess what each column is."""
    del tell
    return {"found": imports.inspected(task["files"])}


def load(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Read what a mapping describes; keep it as a recording where ``output`` is given."""
    del tell
    return {"found": imports.imported(task["files"], task["mapping"], task.get("output"))}


def demo(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Make a recording of the virtual subject, and keep it."""
    del tell
    from surae.recording import write_hdf5
    from surae.web.demo import demo_recording

    recording = demo_recording(task["trial"])
    write_hdf5(task["output"], recording)
    return {"found": imports.described(recording)}


def quality(task: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Judge the quality of a recording."""
    del tell
    return {"findings": imports.findings(read_recording(task["path"]))}


#: Everything a worker can do.
TASKS: dict[str, Callable[[Mapping[str, Any], Tell], dict[str, Any]]] = {
    "fit": fit,
    "profile": profile,
    "compare": compare,
    "study": study,
    "report": report,
    "warm": warm,
    "inspect": inspect,
    "load": load,
    "demo": demo,
    "quality": quality,
}


def do(task: Mapping[str, Any]) -> dict[str, Any]:
    """Do the task that ``do`` names; what the server calls."""
    return TASKS[task["do"]](task, processes.tell)
