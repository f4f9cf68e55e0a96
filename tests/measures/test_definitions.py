"""Every measure of a leg against the same computed anew: the printed equations in small steps."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize, signal

from surae.base.errors import InputError
from surae.measures import DEFINITIONS, measures_of_values
from surae.measures.leg import ZERO, Leg, NotDefinedError
from surae.measures.passive import end_torque, passive_torque, tendon_secant
from surae.model import ModelOptions, get_model, with_optional
from surae.studies import virtual_subject

STEP = 1e-3  # degrees
SLACK = {"tri": 0.415, "tib": 0.216}


def random_leg(seed: int) -> dict[str, float]:
    drawn = virtual_subject(900 + seed, "patient" if seed % 2 else "healthy", tendons=True)
    return {**drawn.parameters, **drawn.tendons, "emd": 0.04}


def arm(group: str, angle: float) -> float:
    return 0.0480 - 0.0104 * angle if group == "tri" else 0.0393 + 0.0171 * angle


def length(group: str, angle: float) -> float:
    l_m, factor = (0.118, 1.67) if group == "tri" else (0.136, 1.56)
    return l_m - factor * arm(group, angle)


def lift(p, group: str, x: float) -> float:
    l0 = p[f"l0_{group}"]
    side = "short" if x < l0 else "long"
    return np.exp(-((x - l0) ** 2) / (0.1 * l0**2 * np.exp(2 * p.get(f"fl_{side}_{group}", 0))))


def tendon(p, group: str, e: float) -> float:
    f_max, eps, toe, k = (8000.0 if group == "tri" else 1400.0), p[f"dlt_{group}"], None, 4.0
    toe = p[f"pt_{group}"]
    grown = np.exp(k)
    e_toe = eps * toe * k * grown / (grown * (1 - toe + toe * k) + toe - 1)
    k_lin = f_max / eps * (1 - toe + toe * k * grown / (grown - 1))
    if e <= 0:
        return 0.0
    if e <= e_toe:
        return toe * f_max / (grown - 1) * (np.exp(k * e / e_toe) - 1)
    return k_lin * (e - e_toe) + toe * f_max


def force(p, group: str, degrees: float, alpha: float = 0.0, relaxed: bool = True, kept=None):
    """Force on the tendon; before relaxing, tissue keeps what `kept` had relaxed of its force."""
    angle = np.radians(degrees)
    whole = length(group, angle)

    def muscle(x: float) -> float:
        elastic = np.exp(p[f"k_{group}"] * (x - p[f"x0_{group}"]))
        held = elastic / (1 + p["k_rel"]) if relaxed else elastic - kept
        return held + alpha * lift(p, group, x)

    if "dlt_tri" not in p:
        return muscle(whole), whole
    balance = lambda e: tendon(p, group, e) - muscle(whole - e)  # noqa: E731
    e = optimize.brentq(balance, 0.0, 0.2, xtol=1e-15, rtol=1e-14)
    return tendon(p, group, e), whole - e


def torque(p, group: str, degrees: float, **how) -> float:
    return arm(group, np.radians(degrees)) * force(p, group, degrees, **how)[0]


def both(p, degrees: float, **how) -> float:
    return torque(p, "tri", degrees, **how) - torque(p, "tib", degrees, **how)


def slope(function, at: float) -> float:
    return (function(at + STEP) - function(at - STEP)) / (2 * STEP)


def quick(p, at: float) -> float:
    total = 0.0
    for group, sign in (("tri", 1.0), ("tib", -1.0)):
        x = force(p, group, at)[1]
        elastic = np.exp(p[f"k_{group}"] * (x - p[f"x0_{group}"]))
        kept = elastic * p["k_rel"] / (1 + p["k_rel"])
        total += sign * slope(lambda a: torque(p, group, a, relaxed=False, kept=kept), at)  # noqa: B023
    return total


def active(p, group: str, degrees: float, alpha: float) -> float:
    return torque(p, group, degrees, alpha=alpha) - torque(p, group, degrees)


def optimal_angle(p, group: str) -> float:
    return optimize.brentq(lambda a: force(p, group, a)[1] - p[f"l0_{group}"], -150, 150)


def expected(p) -> dict[str, float]:
    told = {}
    for at in (-10.0, 0.0, 10.0):
        point = f"@{at:g}deg"
        told |= {
            f"passive_torque{point}": both(p, at),
            f"passive_torque_tri{point}": torque(p, "tri", at),
            f"passive_torque_tib{point}": torque(p, "tib", at),
            f"passive_stiffness{point}": slope(lambda a: both(p, a), at),
            f"passive_stiffness_tri{point}": slope(lambda a: torque(p, "tri", a), at),
            f"passive_stiffness_tib{point}": -slope(lambda a: torque(p, "tib", a), at),
            f"quick_stiffness{point}": quick(p, at),
        }
    told["neutral_angle"] = optimize.brentq(lambda a: both(p, a), -70, 50)
    for group in ("tri", "tib"):
        l_m, factor = (0.118, 1.67) if group == "tri" else (0.136, 1.56)
        r0, r1 = (0.0480, -0.0104) if group == "tri" else (0.0393, 0.0171)
        told[f"slack_angle_{group}"] = np.degrees(((l_m - p[f"x0_{group}"]) / factor - r0) / r1)
        told[f"optimal_angle_{group}"] = optimal_angle(p, group)
        weights = ("g2", "g3", "g4") if group == "tri" else ("g1",)
        per_volt = lift(p, group, force(p, group, 0.0)[1]) * sum(p[w] for w in weights)
        told[f"torque_per_emg_{group}"] = 1e-3 * arm(group, 0) * per_volt
        travel = abs(length(group, 1e-6) - length(group, -1e-6)) / 2e-6
        told[f"passive_exponent_{group}"] = p[f"k_{group}"] * travel
        wide = [np.exp(p.get(f"fl_{side}_{group}", 0.0)) for side in ("short", "long")]
        reach = np.sqrt(0.1) * p[f"l0_{group}"] * np.mean(wide)
        told[f"active_width_{group}"] = np.degrees(reach / travel)
        beyond = force(p, group, 0.0)[1] - p[f"l0_{group}"]
        told[f"working_point_{group}"] = np.degrees(beyond / travel)
        muscles = ("gl", "sol", "gm") if group == "tri" else ("ta",)
        for muscle, weight in zip(muscles, weights, strict=True):
            told[f"torque_gain_{muscle}"] = arm(group, 0) * p[weight]
        if "dlt_tri" in p:
            at = 25.0 if group == "tri" else 4.0

            def missing(e: float, group=group, at=at) -> float:
                return arm(group, 0) * tendon(p, group, e) - at

            e = optimize.brentq(missing, 0.0, 0.1, xtol=1e-15)
            per_length = (missing(e + 1e-8) - missing(e - 1e-8)) / 2e-8
            turned = np.radians(per_length * travel)
            told[f"tendon_rotational_stiffness_{group}@{at:g}Nm"] = turned
    relaxation = signal.TransferFunction([p["tau_rel"], 1], [p["tau_rel"], 1 + p["k_rel"]])
    t = np.linspace(0, 10, 20001)
    response = signal.step(relaxation, T=t)[1]
    told["relaxed_share@10s"] = 100 * (1 - response[-1])
    w0 = 2 * np.pi * p["f0"]
    filter_ = signal.TransferFunction([w0**2], [1, 2 * p["beta"] * w0, w0**2])
    t = np.linspace(0, 2, 40001)
    told["activation_half_time"] = 1e3 * np.interp(0.5, signal.step(filter_, T=t)[1], t)
    w, h = signal.freqs(filter_.num, filter_.den, np.linspace(0.1, 60, 200_000))
    told["bandwidth"] = w[np.argmin(abs(abs(h) - np.sqrt(0.5)))] / (2 * np.pi)
    told["delay"] = 40.0
    alpha = optimize.brentq(lambda a: active(p, "tri", 0.0, a) - 20.0, 0, 5e4)
    told["active_stiffness@20Nm"] = slope(lambda a: torque(p, "tri", a, alpha=alpha), 0.0)
    if "dlt_tri" in p:
        for group, at in (("tri", 500.0), ("tib", 100.0)):
            e = optimize.brentq(lambda e: tendon(p, group, e) - at, 0, 0.1, xtol=1e-15)  # noqa: B023
            curve = (tendon(p, group, e + 1e-8) - tendon(p, group, e - 1e-8)) / 2e-8
            told[f"tendon_stiffness_{group}@{at:g}N"] = 1e-3 * curve
            told[f"tendon_strain_{group}@{at:g}N"] = 100 * e / SLACK[group]
    return told


@pytest.mark.parametrize("compliant", [False, True])
@pytest.mark.parametrize(
    "seed", [*range(3), *(pytest.param(s, marks=pytest.mark.slow) for s in range(3, 10))]
)
def test_measures_are_what_small_steps_of_the_printed_equations_give(seed, compliant) -> None:
    p = random_leg(seed)
    if compliant and seed == 1:  # curves of its own
        p |= {"fl_short_tri": 0.5, "fl_long_tri": -0.6, "fl_short_tib": -0.4, "fl_long_tib": 0.3}
    if not compliant:
        p = {n: v for n, v in p.items() if not n.startswith(("dlt", "pt"))}
    told = measures_of_values(p, "muscle-tendon" if compliant else "muscle")
    truth = expected(p)
    below = ("dissipated", "damping", "slow_", "range_at_torque", "stiffness_at_torque")
    tested_below = {n for n in told if n.startswith(below)}
    assert set(told) - tested_below == set(truth)
    for name, value in truth.items():
        assert told[name] == pytest.approx(value, rel=5e-3), name


def test_the_range_at_a_torque_is_where_the_equations_have_it() -> None:
    slopes = 0
    for seed in range(10):
        p = {n: v for n, v in random_leg(seed).items() if not n.startswith(("dlt", "pt"))}
        told = measures_of_values(p, "muscle")
        for name, at in told.items():
            if name.startswith("range_at_torque"):
                wanted = float(name.partition("@")[2].removesuffix("Nm"))
                assert both(p, at) == pytest.approx(wanted, rel=5e-3)
        if "stiffness_at_torque@10Nm" in told:
            at = told["range_at_torque@10Nm"]
            slope = (both(p, at + 0.05) - both(p, at - 0.05)) / 0.1
            assert told["stiffness_at_torque@10Nm"] == pytest.approx(slope, rel=1e-2)
            slopes += 1
    assert slopes


@pytest.mark.parametrize("compliant", [False, True])
def test_the_end_of_the_range_is_where_it_was_moved_to(compliant) -> None:
    p = random_leg(4)
    if not compliant:
        p = {n: v for n, v in p.items() if not n.startswith(("dlt", "pt"))}
    name = "muscle-tendon" if compliant else "muscle"
    spec, low, high = with_optional(get_model(name), p), -38.0, 13.0
    whole = dict(zip(spec.names, spec.vector(p, ModelOptions()).tolist(), strict=True))
    leg = Leg(spec, ModelOptions(), whole, moved=(low, high))
    alone = replace(leg, moved=None)
    slack = measures_of_values(p, name)["slack_angle_tri"]
    rise = both(p, high) - both(p, low)
    truth = {
        "end_torque": both(p, high),
        "end_stiffness": (both(p, high) - both(p, high - 10.0)) / 10.0,
        "end_stiffness_tib": (torque(p, "tib", high - 10.0) - torque(p, "tib", high)) / 10.0,
        "end_torque_tri": torque(p, "tri", high),
        "torque_rise": rise,
        "slack_before_end_tri": high - slack,
        "optimum_before_end_tri": high - optimal_angle(p, "tri"),
        "optimum_before_end_tib": optimal_angle(p, "tib") - low,
        "shortest_length_tri": 100.0 * force(p, "tri", low)[1] / p["l0_tri"],
        "longest_length_tri": 100.0 * force(p, "tri", high)[1] / p["l0_tri"],
        "shortest_length_tib": 100.0 * force(p, "tib", high)[1] / p["l0_tib"],
        "longest_length_tib": 100.0 * force(p, "tib", low)[1] / p["l0_tib"],
    }
    for each in DEFINITIONS:
        if each.name in truth:
            assert each.value(leg, np.inf) == pytest.approx(truth[each.name], rel=5e-3), each.name
            with pytest.raises(NotDefinedError, match="how far"):
                each.value(alone, np.inf)
            with pytest.raises(NotDefinedError, match="hardly moved"):
                each.value(replace(leg, moved=(high - 1.0, high)), np.inf)
        if each.name == "end_torque":  # at an end that another session has
            assert each.value(leg, 5.0) == pytest.approx(both(p, 5.0), rel=5e-3)
            assert each.span(leg, 5.0) == (5.0, 5.0)


@pytest.mark.parametrize("off", [0.0, 0.06])
def test_stiffness_is_of_the_joint_and_not_of_its_muscles_alone(off) -> None:
    """Tissue beside the muscles, and a zero of the angle that is not the ankle's own."""
    p = {n: v for n, v in random_leg(2).items() if not n.startswith(("dlt", "pt"))}
    tissue = {"joint_stiffness": 2.0, "joint_torque": 0.3, "joint_damping": 0.2}
    spec = with_optional(get_model("muscle"), [*p, *tissue])
    whole = dict(zip(spec.names, spec.vector(p | tissue, ModelOptions()).tolist(), strict=True))
    leg = Leg(spec, ModelOptions(), {**whole, ZERO: off}, moved=(-40.0, 15.0))

    def joint(degrees: float) -> float:
        shown = degrees + np.degrees(off)
        return both(p, shown) + 2.0 * (np.radians(shown) + 0.26) + 0.3

    told = {each.name: each for each in DEFINITIONS}
    wanted = {
        "passive_torque": joint(10.0),
        "passive_stiffness": slope(joint, 10.0),
        "passive_torque_tri": torque(p, "tri", 10.0 + np.degrees(off)),
        "neutral_angle": optimize.brentq(joint, -60, 40),
        "joint_stiffness": np.radians(2.0),
    }
    for name, value in wanted.items():
        assert told[name].value(leg, 10.0) == pytest.approx(value, rel=5e-3), name
    end = 15.0 - np.degrees(off)
    assert told["end_torque"].value(leg, np.inf) == pytest.approx(joint(end), rel=1e-6)
    plain = Leg(spec, ModelOptions(), {**whole, "joint_damping": 0.0, ZERO: off})
    lost = [1e-3 * told["dissipated_energy"].value(each, 0.0) for each in (leg, plain)]
    assert lost[0] - lost[1] == pytest.approx(0.2 * np.radians(10) * np.radians(60), rel=0.03)
    slow = told["slow_torque"].value(leg, 10.0) - told["slow_torque"].value(plain, 10.0)
    assert slow == pytest.approx(0.2 * np.radians(5), rel=0.01)
    bare = Leg(get_model("muscle"), ModelOptions(), p)
    with pytest.raises(NotDefinedError, match="no tissue beside"):
        told["joint_stiffness"].value(bare, 0.0)


