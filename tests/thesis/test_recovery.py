"""Parameters found again: over fifty virtual subjects, from the default settings."""

import numpy as np
import pytest

from benchmark_files import load
from promises import arms_known
from surae.protocol import Protocol

RECOVERY = load("recovery")


def active(profile, rate_hz=256.0):
    return Protocol(profile=profile, chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=rate_hz)


def test_a_table_by_hand():
    def recovery_of(value, sem, identified):
        return RECOVERY.Recovery(
            0,
            99.9,
            "converged",
            1,
            (RECOVERY.Estimate("m", 2.0, value, sem, identified, sem and True),),
        )

    (row,) = RECOVERY.summarise(
        [recovery_of(2.18, 0.1, True), recovery_of(1.9, 0.3, True), recovery_of(3.0, None, False)]
    )
    assert (row.name, row.n) == ("m", 2)
    assert row.bias == pytest.approx(0.02)  # +9 % and −5 %
    assert row.spread == pytest.approx(0.07 * np.sqrt(2))
    assert row.sem == pytest.approx(np.sqrt((0.05**2 + 0.15**2) / 2))
    assert row.covered == 1.0
    assert row.identified == pytest.approx(2 / 3)
    assert row.close == pytest.approx(2 / 3)
    text = RECOVERY.markdown([row])
    assert len({line.count("|") for line in text.splitlines()}) == 1
    assert "| m | 2 | +2.00 | 9.90 |" in text


def test_no_estimate_with_a_standard_error():
    (row,) = RECOVERY.summarise(
        [
            RECOVERY.Recovery(
                0, 1.0, "failed", 0, (RECOVERY.Estimate("m", 2.0, 3.0, None, False, None),)
            )
        ]
    )
    assert row.n == 0
    assert np.isnan(row.bias)
    assert row.identified == row.close == 0.0
    assert "nan" in RECOVERY.markdown([row])


def test_one_subject():
    recovery = RECOVERY.recover(1, active("multiple-holds", 125.0), starts=2)
    assert recovery.status == "converged"
    assert len(recovery.estimates) == 15
    assert recovery == RECOVERY.recover(1, active("multiple-holds", 125.0), starts=2)
    # all but k, x0, l0 and the weights, which rest on arms and paths that no torque tells
    close = [abs(e.error) <= 0.1 for e in recovery.estimates if e.identified]
    assert len(close) == 5
    assert all(close)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["multiple-holds", "multi-sine-holds"])
def test_fifty_subjects(profile):
    with arms_known():  # these subjects have those that are assumed: what is left is noise
        recoveries = [RECOVERY.recover(seed, active(profile), starts=4) for seed in range(50)]
    rows = {row.name: row for row in RECOVERY.summarise(recoveries)}
    identified = [e for recovery in recoveries for e in recovery.estimates if e.identified]
    assert np.mean([abs(e.error) <= 0.1 for e in identified]) >= 0.97
    assert len(identified) >= 0.75 * 15 * 50
    assert np.median([recovery.vaf for recovery in recoveries]) > 99.8
    assert all(recovery.status != "failed" for recovery in recoveries)
    for row in rows.values():
        # The intervals are honest: the errors spread as the standard errors say, about no bias.
        assert 0.7 < row.spread / row.sem < 1.4, row
        assert abs(row.bias) < 4 * row.spread / np.sqrt(row.n), row
        assert row.covered > 0.84, row
    for name in ("m", "k_tri", "x0_tri", "g1", "g2", "g3", "l0_tri", "l0_tib", "f0", "beta"):
        assert rows[name].identified == 1.0
        assert rows[name].close == 1.0
