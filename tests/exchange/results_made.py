"""Results of other programs in their layouts, made up, with planted and with honest values."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

Values = Mapping[str, Mapping[str, float]]


def osimx_text(muscles: Values, model: str = "") -> str:
    """NMSM's .osimx: what its tool has found of each muscle, in its own units."""
    made = "".join(
        f'<RCNLMuscle name="{name}">'
        + "".join(f"<!--Optimized--><{tag}>{v!r}</{tag}>" for tag, v in values.items())
        + "</RCNLMuscle>"
        for name, values in muscles.items()
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n<NMSMPipelineDocument Version="1_dot_5_dot_0">'
        f'<OsimxModel name="made"><associated_osim_model>{model}</associated_osim_model>'
        f"<RCNLMuscleSet>{made}</RCNLMuscleSet></OsimxModel></NMSMPipelineDocument>"
    )


def sto_text(muscles: Values) -> str:
    """NMSM's muscleModelParameters.sto: six rows, a column for each muscle."""
    rows = (
        "activation_time_constant",
        "activation_nonlinearity_constant",
        "electromechanical_delay",
        "emg_scale_factor",
        "optimal_fiber_length",
        "tendon_slack_length",
    )
    head = ["muscleModelParameters", "version=1", f"nRows={len(rows)}", "inDegrees=no", "endheader"]
    names = "\t".join(["time", *muscles])
    body = [
        "\t".join([f"{place}", *(f"{values[row]!r}" for values in muscles.values())])
        for place, row in enumerate(rows, start=1)
    ]
    return "\n".join([*head, names, *body]) + "\n"


def subject_text(muscles: Values, began: str = "", *, old: bool = False) -> str:
    """CEINMS' subject, of its schema, or of the layout before it."""
    outer, inner = ("muscles", "muscle") if old else ("mtuSet", "mtu")
    made = "".join(
        f"<{inner}><name>{name}</name>"
        + "".join(f"<{tag}>{value!r}</{tag}>" for tag, value in values.items())
        + f"</{inner}>"
        for name, values in muscles.items()
    )
    calibrated = (
        f"<calibrationInfo><calibrated><startSubjectFile>{began}</startSubjectFile>"
        "</calibrated></calibrationInfo>"
        if began
        else ""
    )
    default = "<mtuDefault><emDelay>0.02</emDelay><percentageChange>0.15</percentageChange>"
    return (
        '<?xml version="1.0" encoding="UTF-8" standalone="no" ?>\n<subject>'
        f"{default}</mtuDefault><{outer}>{made}</{outer}>{calibrated}</subject>"
    )


def calibration_text(ranges: Mapping[str, tuple[bool, float, float]]) -> str:
    """CEINMS' calibration, with the limits of its search."""
    made = "".join(
        f"<parameter><name>{name}</name><single/>"
        f"<{'relativeToSubjectValue' if part else 'absolute'}><range>{low} {high}</range>"
        f"</{'relativeToSubjectValue' if part else 'absolute'}></parameter>"
        for name, (part, low, high) in ranges.items()
    )
    return (
        "<calibration><calibrationSteps><step><parameterSet>"
        f"{made}</parameterSet></step></calibrationSteps></calibration>"
    )


def redundancy_mat(
    path: Path,
    names: list[str],
    began: Mapping[str, list[float]],
    scales: Mapping[str, list[float]],
    bounds: Mapping[str, tuple[float, float]],
) -> None:
    """MuscleRedundancySolver's results, as it saves them."""
    import scipy.io

    original = {name: np.array([values]) for name, values in began.items()}
    found = {
        name: np.array([np.array(values) * np.array(scales.get(name, np.ones(len(values))))])
        for name, values in began.items()
    }
    limits = {name: {"lb": low, "ub": high} for name, (low, high) in bounds.items()}
    names_cell = np.array(names, dtype=object)
    scipy.io.savemat(
        path,
        {
            "Results": {
                "Param": {"Original": original, "Estimated": found, "Bound": limits},
                "MuscleNames": names_cell,
            },
            "Misc": {"allMuscleList": names_cell},
        },
    )
