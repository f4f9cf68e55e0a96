"""What to measure, or to fix, when a parameter is not known well enough: data, one line each."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TradeOff:
    """Parameters whose effects on the torque resemble one another, and what tells them apart."""

    #: Parameters that resemble one another, or, with `beside`, those of another group.
    names: frozenset[str]
    because: str  #: Why, as the rest of a sentence that begins with the parameters.
    advice: str  #: What to do, as an imperative.
    beside: frozenset[str] = frozenset()  #: The other group; empty where `names` is the only one.

    def holds(self, first: str, second: str) -> bool:
        """Whether this is about the two parameters."""
        beside = self.beside or self.names
        pairs = ((first, second), (second, first))
        return any(one in self.names and other in beside for one, other in pairs)


def _row(names: str, because: str, advice: str, beside: str = "") -> TradeOff:
    return TradeOff(frozenset(names.split()), because, advice, frozenset(beside.split()))


def _of_muscle(g: str, muscle: str, further: str, apart: str, weights: str) -> list[TradeOff]:
    """Those of one muscle group: what stretches it further and is apart, and its weights."""
    tendon = f"dlt_{g} pt_{g} kt_{g} fmax_{g}"
    return [
        _row(f"k_{g} x0_{g}", f"both set how high the passive torque of the {muscle} is",
             f"stretch the relaxed {muscle} further (more {further}), which shows its curve, or "
             "fix one of the two"),
        _row(tendon, "in the toe they bend one curve alike",
             f"higher forces of the {muscle}, past the toe of its tendon, or fix all but one"),
        _row(f"l0_{g}", "off the optimal length the same activation gives less force",
             f"use more of the range of motion while the {muscle} is active", weights),
        _row(tendon, "a tendon that gives way lets the muscle shorten and its tissue slacken",
             f"a passive part with {apart}, apart from the active one, or fix the tendon",
             f"l0_{g} k_{g} x0_{g} {weights}" + (" tau_rel k_rel" if g == "tri" else "")),
    ]  # fmt: skip


_PASSIVE = "k_tri x0_tri k_tib x0_tib"
_HEADS = (
    "the heads of the triceps are active together",
    "let the heads vary apart (knee bent and straight, other efforts), or fix the ratio of two",
)
#: The best known ones, of which none is about a pair that another is about.
TRADE_OFFS: tuple[TradeOff, ...] = (
    *_of_muscle("tri", "triceps", "dorsiflexion", "long holds", "g2 g3 g4"),
    *_of_muscle("tib", "tibialis", "plantarflexion", "more plantarflexion", "g1"),
    _row("tau_rel k_rel", "a strong slow relaxation begins like a weak fast one",
         "hold longer than the relaxation lasts, with a passive part in the trial"),
    _row("f0 beta", "both delay the force behind the EMG",
         "faster bursts of effort, or fix beta at 1, critical damping"),
    _row("g2 g3 g4", *_HEADS),
    _row("e2 e3 e4", *_HEADS),
    _row("tau_rel k_rel", "relaxation lowers the torque that stiffness and slack length set",
         "hold longer at several angles, with a passive part in the trial", _PASSIVE),
    _row("emd", "a slower filter delays the force behind the EMG as a pure delay does",
         "faster bursts of effort, or fix the delay or beta (1, critical damping)", "f0 beta f"),
    _row("reflex_delay", "a slower filter delays the force behind a stretch as the reflex's delay "
         "does", "an active part with fast bursts of effort, which shows the filter, or fix the "
         "delay", "f0 beta f"),
    _row("reflex_tri reflex_tib reflex_delay",
         "the reflexes of both muscles answer the same movement",
         "fast stretches of either muscle with rest between them, or fix one gain at 0"),
    _row("reflex_tri reflex_tib", "tissue that relaxes resists a fast stretch too",
         "stretches over the same range at several speeds, slow ones included",
         f"{_PASSIVE} tau_rel k_rel b_tri F0"),
    _row("reflex_tri reflex_tib", "EMG that the reflex makes drives the force a second time",
         "fix the gain at 0 where the EMG holds the reflex, or leave it to trials without effort",
         "g1 g2 g3 g4 e1 e2 e3 e4"),
)  # fmt: skip


def trade_off(name: str, partners: tuple[str, ...]) -> TradeOff | None:
    """The known reason why a parameter trades off with one of its partners, strongest first."""
    known = (row for partner in partners for row in TRADE_OFFS if row.holds(name, partner))
    return next(known, None)
