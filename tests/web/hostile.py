"""A project of a stranger's, whole by its checksums, of which every name and text is an attack."""

import json
from pathlib import Path
from typing import Any

from surae_workbench.web.database import new_id
from surae_workbench.web.project import Project

#: Markup that runs, leaves, or asks elsewhere; the first ends a script of data.
ATTACK = (
    '</script><meta http-equiv="refresh" content="0;url=http://attack.invalid/">'
    "<img src=http://attack.invalid/x.png onerror=\"document.title='taken'\">"
    "<script>document.title='taken'</script>{{7*7}}<base href=http://attack.invalid/>"
)
NAME = ATTACK[:190]


def blocks() -> dict[str, Any]:
    """What is kept of a leg's page, as a stranger may write it."""
    text = {"kind": "paragraph", "look": ATTACK, "lead": ATTACK, "text": ATTACK}
    picture = {"kind": "picture", "name": "a", "look": "", "alt": ATTACK, "caption": ATTACK}
    key = {"kind": "key", "figures": [[ATTACK, ATTACK, ATTACK]]}
    page = {
        "kind": "section",
        "look": "leg",
        "title": ATTACK,
        "anchor": ATTACK,
        "blocks": [text, {**picture, "name": "b"}, picture, key],
    }
    return {
        "heading": ATTACK,
        "title": ATTACK,
        "kicker": ATTACK,
        "under": ATTACK,
        "footer": ATTACK,
        "language": "en",
        "blocks": [page],
        "images": {
            "a": "http://attack.invalid/seen.png",
            "b": "javascript:document.title='taken'",
            "../../../escaped": "data:image/svg+xml;base64,PHN2Zy8+",
        },
        "signals": f'[{{"name": {json.dumps(ATTACK)}}}]',
        "translated": {},
    }


def hostile_project(folder: Path, recording: Path) -> dict[str, str]:
    """Make it, of one recording as surae keeps them; the ids of what is in it."""
    project = Project(folder)
    ids = {kind: new_id() for kind in ("recording", "session")}
    try:
        subject = {"code": NAME, "group": NAME, "notes": ATTACK, "body_mass": 70.0}
        ids["subject"] = project.database.add("subject", subject)
        project.file("recording", ids["recording"]).write_bytes(recording.read_bytes())
        channel = {"role": NAME, "unit": NAME, "n": 10, "rate_hz": 1.0, "source": NAME}
        project.add(
            "recording",
            {
                "name": NAME,
                "subject": ids["subject"],
                "side": NAME,
                "trial": NAME,
                "condition": NAME,
                "visit": NAME,
                "duration_s": 10.0,
                "emg": NAME,
                "fixed": {},
                "channels": [channel],
                "files": [{"name": NAME, "sha256": "0" * 64}],
                "mapping": None,
                "findings": [
                    {
                        "code": NAME,
                        "severity": "error",
                        "channel": NAME,
                        "start_s": 0.0,
                        "end_s": 1.0,
                        "value": None,
                        "unit": NAME,
                        "message": ATTACK,
                        "advice": ATTACK,
                    }
                ],
            },
            ids["recording"],
        )
        file = project.file("session", ids["session"])
        file.write_text(json.dumps(blocks()), encoding="utf-8")
        session = {
            "name": NAME,
            "recordings": [ids["recording"]],
            "fits": {},
            "content": {"adequacy": {"grade": NAME}},
            "settings": {},
        }
        project.add("session", session, ids["session"])
    finally:
        project.close()
    return ids
