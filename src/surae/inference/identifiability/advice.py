"""Which parameters resemble one another, and what tells them apart: data, one line each."""

from dataclasses import dataclass

from surae.base.words import Message


@dataclass(frozen=True, slots=True)
class TradeOff:
    """Parameters whose effects on the torque resemble one another, and what tells them apart."""

    code: str  #: Of the sentence.
    #: Parameters that resemble one another, or, with `beside`, those of another group.
    names: frozenset[str]
    beside: frozenset[str] = frozenset()  #: The other group; empty where `names` is the only one.

    @property
    def advice(self) -> Message:
        """Why, and what to do: the rest of a sentence that begins with the parameters."""
        return Message(f"apart/{self.code}")

    def holds(self, first: str, second: str) -> bool:
        """Whether this is about the two parameters."""
        beside = self.beside or self.names
        pairs = ((first, second), (second, first))
        return any(one in self.names and other in beside for one, other in pairs)


def _row(code: str, names: str, beside: str = "") -> TradeOff:
    return TradeOff(code, frozenset(names.split()), frozenset(beside.split()))


def _of_muscle(g: str, weights: str) -> tuple[TradeOff, ...]:
    """Those of one muscle group."""
    tendon = f"dlt_{g} pt_{g} kt_{g} fmax_{g}"
    relaxes = " tau_rel k_rel" if g == "tri" else ""
    return (
        _row(f"height/{g}", f"k_{g} x0_{g}"),
        _row(f"toe/{g}", tendon),
        _row(f"optimum/{g}", f"l0_{g}", weights),
        _row(f"tendon/{g}", tendon, f"l0_{g} k_{g} x0_{g} {weights}{relaxes}"),
    )


_PASSIVE = "k_tri x0_tri k_tib x0_tib"
#: The best known ones, of which none is about a pair that another is about.
TRADE_OFFS: tuple[TradeOff, ...] = (
    *_of_muscle("tri", "g2 g3 g4"),
    *_of_muscle("tib", "g1"),
    _row("relaxation", "tau_rel k_rel"),
    _row("filter", "f0 beta"),
    _row("heads", "g2 g3 g4"),
    _row("heads", "e2 e3 e4"),
    _row("relaxed", "tau_rel k_rel", _PASSIVE),
    _row("delay", "emd", "f0 beta f"),
    _row("reflex-delay", "reflex_delay", "f0 beta f"),
    _row("reflexes", "reflex_tri reflex_tib reflex_delay"),
    _row("reflex-tissue", "reflex_tri reflex_tib", f"{_PASSIVE} tau_rel k_rel b_tri F0"),
    _row("reflex-emg", "reflex_tri reflex_tib", "g1 g2 g3 g4 e1 e2 e3 e4"),
)


def trade_off(name: str, partners: tuple[str, ...]) -> TradeOff | None:
    """The known reason why a parameter trades off with one of its partners, strongest first."""
    known = (row for partner in partners for row in TRADE_OFFS if row.holds(name, partner))
    return next(known, None)
