"""The file that keeps what is computed from one fit, so that it goes on where it was stopped."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from surae.errors import InputError
from surae.estimation import FitResult
from surae.files import PathLike, shown
from surae.processes import Plain
from surae.runner import Ledger

#: How the replicates of surae 0.1 began, which were text.
_FORMER = b'{"bootstrap"'


def ledger_of(
    result: FitResult, path: PathLike | None, kind: str, settings: Mapping[str, Plain]
) -> tuple[Ledger, str]:
    """Open the file of what is computed from a fit, or memory.

    `kind` is what it holds, in a word; `settings` must be the same, beside the fit, for results to
    belong together. The text is what the ledger is about, for `Ledger.begin`.
    """
    if path is not None and Path(path).is_file():
        with Path(path).open("rb") as file:
            if file.read(len(_FORMER)) == _FORMER:
                raise InputError(
                    f"{shown(path)} holds replicates as an older surae kept them; remove it or "
                    "choose another output"
                )
    about = json.dumps({"fit": _identity(result), **settings}, sort_keys=True)
    ledger = Ledger(path, write=True)
    held = ledger.about()
    if held is not None and held != (kind, kind, about):
        ledger.close()
        raise InputError(
            f"{shown(path or '')} holds {held[0]} of another fit or other settings; remove it or "
            "choose another output"
        )
    return ledger, about


def _identity(result: FitResult) -> str:
    """A fit's fingerprint: model, options, estimates and residuals to the last bit."""
    problem = result.problem
    text = json.dumps(
        [problem.spec.name, problem.options.as_dict(), dict(result.values), list(problem.free)],
        sort_keys=True,
    )
    digest = hashlib.sha256(text.encode())
    for residual in result.residuals:
        digest.update(np.ascontiguousarray(residual, dtype="<f8").tobytes())
    return digest.hexdigest()
