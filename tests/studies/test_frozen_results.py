"""Results are what they were, to the last bit, where nobody meant to change them.

All of the output of each case in ``tests/frozen_cases.py``, but for seconds, versions and paths,
is compared with its digest in ``tests/data/frozen.json``. Code that is only moved changes none.

Who means to change a result looks at what differs, and renews the file in the same commit::

    python tests/frozen_results.py
    python tests/frozen_results.py --renew

Bits are those of one processor and its libraries. Elsewhere the numbers that are kept of each fit
are compared to 1e-6: other kernels of linear algebra (OpenBLAS's for Haswell in place of SkylakeX)
moved those of eight fits, named and ``auto``, by 4e-9 at most. What is drawn, tested or chosen from
a fit has thresholds that a last bit may cross, and is not compared there: such a case is skipped.
"""

import pytest

import frozen_results as frozen
from frozen_cases import CASES

KEPT = frozen.read_kept()
#: Relative difference of a fit's numbers on another processor.
ELSEWHERE = 1e-6


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return frozen.Results(tmp_path_factory.mktemp("frozen"))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_a_result_is_what_it_was(case, results):
    try:
        now = frozen.summary(results.document(case))
    except frozen.AbsentError as why:
        pytest.skip(str(why))
    kept, other = KEPT["cases"][case], frozen.elsewhere(KEPT["signature"])
    if not other:
        assert frozen.differences(kept, now) == []
        return
    if "vaf" not in kept["numbers"]:
        pytest.skip(f"bits are not those of this machine: {'; '.join(other)}")
    assert frozen.far(kept, now, ELSEWHERE) == []


def test_kept_results_are_those_of_the_cases():
    assert list(KEPT["cases"]) == list(CASES)


@pytest.mark.parametrize("change", [1e-15, -0.5])
def test_the_last_bit_of_a_number_is_seen(change):
    def of(number):
        data = {"parameters": {"m": {"value": number}}, "seconds": number}
        return frozen.summary(frozen.canonical(data))

    before = of(1.0)
    assert frozen.differences(before, of(1.0)) == []
    lines = frozen.differences(before, of(1.0 + change))
    assert lines[0] == "differs in parameters"
    assert "parameters.m.value: 1.0 was kept" in lines[1]


def test_elsewhere_a_number_may_differ_by_its_last_digits_alone():
    def of(number):
        return frozen.summary({"vaf": 99.5, "parameters": {"m": {"value": number}}})

    assert frozen.far(of(2.0), of(2.0 * (1 + 1e-9)), ELSEWHERE) == []
    (line,) = frozen.far(of(2.0), of(2.0 * (1 + 1e-5)), ELSEWHERE)
    assert "parameters.m.value" in line


def test_another_processor_is_named():
    assert frozen.elsewhere(frozen.signature()) == []
    (line,) = frozen.elsewhere({**frozen.signature(), "processor": "z80"})
    assert "z80" in line
