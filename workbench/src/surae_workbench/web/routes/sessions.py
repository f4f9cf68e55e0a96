"""Sessions: the trials of one leg, sorted, fitted each and together, predicted by each other."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

from fastapi import APIRouter, Request, Response

from surae import api
from surae_workbench.web.answers import Job, Leg
from surae_workbench.web.database import new_id
from surae_workbench.web.fits import add_fit, check_draft, main_fit, versions_of
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.language import language_of
from surae_workbench.web.project import dated, unique_name
from surae_workbench.web.routes.common import (
    ERRORS,
    REPORT,
    Bench,
    Browser,
    PathId,
    offer_deletion,
    report_file,
)
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import LegPatch, SessionRequest, TrialsRequest
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api/sessions", responses=ERRORS, tags=["sessions"])
Language = Literal["en", "nl", "de", "fr"]
#: A figure shows no more visits.
_VISITS = 12


@router.post("/trials")
def post_trials(body: TrialsRequest, bench: Bench) -> dict[str, Any]:
    """What each trial is and is used for, as its signals and the others tell."""
    return {"trials": sorted_as(bench, body.recordings, body.efforts)}


@router.post("", status_code=202)
def post_session(request: Request, body: SessionRequest, bench: Bench, browser: Browser) -> Job:
    """Ask for the fits of a session; what cannot be kept is refused now, not in the job."""
    draft = bench.sessions.draft(browser)
    sorted_trials = sorted_as(bench, body.recordings, body.efforts)
    moving = [each["recording"] for each in sorted_trials if each["fitted"]]
    if moving:
        check_draft(bench, {**draft, "recordings": moving[:1], "mvc": [], "normalise": None})
    elif not any(each["perturbed"] for each in sorted_trials):
        raise RefusedError(400, "none of these trials moves: nothing can be fitted")
    rows = [bench.project.need("recording", id_) for id_ in dict.fromkeys(body.recordings)]
    cut = [row["name"] for row in rows if draft["exclusions"].get(row["id"])]
    if cut:
        raise RefusedError(
            400,
            f"stretches of {', '.join(cut)} are left out: a session fits trials whole; take that "
            "back on the page of the recording, or fit without a session",
        )
    if len({row["side"] for row in rows if row["side"]}) > 1:
        raise RefusedError(400, "the trials are of both legs; a session is of one")
    chosen = [row["id"] for row in rows]
    draft = {**draft, "recordings": chosen, "mvc": [], "sliders": {}, "exclusions": {}}
    name = body.name or _usual_name(bench, rows, api.words_in(language_of(request)))
    called = unique_name(bench.database.all("session"), name, 120)
    task = {
        "draft": draft,
        "name": called,
        "recordings": chosen,
        "names": {row["id"]: row["name"] for row in rows},
        "efforts": {id_: effort for id_, effort in body.efforts.items() if id_ in chosen},
        "versions": versions_of(bench, draft),
        "question": body.question,
        "language": language_of(request),
        "fits": {name: new_id() for name in (*(row["name"] for row in rows), "joint")},
    }
    return bench.jobs.submit("session", called, browser, task, chosen[0])


@router.get("")
def get_sessions(bench: Bench) -> dict[str, list[Leg]]:
    """Sessions, the newest first."""
    every = reversed(bench.database.all("session"))
    return {"sessions": [session_summary(bench, each) for each in every]}


@router.get("/{id}")
def get_session(id: PathId, bench: Bench) -> dict[str, Any]:
    """The fit that stands for it, with which others it can be compared, and whether PDFs are."""
    summary = session_summary(bench, bench.project.need("session", id))
    others = [session_summary(bench, each) for each in bench.database.all("session")]
    visits = [each for each in others if each.id != summary.id and each.fit and summary.fit]

    def near(other: Leg) -> tuple[bool, bool, str]:
        """Visits of this leg come first, then those of the other one."""
        return other.subject == summary.subject, other.side == summary.side, other.visit

    return {
        "summary": summary,
        "visits": sorted(visits, key=near, reverse=True),
        "paper": api.has_typst(),
    }


@router.patch("/{id}")
def patch_session(id: PathId, body: LegPatch, bench: Bench) -> Leg:
    """Say whose leg it is, when the visit was, what it is called, and what it is compared with."""
    changes = body.model_dump(exclude_unset=True)
    row = bench.project.need("session", id)
    for key, kind in (("subject", "subject"), ("before", "session")):
        if changes.get(key) is not None:
            bench.project.need(kind, changes[key])
    if changes.get("before") == id:
        raise RefusedError(400, "a visit is not compared with itself; choose another")
    labels = {"subject", "side", "visit"}
    of_trials: dict[str, Any] = {k: v for k, v in changes.items() if k in labels}
    of_session: dict[str, Any] = {k: v for k, v in changes.items() if k not in labels}
    if of_session.get("name", "") is None:
        del of_session["name"]
    if "name" in of_session:
        rows = (each for each in bench.database.all("session") if each["id"] != id)
        of_session["name"] = unique_name(rows, of_session["name"], 120)
    with bench.database.transaction():
        for recording in row["recordings"] if of_trials else ():
            bench.database.update("recording", recording, of_trials)
        row = bench.project.change("session", id, **of_session)
    for what in ("sessions", "recordings") if of_trials else ("sessions",):
        bench.events.changed(what)
    return session_summary(bench, row)


@router.get("/{id}/change")
def get_change(id: PathId, bench: Bench, language: Language = "en") -> dict[str, str]:
    """What changed since the visit it is compared with, as the report shows it."""
    compared = comparison(bench, bench.project.need("session", id))
    if not compared:
        return {"html": ""}
    key = (id, f"change {language} {compared}")

    def make() -> bytes:
        made = bench.workers.ask("tasks:change", comparison=compared, language=language)
        return str(made).encode()

    return {"html": bench.reports.get(key, make).decode()}


offer_deletion(router, "/{id}", "session")


@router.get("/{id}/report.{kind}", response_class=Response, responses=REPORT)
def get_report(
    id: PathId,
    kind: Literal["html", "pdf"],
    bench: Bench,
    language: Language = "en",
) -> Response:
    """Its report in the reader's language: one file to keep."""
    row = bench.project.need("session", id)
    blocks = bench.project.kept("session", id)
    if not blocks.is_file():
        raise RefusedError(404, "the report of this leg is missing; analyse it again")
    summary = session_summary(bench, row)
    called = " ".join(dict.fromkeys((*summary.name.split(", "), summary.visit, language)))
    return report_file(
        bench,
        {**row, "name": called},
        kind,
        "tasks:leg_report",
        blocks=str(blocks),
        language=language,
        comparison=comparison(bench, row),
        name=summary.name,
        side=summary.side or "",
        day=summary.visit,
    )


