"""What makes a parameter uncertain: one record a source, and all that lists, draws or explains it.

Some sources are nuisances: no laboratory can rule them out, so a fit with `model="auto"` estimates
them along with the leg. Their priors are what a careful laboratory knows that did not look further,
not what some recording showed; all can be changed (`nuisances` of `surae.fit`).
"""

import math

from surae.base.frozen import FrozenDict
from surae.base.words import N_
from surae.model.knowledge import Knowledge
from surae.model.parameters import ADDED, OPTIONAL
from surae.model.source import Fill, Gaussian, Nuisance, UncertaintySource
from surae.recording import PLACES

#: How far a leg's arm is from the assumed one, on a logarithm: adults' differ by 9.5 % (Wolfram et
#: al. 2018).
ARM_SIZE = 0.095
#: By how much a muscle lengthens of what its arm makes of a turn, dx/dθ over the arm, on a
#: logarithm: 0.30 to 1.09. Fibres of the relaxed triceps change by 15 to 28 mm over 45° (Maganaris
#: et al. 1998, J. Physiol. 512:603-614), 0.40 to 0.74 of an arm of 48 mm; of the relaxed
#: gastrocnemius's lengthening 48 ± 12 % is the fascicles' (Hoang et al. 2007, J. Exp. Biol.
#: 210:4159-4168), by place in the muscle and joint that turns otherwise (Herbert et al. 2014, J.
#: Physiol. 593:441-455; Hodson-Tole et al. 2016, Front. Physiol. 7:95); without pennation and on a
#: stiff tendon it is 1. The spread is assumed, the same of both groups.
GEAR = Gaussian(math.log(0.57), 0.33)
#: How far that of the person's own lengths is from a table's: what pennation leaves.
GEAR_OF_TABLE = 0.10
_AGAIN = N_("measure the moment arms in a second way too, as by the tendon’s excursion")
_SOURCES = (
    UncertaintySource(
        "noise",
        "noise of the torque",
        "what scatters in the torque without a pattern",
        N_("record more trials, with other movement and effort, and fit them together"),
        Fill("measured"),
        fresh=True,
    ),
    UncertaintySource(
        "emg_noise",
        "error of the EMG",
        "how far the EMG is from the effort at each moment",
        N_("improve the contact of the electrodes, or ask for more effort"),
        Fill("surface", "x"),
        fresh=True,
    ),
    UncertaintySource(
        "zero",
        "torque zero",
        "what the sensor shows without torque",
        N_("measure the zero of the torque sensor"),
        Fill("ink"),
        Nuisance(
            "zero",
            OPTIONAL["torque_zero"],
            Gaussian(0.0, 10.0),
            "Nm",
            "a dynamometer’s zero was off by 12 to 19 Nm with a foot strapped in",
            anew="trial",
        ),
    ),
    UncertaintySource(
        "delay",
        "delay",
        "from the EMG to the force",
        N_("measure the delay from EMG to torque with a twitch"),
        Fill("surface", "/"),
        Nuisance(
            "delay",
            OPTIONAL["emd"],
            Gaussian(0.03, 0.03),
            "s",
            "20 to 100 ms from EMG to force (Cavanagh and Komi 1979)",
            of_leg=True,
        ),
    ),
    UncertaintySource(
        "crosstalk",
        "crosstalk",
        "part of another muscle’s EMG that an electrode picks up",
        N_("test the electrodes muscle by muscle"),
        Fill("series-1"),
        Nuisance(
            "crosstalk",
            OPTIONAL["crosstalk"],
            Gaussian(0.04, 0.03),
            "",
            "3 to 10 % of a neighbour’s rectified EMG (De Luca and Merletti 1988)",
            anew="mounting",
        ),
    ),
    UncertaintySource(
        "axis",
        "axis",
        "how far the ankle’s axis lies from the device’s",
        N_("align the ankle’s axis with the device’s, or measure their distance"),
        Fill("surface", "|"),
        again_by=N_("let another reader measure where the ankle’s axis lies"),
        nuisance=Nuisance(
            "axis",
            OPTIONAL["axis"],
            Gaussian(0.0, 0.01),
            "m",
            "torques 5 to 9 % off (Arampatzis et al. 2007)",
            anew="mounting",
            of_device=True,
        ),
    ),
    UncertaintySource(
        "emg_gain",
        "drift of the EMG",
        "change of an electrode’s gain within the trial",
        N_("keep the electrodes’ gain steady, or measure it before and after"),
        Fill("surface", "-"),
        fresh=True,
    ),
    UncertaintySource(
        "emg_band",
        "rate of the EMG",
        "what a slow rate leaves of the EMG’s band",
        N_("record the raw EMG at 1 kHz or faster"),
        Fill("measured", "x"),
    ),
    UncertaintySource(
        "emg_rest",
        "EMG at rest",
        "what an electrode shows of a muscle that rests",
        N_("record all muscles at rest"),
        Fill("series-1", "-"),
        Nuisance(
            "rest",
            OPTIONAL["emg_rest"],
            Gaussian(0.0, 1.0),
            "of the level at rest",
            "the level that the electrode shows at its quietest: an envelope is never below zero, "
            "so that noise alone lifts it",
            anew="trial",
        ),
    ),
    UncertaintySource(
        "emg_shape",
        "EMG curve",
        "bend from EMG to activation; 0 is a straight line",
        N_("measure several levels of effort"),
        Fill("surface", "."),
        Nuisance(
            "shape",
            (*OPTIONAL["emg_shape"], *OPTIONAL["emg_power"]),
            Gaussian(-0.5, 1.0),
            "",
            "between −3 and 0, and powers of 0.5 to 1 (Lloyd and Besier 2003)",
            departs=True,
            prior_of=FrozenDict({"emg_power": Gaussian(0.0, 0.25)}),
        ),
    ),
    UncertaintySource(
        "release",
        "release",
        "how much slower muscles let go than they take hold",
        N_("ask for bursts of effort that end as fast as they begin"),
        Fill("series-2", "x"),
        Nuisance(
            "release",
            OPTIONAL["release"],
            Gaussian(0.03, 0.03),
            "s",
            "10 to 15 ms to activate, 40 to 50 to deactivate (Zajac 1989; Thelen 2003)",
            of_leg=True,
            departs=True,
        ),
    ),
    UncertaintySource(
        "emg_lag",
        "lag of the EMG",
        "how far an envelope is behind its EMG",
        N_("give the raw EMG instead of envelopes"),
        Fill("series-3", "/"),
        Nuisance(
            "lag",
            OPTIONAL["emg_lag"],
            Gaussian(0.02, 0.015),
            "s",
            "a low-pass of 3 to 10 Hz lags by 16 to 53 ms, by nothing if it is run both ways",
        ),
    ),
    UncertaintySource(
        "tendon",
        "tendons",
        "how far they stretch, and where their force curve becomes straight",
        N_("measure the tendon’s strain by ultrasound"),
        Fill("surface", "\\"),
        Nuisance(
            "toe",
            ("pt_tri", "pt_tib"),
            Gaussian(0.3, 0.1, off=0.3),
            "",
            "Table 2 of the thesis, after Thelen (2003); the spread is assumed",
            of_leg=True,
        ),
        leg=("dlt_tri", "dlt_tib"),
    ),
    UncertaintySource(
        "model",
        "choice of the model",
        "how far apart models are that the data support",
        N_("measure another movement, wider or faster, which tells the models apart"),
        Fill("series-3"),
    ),
    UncertaintySource(
        "left_out",
        "what the model leaves out",
        "what the torque shows and no model has",
        N_("record trials with other movements and efforts"),
        Fill("series-3", "|"),
        knowable=False,
    ),
    UncertaintySource(
        "softening",
        "tissue that softens",
        "by how much tissue was stiffer in its first stretches",
        N_("stretch the relaxed ankle ten times before the trial"),
        Fill("series-2", "/"),
        fresh=True,
    ),
    UncertaintySource(
        "film",
        "filmed fascicle",
        "how far the fascicle in the film differs from the whole muscle",
        N_("film a longer piece of the muscle, or several places of it"),
        Fill("series-1", "."),
        Nuisance(
            "film",
            tuple(name for at in PLACES for name in OPTIONAL[f"film_{at}"]),
            Gaussian(0.0, 0.06),
            "",
            "fibres of one muscle differ so much that fewer than 25 misjudge their mean (Charles "
            "et al. 2022); the deep region of a filmed tibialis travels 6 to 14 % less than its "
            "superficial one (data of Tecchio et al. 2023), 4 to 10 % about their mean; the three "
            "calf muscles differ by as much; the sizes are assumed",
            anew="mounting",
            prior_of=FrozenDict(
                {f"film_zero_{at}": Gaussian(0.0, 0.006) for at in PLACES}
                | {f"film_zero_{at}": Gaussian(0.0, 0.004) for at in ("tib", "tib2")}
            ),
        ),
    ),
    UncertaintySource(
        "film_drift",
        "drift of the film",
        "how far the film's tracker drifts within the trial",
        N_("correct the tracker at key frames"),
        Fill("series-1", "/"),
        fresh=True,
    ),
    UncertaintySource(
        "unheard",
        "muscles without EMG",
        "what muscles do that no electrode records",
        N_("record the EMG of all four muscles"),
        Fill("series-2", "\\"),
    ),
    UncertaintySource(
        "heads",
        "heads of a muscle group",
        "how much one head pulls beyond its share, as its length is not the group’s",
        N_("read what the heads do together, which is better known than each"),
        Fill("series-6", "+"),
        knowable=False,
    ),
    UncertaintySource(
        "trials",
        "differences between trials",
        "by how much trials of this leg disagree",
        N_("record more trials of the same kind"),
        Fill("series-6"),
        fresh=True,
        knowable=False,
    ),
    UncertaintySource(
        "torque_drift",
        "drift of the torque",
        "change of the torque’s zero within the trial",
        N_("let the torque sensor warm up, and measure its zero before and after"),
        Fill("ink", "/"),
        fresh=True,
    ),
    UncertaintySource(
        "plate",
        "foot plate",
        "inertia and weight of a plate that was not tared",
        N_("record the moving plate without the foot, and subtract it"),
        Fill("ink", "x"),
        Nuisance(
            "plate",
            OPTIONAL["plate"],
            Gaussian(0.0, 5.0),
            "Nm",
            "plates of 1 to 3 kg, their centre 5 to 15 cm from the axis; assumed",
            departs=True,
            of_device=True,
            prior_of=FrozenDict({"plate_inertia": Gaussian(0.0, 0.03)}),
        ),
    ),
    UncertaintySource(
        "joint_spring",
        "joint tissue",
        "capsule, ligaments and skin that hold beside the muscles",
        N_("tare the empty plate, and move the relaxed ankle slowly over its whole range"),
        Fill("series-6", "x"),
        Nuisance(
            "spring",
            OPTIONAL["joint_spring"],
            Gaussian(2.0, 2.0, off=0.0),
            "Nm/rad",
            "the capsule makes 47 % of the stiffness of a cat’s wrist (Johns and Wright 1962), the "
            "whole relaxed ankle has some 4 to 8 Nm/rad; the rest is assumed",
            of_leg=True,
            departs=True,
            prior_of=FrozenDict({"joint_torque": Gaussian(0.0, 0.5)}),
        ),
    ),
    UncertaintySource(
        "joint_damper",
        "joint damping",
        "capsule, skin and hinge that brake beside the muscles",
        N_("move the relaxed ankle at several speeds"),
        Fill("series-6", "-"),
        Nuisance(
            "damper",
            OPTIONAL["joint_damper"],
            Gaussian(0.2, 0.3, off=0.0),
            "Nm·s/rad",
            "tenths; assumed",
            of_leg=True,
            departs=True,
        ),
    ),
    UncertaintySource(
        "relaxed_curve",
        "relaxed tissue",
        "how far the relaxed leg’s curve may be from what its rest says",
        N_("record more rest, and move the relaxed ankle slowly over its whole range"),
        Fill("series-6", "\\"),
    ),
    UncertaintySource(
        "give",
        "give of the plate",
        "how far the foot turns on its plate under load",
        N_("strap the foot tighter, or measure the angle at the ankle"),
        Fill("series-6", "/"),
        Nuisance(
            "give",
            OPTIONAL["plate_give"],
            Gaussian(0.0, 8e-4),
            "rad/Nm",
            "a heel lifts by 2 to 6° in strong contractions (Karamanidis et al. 2005)",
            anew="mounting",
            departs=True,
            of_device=True,
        ),
    ),
    UncertaintySource(
        "arms",
        "moment arms",
        "how far the leg’s moment arms differ from the assumed ones",
        N_("give the leg’s own geometry, from images or a scaled model"),
        Fill("series-2"),
        again_by=_AGAIN,
        nuisance=Nuisance(
            "arm",
            OPTIONAL["arm"],
            Gaussian(0.0, 0.15),
            "",
            "moment arms differ by 6 to 12 % between adults (Maganaris et al. 1998, 1999); muscles "
            "travel by half more or less in published geometries; bends are assumed",
            of_leg=True,
            departs=True,
            prior_of=FrozenDict(
                {f"arm_scale_{g}": Gaussian(0.0, 0.06) for g in ("tri", "tib")}
                | {f"path_scale_{g}": Gaussian(0.0, 0.3) for g in ("tri", "tib")}
            ),
            # one image: readers differ by 3 %, methods by 4 mm; what else is assumed
            measured=FrozenDict(
                {
                    f"{of}_{g}": Gaussian(0.0, 0.095)
                    for of in ("arm_scale", "path_scale")
                    for g in ("tri", "tib")
                }
                | {
                    f"{of}_{g}": Gaussian(0.0, 0.05)
                    for of in ("arm_slope", "arm_bend")
                    for g in ("tri", "tib")
                }
            ),
        ),
    ),
    UncertaintySource(
        "path_bends",
        "bend of the paths",
        "how far the muscles’ paths bend otherwise than is assumed",
        N_("give the leg’s own geometry, from images or a scaled model"),
        Fill("series-2", "+"),
        again_by=_AGAIN,
        nuisance=Nuisance(
            "bend",
            OPTIONAL["path_bend"],
            Gaussian(0.0, 0.004),
            "m/rad²",
            "a path that does work bends as its arm does, whatever share of the way its muscle "
            "travels; how that share changes with the angle is assumed",
            of_leg=True,
            departs=True,
            measured=FrozenDict({f"path_bend_{g}": Gaussian(0.0, 0.002) for g in ("tri", "tib")}),
        ),
    ),
    UncertaintySource(
        "arm_size",
        "size of the arms",
        "how much larger the leg’s moment arms are than the assumed ones",
        N_("state the leg’s own moment arms, from images or the tendon’s excursion"),
        Fill("series-2", "|"),
        again=(0.0, 0.0),
    ),
    UncertaintySource(
        "path_size",
        "muscles’ paths",
        "how much farther the muscles travel than is assumed",
        N_("film the muscle, or state the leg’s own geometry"),
        Fill("series-2", "."),
        again=(0.0, 0.0),
    ),
    UncertaintySource(
        "lengths",
        "muscle lengths",
        "how much longer the leg’s muscles are than assumed",
        N_("give the length of the leg’s own muscles, from images or a scaled model"),
        Fill("series-2", "-"),
        again_by=_AGAIN,
        nuisance=Nuisance(
            "length",
            OPTIONAL["length_zero"],
            Gaussian(0.0, 0.005),
            "m",
            "fascicles are 10 to 20 % off what size predicts (Ward et al. 2009)",
            of_leg=True,
        ),
        again=(0.0, 0.0),
    ),
    UncertaintySource(
        "curves",
        "muscle curves",
        "widths of force over length, bend of force over velocity",
        N_("record more angles and velocities under effort"),
        Fill("series-3", "x"),
        Nuisance(
            "curves",
            OPTIONAL["curves"],
            Gaussian(0.0, 0.35),
            "",
            "widths and asymptotes of human muscles differ by a third (Zajac 1989; Thelen 2003)",
            of_leg=True,
            departs=True,
            prior_of=FrozenDict(
                {"fv_speed": Gaussian(0.0, 0.25)}
                | {name: Gaussian(0.0, 0.3) for name in ("fv_curve", "fv_stretch")}
            ),
        ),
    ),
    UncertaintySource(
        "reflex",
        "stretch reflex",
        "force that answers a stretch and that no electrode shows",
        N_("record a slow and a quick stretch at rest"),
        Fill("series-1", "|"),
        Nuisance(
            "reflex",
            OPTIONAL["reflex"],
            Gaussian(0.0, 2000.0),
            "N·s/m",
            "some Nm at a stretch of 3 rad/s; assumed",
            of_leg=True,
            departs=True,
            prior_of=FrozenDict({"reflex_delay": Gaussian(0.05, 0.015, off=0.05)}),
        ),
    ),
    UncertaintySource(
        "reflex_length",
        "reflex to length",
        "force that answers a held stretch",
        N_("record a slow and a quick stretch at rest"),
        Fill("series-1", "\\"),
        Nuisance(
            "reflex_length",
            OPTIONAL["reflex_length"],
            Gaussian(0.0, 1e4),
            "N/m",
            "some Nm at a stretch of a centimetre; assumed",
            of_leg=True,
            departs=True,
            rare=True,
        ),
    ),
    UncertaintySource(
        "reflex_force",
        "reflex to force",
        "force that answers the force of stretched tissue",
        N_("record a slow and a quick stretch at rest"),
        Fill("series-1", "+"),
        Nuisance(
            "reflex_force",
            OPTIONAL["reflex_force"],
            Gaussian(0.0, 0.3),
            "",
            "of spastic muscles (Falisse et al. 2018); size assumed",
            of_leg=True,
            departs=True,
            rare=True,
        ),
    ),
    UncertaintySource(
        "bridges",
        "short-range stiffness",
        "force of bridges that hold until they yield",
        N_("turn the movement about under steady effort, fast and slowly"),
        Fill("series-3", "\\"),
        Nuisance(
            "bridges",
            OPTIONAL["bridges"],
            Gaussian(23.0, 12.0, off=0.0),
            "",
            "23 forces per length (Cui et al. 2008), over half to one and a half percent (Rack and "
            "Westbury 1974; De Groote et al. 2018)",
            of_leg=True,
            departs=True,
            rare=True,
            prior_of=FrozenDict({"bridge_reach": Gaussian(0.01, 0.004, off=0.01)}),
        ),
    ),
    UncertaintySource(
        "angle_zero",
        "zero of the angle",
        "how far the angle’s zero is from the ankle’s own",
        N_("strap the foot tighter, or measure the angle at the ankle"),
        Fill("measured", "/"),
        # half of it another mounting by the same hands has anew; assumed
        again=(0.0, 0.25),
        again_by=N_("let another reader set the zero of the angle too"),
    ),
    UncertaintySource(
        "population",
        "population prior",
        "the spread of legs in the population",
        N_("record more trials, with other movement and effort, and fit them together"),
        Fill("surface", "+"),
        knowable=False,
    ),
    *ADDED.values(),
)
#: All of them by name, in the order in which they are shown.
SOURCES = {source.name: source for source in _SOURCES}
#: Those that are estimated along with the leg, by group.
NUISANCES = {s.nuisance.group: s for s in _SOURCES if s.nuisance is not None}
#: What each source, and each group, is called.
LABELS = {s.name: s.label for s in _SOURCES} | {g: s.label for g, s in NUISANCES.items()}
_BY_PARAMETER = {name: source for source in _SOURCES for name in source.parameters}


def source_of(parameter: str) -> UncertaintySource | None:
    """The source that a parameter is of; None for one of the leg that is its own."""
    return _BY_PARAMETER.get(parameter)


def advice(name: str, known: Knowledge | None) -> str:
    """What would make a source smaller: a second statement, where there is one without it."""
    alone = known is not None and known.agrees(name) is False
    return SOURCES[name].again_by if alone else SOURCES[name].advice