@pytest.mark.parametrize("compliant", [False, True])
def test_damping_is_what_a_slow_movement_adds(compliant) -> None:
    """Torque in slow lengthening less that in slow shortening, the tendon's part included."""
    p, (fast, curve, more) = random_leg(3), (0.2, -0.3, 0.25) if compliant else (0.0, 0.0, 0.0)
    if compliant:
        p |= {"fl_short_tri": 0.3, "fv_speed": fast, "fv_curve": curve, "fv_stretch": more}
    else:
        p = {n: v for n, v in p.items() if not n.startswith(("dlt", "pt"))}
    told = measures_of_values(p, "muscle-tendon" if compliant else "muscle")["damping@20Nm"]
    alpha = optimize.brentq(lambda a: active(p, "tri", 0.0, a) - 20.0, 0, 5e4)
    vmax, speed = 8 * p["l0_tri"] * np.exp(fast), 1e-3  # rad/s
    bend, gain = 0.25 * np.exp(curve), 0.5 * np.exp(more)

    def moving(sign: float) -> float:
        x_slow = [force(p, "tri", np.degrees(a), alpha=alpha)[1] for a in (-1e-4, 1e-4)]
        v = sign * speed * (x_slow[1] - x_slow[0]) / 2e-4
        longer = 1 + (1 + 0.5 * bend) * gain * v / (0.5 * bend * vmax + v)
        f_v = (v + vmax) / (vmax - v / bend) if v < 0 else longer
        return torque(p, "tri", 0.0, alpha=alpha * f_v)

    # the force that velocity adds stretches the tendon: its part of it is taken up at once
    lengthening, shortening = moving(1.0), moving(-1.0)
    expected_damping = np.radians((lengthening - shortening) / (2 * speed))
    assert told == pytest.approx(expected_damping, rel=5e-3)


