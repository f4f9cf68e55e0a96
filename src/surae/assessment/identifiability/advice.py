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
        return (first in self.names and second in beside) or (
            second in self.names and first in beside
        )


#: The best known ones; the first that holds a parameter and one it trades off with is told.
TRADE_OFFS: tuple[TradeOff, ...] = (
    TradeOff(
        frozenset({"k_tri", "x0_tri"}),
        "both set how high the passive torque of the triceps is",
        "stretch the relaxed triceps further (more dorsiflexion), which shows its curve, or fix "
        "one of the two",
    ),
    TradeOff(
        frozenset({"k_tib", "x0_tib"}),
        "both set how high the passive torque of the tibialis is",
        "stretch the relaxed tibialis further (more plantarflexion), which shows its curve, or fix "
        "one of the two",
    ),
    TradeOff(
        frozenset({"tau_rel", "k_rel"}),
        "a strong slow relaxation begins like a weak fast one",
        "hold longer than the relaxation lasts, with a passive part in the trial",
    ),
    TradeOff(
        frozenset({"f0", "beta"}),
        "both delay the force behind the EMG",
        "faster bursts of effort, or fix beta at 1, critical damping",
    ),
    TradeOff(
        frozenset({"g2", "g3", "g4"}),
        "the heads of the triceps are active together",
        "let the heads vary apart (knee bent and straight, other efforts), or fix the ratio of two",
    ),
    TradeOff(
        frozenset({"e2", "e3", "e4"}),
        "the heads of the triceps are active together",
        "let the heads vary apart (knee bent and straight, other efforts), or fix the ratio of two",
    ),
    TradeOff(
        frozenset({"dlt_tri", "pt_tri", "kt_tri", "fmax_tri"}),
        "in the toe they bend one curve alike",
        "higher forces of the triceps, past the toe of its tendon, or fix all but one",
    ),
    TradeOff(
        frozenset({"dlt_tib", "pt_tib", "kt_tib", "fmax_tib"}),
        "in the toe they bend one curve alike",
        "higher forces of the tibialis, past the toe of its tendon, or fix all but one",
    ),
    TradeOff(
        frozenset({"l0_tri"}),
        "off the optimal length the same activation gives less force",
        "use more of the range of motion while the triceps is active",
        beside=frozenset({"g2", "g3", "g4"}),
    ),
    TradeOff(
        frozenset({"l0_tib"}),
        "off the optimal length the same activation gives less force",
        "use more of the range of motion while the tibialis is active",
        beside=frozenset({"g1"}),
    ),
    TradeOff(
        frozenset({"tau_rel", "k_rel"}),
        "relaxation lowers the torque that stiffness and slack length set",
        "hold longer at several angles, with a passive part in the trial",
        beside=frozenset({"k_tri", "x0_tri", "k_tib", "x0_tib"}),
    ),
    TradeOff(
        frozenset({"dlt_tri", "pt_tri", "kt_tri", "fmax_tri"}),
        "a tendon that gives way lets the muscle shorten and its tissue slacken",
        "a passive part with long holds, apart from the active one, or fix the tendon",
        beside=frozenset({"l0_tri", "k_tri", "x0_tri", "tau_rel", "k_rel", "g2", "g3", "g4"}),
    ),
    TradeOff(
        frozenset({"dlt_tib", "pt_tib", "kt_tib", "fmax_tib"}),
        "a tendon that gives way lets the muscle shorten and its tissue slacken",
        "a passive part with more plantarflexion, apart from the active one, or fix the tendon",
        beside=frozenset({"l0_tib", "k_tib", "x0_tib", "g1"}),
    ),
)

#: The same of the optional drives.
DRIVE_TRADE_OFFS: tuple[TradeOff, ...] = (
    TradeOff(
        frozenset({"emd"}),
        "a slower filter delays the force behind the EMG as a pure delay does",
        "faster bursts of effort, or fix the delay or beta (1, critical damping)",
        beside=frozenset({"f0", "beta", "f"}),
    ),
    TradeOff(
        frozenset({"reflex_delay"}),
        "a slower filter delays the force behind a stretch as the reflex's delay does",
        "an active part with fast bursts of effort, which shows the filter, or fix the delay",
        beside=frozenset({"f0", "beta", "f"}),
    ),
    TradeOff(
        frozenset({"reflex_tri", "reflex_tib", "reflex_delay"}),
        "the reflexes of both muscles answer the same movement",
        "fast stretches of either muscle with rest between them, or fix one gain at 0",
    ),
    TradeOff(
        frozenset({"reflex_tri", "reflex_tib"}),
        "tissue that relaxes resists a fast stretch too",
        "stretches over the same range at several speeds, slow ones included",
        beside=frozenset({"k_tri", "x0_tri", "k_tib", "x0_tib", "tau_rel", "k_rel", "b_tri", "F0"}),
    ),
    TradeOff(
        frozenset({"reflex_tri", "reflex_tib"}),
        "EMG that the reflex makes drives the force a second time",
        "fix the gain at 0 where the EMG holds the reflex, or leave it to trials without effort",
        beside=frozenset({"g1", "g2", "g3", "g4", "e1", "e2", "e3", "e4"}),
    ),
)


def trade_off(name: str, partners: tuple[str, ...]) -> TradeOff | None:
    """The known reason why a parameter trades off with one of its partners, strongest first."""
    for partner in partners:
        for known in (*TRADE_OFFS, *DRIVE_TRADE_OFFS):
            if known.holds(name, partner):
                return known
    return None
