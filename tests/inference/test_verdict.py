"""The plain sentence of a verdict."""

import numpy as np
import pytest

from surae.inference.judging.parameter import judge_interval
from surae.inference.judging.verdict import Verdict
from surae.inference.uncertainty.covariance import Covariance


@pytest.mark.parametrize(
    ("relative", "verdict", "text"),
    [
        (0.002, Verdict.IDENTIFIED, "±0.2 %"),
        (0.0996, Verdict.IDENTIFIED, "±9.96 %"),
        (0.1031, Verdict.WEAK, "±10.3 %"),
        (1.6, Verdict.UNDETERMINED, "wider than its value"),
    ],
)
def test_a_note_never_reads_as_the_other_verdict(relative, verdict, text):
    eye = np.eye(2)
    estimated = Covariance(
        names=("m", "beta"), matrix=eye, correlation=eye, directions=(), sigma2=1.0, dof=100
    )
    found, note = judge_interval("m", 1.0, relative, estimated)
    assert found is verdict
    assert text in note