def test_a_slow_stretch_costs_what_its_loop_encloses() -> None:
    p = {n: v for n, v in random_leg(2).items() if not n.startswith(("dlt", "pt"))}
    told = measures_of_values(p, "muscle")["dissipated_energy"]
    dt = 1e-3
    there = np.arange(-20.0, 10.0, 10.0 * dt)
    degrees = np.concatenate([there, there[::-1]])
    total = np.zeros(len(degrees))
    for group, sign in (("tri", 1.0), ("tib", -1.0)):
        angle = np.radians(degrees)
        elastic = np.exp(p[f"k_{group}"] * (length(group, angle) - p[f"x0_{group}"]))
        z = elastic[0] * p["k_rel"] / (1 + p["k_rel"])
        for i, f0 in enumerate(elastic):
            total[i] += sign * arm(group, angle[i]) * max(f0 - z, 0.0)  # (11): no push
            z += dt / p["tau_rel"] * (p["k_rel"] * f0 - (1 + p["k_rel"]) * z)
    assert told == pytest.approx(1e3 * np.trapezoid(total, np.radians(degrees)), rel=5e-3)


def test_a_slow_stretch_meets_what_has_not_relaxed_yet() -> None:
    p = {n: v for n, v in random_leg(5).items() if not n.startswith(("dlt", "pt"))}
    told = measures_of_values(p, "muscle", angles=[10.0])
    dt = 2e-3
    degrees = np.arange(-30.0, 12.0, 5.0 * dt)
    total = np.zeros(len(degrees))
    for group, sign in (("tri", 1.0), ("tib", -1.0)):
        angle = np.radians(degrees)
        elastic = np.exp(p[f"k_{group}"] * (length(group, angle) - p[f"x0_{group}"]))
        z = elastic[0] * p["k_rel"] / (1 + p["k_rel"])
        for i, f0 in enumerate(elastic):
            total[i] += sign * arm(group, angle[i]) * max(f0 - z, 0.0)  # (11): no push
            z += dt / p["tau_rel"] * (p["k_rel"] * f0 - (1 + p["k_rel"]) * z)
    assert told["slow_torque@10deg"] == pytest.approx(np.interp(10, degrees, total), rel=5e-3)
    by = np.interp([9, 11], degrees, total)
    assert told["slow_stiffness@10deg"] == pytest.approx((by[1] - by[0]) / 2, rel=5e-3)
    assert told["slow_torque@10deg"] > told["passive_torque@10deg"]


