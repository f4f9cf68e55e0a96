"""The file that keeps what is computed from one fit, so that it goes on where it was stopped."""

import hashlib
import json

import numpy as np

from surae.errors import InputError
from surae.estimation import FitResult
from surae.files import PathLike, shown
from surae.runner import Ledger


def ledger_of(result: FitResult, path: PathLike | None, kind: str) -> tuple[Ledger, str]:
    """Open the file of what is computed from a fit, or memory.

    `kind` is what it holds, in a word. The text identifies the fit, for `Ledger.begin`.
    """
    about = json.dumps({"fit": _identity(result)})
    ledger = Ledger(path, write=True)
    held = ledger.about()
    if held is not None and held != (kind, kind, about):
        ledger.close()
        raise InputError(
            f"{shown(path or '')} holds {held[0]} of another fit; remove it or "
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
