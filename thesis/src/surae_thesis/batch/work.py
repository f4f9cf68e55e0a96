"""A fit or session of a batch, a recording by itself, a simulation: functions of plain data."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

import surae
from surae import FitSettings, ModelInputs
from surae.api import SessionResult, checks_for
from surae.base.errors import SuraeError
from surae.base.records import from_plain
from surae.model import get_model
from surae.recording import MUSCLES, Recording
from surae_thesis.batch.places import Kept, keep, keep_folder
from surae_thesis.cohort.rules import spectrum
from surae_thesis.cohort.work import finite
from surae_thesis.legs import fit_trial, thesis_leg, with_noise

#: Frequencies at which a spectrum is kept [Hz].
FREQUENCIES = np.arange(0.125, 60.0, 0.125)
#: Distance of the angles at which a relaxed curve is kept [deg].
_STEP = 5.0
#: Part of the samples that are below what counts as a muscle's largest effort.
_LARGEST = 0.995
#: The parameters whose unit is the electrode's.
_WEIGHTS = tuple(f"g{number}" for number in range(1, 1 + len(MUSCLES)))
#: EMG at full effort, which the weights of virtual legs are meant for [V].
_FULL = 6e-4
#: Subjects of the simulations are none of the cohort's, nor of a study's.
_LEGS = 1_000_000

Plain = dict[str, Any]
#: Where a recording is, and how it is read: path, mapping, corrections.
Where = Mapping[str, Any]


@lru_cache(16)
def _read(path: str, mapping: str | None, corrections: str) -> Recording:
    return surae.read(path, mapping=mapping, **json.loads(corrections))


@lru_cache(32)
def _inputs(path: str, mapping: str | None, corrections: str, settings: FitSettings) -> ModelInputs:
    return settings.prepare(_read(path, mapping, corrections))


def fit_job(
    *, where: Where, settings: Plain, others: Mapping[str, Where], kept: Kept | None = None
) -> Plain:
    """Fit one recording by one model, and let it predict the subject's other recordings.

    What goes wrong is an outcome with a reason; Ctrl-C alone is raised.
    """
    return _timed(lambda: _fit(where, from_plain(FitSettings, settings), others, kept))


def session_job(
    *, name: str, each: Sequence[Where], settings: Plain, kept: Kept | None = None
) -> Plain:
    """Fit all recordings of a subject as a session: each, and all together, which stands for it.

    What goes wrong is an outcome with a reason; Ctrl-C alone is raised.
    """
    return _timed(lambda: _session(name, each, from_plain(FitSettings, settings), kept))


def _timed(job: Callable[[], Plain]) -> Plain:
    begin = time.perf_counter()
    try:
        outcome = job()
    except SuraeError as error:
        outcome = {"failed": str(error)}
    return {**outcome, "seconds": time.perf_counter() - begin}


def _session(name: str, each: Sequence[Where], settings: FitSettings, kept: Kept | None) -> Plain:
    paths = [where["path"] for where in each]
    given = json.loads(each[0]["corrections"])
    session = surae.session(paths, mapping=each[0]["mapping"], name=name, **given)
    made: list[SessionResult] = []

    def run(folder: Path | None) -> None:
        result = session.run(folder, settings, progress=lambda _: None)
        if result.interrupted:
            raise KeyboardInterrupt
        made.append(result)

    file = None
    if kept is None:
        run(None)
    else:
        file = keep_folder(kept, run)
    fit = made[0].main
    if fit is None:
        why = "; ".join(f"{trial}: {reason}" for trial, reason in made[0].failed.items())
        return {"failed": why or "no trial could be fitted", "file": file}
    return {**_outcome(fit), "file": file}


def _fit(
    where: Where, settings: FitSettings, others: Mapping[str, Where], kept: Kept | None
) -> Plain:
    recording = _read(**where)
    fit = surae.fit(recording, settings, quality=checks_for(settings, [recording]))
    if fit.result.solution.is_interrupted:
        raise KeyboardInterrupt
    file = None if kept is None else keep(kept, fit.save)
    predicted: dict[str, float | None] = {}
    for name, other in others.items():
        try:
            predicted[name] = finite(fit.predict(_read(**other), prepared=settings.prepared).vaf)
        except SuraeError:
            predicted[name] = None
    return {**_outcome(fit), "predicted": predicted, "file": file}


def _outcome(fit: surae.Fit) -> Plain:
    """What tables have of a fit."""
    return {
        "failed": fit.message if fit.status == "failed" else None,
        "status": fit.status,
        "grade": str(fit.adequacy.grade),
        "vaf": finite(fit.vaf),
        "r2": finite(fit.adequacy.r2),
        "ipde": finite(fit.ipde),
        "parameters": {
            name: {
                "value": finite(p.value),
                "sem": finite(p.sem),
                "ci95": None if p.ci95 is None else [finite(end) for end in p.ci95],
                "verdict": str(p.verdict),
            }
            for name, p in fit.parameters.items()
            if p.free
        },
        "measures": _measures(fit),
    }


def _measures(fit: surae.Fit) -> dict[str, list[float | str | None]]:
    """Value, ends of the 95 % interval and verdict of each measure that has a value."""
    try:
        every = fit.measures()
    except SuraeError:  # a fit without numbers
        return {}
    return {
        name: [m.value, *(m.ci95 or (None, None)), str(m.verdict)]
        for name, m in every.items()
        if finite(m.value) is not None
    }


def _relaxed(recording: Recording) -> list[list[float]]:
    """The relaxed curve: angle, torque and its deviation, stiffness and its; empty without rest."""
    try:
        curve = surae.relaxed(recording).curve
    except SuraeError:
        return []
    angles = np.arange(np.ceil(curve.low / _STEP), np.floor(curve.high / _STEP) + 1.0) * _STEP
    if not len(angles):
        return []
    columns = [angles]
    for mean, covariance in (curve.torque(angles), curve.stiffness(angles)):
        columns += [mean, np.sqrt(np.maximum(np.diag(covariance), 0.0))]
    return [row.tolist() for row in np.round(np.stack(columns, axis=1), 6)]


def trial_job(*, where: Where) -> Plain:
    """A recording's findings, relaxed curve, and power density of its torque [dB re 1 Nm²/Hz]."""
    try:
        recording = _read(**where)
        torque = recording.channels["torque"]
        quality = surae.check(recording)
    except (SuraeError, KeyError) as error:
        return {"failed": f"no torque: {error}" if isinstance(error, KeyError) else str(error)}
    at, power = spectrum(np.asarray(torque.values), torque.rate_hz)
    inside = FREQUENCIES[at[-1] >= FREQUENCIES]
    return {
        "spectrum": np.round(np.interp(inside, at, power), 3).tolist(),
        "findings": sorted({f.code for f in quality.findings if f.severity != "info"}),
        "relaxed": _relaxed(recording),
    }


