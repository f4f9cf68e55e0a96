"""Names to roles: what is plain is found, what is not is left open, and the rule is always said."""

import pytest

from surae.recording.recording import ROLES
from surae.recording.roles import CONFIDENCES, guess_role, heading_unit, is_plate_moment, words_of


@pytest.mark.parametrize(
    ("name", "role", "confidence", "side"),
    [
        ("torque_Nm", "torque", "stated", None),
        ("emg_ta_uV", "emg_ta", "stated", None),
        ("tib_ant_r", "emg_ta", "named", "right"),
        ("Tibialis anterior", "emg_ta", "named", None),
        ("R TIB.ANT.", "emg_ta", "named", "right"),
        ("EMG_TA", "emg_ta", "named", None),
        ("TA", "emg_ta", "likely", None),
        ("L_TA", "emg_ta", "likely", "left"),
        ("med_gas_r", "emg_gm", "named", "right"),
        ("GASTROC.MED", "emg_gm", "named", None),
        ("RGastrocMed", "emg_gm", "named", "right"),
        ("GM", "emg_gm", "likely", None),
        ("MG", "emg_gm", "likely", None),
        ("lat_gas_l", "emg_gl", "named", "left"),
        ("gastrocnemius lateralis", "emg_gl", "named", None),
        ("LG", "emg_gl", "likely", None),
        ("GL", "emg_gl", "likely", None),
        ("soleus_r", "emg_sol", "named", "right"),
        ("SOL", "emg_sol", "likely", None),
        ("Sóleo", "emg_sol", "named", None),
        ("Jambier antérieur", "emg_ta", "named", None),
        ("Enkelmoment", "torque", "named", None),
        ("Sprunggelenkswinkel", "angle", "named", None),
        ("ankle_angle_r", "angle", "named", "right"),
        ("AnkleAngle", "angle", "named", None),
        ("Position", "angle", "likely", None),
        ("ankle_angle_r_moment", "torque", "named", "right"),
        ("Torque", "torque", "likely", None),
        ("ankle_velocity", "angular_velocity", "named", None),
        ("ankle acceleration", "angular_acceleration", "named", None),
    ],
)
def test_plain_names_are_found(name, role, confidence, side):
    guess = guess_role(name)
    assert guess is not None
    assert (guess.role, guess.confidence, guess.side) == (role, confidence, side)
    assert guess.rule


@pytest.mark.parametrize(
    "name",
    [
        *("knee_angle_r", "subtalar_angle_r", "hip_flexion_r_moment", "Vastus medialis"),
        *("rect_fem_r", "tib_post_r", "GMED", "gluteus med", "semimem_r", "ACC.X 10", "GYRO.X 10"),
        *("DAC1_Myo", "pelvis_tx_force", "trigger", "M", "", "EMG ECG", "Keyboard"),
    ],
)
def test_other_joints_muscles_and_sensors_have_no_role(name):
    assert guess_role(name) is None


@pytest.mark.parametrize(
    ("name", "unit", "roles"),
    [
        ("Gastroc", None, ("emg_gl", "emg_gm")),
        ("tib", "mV", ("emg_ta",)),
        ("Sensor 10: EMG 10", "V", ("emg_ta", "emg_gl", "emg_sol", "emg_gm")),
        ("LoadCell", "Nm", ("torque",)),
        ("ch 3", "deg", ("angle",)),
    ],
)
def test_a_vague_name_is_only_possible(name, unit, roles):
    guess = guess_role(name, unit)
    assert guess is not None
    assert (guess.roles, guess.confidence) == (roles, "possible")


@pytest.mark.parametrize(
    ("name", "unit", "role", "confidence"),
    [
        ("TA", "g", "emg_ta", "possible"),
        ("TA", "Nm", "emg_ta", "possible"),
        ("SOL", "deg", "emg_sol", "possible"),
        ("Angle", "Nm", "angle", "possible"),
        ("Torque", "N", "torque", "likely"),
        ("Ankle Torque", "N", "torque", "likely"),
        ("Ankle Torque", "gibberish", "torque", "named"),
        ("Ankle Torque", "N-m", "torque", "named"),
        ("Ankle Torque", "Nm/kg", "torque", "named"),
        ("EMG SOL", "counts", "emg_sol", "named"),
    ],
)
def test_a_unit_that_is_not_known_or_anothers_never_takes_a_role_away(name, unit, role, confidence):
    guess = guess_role(name, unit)
    assert (guess.roles, guess.confidence) == ((role,), confidence)


def test_an_uncalibrated_sensor_keeps_its_role_and_asks_for_its_scale():
    guess = guess_role("Torque", "V")
    assert guess is not None
    assert guess.role == "torque"
    assert "scale" in guess.rule


@pytest.mark.parametrize(
    ("name", "unit"),
    [("MX1", "Nm"), ("Moment.Mz2", "N.mm"), ("ground_torque_x", None), ("FP1My", None)],
)
def test_a_moment_of_a_force_plate_is_no_torque_of_the_joint(name, unit):
    assert guess_role(name, unit) is None
    assert is_plate_moment(name, unit)


@pytest.mark.parametrize(("name", "unit"), [("Platform torque", "Nm"), ("LAnkleMoment", "Nmm")])
def test_what_moves_the_foot_is_no_force_plate(name, unit):
    guess = guess_role(name, unit)
    assert guess is not None
    assert guess.role == "torque"
    assert not is_plate_moment(name, unit)
    assert not is_plate_moment("FX1", "N")


def test_words():
    assert words_of("EMG_TA") == ("emg", "ta")
    assert words_of("ankleAngle_r") == ("ankle", "angle", "r")
    assert words_of("Bip1") == ("bip", "1")
    assert words_of("µ") == ("u",)


def test_whatever_the_name_a_guess_is_of_the_known_roles():
    from hypothesis import given, settings
    from hypothesis import strategies as st

    word = st.sampled_from(["ankle", "Torque", "emg", "TA", "gas", "lat", "L", "knee", "angle"])
    names = st.one_of(st.text(max_size=30), st.lists(word, max_size=4).map("_".join))
    units = st.one_of(st.none(), st.text(max_size=6), st.sampled_from(["V", "Nm", "deg", "g"]))

    @settings(max_examples=100)
    @given(names, units)
    def check(name, unit):
        guess = guess_role(name, unit)
        if guess is not None:
            assert set(guess.roles) <= set(ROLES)
            assert guess.confidence in CONFIDENCES
            assert guess.rule.isprintable() or not (unit or "").isprintable()

    check()


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("Angle (deg)", "deg"),
        ("Hoek [deg]", "deg"),
        ("Ankle angle ( ° )", "°"),
        ("Moment [N.m]", "N.m"),
        ("EMG_TA [µV]", "µV"),
        ("L GM (MVC) [%]", "%"),
        ("velocity (deg/s)", "deg/s"),
        ("ankle_angle_deg", "deg"),
        ("TA mV", "mV"),
        ("SOL_μV", "μV"),
    ],
)
def test_a_heading_may_end_with_its_unit(name, unit):
    assert heading_unit(name) == unit


@pytest.mark.parametrize(
    "name",
    [
        "Angle",
        "EMG (left)",
        "EMG (1)",
        "TA [2]",
        "(deg)",
        "deg",
        "angle_deg_target",
        "Force (N)",
        "grade",
        "ankle (deg) filtered",
        "torque_Nm_per_kg",
        "emg_ta_V",
        "gait_sv",
        "",
    ],
)
def test_what_is_no_unit_at_the_end_states_none(name):
    assert heading_unit(name) is None
