"""The names that users choose among, written once: help shows them without loading what they name.

`tests/test_names.py` holds them to what they name.
"""

from surae.base.words import N_


class Names(tuple[str, ...]):
    """Names that help shows; what plugins of a group are called is among them too."""

    group: str

    def __new__(cls, group: str, names: tuple[str, ...]) -> "Names":
        """Names of what surae itself has, or what is known to be elsewhere."""
        made = super().__new__(cls, names)
        made.group = group
        return made

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or name in self._added()

    def here(self) -> tuple[str, ...]:
        """Those that are installed, of plugins too; none of these is loaded."""
        return (*self, *(name for name in self._added() if name not in self))

    def _added(self) -> tuple[str, ...]:
        from importlib.metadata import entry_points

        return tuple(point.name for point in entry_points(group=f"surae.{self.group}"))


MODELS = Names(
    "models",
    ("muscle", "muscle-tendon", "muscle-tendon-strain", "muscle-tendon-toe", "muscle-2010"),
)
#: The family of models that is searched, and the choices of a fit.
AUTO = "auto"
FITTED = Names("models", (AUTO, *MODELS))
#: What of the laboratory's imperfections `auto` takes in.
NUISANCES = ("all", "none")
#: Groups of optional parameters that drive or resist the muscles, and what a fit estimates by them.
DRIVES = {"emd": "an EMG delay", "reflex": "a stretch reflex"}
LOSSES = ("huber", "soft-l1", "tukey")
POPULATIONS = ("healthy", "patient")
NORMALISATIONS = ("session", "mvc")
#: Whose the table of a geometry is.
GEOMETRY_OF = ("generic", "person")
#: Languages of the leg's page.
LANGUAGES = ("en", "nl", "de", "fr")
#: What a peak is one of, where peaks count more.
ACTIVITIES = ("torque", "emg")
#: Switches of the models that are a choice; the first is the default.
CHOICES = {
    "geometry": ("thesis", "virtual-work"),
    "joint": ("ankle",),
    "tendon_strain": ("thesis", "slack-length"),
    "integrator": Names("integrators", ("implicit", "explicit-euler", "explicit-damped")),
}
#: Tasks and devices of protocols, those that come with surae, and their profiles.
TASKS = ("part-passive", "active", "passive", "steps", "prbs")
DEVICES = ("achilles",)
PROFILES = (
    "ramp-and-hold",
    "sine",
    "multiple-holds",
    "multi-sine",
    "multi-sine-holds",
    "scaled-chirp",
    "isometric",
)
DESIGNED = ("compliant-35", "everything-35", "passive-20", "relaxed-35", "tendon-60")
#: Movements that tell tissue from nerve, and what they are good for.
TELLING = {
    **dict.fromkeys(
        ("prbs", "pralds", "multisine"),
        N_("Small random movements: how much is tissue, and reflex."),
    ),
    "stretches": N_("Slow and fast stretches at rest: how much is tissue, and reflex."),
}
#: What a subject can do, where a protocol is designed.
EFFORTS = ("levels", "none")
#: The source of the LSL stream that surae itself sends, of what a trial asks for: no measurement.
TARGET_SOURCE = "surae-live-target"
#: Rise of a chirp's frequency where none is given: that of the thesis's factor 0.5, rounded [Hz/s].
CHIRP_RATE = 0.159
