"""What makes a parameter uncertain: one record a source, and all that lists, draws or explains it.

Some sources are nuisances: no laboratory can rule them out, so a fit with `model="auto"` estimates
them along with the leg. Their priors are what a careful laboratory knows that did not look further,
not what some recording showed; all can be changed (`nuisances` of `surae.fit`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from surae.frozen import FrozenDict
from surae.model.parameters import OPTIONAL
from surae.recording import FILMED
from surae.words import Text


class Fill(NamedTuple):
    """How a source is drawn: a colour of the palette and a hatch; together they are its own."""

    colour: Literal["surface", "measured", "ink", "series-1", "series-2", "series-3", "series-6"]
    hatch: Literal["", "/", "\\", "x", "-", "|", "+", "."] = ""


@dataclass(frozen=True, slots=True)
class Gaussian:
    """The prior of a nuisance."""

    #: `mean`, `sd`: in the parameter's unit.
    mean: float
    sd: float
    off: float = 0.0  #: The value at which there is no such nuisance.


@dataclass(frozen=True, slots=True)
class Nuisance:
    """The parameters that a source is estimated by; in a model as a whole or not at all."""

    group: str  #: Its name in `nuisances`.
    parameters: tuple[str, ...]
    prior: Gaussian
    unit: str  #: What the prior is in, for readers.
    because: str  #: Where the prior comes from.
    #: What makes it another: the next trial, or electrodes and foot mounted anew.
    anew: Literal["never", "trial", "mounting"] = "never"
    of_leg: bool = False  #: Whether it belongs to the leg, and not to what measures it.
    #: Priors of single parameters that differ from `prior`.
    own: Mapping[str, Gaussian] = field(default_factory=FrozenDict)
    #: Priors where the geometry is the person's own, see `geometry_of` of a fit.
    measured: Mapping[str, Gaussian] = field(default_factory=FrozenDict)
    departs: bool = False  #: Whether it is in the model only where the data ask for it.

    def prior_of(self, parameter: str) -> Gaussian:
        """What is known of one of its parameters."""
        return self.own.get(parameter, self.prior)


@dataclass(frozen=True, slots=True)
class UncertaintySource:
    """One source of uncertainty."""

    name: str  #: In FIT.json.
    label: str  #: What reports and the workbench call it.
    meaning: str  #: What it is.
    remedy: Text  #: What would make it smaller, a sentence.
    look: Fill
    nuisance: Nuisance | None = None  #: None where nothing is estimated for it.
    leg: tuple[str, ...] = ()  #: Parameters of the leg whose ignorance is this source, too.
    fresh: bool = False  #: Whether another trial has it anew, though no nuisance stands for it.
    #: Whether it can be known, so that the budget says how narrow an interval then is.
    knowable: bool = True

    @property
    def parameters(self) -> tuple[str, ...]:
        """All parameters that it is made of."""
        return (*self.leg, *(self.nuisance.parameters if self.nuisance else ()))

    @property
    def anew(self) -> float:
        """Part of its variance that another trial of the leg has anew."""
        return self.anew_when(mounted=False)

    def anew_when(self, *, mounted: bool) -> float:
        """Part of its variance that another trial has anew, electrodes and foot mounted or not."""
        when = self.nuisance.anew if self.nuisance else "trial" if self.fresh else "never"
        if when == "trial" or (mounted and when == "mounting"):
            return 1.0
        return 0.0 if self.name == "lengths" else SHARED

    @property
    def advice(self) -> str:
        """The remedy as an imperative within an English sentence."""
        return self.remedy.en[0].lower() + self.remedy.en[1:].rstrip(".")


#: Part of the variance by what two trials share that differs between them: it shifts estimates
#: otherwise where movement and effort differ. Set on twelve virtual legs (decision 16).
SHARED = 0.15

_SOURCES = (
    UncertaintySource(
        "noise", "noise of the torque", "what scatters in the torque without a pattern",
        Text(
            "Measure longer, or with more movement and effort.",
            "Meet langer, of met meer beweging en inspanning.",
            "Länger messen, oder mit mehr Bewegung und Anstrengung.",
            "Mesurer plus longtemps, ou avec plus de mouvement et d’effort.",
        ),
        Fill("measured"), fresh=True,
    ),
    UncertaintySource(
        "emg_noise", "error of the EMG", "how far the EMG is from the effort at each moment",
        Text(
            "Improve the contact of the electrodes, or ask for more effort.",
            "Verbeter het contact van de elektroden, of vraag meer inspanning.",
            "Den Kontakt der Elektroden verbessern, oder mehr Anstrengung verlangen.",
            "Améliorer le contact des électrodes, ou demander plus d’effort.",
        ),
        Fill("surface", "x"), fresh=True,
    ),
    UncertaintySource(
        "zero", "torque zero", "what the sensor shows without torque",
        Text(
            "Measure the zero of the torque sensor.",
            "Meet het nulpunt van de momentsensor.",
            "Den Nullpunkt des Momentsensors messen.",
            "Mesurer le zéro du capteur de moment.",
        ),
        Fill("ink"),
        Nuisance(
            "zero", OPTIONAL["torque_zero"], Gaussian(0.0, 10.0), "Nm",
            "a dynamometer’s zero was off by 12 to 19 Nm with a foot strapped in", anew="trial",
        ),
    ),
    UncertaintySource(
        "delay", "delay", "from the EMG to the force",
        Text(
            "Measure the delay from EMG to torque with a twitch.",
            "Meet de vertraging van EMG naar moment met een enkele contractie.",
            "Die Verzögerung von EMG zu Moment mit einer Einzelzuckung messen.",
            "Mesurer le délai de l’EMG au moment par une secousse.",
        ),
        Fill("surface", "/"),
        Nuisance(
            "delay", OPTIONAL["emd"], Gaussian(0.03, 0.03), "s",
            "20 to 100 ms from EMG to force (Cavanagh and Komi 1979)", of_leg=True,
        ),
    ),
    UncertaintySource(
        "crosstalk", "crosstalk", "part of another muscle’s EMG that an electrode picks up",
        Text(
            "Test the electrodes muscle by muscle.",
            "Test de elektroden spier voor spier.",
            "Die Elektroden Muskel für Muskel prüfen.",
            "Vérifier les électrodes muscle par muscle.",
        ),
        Fill("series-1"),
        Nuisance(
            "crosstalk", OPTIONAL["crosstalk"], Gaussian(0.04, 0.03), "",
            "3 to 10 % of a neighbour’s rectified EMG (De Luca and Merletti 1988)", anew="mounting",
        ),
    ),
    UncertaintySource(
        "axis", "axis", "how far the ankle’s axis lies from the device’s",
        Text(
            "Align the ankle’s axis with the device’s, or measure their distance.",
            "Lijn de as van de enkel uit met die van het apparaat, of meet hun afstand.",
            "Die Achse des Gelenks an der des Geräts ausrichten, oder ihren Abstand messen.",
            "Aligner l’axe de la cheville sur celui de l’appareil, ou mesurer leur distance.",
        ),
        Fill("surface", "|"),
        Nuisance(
            "axis", OPTIONAL["axis"], Gaussian(0.0, 0.01), "m",
            "torques 5 to 9 % off (Arampatzis et al. 2007)", anew="mounting",
        ),
    ),
    UncertaintySource(
        "emg_gain", "drift of the EMG", "change of an electrode’s gain within the trial",
        Text(
            "Keep the electrodes’ gain steady, or measure it before and after.",
            "Houd de versterking van de elektroden constant, of meet die voor en na.",
            "Die Verstärkung der Elektroden konstant halten, oder vorher und nachher messen.",
            "Maintenir constant le gain des électrodes, ou le mesurer avant et après.",
        ),
        Fill("surface", "-"), fresh=True,
    ),
    UncertaintySource(
        "emg_rest", "EMG at rest", "what an electrode shows of a muscle that rests",
        Text(
            "Record all muscles at rest.",
            "Meet alle spieren in rust.",
            "Alle Muskeln in Ruhe aufzeichnen.",
            "Enregistrer tous les muscles au repos.",
        ),
        Fill("series-1", "-"),
        Nuisance(
            "rest", OPTIONAL["emg_rest"], Gaussian(0.0, 1.0), "of the level at rest",
            "the level that the electrode shows at its quietest: an envelope is never below zero, "
            "so that noise alone lifts it", anew="trial",
        ),
    ),
    UncertaintySource(
        "emg_shape", "EMG curve", "bend from EMG to activation; 0 is a straight line",
        Text(
            "Measure several levels of effort.",
            "Meet meerdere niveaus van inspanning.",
            "Mehrere Anstrengungsstufen messen.",
            "Mesurer plusieurs niveaux d’effort.",
        ),
        Fill("surface", "."),
        Nuisance(
            "shape", (*OPTIONAL["emg_shape"], *OPTIONAL["emg_power"]), Gaussian(-0.5, 1.0), "",
            "between −3 and 0, and powers of 0.5 to 1 (Lloyd and Besier 2003)", departs=True,
            own=FrozenDict({"emg_power": Gaussian(0.0, 0.25)}),
        ),
    ),
    UncertaintySource(
        "tendon", "tendons", "how far they stretch, and where their force curve becomes straight",
        Text(
            "Measure the tendon’s strain by ultrasound.",
            "Meet de rek van de pees met echografie.",
            "Die Dehnung der Sehne mit Ultraschall messen.",
            "Mesurer l’allongement du tendon par échographie.",
        ),
        Fill("surface", "\\"),
        Nuisance(
            "toe", ("pt_tri", "pt_tib"), Gaussian(0.3, 0.1, off=0.3), "",
            "Table 2 of the thesis, after Thelen (2003); the spread is assumed", of_leg=True,
        ),
        leg=("dlt_tri", "dlt_tib"),
    ),
    UncertaintySource(
        "model", "choice of the model", "how far apart models are that the data support",
        Text(
            "Measure another movement, wider or faster, which tells the models apart.",
            "Meet een andere beweging, ruimer of sneller, die de modellen onderscheidt.",
            "Eine andere Bewegung messen, weiter oder schneller, die die Modelle unterscheidet.",
            "Mesurer un autre mouvement, plus ample ou plus rapide, qui distingue les modèles.",
        ),
        Fill("series-3"),
    ),
    UncertaintySource(
        "left_out", "what the model leaves out", "what the torque shows and no model has",
        Text(
            "Record trials with other movements and efforts.",
            "Meet ook andere bewegingen en inspanningen.",
            "Auch andere Bewegungen und Anstrengungen aufzeichnen.",
            "Enregistrer aussi d’autres mouvements et d’autres efforts.",
        ),
        Fill("series-3", "|"), knowable=False,
    ),
    UncertaintySource(
        "film", "filmed fascicle", "how far the fascicle in the film differs from the whole muscle",
        Text(
            "Film a longer piece of the muscle, or several places of it.",
            "Film een langer stuk van de spier, of meerdere plaatsen ervan.",
            "Ein längeres Stück des Muskels filmen, oder mehrere Stellen.",
            "Filmer une plus longue partie du muscle, ou plusieurs endroits.",
        ),
        Fill("series-1", "."),
        Nuisance(
            "film", tuple(name for at in FILMED for name in OPTIONAL[f"film_{at}"]),
            Gaussian(0.0, 0.06), "",
            "fibres of one muscle differ so much that fewer than 25 misjudge their mean (Charles "
            "et al. 2022); a contracted tibialis is 2 % off a straight line (Reeves and Narici "
            "2003); the three calf muscles differ by more; the sizes are assumed", anew="mounting",
            own=FrozenDict(
                {f"film_zero_{at}": Gaussian(0.0, 0.006) for at in FILMED}
                | {"film_scale_tib": Gaussian(0.0, 0.03), "film_zero_tib": Gaussian(0.0, 0.004)}
            ),
        ),
    ),
    UncertaintySource(
        "film_drift", "drift of the film", "how far the film's tracker drifts within the trial",
        Text(
            "Correct the tracker at key frames.",
            "Corrigeer de tracker bij sleutelbeelden.",
            "Den Tracker an Schlüsselbildern korrigieren.",
            "Corriger le suivi sur des images clés.",
        ),
        Fill("series-1", "/"), fresh=True,
    ),
    UncertaintySource(
        "unheard", "muscles without EMG", "what muscles do that no electrode records",
        Text(
            "Record the EMG of all four muscles.",
            "Meet het EMG van alle vier de spieren.",
            "Das EMG aller vier Muskeln aufzeichnen.",
            "Enregistrer l’EMG des quatre muscles.",
        ),
        Fill("series-2", "\\"),
    ),
    UncertaintySource(
        "trials", "differences between trials", "by how much trials of this leg disagree",
        Text(
            "Record more trials of the same kind.",
            "Meet meer proeven van dezelfde soort.",
            "Mehr Versuche derselben Art aufzeichnen.",
            "Enregistrer plus d’essais du même type.",
        ),
        Fill("series-6"), fresh=True, knowable=False,
    ),
    UncertaintySource(
        "torque_drift", "drift of the torque", "change of the torque’s zero within the trial",
        Text(
            "Let the torque sensor warm up, and measure its zero before and after.",
            "Laat de momentsensor opwarmen, en meet het nulpunt voor en na.",
            "Den Momentsensor warmlaufen lassen und seinen Nullpunkt vorher und nachher messen.",
            "Laisser chauffer le capteur de moment, et mesurer son zéro avant et après.",
        ),
        Fill("ink", "/"), fresh=True,
    ),
    UncertaintySource(
        "plate", "foot plate", "inertia and weight of a plate that was not tared",
        Text(
            "Record the moving plate without the foot, and subtract it.",
            "Meet de bewegende voetplaat zonder voet, en trek dat af.",
            "Die bewegte Fußplatte ohne Fuß aufzeichnen und abziehen.",
            "Enregistrer la plaque en mouvement sans le pied, et la soustraire.",
        ),
        Fill("ink", "x"),
        Nuisance(
            "plate", OPTIONAL["plate"], Gaussian(0.0, 5.0), "Nm",
            "plates of 1 to 3 kg, their centre 5 to 15 cm from the axis; assumed", departs=True,
            own=FrozenDict({"plate_inertia": Gaussian(0.0, 0.03)}),
        ),
    ),
    UncertaintySource(
        "give", "give of the plate", "how far the foot turns on its plate under load",
        Text(
            "Strap the foot tighter, or measure the angle at the ankle.",
            "Zet de voet strakker vast, of meet de hoek aan de enkel.",
            "Den Fuß fester fixieren, oder den Winkel am Gelenk messen.",
            "Fixer le pied plus fermement, ou mesurer l’angle à la cheville.",
        ),
        Fill("series-6", "/"),
        Nuisance(
            "give", OPTIONAL["plate_give"], Gaussian(0.0, 8e-4), "rad/Nm",
            "a heel lifts by 2 to 6° in strong contractions (Karamanidis et al. 2005)",
            anew="mounting", departs=True,
        ),
    ),
    UncertaintySource(
        "arms", "moment arms", "how far the leg’s moment arms differ from the assumed ones",
        Text(
            "Give the leg’s own geometry, from images or a scaled model.",
            "Geef de eigen geometrie van het been, uit beelden of een geschaald model.",
            "Die eigene Geometrie des Beins angeben, aus Bildern oder einem skalierten Modell.",
            "Donner la géométrie propre de la jambe, d’images ou d’un modèle à l’échelle.",
        ),
        Fill("series-2"),
        Nuisance(
            "arm", OPTIONAL["arm"], Gaussian(0.0, 0.15), "",
            "moment arms differ by 6 to 12 % between adults (Maganaris et al. 1998, 1999)",
            of_leg=True, departs=True,
            own=FrozenDict(
                {f"arm_scale_{g}": Gaussian(0.0, 0.06) for g in ("tri", "tib")}
                | {f"path_scale_{g}": Gaussian(0.0, 0.1) for g in ("tri", "tib")}
            ),
            # two readers of one image differ by 3 %; what else is assumed
            measured=FrozenDict(
                {f"{of}_{g}": Gaussian(0.0, 0.03) for of in ("arm_scale", "path_scale")
                 for g in ("tri", "tib")}
                | {f"{of}_{g}": Gaussian(0.0, 0.05) for of in ("arm_slope", "arm_bend")
                   for g in ("tri", "tib")}
            ),
        ),
    ),
    UncertaintySource(
        "lengths", "muscle lengths", "how much longer the leg’s muscles are than assumed",
        Text(
            "Give the length of the leg’s own muscles, from images or a scaled model.",
            "Geef de lengte van de spieren van het been, uit beelden of een geschaald model.",
            "Die Länge der Muskeln des Beins angeben, aus Bildern oder einem skalierten Modell.",
            "Donner la longueur des muscles de la jambe, d’images ou d’un modèle à l’échelle.",
        ),
        Fill("series-2", "-"),
        Nuisance(
            "length", OPTIONAL["length_zero"], Gaussian(0.0, 0.005), "m",
            "fascicles are 10 to 20 % off what size predicts (Ward et al. 2009)", of_leg=True,
            measured=FrozenDict(dict.fromkeys(OPTIONAL["length_zero"], Gaussian(0.0, 0.0025))),
        ),
    ),
    UncertaintySource(
        "curves", "muscle curves", "widths of force over length, bend of force over velocity",
        Text(
            "Record more angles and velocities under effort.",
            "Meet meer hoeken en snelheden onder inspanning.",
            "Mehr Winkel und Geschwindigkeiten unter Anstrengung aufzeichnen.",
            "Enregistrer plus d’angles et de vitesses sous effort.",
        ),
        Fill("series-3", "x"),
        Nuisance(
            "curves", OPTIONAL["curves"], Gaussian(0.0, 0.35), "",
            "widths and asymptotes of human muscles differ by a third (Zajac 1989; Thelen 2003)",
            of_leg=True, departs=True,
            own=FrozenDict(
                {"fv_speed": Gaussian(0.0, 0.25)}
                | {name: Gaussian(0.0, 0.3) for name in ("fv_curve", "fv_stretch")}
            ),
        ),
    ),
    UncertaintySource(
        "reflex", "stretch reflex", "force that answers a stretch and that no electrode shows",
        Text(
            "Record a slow and a quick stretch at rest.",
            "Meet een langzame en een snelle rek in rust.",
            "Eine langsame und eine schnelle Dehnung in Ruhe aufzeichnen.",
            "Enregistrer un étirement lent et un rapide au repos.",
        ),
        Fill("series-1", "|"),
        Nuisance(
            "reflex", OPTIONAL["reflex"], Gaussian(0.0, 2000.0), "N·s/m",
            "some Nm at a stretch of 3 rad/s; assumed", of_leg=True, departs=True,
            own=FrozenDict({"reflex_delay": Gaussian(0.05, 0.015, off=0.05)}),
        ),
    ),
    UncertaintySource(
        "population", "population prior", "the spread of legs in the population",
        Text(
            "Measure longer, or with more movement and effort.",
            "Meet langer, of met meer beweging en inspanning.",
            "Länger messen, oder mit mehr Bewegung und Anstrengung.",
            "Mesurer plus longtemps, ou avec plus de mouvement et d’effort.",
        ),
        Fill("surface", "+"), knowable=False,
    ),
)  # fmt: skip
#: All of them by name, in the order in which they are shown.
SOURCES = {source.name: source for source in _SOURCES}
#: Those that are estimated along with the leg, by group.
NUISANCES = {s.nuisance.group: s for s in _SOURCES if s.nuisance is not None}
#: Those that another trial of the session has anew, though no nuisance stands for them.
FRESH = tuple(source.name for source in _SOURCES if source.fresh)
_BY_PARAMETER = {name: source for source in _SOURCES for name in source.parameters}


def source_of(parameter: str) -> UncertaintySource | None:
    """The source that a parameter is of; None for one of the leg that is its own."""
    return _BY_PARAMETER.get(parameter)