def comparison(bench: Workbench, row: Entry) -> str:
    """What a leg is compared with, for `tasks:change`; empty where it is compared with nothing.

    Its visits and those of the person's other leg are shown beside both that are compared.
    """
    after = session_summary(bench, row)
    before = str(row.get("before"))
    known = {each["id"]: session_summary(bench, each) for each in bench.database.all("session")}
    if after.fit is None or before not in known or known[before].fit is None:
        return ""
    if unknown := [each.name for each in (known[before], after) if not each.visit]:
        raise RefusedError(
            400,
            f"on which day was {' and '.join(unknown)} measured? Say it under Edit on its page: a "
            "change is one from a day to another",
        )
    alike = [
        each
        for each in known.values()
        if each.fit and each.visit and after.subject is not None and each.subject == after.subject
    ]
    shown = {each.id: each for each in (known[before], after, *alike[-_VISITS:])}
    visits = sorted(shown.values(), key=lambda each: (each.visit, each.name))
    ids = [each.id for each in visits]
    return json.dumps(
        {
            "visits": [
                (
                    each.name,
                    each.visit,
                    each.side or "",
                    str(bench.project.kept("fit", each.fit or "")),
                )
                for each in visits
            ],
            "question": [row["question"]] if row.get("question") else [],
            "before": ids.index(before),
            "after": ids.index(after.id),
        }
    )


def sorted_as(
    bench: Workbench, recordings: Sequence[str], efforts: Mapping[str, str]
) -> list[dict[str, Any]]:
    """What each trial is, and what it is used for, in the words of the report."""
    rows = {id_: bench.project.need("recording", id_) for id_ in dict.fromkeys(recordings)}
    leg = api.session(
        [replace(bench.recording(id_), name=row["name"]) for id_, row in rows.items()],
        efforts={rows[id_]["name"]: effort for id_, effort in efforts.items() if id_ in rows},
    )
    trials = {trial.name: trial for trial in leg.trials}
    trials_said = []
    for id_, row in rows.items():
        trial = trials[row["name"]]
        what, use = api.trial_words(trial)
        trials_said.append(
            {
                "recording": id_,
                "name": row["name"],
                "effort": trial.effort,
                "stated": trial.stated,
                "fitted": trial.use == "fit",
                "perturbed": trial.use == "nerve",
                "what": what,
                "why": trial.why,
                "use": use,
                "problem": trial.problem,
            }
        )
    return trials_said


def _usual_name(bench: Workbench, rows: Sequence[Entry], words: api.Words) -> str:
    subject = bench.database.get("subject", rows[0]["subject"]) if rows[0]["subject"] else None
    who = words("Leg") if subject is None else subject["code"]
    return ", ".join(filter(None, (who, words(rows[0]["side"] or ""), _day(rows[0]))))


def _day(row: Entry) -> str:
    """The day of a visit as it was told; empty where nobody did: the day of the import is none."""
    return str(row.get("visit") or "")


def keep_session(bench: Workbench, job: Entry, end: Mapping[str, Any]) -> str:
    """Add a session to the project, and its fits as fits like any other."""
    task = job["task"]
    ids = {}
    by_name = {name: id_ for id_, name in task["names"].items()}
    for name, summary in end["summaries"].items():
        joint = name == "joint"
        recordings = [by_name[each] for each in (end["joined"] if joint else [name])]
        label = f"{task['name']} · {'all together' if joint else name}"
        ids[name] = add_fit(bench, task["fits"][name], label, summary, recordings, task)
    about = {"fits": ids, "content": end["content"], "settings": task["draft"]}
    about["question"] = task.get("question")
    data = {"name": task["name"], "recordings": task["recordings"], **about}
    id_ = bench.project.add("session", data, job["id"])
    for what in ("fits", "sessions"):
        bench.events.changed(what)
    return id_


def session_summary(bench: Workbench, session: Entry) -> Leg:
    """A session in lists."""
    first = bench.database.get("recording", session["recordings"][0], deleted=True)
    adequacy = session["content"].get("adequacy")
    return Leg(
        **dated(session),
        subject=None if first is None else first["subject"],
        side=None if first is None else first["side"],
        visit=_day(session if first is None else first),
        trials=len(session["recordings"]),
        grade=None if adequacy is None else adequacy["grade"],
        fit=main_fit(bench, session),
    )
