"""The Lab Streaming Layer through pylsl: kept to this computer unless the network is asked for."""

import os
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

from surae.base.errors import InputError

#: Everything stays on the loopback: streams are looked for there, and only there.
_LOCAL = """\
[log]
level = -3
[ports]
IPv6 = disable
[multicast]
ResolveScope = machine
MachineAddresses = {{127.0.0.1}}
AddressesOverride = {{127.0.0.1}}
[lab]
KnownPeers = {{127.0.0.1}}
SessionID = {session}
"""
#: The variable that names a session of LSL: streams of others are then neither seen nor shown.
SESSION = "SURAE_LSL_SESSION"
#: A stream that comes back is heard again within about this [s].
_TUNING = "[tuning]\nContinuousResolveInterval = 0.2\n"


#: The module, once it is configured: LSL reads its configuration but once in a process.
_configured: list[Any] = []


def lsl(network: bool = False) -> Any:
    """The module pylsl, configured; the first call in a process decides for all.

    With `network` it looks for streams on other computers too, as the laboratory's own
    configuration of LSL says.
    """
    if _configured:
        return _configured[0]
    if find_spec("pylsl") is None:
        raise InputError(
            'live recording needs pylsl: pip install "surae-workbench[live]" installs it'
        )
    import pylsl

    if not network:
        session = os.environ.get(SESSION, "default")
        pylsl.set_config_content(_LOCAL.format(session=session) + _TUNING)
    _configured.append(pylsl)
    return pylsl


def outlet(
    name: str, kind: str, labels: Sequence[str], units: Sequence[str], rate_hz: float, source: str
) -> Any:
    """An outlet of numbers in double precision, its channels named; of words where no label is."""
    pylsl = lsl()
    words = not labels
    info = pylsl.StreamInfo(
        name, kind, len(labels) or 1, rate_hz, "string" if words else "double64", source
    )
    if labels:
        info.set_channel_labels(list(labels))
        info.set_channel_units(list(units))
    return pylsl.StreamOutlet(info)
