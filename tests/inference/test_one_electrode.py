"""Legs that share no code with surae, of whose muscles the tibialis alone has an electrode."""

import json

import numpy as np
import pytest

import surae
from ankle_legs.make import make

DUMB = "fixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }\n"


@pytest.fixture
def pulls_up(monkeypatch):
    """Efforts are the tibialis's; the calf adds a few percent of its own, early or late."""
    from ankle_legs import leg

    drawn = leg.effort

    def effort(rng, times, active):
        whole = drawn(rng, times, active)
        tibialis = np.clip(np.maximum(whole[0], 0.9 * whole[1:].sum(axis=0)), 0.0, 1.2)
        late = round(rng.uniform(-0.05, 0.15) / (times[1] - times[0]))
        calf = rng.uniform(0.0, 0.06) * np.roll(tibialis, late)
        return np.stack([tibialis, 0.2 * calf, 0.55 * calf, 0.25 * calf])

    monkeypatch.setattr(leg, "effort", effort)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["b", "c", "f"])
def test_what_the_calf_does_unheard_is_no_error_of_the_tibialis_emg(
    family, pulls_up, tmp_path
) -> None:
    (mapped,) = make(family, 733, tmp_path, seconds=20.0, raw=True, film=True)
    first, *channels = mapped.read_text(encoding="utf-8").split("[channels.")
    kept = ("angle", "torque", "emg_ta", "fascicle_tib")
    text = [first + DUMB, *(c for c in channels if c.startswith(kept))]
    mapped.write_text("[channels.".join(text), encoding="utf-8")
    fit = surae.fit(mapped, quality=())
    assert fit.result.solution.sizes["drive"] == 0.0
    truth = json.loads((tmp_path / "truth" / f"{family}-733.json").read_text(encoding="utf-8"))
    seen, true = truth["fascicles"]["fascicle_tib"], truth["trials"][0]["parameters"]
    for name, p in fit.parameters.items():
        if p.verdict == "identified" and true[name] is not None:
            assert p.ci95[0] <= true[name] <= p.ci95[1], name
    low, high = fit.measures()["optimal_fascicle_tib"].ci95
    assert low <= 1e3 * seen["scale"] * true["l0_tib"] + seen["zero_mm"] <= high
