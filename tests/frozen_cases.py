"""The cases of frozen results: what legs are made, and which commands are run on them."""

#: Folder → what ``ankle-legs`` writes there.
LEGS = {
    "plain": "make p 11 --trials 1,2 --seconds 20",
    "leg": "make a 11 --trials 1,2,7 --seconds 20",
    "passive": "make a 11 --kind passive --seconds 20",
    "raw": "make b 12 --raw --seconds 20",
    "film": "make d 11 --film --seconds 20",
    "reflex": "make e 11 --seconds 20",
    "arms": "make f 11 --geometry --seconds 20",
    "plate": "make g 12 --seconds 20",
    "empty": "make h 13 --seconds 20",
    "soft": "make r 14 --trials 1,2 --seconds 20",
    "clipped": "make u 11 --seconds 20",
    "isometric": "make a 15 --kind isometric --seconds 20",
    "laboratory": "laboratory a 11 --active 1 --steps tare,zero,axis,geometry,slow,active",
    "perturbed": "make qb 3",
    "stretched": "make sa 3",
}

#: Mappings of measured files, by name.
MAPPINGS = {
    "filmed.toml": """name = "PL_0_01"
emg = "raw"
fixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }
[channels.angle]
file = "shared/repeats/PL_0_01.mat"
column = "Angle"
unit = "deg"
sign = -1
[channels.torque]
file = "shared/repeats/PL_0_01.mat"
column = "Torque"
unit = "Nm"
sign = -1
[channels.emg_ta]
file = "shared/repeats/PL_0_01.mat"
column = "EMG_TA"
unit = "V"
[channels.fascicle_tib]
file = "shared/ultrasound/PL_0_01_fascicles.csv"
column = "fascicle_superficial_mm"
unit = "mm"
""",
}

_P = "plain/p-11/trial-1.csv"
_A = "leg/a-11/trial-1.csv"
_TENDON = "--model muscle-tendon --starts 1"
#: Case → the command of ``surae``, whose output bears the case's name; other cases' outputs may be
#: what it reads.
CASES = {
    "muscle": f"fit {_P} --model muscle",
    "muscle-thesis": f"fit {_A} --model muscle --starts 2",
    "muscle-virtual-work": f"fit {_P} --model muscle --starts 2 --geometry virtual-work",
    "muscle-table": f"fit {_P} --model muscle --starts 1 --geometry data/geometry.csv",
    "muscle-wrist": f"fit {_P} --model muscle --starts 1 --joint wrist/joint.toml "
    "--geometry wrist/geometry.csv",
    "muscle-fixed": f"fit {_P} --model muscle --starts 2 --fixed beta=1 --bound m=1:4",
    "muscle-free": f"fit {_A} --model muscle --starts 2 --free emd --free reflex",
    "muscle-huber": f"fit {_A} --model muscle --starts 2 --loss huber",
    "muscle-tukey": f"fit {_A} --model muscle --starts 1 --loss tukey",
    "muscle-priors": f"fit {_P} --model muscle --starts 2 --priors healthy --prior tau_rel=2:0.5",
    "muscle-weighted": f"fit {_P} --model muscle --starts 2 --weight-peaks 4 --exclude 0:2",
    "muscle-prepared": f"fit {_P} --model muscle --starts 2 --prepared",
    "muscle-filtered": f"fit {_P} --model muscle --starts 1 --filter bessel_hz=10",
    "muscle-normalised": f"fit {_P} --model muscle --starts 2 --normalise session",
    "muscle-joint": "fit plain/p-11/trial-1.csv plain/p-11/trial-2.csv --model muscle --starts 2",
    "muscle-raw": "fit raw/b-12/trial-1.csv --model muscle --starts 1",
    "muscle-reference": "fit data/reference/muscle_patient.csv --model muscle --prepared",
    "muscle-2010": f"fit {_A} --model muscle-2010 --starts 2",
    "tendon": f"fit {_A} --model muscle-tendon --starts 2",
    "tendon-explicit": f"fit {_A} {_TENDON} --integrator explicit-euler",
    "tendon-slack-length": f"fit {_A} {_TENDON} --tendon-strain slack-length",
    "tendon-film": "fit film/d-11/trial-1.toml --model muscle-tendon-strain --starts 1",
    "tendon-strain": f"fit {_A} --model muscle-tendon-strain --starts 1",
    "tendon-toe": f"fit {_A} --model muscle-tendon-toe --starts 1",
    "auto": f"fit {_A}",
    "auto-plain": f"fit {_P}",
    "auto-alone": f"fit {_A} --nuisances none",
    "auto-fixed": f"fit {_A} --fixed tau_rel=1 --priors patient --angle-zero-sd 1",
    "auto-raw": "fit raw/b-12/trial-1.csv",
    "auto-film": "fit film/d-11/trial-1.toml",
    "auto-reflex": "fit reflex/e-11/trial-1.csv --free reflex",
    "auto-arms": "fit arms/f-11/trial-1.csv --geometry arms/f-11/geometry/geometry.csv "
    "--geometry-of person",
    "auto-plate": "fit plate/g-12/trial-1.csv",
    "auto-empty": "fit empty/h-13/trial-1.csv",
    "auto-clipped": "fit clipped/u-11/trial-1.csv",
    "auto-isometric": "fit isometric/a-15/trial-1.csv",
    "auto-joint": "fit leg/a-11/trial-1.csv leg/a-11/trial-2.csv",
    "auto-active-passive": "fit leg/a-11/trial-1.csv passive/a-11/trial-1.csv",
    "auto-soft": "fit soft/r-14/trial-1.csv soft/r-14/trial-2.csv",
    "auto-treated": "fit leg/a-11/trial-7.csv",
    "session": "session plain/p-11/trial-1.csv plain/p-11/trial-2.csv --workers 1",
    "session-known": "session laboratory/a-11 --workers 1",
    "measures": "measures auto.json",
    "measures-named": "measures muscle-thesis.json --angle 5",
    "measures-session": "measures session/",
    "change": "change auto.json auto-treated.json",
    "change-named": "change muscle.json muscle-joint.json",
    "reassessed": "reassess auto.json",
    "reassessed-named": "reassess tendon.json",
    "predicted": "validate auto.json leg/a-11/trial-2.csv",
    "checked": "check clipped/u-11/trial-1.csv --json",
    "simulated": f"simulate {_P} --parameters tendon.json",
    "profile": "profile muscle.json k_tri --workers 1",
    "posterior": "posterior muscle.json --draws 50 --evaluations 600 --workers 1",
    "exported": "export auto.json --to mjcf",
    "expected": "expect everything-35 --legs 2",
    "impedance": "impedance perturbed/qb-3/perturbed.csv --empty perturbed/qb-3/empty.csv",
    "stretches": "stretches stretched/sa-3/slow.csv",
    "measured": "fit shared/dynamometer/PL_50_01.toml",
    "measured-film": "fit filmed.toml --model muscle-tendon --starts 1",
    "measured-gait": "fit shared/gait/walk36.toml --exclude 10: --model muscle --starts 1",
    "measured-strides": "fit shared/strides/adult_00.csv shared/strides/adult_02.csv --model "
    "muscle --starts 1",
    "measured-impedance": "impedance shared/perturbed/dorsiflexing.csv --sign torque=-1",
}
