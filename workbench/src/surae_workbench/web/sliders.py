"""The modelled torque under the sliders, at once."""

import threading
from collections.abc import Mapping
from typing import Any

import numpy as np

from surae import api
from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae_workbench.web.caches import Cache
from surae_workbench.web.curves import plain
from surae_workbench.web.draft import Draft, spec_of, values_of

#: Longest signals that a slider simulates at their full rate; longer ones are thinned.
_RIGID = 400_000
_COMPLIANT = 12_000

#: Memory for simulators [bytes].
_KEPT = 300e6
_simulators: Cache[tuple[api.ModelInputs, api.Simulator, threading.Lock]] = Cache(
    _KEPT, lambda fewer_inputs: 250.0 * fewer_inputs[0].n
)


def live(
    inputs: api.ModelInputs,
    draft: Draft,
    values: Mapping[str, float],
    *,
    model: str | None,
    points: int,
    key: tuple[object, ...],
) -> dict[str, Any]:
    """The torque of a draft's model, or of another `model`, with some values changed.

    `values` are by parameter, all others the draft's; at most so many `points` are given; `key`,
    which begins with the recording, names `inputs`.
    """
    spec = spec_of(draft)
    options = api.ModelOptions.of(**draft["options"])
    if model is not None:
        spec = api.with_optional(api.get_model(model), set(values))
    for name in values:
        if name not in spec.names:
            known = ", ".join(spec.names)
            raise InputError(f"model {spec.name!r} has no parameter {name!r}; it has: {known}")
    table = api.adapted(spec.parameters, options, inputs.emg_unit)
    starts = {name: float(p.start) for name, p in table.items()}
    chosen = starts | values_of(draft, inputs.emg_unit, inputs.fixed) | dict(values)
    for name, p in table.items():
        api.check_value(p, chosen[name], spec)
    vector = np.array([chosen[name] for name in spec.names], dtype=float)

    def tie() -> tuple[api.ModelInputs, api.Simulator, threading.Lock]:
        most = _RIGID if spec.parent is None else _COMPLIANT
        fewer = api.thinned(inputs, -(-inputs.n // most)) if inputs.n > most else inputs
        return fewer, spec.simulator(fewer, options), threading.Lock()

    fewer_inputs, simulator, lock = _simulators.get((key, spec.name, spec.names, options), tie)
    with lock, np.errstate(all="ignore"):
        torque = simulator.torque(vector)
    shown = slice(None, None, max(-(-fewer_inputs.n // points), 1))
    r2 = rmse = None
    measured = fewer_inputs.torque
    if measured is not None:
        counted = _counted(fewer_inputs.time, draft["exclusions"].get(key[0], []))
        error = (measured - torque)[counted]
        followed = api.centred_r2([(measured[counted], error)])
        if np.isfinite(followed):
            r2 = followed
            rmse = float(np.sqrt(np.mean(error**2)))
    return {
        "t": plain(fewer_inputs.time[shown]),
        "modelled": plain(torque[shown]),
        "measured": None if measured is None else plain(measured[shown]),
        "r2": r2,
        "rmse": rmse,
    }


def _counted(times: FloatArray, spans: list[list[float]]) -> Any:
    counted = np.ones(len(times), dtype=bool)
    for begin, end in spans:
        counted &= ~((times >= begin) & (times <= end))
    return counted if counted.any() else np.ones(len(times), dtype=bool)


def warm() -> None:
    """Run every model once on a short made-up signal."""
    n = 128  # as many as filters need
    t = np.arange(n) / 128.0
    zeros = np.zeros(n)
    inputs = api.ModelInputs(
        name="warm",
        rate_hz=128.0,
        time=t,
        angle=0.1 * np.sin(t),
        velocity=0.1 * np.cos(t),
        acceleration=zeros,
        emg=np.full((n, 4), 1e-5),
        emg_unit="V",
        torque=zeros,
    )
    for spec in api.MODELS.values():
        options = api.ModelOptions()
        vector = np.array([p.start for p in api.adapted(spec.parameters, options).values()])
        simulator = spec.simulator(inputs, options)
        simulator.torque(vector)
        simulator.parts(vector)
