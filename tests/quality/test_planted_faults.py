"""Every planted fault is found, and nothing in recordings without."""

from collections import Counter

import pytest

from benchmark_files import load

FAULTS = tuple(load("quality").FAULTS)
#: Seeds of a recording whose EMG is raw, at 2048 Hz, and of one of envelopes at 256 Hz.
RAW, ENVELOPE = 70000, 70001
#: One motion, so that its trajectory is made but once for each rate and task.
MOTION = (("multiple-holds", 0.0, False),)


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        pytest.param(name, seed, marks=[] if fast else pytest.mark.slow)
        for name in FAULTS
        for seed, fast in ((RAW, name.startswith("e")), (ENVELOPE, not name.startswith("e")))
    ],
)  # faults of EMG and electrodes are looked for in what laboratories record
def test_a_planted_fault_is_found(planted, name, seed) -> None:
    plant, needs = planted.FAULTS[name]
    signals = planted.signals(seed, **{**needs, "motions": MOTION})
    plant(signals)
    assert name.split()[0] in planted.codes(signals)


@pytest.mark.parametrize("seed", range(70010, 70013))
def test_nothing_is_found_in_a_clean_recording(planted, seed) -> None:
    assert planted.codes(planted.signals(seed, motions=MOTION)) == set()


def test_every_code_has_a_fault_here_or_a_test_elsewhere() -> None:
    from surae.quality import CODES

    assert set(CODES) - {name.split()[0] for name in FAULTS} == {
        "electrode-off",
        "samples-missing",
        "torque-artefact",
        "emg-kind",
        "emg-aliased",
        "emg-doubled",  # test_single_checks.py
        *(code for code in CODES if code.startswith("film-")),  # test_film_faults.py
        "angle-sign",
        "electrodes-swapped",  # test_explanations.py
        "as-read",  # test_unusable.py
        "emg-clock",
        "angle-clock",
        "torque-clock",
        "angle-torque-lag",  # test_clocks.py
        "emg-above-mvc",
        "no-shared-span",  # tests/cli/test_inspect_layouts.py
        "stretch-series",  # test_perturbed.py
        "not-used",
        "looked-at-in-windows",  # test_long_recordings.py
        "torque-drift",
        "emg-gain",
        "angle-still",
        "torque-unit",
        "emg-unit",
        "time-unit",
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_nearly_all_planted_faults_are_found(planted, name) -> None:
    plant, needs = planted.FAULTS[name]
    detected = 0
    for seed in range(90_000, 90_020):
        signals = planted.signals(seed, **needs)
        plant(signals)
        detected += name.split()[0] in planted.codes(signals)
    assert detected >= 18


@pytest.mark.slow
def test_no_code_is_found_in_more_than_five_of_a_hundred_clean_recordings(planted) -> None:
    told = [planted.codes(planted.signals(seed)) for seed in range(91_000, 91_100)]
    counts = Counter(code for codes in told for code in codes)
    assert max(counts.values(), default=0) <= 5
