"""What the package offers, one line each, and where it is made."""

from surae.runner.engines import AGAIN as AGAIN
from surae.runner.engines import KINDS as KINDS
from surae.runner.engines import Batch as Batch
from surae.runner.engines import Died as Died
from surae.runner.engines import Engine as Engine
from surae.runner.engines import Work as Work
from surae.runner.engines import cores as cores
from surae.runner.engines import results as results
from surae.runner.ledger import Ledger as Ledger
from surae.runner.ledger import LedgerStatus as LedgerStatus
from surae.runner.ledger import Running as Running