def simulation_job(*, where: Where, settings: Plain, leg: int) -> Plain:
    """Standard errors of a virtual leg that moves and strains as recorded, with the thesis's noise.

    As its simulations (2.5): fitted by the model that made the torque; of the weights, whose unit
    is the electrode's, standard errors relative to the value.
    """
    chosen = from_plain(FitSettings, settings)
    try:
        inputs = _inputs(**where, settings=FitSettings())
    except SuraeError as error:
        return {"failed": str(error)}
    effort = inputs.emg / np.maximum(np.quantile(inputs.emg, _LARGEST, axis=0), 1e-300)
    spec = get_model(chosen.model)
    drawn = thesis_leg(_LEGS + leg, tendons=True)
    tendons = {name: value for name, value in drawn.tendons.items() if name in spec.free}
    subject = replace(drawn, tendons=tendons)
    emg = np.minimum(effort, 1.0) * _FULL
    torque = surae.simulate(chosen.model, subject.truth(chosen.model), replace(inputs, emg=emg))
    noisy, _ = with_noise(replace(inputs, emg=emg, torque=torque), [subject.seed, leg])
    fit = fit_trial(noisy, chosen.model, 2, 1)
    if fit is None:
        return {"failed": "the simulated trial could not be fitted"}
    sems = fit["sem"].items()
    return {"sem": {name: comparable(name, fit["values"][name], sem) for name, sem in sems}}


def comparable(name: str, value: float | None, sem: float) -> float:
    """A standard error that does not depend on the unit of an electrode."""
    return sem / abs(value) if name in _WEIGHTS and value else sem


def call(*, function: str, keywords: Plain) -> Plain:
    """One of the functions above, by its name."""
    known: dict[str, Callable[..., Plain]]
    jobs = (fit_job, session_job, trial_job, simulation_job)
    known = {job.__name__: job for job in jobs}
    return known[function](**keywords)
