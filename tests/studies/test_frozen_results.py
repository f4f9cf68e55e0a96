"""Results are what they were, to the last bit, where nobody meant to change them.

All of the output of each case in ``tests/frozen_results.py``, but for seconds, versions and paths,
is compared with its digest in ``tests/data/frozen.json``. Code that is only moved changes none.

Who means to change a result looks at what differs, and renews the file in the same commit::

    python tests/frozen_results.py
    python tests/frozen_results.py --renew
"""

import pytest

import frozen_results as frozen

KEPT = frozen.read_kept()


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return frozen.Results(tmp_path_factory.mktemp("frozen"))


@pytest.mark.slow
@pytest.mark.parametrize("case", frozen.CASES)
def test_a_result_is_what_it_was(case, results):
    try:
        now = frozen.summary(results.document(case))
    except frozen.AbsentError as why:
        pytest.skip(str(why))
    assert frozen.differences(KEPT["cases"][case], now) == []


def test_kept_results_are_those_of_the_cases():
    assert list(KEPT["cases"]) == list(frozen.CASES)


@pytest.mark.parametrize("change", [1e-15, -0.5])
def test_the_last_bit_of_a_number_is_seen(change):
    def of(number):
        return frozen.summary({"parameters": {"m": {"value": number}}, "seconds": number})

    before = of(1.0)
    assert frozen.differences(before, of(1.0)) == []
    lines = frozen.differences(before, of(1.0 + change))
    assert lines[0] == "differs in parameters"
    assert "parameters.m.value: 1.0 was kept" in lines[1]
