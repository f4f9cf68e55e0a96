"""What vouches for a FIT.json: a checksum of what was fitted, and one of how it was found.

Neither keeps anybody from writing another file: they show what was changed by mistake, or by hand.
"""

import json
from collections.abc import Mapping
from typing import Any

from surae.base.errors import InputError
from surae.base.files import sha256
from surae.inference.judging.reasons import OF_OTHER_TRIALS

#: What the first is of: what was fitted and found. What is judged of it is judged again.
_FITTED = (
    "model",
    "options",
    "free",
    "base",
    "priors",
    "settings",
    "traces",
    "sse",
    "R",
    "outliers",
    "family",
)
_OF_EACH = ("value", "free", "lower", "upper")
#: What the second checksum is of: how it was found, which cannot be found again without the search.
_SEARCHED = (
    "surae",
    "status",
    "message",
    "seed",
    "seconds",
    "starts",
    "search",
    "versions",
    "judged_by",
)
_LABELS = ("name", "files", "steps")


def checksums(data: Mapping[str, Any]) -> dict[str, str]:
    """Both, as a file has them."""
    return {"sha256": _of_fitted(data), "sha256_of_search": _of_search(data)}


def check_checksums(data: Mapping[str, Any]) -> None:
    """Refuse what somebody changed; older files have one of them, or none."""
    now = checksums(data)
    if data.get("sha256", now["sha256"]) != now["sha256"]:
        raise InputError("its numbers are not those that were fitted: somebody changed them")
    if data.get("sha256_of_search", now["sha256_of_search"]) != now["sha256_of_search"]:
        raise InputError("how it was found is not what was saved: somebody changed it")


def _of_fitted(data: Mapping[str, Any]) -> str:
    """SHA-256 of what was fitted, however the file is set; names may be changed."""
    fitted = {key: data.get(key) for key in _FITTED}
    for table in ("parameters", "nuisances"):
        fitted[table] = {
            name: [p.get(each) for each in _OF_EACH] for name, p in data.get(table, {}).items()
        }
    traces = [{k: v for k, v in t.items() if k not in _LABELS} for t in data["traces"]]
    return sha256(json.dumps({**fitted, "traces": traces}, sort_keys=True).encode())


def _of_search(data: Mapping[str, Any]) -> str:
    """SHA-256 of how a fit was found, and of what was found in its recordings before."""
    searched = {key: data.get(key) for key in _SEARCHED}
    searched["findings"] = [
        {k: v for k, v in each.items() if k != "recording"} for each in data.get("findings", ())
    ]
    searched["steps"] = [each.get("steps") for each in data["traces"]]
    adequacy = data.get("adequacy")
    codes = adequacy.get("codes") if isinstance(adequacy, dict) else None
    searched["of_other_trials"] = [
        {k: v for k, v in each.items() if k != "says"}
        for each in (codes if isinstance(codes, list) else ())
        if isinstance(each, dict) and each.get("code") in OF_OTHER_TRIALS
    ]
    return sha256(json.dumps(searched, sort_keys=True).encode())
