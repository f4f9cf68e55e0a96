"""What muscles of adults are like, and what public models say of them before anybody is measured.

Fibre lengths of 21 legs: S. R. Ward, C. M. Eng, L. H. Smallwood, R. L. Lieber (2009).
Are current measurements of lower extremity muscle architecture accurate? Clinical Orthopaedics and
Related Research 467(4):1074-1082. Generic values: S. L. Delp et al. (1990), IEEE Transactions on
Biomedical Engineering 37(8):757-767, as gait2392 has them; A. Rajagopal et al. (2016), IEEE
Transactions on Biomedical Engineering 63(10):2068-2079, and as A. K. M. Lai, A. S. Arnold,
J. M. Wakeling (2017), Annals of Biomedical Engineering 45(12):2762-2774, changed them.
"""

#: Normalised fibre length, mean and standard deviation [mm].
WARD = {
    "rectus femoris": (75.9, 12.8),
    "vastus lateralis": (99.4, 17.6),
    "vastus intermedius": (99.3, 20.3),
    "vastus medialis": (96.8, 23.0),
    "biceps femoris long head": (97.6, 26.2),
    "biceps femoris short head": (110.3, 20.6),
    "semitendinosus": (193.0, 41.2),
    "semimembranosus": (69.0, 18.3),
    "sartorius": (403.0, 46.3),
    "gracilis": (227.8, 43.7),
    "tibialis anterior": (68.3, 7.9),
    "extensor hallucis longus": (74.8, 11.3),
    "extensor digitorum longus": (69.3, 11.4),
    "peroneus longus": (50.8, 6.3),
    "peroneus brevis": (45.4, 6.5),
    "gastrocnemius medialis": (51.0, 9.8),
    "gastrocnemius lateralis": (58.8, 9.5),
    "soleus": (44.0, 9.9),
    "flexor hallucis longus": (52.7, 12.9),
    "flexor digitorum longus": (44.6, 10.6),
    "tibialis posterior": (37.8, 4.9),
}
#: Standard deviations from the mean that no adult of so many is beyond; and what models in use
#: have, of older legs, which is not called impossible [mm].
BEYOND = 3.0
OLDER = {
    "tibialis anterior": 98.0,
    "extensor hallucis longus": 111.0,
    "extensor digitorum longus": 102.0,
    "gastrocnemius": 61.0,
    "biceps femoris short head": 173.0,
    "gracilis": 352.0,
    "sartorius": 579.0,
    "semimembranosus": 80.0,
    "rectus femoris": 114.0,
}
#: Mass of the adults [kg], below whose cube root of the ratio a smaller leg's muscles are shorter.
MASS = 75.0
#: Strain of a tendon at the muscle's largest force; of the Achilles tendon at maximal effort some 4
#: to 10 % (Maganaris and Paul 2002, Journal of Biomechanics 35:1639-1646; Magnusson et al. 2001,
#: Acta Physiologica Scandinavica 177:185-195).
STRAIN = (0.01, 0.15)
#: From EMG's onset to force [s] (Cavanagh and Komi 1979, European Journal of Applied Physiology
#: 42:159-163: 49 ms, in other muscles 30 to 100).
DELAY = (0.0, 0.13)
#: Pennation beyond which a fibre hardly pulls along its tendon [rad].
PENNATION = (0.0, 0.8)

#: Generic values: fibre [m], tendon [m], force [N], by model and muscle.
GENERIC = {
    "gait2392": {
        "soleus": (0.05, 0.25, 3549.0),
        "gastrocnemius medialis": (0.06, 0.39, 1558.0),
        "gastrocnemius lateralis": (0.064, 0.38, 683.0),
        "tibialis anterior": (0.098, 0.223, 905.0),
    },
    "gait2354": {
        "soleus": (0.05, 0.25, 4000.0),
        "gastrocnemius medialis": (0.09, 0.36, 2500.0),
        "tibialis anterior": (0.098, 0.223, 3000.0),
    },
    "gait10dof18musc": {
        "soleus": (0.05, 0.25, 5137.0),
        "gastrocnemius": (0.06, 0.39, 2500.0),
        "tibialis anterior": (0.098, 0.223, 3000.0),
    },
    "Rajagopal 2016": {
        "soleus": (0.044, 0.276755872373760, 6194.84262295082),
        "gastrocnemius medialis": (0.051, 0.398716332626330, 3115.51475409836),
        "gastrocnemius lateralis": (0.0588, 0.376070169933794, 1575.05901639344),
        "tibialis anterior": (0.0683, 0.240461026409367, 1227.45245901639),
    },
    "Rajagopal, Lai, Uhlrich 2023": {
        "soleus": (0.044, 0.28135, 6194.84262295082),
        "gastrocnemius medialis": (0.059, 0.387, 3115.51475409836),
        "gastrocnemius lateralis": (0.069, 0.374, 1575.05901639344),
        "tibialis anterior": (0.0683, 0.240461026409367, 1227.45245901639),
    },
}


def range_of(muscle: str, parameter: str, mass: float | None) -> tuple[float, float] | None:
    """What an adult's parameter can be; of a lighter person from less on; None: not known."""
    simple = {
        "tendon_strain": STRAIN,
        "electromechanical_delay": DELAY,
        "pennation_angle": PENNATION,
    }
    if parameter in simple:
        return simple[parameter]
    if parameter != "optimal_fiber_length":
        return None
    if muscle == "gastrocnemius":  # either head, or both in one
        both = [
            range_of(f"gastrocnemius {head}", parameter, mass) for head in ("medialis", "lateralis")
        ]
        ends = [end for each in both if each for end in each]
        return min(ends), max(*ends, 1e-3 * OLDER[muscle])
    if muscle not in WARD:
        return None
    mean, sd = WARD[muscle]
    smaller = 1.0 if mass is None else min((mass / MASS) ** (1.0 / 3.0), 1.0)
    low = max(mean - BEYOND * sd, 0.0) * smaller
    high = max(mean + BEYOND * sd, 1.05 * OLDER.get(muscle, 0.0))
    return 1e-3 * low, 1e-3 * high