@pytest.mark.parametrize("compliant", [False, True])
def test_strength_is_that_of_the_recordings(clean, compliant) -> None:
    p = random_leg(3)
    if not compliant:
        p = {n: v for n, v in p.items() if not n.startswith(("dlt", "pt"))}
    spec = get_model("muscle-tendon-toe" if compliant else "muscle")
    p = {n: v for n, v in p.items() if n in spec.names}
    vector = spec.vector(p, ModelOptions())
    values = dict(zip(spec.names, vector.tolist(), strict=True))
    leg = Leg(spec, ModelOptions(), values, (clean,), moved=(-40.0, 20.0))
    _, _, states = spec.simulator(clean, ModelOptions()).split(vector)
    told = {d.name: d.value(leg, 0.0) for d in DEFINITIONS if d.name.startswith("maximal")}
    for i, group in enumerate(("tri", "tib")):
        alpha = np.percentile(states[i], 99.0)
        torques = [abs(active(p, group, a, alpha)) for a in np.arange(-40.0, 20.1, 0.5)]
        assert told[f"maximal_torque_{group}"] == pytest.approx(max(torques), rel=2e-3)
    for each in DEFINITIONS:
        if each.name in told:
            with pytest.raises(NotDefinedError):
                each.value(replace(leg, inputs=()), 0.0)


