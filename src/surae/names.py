"""The names that users choose among, written once: help shows them without loading what they name.

`tests/test_names.py` holds them to what they name.
"""

MODELS = (
    "muscle",
    "muscle-tendon",
    "muscle-tendon-strain",
    "muscle-tendon-toe",
    "muscle-2010",
)
#: The family of models that is searched, and what a fit may be asked.
AUTO = "auto"
FITTED = (AUTO, *MODELS)
#: What of the laboratory's imperfections `auto` takes in.
NUISANCES = ("all", "none")
LOSSES = ("huber", "soft-l1", "tukey")
POPULATIONS = ("healthy", "patient")
NORMALISATIONS = ("session", "mvc")
FOOT_SHARES = ("winter", "de-leva-female", "de-leva-male")
#: Whose the table of a geometry is.
GEOMETRY_OF = ("generic", "person")
#: Languages of the page for clinicians.
LANGUAGES = ("en", "nl", "de", "fr")
#: What a peak is one of, where peaks count more.
ACTIVITIES = ("torque", "emg")
#: Switches of the models that are a choice; the first is the default.
CHOICES = {
    "geometry": ("thesis", "virtual-work"),
    "tendon_strain": ("thesis", "slack-length"),
    "integrator": ("implicit", "explicit-euler"),
}
