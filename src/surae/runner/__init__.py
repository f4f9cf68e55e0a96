"""Many calls of one function: run anywhere, stopped at any time, kept, and gone on with."""

from surae.runner.engines import AGAIN, KINDS, Batch, Died, Engine, Work, cores, results
from surae.runner.ledger import Ledger, LedgerStatus, Running

__all__ = [
    "AGAIN",
    "KINDS",
    "Batch",
    "Died",
    "Engine",
    "Ledger",
    "LedgerStatus",
    "Running",
    "Work",
    "cores",
    "results",
]
