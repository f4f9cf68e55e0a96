"""What the package offers, one line each, and where it is made."""

from surae.processes.child import Child as Child
from surae.processes.child import End as End
from surae.processes.child import Plain as Plain
from surae.processes.child import guarded as guarded
from surae.processes.inside import function as function
from surae.processes.inside import tell as tell
from surae.processes.inside import without_interrupt as without_interrupt
from surae.processes.messages import FULL as FULL
from surae.processes.messages import NO_ROOM as NO_ROOM
from surae.processes.messages import one_line as one_line
from surae.processes.messages import where as where