def test_every_measure_says_what_it_is() -> None:
    names = [definition.name for definition in DEFINITIONS]
    assert len(set(names)) == len(names)
    for definition in DEFINITIONS:
        assert definition.meaning.endswith("."), definition.name
        assert definition.formula, definition.name


@pytest.mark.slow
def test_python_without_docstrings_says_it_too() -> None:
    told = "from surae.measures import DEFINITIONS as D; print([d.meaning + d.formula for d in D])"
    run = subprocess.run([sys.executable, "-OO", "-c", told], capture_output=True, check=True)
    assert run.stdout.decode().strip() == str([d.meaning + d.formula for d in DEFINITIONS])


@pytest.mark.parametrize("angle", [61, float("nan"), "10", True])
def test_an_angle_that_no_ankle_has_is_refused(angle) -> None:
    with pytest.raises(InputError, match="angle"):
        measures_of_values(random_leg(1), "muscle-tendon", angles=[angle])


def test_a_tendons_secant_is_that_of_its_curve_over_the_recordings_force(clean) -> None:
    p, options = random_leg(1), ModelOptions()
    spec = get_model("muscle-tendon-toe")
    vector = spec.vector({n: v for n, v in p.items() if n in spec.names}, options)
    leg = Leg(spec, options, dict(zip(spec.names, vector.tolist(), strict=True)), (clean,))
    pull = spec.simulator(clean, options).tendon(vector).tendon_force
    for group, most in zip(("tri", "tib"), np.percentile(pull, 99.0, axis=1), strict=True):
        low, high = (
            optimize.brentq(lambda e, f=part * most: tendon(p, group, e) - f, 0, 0.1)  # noqa: B023
            for part in (0.2, 0.8)
        )
        told = next(d for d in DEFINITIONS if d.name == f"tendon_secant_{group}").value(leg, 0.0)
        assert told == pytest.approx(1e-3 * 0.6 * most / (high - low), rel=1e-3)


def test_the_largest_activity_is_as_the_torque_tells_where_a_gain_drifts(clean) -> None:
    p, options = random_leg(1), ModelOptions()
    spec = get_model("muscle")
    own = {name: value for name, value in p.items() if name in spec.names}
    plain = Leg(spec, options, own, (clean,))
    told = Leg(spec, options, own, (clean,), gained=(0.9, 1.2)).with_values({"g1": 2.0 * own["g1"]})
    largest = told.largest_activity
    assert largest["tri"] == pytest.approx(0.9 * plain.largest_activity["tri"])
    assert largest["tib"] == pytest.approx(2.4 * plain.largest_activity["tib"])


def test_a_filmed_fascicle_has_an_optimal_length_of_its_own_and_an_unfilmed_one_none() -> None:
    optimal = next(d for d in DEFINITIONS if d.name == "optimal_fascicle_tib").value
    spec = get_model("muscle")
    own = {name: value for name, value in random_leg(1).items() if name in spec.names}
    own["l0_tib"] = 0.07
    filmed = own | {"film_scale_tib": 0.02, "film_zero_tib": -3e-3}
    assert optimal(Leg(spec, ModelOptions(), filmed), 0.0) == pytest.approx(68.4)
    with pytest.raises(NotDefinedError, match="not filmed"):
        optimal(Leg(spec, ModelOptions(), own), 0.0)
    with pytest.raises(NotDefinedError, match="rigid"):
        tendon_secant(Leg(spec, ModelOptions(), own), 0.0, "tib")


def test_the_end_of_a_movement_is_where_the_ankle_was() -> None:
    """Its torque was measured there: an axis beside the device's turns the ankle by another angle.

    The foot points to its strap, 0.15 m from the device's axis, from wherever the ankle is.
    """
    whole = {n: v for n, v in random_leg(2).items() if not n.startswith(("dlt", "pt"))}
    spec = get_model("muscle")
    forward, up = 0.01, -0.005
    leg = Leg(
        spec, ModelOptions(), whole | {"axis_forward": forward, "axis_up": up}, moved=(-30.0, 20.0)
    )

    def turned(degrees: float) -> float:
        strap = 0.15 * np.exp(1j * np.radians(degrees)) - complex(forward, up)
        return float(np.degrees(np.angle(strap) - np.angle(0.15 - complex(forward, up))))

    assert leg.range_to(np.inf) == (-30.0, 20.0)
    assert leg.turned(20.0) == pytest.approx(turned(20.0))
    assert leg.turned(20.0) != pytest.approx(20.0, abs=0.5)
    straight = Leg(spec, ModelOptions(), whole, moved=(-30.0, 20.0))
    assert straight.turned(20.0) == 20.0
    assert end_torque(leg, np.inf) == pytest.approx(passive_torque(straight, turned(20.0)))
